# SPDX-License-Identifier: Apache-2.0
"""Contact modes of mechanisms given by W = J M^-1 J^T: beside an enumeration, and beside those of a body."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from contact_dynamics import ContactSet, ModeVerdict
from contact_dynamics.contact_modes import ResponseContactProblem, contact_modes
from contact_dynamics.errors import InvalidFieldError
from contact_modes.evidence import problem_of_made
from oracles.modes_of_planar_mechanism import Mechanism, all_modes, drawn
from oracles.modes_on_planes import INERTIA, MASS, Made, made
from sweeps import seeds


def upright(frictions: Any) -> ContactSet:
    n = len(frictions)
    return ContactSet(p_WC_W=np.zeros((n, 3)), normals_W=[0.0, 0.0, 1.0], frictions=frictions)


def in_space(mechanism: Mechanism) -> ResponseContactProblem:
    """Return the problem of a planar mechanism, which cannot move across its plane."""
    n = len(mechanism.frictions)
    response, free = np.zeros((n, 3, n, 3)), np.zeros((n, 3))
    response[np.ix_(range(n), [0, 2], range(n), [0, 2])] = mechanism.response.reshape(n, 2, n, 2)
    free[:, [0, 2]] = mechanism.free.reshape(n, 2)
    return ResponseContactProblem(
        inverse_inertia_W=response.reshape(3 * n, 3 * n),
        accelerations_W=free,
        contacts=upright(mechanism.frictions),
    )


def in_plane(mode: Any, frictions: np.ndarray) -> str:
    """Return a mode's letters in the plane."""
    letters = ""
    for letter, way, friction in zip(mode.mode, mode.tangential_directions_W, frictions, strict=True):
        if letter == "c" and friction > 0.0:
            letters += "r" if way[0] > 0.0 else "l"
        else:
            letters += "c" if letter == "f" and friction == 0.0 else letter
    return letters


@seeds(range(25), slow=range(25, 2000))
def test_modes_of_drawn_planar_mechanisms_are_those_of_linear_programs(seed: int) -> None:
    """There are more contacts than freedoms in many draws, so that contacts share loads."""
    mechanism = drawn(seed)
    answer = contact_modes(in_space(mechanism))
    found, expected = {in_plane(mode, mechanism.frictions) for mode in answer.modes}, all_modes(mechanism)
    assert found == expected or (answer.verdict == ModeVerdict.UNDECIDED and found <= expected)


def test_few_mechanisms_are_undecided() -> None:
    verdicts = [contact_modes(in_space(drawn(seed))).verdict for seed in range(100)]
    assert verdicts.count(ModeVerdict.UNDECIDED) <= 2


@seeds(range(50), slow=range(50, 1000))
def test_forces_and_accelerations_solve_the_complementarity_problem_to_1e_10(seed: int) -> None:
    mechanism = drawn(seed)
    problem = in_space(mechanism)
    for mode in contact_modes(problem).modes:
        forces, points = mode.contact_forces_W, mode.contact_accelerations_W
        caused = (problem.inverse_inertia_W @ forces.ravel()).reshape(-1, 3)
        size = max(np.abs(problem.accelerations_W).max(), np.abs(caused).max())
        assert np.abs(caused + problem.accelerations_W - points).max() <= 1e-10 * size
        pressing, rising = forces[:, 2], points[:, 2]
        largest = max(np.abs(forces).max(), 1e-300)
        assert pressing.min() >= -1e-10 * largest
        assert rising.min() >= -1e-10 * size
        assert np.abs(pressing * rising).max() <= 1e-10 * largest * size
        friction, slides = forces[:, :2], points[:, :2]
        limits = mechanism.frictions * pressing
        assert (np.linalg.norm(friction, axis=1) - limits).max() <= 1e-10 * largest
        dissipated = np.sum(friction * slides, axis=1) + limits * np.linalg.norm(slides, axis=1)
        assert np.abs(dissipated).max() <= 1e-10 * largest * size


