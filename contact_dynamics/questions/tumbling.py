"""Where will a free body be? Torque-free tumbling, or motion under a wrench and drag (lectures 24 and 25)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import TooLargeError
from contact_dynamics.motion.covariance import CarriedCovariance
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH, ConstantWrench, Drag
from contact_dynamics.motion.integrated import Method
from contact_dynamics.questions.sample_times import AtRate, Event, Sampling
from contact_dynamics.questions.subject import NEWEST, FitQuality, StateSource
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.tumbling.flips import Flips
from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
from contact_dynamics.validation import FloatArray, check_array
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MOST_CURVE_POINTS: Final = 10_000
"""Longest polhode and herpolhode in one answer. More would stall the middleware."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TumblingQuestion(Record):
    """Where will a body be that nothing touches?

    Attributes:
        body: The body, or the name of one of the known world.
        state: Its state, with a covariance or without, or which published one.
        sampling: At which times. By default at the default rate over the default horizon.
        gravity_W: (3,), m/s^2, world axes. None: that of the known world.
        wrench: A wrench that acts all along, besides gravity.
        drag: Drag in still air.
        want_covariance: Whether to carry the state's covariance along.
        curve_points: How many points of polhode and herpolhode to tell, at most `MOST_CURVE_POINTS`. Zero:
            none.

    Raises:
        InvalidFieldError: gravity is not three finite numbers.
        TooLargeError: too many points of the curves.
    """

    body: Body | str
    state: StateSource = NEWEST
    sampling: Sampling = field(default_factory=AtRate)
    gravity_W: FloatArray | None = None
    wrench: ConstantWrench = NO_WRENCH
    drag: Drag = NO_DRAG
    want_covariance: bool = False
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
            want_covariance: bool = ...,
            curve_points: int = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check what has no type of its own."""
        if self.gravity_W is not None:
            object.__setattr__(self, "gravity_W", check_array("gravity", self.gravity_W, (3,)))
        if self.curve_points > MOST_CURVE_POINTS:
            raise TooLargeError("curve_points", self.curve_points, f"at most {MOST_CURVE_POINTS}")


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TumblingAnswer(Record):
    """Where the body will be.

    Attributes:
        body_name: The body's name; empty where it has none.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: The state that was taken; times count from its stamp.
        fit: How well the motion fits the published states that the state was found from. None: no fit.
        trajectory: The centre of mass, the orientation and the velocities at the times asked for.
        covariance: The state's covariance at these times. None: not asked for.
        method: Whether the motion is exact or integrated.
        event: What ended the trajectory. None: nothing did, all samples asked for are there.
        poinsot: The rotation as Poinsot saw it. None: a torque acts, so that his picture does not apply.
        flips: The next flips of the middle axis. None: as for ``poinsot``.
        curves: Polhode and herpolhode. None: not asked for, or as for ``poinsot``.
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
