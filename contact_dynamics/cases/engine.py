# SPDX-License-Identifier: Apache-2.0
"""Engines that answer the cases: this package, and the simulators beside it.

An engine is a module with a function of the setting for each case, of the case's name. Another simulator is
such a module and a line in `PEERS`.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Final

from contact_dynamics.records import Record


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Engine(Record):
    """One engine."""

    name: str  # its name in the table
    package: str  # the Python package that it needs
    module: str  # the module with its answers

    @property
    def version(self) -> str:
        """The version of its package, or an empty text if that is not installed."""
        return "" if find_spec(self.package) is None else str(import_module(self.package).__version__)

    def answer(self, case: str, setting: float) -> float:
        """Return its answer to a case at a setting, in the case's unit. Its package must be installed."""
        return float(getattr(import_module(self.module), case)(setting))


OURS: Final = Engine(name="ours", package="contact_dynamics", module="contact_dynamics.cases.ours")
MUJOCO: Final = Engine(name="MuJoCo", package="mujoco", module="contact_dynamics.cases.mujoco")
PEERS: Final = (MUJOCO,)  # the simulators. Each has an option `--without-` and its package.