def response_of(case: Made) -> tuple[np.ndarray, np.ndarray]:
    """Return W and the accelerations without contact forces of a body."""
    J = np.zeros((len(case.points), 3, 6))
    for k, unit in enumerate(np.eye(6)):
        J[:, :, k] = unit[:3] + np.cross(unit[3:], case.points)
    rows = J.reshape(-1, 6)
    inverse = np.zeros((6, 6))
    inverse[:3, :3], inverse[3:, 3:] = np.eye(3) / MASS, np.linalg.inv(INERTIA)
    load = case.wrench - np.append(np.zeros(3), np.cross(case.w, INERTIA @ case.w))
    free = (rows @ inverse @ load).reshape(-1, 3) + np.cross(case.w, np.cross(case.w, case.points))
    return rows @ inverse @ rows.T, free


@seeds(range(1, 60, 3), slow=range(1, 600))
def test_w_of_a_body_has_the_modes_of_its_own_problem(seed: int) -> None:
    case = made(seed, most=6)
    alone = problem_of_made(case)
    own = contact_modes(alone)
    response, free = response_of(case)
    answer = contact_modes(
        ResponseContactProblem(
            inverse_inertia_W=response,
            accelerations_W=free,
            contacts=alone.contacts,
            velocities_W=case.v + np.cross(case.w, case.points),
        )
    )
    assert answer.verdict == own.verdict
    assert [mode.mode for mode in answer.modes] == [mode.mode for mode in own.modes]
    for mode, other in zip(answer.modes, own.modes, strict=True):
        if mode.motion_unique:
            expected = other.contact_accelerations_W
            assert mode.contact_accelerations_W == pytest.approx(expected, rel=1e-8, abs=1e-8)
            assert mode.contact_forces_W == pytest.approx(other.contact_forces_W, rel=1e-8, abs=1e-8)


def arm(torque: float, friction: float = 0.5) -> ResponseContactProblem:
    """Return a link of 1 kg on a hinge: its tip, 1 m to the right and 1 m below, can move along (1, 0, 1)."""
    J = np.array([[1.0], [0.0], [1.0]])
    inertia = 0.5  # kg m^2
    return ResponseContactProblem(
        inverse_inertia_W=J @ J.T / inertia,
        accelerations_W=(J[:, 0] * torque / inertia)[None],
        contacts=upright([friction]),
    )


def test_a_link_on_a_hinge_presses_or_leaves() -> None:
    """A torque presses the tip to the floor. The tip cannot slide without lifting, so it sticks."""
    (pressed,) = contact_modes(arm(-1.0)).modes
    assert pressed.mode == "f"
    # Pressing and friction turn the link alike. The least forces that hold it use up all friction.
    assert pressed.contact_forces_W[0] == pytest.approx([1.0 / 3.0, 0.0, 2.0 / 3.0], abs=1e-12)
    assert not pressed.forces_unique
    (leaves,) = contact_modes(arm(2.0)).modes
    assert leaves.mode == "s"
    assert leaves.contact_accelerations_W[0] == pytest.approx([4.0, 0.0, 4.0], abs=1e-12)


@pytest.mark.parametrize(
    ("friction", "expected"), [(0.99, ["c"]), (1.0, []), (1.01, [])], ids=["slides", "border", "jams"]
)
def test_a_link_that_is_pressed_while_its_tip_slides_jams_beyond_a_friction_of_one(
    friction: float, expected: list[str]
) -> None:
    """Friction presses the tip with (-mu, 0, 1), which turns the link the other way for mu > 1 (Painleve)."""
    answer = contact_modes(replace(arm(-1.0, friction), velocities_W=[[1.0, 0.0, 0.0]]))
    assert [mode.mode for mode in answer.modes] == expected
    assert answer.verdict == (ModeVerdict.UNIQUE if expected else ModeVerdict.INCONSISTENT)


