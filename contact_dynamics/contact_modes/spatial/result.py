"""The answer to a question about contact modes in space."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.result import ModeVerdict
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialMode(Record):
    """A mode that is consistent with mechanics, with accelerations and forces that realise it. World axes.

    Attributes:
        mode: One letter a contact: s, f or c.
        acceleration_W: (3,), m/s^2, of the centre of mass.
        angular_acceleration_W: (3,), rad/s^2.
        contact_forces_W: (n, 3), N, on the body.
        contact_accelerations_W: (n, 3), m/s^2, of the body's points.
        tangential_directions_W: (n, 3), unit, which way a contact slides; zero: it does not.
        misdirection: rad, largest angle of friction to the way against sliding; 0: Coulomb's, exactly.
        forces_unique: Whether the forces are the only ones with this mode.
        motion_unique: Whether the accelerations are the only ones with this mode.
    """

    mode: str
    acceleration_W: FloatArray
    angular_acceleration_W: FloatArray
    contact_forces_W: FloatArray
    contact_accelerations_W: FloatArray
    tangential_directions_W: FloatArray
    misdirection: float
    forces_unique: bool
    motion_unique: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialModeAnswer(Record):
    """The answer to one question about contact modes in space.

    Refused letters are not listed: there are as many as cells in the arrangement of all sectors, and groups
    of them are refused at once. Strings of contacting and separating have their reasons (`refusals`).

    Attributes:
        verdict: On the whole contact set.
        modes: All consistent modes.
        approaching: Contacts that approach; not empty exactly where the verdict is IMPACT.
        velocity_tolerance: m/s, below which a contact's velocity counted as zero.
        friction_facets: Edges of the pyramids.
        examined: Letters, and groups of them, that were tried.
        undecided: What could not be made out, and why. Empty unless the verdict is UNDECIDED.
    """

    verdict: ModeVerdict
    modes: tuple[SpatialMode, ...]
    approaching: tuple[int, ...]
    velocity_tolerance: float
    friction_facets: int
    examined: int
    undecided: str = ""
