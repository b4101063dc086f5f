# SPDX-License-Identifier: Apache-2.0
"""Several bodies in one problem: stacks in closed form, drawn pairs beside an enumeration, and laws."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics import Body
from contact_dynamics.contact import ContactSet, Curvatures
from contact_dynamics.contact_modes import (
    BodiesContactProblem,
    BodiesModeAnswer,
    ModeVerdict,
    SpatialContactProblem,
    contact_modes,
)
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_modes.evidence import problem_of_made
from oracles.modes_of_stacks import Stack
from oracles.modes_of_stacks import made as made_stack
from oracles.modes_of_two_bodies import Bodies, accelerations, all_modes, drawn
from oracles.modes_on_planes import made
from sweeps import seeds

G = 9.81
HEIGHT = 0.1  # m, of each block
ROUNDING = 1e-12  # m/s^2, of accelerations of some 10 m/s^2


def corners(width: float, z: float) -> np.ndarray:
    return np.array([[x, y, z] for x in (-0.5 * width, 0.5 * width) for y in (-0.5 * width, 0.5 * width)])


def stack(
    masses: list[float], frictions: list[float], pushes: list[list[float]], **surfaces: Any
) -> BodiesContactProblem:
    """Return square blocks on each other and on a floor, each with four contacts below it.

    Surfaces have their motion at the floor's contacts.
    """
    k = len(masses)
    widths = [0.3 - 0.04 * i for i in range(k)]
    moving = {name: [value] * 4 + [[0.0, 0.0, 0.0]] * (4 * k - 4) for name, value in surfaces.items()}
    return BodiesContactProblem(
        bodies=[
            Body.box((width, width, HEIGHT), mass=mass) for width, mass in zip(widths, masses, strict=True)
        ],
        states=[BodyState(p_WB_W=[0, 0, HEIGHT * (i + 0.5)], q_WB=[0, 0, 0, 1]) for i in range(k)],
        contacts=ContactSet(
            p_WC_W=np.vstack([corners(width, HEIGHT * i) for i, width in enumerate(widths)]),
            normals_W=[0.0, 0.0, 1.0],
            frictions=np.repeat(frictions, 4),
            **moving,
        ),
        pairs=[(i, i - 1 if i > 0 else None) for i in range(k) for _ in range(4)],
        forces_W=np.array([[0.0, 0.0, -mass * G] for mass in masses]) + pushes,
    )


def only(answer: BodiesModeAnswer) -> Any:
    assert answer.verdict == ModeVerdict.UNIQUE, answer
    (mode,) = answer.modes
    return mode


BETWEEN_THRESHOLDS = [0.2, 0.99999, 1.00001, 1.5]


@pytest.mark.parametrize("share", BETWEEN_THRESHOLDS)
def test_a_stack_that_is_pushed_below_starts_to_slide_when_friction_of_the_floor_is_used_up(
    share: float,
) -> None:
    below, above, floor, between = 2.0, 1.0, 0.3, 0.5
    hold = floor * (below + above) * G
    mode = only(contact_modes(stack([below, above], [floor, between], [[share * hold, 0, 0], [0, 0, 0]])))
    together = max(0.0, share - 1.0) * hold / (below + above)
    assert mode.mode == ("ffffffff" if share < 1.0 else "ccccffff")
    assert mode.accelerations_W == pytest.approx(np.array([[together, 0, 0]] * 2), abs=ROUNDING)


@pytest.mark.parametrize("share", [0.5, *BETWEEN_THRESHOLDS[1:]])
def test_the_upper_block_slips_when_the_lower_one_is_pushed_away_below_it(share: float) -> None:
    below, above, floor, between = 2.0, 1.0, 0.3, 0.5
    both = (below + above) * G
    push = share * (between + floor) * both
    mode = only(contact_modes(stack([below, above], [floor, between], [[push, 0, 0], [0, 0, 0]])))
    together = (push - floor * both) / (below + above)
    slips = (push - floor * both - between * above * G) / below, between * G
    lower, upper = (together, together) if share < 1.0 else slips
    assert mode.mode == ("ccccffff" if share < 1.0 else "cccccccc")
    assert mode.accelerations_W[:, 0] == pytest.approx([lower, upper], abs=5.0 * ROUNDING)


@pytest.mark.parametrize(
    ("acceleration", "expected"), [(2.9, "ffffffff"), (3.0, "ffffcccc"), (4.8, "ffffcccc")]
)
def test_the_upper_block_slips_on_a_tray_that_accelerates_faster_than_its_friction(
    acceleration: float, expected: str
) -> None:
    problem = stack([2.0, 1.0], [0.5, 0.3], [[0, 0, 0]] * 2, surface_accelerations_W=[acceleration, 0.0, 0.0])
    mode = only(contact_modes(problem))
    assert mode.mode == expected
    assert mode.accelerations_W[:, 0] == pytest.approx(
        [acceleration, min(acceleration, 0.3 * G)], abs=ROUNDING
    )


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_a_block_on_a_block_on_a_turntable_slips_when_friction_holds_it_no_longer(share: float) -> None:
    radius, friction = 0.4, 0.3
    spin = np.sqrt(share * friction * G / radius)
    flat = stack([2.0, 0.5], [1.0, friction], [[0, 0, 0]] * 2)
    outward = np.array([radius, 0.0, 0.0])
    at = flat.contacts.p_WC_W[:4] + outward
    w = np.array([0.0, 0.0, spin])
    zeros = np.zeros((4, 3))
    problem = replace(
        flat,
        states=[
            BodyState(p_WB_W=one.p_WB_W + outward, q_WB=[0, 0, 0, 1], v_WB_W=np.cross(w, outward), w_WB_W=w)
            for one in flat.states
        ],
        contacts=replace(
            flat.contacts,
            p_WC_W=flat.contacts.p_WC_W + outward,
            surface_velocities_W=np.vstack([np.cross(w, at), zeros]),
            surface_angular_velocities_W=np.vstack([np.tile(w, (4, 1)), zeros]),
            surface_accelerations_W=np.vstack([np.cross(w, np.cross(w, at)), zeros]),
        ),
    )
    mode = only(contact_modes(problem))
    assert mode.mode[:4] == "ffff"
    assert (mode.mode[4:] == "ffff") == (share < 1.0)


def of_draw(bodies: Bodies) -> BodiesContactProblem:
    return BodiesContactProblem(
        bodies=[
            MassProperties(mass=m, I_B=one) for m, one in zip(bodies.masses, bodies.inertias, strict=True)
        ],
        states=[
            BodyState(p_WB_W=p, q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=w)
            for p, v, w in zip(bodies.centres, bodies.v, bodies.w, strict=True)
        ],
        contacts=ContactSet(p_WC_W=bodies.points, normals_W=bodies.normals, frictions=bodies.frictions),
        pairs=bodies.pairs,
        forces_W=bodies.forces,
        torques_W=bodies.torques,
    )


def shown(letters: str, frictions: np.ndarray) -> str:
    """Return letters with c where a contact without friction stays."""
    return "".join(
        "c" if mu == 0.0 and one == "f" else one for one, mu in zip(letters, frictions, strict=True)
    )


@seeds(range(24), slow=range(24, 2000))
def test_modes_of_two_drawn_bodies_are_those_of_an_enumeration(seed: int) -> None:
    """No mode is missing or wrong, and forces on each body give its accelerations."""
    bodies = drawn(seed)
    expected = all_modes(bodies)
    answer = contact_modes(of_draw(bodies))
    if not expected.clear:
        return
    found = {shown(mode.mode, bodies.frictions): mode for mode in answer.modes}
    known = [letters for letters in found if letters not in expected.shared]
    assert answer.verdict != ModeVerdict.UNDECIDED
    assert sorted(known) == sorted({mode.letters for mode in expected.modes})
    for other in expected.modes:
        near = [
            mode
            for mode in answer.modes
            if shown(mode.mode, bodies.frictions) == other.letters
            and np.abs(mode.contact_forces_W - other.forces).max()
            <= 1e-9 * (1.0 + np.abs(other.forces).max())
        ]
        assert len(near) == 1, other.letters
        linear, angular, points = accelerations(bodies, near[0].contact_forces_W)
        size = 1.0 + np.abs(points).max()
        assert np.abs(near[0].accelerations_W - linear).max() <= 1e-9 * size
        assert np.abs(near[0].angular_accelerations_W - angular).max() <= 1e-9 * size
        assert np.abs(near[0].contact_accelerations_W - points).max() <= 1e-9 * size


@seeds(range(12), slow=range(12, 2000))
def test_no_mode_of_a_stack_that_was_made_is_missed(seed: int) -> None:
    """There are two bodies with up to eight contacts, or three with up to twelve."""
    case = made_stack(seed, bodies=3 if seed % 6 == 5 else 2)
    answer = contact_modes(of_stack(case))
    assert answer.verdict == ModeVerdict.UNDECIDED or any(
        mode.mode == case.letters
        and (
            not mode.motion_unique
            or mode.accelerations_W == pytest.approx(case.accelerations, rel=1e-6, abs=1e-6)
        )
        for mode in answer.modes
    )


def test_few_stacks_are_undecided() -> None:
    verdicts = [contact_modes(of_stack(made_stack(seed))).verdict for seed in range(12, 27)]
    assert verdicts.count(ModeVerdict.UNDECIDED) <= 1


def of_stack(case: Stack) -> BodiesContactProblem:
    return BodiesContactProblem(
        bodies=[MassProperties(mass=m, I_B=one) for m, one in zip(case.masses, case.inertias, strict=True)],
        states=[BodyState(p_WB_W=centre, q_WB=[0, 0, 0, 1]) for centre in case.centres],
        contacts=ContactSet(p_WC_W=case.points, normals_W=[0.0, 0.0, 1.0], frictions=case.frictions),
        pairs=case.pairs,
        forces_W=case.forces,
        torques_W=case.torques,
    )


@seeds(range(0, 60, 3), slow=range(1, 600))
def test_one_body_has_the_modes_of_its_own_problem(seed: int) -> None:
    alone = problem_of_made(made(seed, most=6))
    own = contact_modes(alone)
    answer = contact_modes(
        BodiesContactProblem(
            bodies=[alone.body],
            states=[alone.state],
            contacts=alone.contacts,
            pairs=[(0, None)] * len(alone.contacts),
            forces_W=alone.force_W,
            torques_W=alone.torque_W,
        )
    )
    assert answer.verdict == own.verdict
    assert [mode.mode for mode in answer.modes] == [mode.mode for mode in own.modes]
    for mode, other in zip(answer.modes, own.modes, strict=True):
        assert (mode.motion_unique, mode.forces_unique) == (other.motion_unique, other.forces_unique)
        if mode.motion_unique:
            assert mode.accelerations_W[0] == pytest.approx(other.acceleration_W, rel=1e-8, abs=1e-8)
            assert mode.contact_forces_W == pytest.approx(other.contact_forces_W, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("push", [1.0, 6.0])
def test_a_heavy_body_below_acts_as_a_floor_up_to_one_over_its_mass(push: float) -> None:
    """The block accelerates by 1/m differently: times m, the difference is the same for 1e3 to 1e8 kg.

    It is rounding for 1e12 kg.
    """
    block, load = Body.box((0.2, 0.2, HEIGHT), mass=1.0), np.array([push, 1.0, -G])
    state = BodyState(p_WB_W=[0, 0, 0.5 * HEIGHT], q_WB=[0, 0, 0, 1])
    contacts = ContactSet(p_WC_W=corners(0.2, 0.0), normals_W=[0, 0, 1], frictions=0.3)
    (fixed,) = contact_modes(
        SpatialContactProblem(body=block, state=state, contacts=contacts, force_W=load)
    ).modes
    differences = []
    for mass in (1e3, 1e5, 1e8, 1e12):
        heavy = Body.box((0.4, 0.4, 0.2), mass=mass)
        below = BodyState(p_WB_W=[0, 0, -0.1], q_WB=[0, 0, 0, 1])
        mode = only(
            contact_modes(
                BodiesContactProblem(
                    bodies=[heavy, block],
                    states=[below, state],
                    contacts=contacts,
                    pairs=[(1, 0)] * 4,
                    forces_W=[[0, 0, 0], load],
                )
            )
        )
        assert mode.mode == fixed.mode
        differences.append(mass * (mode.accelerations_W[1] - fixed.acceleration_W))
    assert differences[1] == pytest.approx(differences[0], rel=0.05)
    assert differences[2] == pytest.approx(differences[1], rel=0.001, abs=1e-5)
    assert np.abs(differences[3]).max() < 100.0  # 1e-10 m/s^2


@seeds(range(0, 40, 4))
def test_the_order_of_bodies_and_contacts_and_of_pairs_does_not_matter(seed: int) -> None:
    """If the bodies of a pair change places, the normal turns round, and so do the forces.

    Where they move, it matters which of them has the flat side, the second one.
    """
    bodies = drawn(seed + seed // 4 % 2)
    order = np.random.default_rng(seed).permutation(len(bodies.points))
    turned = [not bodies.v.any() and i % 2 == 0 and bodies.pairs[i][1] is not None for i in order]
    signs = np.where(turned, -1.0, 1.0)[:, None]
    renamed = [tuple(None if k is None else 1 - k for k in bodies.pairs[i]) for i in order]
    other = bodies._replace(
        masses=bodies.masses[::-1],
        inertias=bodies.inertias[::-1],
        centres=bodies.centres[::-1],
        v=bodies.v[::-1],
        w=bodies.w[::-1],
        forces=bodies.forces[::-1],
        torques=bodies.torques[::-1],
        points=bodies.points[order],
        normals=bodies.normals[order] * signs,
        frictions=bodies.frictions[order],
        pairs=[pair[::-1] if turn else pair for pair, turn in zip(renamed, turned, strict=True)],
    )
    first, second = contact_modes(of_draw(bodies)), contact_modes(of_draw(other))
    assert first.verdict == second.verdict
    assert len(first.modes) == len(second.modes)
    for mode in second.modes:
        moves = mode.accelerations_W[::-1]
        (own,) = [
            one
            for one in first.modes
            if "".join(one.mode[i] for i in order) == mode.mode
            and one.accelerations_W == pytest.approx(moves, rel=1e-9, abs=1e-9)
        ]
        assert mode.forces_unique == own.forces_unique
        if mode.forces_unique:
            forces = own.contact_forces_W[order] * signs
            assert mode.contact_forces_W == pytest.approx(forces, rel=1e-9, abs=1e-9)


@seeds(range(1, 40, 4))
def test_a_common_velocity_changes_nothing(seed: int) -> None:
    """All bodies and the world's surfaces move on at one velocity."""
    bodies = drawn(seed)
    velocity = np.array([0.3, -2.0, 0.7])
    problem = of_draw(bodies)
    moving = [[0.0, 0.0, 0.0] if second is not None else velocity for _, second in bodies.pairs]
    carried = replace(
        of_draw(bodies._replace(v=bodies.v + velocity)),
        contacts=replace(problem.contacts, surface_velocities_W=np.array(moving)),
    )
    first, second = contact_modes(problem), contact_modes(carried)
    assert [mode.mode for mode in first.modes] == [mode.mode for mode in second.modes]
    for one, other in zip(first.modes, second.modes, strict=True):
        assert one.accelerations_W == pytest.approx(other.accelerations_W, rel=1e-9, abs=1e-9)


