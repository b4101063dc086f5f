# SPDX-License-Identifier: Apache-2.0
"""What holds of every toss of boxes drawn at random: energy never grows, and nothing penetrates."""

from __future__ import annotations

import copy
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, Surface, World
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError, NotSupportedError
from contact_dynamics.rigid_body.body import kinetic_energy
from contact_dynamics.shapes import cylinder
from contact_dynamics.toss import Toss, TossEnd, TossEventKind, UndecidedReason, toss
from sweeps import seeds

G = 9.81
FLOOR = {"name": "floor", "p_WS_W": [0, 0, 0], "normal_W": [0, 0, 1]}


def drawn(seed: int) -> tuple[Body, BodyState, World]:
    """Return a box, its throw and a floor with friction."""
    rng = np.random.default_rng(seed)
    size = tuple((0.05 + 0.15 * rng.random(3)).tolist())
    mass = 0.2 + rng.random()
    body = Body.box(size, mass=mass, name="box")
    q = rng.normal(size=4)
    state = BodyState(
        p_WB_W=[0, 0, 0.5],
        q_WB=q / np.linalg.norm(q),
        v_WB_W=rng.normal(size=3),
        w_WB_W=8.0 * rng.normal(size=3),
        stamp_ns=1_000,
    )
    friction, restitution = rng.choice([0.05, 0.2, 0.5, 1.0]), rng.choice([0.0, 0.1, 0.4])
    floor = Surface(**FLOOR, friction=friction, restitution=restitution)
    return body, state, World(surfaces=(floor,), gravity_W=[0, 0, -G])


def energies(body: Body, went: Toss, times: np.ndarray) -> np.ndarray:
    mass = body.mass_properties
    states = [went.state_at(time) for time in times.tolist()]
    return np.array([kinetic_energy(mass, one) + mass.mass * G * float(one.p_WB_W[2]) for one in states])


def test_a_toss_that_is_copied_or_pickled_has_its_events() -> None:
    """They are made when they are first asked for, and copies may be made before that."""
    body, state, world = drawn(0)
    went = toss(body, state, world)
    pickled = pickle.loads(pickle.dumps(went))  # noqa: S301  our own
    copied = copy.copy(toss(body, state, world))
    expected = went.to_dict()
    assert len(went.events) == len(expected["events"]) > 0
    assert went.events is went.events
    for other in (pickled, copied, copy.deepcopy(went), replace(went, alternatives=(went,))):
        assert {**other.to_dict(), "alternatives": []} == expected
        assert other.events[-1].kind == TossEventKind.RESTS


@seeds(range(5), slow=range(5, 12))
def test_energy_never_grows_nothing_penetrates_and_rest_is_rest(seed: int) -> None:
    body, state, world = drawn(seed)
    went = toss(body, state, world, max_alternatives=0)
    assert went.end == TossEnd.RESTS
    times = np.linspace(0.0, went.seconds, 200)
    # A step may be off by 1e-7 m/s, and bodies here have some 1 kg and 3 m/s.
    assert float(np.diff(energies(body, went, times)).max()) <= 1e-6
    parts = went.energy
    assert parts.first == pytest.approx(parts.lost_in_strikes + parts.lost_in_contact, abs=1e-9)
    assert parts.lost_in_strikes > 0.0
    moved = went.at(times)
    R = np.array([one.R_WB for one in map(went.state_at, times.tolist())])
    lowest = (moved.p_WB_W[:, None] + body.shape.vertices @ R.transpose(0, 2, 1))[:, :, 2].min(axis=1)
    assert float(lowest.min()) >= -1e-9
    feet = went.state.p_WB_W + body.shape.vertices @ went.state.R_WB.T
    assert sorted(np.flatnonzero(np.abs(feet[:, 2]) <= 1e-9)) == list(went.resting_corners)
    assert np.abs(went.resting_normal_B).max() == pytest.approx(1.0, abs=1e-8)
    assert not went.state.v_WB_W.any()
    assert not went.state.w_WB_W.any()
    after = went.state_at(went.seconds + 100.0)
    assert after.p_WB_W.tolist() == went.state.p_WB_W.tolist()
    assert after.stamp_ns == 1_000 + round(1e9 * (went.seconds + 100.0))


