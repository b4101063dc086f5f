# SPDX-License-Identifier: Apache-2.0
"""Surfaces that move: what contacts say of it, and that calls which do not take it say so."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import contact_dynamics as cd
from contact_dynamics import impact_sequence, spatial_pair_impact
from contact_dynamics.contact import spatial_contact_velocities
from contact_dynamics.contact_modes import spatial_sliding_modes
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.impact import jamming_impact, outcomes_over_interleavings, spatial_impact_distribution
from contact_dynamics.plane import PlaneOfMotion, project_onto_plane
from contact_dynamics.questions import ContactModeQuestion, Context, ImpactQuestion, ask

UP = (0.0, 0.0, 1.0)
CRATE = cd.Body.box((0.4, 0.2, 0.6), 2.0, name="crate")
AT_REST = cd.BodyState(p_WB_W=[0, 0, 0.3], q_WB=[0, 0, 0, 1])
FALLING = replace(AT_REST, v_WB_W=np.array([0.0, 0.0, -1.0]))
TURNTABLE = cd.Surface(
    name="turntable",
    p_WS_W=[1, 2, 0],
    normal_W=UP,
    friction=0.5,
    restitution=0.3,
    v_WS_W=[0.3, 0.2, 0.1],
    w_WS_W=[0.5, -0.2, 2.0],
    a_WS_W=[-1.0, 0.5, 0.2],
    alpha_WS_W=[0.1, 0.2, 0.3],
)
BELT = cd.World(bodies=(CRATE,), surfaces=(replace(TURNTABLE, w_WS_W=np.zeros(3)),))
FEET = cd.find_contacts(CRATE, AT_REST, BELT)
FOOT = cd.PlanarContact(
    r=(0.0, -0.3), normal=(0.0, 1.0), friction=0.5, restitution=0.3, surface_velocity=(1, 0)
)


def carried(surface: cd.Surface, point: np.ndarray, seconds: float) -> np.ndarray:
    """Return where a surface takes a point of it, to third order in the time."""
    v, w, a, alpha = surface.v_WS_W, surface.w_WS_W, surface.a_WS_W, surface.alpha_WS_W
    turn = Rotation.from_rotvec(w * seconds + 0.5 * alpha * seconds**2)
    place = surface.p_WS_W + v * seconds + 0.5 * a * seconds**2
    return place + turn.apply(point - surface.p_WS_W)


@pytest.mark.parametrize("body", [CRATE, cd.Body.sphere(0.3, 1.0)], ids=["corners", "ball"])
def test_contacts_that_are_found_have_the_motion_of_their_surface_there(body: cd.Body) -> None:
    wall = cd.Surface(name="wall", p_WS_W=[-0.2, 0, 0], normal_W=[1, 0, 0], friction=0.1, restitution=0.0)
    found = cd.find_contacts(body, AT_REST, cd.World(surfaces=(TURNTABLE, wall)), distance_tolerance=0.2)
    assert set(found.surfaces) == {"turntable", "wall"}
    h = 1e-4
    for each in found:
        before, now, after = (carried(TURNTABLE, each.p_WC_W, t) for t in (-h, 0.0, h))
        if each.surface == "wall":
            assert not each.surfaces_move or not np.any(each.surface_velocity_W)
            continue
        np.testing.assert_allclose(each.surface_velocity_W, (after - before) / (2 * h), atol=1e-7)
        np.testing.assert_allclose(each.surface_acceleration_W, (after - 2 * now + before) / h**2, atol=1e-6)
        np.testing.assert_array_equal(each.surface_angular_velocity_W, TURNTABLE.w_WS_W)
    velocities = spatial_contact_velocities(AT_REST, found)
    np.testing.assert_allclose(velocities, -found.surface_velocities_W, atol=1e-15)


def test_sets_hold_the_motion_of_their_contacts() -> None:
    still = cd.Contact(p_WC_W=[0, 0, 0], normal_W=UP, friction=0.1, restitution=0.0)
    both = cd.ContactSet.of([FEET[1], still, FEET[2]])
    assert both.surfaces_move
    assert not still.surfaces_move
    assert not np.any(both[1].surface_velocity_W)
    assert not np.any(both[1].surface_acceleration_W)
    for name in ("surface_velocities_W", "surface_accelerations_W"):
        one, several = getattr(FEET, name), getattr(both.subset([0, 2]), name)
        np.testing.assert_array_equal(several, one[[1, 2]])
    assert both.surface_angular_velocities_W is None
    assert not cd.ContactSet.of([still, still]).surfaces_move
    for_all = cd.ContactSet(
        p_WC_W=np.zeros((3, 3)), normals_W=UP, frictions=0.5, surface_velocities_W=[1, 2, 3]
    )
    assert for_all.surface_velocities_W is not None
    assert for_all.surface_velocities_W.tolist() == [[1, 2, 3]] * 3


def test_what_does_not_move_is_at_rest_whichever_way_it_is_said() -> None:
    none = {f"surface_{name}_W": np.zeros((4, 3)) for name in ("velocities", "accelerations")}
    feet = replace(FEET, **none, surface_angular_velocities_W=np.zeros(3))
    assert not feet.surfaces_move
    assert feet.surface_velocities_W is None
    assert not replace(FOOT, surface_velocity=(0.0, 0.0)).surfaces_move
    assert replace(FOOT, surface_velocity=(0.0, 0.0), surface_angular_velocity=-1.0).surfaces_move
    still = replace(TURNTABLE, v_WS_W=[0, 0, 0], w_WS_W=[0, 0, 0], a_WS_W=[0, 0, 0], alpha_WS_W=np.zeros(3))
    assert TURNTABLE.moves
    assert not still.moves
    assert BELT.surfaces_move
    assert not cd.World(surfaces=(still,)).surfaces_move
    assert not cd.find_contacts(CRATE, AT_REST, cd.World(surfaces=(still,))).surfaces_move


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: replace(FEET, surface_velocities_W=np.ones((3, 3))),
            r"surface_velocities_W must be of shape",
        ),
        (
            lambda: replace(FEET, surface_accelerations_W=[1e300, 0, 0]),
            "surface_accelerations_W must be at most",
        ),
        (
            lambda: replace(FOOT, surface_acceleration=(1.0,)),
            "surface_acceleration must be two finite numbers",
        ),
    ],
)
def test_motion_that_is_none_is_refused_by_its_name(make: Callable[[], object], message: str) -> None:
    with pytest.raises(InvalidFieldError, match=message):
        make()


SPATIAL: dict[str, Callable[[], object]] = {
    "spatial_sliding_modes": lambda: spatial_sliding_modes(FEET),
    "spatial_pair_impact": lambda: spatial_pair_impact(CRATE, FALLING, CRATE, AT_REST, FEET[0]),
    "outcomes_over_interleavings": lambda: outcomes_over_interleavings(CRATE, FALLING, FEET),
    "jamming_impact": lambda: jamming_impact(CRATE, AT_REST, FEET, force_W=[0, 0, -20]),
    "spatial_impact_distribution": lambda: spatial_impact_distribution(
        CRATE, FALLING, FEET[0], covariance=np.zeros((12, 12))
    ),
    "impact_sequence": lambda: impact_sequence(CRATE, FALLING, cd.World(), contacts=FEET),
    "a plane of motion": lambda: project_onto_plane(
        CRATE, AT_REST, FEET, plane=PlaneOfMotion(normal_W=[0, -1, 0]), force_W=UP, torque_W=[0, 0, 0]
    ),
}


@pytest.mark.parametrize("call", SPATIAL.values(), ids=SPATIAL)
def test_calls_that_take_only_surfaces_at_rest_say_so(call: Callable[[], object]) -> None:
    with pytest.raises(NotSupportedError, match=r"(contacts?|world) must have surfaces at rest in"):
        call()


@pytest.mark.parametrize(
    ("motion", "steady"),
    [
        ({"v_WS_W": [1, 2, 0]}, True),
        ({"w_WS_W": [0, 0, 2]}, True),
        ({"w_WS_W": [0, 0, 2], "v_WS_W": [1, 0, 0], "a_WS_W": [0, 2, 0]}, True),
        ({"w_WS_W": [0, 0, 2], "v_WS_W": [1, 0, 0]}, False),
        ({"v_WS_W": [1, 0, 0.1]}, False),
        ({"a_WS_W": [1, 0, 0]}, False),
        ({"w_WS_W": [0.1, 0, 2]}, False),
        ({"alpha_WS_W": [0, 0, 1]}, False),
    ],
)
def test_questions_take_belts_and_turntables(motion: dict[str, list[float]], steady: bool) -> None:  # noqa: FBT001
    still = cd.Surface(name="disc", p_WS_W=[1, 2, 0], normal_W=UP, friction=0.5, restitution=0.3)
    surface = replace(still, **{name: np.array(value, dtype=float) for name, value in motion.items()})
    assert surface.is_steady is steady
    world = cd.World(bodies=(CRATE,), surfaces=(surface,))
    if not steady:
        with pytest.raises(
            NotSupportedError, match="world must have surfaces that are at rest or move steadily"
        ):
            Context(world=world)
        return
    later = surface.after(0.7)
    points = np.array([[0.3, 0.2, 0.0], [4.0, -1.0, 0.0]])
    np.testing.assert_allclose(later.motion_at(points)[0], surface.motion_at(points)[0], atol=1e-14)
    np.testing.assert_allclose(later.gaps(points), 0.0, atol=1e-15)
    asked = ask(ContactModeQuestion(body="crate", state=AT_REST), Context(world=world))
    problem = cd.SpatialContactProblem.of(CRATE, AT_REST, world)
    assert [mode.mode for mode in asked.modes] == [mode.mode for mode in cd.contact_modes(problem).modes]
    hit = ask(ImpactQuestion(body="crate", state=FALLING), Context(world=world))
    impact = cd.several_impact(CRATE, FALLING, cd.find_contacts(CRATE, FALLING, world))
    np.testing.assert_array_equal(hit.impact.state.v_WB_W, impact.state.v_WB_W)


def copied(value: object) -> Any:
    """What another process is given."""
    return pickle.loads(pickle.dumps(value))  # noqa: S301  our own data


def test_copies_at_rest_are_at_rest() -> None:
    at_rest = replace(FOOT, surface_velocity=(0.0, 0.0))
    for one, moves in ((FOOT, True), (at_rest, False), (FEET, True), (FEET[0], True), (BELT, True)):
        assert copied(one).surfaces_move is moves
    still = cd.Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=UP, friction=0.5, restitution=0.3)
    again = copied(still)
    assert not again.moves
    assert not replace(again, friction=0.1).moves