def test_accelerations_of_contacts_are_second_derivatives_of_the_gap() -> None:
    """The corner of a spinning body slides over the face of another one that spins as well."""
    bodies = drawn(1)._replace(pairs=[(0, 1)], frictions=np.array([0.4]))
    bodies = bodies._replace(points=bodies.points[:1], normals=bodies.normals[:1])
    v, w = bodies.v.copy(), bodies.w.copy()
    arms = bodies.points[0] - bodies.centres
    relative = (v[0] + np.cross(w[0], arms[0])) - (v[1] + np.cross(w[1], arms[1]))
    v[0] -= (relative @ bodies.normals[0]) * bodies.normals[0]
    bodies = bodies._replace(v=v)
    for mode in contact_modes(of_draw(bodies)).modes:

        def gap(
            t: float, *, a: Any = mode.accelerations_W, alpha: Any = mode.angular_accelerations_W
        ) -> float:
            moved = bodies.centres + t * v + 0.5 * t * t * a
            # To second order in t, turning by w t + alpha t^2 / 2 about the world's axes.
            turns = [Rotation.from_rotvec(w[k] * t + 0.5 * alpha[k] * t * t) for k in (0, 1)]
            corner = moved[0] + turns[0].apply(arms[0])
            plane = moved[1] + turns[1].apply(arms[1])
            return float(turns[1].apply(bodies.normals[0]) @ (corner - plane))

        step = 1e-4
        second = (gap(step) - 2.0 * gap(0.0) + gap(-step)) / step**2
        rising = float(mode.contact_accelerations_W[0] @ bodies.normals[0])
        assert second == pytest.approx(rising, abs=1e-5)  # step^2, and 1e-16 / step^2


