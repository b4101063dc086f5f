# SPDX-License-Identifier: Apache-2.0
"""Moving bodies that roll, slide over corners and over curved ground: forces known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.contact import ContactSet, Curvatures
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.contact_modes import PlanarMode, contact_modes, spatial_kinematic_modes
from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench, PlaneOfMotion
from contact_dynamics.plane.projection import project_onto_plane
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.shapes.convex import cylinder
from contact_dynamics.world import Body, Surface, World
from contact_modes.evidence import planar_problem, spatial_problem

G = 10.0
M, R = 2.0, 0.25
DISC = PlanarBody(mass=M, inertia=0.5 * M * R * R)
WEIGHT = PlanarWrench(f=(0.0, -M * G))
INF = math.inf


def contact(
    k_B: float, k_S: float, *, r: tuple[float, float] = (0.0, -R), friction: float = 0.8
) -> PlanarContact:
    return PlanarContact(r=r, normal=(0.0, 1.0), friction=friction, body_curvature=k_B, surface_curvature=k_S)


def only(velocity: PlanarVelocity, *contacts: PlanarContact, body: PlanarBody = DISC) -> PlanarMode:
    answer = contact_modes(planar_problem(body, velocity, contacts, WEIGHT))
    assert len(answer.modes) == 1, [mode.mode for mode in answer.modes]
    return answer.modes[0]


def rolling(speed: float) -> PlanarVelocity:
    return PlanarVelocity(v=(speed, 0.0), w=-speed / R)


def test_a_disc_that_rolls_on_a_floor_weighs_what_it_does_at_rest() -> None:
    mode = only(rolling(3.0), contact(1.0 / R, 0.0))
    assert mode.mode == "f"
    assert mode.contact_forces[0] == pytest.approx((0.0, M * G), abs=1e-12)
    assert mode.acceleration == pytest.approx((0.0, 0.0), abs=1e-12)


def test_a_corner_of_it_would_be_thrown_up() -> None:
    """The same motion about a corner below the centre: it carries m v^2 / R less, and then lifts off."""
    assert only(rolling(1.0), contact(INF, 0.0)).contact_forces[0][1] == pytest.approx(M * (G - 1.0 / R))
    assert only(rolling(3.0), contact(INF, 0.0)).mode == "s"


@pytest.mark.parametrize(("speed", "letter"), [(1.5, "f"), (1.6, "s")])
def test_a_disc_that_pivots_over_a_step_leaves_it_above_v2_equal_g_R(speed: float, letter: str) -> None:
    mode = only(rolling(speed), contact(1.0 / R, INF, friction=10.0))
    assert mode.mode == letter
    if letter == "f":
        assert mode.contact_forces[0][1] == pytest.approx(M * (G - speed * speed / R), rel=1e-12)


def test_a_disc_that_slides_over_a_step_without_friction() -> None:
    """Its centre goes around the corner, whatever it spins: the force is m (g - v^2 / R)."""
    for w in (-7.0, 0.0, 3.0):
        mode = only(PlanarVelocity(v=(1.2, 0.0), w=w), contact(1.0 / R, INF, friction=0.0))
        assert mode.contact_forces[0][1] == pytest.approx(M * (G - 1.2**2 / R), rel=1e-12)


@pytest.mark.parametrize(("curvature", "speed"), [(0.5, 3.0), (0.5, 5.0), (-0.5, 5.0)])
def test_a_block_that_slides_over_a_hill_or_through_a_valley(curvature: float, speed: float) -> None:
    """N = m (g - k v^2) while that is positive; friction is mu N, here through the centre of mass."""
    slider = contact(INF, curvature, r=(0.0, 0.0), friction=0.3)
    mode = only(PlanarVelocity(v=(speed, 0.0), w=0.0), slider)
    force = M * (G - curvature * speed * speed)
    if force < 0.0:
        assert mode.mode == "s"
    else:
        assert mode.mode == "r"
        assert mode.contact_forces[0] == pytest.approx((-0.3 * force, force), rel=1e-12)


def test_a_plank_that_rocks_on_a_cylinder() -> None:
    """Without thickness and level its centre is at R (sin q - q cos q, cos q + q sin q): y'' = R q'^2."""
    plank = PlanarBody(mass=M, inertia=0.3)
    rocking = PlanarVelocity(v=(0.0, 0.0), w=2.0)
    mode = only(rocking, contact(0.0, 1.0 / R, r=(0.0, 0.0)), body=plank)
    assert mode.mode == "f"
    assert mode.acceleration == pytest.approx((0.0, R * 4.0), abs=1e-12)
    assert mode.contact_forces[0] == pytest.approx((0.0, M * (G + R * 4.0)), rel=1e-12)


