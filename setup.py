"""Packaging for pip and for colcon.

package.xml has the version and the description of the package, and requirements/ has the dependencies.
"""

from __future__ import annotations

import re
from pathlib import Path
from xml.etree import ElementTree as ET

from setuptools import find_packages, setup

# colcon may run this file through a link in its build folder, beside which requirements/ is missing.
HERE = Path(__file__).resolve().parent
MANIFEST = ET.parse(HERE / "package.xml").getroot()
NAME = MANIFEST.findtext("name")
REPOSITORY = ""
"""The address of the files, with a slash at the end, for README's links on a package index. It is empty until
there is one."""


def requirements(kind: str) -> list[str]:
    """Return the lines of one file of requirements/, without comments."""
    lines = (HERE / "requirements" / f"{kind}.txt").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def readme() -> str:
    """Return the README with absolute links, since a package index has no files beside it."""
    text = (HERE / "README.md").read_text(encoding="utf-8")
    return re.sub(r"\]\((?!https?:|#)", lambda _: f"]({REPOSITORY}", text)


def files(pattern: str) -> list[str]:
    """Return the paths that match, relative to this file, as setuptools needs them for data files."""
    return sorted(str(path.relative_to(HERE)) for path in HERE.glob(pattern))


setup(
    name=NAME,
    version=MANIFEST.findtext("version"),
    description=MANIFEST.findtext("description"),
    long_description=readme(),
    long_description_content_type="text/markdown",
    license=MANIFEST.findtext("license"),
    keywords=["contact mechanics", "friction", "impact", "rigid body", "robotics", "ROS 2"],
    classifiers=[
        "Development Status :: 4 - Beta",
        "Intended Audience :: Science/Research",
        "Operating System :: POSIX :: Linux",
        "Programming Language :: Python :: 3",
        "Programming Language :: Python :: 3 :: Only",
        *(f"Programming Language :: Python :: 3.{minor}" for minor in range(10, 15)),
        "Topic :: Scientific/Engineering :: Physics",
        "Typing :: Typed",
    ],
    python_requires=">=3.10",
    packages=find_packages(include=[f"{NAME}*", "msg_adapters*"], exclude=[f"{NAME}_interfaces*"]),
    package_data={"": ["py.typed", "*.csv", "*.json", "*.npz"]},
    zip_safe=False,
    install_requires=requirements("core"),
    extras_require={
        **{kind: requirements(kind) for kind in ("jazzy", "view", "plot", "test", "bench", "docs")},
        "evaluate": [*requirements("evaluate"), *requirements("plot")],
    },
    entry_points={"console_scripts": ["contact-dynamics = contact_dynamics.command_line:main"]},
    data_files=[
        ("share/ament_index/resource_index/packages", [f"resource/{NAME}"]),
        (f"share/{NAME}", ["package.xml"]),
        (f"share/{NAME}/config", files("config/*.yaml") + files("config/*.xml")),
        (f"share/{NAME}/launch", files("launch/*.launch.py")),
        # Where `ros2 run` looks.  As console scripts, names like `server` would stand in every bin folder.
        (f"lib/{NAME}", files("executables/*")),
    ],
)