def test_a_ball_rolls_on_a_body_as_on_the_world() -> None:
    """The lower body is at rest, held by the world: the curvatures of the upper one count alike."""
    ball = Body.sphere(0.1, mass=1.0)
    rolling = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0.2, 0, 0], w_WB_W=[0, 2.0, 0])
    plate = Body.box((1.0, 1.0, 0.1), mass=5.0)
    below = BodyState(p_WB_W=[0, 0, -0.05], q_WB=[0, 0, 0, 1])
    curvature = [10.0, *[np.inf] * 4]
    curved = Curvatures(along=curvature, across=curvature, directions_W=np.zeros((5, 3)))
    mode = only(
        contact_modes(
            BodiesContactProblem(
                bodies=[ball, plate],
                states=[rolling, below],
                contacts=ContactSet(
                    p_WC_W=[[0, 0, 0], *corners(1.0, -0.1)],
                    normals_W=[0, 0, 1],
                    frictions=0.5,
                    body_curvatures=curved,
                ),
                pairs=[(0, 1), *[(1, None)] * 4],
                forces_W=[[1.0, 0, -G], [0, 0, -5.0 * G]],
            )
        )
    )
    assert mode.mode == "fffff"
    assert mode.accelerations_W[0] == pytest.approx([1.0 / 1.4, 0, 0], abs=ROUNDING)


