"""Which contacts separate, slide or stay? All answers that mechanics allows (lecture 26)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    BodyStatics,
    ModeVerdict,
    RefusedMode,
    SpatialMode,
    SpatialModeMargin,
    SpatialWrenchSet,
)
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.knowledge import check_optional
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.settled_impact import SettledImpact
from contact_dynamics.questions.subject import NEWEST, StateSource
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray, check_array
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MOST_FRICTION_FACETS: Final = 32
"""More edges of a friction pyramid are refused: 32 hold 99.5 % of the round cone, and more cost more."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactModeQuestion(Record):
    """Which contacts separate, slide or stay, under an applied wrench?

    Attributes:
        body: The body, or the name of one of the known world.
        state: Its state, or which published one.
        contacts: The contacts. None: those of the body's shape with the known world's surfaces.
        force_W: (3,), N, applied besides gravity and contact forces, world axes.
        torque_W: (3,), N m, applied about the centre of mass, world axes.
        gravity_W: (3,), m/s^2, world axes. None: that of the known world.
        problem: In a plane of motion, in space, or whichever suits.
        plane: The plane of motion. None: the one that fits best.
        out_of_plane_tolerance: m/s, >= 0. Motion out of the plane up to this counts as planar. None: the
            default.
        velocity_tolerance: m/s, >= 0. A contact that is slower counts as at rest. None: the default.
        distance_tolerance: m, >= 0. A body with a smaller gap touches. None: the default.
        friction_facets: Space: edges, 3 to 32, of the pyramid that stands for a cone at rest. Zero: 8, and 4
            in wrench sets.
        margin_length: m, makes a torque comparable with a force in margins and statics. None or zero: the
            radius of gyration.
        want_margins: Whether to tell how far the wrench is from another mode.
        want_wrenches: Whether to tell the applied wrenches of every kinematically possible mode.
        want_statics: Whether to answer the static questions.
        want_impact: Whether to resolve the impact that settles an inconsistency or an approach.

    Raises:
        InvalidFieldError: a number is out of its range or not finite.
    """

    body: Body | str
    state: StateSource = NEWEST
    contacts: ContactSet | None = None
    force_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    torque_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    gravity_W: FloatArray | None = None
    problem: Problem = Problem.AUTOMATIC
    plane: PlaneOfMotion | None = None
    out_of_plane_tolerance: float | None = None
    velocity_tolerance: float | None = None
    distance_tolerance: float | None = None
    friction_facets: int = 0
    margin_length: float | None = None
    want_margins: bool = False
    want_wrenches: bool = False
    want_statics: bool = False
    want_impact: bool = False

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            body: Body | str,
            state: StateSource = ...,
            contacts: ContactSet | None = ...,
            force_W: ArrayLike = ...,
            torque_W: ArrayLike = ...,
            gravity_W: ArrayLike | None = ...,
            problem: Problem = ...,
            plane: PlaneOfMotion | None = ...,
            out_of_plane_tolerance: float | None = ...,
            velocity_tolerance: float | None = ...,
            distance_tolerance: float | None = ...,
            friction_facets: int = ...,
            margin_length: float | None = ...,
            want_margins: bool = ...,
            want_wrenches: bool = ...,
            want_statics: bool = ...,
            want_impact: bool = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check what has no type of its own."""
        object.__setattr__(self, "force_W", check_array("force_W", self.force_W, (3,)))
        object.__setattr__(self, "torque_W", check_array("torque_W", self.torque_W, (3,)))
        if self.gravity_W is not None:
            object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        for name in ("out_of_plane_tolerance", "velocity_tolerance", "distance_tolerance"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)))
        object.__setattr__(self, "margin_length", check_optional("margin_length", self.margin_length) or None)
        if self.friction_facets != 0 and not 3 <= self.friction_facets <= MOST_FRICTION_FACETS:
            allowed = f"0, or a whole number from 3 to {MOST_FRICTION_FACETS}"
            raise InvalidFieldError("friction_facets", self.friction_facets, allowed)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactModeAnswer(Record):
    """What the contacts do: the verdict, all consistent modes with their evidence, and what else was asked.

    All vectors are in world axes, also those of a planar problem. Its modes have no
    ``tangential_directions_W`` (the letters l and r say which way), its wrench sets no ``sliding_from_W``.

    Attributes:
        body_name: The body's name; empty where it has none.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: The state that was taken.
        contacts: The contacts.
        verdict: The verdict on the whole contact set.
        modes: All consistent modes. In a plane mirrored contacts share their forces equally.
        margins: How far the wrench is from leaving each of these modes, in their order. None: not asked for.
        approaching: Contacts that approach, as indices.
        contact_velocities_W: (n, 3), m/s, of the body's points, with what is within tolerance as zero.
        refused: Modes that are possible kinematically and refused by mechanics. Space: told with margins.
        kinematic_modes: Every kinematically possible mode. Space: strings of s and c alone.
        wrench_sets: The applied wrenches of each mode. None: not asked for.
        statics: What holds the body at rest. None: not asked for.
        settled: The impact that settles the case, and the modes after it. None: not asked for, or not needed.
        problem: PLANAR or SPATIAL.
        plane: The plane of motion. None: space.
        out_of_plane: m/s, the largest motion out of the plane. NaN in space.
        out_of_plane_reason: What left the plane, so that AUTOMATIC came to SPATIAL. Empty otherwise.
        velocity_tolerance: m/s, that was used.
        acceleration_tolerance: m/s^2, that was used. NaN in space.
        distance_tolerance: m, that was used.
        friction_facets: Space: edges of each friction pyramid in the modes. Zero in the plane.
        wrench_facets: Space: edges of each friction pyramid in the wrench sets. Zero: not asked for.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    contacts: ContactSet
    verdict: ModeVerdict
    modes: tuple[SpatialMode, ...]
    margins: tuple[SpatialModeMargin, ...] | None
    approaching: tuple[int, ...]
    contact_velocities_W: FloatArray
    refused: tuple[RefusedMode, ...]
    kinematic_modes: tuple[str, ...]
    wrench_sets: tuple[SpatialWrenchSet, ...] | None
    statics: BodyStatics | None
    settled: SettledImpact | None
    problem: Problem
    plane: PlaneOfMotion | None
    out_of_plane: float
    out_of_plane_reason: str
    velocity_tolerance: float
    acceleration_tolerance: float
    distance_tolerance: float
    friction_facets: int
    wrench_facets: int
