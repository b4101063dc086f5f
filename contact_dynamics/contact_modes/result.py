# SPDX-License-Identifier: Apache-2.0
"""Answers in the plane and in space share these types: verdicts, refused modes and statics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.validation import check_not_negative

if TYPE_CHECKING:
    from collections.abc import Sequence, Sized

_SHOWN: Final = 2
"""Modes that a verdict is shown with in short."""


class ModeVerdict(NamedInt):
    """What rigid-body mechanics says about a contact set as a whole."""

    UNIQUE = 0
    """One mode is consistent."""
    INDETERMINATE = 1
    """Several modes are consistent, and mechanics does not choose between them."""
    INCONSISTENT = 2
    """No mode is consistent. An impact without approach settles the case (lectures 26 and 27)."""
    IMPACT = 3
    """A contact approaches. Modes apply only after that impact."""
    UNDECIDED = 4
    """The modes that are listed are consistent. It could not be decided whether others are, and the answer
    says why. There may be no mode in the list."""


class Refusal(NamedInt):
    """Why mechanics refuses a mode that is possible kinematically."""

    PENETRATES = 0
    """The contact would penetrate. The amount is its normal acceleration, m/s^2, which is negative."""
    PULLS = 1
    """The contact would have to pull. The amount is its normal force, N, which is negative."""
    OUTSIDE_CONE = 2
    """The contact force would leave the friction cone. The amount is |f_t| - mu f_n, N, which is positive."""
    WRONG_MOTION = 3
    """The contact would not move as its letter says. The amount is the acceleration, m/s^2, that contradicts
    the letter. It is 0 if the letter demands more than 0."""
    NO_SOLUTION = 4
    """No contact forces give the mode's accelerations. For one contact the amount is the factor of the normal
    force (1/kg, lecture 26, eq. 2), which is not positive. For several contacts it is the distance, N, from
    the applied wrench to the wrenches that can bring the mode about, with torques divided by the radius of
    gyration."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class RefusedMode(Record):
    """A mode that is possible kinematically and refused by mechanics.

    Attributes:
        mode: The mode, with one letter for each contact.
        refusal: The first reason that was found.
        contact: The index of the contact whose letter fails, or -1 if no single contact is the reason.
        amount: By how much it fails, in the unit that the refusal states.
    """

    mode: str
    refusal: Refusal
    contact: int
    amount: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class VerdictsWithin(Record):
    """The verdicts on contacts that are known only to some uncertainty.

    Attributes:
        uncertainty: The box in which the true contacts are.
        verdicts: The verdicts that occur in the box, the one on the problem itself first. Each of the others
            was found at some contacts in the box.
        modes: The modes that are consistent at the problem itself or at some contacts that were found.
        certain: Whether it is proven that no other verdict occurs in the box. If it is not, the verdicts are
            those that samples have shown. If the verdict UNIQUE is certain, its mode is the same in the box.
        samples: How many contact sets in the box were tried.
    """

    uncertainty: ContactUncertainty
    verdicts: tuple[ModeVerdict, ...]
    modes: tuple[str, ...]
    certain: bool
    samples: int


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ModeProbability(Record):
    """How probable a mode is, by the noise of a measured state.

    Attributes:
        mode: The mode, or nothing for an impact.
        probability: The share of measurements of the state, drawn by its noise, under which it is consistent.
    """

    mode: str
    probability: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class GeometryMargin(Record):
    """How far the contacts would have to be off for another answer, in one of three ways.

    Another answer is another verdict, or another mode that is UNIQUE.

    Attributes:
        kind: What is off: "points" (sizes are in m), "normals" (rad) or "frictions".
        holds_within: It is proven that the answer is the same if all contacts are off by at most this. It is
            0 if nothing could be proven.
        changes_at: At some contacts that are off by at most this, another answer was found. It is infinite if
            none was found.
        verdict_beyond: The verdict there, or the present one if none was found.
        modes_beyond: The consistent modes there, or none.
    """

    kind: str
    holds_within: float
    changes_at: float
    verdict_beyond: ModeVerdict
    modes_beyond: tuple[str, ...]


SOME_MODE: Final = "a body at rest always has a consistent mode, and rounding hides which"
"""What could not be decided if no mode of a body at rest was found. Lemke's method finds one whatever the
friction, because contact forces do no positive work on accelerations from rest (Pang and Trinkle 1996)."""


def verdict_on(modes: Sized) -> ModeVerdict:
    """Return the verdict that follows from all consistent modes of contacts that do not approach."""
    if len(modes) == 1:
        return ModeVerdict.UNIQUE
    return ModeVerdict.INDETERMINATE if len(modes) > 0 else ModeVerdict.INCONSISTENT


def verdict_in_short(kind: str, verdict: ModeVerdict, modes: Sequence[str]) -> str:
    """Return a verdict with the first modes, each with its words."""
    shown = [f"{mode}: {mode_in_words(mode)}" for mode in modes[:_SHOWN]]
    more = [f"{len(modes) - _SHOWN} more"] if len(modes) > _SHOWN else []
    return f"{kind}: {verdict}{', ' if shown else ''}{'; '.join([*shown, *more])}"


class Certainty(NamedInt):
    """How surely rigid-body mechanics says yes."""

    NO = 1
    """It is not consistent."""
    POSSIBLE = 2
    """It is consistent, and something else is consistent too."""
    CERTAIN = 3
    """It is consistent, and nothing else is."""
    UNKNOWN = 4
    """Rounding decides. In space it may stand for an answer beside the equilibrium."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class BodyStatics(Record):
    """What holds a body at rest, and how well.

    Attributes:
        equilibrium: Whether the body stays at rest.
        jammed: Whether friction alone keeps the body at rest.
        wedged: Whether the contacts can press against each other without an applied wrench, or None if
            rounding decides.
        stable_disturbance: N. Equilibrium stays possible under every change of the wrench up to this size. It
            is infinite if equilibrium is possible under every wrench (force closure), and NaN if there is no
            equilibrium. Infinite together with an ``equilibrium`` that is POSSIBLE means: contact forces that
            hold the body exist whatever pushes it, but they depend on how hard the contacts are pressed
            together (a wedged body). Rigid-body mechanics does not say that, so that the body may also move.
        margin_length: m. The size of a change is measured in |f|^2 + (moment / length)^2 with this length.
    """

    equilibrium: Certainty
    jammed: Certainty
    wedged: bool | None
    stable_disturbance: float
    margin_length: float

    def is_stable_against(self, disturbance: float) -> bool:
        """Return whether equilibrium stays possible under every change of the wrench up to this size, N."""
        return self.stable_disturbance >= check_not_negative("disturbance", disturbance)  # false for NaN
