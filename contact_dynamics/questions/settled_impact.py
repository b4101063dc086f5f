"""The impact that settles a question about contact modes, and the modes after it."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.contact_modes import ModeVerdict, SpatialMode
from contact_dynamics.questions.resolved_impact import ResolvedImpact
from contact_dynamics.records import Record


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SettledImpact(Record):
    """The impact by which an inconsistent or approaching contact set comes to a contact mode.

    Attributes:
        impact: What the impact comes to.
        verdict: The verdict on the velocities after it.
        modes: All consistent modes with these velocities, as in `ContactModeAnswer`.
    """

    impact: ResolvedImpact
    verdict: ModeVerdict
    modes: tuple[SpatialMode, ...]
