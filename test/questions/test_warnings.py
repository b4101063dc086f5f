# SPDX-License-Identifier: Apache-2.0
"""Answers that hold and are doubtful say so: an open order of strikes, a contact off the shape's surface."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, Surface, World
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw, outcomes_over_orders
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import bodies_contact_modes as bodies_questions
from contact_dynamics.questions import contact_modes as modes_questions
from contact_dynamics.questions import impact as impact_questions
from contact_dynamics.questions import many, many_contact_modes
from contact_dynamics.questions.bodies_contact_modes import BodiesContactModeQuestion
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.context import Context, Problem
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.many import ManyImpactsQuestion, ManyStates
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from contact_dynamics.questions.touching import outside_shape
from contact_dynamics.shapes import box, capsule, cylinder, polyhedron, sphere
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.tolerances import DISTANCE_TOLERANCE
from msg_adapters.batches import contact_modes_answer_to_msg, impacts_answer_to_msg
from msg_adapters.impact import impact_answer_to_msg
from oracles.boxes_nearly_flush import MASS as BOX_MASS
from oracles.boxes_nearly_flush import flush

MASS = MassProperties(mass=0.37, I_B=8.1e-4 * np.eye(3))
CUBE = Body(name="cube", mass_properties=MASS, shape=box(size=(0.1, 0.1, 0.1)))
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.5)
KNOWN = Context(world=World(bodies=(CUBE,), surfaces=(FLOOR,)))
FLAT = BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -1])
DECIDES = re.compile(r"differ by up to ([\d.e-]+) m/s and ([\d.e-]+) rad/s \(include_orders\)$")


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_flat_landing_is_level_and_names_what_another_order_would_do(law: RestitutionLaw) -> None:
    answer = impact_questions.answer(ImpactQuestion(body="cube", state=FLAT, restitution_law=law), KNOWN)
    np.testing.assert_allclose(answer.impact.state.v_WB_W, [0.0, 0.0, 0.5], atol=1e-12)
    np.testing.assert_allclose(answer.impact.state.w_WB_W, 0.0, atol=1e-12)
    (warning,) = answer.warnings
    assert len(warning) < 140
    assert warning.startswith("contacts 0, 1, 2, 3 are resolved together: other orders")
    found = DECIDES.search(warning)
    assert found is not None
    orders = outcomes_over_orders(MASS, FLAT, answer.contacts, restitution_law=law)
    apart = np.abs(orders.velocities_W - orders.velocities_W[0]).max(axis=0)
    assert 1.0 < float(found[2]) <= apart[3:].max() * 1.01
    assert float(found[1]) <= apart[:3].max() * 1.01
    message = impact_answer_to_msg(answer, world_frame="world").message
    assert message == f"warning: {warning}"


def test_one_strike_and_another_law_have_no_order() -> None:
    tilted = replace(FLAT, q_WB=[0.1, 0.2, 0.0, 0.97467943448], p_WB_W=[0, 0, 0.3])
    assert impact_questions.answer(ImpactQuestion(body="cube", state=tilted), KNOWN).warnings == ()
    at_once = ImpactQuestion(body="cube", state=FLAT, several_contacts_law=SeveralContactsLaw.SIMULTANEOUS)
    assert impact_questions.answer(at_once, KNOWN).warnings == ()


def test_two_feet_in_a_plane_two_bodies_and_strikes_in_time_warn_too() -> None:
    feet = ContactSet(
        p_WC_W=[[-0.05, 0, 0], [0.05, 0, 0]], normals_W=[0, 0, 1], frictions=0.3, restitutions=0.5
    )
    stated = ImpactQuestion(body="cube", state=FLAT, contacts=feet)
    plane = PlaneOfMotion(normal_W=[0, -1, 0])
    in_plane = replace(stated, problem=Problem.PLANAR, plane=plane)
    under = BodyState(p_WB_W=[0, 0, -0.05], q_WB=[0, 0, 0, 1])
    on_another = replace(stated, other=CUBE, other_state=under)
    for question in (stated, in_plane, on_another):
        known = KNOWN if question.other is None else Context(world=World(bodies=(CUBE,)))  # not in the floor
        (warning,) = impact_questions.answer(question, known).warnings
        assert DECIDES.search(warning)
    (warning,) = impact_questions.answer(replace(stated, several_contacts_law=InTime()), KNOWN).warnings
    assert "does not determine their order" in warning


def test_a_body_that_an_impact_drives_into_what_it_touches_is_a_warning() -> None:
    """A ball of equal mass drops on a cube on the floor: the floor would have to take part."""
    ball = Body.sphere(0.02, 0.37, name="ball")
    on_top = ContactSet(p_WC_W=[[0, 0, 0.1]], normals_W=[0, 0, 1], frictions=0.3, restitutions=0.5)
    lying = BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1])
    dropped = BodyState(p_WB_W=[0, 0, 0.12], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -1])
    question = ImpactQuestion(body=ball, state=dropped, other="cube", other_state=lying, contacts=on_top)
    answer = impact_questions.answer(question, KNOWN)
    np.testing.assert_allclose(answer.impact.states[1].v_WB_W, [0.0, 0.0, -0.75], atol=1e-12)
    into = "after the impact, 'cube' moves into 'floor', which it touches, at 0.75 m/s"
    assert answer.warnings == (f"{into}: the contacts there were not part of the impact",)
    lifted = replace(question, state=replace(dropped, p_WB_W=[0, 0, 1.12]))
    lifted = replace(
        lifted,
        other_state=replace(lying, p_WB_W=[0, 0, 1.05]),
        contacts=replace(on_top, p_WC_W=[[0, 0, 1.1]]),
    )
    assert impact_questions.answer(lifted, KNOWN).warnings == ()


def test_a_contact_off_the_shape_of_the_second_body_is_a_warning() -> None:
    ball = Body.sphere(0.02, 0.37, name="ball")
    above = ContactSet(p_WC_W=[[0, 0, 1.11]], normals_W=[0, 0, 1], frictions=0.3, restitutions=0.5)
    dropped = BodyState(p_WB_W=[0, 0, 1.13], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -1])
    still = BodyState(p_WB_W=[0, 0, 1.05], q_WB=[0, 0, 0, 1])
    question = ImpactQuestion(body=ball, state=dropped, other="cube", other_state=still, contacts=above)
    answer = impact_questions.answer(question, KNOWN)
    assert answer.warnings == ("contact 0 is 0.01 m outside of the shape of 'cube'",)


def test_an_impact_at_one_of_the_contacts_is_a_warning() -> None:
    """A cube that slides on the floor and hits a wall with its upper edge would turn into the floor."""
    wall = Surface(name="wall", p_WS_W=[0.05, 0, 0], normal_W=[-1, 0, 0], friction=0.0, restitution=0.5)
    known = Context(world=World(bodies=(CUBE,), surfaces=(FLOOR, wall)))
    sliding = replace(FLAT, v_WB_W=[1, 0, 0])
    every = ImpactQuestion(body="cube", state=sliding, several_contacts_law=SeveralContactsLaw.SIMULTANEOUS)
    assert impact_questions.answer(every, known).warnings == ()
    one = ContactSet(p_WC_W=[[0.05, 0, 0.1]], normals_W=[-1, 0, 0], frictions=0.0, restitutions=0.5)
    (warning,) = impact_questions.answer(replace(every, contacts=one), known).warnings
    assert warning.startswith("after the impact, 'cube' moves into 'wall', which it touches, at ")


def test_a_surface_that_the_body_touches_without_a_contact_is_a_warning() -> None:
    """A finger pushes a cube on the floor, whose contact the question leaves out: the cube would fall."""
    finger = ContactSet(p_WC_W=[[-0.05, 0, 0.05]], normals_W=[1, 0, 0], frictions=0.5)
    lying = replace(FLAT, v_WB_W=[0, 0, 0])
    question = ContactModeQuestion(body="cube", state=lying, contacts=finger, force_W=[-1, 0, 0])
    left_out = "'cube' touches 'floor', where no contact is given"
    assert modes_questions.answer(question, KNOWN).warnings == (left_out,)
    feet = ContactSet(
        p_WC_W=[[-0.05, 0, 0.05], [-0.05, 0, 0], [0.05, 0, 0]],
        normals_W=[[1, 0, 0], [0, 0, 1], [0, 0, 1]],
        frictions=0.5,
    )
    assert modes_questions.answer(replace(question, contacts=feet), KNOWN).warnings == ()
    above = replace(lying, p_WB_W=[0, 0, 0.06])
    higher = replace(finger, p_WC_W=[[-0.05, 0, 0.06]])
    assert modes_questions.answer(replace(question, state=above, contacts=higher), KNOWN).warnings == ()
    on_top = ContactSet(p_WC_W=[[0, 0, 0.1]], normals_W=[0, 0, 1], frictions=0.5)
    stack = BodiesContactModeQuestion(
        bodies=[CUBE, "cube"],
        states=[replace(lying, p_WB_W=[0, 0, 0.15]), lying],
        contacts=on_top,
        pairs=[(0, 1)],
    )
    assert bodies_questions.answer(stack, KNOWN).warnings == (left_out,)


def test_friction_that_differs_in_tosses_is_a_warning() -> None:
    """Half of the friction in sustained contact, and in between below an approach speed of 2 m/s."""
    slower = replace(FLOOR, lasting_factor=0.5, lasting_speed=2.0)
    known = Context(world=World(bodies=(CUBE,), surfaces=(slower,)))
    words = (
        "the friction of 'floor' is 0.3 in this answer. In tosses it is 0.15 in sustained contact, and in "
        "between in slow impacts"
    )
    falling = ImpactQuestion(body="cube", state=FLAT, several_contacts_law=SeveralContactsLaw.SIMULTANEOUS)
    assert impact_questions.answer(falling, known).warnings == (words,)  # at 1 m/s
    fast = replace(falling, state=replace(FLAT, v_WB_W=[0, 0, -2]))
    assert impact_questions.answer(fast, known).warnings == ()
    assert impact_questions.answer(falling, KNOWN).warnings == ()
    sliding = ContactModeQuestion(body="cube", state=replace(FLAT, v_WB_W=[1, 0, 0]))
    assert modes_questions.answer(sliding, known).warnings == (words,)
    assert modes_questions.answer(sliding, KNOWN).warnings == ()
    resting = replace(sliding, state=replace(FLAT, v_WB_W=[0, 0, 0]))
    assert modes_questions.answer(resting, known).warnings == ()
    pushed = replace(resting, force_W=[0.2 * 0.37 * 9.8, 0, 0])  # it rests here, and slides in a toss
    answer = modes_questions.answer(pushed, known)
    assert [mode.mode for mode in answer.modes] == ["ffff"]
    assert answer.warnings == (words,)


def test_a_margin_that_is_not_known_is_a_warning() -> None:
    """Of twelve feet that begin to slide, nobody knows how long each slides on."""
    angles = 2.0 * np.pi * np.arange(12) / 12
    feet = ContactSet(
        p_WC_W=np.column_stack([0.04 * np.cos(angles), 0.04 * np.sin(angles), np.zeros(12)]),
        normals_W=[0, 0, 1],
        frictions=0.4,
    )
    state = replace(FLAT, v_WB_W=[0, 0, 0])
    pushed = ContactModeQuestion(
        body="cube",
        state=state,
        contacts=feet,
        force_W=[10, 0, 0],
        problem=Problem.SPATIAL,
        include_margins=True,
    )
    answer = modes_questions.answer(pushed, KNOWN)
    assert answer.margins is not None
    assert np.isnan(answer.margins[0].margin)
    (warning,) = answer.warnings
    assert warning.startswith("the margin of cccccccccccc is unknown: the contacts on a plane have more")
    held = modes_questions.answer(replace(pushed, force_W=[0, 0, 0]), KNOWN)
    assert held.margins is not None
    assert np.isfinite(held.margins[0].margin)
    assert held.warnings == ()


def test_a_flush_rim_counts_as_points_where_that_matters() -> None:
    """A cup of radius r bears m g r / h at height h. Eight points bear cos 22.5 degrees of it, or all."""
    radius, height, lightly = 0.03, 0.1, 0.1
    cup = Body.cylinder(radius=radius, length=height, mass=0.2, name="cup")
    standing = BodyState(p_WB_W=[0, 0, height / 2], q_WB=[0, 0, 0, 1])
    known = Context(world=World(bodies=(cup,), surfaces=(replace(FLOOR, friction=2.0),)))
    pushed = ContactModeQuestion(body="cup", state=standing, force_W=[lightly, 0, 0], problem=Problem.SPATIAL)
    assert modes_questions.answer(pushed, known).warnings == ()
    tips = 0.2 * 9.80665 * radius / (height / 2)
    for angle in np.pi / 8 * np.arange(3):
        along = np.array([np.cos(angle), np.sin(angle), 0.0])
        for share, is_held in ((0.92, True), (1.001, False)):
            answer = modes_questions.answer(replace(pushed, force_W=share * tips * along), known)
            assert ([mode.mode for mode in answer.modes] == ["f" * 8]) == is_held
            doubts = ["'cup' counts as 8 points" in each and "to 8% too" in each for each in answer.warnings]
            assert doubts == ([] if is_held else [True])
    (warning,) = modes_questions.answer(replace(pushed, include_margins=True), known).warnings
    assert "flush rim" in warning


def test_orders_that_lead_to_one_outcome_are_no_warning() -> None:
    """A level elastic rod on its two ends rises level in every order (`test_level_rod_on_two_supports`)."""
    rod = Body(name="rod", mass_properties=MassProperties(mass=2.0, I_B=np.diag([1e-4, 2 / 3, 2 / 3])))
    ends = ContactSet(p_WC_W=[[1, 0, 0], [-1, 0, 0]], normals_W=[0, 0, 1], frictions=0, restitutions=1)
    state = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, -1])
    assert impact_questions.answer(ImpactQuestion(body=rod, state=state, contacts=ends)).warnings == ()


@pytest.mark.parametrize(
    ("shape", "on", "off", "gap"),
    [
        (box(size=(0.1, 0.1, 0.1)), [0.05, 0.0, 0.01], [0.05, 0.0, -0.07], 0.02),
        (sphere(radius=0.1), [0.0, 0.0, -0.1], [0.0, 0.03, -0.14], 0.0431782106),
        (capsule(radius=0.1, length=0.2), [0.1, 0.0, 0.05], [0.0, 0.0, -0.25], 0.05),
        (cylinder(radius=0.1, length=0.2), [0.1, 0.0, -0.1], [0.0, 0.0, -0.15], 0.05),
    ],
)
@pytest.mark.parametrize("turn", [[0, 0, 0, 1], [0.5, -0.5, 0.5, -0.5]])
def test_a_contact_outside_or_inside_the_shape_is_a_warning(
    shape: ConvexShape, on: list[float], off: list[float], gap: float, turn: list[float]
) -> None:
    body = Body(name="it", mass_properties=MASS, shape=shape)
    state = BodyState(p_WB_W=[1, 2, 3], q_WB=turn)
    depth = min(on[0] or 0.1, 0.1)  # of the centre
    for point, where, size in ((on, "", 0.0), (off, "outside of", gap), ([0.0] * 3, "inside", depth)):
        place = state.p_WB_W + state.R_WB @ np.array(point)
        contacts = ContactSet(p_WC_W=[place], normals_W=[0, 0, 1], frictions=0.3, restitutions=0.5)
        falling = replace(state, v_WB_W=[0, 0, -1])
        answers = (
            modes_questions.answer(ContactModeQuestion(body=body, state=state, contacts=contacts)),
            impact_questions.answer(ImpactQuestion(body=body, state=falling, contacts=contacts)),
        )
        for answer in answers:
            if not where:
                assert answer.warnings == ()
                continue
            (warning,) = answer.warnings
            found = re.fullmatch(rf"contact 0 is ([\d.]+) m {where} the shape of 'it'", warning)
            assert found is not None
            inscribed = 5e-3 * size if where == "inside" else 1e-6  # a rim is inside by corners on it
            assert float(found[1]) == pytest.approx(size, abs=inscribed)


@pytest.mark.parametrize("apart", [0.0, 1e-17, 1e-9, 9e-7, 1.1e-6, 1e-5, 1e-3])
def test_the_distance_from_a_sharp_tip_decides(apart: float) -> None:
    """The planes of a needle's faces are much nearer to a point beyond its tip than the tip is."""
    needle = polyhedron([[0.1, 0, 0], [0, 1e-3, 0], [0, -5e-4, 8e-4], [0, -5e-4, -8e-4]])
    body = Body(name="needle", mass_properties=MASS, shape=needle)
    rest = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    contacts = ContactSet(p_WC_W=[[0.1 + apart, 0, 0]], normals_W=[0, 0, 1], frictions=0.3)
    answer = modes_questions.answer(ContactModeQuestion(body=body, state=rest, contacts=contacts))
    assert any("outside of the shape" in each for each in answer.warnings) == (apart > DISTANCE_TOLERANCE)


