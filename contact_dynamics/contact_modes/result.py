"""The parts of answers about contact modes that plane and space share: verdicts, refusals, statics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from contact_dynamics.records import NamedInt, Record

if TYPE_CHECKING:
    from collections.abc import Sized


class ModeVerdict(NamedInt):
    """What rigid-body mechanics says about a contact set as a whole."""

    UNIQUE = 0
    """One mode is consistent."""
    INDETERMINATE = 1
    """Several are; mechanics does not choose."""
    INCONSISTENT = 2
    """None is: the case is an impact without approach (lectures 26 and 27)."""
    IMPACT = 3
    """A contact approaches. Modes apply only after that impact."""
    UNDECIDED = 4
    """The modes that are listed are consistent, if any are; whether others are could not be made out, and the
    answer says why."""


class Refusal(NamedInt):
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


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class RefusedMode(Record):
    """A mode that is possible kinematically and refused by mechanics.

    Attributes:
        mode: One letter a contact.
        refusal: The first reason found.
        contact: The contact whose letter fails; -1: the mode as a whole.
        amount: By how much, in the unit that the refusal states.
    """

    mode: str
    refusal: Refusal
    contact: int
    amount: float


def verdict_on(modes: Sized) -> ModeVerdict:
    """Return the verdict on a set without approaching contacts from its consistent modes."""
    if len(modes) == 1:
        return ModeVerdict.UNIQUE
    return ModeVerdict.INDETERMINATE if len(modes) > 0 else ModeVerdict.INCONSISTENT


class Certainty(NamedInt):
    """How far rigid-body mechanics answers yes."""

    NO = 1
    POSSIBLE = 2
    """Consistent, and so is something else."""
    CERTAIN = 3


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class BodyStatics(Record):
    """What holds a body at rest, and how well.

    Attributes:
        equilibrium: Whether it stays at rest.
        jammed: Whether friction alone keeps it at rest.
        wedged: Whether the contacts can press against each other without an applied wrench.
        stable_disturbance: N: equilibrium is possible under every change of the wrench up to this size;.
        margin_length: m, of the metric |f|^2 + (moment / length)^2 of that size.
    """

    equilibrium: Certainty
    jammed: Certainty
    wedged: bool
    stable_disturbance: float
    # infinite: under every change at all (force closure); NaN: no equilibrium
    margin_length: float

    def is_stable_against(self, disturbance: float) -> bool:
        """Return whether equilibrium stays possible under every change of the wrench up to this size, N."""
        return self.stable_disturbance >= disturbance  # NaN compares as false
