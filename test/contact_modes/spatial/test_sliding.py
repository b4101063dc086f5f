# SPDX-License-Identifier: Apache-2.0
"""Ways of sticking and sliding together: known counts, strings beside linear programs, sampled motions."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import linprog

from contact_dynamics import BodyState, ContactSet
from contact_dynamics.contact_modes import spatial_kinematic_modes, spatial_sliding_modes
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.vectors import tangents_towards
from sweeps import seeds

X, Y, Z = np.eye(3)
WAYS = "0123456789ABCDEF"


def contact_set(points: np.ndarray, normals: np.ndarray) -> ContactSet:
    n = len(points)
    return ContactSet(
        p_WC_W=points.reshape(-1, 3),
        normals_W=normals.reshape(-1, 3)
        / np.maximum(np.linalg.norm(normals.reshape(-1, 3), axis=1), 1.0)[:, None],
        frictions=np.ones(n),
    )


def box_at(*walls: tuple[np.ndarray, np.ndarray, np.ndarray]) -> ContactSet:
    """Return the corners of a unit cube on walls, given by normal and two tangents."""
    corners = [
        (-0.5 * (normal + i * one + j * two), normal)
        for normal, one, two in walls
        for i in (1.0, -1.0)
        for j in (1.0, -1.0)
    ]
    return contact_set(np.array([point for point, _ in corners]), np.array([normal for _, normal in corners]))


FLOOR, WALL = (Z, X, Y), (Y, Z, X)


def drawn(seed: int) -> ContactSet:
    """Return two contacts, at whole places with whole normals if the seed is odd."""
    chance = np.random.default_rng(seed)
    points, normals = chance.normal(size=(2, 3)), chance.normal(size=(2, 3))
    if seed % 2:
        points, normals = chance.integers(-1, 2, size=(2, 3)) * 1.0, chance.integers(-1, 2, size=(2, 3)) * 1.0
        normals[~normals.any(axis=1)] = Z
    return contact_set(points, normals / np.linalg.norm(normals, axis=1)[:, None])


def possible(contacts: ContactSet, mode: str, planes: int) -> bool:
    """Return whether some acceleration has these letters, by a linear program."""
    zero, positive = [], []
    for point, normal, letter in zip(contacts.p_WC_W, contacts.normals_W, mode, strict=True):

        def row(way: np.ndarray, point: np.ndarray = point) -> np.ndarray:
            return np.concatenate([way, np.cross(point, way)])

        one, two = tangents_towards(normal)
        (positive if letter == "s" else zero).append(row(normal))
        if letter == "f":
            zero += [row(one), row(two)]
        elif letter != "s":
            item = WAYS.index(letter)
            start, end = math.pi * (item // 2) / planes, math.pi * ((item + 1) // 2) / planes
            after = row(-math.sin(start) * one + math.cos(start) * two)
            before = row(math.sin(end) * one - math.cos(end) * two)
            if item % 2:
                positive += [after, before]
            else:
                zero.append(after)
                positive.append(row(math.cos(start) * one + math.sin(start) * two))
    outcome = linprog(
        [0.0] * 6 + [-1.0],
        A_eq=[np.append(one, 0.0) for one in zero] or None,
        b_eq=[0.0] * len(zero) or None,
        A_ub=[np.append(-one, 1.0) for one in positive] or None,
        b_ub=[0.0] * len(positive) or None,
        bounds=[(-1.0, 1.0)] * 6 + [(0.0, 1.0)],
    )
    return bool(outcome.status == 0 and -outcome.fun > 1e-7)


@pytest.mark.parametrize(
    ("contacts", "count"),
    [
        (contact_set(np.zeros((0, 3)), np.zeros((0, 3))), 1),
        # Separates, sticks, slides along four half-lines or in four quadrants.
        (contact_set(np.zeros((1, 3)), Z), 10),
        # The program that Huang, Cheng and Mason published finds as many for a box on a table.
        (box_at(FLOOR), 196),
        # At a wall as well it finds 1164, the sum over contacting modes of all faces of their planes: its
        # conditions that the other contacts separate are switched off. With them 228 are left.
        (box_at(FLOOR, WALL), 228),
    ],
)
def test_known_counts(contacts: ContactSet, count: int) -> None:
    assert len(spatial_sliding_modes(contacts)) == count


@pytest.mark.parametrize(("seed", "planes"), [(0, 2), (3, 2), (5, 3)])
def test_every_string_of_two_contacts(seed: int, planes: int) -> None:
    contacts = drawn(seed)
    strings = ["".join(letters) for letters in itertools.product("sf" + WAYS[: 4 * planes], repeat=2)]
    expected = [mode for mode in strings if possible(contacts, mode, planes)]
    assert list(spatial_sliding_modes(contacts, planes=planes)) == sorted(expected)


def test_a_box_at_two_walls_has_these_modes_and_no_others() -> None:
    contacts = box_at(FLOOR, WALL)
    modes = spatial_sliding_modes(contacts)
    assert all(possible(contacts, mode, 2) for mode in modes)


@seeds(range(6))
def test_contacting_modes_are_those_without_the_ways(seed: int) -> None:
    contacts = drawn(seed)
    at_rest = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0])
    modes = spatial_sliding_modes(contacts, planes=4)
    assert len(set(modes)) == len(modes)
    staying = {"".join("s" if letter == "s" else "c" for letter in mode) for mode in modes}
    assert staying == set(spatial_kinematic_modes(at_rest, contacts))


def test_misuse_is_refused_by_name() -> None:
    with pytest.raises(TooLargeError, match="contacts"):
        spatial_sliding_modes(box_at(FLOOR, WALL, (X, Y, Z)))