def test_a_body_without_a_shape_has_no_outside() -> None:
    body = Body(name="it", mass_properties=MASS)
    contacts = ContactSet(p_WC_W=[[9, 9, 9]], normals_W=[0, 0, 1], frictions=0.3)
    rest = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    assert (
        modes_questions.answer(ContactModeQuestion(body=body, state=rest, contacts=contacts)).warnings == ()
    )


def test_contacts_that_are_taken_as_flush_warn_where_the_verdict_is_undecided_otherwise() -> None:
    for noise, count in ((0.0, 0), (1e-9, 0), (2e-7, 1)):
        box = flush(2, noise)
        body = Body(name="peg", mass_properties=MassProperties(mass=BOX_MASS, I_B=np.diag(box.inertia)))
        answer = modes_questions.answer(
            ContactModeQuestion(
                body="peg",
                state=BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1]),
                contacts=ContactSet(p_WC_W=box.points, normals_W=box.normals, frictions=box.frictions),
                force_W=box.wrench[:3],
                torque_W=box.wrench[3:],
            ),
            Context(world=World(bodies=(body,), surfaces=())),
        )
        assert answer.undecided == ""
        assert len(answer.warnings) == count
        assert all(one.startswith("contacts are taken as flush to within 0.0001") for one in answer.warnings)