def test_a_plank_that_slides_and_turns_over_a_corner() -> None:
    """No friction, level, the corner below its centre: y = -x tan q, so y'' = -2 v q' where x = 0."""
    plank = PlanarBody(mass=M, inertia=0.3)
    mode = only(
        PlanarVelocity(v=(0.5, 0.0), w=1.5), contact(0.0, INF, r=(0.0, 0.0), friction=0.0), body=plank
    )
    assert mode.acceleration[1] == pytest.approx(2.0 * 0.5 * 1.5, rel=1e-12)


def test_several_contacts_have_their_own_terms() -> None:
    """A disc that spins against two frictionless walls of a groove: they feel its weight and no more."""
    slope = math.sqrt(0.5)
    walls = [
        PlanarContact(
            r=(side * R * slope, -R * slope),
            normal=(-side * slope, slope),
            friction=0.0,
            body_curvature=1.0 / R,
        )
        for side in (-1.0, 1.0)
    ]
    answer = contact_modes(planar_problem(DISC, PlanarVelocity(v=(0.0, 0.0), w=20.0), walls, WEIGHT))
    assert len(answer.modes) == 1
    for _, f_n in answer.modes[0].contact_forces:
        assert f_n == pytest.approx(M * G * slope, rel=1e-9)
    assert answer.modes[0].acceleration == pytest.approx((0.0, 0.0), abs=1e-8)


@pytest.mark.parametrize("first", [True, False])
def test_each_contact_has_the_terms_of_its_own_kind(*, first: bool) -> None:
    """A disc rolls on the floor; a pin at its top leaves the ceiling as it comes round, down at w^2 R."""
    pin = PlanarContact(r=(0.0, R), normal=(0.0, -1.0), friction=0.0)
    disc = contact(1.0 / R, 0.0)
    mode = only(rolling(3.0), *((disc, pin) if first else (pin, disc)))
    assert mode.mode == ("fs" if first else "sf")
    assert mode.contact_forces[0 if first else 1] == pytest.approx((0.0, M * G), abs=1e-8)
    assert mode.contact_accelerations[1 if first else 0][1] == pytest.approx(9.0 / R)


FLOOR = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=[0.0, 0.0, 1.0], friction=0.8, restitution=0.0)
FROM_THE_FRONT = PlaneOfMotion(normal_W=[0.0, -1.0, 0.0])


def state(q: tuple[float, ...], v: tuple[float, ...], w: tuple[float, ...]) -> BodyState:
    return BodyState(p_WB_W=[0.0, 0.0, R], q_WB=np.array(q), v_WB_W=np.array(v), w_WB_W=np.array(w))


def test_a_ball_found_on_the_floor_rolls_and_pivots_without_force_but_its_weight() -> None:
    ball = Body.sphere(R, mass=M, name="ball")
    now = state((0.1, 0.7, -0.1, 0.7), (1.0, -0.5, 0.0), (0.5 / R, 1.0 / R, 6.0))
    contacts = find_contacts(ball, now, World(surfaces=(FLOOR,)))
    answer = contact_modes(spatial_problem(ball.mass_properties, now, contacts, (0.0, 0.0, -M * G)))
    assert [mode.mode for mode in answer.modes] == ["f"]
    np.testing.assert_allclose(answer.modes[0].contact_forces_W, [[0.0, 0.0, M * G]], atol=1e-6)
    np.testing.assert_allclose(answer.modes[0].acceleration_W, np.zeros(3), atol=1e-6)


