"""The question about contact modes: which contacts separate, slide or stay?"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.context import check_optional
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.subject import NEWEST, StateSource
from contact_dynamics.records import Record
from contact_dynamics.validation import FloatArray, check_array, check_positive, check_whole
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MAX_FRICTION_FACETS: Final = 32
"""A friction pyramid may have at most this many edges. With 32 it holds 99.5 % of the round cone."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactModeQuestion(Record):
    """Which contacts separate, slide or stay, under an applied wrench?

    Attributes:
        body: The body, or the name of one of the known world.
        state: Its state, or a reference to a published one.
        contacts: The contacts. If it is None, they are found from the body's shape and the known world's
            surfaces.
        force_W: (3,), N, applied besides gravity and contact forces, world axes.
        torque_W: (3,), N m, applied about the centre of mass, world axes.
        gravity_W: (3,), m/s^2, world axes. If it is None, the known world's gravity acts.
        problem: Whether to solve the problem in a plane of motion, in space, or in whichever suits.
        plane: The plane of motion. If it is None, the best fitting plane is found.
        out_of_plane_tolerance: m/s, >= 0. Motion out of the plane up to this counts as planar. None means the
            default.
        velocity_tolerance: m/s, >= 0. A slower contact counts as at rest. None means the default.
        distance_tolerance: m, >= 0. A body with a smaller gap touches. None means the default.
        friction_facets: Number of edges, 3 to 32, of the pyramid that stands for a friction cone at rest in
            space, in margins, statics and wrench sets. None means 8 edges, and 4 in the wrench sets. The
            modes do not depend on it.
        margin_length: m, > 0. A torque divided by this length compares with a force in margins and statics.
            If it is None, the radius of gyration serves.
        include_margins: Whether the answer says how far the wrench is from another mode.
        include_wrenches: Whether the answer has the applied wrenches of every kinematically possible mode.
        include_statics: Whether the static questions are answered too.
        include_impact: Whether the impact is resolved that settles an inconsistency or an approach.
        uncertainty: How far the true contacts may be from the contacts. If they are not known exactly, the
            answer says which verdicts occur.
        include_geometry_margins: Whether the answer has the distance of the contacts from another verdict or
            mode.
        include_probabilities: Whether the answer has the probability of each mode by the noise of the state,
            which must have a covariance.

    Raises:
        InvalidFieldError: a number is out of its range or not finite, or the problem is not a `Problem`.
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
    friction_facets: int | None = None
    margin_length: float | None = None
    include_margins: bool = False
    include_wrenches: bool = False
    include_statics: bool = False
    include_impact: bool = False
    uncertainty: ContactUncertainty = EXACT_CONTACTS
    include_geometry_margins: bool = False
    include_probabilities: bool = False

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
            friction_facets: int | None = ...,
            margin_length: float | None = ...,
            include_margins: bool = ...,
            include_wrenches: bool = ...,
            include_statics: bool = ...,
            include_impact: bool = ...,
            uncertainty: ContactUncertainty = ...,
            include_geometry_margins: bool = ...,
            include_probabilities: bool = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check the vectors, the numbers and the choice of the problem."""
        object.__setattr__(self, "force_W", check_array("force_W", self.force_W, (3,)))
        object.__setattr__(self, "torque_W", check_array("torque_W", self.torque_W, (3,)))
        if self.gravity_W is not None:
            object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        for name in ("out_of_plane_tolerance", "velocity_tolerance", "distance_tolerance"):
            object.__setattr__(self, name, check_optional(name, getattr(self, name)))
        if self.margin_length is not None:
            object.__setattr__(self, "margin_length", check_positive("margin_length", self.margin_length))
        if self.friction_facets is not None:
            facets = check_whole("friction_facets", self.friction_facets, 3, MAX_FRICTION_FACETS)
            object.__setattr__(self, "friction_facets", facets)
