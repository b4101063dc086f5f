"""What a question about contact modes in space comes to."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.result import ModeVerdict
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpatialMode:
    """A mode that is consistent with mechanics, with accelerations and forces that realise it. World axes."""

    mode: str  # one letter a contact: s, f or c
    acceleration_W: FloatArray  # (3,), m/s^2, of the centre of mass
    angular_acceleration_W: FloatArray  # (3,), rad/s^2
    contact_forces_W: FloatArray  # (n, 3), N, on the body
    contact_accelerations_W: FloatArray  # (n, 3), m/s^2, of the body's points
    tangential_directions_W: FloatArray  # (n, 3), unit, which way a contact slides; zero: it does not
    misdirection: float  # rad, largest angle of friction to the way against sliding; 0: Coulomb's, exactly
    forces_unique: bool  # whether the forces are the only ones with this mode
    motion_unique: bool  # whether the accelerations are the only ones with this mode


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SpatialModeAnswer:
    """The answer to one question about contact modes in space.

    Refused letters are not listed: there are as many as cells in the arrangement of all sectors, and groups
    of them are refused at once. Strings of contacting and separating have their reasons (`refusals`).
    """

    verdict: ModeVerdict  # on the whole contact set
    modes: tuple[SpatialMode, ...]  # all consistent modes
    approaching: tuple[int, ...]  # contacts that approach; not empty exactly where the verdict is IMPACT
    velocity_tolerance: float  # m/s, below which a contact's velocity counted as zero
    friction_facets: int  # edges of the pyramids
    examined: int  # letters, and groups of them, that were tried