def test_a_can_found_on_its_side_rolls_in_space_as_in_its_plane() -> None:
    can = Body(
        name="can",
        mass_properties=MassProperties(mass=M, I_B=np.diag([0.05, 0.05, 0.5 * M * R * R])),
        shape=cylinder(radius=R, length=0.4),
    )
    lying = state((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)), (3.0, 0.0, 0.0), (0.0, 3.0 / R, 0.0))
    contacts = find_contacts(can, lying, World(surfaces=(FLOOR,)))
    assert len(contacts) == 2
    problem = project_onto_plane(
        can.mass_properties,
        lying,
        contacts,
        plane=FROM_THE_FRONT,
        force_W=np.array([0.0, 0.0, -M * G]),
        torque_W=np.zeros(3),
    )
    assert [flat.body_curvature for flat in problem.contacts] == pytest.approx([1.0 / R] * 2)
    answer = contact_modes(planar_problem(problem.body, problem.velocity, problem.contacts, problem.wrench))
    assert [mode.mode for mode in answer.modes] == ["ff"]
    assert sum(f_n for _, f_n in answer.modes[0].contact_forces) == pytest.approx(M * G, rel=1e-9)
    in_space = contact_modes(spatial_problem(can.mass_properties, lying, contacts, (0.0, 0.0, -M * G)))
    assert "ff" in [mode.mode for mode in in_space.modes]
    total = in_space.modes[0].contact_forces_W.sum(axis=0)
    np.testing.assert_allclose(total, [0.0, 0.0, M * G], atol=1e-5)


def test_a_can_that_lies_askew_to_the_plane_is_refused() -> None:
    askew = Curvatures(along=[4.0], across=[INF], directions_W=[[math.sqrt(0.5), math.sqrt(0.5), 0.0]])
    contacts = ContactSet(
        p_WC_W=np.zeros((1, 3)), normals_W=[[0.0, 0.0, 1.0]], frictions=[0.5], body_curvatures=askew
    )
    with pytest.raises(OutOfPlaneError, match="body_curvatures"):
        project_onto_plane(
            MassProperties(mass=M, I_B=np.eye(3)),
            state((0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)),
            contacts,
            plane=FROM_THE_FRONT,
            force_W=np.zeros(3),
            torque_W=np.zeros(3),
        )


@pytest.mark.parametrize("turned", [0.0, 0.3, 1.1, 2.0])
def test_a_can_that_rolls_may_do_what_one_at_rest_may(turned: float) -> None:
    """Its centripetal terms cancel but for rounding, which must not count as acceleration."""
    radius = 0.237
    can = Body(
        name="can",
        mass_properties=MassProperties(mass=M, I_B=np.diag([0.05, 0.05, 0.5 * M * radius * radius])),
        shape=cylinder(radius=radius, length=0.4),
    )
    ahead = np.array([math.cos(turned), math.sin(turned), 0.0])
    q = (Rotation.from_euler("z", turned) * Rotation.from_euler("x", 90.0, degrees=True)).as_quat()
    lying = BodyState(
        p_WB_W=[0.0, 0.0, radius],
        q_WB=q,
        v_WB_W=3.0 * ahead,
        w_WB_W=np.cross([0.0, 0.0, 1.0], ahead) * 3.0 / radius,
    )
    assert spatial_kinematic_modes(lying, find_contacts(can, lying, World(surfaces=(FLOOR,)))) == (
        "cc",
        "cs",
        "sc",
        "ss",
    )
