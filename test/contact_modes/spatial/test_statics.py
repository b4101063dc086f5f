# SPDX-License-Identifier: Apache-2.0
"""Statics in space: closed forms, and the plane's answers where a case is planar."""

from __future__ import annotations

import contextlib
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    BodyStatics,
    Certainty,
    PlanarContactProblem,
    SpatialContactProblem,
    contact_modes,
    statics,
)
from contact_dynamics.errors import TooLargeError, UndecidedError
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarWrench
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import balance, pyramid_wrenches, spatial_problem
from sweeps import seeds

WEIGHT, MU, HEIGHT = 20.0, 0.5, 0.25
BODY = MassProperties(mass=2.0, I_B=0.7 * np.eye(3))
STATE = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
FEET = [(x, y, -HEIGHT) for x in (-1.0, 1.0) for y in (-0.6, 0.6)]
SOLVED = 1e-9  # relative: facets of a hull of some dozen points


def touching(
    points: list[tuple[float, ...]], normals: list[tuple[float, ...]], friction: float = MU
) -> ContactSet:
    return ContactSet(
        p_WC_W=np.array(points, dtype=float).reshape(-1, 3),
        normals_W=np.array(normals, dtype=float).reshape(-1, 3),
        frictions=friction,
    )


def on_floor(points: list[tuple[float, ...]], friction: float = MU) -> ContactSet:
    return touching(points, [(0.0, 0.0, 1.0)] * len(points), friction)


def pushed(
    x: float = 0.0, y: float = 0.0, *, length: float = 1e3, facets: int = 8, friction: float = MU
) -> BodyStatics:
    return statics(
        spatial_problem(BODY, STATE, on_floor(FEET, friction), (x, y, -WEIGHT), friction_facets=facets),
        margin_length=length,
    )


def test_a_table_tips_over_its_nearest_edge_or_turns_on_its_feet() -> None:
    # With a long length torques cost next to nothing. Rough feet: the weight's torque about the nearest edge.
    rough = pushed(friction=2.0)
    assert rough.stable_disturbance == pytest.approx(WEIGHT * 0.6 / 1e3, rel=1e-6)
    assert (rough.equilibrium, rough.jammed, rough.wedged) == (Certainty.CERTAIN, Certainty.NO, False)
    # Smooth ones turn first: all friction at the feet's distance from the middle, to the pyramid's 8 %.
    turns = MU * WEIGHT * math.hypot(1.0, 0.6) / 1e3
    assert math.cos(math.pi / 8.0) * turns <= pushed().stable_disturbance <= turns


@pytest.mark.parametrize("facets", [4, 8, 16])
def test_the_disturbance_is_the_pyramids_within_the_round_cone(facets: int) -> None:
    # Short length: torques cost all. A regular pyramid's sides are nearer than the cone by cos(pi / facets).
    low = on_floor([(x, y, -1e-6) for x, y, _ in FEET])
    found = statics(
        spatial_problem(BODY, STATE, low, (0.0, 0.0, -WEIGHT), friction_facets=facets), margin_length=1e-4
    )
    slope = MU * math.cos(math.pi / facets)
    assert found.stable_disturbance == pytest.approx(WEIGHT * slope / math.hypot(1.0, slope), rel=1e-4)
    assert found.stable_disturbance <= WEIGHT * MU / math.hypot(1.0, MU) + SOLVED


