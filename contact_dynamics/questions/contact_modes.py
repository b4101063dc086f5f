# SPDX-License-Identifier: Apache-2.0
"""Which contacts separate, slide or stay? All answers that mechanics allows (lecture 26)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.noise import possible_motions
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact.velocities import spatial_contact_velocities
from contact_dynamics.contact_modes import (
    BodyStatics,
    GeometryMargin,
    ModeVerdict,
    PlanarContactProblem,
    RefusedMode,
    SpatialMode,
    SpatialModeMargin,
    SpatialWrenchSet,
    VerdictsWithin,
    contact_modes,
    geometry_margins,
    mode_margins,
    refused_modes,
    spatial_kinematic_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.contact_modes.letters import SLIDES_LEFT, SLIDES_RIGHT, STAYS, STICKS
from contact_dynamics.contact_modes.planar.problem import MAX_PLANAR_CONTACTS
from contact_dynamics.contact_modes.result import ModeProbability
from contact_dynamics.contact_modes.spatial.problem import FRICTION_FACETS
from contact_dynamics.contact_modes.spatial.wrench_sets import WRENCH_FACETS
from contact_dynamics.errors import OutOfPlaneError, TooLargeError
from contact_dynamics.plane.lifting import check_mirrored, mirror_partners
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.context import Context, Problem, check_optional, check_read, or_default
from contact_dynamics.questions.extent import check_contacts, check_extent, check_margin_length, check_wrench
from contact_dynamics.questions.plane_of_motion import (
    lifted_margin,
    lifted_mode,
    lifted_vectors,
    lifted_wrench_set,
    planar_problem_of,
)
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.settled_impact import (
    ModeCase,
    SettledImpact,
    settled_in_plane,
    settled_in_space,
)
from contact_dynamics.questions.subject import NEWEST, StateSource, covariance_of, subject_of
from contact_dynamics.questions.touching import (
    flush_rim,
    friction_in_tosses,
    in_contact,
    outside_shape,
    without_contacts,
)
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tolerances import FLUSH, FLUSH_ROUGHLY
from contact_dynamics.validation import FloatArray, check_array, check_positive, check_whole
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.contact.noise import NoisyState
    from contact_dynamics.plane.projection import PlanarProblem

MAX_FRICTION_FACETS: Final = 32
"""A friction pyramid may have at most this many edges. With 32 it holds 99.5 % of the round cone."""

MAX_UNCERTAIN_CONTACTS: Final = 16
"""Largest number of uncertain contacts in a question. It takes dozens of samples of some 50 ms each."""

LEAST_PROBABILITY: Final = 0.01
"""Motions that are rarer by the noise of a state are left out of the probabilities."""

IMPACT: Final = ""  # the mode in the probabilities if a contact approaches

_MOVING: Final = "contacts must have surfaces at rest in a plane of motion, got surfaces that move"

_UNCERTAIN: Final = (
    "contacts must be exact to be in a plane, got uncertain points or normals, whose errors may leave it"
)

TAKEN_AS_FLUSH: Final = (
    f"contacts are taken as flush to within {FLUSH_ROUGHLY:g} (rad, or parts of the reach): "
    "for the stated contacts the verdict is undecided"
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactModeQuestion(Question["ContactModeAnswer"]):
    """Question about the contact modes of a body under an applied wrench.

    Attributes:
        body: The body, or the name of a body of the context's world.
        state: State of the body, or a reference to a published state.
        contacts: Contacts. If it is None, they are detected from the body's shape and the surfaces of the
            context's world.
        force_W: (3,), N, applied force in addition to gravity and contact forces, world axes. The default is
            zero.
        torque_W: (3,), N m, applied torque about the centre of mass, world axes. The default is zero.
        gravity_W: (3,), m/s^2, world axes. None means the gravity of the context's world.
        problem: Whether to solve a planar or a spatial problem, or to choose automatically.
        plane: Plane of motion. If it is None, the plane that fits best is used.
        out_of_plane_tolerance: m/s, >= 0. Largest motion out of the plane that counts as planar. None means
            the default.
        velocity_tolerance: m/s, >= 0. Speed below which a contact counts as at rest. None means the default.
        distance_tolerance: m, >= 0. Largest gap at which a body counts as touching. None means the default.
        friction_facets: Number of edges, 3 to 32, of the pyramid that approximates the friction cone of a
            contact at rest, in statics and wrench sets of spatial problems. None means 8 edges, and 4 in
            wrench sets. Modes, verdicts and margins do not depend on it.
        margin_length: m, > 0. Length that makes torque comparable with force in margins and statics. None
            means the radius of gyration.
        include_margins: Whether the answer contains the margin of each mode.
        include_wrenches: Whether the answer contains the applied wrenches of every kinematically possible
            mode.
        include_statics: Whether the answer contains statics.
        include_impact: Whether to resolve the impact that follows from an inconsistency or an approach.
        uncertainty: Errors of the contacts. If they are not exact, the answer lists the verdicts that occur
            within these errors.
        include_geometry_margins: Whether the answer contains the errors of the contacts that change the
            verdict or mode.
        include_probabilities: Whether the answer contains the probability of each mode under the noise of the
            state, which must have a covariance.

    Raises:
        InvalidFieldError: a number is out of range or not finite, the problem is not a `Problem`, or a value
            would be ignored.
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
            """Accept everything that NumPy converts to arrays."""

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
        self._check_all_are_read()

    def _check_all_are_read(self) -> None:
        """Raise `InvalidFieldError` for a value that would be ignored."""
        is_planar, is_spatial = self.problem is Problem.PLANAR, self.problem is Problem.SPATIAL
        is_measured = self.include_margins or self.include_statics
        in_plane = {"plane": self.plane, "out_of_plane_tolerance": self.out_of_plane_tolerance}
        check_read("problem is PLANAR", is_met=not is_spatial, **in_plane)
        check_read("problem is SPATIAL", is_met=not is_planar, friction_facets=self.friction_facets)
        flags = "include_margins or include_statics is true"
        check_read(flags, is_met=is_measured, margin_length=self.margin_length)

    @property
    def detects_contacts(self) -> bool:
        """Whether the contacts are not given."""
        return self.contacts is None


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactModeAnswer(Answer):
    """Verdict, all consistent modes with forces and accelerations, and the requested further results.

    All vectors are in world axes, also those of a planar problem. The modes of a planar problem have no
    ``tangential_directions_W``, because the letters l and r contain the direction, and its wrench sets no
    ``sliding_from_W``.

    Attributes:
        body_name: Name of the body, which may be empty.
        p_FB_F: (3,), m, centre of mass in the published frame F.
        state: State for which the question was answered.
        contacts: Contacts.
        verdict: Verdict on all contacts together.
        undecided: The undecided cases and the reason. Empty unless the verdict is UNDECIDED.
        modes: All consistent modes. In a plane, mirrored contacts share their forces equally.
        margins: Margin of each mode, in the order of the modes, or None if not requested.
        approaching: Indices of the approaching contacts.
        contact_velocities_W: (n, 3), m/s, velocities of the body's contact points. Components within the
            tolerance are zero.
        refused: Modes that are kinematically possible but not consistent. For spatial problems only with
            margins.
        kinematic_modes: All kinematically possible modes. For spatial problems: strings of s and c only.
        wrench_sets: Applied wrenches of each mode, or None if not requested.
        statics: Statics of the body at rest, or None if not requested.
        undecided_modes: Modes for which it is undecided whether they are consistent.
        within: Verdicts that occur within the uncertainty of the contacts, or None without an uncertainty.
        geometry_margins: Errors of the contacts that change the answer, or None if not requested.
        probabilities: Probability of each mode under the noise of the state, most probable first, or None if
            not requested. Modes below `LEAST_PROBABILITY` are omitted.
        settled: Impact that resolves the case, and the modes after it. None if not requested or not needed.
        problem: PLANAR or SPATIAL.
        plane: Plane of motion, or None for a spatial problem.
        out_of_plane: m/s, largest motion out of the plane, or NaN for a spatial problem.
        out_of_plane_reason: Quantity that leaves the plane, if AUTOMATIC chose SPATIAL for that reason. Empty
            otherwise.
        velocity_tolerance: m/s, tolerance that was used.
        acceleration_tolerance: m/s^2, tolerance that was used, or NaN for a spatial problem.
        distance_tolerance: m, tolerance that was used.
        friction_facets: Number of edges of each friction pyramid in statics, or zero for a planar problem.
        wrench_facets: Number of edges of each friction pyramid in the wrench sets of spatial problems, or
            zero if not requested.
        warnings: Texts about limited validity: a contact outside the body's shape, a surface that the body
            touches without an explicit contact, contacts treated as flush because the verdict would otherwise
            be undecided, margins that are NaN, margins in a plane that was chosen from the load, a flush rim
            that is represented by a few points, or a surface whose friction of sliding differs in tosses.
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
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    within: VerdictsWithin | None = None
    geometry_margins: tuple[GeometryMargin, ...] | None = None
    probabilities: tuple[ModeProbability, ...] | None = None
    warnings: tuple[str, ...] = ()


_SLIDING: Final = {SLIDES_LEFT, SLIDES_RIGHT, STAYS}
_LITTLE_FRICTION: Final = 0.01  # relative to the largest that the normal force allows

_IN_PLANE_ONLY: Final = (
    "margins and statics hold for wrench changes in the plane of motion; problem=SPATIAL has them for all",
)
"""The plane is found from the load and the motion, so a user need not know that the answer is planar."""


def answer(question: ContactModeQuestion, context: Context | None = None) -> ContactModeAnswer:
    """Answer a question about contact modes. Without ``context`` no body is known by name.

    Raises:
        ContactDynamicsError: nothing touches, a planar question leaves its plane, or something is asked for
            that is not known or not allowed. The message names it.
    """
    known = Context() if context is None else context
    case, noisy = _case(question, known)
    view, reason = _in_plane(question, case, known)
    found = _spatial_answer(question, case, reason) if view is None else _planar_answer(question, case, *view)
    body, state, contacts = case.subject.body, case.subject.state, case.contacts
    if question.contacts is not None:
        doubts = outside_shape(
            body,
            points_W=contacts.p_WC_W,
            p_WB_W=state.p_WB_W,
            R_WB=state.R_WB,
            distance_tolerance=case.distance_tolerance,
        )
        doubts += without_contacts(
            body, state, known.world, contacts.normals_W, distance_tolerance=case.distance_tolerance
        )
    else:
        at_rest = [mode.mode for mode in found.modes] == [STICKS * len(contacts)]
        has_loads = question.include_margins or question.include_statics or question.include_wrenches
        doubts = () if at_rest and not has_loads else flush_rim(body, contacts)
        uses = [0.0 if each else None for each in _uses_friction(found.modes, contacts)]
        doubts += friction_in_tosses(known.world, contacts, uses)
    doubts = (*(known.notes or ()), *doubts)
    found = replace(found, warnings=(*found.warnings, *doubts)) if doubts else found
    if not question.include_probabilities:
        return found
    if noisy is None:
        covariance_of(case.subject)  # there is none, which is an error
        return found
    return replace(found, probabilities=_probabilities(question, case, noisy, known))


def _uses_friction(modes: Sequence[SpatialMode], contacts: ContactSet) -> NDArray[np.bool_]:
    """Return whether each contact slides in one of the modes, or its surface holds the body by friction."""
    uses = np.zeros(len(contacts), dtype=bool)
    same = np.equal.outer(*[np.array(contacts.surfaces, dtype=object)] * 2)
    for mode in modes:
        forces_W = same.astype(float) @ mode.contact_forces_W  # those of one surface together
        normal = np.einsum("ij,ij->i", forces_W, contacts.normals_W)
        tangential = np.linalg.norm(forces_W - normal[:, None] * contacts.normals_W, axis=1)
        uses |= tangential > _LITTLE_FRICTION * contacts.frictions * normal
        uses |= [letter in _SLIDING for letter in mode.mode]
    return uses


def _probabilities(
    question: ContactModeQuestion, case: ModeCase, noisy: NoisyState, context: Context
) -> tuple[ModeProbability, ...]:
    """Return the modes of the states within the noise, with their probabilities, the most probable first."""
    alone = ContactModeQuestion(
        body=case.subject.body,
        contacts=case.contacts,
        force_W=question.force_W,
        torque_W=question.torque_W,
        gravity_W=question.gravity_W,
        problem=question.problem,
        plane=question.plane,
        out_of_plane_tolerance=question.out_of_plane_tolerance,
        velocity_tolerance=question.velocity_tolerance,
        distance_tolerance=question.distance_tolerance,
        friction_facets=question.friction_facets,
    )
    shares: dict[str, float] = {}
    for share, state in possible_motions(noisy, case.contacts, velocity_tolerance=case.velocity_tolerance):
        if share >= LEAST_PROBABILITY:
            found = answer(replace(alone, state=state), context)
            modes = {IMPACT} if found.verdict is ModeVerdict.IMPACT else {mode.mode for mode in found.modes}
            for mode in modes:
                shares[mode] = shares.get(mode, 0.0) + share
    ordered = sorted(shares.items(), key=lambda each: (-each[1], each[0]))
    return tuple(ModeProbability(mode=mode, probability=share) for mode, share in ordered)


def _case(question: ContactModeQuestion, context: Context) -> tuple[ModeCase, NoisyState | None]:
    """Look up all that a question names. The second value is the noisy state, if it has a covariance."""
    subject = subject_of(question.body, question.state, context)
    check_extent(subject.body.mass_properties, subject.state)
    defaults, world = context.defaults, context.world
    distance_tolerance = or_default(question.distance_tolerance, defaults.distance_tolerance)
    velocity_tolerance = or_default(question.velocity_tolerance, defaults.velocity_tolerance)
    subject, contacts, noisy = in_contact(
        question.contacts,
        subject,
        world,
        distance_tolerance=distance_tolerance,
        velocity_tolerance=velocity_tolerance,
        carriers=context.carrier_noise,
    )
    if len(contacts) > MAX_PLANAR_CONTACTS:
        raise TooLargeError("contacts", f"{len(contacts)} contacts", f"at most {MAX_PLANAR_CONTACTS}")
    check_contacts(contacts)
    if question.include_impact:
        _ = contacts.impact_restitutions
    question.uncertainty.check_count(len(contacts))
    is_hard = question.include_geometry_margins or not question.uncertainty.is_exact
    if is_hard and len(contacts) > MAX_UNCERTAIN_CONTACTS:
        allowed = f"at most {MAX_UNCERTAIN_CONTACTS} that are uncertain"
        raise TooLargeError("contacts", f"{len(contacts)} contacts", allowed)
    check_margin_length(question.margin_length)
    gravity_W = world.gravity_W if question.gravity_W is None else question.gravity_W
    force_W = question.force_W + subject.body.mass_properties.mass * gravity_W
    check_wrench(force_W, question.torque_W)
    case = ModeCase(
        subject=subject,
        contacts=contacts,
        force_W=force_W,
        torque_W=question.torque_W,
        velocity_tolerance=velocity_tolerance,
        distance_tolerance=distance_tolerance,
        friction_facets=question.friction_facets or FRICTION_FACETS,
    )
    return case, noisy


def _in_plane(
    question: ContactModeQuestion, case: ModeCase, context: Context
) -> tuple[tuple[PlanarProblem, tuple[int, ...]] | None, str]:
    """Return the problem in its plane of motion, with the mirror image of each contact in that plane.

    If AUTOMATIC finds no such plane, return None and what left the plane.
    """
    if question.problem is Problem.SPATIAL:
        return None, ""
    box = question.uncertainty
    if question.problem is Problem.AUTOMATIC and (
        question.include_geometry_margins
        or (not box.is_exact and (np.any(box.points) or np.any(box.normals)))
    ):
        return None, _UNCERTAIN
    state, contacts = case.subject.state, case.contacts
    if question.problem is Problem.AUTOMATIC and contacts.surfaces_move:
        return None, _MOVING
    try:
        problem = planar_problem_of(
            case.subject.body.mass_properties,
            state,
            contacts,
            plane=question.plane,
            force_W=case.force_W,
            torque_W=case.torque_W,
            speed_tolerance=or_default(
                question.out_of_plane_tolerance, context.defaults.out_of_plane_tolerance
            ),
        )
        partners = mirror_partners(problem.plane, state, contacts, distance_tolerance=case.distance_tolerance)
        if question.problem is Problem.AUTOMATIC:
            check_mirrored(problem.plane, state, contacts, partners)
    except OutOfPlaneError as error:
        if question.problem is Problem.PLANAR:
            raise
        return None, str(error)
    return (problem, partners), ""


def _planar_answer(
    question: ContactModeQuestion, case: ModeCase, problem: PlanarProblem, partners: tuple[int, ...]
) -> ContactModeAnswer:
    plane, subject = problem.plane, case.subject
    asked = PlanarContactProblem(
        body=problem.body,
        velocity=problem.velocity,
        contacts=problem.contacts,
        wrench=problem.wrench,
        velocity_tolerance=case.velocity_tolerance,
        uncertainty=question.uncertainty,
    )
    found = contact_modes(asked)
    margins, sets, at_rest, settled = None, None, None, None
    if question.include_margins:
        in_plane = mode_margins(asked, found, margin_length=question.margin_length)
        margins = tuple(lifted_margin(margin, plane) for margin in in_plane)
    if question.include_wrenches:
        sets = tuple(lifted_wrench_set(wrenches, plane) for wrenches in wrench_sets(asked))
    if question.include_statics:
        at_rest = statics(asked, margin_length=question.margin_length)
    if question.include_impact:
        settled = settled_in_plane(case, problem, asked, found.verdict, partners)
    return ContactModeAnswer(
        body_name=subject.body.name,
        p_FB_F=subject.body.p_FB_F,
        state=subject.state,
        contacts=case.contacts,
        verdict=found.verdict,
        modes=tuple(lifted_mode(mode, problem, partners) for mode in found.modes),
        margins=margins,
        approaching=found.approaching,
        contact_velocities_W=lifted_vectors(found.contact_velocities, problem),
        refused=found.refused,
        kinematic_modes=found.kinematic_modes,
        wrench_sets=sets,
        statics=at_rest,
        settled=settled,
        undecided=found.undecided,
        undecided_modes=found.undecided_modes,
        within=found.within,
        geometry_margins=geometry_margins(asked, found) if question.include_geometry_margins else None,
        problem=Problem.PLANAR,
        plane=plane,
        out_of_plane=problem.out_of_plane,
        out_of_plane_reason="",
        velocity_tolerance=found.velocity_tolerance,
        acceleration_tolerance=found.acceleration_tolerance,
        distance_tolerance=case.distance_tolerance,
        friction_facets=0,
        wrench_facets=0,
        warnings=_IN_PLANE_ONLY if question.problem is Problem.AUTOMATIC and (margins or at_rest) else (),
    )


def _spatial_answer(question: ContactModeQuestion, case: ModeCase, reason: str) -> ContactModeAnswer:
    subject, state, contacts = case.subject, case.subject.state, case.contacts
    asked = replace(case.in_space, uncertainty=question.uncertainty)
    found = contact_modes(asked)
    margins, sets, at_rest, settled = None, None, None, None
    refused: tuple[RefusedMode, ...] = ()
    wrench_facets = 0
    if question.include_margins:
        margins = mode_margins(asked, found, margin_length=question.margin_length)
        refused = refused_modes(asked, found, margin_length=question.margin_length)
    if question.include_wrenches:
        wrench_facets = question.friction_facets or WRENCH_FACETS
        sets = wrench_sets(replace(asked, friction_facets=wrench_facets))
    if question.include_statics:
        at_rest = statics(asked, margin_length=question.margin_length)
    if question.include_impact:
        settled = settled_in_space(case, found.verdict)
    return ContactModeAnswer(
        body_name=subject.body.name,
        p_FB_F=subject.body.p_FB_F,
        state=state,
        contacts=contacts,
        verdict=found.verdict,
        undecided=found.undecided,
        undecided_modes=found.undecided_modes,
        warnings=(
            *([TAKEN_AS_FLUSH] if found.flush_within > FLUSH else []),
            *(f"the margin of {one.mode} is unknown: {one.unknown}" for one in margins or () if one.unknown),
        ),
        within=found.within,
        geometry_margins=geometry_margins(asked, found) if question.include_geometry_margins else None,
        modes=found.modes,
        margins=margins,
        approaching=found.approaching,
        contact_velocities_W=spatial_contact_velocities(
            state, contacts, velocity_tolerance=case.velocity_tolerance
        ),
        refused=refused,
        kinematic_modes=tuple(
            spatial_kinematic_modes(state, contacts, velocity_tolerance=case.velocity_tolerance)
        ),
        wrench_sets=sets,
        statics=at_rest,
        settled=settled,
        problem=Problem.SPATIAL,
        plane=None,
        out_of_plane=math.nan,
        out_of_plane_reason=reason,
        velocity_tolerance=found.velocity_tolerance,
        acceleration_tolerance=math.nan,
        distance_tolerance=case.distance_tolerance,
        friction_facets=found.friction_facets,
        wrench_facets=wrench_facets,
    )
