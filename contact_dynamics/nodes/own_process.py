# SPDX-License-Identifier: Apache-2.0
"""Settings of a node's own process: its memory, its output, and ROS's log files."""

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
"""Bytes, less than the buffers of the services. glibc starts with twice as much, and raises it with each
freed buffer unless it is set."""


def keep_reserved_memory_untouched() -> None:
    """Allocate large buffers by fresh memory maps. Without glibc, this does nothing.

    DDS reserves a buffer for the largest possible message of each writer and reader: a hundred buffers, of
    some 100 kB for services and of megabytes for some topics. Fresh memory costs nothing until it is written.
    Once a process has freed some, however, glibc takes such buffers from its heap and clears them. A process
    that created server and visualizer for the third time used 7 GB instead of 0.1 GB, and a server grew by
    6 MB with each lifecycle transition. Buffers above a threshold are always mapped, and unmapped when freed.
    """
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _THRESHOLD)


_OUTPUTS: Final = (1, 2)


def never_wait_for_readers() -> None:
    """Discard output to a full pipe instead of blocking. Other processes with the same pipe still block.

    A pipe holds 64 kB. Without this, a node whose output nobody reads would stop once the pipe is full, and
    ROS prints six lines for each invalid message.
    """
    for output in _OUTPUTS:
        with suppress(OSError):  # closed, or owned by another user
            if stat.S_ISFIFO(os.fstat(output).st_mode):
                # A reopened pipe has flags of its own; the inherited descriptor may be shared.
                own = os.open(f"/proc/self/fd/{output}", os.O_WRONLY | os.O_NONBLOCK)
                os.dup2(own, output)
                os.close(own)


def ensure_ros_log_directory() -> None:
    """Let this process and its children log to a temporary folder if home is not writable.

    rclpy does not start without a folder for its log files, which is ROS_LOG_DIR, ROS_HOME/log or ~/.ros/log.
    A folder in ROS_LOG_DIR is unchanged, so that the error of rclpy names it.
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