def test_a_contact_in_the_notch_of_a_body_is_outside_of_its_shape() -> None:
    bar, post = Body.box((0.3, 0.1, 0.1), 1.0), Body.box((0.1, 0.1, 0.3), 1.0)
    bracket = Body.union([bar, post.placed([-0.1, 0, 0.2])])
    shown = [[0.0, 0.0, 0.07], [0.0, 0.0, 0.05], [-0.05, 0.0, 0.2], [0.1, 0.0, 0.35], [-0.1, 0.0, 0.0]]
    found = outside_shape(bracket, points_W=np.array(shown), p_WB_W=bracket.p_FB_F, R_WB=np.eye(3))
    assert [each.split(" of the shape")[0] for each in found] == [
        "contact 0 is 0.02 m outside",
        "contact 3 is 0.15 m outside",
        "contact 4 is 0.05 m inside the shape of 'union'",
    ]


def test_a_batch_of_impacts_warns_of_contacts_outside_of_the_shape() -> None:
    """Few are named one by one. Many are counted, and the farthest is named."""
    for count, expected in (
        (1, ["contact 1 is 0.01 m outside of the shape of 'cube'"]),
        (6, ["6 of 8 contacts are outside of the shape of 'cube', the farthest by 0.06 m: contact 6"]),
    ):
        depths = np.zeros(8)
        depths[1 : 1 + count] = 0.01 * np.arange(1, 1 + count)
        down = np.column_stack([np.full(8, 0.05), np.zeros(8), -0.05 - depths])
        question = ManyImpactsQuestion(
            body="cube",
            states=ManyStates(
                p_WB_W=np.zeros((8, 3)),
                q_WB=np.tile([0.0, 0.0, 0.0, 1.0], (8, 1)),
                v_WB_W=np.tile([0.0, 0.0, -1.0], (8, 1)),
                w_WB_W=np.zeros((8, 3)),
            ),
            p_WC_W=down,
            normals_W=[[0, 0, 1]],
            frictions=[0.3],
            restitutions=[0.5],
        )
        answer = many.answer_impacts(question, KNOWN)
        assert list(answer.warnings) == expected
        msg = impacts_answer_to_msg(answer, world_frame="world")
        assert msg.message == "\n".join(f"warning: {each}" for each in expected)


def test_a_batch_of_contact_modes_says_which_candidates_have_a_warning() -> None:
    rest = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1])
    on, off = [0.05, 0.0, -0.05], [0.05, 0.0, -0.07]
    outside = "contact 0 is 0.02 m outside of the shape of 'cube'"
    for points, expected in (
        ([on, on, on], []),
        ([off, off, off], [f"all candidates: {outside}"]),
        ([on, off, on], [f"candidate 1: {outside}"]),
        ([on, off, off], [f"2 of 3 candidates, of which candidate 1 is the first: {outside}"]),
    ):
        asked = ContactModeQuestion(
            body="cube", state=rest, contacts=ContactSet(p_WC_W=points, normals_W=[0, 0, 1], frictions=0.3)
        )
        question = ManyContactModesQuestion(
            asked=asked, forces_W=np.zeros((3, 3)), torques_W=np.zeros((3, 3)), contact_counts=(1, 1, 1)
        )
        answer = many_contact_modes.answer(question, KNOWN)
        assert list(answer.warnings) == expected
        msg = contact_modes_answer_to_msg(answer, world_frame="world")
        assert msg.message == "\n".join(f"warning: {each}" for each in expected)
