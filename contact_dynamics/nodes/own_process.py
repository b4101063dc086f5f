# SPDX-License-Identifier: Apache-2.0
"""What a node does to its own process before it starts: its memory, its output, and ROS's log files."""

from __future__ import annotations

import ctypes
import os
import stat
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Final

_M_MMAP_THRESHOLD: Final = -3  # as malloc.h of glibc has it
_THRESHOLD: Final = 64 * 1024
"""bytes, below the pieces of the services. glibc begins with twice as much, and raises it with each piece
that is freed unless it is set."""


def keep_reserved_memory_untouched() -> None:
    """Let large pieces of memory always be fresh ones. Without glibc there is nothing to do.

    DDS sets aside room for messages as large as their lists may be, for each writer and reader: a hundred
    pieces, each of some 100 kB for the services and of megabytes for some topics. Fresh memory costs nothing
    before it is written to. But glibc takes pieces from its heap once a process has freed some, and clears
    them, so that all of the room is found at once. A process that made server and visualizer for the third
    time took 7 GB in place of 0.1 GB, and a server grew by 6 MB each time that it was cleaned up and
    configured. Pieces above a threshold are always fresh, and go back to the machine when they are freed.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _THRESHOLD)


_OUTPUTS: Final = (1, 2)


def never_wait_for_readers() -> None:
    """Let lines get lost that go to a pipe which is full. Others with the same pipe wait as before.

    A pipe holds 64 kB. Whoever starts a node and does not read its output would stop it at the next line once
    that is full, and ROS prints six lines for each message that is none.
    """
    for output in _OUTPUTS:
        with suppress(OSError):  # it is closed, or another user's
            if stat.S_ISFIFO(os.fstat(output).st_mode):
                # To open it anew makes a way of this process alone. The one that it was given may be shared.
                own = os.open(f"/proc/self/fd/{output}", os.O_WRONLY | os.O_NONBLOCK)
                os.dup2(own, output)
                os.close(own)


def ensure_ros_log_directory() -> None:
    """Let this process and its children log to a temporary folder if home cannot be written.

    rclpy does not start without a folder for its log files. It is looked for as rcl does, in ROS_LOG_DIR,
    ROS_HOME/log or ~/.ros/log. A folder that the user has named with ROS_LOG_DIR is left as it is, so that
    rclpy refuses it by name.
    """
    if os.environ.get("ROS_LOG_DIR"):
        return
    home = os.environ.get("ROS_HOME")
    folder = (Path(home).expanduser() if home else Path("~").expanduser() / ".ros") / "log"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return
    except OSError as error:
        chosen = tempfile.mkdtemp(prefix="ros_log_")
        os.environ["ROS_LOG_DIR"] = chosen
        sys.stderr.write(
            f"ROS's log files go to {chosen}, because {folder} cannot be written ({error.strerror}). "
            "Set ROS_LOG_DIR to choose the folder.\n"
        )