@pytest.mark.parametrize("steepness", [0.1, 0.3, 0.65, 1.0, 1.3])
def test_no_mode_has_forces_that_rounding_alone_decides(steepness: float) -> None:
    """The friction is that at which a link jams, but for rounding: forces of 1e16 times the load."""
    way = np.array([np.cos(steepness), 0.0, np.sin(steepness)])
    for velocity in ([0.0, 0.0, 0.0], [1.0, 0.0, 0.0]):
        for sense in (-1.0, 1.0):
            answer = contact_modes(
                ResponseContactProblem(
                    inverse_inertia_W=np.outer(way, way),
                    accelerations_W=[sense * way],
                    contacts=upright([np.tan(steepness)]),
                    velocities_W=velocity,
                )
            )
            assert all(np.abs(mode.contact_forces_W).max() < 100.0 for mode in answer.modes)
            assert answer.modes or answer.verdict in {ModeVerdict.UNDECIDED, ModeVerdict.INCONSISTENT}


def test_without_contacts_that_touch_nothing_acts() -> None:
    (leaves,) = contact_modes(replace(arm(-1.0), velocities_W=[[0.0, 0.0, 1.0]])).modes
    assert leaves.mode == "s"
    assert leaves.contact_accelerations_W[0] == pytest.approx([-2.0, 0.0, -2.0], abs=1e-12)
    nothing = ResponseContactProblem(
        inverse_inertia_W=np.zeros((0, 0)), accelerations_W=np.zeros((0, 3)), contacts=upright([])
    )
    assert [mode.mode for mode in contact_modes(nothing).modes] == [""]


def test_velocities_are_relative_to_surfaces_that_move() -> None:
    """A block on a belt slides, and is pulled along, as one that slides the other way on a floor."""
    floor = ResponseContactProblem(
        inverse_inertia_W=np.eye(3) / 2.0,
        accelerations_W=[0.0, 0.0, -9.81],
        contacts=upright([0.5]),
        velocities_W=[-1.0, 0.0, 0.0],
    )
    belt = replace(
        floor,
        contacts=replace(floor.contacts, surface_velocities_W=[1.0, 0.0, 0.0]),
        velocities_W=np.zeros((1, 3)),
    )
    for problem in (floor, belt):
        (mode,) = contact_modes(problem).modes
        assert mode.mode == "c"
        assert mode.contact_accelerations_W[0] == pytest.approx([0.5 * 9.81, 0.0, 0.0], abs=1e-12)
    faster = replace(belt, velocities_W=[0.0, 0.0, -0.1])
    assert contact_modes(faster).verdict == ModeVerdict.IMPACT


@pytest.mark.parametrize("size", [1e-9, 1e9])
def test_units_do_not_matter(size: float) -> None:
    for seed in range(10):
        problem = in_space(drawn(seed))
        scaled = replace(problem, inverse_inertia_W=size * problem.inverse_inertia_W)
        one, other = contact_modes(problem), contact_modes(scaled)
        assert [mode.mode for mode in one.modes] == [mode.mode for mode in other.modes]
        for mode, same in zip(one.modes, other.modes, strict=True):
            forces = size * same.contact_forces_W
            assert forces == pytest.approx(mode.contact_forces_W, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"inverse_inertia_W": np.eye(2)}, r"shape \(3, 3\), got shape \(2, 2\).*zeros across its plane"),
        ({"inverse_inertia_W": np.eye(4)}, r"inverse_inertia_W must be of shape \(3, 3\)"),
        ({"inverse_inertia_W": np.triu(np.ones((3, 3)))}, "must be symmetric, as"),
        ({"inverse_inertia_W": np.diag([-1.0, 1.0, 1.0])}, "must be positive semidefinite"),
        ({"inverse_inertia_W": np.diag([1.0, 1.0, 0.0])}, "got 0 1/kg along the normal of contact 0"),
        ({"accelerations_W": np.zeros((2, 3))}, r"accelerations_W must be of shape \(1, 3\)"),
    ],
)
def test_errors_name_the_argument(change: dict[str, Any], error: str) -> None:
    with pytest.raises(InvalidFieldError, match=error):
        replace(arm(-1.0), **change)
