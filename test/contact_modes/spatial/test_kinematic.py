# SPDX-License-Identifier: Apache-2.0
"""Contacting and separating modes in space: known counts, and every string beside a linear program.

Huang, Cheng and Mason, Efficient Contact Mode Enumeration in 3D (WAFR 2020), count the modes of a box with
walls (its four corners on each), of a peg in a hole and of a box upon a box. The sets here are theirs, as
their published program draws them, and that program finds the same six counts for the box. Of the counts in
their table 184 is known to us, for the box upon a box at two walls (16 contacts, 9 dimensions); the others
follow from the face counts of polytopes.
"""

from __future__ import annotations

import itertools
import math
import subprocess
import sys

import numpy as np
import pytest
from scipy.optimize import linprog

from contact_dynamics import BodyState, ContactSet
from contact_dynamics.contact import Curvatures
from contact_dynamics.contact_modes import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.kinematic import cone_faces
from contact_dynamics.errors import TooLargeError
from sweeps import seeds

POSITIVE = 1e-7  # slack, of accelerations up to 1, above which a linear program counts a string as possible


def contact_set(pairs: list[tuple[tuple[float, ...], tuple[float, ...]]]) -> ContactSet:
    points = np.array([point for point, _ in pairs], dtype=float).reshape(-1, 3)
    normals = np.array([normal for _, normal in pairs], dtype=float).reshape(-1, 3)
    return ContactSet(
        p_WC_W=points,
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=np.ones(len(pairs)),
    )


def state(v: tuple[float, ...] = (0, 0, 0), w: tuple[float, ...] = (0, 0, 0)) -> BodyState:
    return BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=np.array(v), w_WB_W=np.array(w))


def face_of_cube(axis: int, side: float) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
    """Return the corners of one face of a cube of half-width 1, with normals into the cube."""
    found = []
    for one, two in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
        point, normal = [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3] = side, one, two
        normal[axis] = -side
        found.append((tuple(point), tuple(normal)))
    return found


TABLE = face_of_cube(2, -1.0)


def polygon_on_table(corners: int) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
    angles = 2.0 * np.pi * np.arange(corners) / corners
    return [((np.cos(a), np.sin(a), -1.0), (0.0, 0.0, 1.0)) for a in angles]


def all_strings(now: BodyState, contacts: ContactSet) -> set[str]:
    """Return the modes by a linear program for each of the 2^n strings."""
    r = contacts.p_WC_W - now.p_WB_W
    rows = np.hstack([contacts.normals_W, np.cross(r, contacts.normals_W)])
    turned = np.cross(now.w_WB_W, np.cross(now.w_WB_W, r))
    offsets = np.sum(contacts.normals_W * turned, axis=1)
    v_n = np.sum(contacts.normals_W * (now.v_WB_W + np.cross(now.w_WB_W, r)), axis=1)
    found = set()
    for letters in itertools.product("sc", repeat=len(rows)):
        stay = [i for i, letter in enumerate(letters) if letter == "c"]
        leave = [i for i, letter in enumerate(letters) if letter == "s" and abs(v_n[i]) <= 1e-9]
        if any(v_n[i] > 1e-9 for i in stay):
            continue
        if not leave and not stay:
            found.add("".join(letters))
            continue
        bound = 1.0 if not offsets.any() else 100.0
        outcome = linprog(
            [0.0] * 6 + [-1.0],
            A_eq=np.hstack([rows[stay], np.zeros((len(stay), 1))]) if stay else None,
            b_eq=-offsets[stay] if stay else None,
            A_ub=np.hstack([-rows[leave], np.ones((len(leave), 1))]) if leave else None,
            b_ub=offsets[leave] if leave else None,
            bounds=[(-bound, bound)] * 6 + [(0.0, 1.0)],
        )
        if outcome.status == 0 and -outcome.fun > POSITIVE:
            found.add("".join(letters))
    return found


@pytest.mark.parametrize(
    ("pairs", "count"),
    [
        ([], 1),
        ([((0, 0, -1), (0, 0, 1))], 2),
        ([((0, 0, -1), (0, 0, 1)), ((0, 0, 1), (0, 0, -1))], 1),
        ([((-1, 0, -1), (0, 0, 1)), ((1, 0, -1), (0, 0, 1))], 4),
        ([((-1, 0, -1), (0, 0, 1)), ((0, 0, -1), (0, 0, 1)), ((1, 0, -1), (0, 0, 1))], 4),
        (TABLE, 10),
        (TABLE + TABLE, 10),
        (polygon_on_table(3), 8),
        (polygon_on_table(7), 16),
    ],
)
def test_counts_by_hand(pairs: list, count: int) -> None:
    # A convex m-gon on a table has the faces of a cone over it: 1 + m + m + 1.
    modes = spatial_kinematic_modes(state(), contact_set(pairs))
    assert len(modes) == count
    assert list(modes) == sorted(set(modes))


