# SPDX-License-Identifier: Apache-2.0
"""Packaging for pip and for colcon.

package.xml has the version and the description of the package, and requirements/ has the dependencies. Each
`.pxd` of the package names a module that Cython compiles. Without Cython or a C compiler it stays Python, and
with `CONTACT_DYNAMICS_PLAIN=1` in the environment too: the wheel is then for every platform.
"""

from __future__ import annotations

import re
import runpy
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import setuptools
from setuptools import Extension, find_packages, setup
from setuptools.command.build_ext import build_ext

# colcon may run this file through a link in its build folder, beside which requirements/ is missing.
HERE = Path(__file__).resolve().parent
MANIFEST = ET.parse(HERE / "package.xml").getroot()
NAME = MANIFEST.findtext("name")
VERSION = MANIFEST.findtext("version")
# Ubuntu 24.04's setuptools, with which colcon builds, does not know PEP 639's name.
LICENSE_KEY = "license_expression" if int(setuptools.__version__.split(".")[0]) >= 77 else "license"
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


def core() -> list[Extension]:
    """Return the modules to compile: none without Cython, or where the environment asks for plain Python."""
    compiled = runpy.run_path(str(HERE / NAME / "numerics" / "compiled.py"))
    if find_spec("Cython") is None or compiled["plain_is_chosen"]():
        return []
    sources = [Path(name).with_suffix(".py") for name in files(f"{NAME}/**/*.pxd")]
    return [
        Extension(
            ".".join(source.with_suffix("").parts),
            [str(source)],
            define_macros=[("SOURCE_CRC", str(compiled["checksum"](HERE / source)))],
            # A fused multiply-add would round once where Python rounds twice. GCC 12 makes some of
            # pairs of operations all the same, unless it leaves these alone.
            extra_compile_args=[
                "-O2",
                "-g0",
                "-ffp-contract=off",
                "-fno-tree-slp-vectorize",
                "-funroll-loops",
            ],
            optional=True,
        )
        for source in sources
    ]


class BuildCore(build_ext):
    """Translates modules to C when they are built, and not each time that this file is read."""

    def finalize_options(self) -> None:
        """Build as many modules at once as there are processors, unless `--parallel` says how many."""
        super().finalize_options()
        self.parallel = self.parallel or True

    def build_extension(self, ext: Any) -> None:
        """Build one module, always anew: the time of a file does not tell what it was built from."""
        directives = {
            "annotation_typing": False,  # a float in Python's annotations may be an integer
            "boundscheck": False,
            "cdivision": True,
            "cpow": True,
            "infer_types": True,
            "initializedcheck": False,
            "wraparound": False,
        }
        (source,) = ext.sources
        translated = Path(self.build_temp, source).with_suffix(".c")
        translated.parent.mkdir(parents=True, exist_ok=True)
        # A process of its own, since threads of one would translate one after the other.
        command = [sys.executable, "-m", "cython", "-3", "--module-name", ext.name, "-o", str(translated)]
        options = [option for name, value in directives.items() for option in ("-X", f"{name}={value}")]
        subprocess.run([*command, *options, source], check=True)  # noqa: S603  our own
        ext.sources = [str(translated)]
        self.force = True
        super().build_extension(ext)


setup(
    name=NAME,
    version=VERSION,
    description=MANIFEST.findtext("description"),
    long_description=readme(),
    long_description_content_type="text/markdown",
    **{LICENSE_KEY: MANIFEST.findtext("license")},
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
    package_data={"": ["py.typed", "*.csv", "*.json", "*.npz", "*.pxd"]},
    ext_modules=core(),
    cmdclass={"build_ext": BuildCore},
    zip_safe=False,
    install_requires=requirements("core"),
    extras_require={
        **{kind: requirements(kind) for kind in ("view", "plot", "mesh", "completion")},
        **{kind: requirements(kind) for kind in ("test", "bench", "docs")},
        # Their wheel is built by `make wheels`. An installed ROS has the interfaces from colcon instead.
        "jazzy": [*requirements("jazzy"), f"{NAME}_interfaces=={VERSION}"],
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
