# SPDX-License-Identifier: Apache-2.0
"""Packs the interfaces that setup/build_interfaces.sh has installed in this Python's environment as a wheel.

The wheel contains what a node needs: modules, libraries, definitions, and the ament index. It has no headers
and no files of CMake, which name folders of the machine that built them. As with the ROS wheels, Python finds
the libraries through ros-wheels-bootstrapper.

usage: VENV/bin/python setup/interfaces_wheel.py FOLDER
"""

from __future__ import annotations

import sys
from importlib.metadata import version
from pathlib import Path
from sysconfig import get_path, get_platform
from xml.etree import ElementTree as ET

from wheel.wheelfile import WheelFile

NAME = "contact_dynamics_interfaces"
ROOT = Path(__file__).resolve().parents[1]
LEFT_OUT = ("*.c", "*.egg-info/*", "share/*/cmake/*", "share/*/environment/*", "share/*/*sh", "share/*/*dsv")
"""What only builds and shells read, and setuptools' own record, because the wheel has one."""


def main(folder: Path) -> None:
    """Write the wheel into a folder."""
    prefix = Path(sys.prefix)
    modules = Path(get_path("platlib")).relative_to(prefix)
    manifest = ET.parse(ROOT / NAME / "package.xml").getroot()
    release = manifest.findtext("version")
    needed = [str(each.text) for each in (*manifest.iter("depend"), *manifest.iter("exec_depend"))]
    # rosidl adds service_msgs to packages with services. Libraries fit the versions they were built with.
    wheels = [f"ros-{name.replace('_', '-')}" for name in (*needed, "service_msgs")]
    tag = f"cp{sys.version_info[0]}{sys.version_info[1]}"
    metadata = [
        "Metadata-Version: 2.4",
        f"Name: {NAME}",
        f"Version: {release}",
        f"Summary: {manifest.findtext('description')}",
        f"License-Expression: {manifest.findtext('license')}",
        "License-File: LICENSE",
        *(f"Requires-Dist: {wheel}=={version(wheel)}" for wheel in wheels),
    ]
    platform = get_platform().replace("-", "_").replace(".", "_")
    about = ["Wheel-Version: 1.0", "Root-Is-Purelib: false", f"Tag: {tag}-{tag}-{platform}"]
    record, data = f"{NAME}-{release}.dist-info", Path(f"{NAME}-{release}.data", "data")
    # A set, because rosidl installs some files twice.
    installed = set((prefix / "build" / NAME / "installed.txt").read_text(encoding="utf-8").splitlines())
    with WheelFile(folder / f"{NAME}-{release}-{tag}-{tag}-{platform}.whl", "w") as packed:
        for file in map(Path, sorted(installed)):
            if file.parts[0] == "include" or any(map(file.match, LEFT_OUT)):
                continue
            inside = file.relative_to(modules) if modules in file.parents else data / file
            packed.write(prefix / file, str(inside))
        packed.write(ROOT / "LICENSE", f"{record}/licenses/LICENSE")
        packed.writestr(f"{record}/METADATA", "\n".join(metadata) + "\n")
        packed.writestr(f"{record}/WHEEL", "\n".join(about) + "\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