@seeds(range(12), slow=range(12, 30))
def test_drawn_sets(seed: int) -> None:
    chance = np.random.default_rng(seed)
    n = int(chance.integers(1, 8))
    whole = seed % 2 == 0  # small whole numbers make coincidences
    pairs = []
    while len(pairs) < n:
        if whole:
            point, normal = chance.integers(-1, 2, size=3), chance.integers(-1, 2, size=3)
        else:
            point, normal = chance.normal(size=3), np.array([0.0, 0.0, 1.0]) + chance.normal(size=3)
        if np.any(normal):
            pairs.append((tuple(point), tuple(normal)))
    contacts = contact_set(pairs)
    assert set(spatial_kinematic_modes(state(), contacts)) == all_strings(state(), contacts)


@seeds(range(5), slow=range(5, 12))
def test_a_body_that_turns_about_its_contacts(seed: int) -> None:
    chance = np.random.default_rng(seed)
    centre = chance.normal(size=3)
    w = np.array([0.0, 0.0, 1.0]) if seed % 2 == 0 else chance.normal(size=3)
    pairs = []
    for _ in range(int(chance.integers(1, 6))):
        # A normal whose line meets the axis of rotation: the contact does not move along it.
        point = centre + chance.normal(size=3)
        normal = centre + w * chance.normal() - point
        pairs.append((tuple(point), tuple(normal)))
    now = state(v=tuple(-np.cross(w, centre)), w=tuple(w))
    contacts = contact_set(pairs)
    assert set(spatial_kinematic_modes(now, contacts)) == all_strings(now, contacts)


@seeds(range(8))
def test_a_spin_about_the_normal_changes_nothing_however_the_table_leans(seed: int) -> None:
    # Its centripetal terms lie in the table, but for rounding.
    turned = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    contacts = contact_set([(tuple(turned @ p), tuple(turned @ n)) for p, n in TABLE])
    assert len(spatial_kinematic_modes(state(w=tuple(2.0 * turned[:, 2])), contacts)) == 10


def test_a_wheel_between_two_plates_rolls_and_a_bar_between_them_cannot() -> None:
    places = [((0, 0, -1), (0, 0, 1)), ((0, 0, 1), (0, 0, -1))]
    bar = contact_set(places)
    wheel = ContactSet(
        p_WC_W=bar.p_WC_W,
        normals_W=bar.normals_W,
        frictions=bar.frictions,
        body_curvatures=Curvatures(along=np.ones(2), across=np.ones(2), directions_W=np.zeros((2, 3))),
    )
    rolling = state(v=(2.0, 0.0, 0.0), w=(0.0, 2.0, 0.0))
    # The material points accelerate to the axis, w^2 R, but the wheel's rim stays where it is.
    assert spatial_kinematic_modes(rolling, wheel) == ("cc",)
    assert spatial_kinematic_modes(rolling, bar) == ("cs", "sc", "ss")


def test_approaching_and_leaving_contacts() -> None:
    contacts = contact_set(TABLE)
    assert spatial_kinematic_modes(state(v=(0, 0, 1)), contacts) == ("ssss",)
    assert spatial_kinematic_modes(state(v=(0, 0, -1)), contacts) == ()
    # Tipping about one edge: two leave, two stay or leave.
    tipping = spatial_kinematic_modes(state(v=(1, 0, 1), w=(0, 1, 0)), contacts)
    assert len(tipping) > 1
    assert set(tipping) == all_strings(state(v=(1, 0, 1), w=(0, 1, 0)), contacts)


def test_misuse_is_refused_by_name() -> None:
    with pytest.raises(TooLargeError, match="contacts"):
        spatial_kinematic_modes(state(), contact_set(polygon_on_table(65)))


def test_a_few_contacts_do_not_import_scipy() -> None:
    """Its first import takes longer than a hundred answers."""
    code = """
import sys
import numpy as np
from contact_dynamics import BodyState, ContactSet, MassProperties
from contact_dynamics.contact_modes import SpatialContactProblem, contact_modes, spatial_kinematic_modes
still = np.zeros(3)
body = MassProperties(mass=1.0, I_B=np.eye(3))
state = BodyState(p_WB_W=still, q_WB=np.array([0.0, 0.0, 0.0, 1.0]), v_WB_W=still, w_WB_W=still)
feet = ContactSet(
    p_WC_W=np.array([[x, y, -1.0] for x in (-1.0, 1.0) for y in (-1.0, 1.0)]),
    normals_W=np.tile([0.0, 0.0, 1.0], (4, 1)), frictions=np.full(4, 0.3), restitutions=np.zeros(4),
)
problem = SpatialContactProblem(body=body, state=state, contacts=feet, force_W=(0.0, 0.0, -9.8))
answer = contact_modes(problem)
assert [mode.mode for mode in answer.modes] == ["ffff"]
assert len(spatial_kinematic_modes(state, feet)) == 10
sys.exit("scipy" in sys.modules)
"""
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


