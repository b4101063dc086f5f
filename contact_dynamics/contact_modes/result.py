# SPDX-License-Identifier: Apache-2.0
"""The answers to questions about contact modes in the plane and in space: verdicts, modes, why not others.

A mode is a string with one letter for each contact, in the contacts' order (`letters`). In the plane, contact
axes are (tangent, normal), where the tangent is the normal turned by -90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.letters import LETTERS, mode_in_words
from contact_dynamics.plane.types import Vector2
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.validation import check_not_negative, check_size

if TYPE_CHECKING:
    from collections.abc import Sequence, Sized

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

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


def check_length(margin_length: float | None, own: float) -> float:
    """Return the length, m, that makes a torque comparable with a force, or the body's own without one.

    Raises:
        InvalidFieldError: the length is not from 1 / `LARGEST_NUMBER` to `LARGEST_NUMBER`.
    """
    return own if margin_length is None else check_size("margin_length", margin_length)


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


class AnyMode(Record):
    """What a mode that is consistent with mechanics says in words."""

    __slots__ = ()
    mode: str

    @property
    def words(self) -> tuple[str, ...]:
        """What each contact does: "separates", "stays fixed", "slides", "slides left" or "slides right"."""
        return tuple(LETTERS[letter][0] for letter in self.mode)

    def in_short(self) -> str:
        """Return the letters, and what the body does, or each kind of contact."""
        return f"{type(self).__name__} {self.mode}: {mode_in_words(self.mode)}"


class AnyModeAnswer(Record):
    """What an answer says in words."""

    __slots__ = ()
    verdict: ModeVerdict
    modes: Sequence[AnyMode]

    def in_short(self) -> str:
        """Return the verdict, and what the first modes are in words."""
        shown = [f"{mode.mode}: {mode_in_words(mode.mode)}" for mode in self.modes[:_SHOWN]]
        more = [f"{len(self.modes) - _SHOWN} more"] if len(self.modes) > _SHOWN else []
        return f"{type(self).__name__}: {self.verdict}{', ' if shown else ''}{'; '.join([*shown, *more])}"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarMode(AnyMode):
    """A mode that is consistent with mechanics, with accelerations and forces that realise it.

    Attributes:
        mode: The mode, with one letter for each contact.
        acceleration: m/s^2, the acceleration of the centre of mass.
        angular_acceleration: rad/s^2.
        contact_forces: N, the force (f_t, f_n) on the body at each contact.
        contact_accelerations: m/s^2, the acceleration (a_t, a_n) of the body's point at each contact.
        forces_unique: Whether the forces above are the only ones with this mode.
        motion_unique: Whether the accelerations above are the only ones with this mode.
    """

    mode: str
    acceleration: Vector2
    angular_acceleration: float
    contact_forces: tuple[Vector2, ...]
    contact_accelerations: tuple[Vector2, ...]
    forces_unique: bool
    motion_unique: bool


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarModeAnswer(AnyModeAnswer):
    """The answer to one question about contact modes.

    Attributes:
        verdict: The verdict on the whole contact set.
        modes: All consistent modes.
        refused: The modes that are possible kinematically and not consistent, each with the reason.
        approaching: The indices of the contacts that approach. There are some exactly if the verdict is
            IMPACT.
        contact_velocities: m/s, the velocity (v_t, v_n) of the body's point at each contact. Values within
            tolerance are 0.
        velocity_tolerance: m/s. Velocities of contacts up to this size counted as zero.
        acceleration_tolerance: m/s^2. Accelerations of the centre of mass up to this size counted as zero.
        undecided: What could not be decided, and why. It is empty unless the verdict is UNDECIDED.
        undecided_modes: The modes that are possible kinematically and neither consistent nor refused.
        within: The verdicts that occur within the problem's uncertainty, or None if it has none.
        problem: The `PlanarContactProblem` that is answered.
    """

    verdict: ModeVerdict
    modes: tuple[PlanarMode, ...]
    refused: tuple[RefusedMode, ...]
    approaching: tuple[int, ...]
    contact_velocities: tuple[Vector2, ...]
    velocity_tolerance: float
    acceleration_tolerance: float
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    within: VerdictsWithin | None = None
    problem: Record = field(repr=False, compare=False)

    @property
    def kinematic_modes(self) -> tuple[str, ...]:
        """Return every mode that some acceleration realises without penetration, in alphabetical order."""
        consistent = [found.mode for found in self.modes]
        refused = [found.mode for found in self.refused]
        return tuple(sorted([*consistent, *refused, *self.undecided_modes]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialMode(AnyMode):
    """A mode that is consistent with mechanics, with accelerations and forces that realise it, in world axes.

    Attributes:
        mode: One letter for each contact: s, f or c.
        acceleration_W: (3,), m/s^2, the acceleration of the centre of mass.
        angular_acceleration_W: (3,), rad/s^2.
        contact_forces_W: (n, 3), N, the forces on the body.
        contact_accelerations_W: (n, 3), m/s^2, the accelerations of the body's points in contact.
        tangential_directions_W: (n, 3), unit, the direction in which a contact slides; zero where it does
            not slide.
        misdirection: rad, the largest angle between friction and the direction against the sliding. It is
            rounding, unless the problem's ``sharpen`` is false.
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
class SpatialModeAnswer(AnyModeAnswer):
    """The answer to one question about contact modes in space.

    Rejected letters are not listed: there are as many as cells in the arrangement of all sectors, and the
    search rejects whole groups. `margins` gives reasons for each choice of separating contacts.

    Attributes:
        verdict: On the whole contact set.
        modes: All consistent modes. Separating comes before sticking, and sticking before sliding.
        approaching: The contacts that approach. It is not empty exactly where the verdict is IMPACT.
        velocity_tolerance: m/s. A contact's velocity up to it counted as zero.
        friction_facets: The number of edges of each friction pyramid.
        examined: The number of cases, of one letter or of a group of letters, that were tried.
        undecided: What could not be decided, and why. It is empty unless the verdict is UNDECIDED.
        undecided_modes: The letters of modes that could be neither found nor refuted.
        flush_within: rad, or a share of the reach. The modes are those of contacts whose normals and places
            differ by no more than this from the given ones, in which flush ones are exactly flush
            (`spatial.problem`). It is 0 where the modes are those of the given contacts.
        within: The verdicts that occur within the problem's uncertainty, or None if it has none.
        problem: The `SpatialContactProblem` that is answered.
    """

    verdict: ModeVerdict
    modes: tuple[SpatialMode, ...]
    approaching: tuple[int, ...]
    velocity_tolerance: float
    friction_facets: int
    examined: int
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    flush_within: float = 0.0
    within: VerdictsWithin | None = None
    problem: Record = field(repr=False)


def applied_wrench(
    body: MassProperties, state: BodyState, contacts: ContactSet, mode: SpatialMode
) -> FloatArray:
    """Return the wrench under which a mode's contact forces give its accelerations, gravity included.

    It is (6,), the force, N, then the torque about the centre of mass, N m, in world axes.
    """
    I_W = body.inertia_in_world(state.R_WB)
    force_W = body.mass * mode.acceleration_W - mode.contact_forces_W.sum(axis=0)
    torques_W = np.cross(contacts.p_WC_W - state.p_WB_W, mode.contact_forces_W)
    spun_W = I_W @ mode.angular_acceleration_W + np.cross(state.w_WB_W, I_W @ state.w_WB_W)
    return np.concatenate([force_W, spun_W - torques_W.sum(axis=0)])
