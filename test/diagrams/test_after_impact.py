# SPDX-License-Identifier: Apache-2.0
"""What was measured after an impact, found from the poses of flights whose velocities are known."""

from __future__ import annotations

import pickle
import warnings
from dataclasses import replace

import numpy as np
import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    from viewing.answers import impact_answer

from contact_dynamics import BodyState, ContactSet, MassProperties, free_motion
from contact_dynamics.diagrams.after_impact import LATE_S, SPAN_S, AwaitedImpacts
from contact_dynamics.diagrams.words import after_impact_in_words
from contact_dynamics.questions import ImpactAnswer

GRAVITY = np.array([0.0, 0.0, -9.81])
BRICK = MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3]))
STRIKE_NS = 1_760_000_000_123_456_789
AFTER = BodyState(
    p_WB_W=[0.3, 0.1, 0.2],
    q_WB=[0.1, -0.5, 0.7, 0.5],
    v_WB_W=[0.4, -1.2, 1.6],
    w_WB_W=[3, -2, 4],
    stamp_ns=STRIKE_NS,
)


def prediction(v_W: tuple[float, float, float] = (0.4, -1.2, 1.5), stamp_ns: int = STRIKE_NS) -> ImpactAnswer:
    """An impact at that time after which the body has a velocity, m/s, and the spin of `AFTER`."""
    none = np.zeros((0, 3))
    contacts = ContactSet(p_WC_W=none, normals_W=none, frictions=[], restitutions=[], surfaces=())
    return impact_answer(
        replace(AFTER, stamp_ns=stamp_ns),
        contacts,
        impulses_W=none,
        path_W=none,
        path_events=(),
        path_contacts=(),
        v_after_W=v_W,
    )


def flight(begin: float = -0.1, end: float = 0.1, rate: float = 240.0) -> list[BodyState]:
    """Poses of the body after the impact, and before it on the same path, without velocities of use."""
    times = np.arange(begin, end, 1.0 / rate)
    path = free_motion(BRICK, AFTER, gravity_W=GRAVITY).at(times)
    return [
        BodyState(p_WB_W=p_W, q_WB=q, stamp_ns=STRIKE_NS + round(1e9 * t))
        for t, p_W, q in zip(times.tolist(), path.p_WB_W, path.q_WB, strict=True)
    ]


def test_the_velocities_after_an_impact_are_found_from_the_poses_after_it() -> None:
    awaited = AwaitedImpacts(gravity_W=GRAVITY)
    awaited.expect(prediction(), now_ns=STRIKE_NS - 100_000_000)
    states = flight()
    found = [each for state in states for each in awaited.see("brick", [state])]
    (compared,) = found
    # A fall is a quadratic, exactly, and stamps are whole nanoseconds, 4 ms apart.
    np.testing.assert_allclose(compared.v_WB_W, AFTER.v_WB_W, atol=1e-7)
    # A tumbling body's rotation vector is not: over 50 ms the third order is some hundredths.
    np.testing.assert_allclose(compared.w_WB_W, AFTER.w_WB_W, atol=0.1)
    assert compared.linear_error == pytest.approx(0.1)
    seconds = 1e-9 * (np.array(compared.stamps_ns) - STRIKE_NS)
    assert seconds[0] >= LATE_S
    assert seconds[-1] <= SPAN_S
    measured = AFTER.v_WB_W + np.outer(seconds, GRAVITY)
    np.testing.assert_allclose(compared.measured_speeds, np.linalg.norm(measured, axis=1), atol=1e-7)
    predicted = np.array([0.4, -1.2, 1.5]) + np.outer(seconds, GRAVITY)
    np.testing.assert_allclose(compared.predicted_speeds, np.linalg.norm(predicted, axis=1), atol=1e-12)
    first, _, last = after_impact_in_words(compared)
    assert first == "velocity measured (0.4, -1.2, 1.6), predicted (0.4, -1.2, 1.5) m/s"
    assert last.startswith("they differ by 0.1 m/s and ")


def test_it_does_not_matter_in_which_portions_states_come() -> None:
    found = []
    for size in (1, 7, 1000):
        awaited = AwaitedImpacts(gravity_W=GRAVITY)
        awaited.expect(prediction(), now_ns=STRIKE_NS - 100_000_000)
        states = flight()
        portions = [states[i : i + size] for i in range(0, len(states), size)]
        (compared,) = [each for portion in portions for each in awaited.see("brick", portion)]
        found.append(compared.v_WB_W.tolist())
    assert found[0] == found[1] == found[2]


