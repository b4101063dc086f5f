# SPDX-License-Identifier: Apache-2.0
"""This file imports modules of the compiled core: those that have a `.pxd` with C types beside their `.py`.

Both forms give the same bits, and the compiled one is much faster. Python imports it by itself where it
exists, even if it was built from older sources. So compiled modules carry a checksum of their sources, and
where it does not fit, the `.py` runs. The variable `CONTACT_DYNAMICS_PLAIN=1` in the environment chooses the
`.py` too, for tests, coverage and debuggers, and makes setup.py build a wheel without the core.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import sys
import warnings
import zlib
from pathlib import Path
from typing import Final

PLAIN: Final = "CONTACT_DYNAMICS_PLAIN"

SLOWER: Final = (
    "impacts in space take 5 to 20 times as long, tosses 10 to 17 times, and batches 20 to 60 times"
)
"""The cost of running without the compiled core. `make bench` measures it with `CONTACT_DYNAMICS_PLAIN=1`."""


def plain_is_chosen() -> bool:
    """Return whether the environment asks for plain Python."""
    return os.environ.get(PLAIN, "0") not in {"", "0"}


def checksum(source: Path) -> int:
    """Return the checksum of a `.py` file and the `.pxd` beside it, which setup.py compiles in."""
    return zlib.crc32(source.read_bytes() + source.with_suffix(".pxd").read_bytes()) & 0x7FFFFFFF


def import_core(*modules: str) -> None:
    """Import modules, of a package that is being imported, in their compiled form if that is up to date.

    They share what only C sees, so that all of them are compiled or none. If they are not, a warning says so,
    unless `CONTACT_DYNAMICS_PLAIN` chooses plain Python.
    """
    if modules[-1] in sys.modules:
        return
    if os.environ.get(PLAIN, "0") in {"", "0"}:
        problems = [(module, problem) for module in modules if (problem := _problem_of(module))]
        if not problems:
            return
        module, problem = problems[0]
        warnings.warn(
            f"the compiled core of contact_dynamics {problem}; {module} runs as plain Python: {SLOWER}. "
            "Where there is a C compiler, `make setup` in a clone or `pip install` builds it. "
            f"{PLAIN}=1 in the environment silences this warning",
            RuntimeWarning,
            stacklevel=3,
        )
    for module in modules:
        package, _, name = module.rpartition(".")
        spec = importlib.util.spec_from_file_location(module, _source_of(module))
        if spec is None or spec.loader is None:
            raise ImportError(module)
        plain = importlib.util.module_from_spec(spec)
        sys.modules[module] = plain
        spec.loader.exec_module(plain)
        setattr(sys.modules[package], name, plain)


def _source_of(module: str) -> Path:
    package, _, name = module.rpartition(".")
    return Path(sys.modules[package].__path__[0], f"{name}.py")


def _problem_of(module: str) -> str:
    """Return why the compiled form of a module cannot be used, or nothing if it can."""
    try:
        built = getattr(importlib.import_module(module), "SOURCE_CRC", None)
    except (ImportError, TypeError, ValueError) as error:  # the latter if what it uses runs as plain Python
        return f"cannot be imported ({error})"
    if built == checksum(_source_of(module)):
        return ""
    return "is missing" if built is None else "was built from other sources"
