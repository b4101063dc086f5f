# SPDX-License-Identifier: Apache-2.0
"""Where will a free body be? Torque-free tumbling, or motion under a wrench and drag (lectures 24 and 25)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.touches import gap_between, lowest_along
from contact_dynamics.errors import TooLargeError
from contact_dynamics.motion.covariance import CarriedCovariance, covariance_along
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag
from contact_dynamics.motion.integrated import ForcedMotion, Method, motion_of
from contact_dynamics.motion.integrated_fit import fit_motion
from contact_dynamics.questions.context import Context
from contact_dynamics.questions.sample_times import (
    MAX_INTEGRATED_STEPS,
    AtRate,
    Event,
    Sampling,
    UntilContact,
    check_turns,
    times_of,
)
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.subject import (
    NEWEST,
    FitQuality,
    StateSource,
    Subject,
    covariance_of,
    kept_fit,
    subject_of,
)
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.tumbling import FreeMotion, Trajectory, free_motion
from contact_dynamics.tumbling.flips import Flips, next_flips
from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves, poinsot, rolling_curves
from contact_dynamics.validation import FloatArray, check_array, check_whole
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.motion.free_fit import FitResult
    from contact_dynamics.motion.integrated import ChosenMotion
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.shapes.convex import ConvexShape

FLIPS: Final = 3  # number of next flips in an answer

MAX_COVARIANCES: Final = 2000
"""Largest number of samples with covariances in one answer. More would stall the middleware."""

MAX_CARRIED_TURNS: Final = 30.0
"""Longest motion under torque or drag with covariances, in turns. It takes 1 or 2 s of computing."""

_SAMPLES_TRIED: Final = 50
"""Samples beside an obstacle at which its gap to the body is computed."""

MAX_CURVE_POINTS: Final = 10_000
"""Largest number of points of polhode and herpolhode in one answer. More would stall the middleware."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TumblingQuestion(Question["TumblingAnswer"]):
    """Question about the free motion of a body.

    Attributes:
        body: The body, or the name of a body of the context's world.
        state: State of the body, with or without a covariance, or a reference to a published state.
        sampling: Times of the samples. The default is the default sample rate over the default horizon.
        gravity_W: (3,), m/s^2, world axes. None means the gravity of the context's world.
        wrench: Constant wrench in addition to gravity.
        drag: Drag in still air.
        include_covariance: Whether the answer contains the state's covariance at each sample. It contains no
            standard deviation of the time of an event.
        curve_points: Number of points of polhode and herpolhode in the answer, at most `MAX_CURVE_POINTS`.

    Raises:
        InvalidFieldError: gravity is not three finite numbers.
        TooLargeError: the number of points of the curves is too large.
    """

    body: Body | str
    state: StateSource = NEWEST
    sampling: Sampling = field(default_factory=AtRate)
    gravity_W: FloatArray | None = None
    wrench: ConstantWrench = NO_WRENCH
    drag: Drag = NO_DRAG
    include_covariance: bool = False
    curve_points: int = 0

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            body: Body | str,
            state: StateSource = ...,
            sampling: Sampling = ...,
            gravity_W: ArrayLike | None = ...,
            wrench: ConstantWrench = ...,
            drag: Drag = ...,
            include_covariance: bool = ...,
            curve_points: int = ...,
        ) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check gravity and the number of points."""
        if self.gravity_W is not None:
            object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        points = check_whole("curve_points", self.curve_points, 0)
        if points > MAX_CURVE_POINTS:
            raise TooLargeError("curve_points", points, f"at most {MAX_CURVE_POINTS}")
        object.__setattr__(self, "curve_points", points)

    @property
    def detects_contacts(self) -> bool:
        """Whether the motion ends at the first contact."""
        return isinstance(self.sampling, UntilContact)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TumblingAnswer(Answer):
    """Predicted motion of a free body, and properties of its rotation.

    Attributes:
        body_name: Name of the body, which may be empty.
        p_FB_F: (3,), m, centre of mass in the published frame F.
        state: State of the question. Times are relative to its stamp.
        fit: Quality of the fit to published states, or None without a fit.
        trajectory: Position of the centre of mass, orientation and velocities at the requested times.
        covariance: Covariance of the state at these times, or None if not requested.
        method: Whether the motion is exact or integrated.
        event: Event that ended the trajectory, or None if it contains all requested samples.
        poinsot: Poinsot's construction of the rotation, or None if a torque acts.
        flips: Next flips about the intermediate axis, or None if a torque acts.
        curves: Polhode and herpolhode, or None if not requested or if a torque acts.
        warnings: Planes and obstacles that the body would penetrate at some of the times, since the motion is
            not stopped by contacts, and uncertain motions of carried surfaces.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    fit: FitQuality | None
    trajectory: Trajectory
    covariance: CarriedCovariance | None
    method: Method
    event: Event | None
    poinsot: Poinsot | None
    flips: Flips | None
    curves: RollingCurves | None
    warnings: tuple[str, ...] = ()

    @property
    def predicted_motion(self) -> Trajectory:
        """Return the motion at the requested times."""
        return self.trajectory


