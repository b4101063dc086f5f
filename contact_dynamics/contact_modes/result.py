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
from contact_dynamics.tolerances import TURNS
from contact_dynamics.validation import check_not_negative, check_size

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence, Sized

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

_SHOWN: Final = 2
"""Modes that a verdict is shown with in short."""


class ModeVerdict(NamedInt):
    """Verdict on the contact modes of all contacts together."""

    UNIQUE = 0
    """One mode is consistent."""
    INDETERMINATE = 1
    """Several modes are consistent, and rigid-body mechanics does not determine which one occurs."""
    INCONSISTENT = 2
    """No mode is consistent. An impact without approach resolves the case (lectures 26 and 27)."""
    IMPACT = 3
    """A contact approaches. Contact modes apply only after the impact."""
    UNDECIDED = 4
    """The listed modes are consistent, but others may exist; the answer contains the reason. The list may be
    empty."""


class Refusal(NamedInt):
    """Reason for which a kinematically possible mode is not consistent."""

    PENETRATES = 0
    """The contact would penetrate. The amount is its normal acceleration, m/s^2, which is negative."""
    PULLS = 1
    """The contact force would pull. The amount is the normal force, N, which is negative."""
    OUTSIDE_CONE = 2
    """The contact force would be outside the friction cone. The amount is |f_t| - mu f_n, N, which is
    positive."""
    WRONG_MOTION = 3
    """The motion of the contact would contradict its letter. The amount is the acceleration, m/s^2, that
    contradicts the letter, or 0 if the letter requires more than 0."""
    NO_SOLUTION = 4
    """No contact forces cause the accelerations of the mode. For one contact the amount is the factor of the
    normal force (1/kg, lecture 26, eq. 2), which is not positive. For several contacts it is the distance, N,
    from the applied wrench to the wrenches that can cause the mode, with torques divided by the radius of
    gyration."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class RefusedMode(Record):
    """Mode that is kinematically possible but not consistent with mechanics.

    Attributes:
        mode: One letter for each contact.
        refusal: The first violated condition that was found.
        contact: Index of the contact that violates it, or -1 if it is not a single contact.
        amount: Amount of the violation, in the unit that the `Refusal` defines.
    """

    mode: str
    refusal: Refusal
    contact: int
    amount: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class VerdictsWithin(Record):
    """Verdicts that occur within the uncertainty of the contacts.

    Attributes:
        uncertainty: Box that contains the true contacts.
        verdicts: Verdicts that occur in the box. The first one is that of the given contacts, and every other
            one was found for some contacts in the box.
        modes: Modes that are consistent for the given contacts or for contacts that were found.
        certain: Whether it is proven that no other verdict occurs in the box, and that a UNIQUE mode is the
            same in the whole box. If false, the verdicts are those of samples.
        samples: Number of sampled contact sets in the box.
    """

    uncertainty: ContactUncertainty
    verdicts: tuple[ModeVerdict, ...]
    modes: tuple[str, ...]
    certain: bool
    samples: int


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class ModeProbability(Record):
    """Probability of a mode, given the noise of a measured state.

    Attributes:
        mode: The mode, or an empty string for an impact.
        probability: Share of measurements, sampled from the noise of the state, for which the mode is
            consistent.
    """

    mode: str
    probability: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class GeometryMargin(Record):
    """Error of the contacts that changes the answer, for one kind of error.

    A change is another verdict, or another UNIQUE mode.

    Attributes:
        kind: Kind of error: "points" (sizes in m), "normals" (rad) or "frictions".
        holds_within: Error of all contacts up to which the answer is proven not to change. It is 0 if nothing
            could be proven.
        changes_at: Error at which a change was found for some contacts. It is infinite if none was found.
        verdict_beyond: Verdict of those contacts, or the verdict of the given contacts if no change was
            found.
        modes_beyond: Consistent modes of those contacts. Empty if no change was found.
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
    """Answer to a question of statics."""

    NO = 1
    """It is not consistent with rigid-body mechanics."""
    POSSIBLE = 2
    """It is consistent, but so is another mode."""
    CERTAIN = 3
    """It is consistent, and no other mode is."""
    UNKNOWN = 4
    """Rounding error prevents a decision, which is possible in space only and not for the equilibrium."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class BodyStatics(Record):
    """Equilibrium of a body at rest.

    Attributes:
        equilibrium: Whether the body stays at rest.
        jammed: Whether friction alone keeps the body at rest.
        wedged: Whether the contacts can press against each other without an applied wrench, or None if
            rounding error prevents a decision.
        stable_disturbance: N. Equilibrium remains possible under every change of the wrench up to this size.
            It is infinite if equilibrium is possible under every wrench (force closure), and NaN without
            equilibrium. If it is infinite and ``equilibrium`` is POSSIBLE, contact forces can balance any
            wrench, but only if the contacts press against each other strongly enough (a wedged body).
            Rigid-body mechanics does not determine that force, so the body may also move.
        margin_length: m. The size of a change is the root of |f|^2 + (moment / length)^2 with this length.
    """

    equilibrium: Certainty
    jammed: Certainty
    wedged: bool | None
    stable_disturbance: float
    margin_length: float

    def is_stable_against(self, disturbance: float) -> bool:
        """Return whether equilibrium remains possible under every change of the wrench up to this size, N."""
        return self.stable_disturbance >= check_not_negative("disturbance", disturbance)  # false for NaN


def does_turn(angular_acceleration: ArrayLike) -> bool:
    """Return whether an angular acceleration, rad/s^2, of any shape is more than rounding."""
    return bool(np.abs(angular_acceleration).max() > TURNS)


def motion_in_words(mode: AnyMode) -> str:
    """Return what the body does in a mode (`letters.mode_in_words`)."""
    turns = None  # the motion of a mechanism has no angular accelerations
    if isinstance(mode, PlanarMode):
        turns = does_turn(mode.angular_acceleration)
    elif isinstance(mode, SpatialMode):
        turns = does_turn(mode.angular_acceleration_W)
    elif isinstance(mode, BodiesMode):
        turns = does_turn(mode.angular_accelerations_W)
    return mode_in_words(mode.mode, turns=turns)


class AnyMode(Record):
    """Consistent mode in the plane or in space, with text summaries."""

    __slots__ = ()
    mode: str
    forces_unique: bool

    @property
    def words(self) -> tuple[str, ...]:
        """Return the motion of each contact.

        It is "separates", "stays fixed", "slides", "slides left" or "slides right".
        """
        return tuple(LETTERS[letter][0] for letter in self.mode)

    def in_short(self) -> str:
        """Return the letters, a text label of the motion, and whether other forces cause it too."""
        words = f"{type(self).__name__} {self.mode}: {motion_in_words(self)}"
        return "; ".join([words, *shared_forces([self])])


class AnyModeAnswer(Record):
    """Answer in the plane or in space, with a text summary."""

    __slots__ = ()
    verdict: ModeVerdict
    modes: Sequence[AnyMode]

    def in_short(self) -> str:
        """Return the verdict, text labels of the first modes, and which modes have no unique forces."""
        shown = [f"{mode.mode}: {motion_in_words(mode)}" for mode in self.modes[:_SHOWN]]
        more = [f"{len(self.modes) - _SHOWN} more"] if len(self.modes) > _SHOWN else []
        words = [*shown, *more, *shared_forces(self.modes)]
        return f"{type(self).__name__}: {self.verdict}{', ' if words else ''}{'; '.join(words)}"


def shared_forces(modes: Iterable[AnyMode]) -> list[str]:
    """Return the sentence about modes whose forces are not unique, if there are any."""
    shared = [mode.mode for mode in modes if not mode.forces_unique]
    return [f"the contact forces of {', '.join(shared)} are not unique"] if shared else []


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarMode(AnyMode):
    """Consistent mode, with its accelerations and contact forces.

    Attributes:
        mode: One letter for each contact.
        acceleration: Acceleration of the centre of mass, m/s^2.
        angular_acceleration: rad/s^2.
        contact_forces: Force (f_t, f_n) on the body at each contact, N.
        contact_accelerations: Acceleration (a_t, a_n) of the body's point at each contact relative to the
            surface, m/s^2.
        forces_unique: Whether no other contact forces are possible in this mode.
        motion_unique: Whether no other accelerations are possible in this mode.
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
    """Answer to a `PlanarContactProblem`.

    Attributes:
        verdict: Verdict on all contacts together.
        modes: All consistent modes.
        refused: Modes that are kinematically possible but not consistent, each with the reason.
        approaching: Indices of the approaching contacts. Empty unless the verdict is IMPACT.
        contact_velocities: Velocity (v_t, v_n) of the body's point at each contact relative to the surface,
            m/s. Components within the tolerance are 0.
        velocity_tolerance: m/s. Velocities of contacts up to this size count as zero.
        acceleration_tolerance: m/s^2. Accelerations of the centre of mass up to this size count as zero.
        undecided: The undecided cases and the reason. Empty unless the verdict is UNDECIDED.
        undecided_modes: Kinematically possible modes that are neither consistent nor refused.
        within: Verdicts that occur within the problem's uncertainty, or None without an uncertainty.
        problem: The `PlanarContactProblem`.
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
        """Return all kinematically possible modes, in alphabetical order."""
        consistent = [found.mode for found in self.modes]
        refused = [found.mode for found in self.refused]
        return tuple(sorted([*consistent, *refused, *self.undecided_modes]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResponseMode(AnyMode):
    """Consistent mode in space, with the forces and accelerations of its contacts, in world axes.

    Attributes:
        mode: One letter for each contact: s, f or c.
        contact_forces_W: (n, 3), N, contact forces on the body into which the normals point.
        contact_accelerations_W: (n, 3), m/s^2, accelerations of the contact points relative to the surfaces,
            in their axes, which turn with them.
        tangential_directions_W: (n, 3), unit direction in which each contact slides on its surface, or zero
            if it does not slide.
        misdirection: rad, largest angle between friction and the direction opposite to sliding. It is at the
            level of rounding error, unless the problem's ``sharpen`` is false.
        forces_unique: Whether no other contact forces are possible in this mode.
        motion_unique: Whether no other accelerations are possible in this mode.
    """

    mode: str
    contact_forces_W: FloatArray
    contact_accelerations_W: FloatArray
    tangential_directions_W: FloatArray
    misdirection: float
    forces_unique: bool
    motion_unique: bool


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialMode(ResponseMode):
    """Consistent mode of a body in space, with its accelerations and contact forces, in world axes.

    Attributes:
        acceleration_W: (3,), m/s^2, acceleration of the centre of mass.
        angular_acceleration_W: (3,), rad/s^2.

    The others are those of `ResponseMode`.
    """

    acceleration_W: FloatArray
    angular_acceleration_W: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesMode(ResponseMode):
    """Consistent mode of several bodies, with their accelerations and contact forces, in world axes.

    Attributes:
        accelerations_W: (k, 3), m/s^2, accelerations of the centres of mass.
        angular_accelerations_W: (k, 3), rad/s^2.

    The others are those of `ResponseMode`.
    """

    accelerations_W: FloatArray
    angular_accelerations_W: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResponseModeAnswer(AnyModeAnswer):
    """Answer to a `ResponseContactProblem`.

    Attributes:
        verdict: Verdict on all contacts together.
        modes: All consistent modes, sorted by their letters: separating, then sticking, then sliding.
        approaching: Indices of the approaching contacts. Empty unless the verdict is IMPACT.
        velocity_tolerance: m/s. Velocities of contacts up to this size count as zero.
        examined: Number of cases that were tried, each with one letter or a group of letters.
        undecided: The undecided cases and the reason. Empty unless the verdict is UNDECIDED.
        undecided_modes: Letters of modes that could be neither found nor refuted.
        flush_within: As in `SpatialModeAnswer`. It is 0 for a mechanism, whose contacts have no positions.
        problem: The problem.
    """

    verdict: ModeVerdict
    modes: tuple[ResponseMode, ...]
    approaching: tuple[int, ...]
    velocity_tolerance: float
    examined: int
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    flush_within: float = 0.0
    problem: Record = field(repr=False)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesModeAnswer(ResponseModeAnswer):
    """Answer to a `BodiesContactProblem`, whose fields are those of `ResponseModeAnswer`."""

    modes: tuple[BodiesMode, ...]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialModeAnswer(AnyModeAnswer):
    """Answer to a `SpatialContactProblem`.

    Refused modes are not listed, because there is one for each cell in the arrangement of all sliding
    directions, and the search refutes whole groups. `refused_modes` returns the reason for each choice of
    separating contacts.

    Attributes:
        verdict: Verdict on all contacts together.
        modes: All consistent modes, sorted by their letters: separating, then sticking, then sliding.
        approaching: Indices of the approaching contacts. Empty unless the verdict is IMPACT.
        velocity_tolerance: m/s. Velocities of contacts up to this size count as zero.
        friction_facets: Number of edges of each friction pyramid.
        examined: Number of cases that were tried, each with one letter or a group of letters.
        undecided: The undecided cases and the reason. Empty unless the verdict is UNDECIDED.
        undecided_modes: Letters of modes that could be neither found nor refuted.
        flush_within: rad, or relative to the largest lever arm. The modes are those of contacts whose normals
            and positions differ by at most this from the given ones, in which nearly flush contacts are
            exactly flush (`spatial.problem`). It is 0 if the modes are those of the given contacts.
        within: Verdicts that occur within the problem's uncertainty, or None without an uncertainty.
        problem: The `SpatialContactProblem`.
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
