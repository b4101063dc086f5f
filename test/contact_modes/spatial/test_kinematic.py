# SPDX-License-Identifier: Apache-2.0
"""Contacting and separating modes in space: counts by hand, and every string beside a linear program."""

from __future__ import annotations

import itertools
import subprocess
import sys

import numpy as np
import pytest
from scipy.optimize import linprog

from contact_dynamics.contact import ContactSet, Curvatures
from contact_dynamics.contact_modes import spatial_kinematic_modes
from contact_dynamics.errors import TooLargeError
from contact_dynamics.rigid_body import BodyState
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
        (TABLE + face_of_cube(2, 1.0), 1),
        ([pair for axis in range(3) for side in (-1.0, 1.0) for pair in face_of_cube(axis, side)], 1),
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
