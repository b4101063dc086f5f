# SPDX-License-Identifier: Apache-2.0
"""Questions of all kinds with numbers of every size, for the fuzzing of what answers them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.contact import ContactSet
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.motion import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.questions import (
    AtRate,
    AtStamps,
    AtTimes,
    BodiesContactModeQuestion,
    ContactModeQuestion,
    Context,
    ImpactQuestion,
    InTime,
    Problem,
    PublishedState,
    StateStore,
    TossQuestion,
    TossSampling,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.many import ManyImpactsQuestion, ManyStates, ManyTumblingsQuestion
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.shapes import ConvexShape, Obstacle
from contact_dynamics.toss import TossUncertainty
from contact_dynamics.world import Body, Surface, World, box_vertices
from questions.known_world import CUBE, FLOOR, SIDE, state

BALL = Body(
    name="ball",
    mass_properties=MassProperties(mass=0.1, I_B=4e-5 * np.eye(3)),
    shape=ConvexShape(vertices=np.zeros((1, 3)), rounding=0.05),
)
STEP = Obstacle(
    name="step",
    vertices_W=box_vertices([0.4, 0.4, 0.1]) + np.array([0.5, 0.0, 0.05]),
    friction=0.5,
    restitution=0.3,
)
WALL = Surface(name="wall", p_WS_W=[2.0, 0, 0], normal_W=[-1, 0, 0], friction=0.3, restitution=0.4)
NAMES = ("cube", "ball")
FEW_MS = 4_000_000  # ns


def context() -> Context:
    """A cube and a ball, of which some states were published, above a floor with a step on it."""
    states = StateStore(history=5.0, timeout=0.5)
    for name in NAMES:
        for number in range(5):
            stamp_ns = number * FEW_MS
            states.add(name, state(1.0, v=(0.1, 0.0, -1e-9 * 9.8 * stamp_ns), stamp_ns=stamp_ns))
    return Context(world=World(bodies=(CUBE, BALL), surfaces=(FLOOR, STEP)), states=states)


def knowledge_of_flats() -> Context:
    """The same with a wall instead of the step: tosses are among flats."""
    known = context()
    return replace(known, world=replace(known.world, surfaces=(FLOOR, WALL)))


usual = st.one_of(
    st.sampled_from([0.0, 0.0, 0.0, 1.0, -1.0, 0.5, -0.5, 0.5 * SIDE, 1e-3, 1e-9]), st.floats(-3.0, 3.0)
)
extreme = st.one_of(
    st.sampled_from([5e-324, 1e-300, 1e-160, 1e-30, 1e-12, 1e4, 1e8, 1e12, 1e16, 1e60, 1e100, 1e160, 1e300]),
    st.floats(allow_nan=True, allow_infinity=True),
).flatmap(lambda value: st.sampled_from([value, -value]))


@st.composite
def numbers(draw: st.DrawFn) -> float:
    """Mostly usual, now and then of any size, or none at all."""
    return draw(extreme if draw(st.integers(0, 15)) == 0 else usual)


sizes = numbers().map(abs)


def vectors(length: int = 3) -> st.SearchStrategy[np.ndarray]:
    return st.lists(numbers(), min_size=length, max_size=length).map(np.array)


@st.composite
def units(draw: st.DrawFn, length: int = 3) -> np.ndarray:
    """Along an axis, or anyhow."""
    axis = np.eye(length)[-1 - draw(st.integers(0, length - 1)) if draw(st.integers(0, 2)) == 0 else -1]
    if draw(st.integers(0, 2)) > 0:
        return axis
    other = np.array(draw(st.lists(st.floats(-1.0, 1.0), min_size=length, max_size=length)))
    size = float(np.linalg.norm(other))
    return other / size if size > 1e-3 else axis


@st.composite
def body_states(draw: st.DrawFn) -> BodyState:
    return BodyState(
        p_WB_W=[draw(usual), draw(usual), draw(numbers())],
        q_WB=draw(units(4)),
        v_WB_W=draw(vectors()),
        w_WB_W=draw(st.one_of(st.just(np.zeros(3)), vectors())),
        stamp_ns=draw(st.sampled_from([0, FEW_MS, 10**18])),
    )


@st.composite
def sources(draw: st.DrawFn) -> Any:
    kind = draw(st.integers(0, 5))
    if kind == 0:
        return PublishedState(fit_window=draw(sizes), stamp_ns=draw(st.sampled_from([None, FEW_MS, -1])))
    if kind == 1:
        deviations = draw(st.lists(sizes, min_size=12, max_size=12))
        return UncertainState(state=draw(body_states()), covariance=np.diag([d * d for d in deviations]))
    return draw(body_states())


@st.composite
def asked_bodies(draw: st.DrawFn) -> Body | str:
    if draw(st.integers(0, 3)):
        return draw(st.sampled_from(NAMES))
    moments = np.array([draw(sizes), draw(sizes), draw(sizes)])
    return Body(
        name="", mass_properties=MassProperties(mass=draw(sizes), I_B=np.diag(moments)), shape=CUBE.shape
    )


@st.composite
def contact_sets(draw: st.DrawFn) -> ContactSet | None:
    count = draw(st.integers(-1, 4))
    if count < 0:
        return None
    return ContactSet(
        p_WC_W=np.array([draw(vectors()) for _ in range(count)]).reshape(-1, 3),
        normals_W=np.array([draw(units()) for _ in range(count)]).reshape(-1, 3),
        frictions=[draw(sizes) for _ in range(count)],
        restitutions=[draw(st.floats(0.0, 1.0)) for _ in range(count)],
    )


@st.composite
def samplings(draw: st.DrawFn) -> Any:
    kind = draw(st.integers(0, 4))
    rate, duration = draw(st.one_of(st.none(), sizes)), draw(st.one_of(st.none(), sizes))
    if kind == 0:
        return AtTimes(times=sorted(draw(st.lists(sizes, max_size=4))))
    if kind == 1:
        return AtStamps(stamps_ns=sorted(draw(st.lists(st.integers(-(2**63), 2**63 - 1), max_size=3))))
    if kind == 2:
        return AtRate(rate=rate, duration=duration)
    if kind == 3:
        return UntilContact(rate=rate, duration=duration)
    return UntilPlane(
        rate=rate,
        duration=duration,
        plane_point=draw(vectors()),
        plane_normal=draw(units()),
        body_point=draw(vectors()),
    )


optional_sizes = st.one_of(st.none(), st.none(), sizes)
gravities = st.one_of(st.none(), st.none(), vectors())
planes = st.one_of(st.none(), units().map(lambda normal: PlaneOfMotion(normal_W=normal)))
nothing = st.just(np.zeros(3))


@st.composite
def tumbling_questions(draw: st.DrawFn) -> TumblingQuestion:
    forces = draw(st.integers(0, 9)) == 0  # they are integrated, which takes long
    return TumblingQuestion(
        body=draw(asked_bodies()),
        state=draw(sources()),
        sampling=draw(samplings()),
        gravity_W=draw(gravities),
        wrench=ConstantWrench(
            force=draw(vectors() if forces else nothing),
            torque=draw(vectors() if forces else nothing),
            axes=draw(st.sampled_from(WrenchAxes)),
        ),
        drag=Drag(linear=draw(sizes), quadratic_angular=draw(sizes)) if forces else Drag(),
        include_covariance=draw(st.booleans()),
        curve_points=draw(st.sampled_from([0, 1, 2, 50])),
    )


@st.composite
def impact_questions(draw: st.DrawFn) -> ImpactQuestion:
    in_time = st.builds(
        InTime, strike_window=sizes, max_strikes=st.sampled_from([1, 50, 2**32 - 1]), hold_step=optional_sizes
    )
    other = draw(st.sampled_from([None, None, None, "ball", "cube"]))
    return ImpactQuestion(
        body=draw(asked_bodies()),
        state=draw(sources()),
        other=other,
        other_state=PublishedState() if other is None else draw(sources()),
        contacts=draw(contact_sets()),
        horizon=draw(optional_sizes),
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        several_contacts_law=draw(st.one_of(st.sampled_from(SeveralContactsLaw), in_time)),
        include_orders=draw(st.booleans()),
        include_covariance=draw(st.booleans()),
        problem=draw(st.sampled_from(Problem)),
        plane=draw(planes),
        out_of_plane_tolerance=draw(optional_sizes),
        velocity_tolerance=draw(optional_sizes),
        distance_tolerance=draw(optional_sizes),
    )


@st.composite
def rows(draw: st.DrawFn, count: int, one: st.SearchStrategy[Any]) -> np.ndarray:
    """One for each state, or one for all."""
    return np.array([draw(one) for _ in range(draw(st.sampled_from([count, count, 1])))])


@st.composite
def many_states(draw: st.DrawFn) -> ManyStates:
    states = draw(st.lists(body_states(), min_size=1, max_size=4))
    return ManyStates(
        p_WB_W=[each.p_WB_W for each in states],
        q_WB=[each.q_WB for each in states],
        v_WB_W=[each.v_WB_W for each in states],
        w_WB_W=[each.w_WB_W for each in states],
    )


@st.composite
def many_tumblings_questions(draw: st.DrawFn) -> ManyTumblingsQuestion:
    states = draw(many_states())
    return ManyTumblingsQuestion(
        body=draw(asked_bodies()),
        states=states,
        seconds=draw(rows(len(states), numbers())),
        gravity_W=draw(gravities),
    )


@st.composite
def many_impacts_questions(draw: st.DrawFn) -> ManyImpactsQuestion:
    states = draw(many_states())
    return ManyImpactsQuestion(
        body=draw(asked_bodies()),
        states=states,
        p_WC_W=[draw(vectors()) for _ in range(len(states))],
        normals_W=draw(rows(len(states), units())),
        frictions=draw(rows(len(states), sizes)),
        restitutions=draw(rows(len(states), st.floats(0.0, 1.0))),
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        velocity_tolerance=draw(optional_sizes),
    )


@st.composite
def contact_mode_questions(draw: st.DrawFn) -> ContactModeQuestion:
    applied = st.one_of(nothing, nothing, vectors())
    return ContactModeQuestion(
        body=draw(asked_bodies()),
        state=draw(sources()),
        contacts=draw(contact_sets()),
        force_W=draw(applied),
        torque_W=draw(applied),
        gravity_W=draw(gravities),
        problem=draw(st.sampled_from(Problem)),
        plane=draw(planes),
        out_of_plane_tolerance=draw(optional_sizes),
        velocity_tolerance=draw(optional_sizes),
        distance_tolerance=draw(optional_sizes),
        friction_facets=draw(st.sampled_from([0, 0, 3, 8])),
        margin_length=draw(optional_sizes),
        include_margins=draw(st.booleans()),
        include_wrenches=draw(st.booleans()),
        include_statics=draw(st.booleans()),
        include_impact=draw(st.booleans()),
    )


@st.composite
def bodies_contact_mode_questions(draw: st.DrawFn) -> BodiesContactModeQuestion:
    found, k = draw(contact_sets()), draw(st.integers(1, 3))
    contacts = found or ContactSet(p_WC_W=np.zeros((0, 3)), normals_W=np.zeros((0, 3)), frictions=[])
    others = st.one_of(st.none(), st.integers(0, k - 1))
    return BodiesContactModeQuestion(
        bodies=[draw(asked_bodies()) for _ in range(k)],
        states=[draw(sources()) for _ in range(k)],
        contacts=contacts,
        pairs=[(draw(st.integers(0, k - 1)), draw(others)) for _ in range(len(contacts))],
        forces_W=draw(rows(k, vectors())),
        torques_W=draw(nothing),
        gravity_W=draw(gravities),
        velocity_tolerance=draw(optional_sizes),
    )


def asked_of_many(question: ContactModeQuestion) -> ContactModeQuestion:
    """Return a question without what is not asked for many candidates."""
    return replace(
        question,
        force_W=np.zeros(3),
        torque_W=np.zeros(3),
        friction_facets=None,
        margin_length=question.margin_length if question.include_margins else None,
        include_wrenches=False,
        include_statics=False,
        include_impact=False,
        uncertainty=EXACT_CONTACTS,
        include_geometry_margins=False,
        include_probabilities=False,
    )


@st.composite
def many_contact_modes_questions(draw: st.DrawFn) -> ManyContactModesQuestion:
    asked = asked_of_many(draw(contact_mode_questions()))
    count = 0 if asked.contacts is None else len(asked.contacts)
    candidates = draw(st.integers(1, 3))
    return ManyContactModesQuestion(
        asked=asked,
        forces_W=draw(rows(candidates, vectors())),
        torques_W=draw(rows(candidates, vectors())),
        contact_counts=draw(st.sampled_from([(), (), (1,) * count, (count,)])),
    )


@st.composite
def toss_uncertainties(draw: st.DrawFn) -> TossUncertainty:
    """Mostly small, as a calibration finds it, now and then of any size."""
    rows_of_two_flats = draw(st.sampled_from([0, 8, 11, 11, 3]))
    deviations = [draw(st.one_of(st.just(0.01), sizes)) for _ in range(rows_of_two_flats)]
    factors = draw(st.sampled_from([0, 2, 2, 1]))
    return TossUncertainty(
        covariance=np.diag([d * d for d in deviations]),
        velocity=draw(st.one_of(st.just(0.02), sizes)),
        spin=draw(st.one_of(st.just(0.3), sizes)),
        height=draw(st.one_of(st.just(1e-4), sizes)),
        lasting_factors=[draw(sizes) for _ in range(factors)],
        lasting_factor_stds=[draw(sizes) for _ in range(draw(st.sampled_from([0, factors])))],
    )


@st.composite
def toss_questions(draw: st.DrawFn) -> TossQuestion:
    sampling = st.builds(
        TossSampling,
        count=st.integers(1, 4),
        strikes=st.sampled_from([None, 1, 2]),
        to_rest=st.booleans(),
        uncertainty=toss_uncertainties(),
    )
    return TossQuestion(
        body=draw(asked_bodies()),
        state=draw(sources()),
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        horizon=draw(st.one_of(st.just(0.5), st.just(0.5), sizes)),
        rate=draw(optional_sizes),
        max_alternatives=draw(st.sampled_from([None, 0, 0, 1])),
        sampling=draw(st.one_of(st.none(), sampling)),
        lasting_factors=draw(st.sampled_from([(), (), (1.0, 0.5), (0.0, 1e300)])),
    )