X, Y, Z = np.eye(3)
WALLS = [(Z, X, Y), (Y, Z, X), (X, Y, Z), (-X, Z, Y), (-Y, X, Z), (-Z, Y, X)]
AT_REST = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])


def unit_contacts(points: list[np.ndarray], normals: list[np.ndarray]) -> ContactSet:
    n = len(points)
    return ContactSet(p_WC_W=np.array(points), normals_W=np.array(normals), frictions=np.ones(n))


def box_at(walls: int) -> ContactSet:
    """Return the corners of a unit cube on the first of its walls: floor, two walls, the opposite three."""
    points, normals = [], []
    for normal, one, two in WALLS[:walls]:
        for i in (1.0, -1.0):
            for j in (1.0, -1.0):
                points.append(-0.5 * (normal + i * one + j * two))
                normals.append(normal)
    return unit_contacts(points, normals)


@pytest.mark.parametrize(("walls", "count"), [(1, 10), (2, 46), (3, 136), (4, 10), (5, 2), (6, 1)])
def test_a_box_at_walls(walls: int, count: int) -> None:
    # One wall: the cone over a square, 1 + 4 + 4 + 1 faces. Two and three: 46 is a quarter of the published
    # 184 (below), 136 is what a linear program for each of the 2^12 strings finds. Between opposite walls the
    # box keeps three coordinates, and two conditions each from the floor and the third wall: a square again.
    # Four walls around it let it rise, or not; six hold it.
    modes = spatial_kinematic_modes(AT_REST, box_at(walls))
    assert len(modes) == count
    assert "c" * (4 * walls) in modes


def test_a_box_upon_a_box_at_two_walls() -> None:
    # Nine coordinates: the lower box turns about z and moves along x and y, the upper one has all six. The
    # lower box's feet on the floor never leave, and add no row.
    rows = []
    for i in (1.0, -1.0):
        for j in (1.0, -1.0):
            at_wall = -0.5 * (Y + i * Z + j * X)
            lower, upper, between = np.zeros(9), np.zeros(9), np.zeros(9)
            lower[[0, 2]] = at_wall[0], 1.0
            upper[3:] = [*Y, *np.cross(at_wall, Y)]
            foot = -0.4 * (Z + i * X + j * Y)
            between[3:] = [*Z, *np.cross(foot, Z)]
            rows += [lower, upper, between]
    stacked = np.array(rows)
    faces = cone_faces(stacked / np.linalg.norm(stacked, axis=1)[:, None])
    assert len(faces) == 184
    # The boxes' conditions share no coordinate: 4 for a side that turns and leaves, 46 for the upper box.
    assert len(faces) == 4 * len(spatial_kinematic_modes(AT_REST, box_at(2)))


@pytest.mark.parametrize("around", [3, 4, 8])
def test_a_peg_fills_its_hole(around: int) -> None:
    # Two rings of contacts, normals inward: it turns and slides along its axis, and no contact can leave.
    points, normals = [], []
    for height in (6.0, -6.0):
        for k in range(around):
            angle = 2.0 * math.pi * k / around
            outward = np.array([math.cos(angle), math.sin(angle), 0.0])
            points.append(3.0 * outward + height * Z)
            normals.append(-outward)
    assert spatial_kinematic_modes(AT_REST, unit_contacts(points, normals)) == ("c" * (2 * around),)


@pytest.mark.parametrize("n", [7, 8, 9])
def test_a_cyclic_polytope_has_the_most_modes(n: int) -> None:
    # Rows on the moment curve are the facets of the dual of a cyclic polytope, neighbourly, whose faces are
    # the most that n contacts can have (McMullen, 1970): f_k of the cyclic 5-polytope, dual simplicial.
    angles = np.linspace(0.2, 1.0, n)
    curve = np.column_stack([angles**k for k in range(6)])
    faces = cone_faces(curve / np.linalg.norm(curve, axis=1)[:, None])
    # Cyclic polytope C(n, 5): f_0 = n, f_1 = n (n - 1) / 2; Dehn and Sommerville give f_2, f_3, f_4.
    f_0, f_1 = n, n * (n - 1) // 2
    f_2 = 4 * f_1 - 10 * f_0 + 20
    f_3 = 5 * f_1 - 15 * f_0 + 30
    f_4 = 2 * f_1 - 6 * f_0 + 12
    assert len(faces) == 1 + f_0 + f_1 + f_2 + f_3 + f_4 + 1