@seeds(range(6))
def test_the_motion_has_no_gaps_but_for_impulses(seed: int) -> None:
    body, state, world = drawn(seed)
    went = toss(body, state, world, max_alternatives=0)
    for time in sorted({event.seconds for event in went.events}):
        before, after = went.state_at(max(time - 1e-9, 0.0)), went.state_at(time)
        assert after.p_WB_W == pytest.approx(before.p_WB_W, abs=1.1e-6)
        pushed = sum(event.impulse_W for event in went.events if event.seconds == time)
        change = body.mass_properties.mass * (after.v_WB_W - before.v_WB_W)
        # Contacts that settle give up some millimetres a second, and so does a body that comes to rest.
        assert change == pytest.approx(pushed, abs=0.01)


def test_the_result_does_not_depend_on_the_steps() -> None:
    """A block that falls off its edge is long in contact, and no strike is close to another."""
    size = (0.06, 0.1, 0.16)
    body = Body.box(size, mass=0.5, name="box")
    angle = math.atan2(size[0], size[2]) + 0.05
    height = 0.5 * (size[2] * math.cos(angle) + size[0] * math.sin(angle))
    state = BodyState(p_WB_W=[0, 0, height], q_WB=[0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)])
    world = World(surfaces=(Surface(**FLOOR, friction=0.3, restitution=0.0),), gravity_W=[0, 0, -G])
    coarse, fine = (toss(body, state, world, max_alternatives=0, error=error) for error in (1e-7, 1e-11))
    first = next(event.seconds for event in fine.strikes)
    times = np.linspace(0.0, 0.999 * first, 40)
    assert coarse.at(times).p_WB_W == pytest.approx(fine.at(times).p_WB_W, abs=2e-6)
    # Two corners strike at one instant. Rounding decides which of them is struck first, and the two outcomes
    # are mirror images of each other.
    mirrored = fine.state.p_WB_W * [1.0, -1.0, 1.0]
    ends = (fine.state.p_WB_W, mirrored)
    assert min(np.abs(coarse.state.p_WB_W - end).max() for end in ends) < 2e-5


def test_a_box_that_lands_flat_tells_that_the_order_of_its_corners_is_open() -> None:
    size = (0.1, 0.1, 0.1)
    cube = Body.box(size, mass=0.5, name="cube")
    state = BodyState(p_WB_W=[0, 0, 0.1], q_WB=[0, 0, 0, 1], v_WB_W=[0.3, 0, 0])
    world = World(surfaces=(Surface(**FLOOR, friction=0.3, restitution=0.2),), gravity_W=[0, 0, -G])
    went = toss(cube, state, world, max_alternatives=3)
    first = went.undecided[0]
    assert (first.reason, first.options, first.taken) == (UndecidedReason.STRIKE_TOGETHER, 4, 0)
    assert first.seconds == pytest.approx(math.sqrt(2.0 * 0.05 / G), abs=1e-9)
    assert [other.undecided[0].taken for other in went.alternatives] == [1, 2, 3]
    assert not went.all_followed
    struck = {other.strikes[0].corners for other in (went, *went.alternatives)}
    assert len(struck) == 4
    assert went.end == TossEnd.RESTS


def test_bad_input_is_refused_by_name() -> None:
    body, state, world = drawn(0)
    round_one = Body(name="can", mass_properties=body.mass_properties, shape=cylinder(radius=0.1, length=0.2))
    with pytest.raises(NotSupportedError, match=r"'can'.*rims"):
        toss(round_one, state, world)
    with pytest.raises(ContactDynamicsError, match="must have `vertices_B` or a `shape`, got neither"):
        toss(Body(name="point", mass_properties=body.mass_properties), state, world)
    went = toss(body, state, world, horizon=0.05)
    assert went.end == TossEnd.HORIZON
    with pytest.raises(InvalidFieldError, match="seconds"):
        went.at([0.06])
    assert TossEventKind.RESTS not in {event.kind for event in went.events}


def test_a_ball_that_rolls_on_for_years_ends_at_the_bound_on_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each step is short beside a turn, so a horizon without end would take as long."""
    monkeypatch.setattr("contact_dynamics.toss.simulation.MAX_STEPS", 200)
    ball = Body.sphere(0.05, mass=0.3, name="ball")
    floor = Surface(**FLOOR, friction=0.5, restitution=0.0)
    state = BodyState(p_WB_W=[0, 0, 0.05], q_WB=[0, 0, 0, 1], v_WB_W=[1, 0, 0])
    went = toss(ball, state, World(surfaces=(floor,)), horizon=1e9)
    assert went.end == TossEnd.MAX_EVENTS
    assert 1.0 < went.seconds < 1e4
    assert went.state.v_WB_W[0] == pytest.approx(5.0 / 7.0, rel=1e-6)  # it rolls
