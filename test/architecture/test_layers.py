"""The layers of the project: each imports only what lies below it."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "contact_dynamics"
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
TOP = {"nodes", "demo", "command_line", "__main__"}
SINKS = {"recording", "viewing"}
PHYSICS_MAY = {"numpy", "scipy", "contact_dynamics", "__future__"}


def imports_of(path: Path) -> set[str]:
    """All modules that a file imports, also inside functions."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and node.level == 0:
            found.add(node.module)
            if node.module == "contact_dynamics":
                found.update(f"contact_dynamics.{alias.name}" for alias in node.names)
    return found


def chapter_of(path: Path) -> str:
    """The first name below `contact_dynamics`: a module or a subpackage."""
    return path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def files(*, top: bool, sinks: bool, physics: bool) -> list[Path]:
    """The package's files of the layers that are asked for."""
    chosen = []
    for path in sorted(PACKAGE.rglob("*.py")):
        layer = chapter_of(path)
        if (layer in TOP and top) or (layer in SINKS and sinks) or (layer not in TOP | SINKS and physics):
            chosen.append(path)
    return chosen


def relative(path: Path) -> str:
    """What pytest shows."""
    return str(path.relative_to(ROOT))


@pytest.mark.parametrize("path", files(top=False, sinks=False, physics=True), ids=relative)
def test_physics_imports_numpy_scipy_and_itself_only(path: Path) -> None:
    import sys

    for module in imports_of(path):
        root = module.split(".")[0]
        assert root in PHYSICS_MAY or root in sys.stdlib_module_names, f"{path} imports {module}"
        if root == "contact_dynamics":
            chapter = ([*module.split("."), ""])[1]
            assert chapter not in TOP | SINKS, f"{path} imports {module}"


@pytest.mark.parametrize("path", files(top=False, sinks=True, physics=False), ids=relative)
def test_sinks_do_not_import_nodes(path: Path) -> None:
    for module in imports_of(path):
        parts = [*module.split("."), ""]
        assert not (parts[0] == "contact_dynamics" and parts[1] in TOP), f"{path} imports {module}"


@pytest.mark.parametrize("path", sorted((ROOT / "msg_adapters").glob("*.py")), ids=relative)
def test_adapters_import_physics_and_messages_only(path: Path) -> None:
    for module in imports_of(path):
        parts = [*module.split("."), ""]
        assert parts[0] != "rclpy", f"{path} imports {module}"
        assert not (parts[0] == "contact_dynamics" and parts[1] in TOP | SINKS), f"{path} imports {module}"


def test_the_lists_of_files_are_not_empty() -> None:
    assert len(files(top=False, sinks=False, physics=True)) > 10
    assert len(files(top=False, sinks=True, physics=False)) > 3
    assert len(list((ROOT / "msg_adapters").glob("*.py"))) > 5


def test_physics_imports_without_ros(tmp_path: Path) -> None:
    """With every ROS package made unimportable, the physics and its table of contents import."""
    import subprocess
    import sys

    blocked = "".join(f"sys.modules[{name!r}] = None\n" for name in sorted(ROS))
    use = "import contact_dynamics\nfor name in contact_dynamics.__all__: getattr(contact_dynamics, name)\n"
    code = f"import sys\n{blocked}{use}"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert result.returncode == 0, result.stderr
