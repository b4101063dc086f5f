"""Cases asked, and their answers as a table."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.cases.case import Case
    from contact_dynamics.cases.published import PublishedValue, PublishedVerdict

DIGITS: Final = 6
"""Significant digits of a number in the table."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Asked(Record):
    """One setting of a case, asked.

    Attributes:
        name: The name of the case.
        case: The case.
        setting: The setting.
        exact: The exact answer.
        ours: The package's answer.
        mujoco: MuJoCo's, or None if it was not simulated.
    """

    name: str
    case: Case
    setting: float
    exact: float
    ours: float
    mujoco: float | None

    @property
    def is_right(self) -> bool:
        """Whether the package's answer is exact within the case's tolerance."""
        return abs(self.ours - self.exact) <= self.case.tolerance


def asked(name: str, case: Case, setting: float, *, simulate: bool) -> Asked:
    """Ask one setting of a case, here and, if ``simulate``, of MuJoCo, which must be installed then."""
    return Asked(
        name=name,
        case=case,
        setting=setting,
        exact=case.exact(setting),
        ours=case.ours(setting),
        mujoco=case.mujoco(setting) if simulate else None,
    )


def shown(value: float, tolerance: float = 0.0) -> str:
    """Return a number with a few digits. What is below the tolerance is rounding, and is not shown."""
    if tolerance > 0.0:
        value = round(value, -math.floor(math.log10(tolerance)))
    return f"{value + 0.0:.{DIGITS}g}"


def row(one: Asked, *, no_mujoco: str) -> str:
    """Return one line of the table. ``no_mujoco`` stands where MuJoCo did not answer."""
    mujoco = no_mujoco if one.mujoco is None else f"{one.mujoco:.4g}"
    verdict = "exact" if one.is_right else "WRONG"
    tolerance = one.case.tolerance
    return (
        f"  {one.setting:<10g} {shown(one.exact, tolerance):>14} {shown(one.ours, tolerance):>14} "
        f"{mujoco:>14}  {verdict}"
    )


def heading(case: Case, peer: str) -> str:
    """Return the lines above the rows of a case."""
    return (
        f"{case.title}\n  {case.quantity}: {case.formula}\n"
        f"  {case.setting}\n  {'':10} {'exact':>14} {'ours':>14} {peer:>14}"
    )


def published_row(value: PublishedValue, ours: float, verdict: PublishedVerdict) -> str:
    """Return one line about a published number, with a second one if it had to be explained."""
    explained = f"\n{'':42}{value.explained}" if verdict.name == "EXPLAINED" else ""
    return (
        f"{value.expected:>14.{DIGITS}g} {ours:>14.{DIGITS}g} {value.tolerance:>10.2g}  {verdict.name.lower():9} "
        f"{value.what} [{value.where}]{explained}"
    )