def test_bodies_without_contacts_fall() -> None:
    flat = stack([2.0, 1.0], [0.5, 0.3], [[0, 0, 0], [3.0, 0, 0]])
    nothing = ContactSet(p_WC_W=np.zeros((0, 3)), normals_W=np.zeros((0, 3)), frictions=[])
    mode = only(contact_modes(replace(flat, contacts=nothing, pairs=[])))
    assert mode.accelerations_W == pytest.approx(np.array([[0, 0, -G], [3.0, 0, -G]]), abs=ROUNDING)


def test_bodies_that_approach_are_an_impact() -> None:
    problem = stack([2.0, 1.0], [0.5, 0.3], [[0, 0, 0]] * 2)
    falling = [problem.states[0], problem.states[1].with_velocities([0, 0, -0.1], [0, 0, 0])]
    answer = contact_modes(replace(problem, states=falling))
    assert (answer.verdict, answer.approaching, answer.modes) == (ModeVerdict.IMPACT, (4, 5, 6, 7), ())


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"pairs": [(0, None)]}, r"pairs must be 8, one for each contact"),
        ({"pairs": [(0, 0)] * 8}, r"pairs\[0\] must be two different indices below 2"),
        ({"pairs": [(2, None)] * 8}, r"pairs\[0\] must be two different indices below 2"),
        ({"states": []}, r"states must be 2, one for each body, got 0 states"),
        ({"forces_W": np.zeros((3, 3))}, r"forces_W must be of shape \(2, 3\)"),
    ],
)
def test_errors_name_the_argument(change: dict[str, Any], error: str) -> None:
    problem = stack([2.0, 1.0], [0.5, 0.3], [[0, 0, 0]] * 2)
    with pytest.raises(InvalidFieldError, match=error):
        replace(problem, **change)


