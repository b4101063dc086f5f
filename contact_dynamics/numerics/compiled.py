# SPDX-License-Identifier: Apache-2.0
"""Import of the compiled core: the modules that have a `.pxd` with C types beside their `.py`.

Both forms give bitwise equal results, and the compiled one is much faster. Python prefers a compiled module
even if it was built from older sources. Compiled modules therefore contain a checksum of their sources, and
if it differs, the `.py` is imported. The environment variable `CONTACT_DYNAMICS_PLAIN=1` also selects the
`.py`, for tests, coverage and debuggers, and makes setup.py build a wheel without the core.
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


_USES_PLAIN: Final = "uses modules that run as plain Python"

_plain: set[str] = set()
"""Modules that run as plain Python because a compiled one cannot be used."""


def plain_is_chosen() -> bool:
    """Return whether the environment selects plain Python."""
    return os.environ.get(PLAIN, "0") not in {"", "0"}


def checksum(source: Path) -> int:
    """Return the checksum of a `.py` file and the `.pxd` beside it, which setup.py compiles in."""
    return zlib.crc32(source.read_bytes() + source.with_suffix(".pxd").read_bytes()) & 0x7FFFFFFF


def import_core(*modules: str) -> None:
    """Import modules of a package that is being imported, in their compiled form if it is up to date.

    They share declarations that only C sees, so that all of them are compiled or none. If they are not, a
    warning is issued, unless `CONTACT_DYNAMICS_PLAIN` selects plain Python, or an earlier warning has named
    the outdated module.
    """
    if modules[-1] in sys.modules:
        return
    before = set(sys.modules)
    if not plain_is_chosen():
        problems = [(module, problem) for module in modules if (problem := _problem_of(module))]
        if not problems:
            return
        _warn([one for one in problems if one[1] != _USES_PLAIN or not _plain])
        _plain.update(modules)
    package = modules[0].rpartition(".")[0]
    for module in set(sys.modules) - before:
        if module.startswith(f"{package}."):  # it may have imported compiled modules
            del sys.modules[module]
    for module in modules:
        name = module.rpartition(".")[2]
        spec = importlib.util.spec_from_file_location(module, _source_of(module))
        if spec is None or spec.loader is None:
            raise ImportError(module)
        plain = importlib.util.module_from_spec(spec)
        sys.modules[module] = plain
        spec.loader.exec_module(plain)
        setattr(sys.modules[package], name, plain)


def _warn(problems: list[tuple[str, str]]) -> None:
    for module, problem in problems[:1]:
        warnings.warn(
            f"the compiled core of contact_dynamics {problem}; {module} runs as plain Python: {SLOWER}. "
            "Where there is a C compiler, `make setup` in a clone or `pip install` builds it. "
            f"{PLAIN}=1 in the environment silences this warning",
            RuntimeWarning,
            stacklevel=4,
        )


def _source_of(module: str) -> Path:
    package, _, name = module.rpartition(".")
    return Path(sys.modules[package].__path__[0], f"{name}.py")


def _problem_of(module: str) -> str:
    """Return why the compiled form of a module cannot be used, or an empty string if it can."""
    try:
        built = getattr(importlib.import_module(module), "SOURCE_CRC", None)
    except ImportError as error:
        return f"cannot be imported ({error})"
    except (TypeError, ValueError):
        return _USES_PLAIN
    if built == checksum(_source_of(module)):
        return ""
    return "is missing" if built is None else "was built from other sources"
