"""What a question about contact modes comes to: a verdict, every consistent mode, and why the others are not.

A mode is a string with one letter a contact, in the contacts' order (lecture 26): `s` separate, `l` slide
left, `r` slide right, `f` fixed. Contact axes are (tangent, normal), the tangent being the normal turned by
-90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

from contact_dynamics.plane.types import Vector2


class ModeVerdict(IntEnum):
    """What rigid-body mechanics says about a contact set as a whole."""

    UNIQUE = 0
    """One mode is consistent."""
    INDETERMINATE = 1
    """Several are; mechanics does not choose."""
    INCONSISTENT = 2
    """None is: the case is an impact without approach (lectures 26 and 27)."""
    IMPACT = 3
    """A contact approaches. Modes apply only after that impact."""


class Refusal(IntEnum):
    """Why mechanics refuses a mode that is possible kinematically."""

    PENETRATES = 0
    """Amount: normal acceleration < 0, m/s^2."""
    PULLS = 1
    """Amount: normal force < 0, N."""
    OUTSIDE_CONE = 2
    """Amount: |f_t| - mu f_n > 0, N."""
    WRONG_MOTION = 3
    """Amount: the acceleration that contradicts the contact's letter, m/s^2; 0 where the letter asks for more
    than 0."""
    NO_SOLUTION = 4
    """Amount: for one contact the factor of the normal force (1/kg, lecture 26, eq. 2) that is not > 0; for
    several the distance, N, of the applied wrench from those that can bring the mode about, a torque being
    divided by the radius of gyration. No contact forces give the mode's accelerations."""


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
class RefusedMode:
    """A mode that is possible kinematically and refused by mechanics."""

    mode: str  # one letter a contact
    refusal: Refusal  # the first reason found
    contact: int  # the contact whose letter fails; -1: the mode as a whole
    amount: float  # by how much, in the unit that the refusal states


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


def verdict_on(modes: tuple[PlanarMode, ...]) -> ModeVerdict:
    """Return the verdict on a set without approaching contacts from its consistent modes."""
    if len(modes) == 1:
        return ModeVerdict.UNIQUE
    return ModeVerdict.INDETERMINATE if modes else ModeVerdict.INCONSISTENT