def test_the_surface_of_a_body_moves_as_its_state_says() -> None:
    problem = stack([2.0, 1.0], [0.5, 0.3], [[0, 0, 0]] * 2)
    contacts = replace(problem.contacts, surface_velocities_W=[1.0, 0.0, 0.0])
    with pytest.raises(InvalidFieldError, match=r"contacts.surface_velocities_W\[4\] must be zero between"):
        replace(problem, contacts=contacts)


def test_a_search_that_does_not_end_is_undecided() -> None:
    """A block rests on two others, each of which can slide: the found mode is returned, and open letters."""
    side = 0.2
    places = [[-0.11, 0, 0.05], [0.11, 0, 0.05], [0, 0, 0.15]]
    lower = [corners(side, 0.0) + np.array([x, 0, 0]) for x in (-0.11, 0.11)]
    upper = [[[x, y, 0.1] for x in xs for y in (-0.1, 0.1)] for xs in ((-0.1, -0.01), (0.01, 0.1))]
    problem = BodiesContactProblem(
        bodies=[Body.box((side, side, 0.1), mass=1.0)] * 3,
        states=[BodyState(p_WB_W=place, q_WB=[0, 0, 0, 1]) for place in places],
        contacts=ContactSet(p_WC_W=np.vstack([*lower, *upper]), normals_W=[0, 0, 1], frictions=0.4),
        pairs=[(0, None)] * 4 + [(1, None)] * 4 + [(2, 0)] * 4 + [(2, 1)] * 4,
        forces_W=[[0, 0, -G], [0, 0, -G], [20.0, 0, -G]],
    )
    answer = contact_modes(problem)
    assert answer.verdict == ModeVerdict.UNDECIDED
    assert [mode.mode for mode in answer.modes] == ["ffffffffcccccccc"]
    assert "did not end" in answer.undecided
    assert answer.undecided_modes