@pytest.mark.parametrize("late", [0.06, 0.2, 0.45])
def test_an_answer_that_comes_after_the_states_is_compared_with_them(late: float) -> None:
    in_time, awaited = AwaitedImpacts(gravity_W=GRAVITY), AwaitedImpacts(gravity_W=GRAVITY)
    in_time.expect(prediction(), now_ns=STRIKE_NS - 100_000_000)
    assert in_time.see("brick", []) == []
    states = flight(end=late)
    (expected,) = in_time.see("brick", states)
    for state in states:
        assert awaited.see("brick", [state]) == []
    awaited.expect(prediction(), now_ns=STRIKE_NS - 100_000_000)
    (compared,) = awaited.see("brick", [])
    assert compared.v_WB_W.tolist() == expected.v_WB_W.tolist()
    assert compared.stamps_ns == expected.stamps_ns
    assert awaited.see("brick", states[-1:]) == []


def test_an_answer_that_comes_much_later_finds_no_states_of_its_time() -> None:
    awaited = AwaitedImpacts(gravity_W=GRAVITY)
    for state in flight(end=0.8):
        awaited.see("brick", [state])
    awaited.expect(prediction(), now_ns=STRIKE_NS - 100_000_000)
    assert awaited.see("brick", []) == []


@pytest.mark.parametrize("back", [0.6, 1000.0])
def test_nothing_is_kept_of_before_the_clock_was_set_back(back: float) -> None:
    """What is kept of half a second or more is as much as without that, and is not compared either."""
    late, awaited, fresh = 0.8, AwaitedImpacts(gravity_W=GRAVITY), AwaitedImpacts(gravity_W=GRAVITY)
    awaited.expect(prediction(stamp_ns=STRIKE_NS + 10**9), now_ns=STRIKE_NS)  # which does not come any more
    awaited.see("brick", flight(end=late))
    for state in flight(end=10.0):
        early = replace(state, stamp_ns=state.stamp_ns - round(1e9 * back))
        for each in (awaited, fresh):
            assert each.see("brick", [early]) == []
    assert len(pickle.dumps(awaited)) == pytest.approx(len(pickle.dumps(fresh)), rel=0.01)


def test_impacts_of_a_body_that_is_not_seen_are_not_kept() -> None:
    """As where questions state the body's states and nobody publishes them."""
    sizes, awaited = [], AwaitedImpacts(gravity_W=GRAVITY)
    for i in range(200):
        strike_ns = STRIKE_NS + 50_000_000 * i
        awaited.expect(prediction(stamp_ns=strike_ns), now_ns=strike_ns - 10_000_000)
        sizes.append(len(pickle.dumps(awaited)))
    assert sizes[199] < 1.01 * sizes[19]


def test_the_newest_prediction_counts_that_was_made_before_the_impact() -> None:
    awaited = AwaitedImpacts(gravity_W=GRAVITY)
    for before_ns, v_W in ((80_000_000, (9.0, 9.0, 9.0)), (20_000_000, (0.4, -1.2, 1.6))):
        awaited.expect(prediction(v_W), now_ns=STRIKE_NS - before_ns)
    states = flight()
    middle = len(states) // 2 + 3  # the impact has been, but not long enough
    assert awaited.see("brick", states[:middle]) == []
    awaited.expect(
        prediction((5.0, 5.0, 5.0), STRIKE_NS + 10**9), now_ns=states[middle].stamp_ns
    )  # the next one
    (compared,) = awaited.see("brick", states[middle:])
    assert compared.linear_error < 1e-7  # stamps are whole nanoseconds, 4 ms apart


@pytest.mark.parametrize(
    ("answer", "states", "body"),
    [
        (prediction(), flight(rate=60.0), "brick"),
        (prediction(), flight(end=0.04), "brick"),
        (prediction(), flight(), "another"),
        (prediction(stamp_ns=0), flight(), "brick"),
    ],
    ids=["too few poses", "not long enough", "of another body", "no stamp"],
)
def test_what_cannot_be_compared_is_not(answer: ImpactAnswer, states: list[BodyState], body: str) -> None:
    awaited = AwaitedImpacts(gravity_W=GRAVITY)
    awaited.expect(answer, now_ns=STRIKE_NS - 100_000_000)
    assert awaited.see(body, states) == []
