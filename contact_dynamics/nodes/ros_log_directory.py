"""Finds a folder for ROS's own log files on machines whose home folder cannot be written.

rclpy does not start without such a folder. This file looks for it as rcl does, in ROS_LOG_DIR, ROS_HOME/log
or ~/.ros/log.
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path


def ensure_ros_log_directory() -> None:
    """Let this process and its children log to a temporary folder if home cannot be written.

    A folder that the user has named with ROS_LOG_DIR is left as it is, so that rclpy refuses it by name.
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