def test_two_soft_less_fingers_cannot_hold_a_twist_but_three_hold_all() -> None:
    # Points without torsional friction: a body turns about the line of two, and not about three.
    two = touching([(-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)], [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
    nothing = {"force_W": (0.0, 0.0, 0.0)}
    found = statics(SpatialContactProblem(body=BODY, state=STATE, contacts=two, **nothing))
    assert found.wedged
    assert found.stable_disturbance == 0.0
    twisted = statics(spatial_problem(BODY, STATE, two, (0.0, 0.0, 0.0), (0.1, 0.0, 0.0)))
    assert twisted.equilibrium == Certainty.NO
    assert statics(spatial_problem(BODY, STATE, two, (0.0, 0.0, -5.0))).equilibrium != Certainty.NO
    angles = [0.0, 2.0 * math.pi / 3.0, 4.0 * math.pi / 3.0]
    three = touching(
        [(math.cos(a), math.sin(a), 0.0) for a in angles], [(-math.cos(a), -math.sin(a), 0.0) for a in angles]
    )
    held = statics(SpatialContactProblem(body=BODY, state=STATE, contacts=three, **nothing))
    assert held.wedged
    assert math.isinf(held.stable_disturbance)
    slippery = touching(
        [(math.cos(a), math.sin(a), 0.0) for a in angles],
        [(-math.cos(a), -math.sin(a), 0.0) for a in angles],
        0.0,
    )
    loose = statics(SpatialContactProblem(body=BODY, state=STATE, contacts=slippery, **nothing))
    assert loose.wedged
    assert loose.stable_disturbance == 0.0


@pytest.mark.parametrize("heading", [0.0, 0.2, 0.39, 1.0, 2.2])
@pytest.mark.parametrize("more", [-1e-6, 1e-6])
def test_two_fingers_wedge_up_to_the_angle_of_friction_in_any_direction(heading: float, more: float) -> None:
    # The line of the fingers leans against their normals by nearly all that friction allows.
    lean = (1.0 + more) * MU
    up = np.array([1.0, lean * math.cos(heading), lean * math.sin(heading)])
    fingers = touching([tuple(-up), tuple(up)], [(1.0, 0.0, 0.0), (-1.0, 0.0, 0.0)])
    found = statics(spatial_problem(BODY, STATE, fingers, (0.0, 0.0, 0.0), friction_facets=5))
    assert found.wedged == (more < 0.0)


@seeds(range(16))
def test_planar_cases_have_the_planes_answer(seed: int) -> None:
    """Contacts in pairs on both sides of the plane, and a wrench within it."""
    chance = np.random.default_rng(seed)
    contacts, points, normals = [], [], []
    for _ in range(int(chance.integers(1, 4))):
        x, z, angle = chance.uniform(-1.0, 1.0), chance.uniform(-1.0, 1.0), chance.uniform(0.0, 2.0 * math.pi)
        normal = (math.cos(angle), math.sin(angle))
        contacts.append(PlanarContact(r=(float(x), float(z)), normal=normal, friction=MU))
        points += [(x, -1.0, z), (x, 1.0, z)]
        normals += [(normal[0], 0.0, normal[1])] * 2
    # Half the wrenches are made of contact forces, so that equilibrium is as frequent as not.
    force, moment = chance.normal(size=2), float(chance.normal())
    if seed % 2:
        parts = [chance.uniform(0.1, 1.0) * np.array(one.normal) for one in contacts]
        force = -sum(parts, np.zeros(2))
        moment = -sum(one.r[0] * f[1] - one.r[1] * f[0] for one, f in zip(contacts, parts, strict=True))
    plane = statics(
        PlanarContactProblem(
            body=PlanarBody(mass=2.0, inertia=0.7),
            contacts=contacts,
            wrench=PlanarWrench(f=(force[0], force[1]), moment=moment),
        )
    )
    space = statics(
        spatial_problem(
            BODY,
            STATE,
            touching(points, normals),
            (force[0], 0.0, force[1]),
            (0.0, -moment, 0.0),
            friction_facets=16,
        )
    )
    assert space.wedged == plane.wedged
    if not math.isnan(plane.stable_disturbance) and plane.stable_disturbance < 1e-3:
        return  # too near the cone's side for a pyramid whose edges lean elsewhere
    assert (space.equilibrium == Certainty.NO) == (plane.equilibrium == Certainty.NO)
    if space.equilibrium != Certainty.NO:
        assert space.stable_disturbance <= plane.stable_disturbance * (1.0 + 1e-6)
        assert (space.jammed == Certainty.NO) == (plane.jammed == Certainty.NO)


# Three corners on a floor, each found twice, with normals that are some 1e-5 rad apart.
CORNERS = np.array([(0.6, -1.0, -0.5), (-0.1, -0.6, -0.5), (-0.6, -0.4, -0.5)] * 2)
LEANING = np.array(
    [(-10.8, 3.9), (-4.7, 13.499), (15.2, 30.5), (21.999, -1.7), (-28.599, -22.199), (-5.6, -10.2)]
)


def test_corners_found_twice_have_an_answer_in_every_attitude() -> None:
    """Rounding depends on the attitude as on the machine: in half of them Qhull alone gives up."""
    normals = np.column_stack([1e-6 * LEANING, np.ones(len(LEANING))])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    force = -normals.sum(axis=0) + [0.1, 0.05, 0.0]
    torque = -np.cross(CORNERS, normals).sum(axis=0)
    found = [
        statics(
            spatial_problem(
                BODY,
                STATE,
                touching(list(map(tuple, CORNERS @ R.T)), list(map(tuple, normals @ R.T))),
                R @ force,
                R @ torque,
                friction_facets=16,
            )
        )
        for R in Rotation.random(6, random_state=22).as_matrix()
    ]
    rooms = [one.stable_disturbance for one in found]
    assert min(rooms) > 0.01
    assert rooms == pytest.approx([rooms[0]] * len(rooms), rel=1e-6)


@pytest.mark.parametrize("apart", [10.0**-i for i in range(6, 15)])
def test_contacts_that_nearly_coincide_are_answered_or_refused_by_name(apart: float) -> None:
    normals = np.array([(0.68508724, 0.41538837, -0.59842124), (-0.31675377, -0.29525161, 0.90138423)])
    point = np.array([-0.51296316, -1.24467599, 1.11255807])
    chance = np.random.default_rng(3)
    for _ in range(20):
        points = [tuple(point), tuple(point + apart * chance.normal(size=3))]
        force, torque = chance.normal(size=3), chance.normal(size=3)
        with contextlib.suppress(UndecidedError):
            found = statics(
                spatial_problem(BODY, STATE, touching(points, list(map(tuple, normals)), 0.3), force, torque)
            )
            assert found.equilibrium == Certainty.NO  # a torque about the one point cannot be balanced


def can_balance(found: ContactSet, wrench: np.ndarray, share: float) -> bool:
    """Whether forces in cones of 64 edges, friction scaled by ``share``, balance a wrench."""
    return balance(pyramid_wrenches(found, 64, share), wrench)


@seeds(range(5), slow=range(5, 12))
def test_linear_programs_over_the_forces_agree(seed: int) -> None:
    """The answer lies between pyramids inside ours and cones around ours. There are many coincidences."""
    chance = np.random.default_rng(seed)
    n, whole = int(chance.integers(2, 6)), seed % 2 == 0
    normals = np.ones((1, 3))
    while len(normals) != n or not normals.any(axis=1).all():
        normals = chance.integers(-1, 2, size=(n, 3)).astype(float) if whole else chance.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    points = chance.integers(-1, 2, size=(n, 3)).astype(float) if whole else chance.normal(size=(n, 3))
    found = touching(list(map(tuple, points)), list(map(tuple, normals)))
    wrench = -np.concatenate([normals.sum(axis=0), np.cross(points, normals).sum(axis=0)])
    wrench += 0.3 * chance.normal(size=6) * (seed % 3)
    held = statics(spatial_problem(BODY, STATE, found, wrench[:3], wrench[3:]), margin_length=1.0)
    inner, outer = math.cos(math.pi / 8.0), 1.0 / math.cos(math.pi / 64.0)
    if can_balance(found, wrench, inner):
        assert held.equilibrium != Certainty.NO
    if held.equilibrium != Certainty.NO:
        assert can_balance(found, wrench, outer)
        room = min(held.stable_disturbance, 10.0)
        for way in chance.normal(size=(5, 6)):
            assert can_balance(found, wrench + 0.999 * room * way / np.linalg.norm(way), outer)


def test_without_contacts_only_nothing_is_held() -> None:
    none = on_floor([])
    assert statics(spatial_problem(BODY, STATE, none, (0, 0, -1))).equilibrium == Certainty.NO
    assert statics(spatial_problem(BODY, STATE, none, (0, 0, 0))).equilibrium == Certainty.CERTAIN


def test_misuse_is_refused_by_name() -> None:
    with pytest.raises(TooLargeError, match="edges"):
        pushed(facets=64)


@pytest.mark.parametrize("decade", range(-14, -3))
def test_what_rounding_hides_does_not_take_the_other_answers_with_it(decade: int) -> None:
    # Whether friction alone keeps such a box at rest hangs on the last digits of its normals.
    feet = [(x, y, 0.0) for x in (-0.1, 0.1) for y in (-0.1, 0.1)]
    for seed in range(3):
        normals = [0.0, 0.0, 1.0] + 10.0**decade * np.random.default_rng([seed, -decade]).normal(size=(4, 3))
        found = statics(
            spatial_problem(
                MassProperties(mass=1.0, I_B=np.diag([0.01, 0.012, 0.015])),
                BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1]),
                ContactSet(
                    p_WC_W=feet, normals_W=normals / np.linalg.norm(normals, axis=1)[:, None], frictions=0.5
                ),
                (0.0, 0.0, -9.8),
            )
        )
        assert (found.equilibrium, found.wedged) == (Certainty.CERTAIN, False)
        assert found.stable_disturbance > 1.0
        assert found.jammed in {Certainty.NO, Certainty.CERTAIN, Certainty.UNKNOWN}


@pytest.mark.parametrize("friction", [0.0876, 0.0885, 0.0887, 0.2])
def test_forces_far_beyond_the_weight_hold_a_body_in_a_slot_that_widens(friction: float) -> None:
    """By 5 degrees on either side, whose tangent is 0.0875. It takes 5 to 1e4 times the weight."""
    lean = math.radians(5.0)
    contacts = ContactSet(
        p_WC_W=[[side * 0.1, y, 0.0] for side in (-1, 1) for y in (-0.05, 0.05)],
        normals_W=[[-side * math.cos(lean), 0.0, -math.sin(lean)] for side in (-1, 1) for _ in (-0.05, 0.05)],
        frictions=friction,
    )
    problem = spatial_problem(
        MassProperties(mass=0.2, I_B=1e-4 * np.eye(3)),
        BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1]),
        contacts,
        [0, 0, -1.962],
    )
    assert "ffff" in {mode.mode for mode in contact_modes(problem).modes}
    assert statics(problem).equilibrium == Certainty.POSSIBLE
