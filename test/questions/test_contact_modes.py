# SPDX-License-Identifier: Apache-2.0
"""Questions about contact modes, asked in Python: a block on a floor that is pushed, pulled and dropped."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, ModeVerdict, World
from contact_dynamics.contact_modes import Certainty
from contact_dynamics.errors import InvalidFieldError, NoContactError, OutOfPlaneError, TooLargeError
from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.questions import ContactModeQuestion, Problem, SettledImpact
from contact_dynamics.questions.contact_modes import answer
from questions.known_world import CONTEXT, CUBE, FRICTION, GRAVITY, MASS, RESTING, SIDE, below, state

ROUNDING = 1e-12  # a few operations on numbers of order 1 to 10
HALF = 0.5 * SIDE
WEIGHT = MASS * GRAVITY
HOLDS = FRICTION * WEIGHT  # N, what friction takes of a push
AT_REST = ContactModeQuestion(body="cube", state=RESTING)
FROM_THE_SIDE = PlaneOfMotion(normal_W=[0, -1, 0])


def test_a_body_a_state_and_contacts_are_enough() -> None:
    """One foot straight below the centre carries the weight."""
    found = answer(ContactModeQuestion(body=CUBE, state=state(), contacts=below()))
    assert (found.verdict, [mode.mode for mode in found.modes]) == (ModeVerdict.UNIQUE, ["f"])
    np.testing.assert_allclose(found.modes[0].contact_forces_W, [[0, 0, WEIGHT]], rtol=0.0, atol=ROUNDING)
    assert found.problem is Problem.PLANAR
    assert (found.margins, found.wrench_sets, found.statics, found.settled) == (None, None, None, None)
    assert set(found.kinematic_modes) == {"s", "l", "r", "f"}


def test_contacts_are_found_from_the_shape() -> None:
    found = answer(AT_REST, CONTEXT)
    assert found.contacts.surfaces == ("floor",) * 4
    np.testing.assert_allclose(found.contacts.frictions, FRICTION)
    assert [mode.mode for mode in found.modes] == ["ffff"]
    forces = found.modes[0].contact_forces_W
    np.testing.assert_allclose(forces.sum(axis=0), [0, 0, WEIGHT], rtol=0.0, atol=1e-9)
    with pytest.raises(NoContactError) as caught:
        answer(replace(AT_REST, state=state(HALF + 2e-4)), CONTEXT)
    assert str(caught.value) == (
        "contacts: no point of 'cube' is within 1e-09 m of a surface (distance_tolerance): the nearest, "
        "'floor', is 0.0002 m away (a measured state requires a covariance or a larger tolerance)"
    )
    with pytest.raises(NoContactError, match="'cube' is within 1e-09 m of a surface: the world has none"):
        answer(AT_REST, replace(CONTEXT, world=World(bodies=(CUBE,))))


def test_a_surface_with_static_friction_may_hold_what_it_could_let_slide() -> None:
    (floor,) = CONTEXT.world.surfaces
    world = replace(CONTEXT.world, surfaces=(replace(floor, static_friction=1.5 * FRICTION),))
    pushed = replace(AT_REST, force_W=[1.2 * HOLDS, 0, 0], include_statics=True)
    found = answer(pushed, replace(CONTEXT, world=world))
    assert found.verdict == ModeVerdict.INDETERMINATE
    assert {mode.mode for mode in found.modes} == {"ffff", "rrrr"}
    assert found.contacts.static_frictions == pytest.approx([1.5 * FRICTION] * 4)
    assert found.statics is not None
    assert found.statics.equilibrium == Certainty.POSSIBLE
    with pytest.raises(InvalidFieldError, match=r"contacts.static_frictions must be at most"):
        answer(replace(pushed, contacts=replace(found.contacts, static_frictions=[1e20] * 4)), CONTEXT)


@pytest.mark.parametrize("exponent", [-30, -100, -139, -141, -155, -162, -200, -300, -318])
@pytest.mark.parametrize("problem", Problem)
def test_a_weight_of_any_size_is_answered(problem: Problem, exponent: int) -> None:
    """Squares of such a force are zero, and it is not."""
    gravity_W = np.array([0.0, 0.0, -float(f"1e{exponent}")])
    plane = None if problem is Problem.SPATIAL else FROM_THE_SIDE
    found = answer(replace(AT_REST, gravity_W=gravity_W, problem=problem, plane=plane), CONTEXT)
    assert [mode.mode for mode in found.modes] == ["ffff"]


@pytest.mark.parametrize("problem", [Problem.PLANAR, Problem.SPATIAL])
def test_a_push_beyond_friction_makes_it_slide(problem: Problem) -> None:
    """In the plane of motion it slides right, in space along x, with (F - mu m g) / m."""
    push = 1.5 * HOLDS
    plane = FROM_THE_SIDE if problem is Problem.PLANAR else None
    question = replace(AT_REST, force_W=np.array([push, 0.0, 0.0]), problem=problem, plane=plane)
    found = answer(question, CONTEXT)
    (mode,) = found.modes
    np.testing.assert_allclose(mode.acceleration_W, [(push - HOLDS) / MASS, 0, 0], rtol=0.0, atol=1e-9)
    if problem is Problem.PLANAR:
        assert mode.mode == "rrrr"
        assert mode.tangential_directions_W.shape == (0, 3)
    else:
        assert mode.mode == "cccc"
        np.testing.assert_allclose(mode.tangential_directions_W, [[1, 0, 0]] * 4, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("degrees", [*range(-180, 180, 15), -46, -44, 134, 136])
@pytest.mark.parametrize("moves", ["by a push", "already", "turning"])
def test_right_is_the_same_direction_under_every_load_and_motion(degrees: int, moves: str) -> None:
    """Towards +x or +y, whichever is nearer to the plane; +x where both are."""
    azimuth = math.radians(degrees)
    along = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    asked = ContactModeQuestion(body="cube", state=state(), contacts=below())
    if moves == "by a push":
        asked = replace(asked, force_W=9.0 * HOLDS * along)
    elif moves == "already":
        asked = replace(asked, state=state(v=tuple(0.3 * along)))
    else:  # the foot is half a side below the centre of mass
        spin = np.cross(along, [0.0, 0.0, 1.0]) * 0.3 / HALF
        asked = replace(asked, state=state(w=tuple(spin)))
    found = answer(asked, CONTEXT)
    assert found.plane is not None
    towards = along[0] + along[1] if abs(along[0] + along[1]) > 1e-9 else along[0]
    assert [mode.mode for mode in found.modes] == ["r" if towards > 0.0 else "l"]
    right_W = np.cross([0.0, 0.0, 1.0], found.plane.normal_W)
    np.testing.assert_allclose(right_W, math.copysign(1.0, towards) * along, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_level_plane_is_seen_from_above(sign: float) -> None:
    """A wall in front, in weightlessness: what is to the right of who looks at it from above is -y."""
    wall = ContactSet(p_WC_W=[[-HALF, 0, 1]], normals_W=[[1, 0, 0]], frictions=0.1, restitutions=0.0)
    push = ContactModeQuestion(
        body="cube", state=state(), contacts=wall, gravity_W=[0, 0, 0], force_W=[-1, sign, 0]
    )
    found = answer(push, CONTEXT)
    assert found.plane is not None
    np.testing.assert_array_equal(found.plane.normal_W, [0, 0, 1])
    assert [mode.mode for mode in found.modes] == ["l" if sign > 0.0 else "r"]


def test_the_margin_is_what_is_left_of_friction() -> None:
    """The margin is the shortest way in the metric. Along the push alone it would be mu m g - F."""
    push = 0.25 * HOLDS
    found = answer(
        replace(AT_REST, force_W=np.array([push, 0.0, 0.0]), plane=FROM_THE_SIDE, include_margins=True),
        CONTEXT,
    )
    assert found.margins is not None
    (margin,) = found.margins
    along = HOLDS - push
    assert margin.margin == pytest.approx(along / math.hypot(1.0, FRICTION), rel=1e-9)
    assert margin.change_W[0] > 0.0
    assert margin.modes_beyond == ("rrrr",)
    assert {refused.mode for refused in found.refused} < set(found.kinematic_modes)


def test_statics_and_wrenches() -> None:
    found = answer(
        replace(AT_REST, plane=FROM_THE_SIDE, include_statics=True, include_wrenches=True), CONTEXT
    )
    assert found.statics is not None
    assert found.statics.equilibrium is Certainty.CERTAIN
    assert not found.statics.wedged
    assert found.wrench_sets is not None
    assert {one.mode for one in found.wrench_sets} == set(found.kinematic_modes)
    wrench = np.array([0, 0, -WEIGHT, 0, 0, 0])
    holds = {one.mode: one.depth(wrench, HALF) for one in found.wrench_sets}
    assert holds["ffff"] > 0.0
    assert holds["ssss"] < 0.0
    in_space = answer(
        ContactModeQuestion(
            body=CUBE, state=state(), contacts=below(), problem=Problem.SPATIAL, include_wrenches=True
        )
    )
    assert (in_space.wrench_facets, in_space.friction_facets) == (4, 8)
    assert in_space.wrench_sets


@pytest.mark.parametrize("problem", [Problem.PLANAR, Problem.SPATIAL])
def test_a_foot_that_approaches_is_settled_by_an_impact(problem: Problem) -> None:
    """The impulse m v stops the fall without restitution, and then the foot carries the weight."""
    question = ContactModeQuestion(
        body=CUBE,
        state=state(v=(0.0, 0.0, -1.0)),
        contacts=below(restitution=0.0),
        problem=problem,
        include_impact=True,
    )
    found = answer(question)
    assert (found.verdict, found.approaching, found.modes) == (ModeVerdict.IMPACT, (0,), ())
    np.testing.assert_allclose(found.contact_velocities_W, [[0, 0, -1.0]], rtol=0.0, atol=ROUNDING)
    assert found.settled is not None
    np.testing.assert_allclose(found.settled.impact.impulses_W, [[0, 0, MASS]], rtol=0.0, atol=1e-9)
    assert [mode.mode for mode in found.settled.modes] == ["f"]
    assert found.settled.verdict is ModeVerdict.UNIQUE


def settling(problem: Problem, body: Body, points: list[tuple[float, float]], **fields: Any) -> SettledImpact:
    """What settles the case of a body at the origin that touches the world at points of the plane."""
    normals_W = [[0, 0, sign] for sign in fields.pop("signs")]
    contacts = ContactSet(
        p_WC_W=[[x, 0, z] for x, z in points],
        normals_W=normals_W,
        frictions=fields.pop("friction"),
        restitutions=fields.pop("restitution", 0.0),
    )
    plane = FROM_THE_SIDE if problem is Problem.PLANAR else None
    at_origin = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], **fields.pop("velocities"))
    question = ContactModeQuestion(
        body=body,
        state=at_origin,
        contacts=contacts,
        problem=problem,
        plane=plane,
        include_impact=True,
        **fields,
    )
    settled = answer(question).settled
    assert settled is not None
    return settled


@pytest.mark.parametrize("problem", [Problem.PLANAR, Problem.SPATIAL])
@pytest.mark.parametrize(("restitution", "after"), [(0.0, "f"), (0.5, "s")])
def test_an_impact_settles_the_inconsistent_rod(problem: Problem, restitution: float, after: str) -> None:
    """Its tip sticks throughout restitution too, by hand: K I is the change of the tip's velocity."""
    x, z = tip = (-4.0 * math.cos(math.radians(75.0)), -4.0 * math.sin(math.radians(75.0)))
    settled = settling(
        problem,
        Body(name="rod", mass_properties=MassProperties(mass=1.0, I_B=np.eye(3))),
        [tip],
        signs=[1],
        friction=math.tan(math.radians(30.0)),
        restitution=restitution,
        velocities={"v_WB_W": [-1.0, 0, 0], "w_WB_W": [0, 0, 0]},
    )
    assert settled.impact.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
    assert settled.impact.jams
    K = np.array([[1.0 + z * z, -x * z], [-x * z, 1.0 + x * x]])
    normal = (1.0 + restitution) * np.linalg.solve(K, [1.0, 0.0])[1]
    friction = (1.0 - K[0, 1] * normal) / K[0, 0]
    np.testing.assert_allclose(settled.impact.impulses_W, [[friction, 0.0, normal]], rtol=0.0, atol=1e-9)
    assert (settled.verdict, [mode.mode for mode in settled.modes]) == (ModeVerdict.UNIQUE, [after])


