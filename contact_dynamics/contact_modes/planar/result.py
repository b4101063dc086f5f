"""What a question about contact modes comes to: a verdict, every consistent mode, and why the others are not.

A mode is a string with one letter a contact, in the contacts' order (lecture 26): `s` separate, `l` slide
left, `r` slide right, `f` fixed. Contact axes are (tangent, normal), the tangent being the normal turned by
-90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.contact_modes.result import ModeVerdict, RefusedMode
from contact_dynamics.plane.types import Vector2


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarMode:
    """A mode that is consistent with mechanics, with accelerations and forces that realise it."""

    mode: str  # one letter a contact
    acceleration: Vector2  # m/s^2, of the centre of mass
    angular_acceleration: float  # rad/s^2
    contact_forces: tuple[Vector2, ...]  # N, on the body, (f_t, f_n) of each contact
    contact_accelerations: tuple[Vector2, ...]  # m/s^2, (a_t, a_n) of the body's point at each contact
    forces_unique: bool  # whether the forces above are the only ones with this mode
    motion_unique: bool  # whether the accelerations above are the only ones with this mode


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarModeAnswer:
    """The answer to one question about contact modes."""

    verdict: ModeVerdict  # on the whole contact set
    modes: tuple[PlanarMode, ...]  # all consistent modes
    refused: tuple[RefusedMode, ...]  # the kinematically possible rest
    approaching: tuple[int, ...]  # contacts that approach; not empty exactly where the verdict is IMPACT
    contact_velocities: tuple[Vector2, ...]  # m/s, (v_t, v_n), with values within tolerance as 0
    velocity_tolerance: float  # m/s, below which a contact's velocity counted as zero
    acceleration_tolerance: float  # m/s^2, below which one of the centre of mass counted as zero

    @property
    def kinematic_modes(self) -> tuple[str, ...]:
        """Return every mode that some acceleration realises without penetration, in alphabetical order."""
        return tuple(sorted([found.mode for found in self.modes] + [found.mode for found in self.refused]))
