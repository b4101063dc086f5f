"""The physics imports without ROS, and adapters know messages only.  Who may import whom: `test_chapters`."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from architecture.test_chapters import ROOT, imports_of, relative

ROS = {
    "rclpy",
    "rcl_interfaces",
    "geometry_msgs",
    "nav_msgs",
    "std_msgs",
    "builtin_interfaces",
    "service_msgs",
    "contact_dynamics_interfaces",
    "launch",
    "launch_ros",
    "ament_index_python",
}


@pytest.mark.parametrize("path", sorted((ROOT / "msg_adapters").glob("*.py")), ids=relative)
def test_adapters_know_messages_and_no_middleware(path: Path) -> None:
    assert not {module for module in imports_of(path) if module.split(".")[0] == "rclpy"}, relative(path)


def test_physics_imports_without_ros(tmp_path: Path) -> None:
    """With every ROS package made unimportable, the physics and its table of contents import."""
    blocked = "".join(f"sys.modules[{name!r}] = None\n" for name in sorted(ROS))
    use = "import contact_dynamics\nfor name in contact_dynamics.__all__: getattr(contact_dynamics, name)\n"
    code = f"import sys\n{blocked}{use}"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert result.returncode == 0, result.stderr