def answer(question: TumblingQuestion, context: Context | None = None) -> TumblingAnswer:
    """Answer a question about tumbling. Without ``context``, no named bodies and no surfaces exist.

    Raises:
        ContactDynamicsError: the question refers to something unknown, or is invalid. The message names it.
    """
    known = Context() if context is None else context
    forces = _Forces(
        gravity_W=known.world.gravity_W if question.gravity_W is None else question.gravity_W,
        wrench=question.wrench,
        drag=question.drag,
    )
    subject = subject_of(question.body, question.state, known, fit=forces.fit)
    motion, method = forces.motion(subject.body.mass_properties, subject.state)
    times, event = times_of(question.sampling, subject, motion, known)
    picture, flips, curves = _rotation(question, subject, motion)
    trajectory = motion.at(times)
    return TumblingAnswer(
        body_name=subject.body.name,
        p_FB_F=subject.body.p_FB_F,
        state=subject.state,
        fit=subject.fit,
        trajectory=trajectory,
        covariance=_covariance(subject, motion, times) if question.include_covariance else None,
        method=method,
        event=event,
        poinsot=picture,
        flips=flips,
        curves=curves,
        warnings=(*(known.notes or ()), *_passed(subject.body, trajectory, known)),
    )


def _passed(body: Body, trajectory: Trajectory, known: Context) -> tuple[str, ...]:
    """Return a warning for each plane and obstacle that the body would be in at some time."""
    if body.shape.is_empty:
        return ()
    found, R_WB, tolerance = [], matrices_of(trajectory.q_WB), known.defaults.distance_tolerance
    for surface in known.world.surfaces:
        if isinstance(surface, Obstacle):
            gaps = _gaps_to(surface, body.shape, trajectory.p_WB_W, R_WB, tolerance)
        elif surface.is_steady:
            normal_W = surface.normal_W
            gaps = lowest_along(body.shape, trajectory.p_WB_W, R_WB, normal_W) - normal_W @ surface.p_WS_W
        else:
            continue
        deep = gaps < -tolerance
        if deep.any():
            first = int(deep.argmax())
            found.append(
                f"free flight ignores surfaces: at sample {first} {body.name!r} would be "
                f"{-gaps[first]:.3g} m deep in {surface.name!r}"
            )
    return tuple(found)


def _gaps_to(
    obstacle: Obstacle, shape: ConvexShape, p_WB_W: FloatArray, R_WB: FloatArray, tolerance: float
) -> FloatArray:
    """Return gaps between a body and an obstacle, (n,), m, which are exact up to the first one below zero.

    The obstacle's faces separate most poses. At the others, the shapes are compared.
    """
    gaps = np.full(len(p_WB_W), -np.inf)
    for normal_W in obstacle.features.normals:
        level = float((obstacle.vertices_W @ normal_W).max())
        gaps = np.maximum(gaps, lowest_along(shape, p_WB_W, R_WB, normal_W) - level)
    near = np.flatnonzero(gaps < -tolerance)
    gaps[near[_SAMPLES_TRIED:]] = 0.0
    for i in near[:_SAMPLES_TRIED].tolist():
        gaps[i] = gap_between(shape, p_WB_W[i], R_WB[i], obstacle)
        if gaps[i] < -tolerance:
            break
    return gaps


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Forces:
    """What acts on the body."""

    gravity_W: FloatArray
    wrench: ConstantWrench
    drag: Drag

    def motion(self, body: MassProperties, state: BodyState) -> ChosenMotion:
        """Return the motion from a state on."""
        return motion_of(
            body,
            state,
            gravity_W=self.gravity_W,
            wrench=self.wrench,
            drag=self.drag,
            max_steps=MAX_INTEGRATED_STEPS,
        )

    def fit(self, body: MassProperties, states: Sequence[BodyState]) -> FitResult:
        """Return the motion that fits states best."""
        if self.wrench is NO_WRENCH and self.drag is NO_DRAG:
            return kept_fit(body, states, gravity_W=self.gravity_W)
        return fit_motion(
            body,
            states,
            gravity_W=self.gravity_W,
            wrench=self.wrench,
            drag=self.drag,
            max_steps=MAX_INTEGRATED_STEPS,
        )


def _rotation(
    question: TumblingQuestion, subject: Subject, motion: FreeMotion | ForcedMotion
) -> tuple[Poinsot | None, Flips | None, RollingCurves | None]:
    """Return Poinsot's picture of a rotation, its next flips and its curves. Under a torque all are None."""
    if isinstance(motion, ForcedMotion):
        if not motion.rotates_freely:
            return None, None, None
        motion = free_motion(motion.body, motion.state)
    count = question.curve_points
    return (
        poinsot(motion),
        next_flips(motion, FLIPS, covariance=subject.covariance),
        rolling_curves(motion, count) if count else None,
    )


def _covariance(subject: Subject, motion: FreeMotion | ForcedMotion, times: FloatArray) -> CarriedCovariance:
    if len(times) > MAX_COVARIANCES:
        raise TooLargeError("times", f"{len(times)} samples with covariances", f"at most {MAX_COVARIANCES}")
    if isinstance(motion, ForcedMotion):
        check_turns("times", motion, times, MAX_CARRIED_TURNS, "with covariances under torque or drag")
    return covariance_along(motion, covariance_of(subject), times)