@pytest.mark.parametrize("problem", [Problem.PLANAR, Problem.SPATIAL])
def test_an_impact_settles_a_point_that_jams_in_a_slot(problem: Problem) -> None:
    """It stops dead. By hand: the point's inverse inertia takes its velocity (-1, 0) to zero."""
    x, z = 1.0, -3.0
    settled = settling(
        problem,
        Body(name="handle", mass_properties=MassProperties(mass=2.0, I_B=np.eye(3) / 3.0)),
        [(x, z)] * 2,
        signs=[1, -1],
        friction=2.0,
        velocities={"v_WB_W": [2.0, 0, 1.0], "w_WB_W": [0, 1.0, 0]},
        gravity_W=[0, 0, 0],
        force_W=[3.0, 0, 3.0],
        torque_W=[0, -1.0, 0],
    )
    K = np.eye(2) / 2.0 + 3.0 * np.array([[z * z, -x * z], [-x * z, x * x]])
    expected = np.linalg.solve(K, [1.0, 0.0])
    total = settled.impact.impulses_W.sum(axis=0)
    # 1e-6 is what the load does to jammed contacts in the short time that it acts for.
    np.testing.assert_allclose(total, [expected[0], 0.0, expected[1]], rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(settled.impact.velocities_after_W, 0.0, rtol=0.0, atol=1e-9)
    assert settled.impact.kinetic_energy_after < settled.impact.kinetic_energy_before
    assert (settled.verdict, [mode.mode for mode in settled.modes]) == (ModeVerdict.UNIQUE, ["ff"])


@pytest.mark.parametrize("problem", [Problem.PLANAR, Problem.SPATIAL])
def test_two_feet_that_land_strike_in_turn_and_every_order_is_told(problem: Problem) -> None:
    """With m = I = 1 an impulse p at a foot changes its v_n by 2 p, and that of the other not at all."""
    settled = settling(
        problem,
        Body(name="feet", mass_properties=MassProperties(mass=1.0, I_B=np.eye(3))),
        [(-1.0, -1.0), (1.0, -1.0)],
        signs=[1, 1],
        friction=0.0,
        velocities={"v_WB_W": [0, 0, -1.0], "w_WB_W": [0, 0, 0]},
    )
    np.testing.assert_allclose(settled.impact.impulses_W, [[0.0, 0.0, 0.5]] * 2, rtol=0.0, atol=ROUNDING)
    assert sorted(settled.impact.orders) == [(), (0, 1), (1, 0)]  # both at once, and each first
    np.testing.assert_allclose(settled.impact.order_velocities_W, 0.0, rtol=0.0, atol=ROUNDING)


@pytest.mark.parametrize(("share", "holds"), [(0.9, Certainty.CERTAIN), (1.001, Certainty.NO)])
def test_statics_in_space(share: float, holds: Certainty) -> None:
    push = share * HOLDS * np.array([math.cos(0.5), math.sin(0.5), 0.0])
    found = answer(replace(AT_REST, force_W=push, problem=Problem.SPATIAL, include_statics=True), CONTEXT)
    assert found.statics is not None
    assert (found.statics.equilibrium, found.statics.jammed) == (holds, holds)


def test_automatic_says_why_it_went_to_space() -> None:
    pushed = replace(AT_REST, force_W=np.array([1.0, 2.0, 0.0]), torque_W=np.array([0.0, 0.0, 0.1]))
    found = answer(pushed, CONTEXT)
    assert found.problem is Problem.SPATIAL
    assert "out of the plane" in found.out_of_plane_reason
    assert math.isnan(found.out_of_plane)
    with pytest.raises(OutOfPlaneError, match="out of the plane"):
        answer(replace(pushed, problem=Problem.PLANAR), CONTEXT)


@pytest.mark.parametrize(
    ("name", "value", "problem", "condition"),
    [
        ("plane", FROM_THE_SIDE, Problem.SPATIAL, "problem is PLANAR"),
        ("out_of_plane_tolerance", 1e-3, Problem.SPATIAL, "problem is PLANAR"),
        ("friction_facets", 16, Problem.PLANAR, "problem is SPATIAL"),
        ("margin_length", 0.1, Problem.AUTOMATIC, "include_margins or include_statics is true"),
    ],
)
def test_a_value_that_would_be_ignored_is_an_error(
    name: str, value: Any, problem: Problem, condition: str
) -> None:
    with pytest.raises(InvalidFieldError, match=f"^{name} must be left out unless {condition}, got"):
        replace(AT_REST, problem=problem, **{name: value})


def test_numbers_without_sense_are_refused() -> None:
    n = 1001
    many = ContactSet(p_WC_W=np.zeros((n, 3)), normals_W=[0.0, 0.0, 1.0], frictions=0.0, restitutions=0.0)
    with pytest.raises(TooLargeError, match=r"contacts must be .*, got 1001 contacts"):
        answer(ContactModeQuestion(body=CUBE, state=state(), contacts=many))


def test_margins_in_a_plane_that_was_found_from_the_load_are_said_to_be_of_that_plane() -> None:
    """A smaller change out of the plane may end the mode."""
    pushed = ContactModeQuestion(body=CUBE, state=RESTING, force_W=[1.0, 0, 0], include_margins=True)
    found = answer(pushed, CONTEXT)
    whole = answer(replace(pushed, problem=Problem.SPATIAL), CONTEXT)
    assert (found.problem, whole.problem) == (Problem.PLANAR, Problem.SPATIAL)
    assert any("SPATIAL" in warning for warning in found.warnings)
    for other in (
        replace(pushed, problem=Problem.PLANAR),
        replace(pushed, problem=Problem.SPATIAL),
        replace(pushed, include_margins=False),
    ):
        assert answer(other, CONTEXT).warnings == ()
