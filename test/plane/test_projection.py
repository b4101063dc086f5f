# SPDX-License-Identifier: Apache-2.0
"""The plane of motion: what is planar and by how much the rest is not, which way is right, and back."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from contact_dynamics import BodyState, Contact, ContactSet, MassProperties, planar_impact, spatial_impact
from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.plane import PlaneOfMotion
from contact_dynamics.plane.lifting import check_mirrored, equal_shares, mirror_partners
from contact_dynamics.plane.plane_search import best_plane
from contact_dynamics.plane.projection import project_onto_plane

BODY = MassProperties(mass=2.0, I_B=np.diag([0.2, 0.3, 0.4]))
UP = np.array([0.0, 0.0, 1.0])
FROM_THE_FRONT = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])  # x to the right, z up
WEIGHT = np.array([0.0, 0.0, -20.0])
NONE = np.zeros(3)

angles = st.floats(-math.pi, math.pi)
numbers = st.floats(-3.0, 3.0)


def state(
    v: tuple[float, float, float] = (0.0, 0.0, 0.0), w: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> BodyState:
    return BodyState(
        p_WB_W=[0.0, 0.0, 0.5], q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=np.array(v), w_WB_W=np.array(w)
    )


def contact(point: tuple[float, float, float], normal: np.ndarray = UP) -> ContactSet:
    return ContactSet(p_WC_W=[point], normals_W=normal[None], frictions=[0.5], restitutions=[0.5])


def test_seen_with_the_normal_towards_the_eye_right_is_right() -> None:
    problem = project_onto_plane(
        BODY,
        state((1.0, 0.0, -2.0), (0.0, 3.0, 0.0)),
        contact((0.25, 0.0, 0.0)),
        plane=FROM_THE_FRONT,
        force_W=WEIGHT,
        torque_W=NONE,
    )
    assert problem.velocity.v == (1.0, -2.0)
    assert problem.velocity.w == -3.0  # about +y is clockwise from the front, where y points away
    assert problem.contacts[0].r == (0.25, -0.5)
    assert problem.contacts[0].tangent == (1.0, 0.0)
    assert problem.body.inertia == pytest.approx(0.3, abs=1e-16)
    assert problem.wrench.f == (0.0, -20.0)
    assert problem.out_of_plane == 0.0


def test_turned_over_left_and_right_change_places() -> None:
    behind = PlaneOfMotion(normal_W=[0.0, 1.0, 0.0])
    problem = project_onto_plane(
        BODY, state((1.0, 0.0, 0.0)), contact((0.25, 0.0, 0.0)), plane=behind, force_W=WEIGHT, torque_W=NONE
    )
    assert problem.velocity.v == (-1.0, 0.0)
    assert problem.contacts[0].r == (-0.25, -0.5)


@given(azimuth=angles, tilt=angles)
def test_axes_are_right_handed(azimuth: float, tilt: float) -> None:
    normal = Rotation.from_euler("zy", [azimuth, tilt]).apply([0.0, 0.0, 1.0])
    plane = PlaneOfMotion(normal_W=normal)
    axes = np.vstack([plane.axes_W, plane.normal_W])
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0, abs=1e-14)
    np.testing.assert_allclose(plane.lift((2.0, -1.0)), 2.0 * axes[0] - axes[1], atol=1e-15)


@pytest.mark.parametrize(
    ("moving", "amount"),
    [
        (state((0.0, 0.25, 0.0)), 0.25),  # the whole body
        (state((0.0, 0.0, 0.0), (0.5, 0.0, 0.0)), 0.25),  # the contact, half a metre below the centre
        (state((1.0, 0.0, 1.0), (0.0, 9.0, 0.0)), 0.0),
    ],
)
def test_the_amount_out_of_plane_is_the_speed_left_out(moving: BodyState, amount: float) -> None:
    touching = contact((0.0, 0.0, 0.0))
    if amount:
        with pytest.raises(
            OutOfPlaneError, match=rf"state must be at most 1e-06 m/s, got {amount:g} m/s out of the plane"
        ):
            project_onto_plane(BODY, moving, touching, plane=FROM_THE_FRONT, force_W=WEIGHT, torque_W=NONE)
    problem = project_onto_plane(
        BODY, moving, touching, plane=FROM_THE_FRONT, force_W=WEIGHT, torque_W=NONE, speed_tolerance=0.3
    )
    assert problem.out_of_plane == pytest.approx(amount, abs=1e-16)


def test_what_leans_out_of_the_plane_is_refused_by_name() -> None:
    leaning = np.array([0.0, math.sin(0.02), math.cos(0.02)])
    arguments = {"plane": FROM_THE_FRONT, "force_W": WEIGHT, "torque_W": NONE}
    with pytest.raises(OutOfPlaneError, match=r"contact normals must be .*, got a part of 0\.0199"):
        project_onto_plane(BODY, state(), contact((0.0, 0.0, 0.0), leaning), **arguments)
    with pytest.raises(OutOfPlaneError, match=r"applied force must be .*, got a part of 0\.0199"):
        project_onto_plane(
            BODY, state(), contact((0.0, 0.0, 0.0)), **{**arguments, "force_W": 20.0 * leaning}
        )
    with pytest.raises(OutOfPlaneError, match="applied torque"):
        project_onto_plane(
            BODY, state(), contact((0.0, 0.0, 0.0)), **{**arguments, "torque_W": np.array([1.0, 0.0, 0.0])}
        )
    skew = MassProperties(mass=2.0, I_B=[[0.2, 0.05, 0.0], [0.05, 0.3, 0.0], [0.0, 0.0, 0.4]])
    with pytest.raises(OutOfPlaneError, match="inertia"):
        project_onto_plane(skew, state(), contact((0.0, 0.0, 0.0)), **arguments)


@given(azimuth=angles, speed=st.floats(0.1, 5.0), spin=st.floats(0.1, 5.0))
def test_the_best_plane_of_a_planar_motion_is_its_own(azimuth: float, speed: float, spin: float) -> None:
    """Turned about the vertical as a whole, body and motion: the plane turns with them."""
    turn = Rotation.from_euler("z", azimuth)
    moving = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=turn.as_quat(),
        v_WB_W=turn.apply([speed, 0.0, -1.0]),
        w_WB_W=turn.apply([0.0, spin, 0.0]),
    )
    touching = contact(tuple(turn.apply([0.1, 0.0, -0.5])))
    plane = best_plane(BODY, moving, touching, force_W=WEIGHT, torque_W=NONE)
    problem = project_onto_plane(BODY, moving, touching, plane=plane, force_W=WEIGHT, torque_W=NONE)
    assert problem.out_of_plane < 1e-14 * (speed + spin)
    np.testing.assert_allclose(abs(plane.normal_W @ turn.apply([0.0, 1.0, 0.0])), 1.0, atol=1e-14)


def test_the_best_plane_of_a_body_at_rest_holds_a_principal_axis_as_normal() -> None:
    plane = best_plane(BODY, state(), contact((0.0, 0.0, 0.0)), force_W=WEIGHT, torque_W=NONE)
    assert max(abs(plane.normal_W[:2])) == pytest.approx(1.0, abs=1e-15)


@given(azimuth=angles, offset=st.floats(0.0, 1.0))
def test_a_body_at_rest_is_seen_in_the_plane_of_its_contacts(azimuth: float, offset: float) -> None:
    round_body = MassProperties(mass=2.0, I_B=np.diag([0.2, 0.2, 0.4]))
    across = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    feet = ContactSet(p_WC_W=[-0.5 * across, offset * across], normals_W=UP, frictions=0.5, restitutions=0.0)
    plane = best_plane(round_body, state(), feet, force_W=WEIGHT, torque_W=NONE)
    assert abs(plane.normal_W @ across) < 1e-15
    assert abs(plane.normal_W @ UP) < 1e-15


@pytest.mark.parametrize(
    "places",
    [
        [(0.0, 0.0, 0.0)],  # below the centre of mass
        [(0.3, 0.2, 0.0), (-0.3, 0.2, 0.0), (0.3, -0.2, 0.0), (-0.3, -0.2, 0.0)],
        [(0.3, 0.2, 0.0), (-0.3, 0.2, 0.0)],  # on a line beside it
    ],
)
def test_contacts_that_name_no_plane_leave_it_to_the_principal_axes(
    places: list[tuple[float, float, float]],
) -> None:
    feet = ContactSet(p_WC_W=np.array(places), normals_W=UP, frictions=0.5, restitutions=0.0)
    plane = best_plane(BODY, state(), feet, force_W=WEIGHT, torque_W=NONE)
    assert max(abs(plane.normal_W[:2])) == pytest.approx(1.0, abs=1e-15)


def test_normals_that_span_space_have_no_plane() -> None:
    corner = ContactSet(p_WC_W=np.zeros((3, 3)), normals_W=np.eye(3), frictions=0.5, restitutions=0.0)
    with pytest.raises(OutOfPlaneError, match="span space"):
        best_plane(BODY, state(), corner, force_W=WEIGHT, torque_W=NONE)


@given(
    motion=st.tuples(numbers, st.floats(-3.0, -0.1), numbers),
    r_x=st.floats(-1.0, 1.0),
    mu=st.floats(0.0, 2.0),
    e=st.floats(0.0, 1.0),
    azimuth=angles,
)
def test_a_planar_impact_lifted_to_space_is_the_spatial_impact(
    motion: tuple[float, float, float], r_x: float, mu: float, e: float, azimuth: float
) -> None:
    """Two algorithms for one embedded problem: the plane's closed form and space's path of impulse."""
    v_x, v_z, w = motion
    turn = Rotation.from_euler("z", azimuth)
    before = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=turn.as_quat(),
        v_WB_W=turn.apply([v_x, 0.0, v_z]),
        w_WB_W=turn.apply([0.0, w, 0.0]),
    )
    point = turn.apply([r_x, 0.0, -0.5])
    touching = ContactSet(p_WC_W=point[None], normals_W=UP[None], frictions=[mu], restitutions=[e])
    if before.velocity_of_point(point)[2] > -1e-3:
        return
    plane = PlaneOfMotion(normal_W=turn.apply([0.0, -1.0, 0.0]))
    problem = project_onto_plane(
        BODY, before, touching, plane=plane, force_W=NONE, torque_W=NONE, speed_tolerance=1e-12
    )
    flat = planar_impact(problem.body, problem.velocity, problem.contacts[0])
    deep = spatial_impact(BODY, before, Contact(p_WC_W=point, normal_W=UP, friction=mu, restitution=e))
    scale = 1e-9 * (
        1.0 + float(np.linalg.norm(deep.impulse_W))
    )  # the path's series are summed to about 1e-12
    np.testing.assert_allclose(plane.lift(flat.velocity.v), deep.state.v_WB_W, atol=scale)
    np.testing.assert_allclose(flat.velocity.w * plane.normal_W, deep.state.w_WB_W, atol=scale)


PLANE = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])
CENTRE = np.array([0.3, 0.2, 0.1])
STATE = BodyState(p_WB_W=CENTRE, q_WB=[0.0, 0.0, 0.0, 1.0])


def contacts(arms: list[tuple[float, ...]], frictions: list[float] | None = None) -> ContactSet:
    n = len(arms)
    return ContactSet(
        p_WC_W=CENTRE + np.array(arms, dtype=float).reshape(-1, 3),
        normals_W=[0.0, 0.0, 1.0],
        frictions=np.array(frictions or [0.5] * n),
        restitutions=0.0,
    )


def partners(found: ContactSet, tolerance: float = 1e-6) -> tuple[int, ...]:
    return mirror_partners(PLANE, STATE, found, distance_tolerance=tolerance)


def test_each_foot_has_its_mirror_image() -> None:
    feet = [(1.0, 0.5, -1.0), (1.0, -0.5, -1.0), (0.2, 0.0, -1.0), (-1.0, -0.5, -1.0), (-1.0, 0.5, -1.0)]
    assert partners(contacts(feet)) == (1, 0, 2, 4, 3)
    assert partners(contacts([])) == ()


def test_coincident_contacts_are_paired_one_by_one() -> None:
    twice = [(1.0, 0.5, -1.0)] * 2 + [(1.0, -0.5, -1.0)] * 2
    found = partners(contacts(twice))
    assert sorted(found) == [0, 1, 2, 3]
    assert all(found[found[i]] == i for i in range(4))
    assert {found[0], found[1]} == {2, 3}


@pytest.mark.parametrize(
    ("arms", "frictions"),
    [
        ([(1.0, 0.5, -1.0)], None),
        ([(1.0, 0.5, -1.0), (1.0, -0.4, -1.0)], None),
        ([(1.0, 0.5, -1.0), (1.0, 0.5, -1.0)], None),
        ([(1.0, 0.5, -1.0), (1.0, -0.5, -1.0)], [0.5, 0.4]),
    ],
    ids=["alone", "not opposite", "on one side", "of another friction"],
)
def test_what_has_none_is_refused_with_its_distance(
    arms: list[tuple[float, ...]], frictions: list[float] | None
) -> None:
    found = contacts(arms, frictions)
    assert partners(found)[0] == -1
    with pytest.raises(OutOfPlaneError, match=r"contacts.p_WC_W\[0\] must be .*, got 0.5 m beside the plane"):
        check_mirrored(PLANE, STATE, found, partners(found))


def test_noise_of_half_a_degree_does_not_part_a_pair() -> None:
    tilt = 0.4 * math.radians(1.0)
    feet = [(1.0, 0.5, -1.0 + 0.5 * tilt), (1.0, -0.5, -1.0 - 0.5 * tilt)]
    assert partners(contacts(feet)) == (1, 0)
    far = [(1.0, 0.5, -0.9), (1.0, -0.5, -1.1)]
    assert partners(contacts(far)) == (-1, -1)
    assert partners(contacts(far), tolerance=0.2) == (1, 0)


def test_pairs_share_equally_and_others_keep_theirs() -> None:
    forces = np.array([[0.0, 0.0, 4.0], [1.0, 0.0, 0.0], [0.0, 0.0, 7.0], [0.0, 0.0, 9.0]])
    shared = equal_shares(forces, (1, 0, 2, -1))
    np.testing.assert_array_equal(shared[:2], [[0.5, 0.0, 2.0]] * 2)
    np.testing.assert_array_equal(shared[2:], forces[2:])
