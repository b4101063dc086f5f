# SPDX-License-Identifier: Apache-2.0
"""Questions about whole tosses: the answer is the toss itself, and what is not allowed is named."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError, TooLargeError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.questions import Context, TossQuestion, TossSampling, UncertainState, ask
from contact_dynamics.rigid_body import BodyState
from contact_dynamics.toss import TossEnd, TossEventKind, TossUncertainty, toss
from contact_dynamics.world import Body, Surface, World

SIZE = (0.1, 0.1, 0.1)
CUBE = Body.box(SIZE, mass=0.37, name="cube")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.15)
KNOWN = Context(world=World(bodies=(CUBE,), surfaces=(FLOOR,)))
THROWN = BodyState(
    p_WB_W=[0, 0, 0.2],
    q_WB=[0.3, 0.2, 0.1, 0.9273618495],
    v_WB_W=[0.5, 0.3, 0.5],
    w_WB_W=[2, -4, 1],
    stamp_ns=7_000_000_000,
)
UNCERTAIN = UncertainState(state=THROWN, covariance=1e-4 * np.eye(12))


def test_the_answer_is_the_toss() -> None:
    answer = ask(TossQuestion(body="cube", state=THROWN, rate=50.0), KNOWN)
    went = toss(CUBE, THROWN, KNOWN.world)
    assert answer.toss.end == TossEnd.RESTS
    assert answer.toss.seconds == went.seconds
    assert len(answer.alternatives) == len(went.alternatives)
    assert answer.distribution is None
    times = answer.toss.trajectory.seconds
    assert times[0] == 0.0
    np.testing.assert_allclose(np.diff(times[:-1]), 0.02, rtol=1e-9)
    assert times[-1] == went.seconds
    assert 0.0 < times[-1] - times[-2] <= 0.02
    np.testing.assert_array_equal(answer.toss.trajectory.p_WB_W[-1], went.state.p_WB_W)
    assert answer.toss.events[-1].kind == TossEventKind.RESTS


def test_what_is_left_out_is_as_the_library_has_it() -> None:
    """Ten seconds of horizon; the default rate; eight other ways."""
    short = ask(TossQuestion(body="cube", state=THROWN, horizon=0.1, max_alternatives=0), KNOWN)
    assert (short.toss.end, short.toss.seconds) == (TossEnd.HORIZON, 0.1)
    assert len(short.toss.trajectory.seconds) == 0.1 * KNOWN.defaults.rate + 1
    assert short.alternatives == ()


def test_a_distribution_comes_with_samples() -> None:
    sampling = TossSampling(count=30, uncertainty=TossUncertainty(velocity=0.02, spin=0.3))
    answer = ask(TossQuestion(body="cube", state=UNCERTAIN, sampling=sampling, max_alternatives=0), KNOWN)
    told = answer.distribution
    assert told is not None
    assert told.samples == 30
    assert max(branch.strike for branch in told.branches) == 2
    assert told.rest is None


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: TossQuestion(body="cube", max_alternatives=-1), "max_alternatives must be .*, got -1"),
        (lambda: TossSampling(count=0), "samples must be .*, got 0"),
        (lambda: TossSampling(count=2001), "samples must be at most 2000.*, got 2001"),
        (lambda: TossSampling(count=1, strikes=11), "strikes must be .*, got 11"),
        (
            lambda: TossUncertainty(covariance=np.zeros((101, 101))),
            "covariance must be at most 100.*, got 101",
        ),
        (lambda: TossUncertainty(covariance=np.zeros((5, 6))), "covariance must be .*, got"),
        (
            lambda: TossUncertainty(lasting_factor_stds=[0.1]),
            "lasting_factor_stds must be 0.*, got 1 numbers",
        ),
    ],
)
def test_what_is_not_allowed_is_named(make: Callable[[], object], message: str) -> None:
    with pytest.raises(ContactDynamicsError, match=message):
        make()


def test_a_covariance_of_another_world_is_refused() -> None:
    """Six parameters belong to one surface; two surfaces have eight."""
    sampling = TossSampling(count=1, uncertainty=TossUncertainty(covariance=np.eye(8)))
    with pytest.raises(InvalidFieldError, match=r"covariance must be 6 rows.*, got 8 rows"):
        ask(TossQuestion(body="cube", state=THROWN, sampling=sampling), KNOWN)


def test_factors_of_friction_for_another_world_are_refused() -> None:
    sampling = TossSampling(count=1, uncertainty=TossUncertainty(lasting_factors=[1.2, 1.2]))
    with pytest.raises(
        InvalidFieldError, match=r"lasting_factors must be one for each of 1.*, got 2 numbers"
    ):
        ask(TossQuestion(body="cube", state=THROWN, sampling=sampling), KNOWN)


def test_the_toss_itself_has_the_friction_that_lasts_as_its_samples_have_it() -> None:
    factors = [1.5]
    sampling = TossSampling(count=1, to_rest=True, uncertainty=TossUncertainty(lasting_factors=factors))
    answer = ask(TossQuestion(body="cube", state=THROWN, sampling=sampling), KNOWN)
    alone = toss(CUBE, THROWN, KNOWN.world, lasting_factors=factors)
    np.testing.assert_array_equal(answer.toss.trajectory.p_WB_W[-1], alone.state.p_WB_W)
    assert abs(alone.state.p_WB_W - toss(CUBE, THROWN, KNOWN.world).state.p_WB_W).max() > 1e-3
    unsampled = ask(TossQuestion(body="cube", state=THROWN, lasting_factors=factors), KNOWN)
    np.testing.assert_array_equal(unsampled.toss.trajectory.p_WB_W[-1], alone.state.p_WB_W)


def test_two_lists_of_factors_are_refused() -> None:
    sampling = TossSampling(count=1, uncertainty=TossUncertainty(lasting_factors=[1.5]))
    with pytest.raises(InvalidFieldError, match=r"lasting_factors must be none, or those.*, got \[1.2\]"):
        TossQuestion(body="cube", state=THROWN, sampling=sampling, lasting_factors=[1.2])


def test_a_trajectory_of_too_many_samples_is_refused() -> None:
    with pytest.raises(TooLargeError, match=r"rate must be .*, got .* samples"):
        ask(TossQuestion(body="cube", state=THROWN, rate=1e6, max_alternatives=0), KNOWN)


@pytest.mark.parametrize("law", SeveralContactsLaw)
def test_the_law_for_several_contacts_is_that_of_the_toss(law: SeveralContactsLaw) -> None:
    flat = BodyState(p_WB_W=[0, 0, 0.2], q_WB=[0, 0, 0, 1], v_WB_W=[0.5, 0.3, 0], w_WB_W=[0, 0, 3])
    answer = ask(TossQuestion(body="cube", state=flat, several_contacts_law=law), KNOWN)
    went = toss(CUBE, flat, KNOWN.world, several_contacts_law=law)
    np.testing.assert_array_equal(answer.toss.trajectory.p_WB_W[-1], went.state.p_WB_W)
    assert [event.kind for event in answer.toss.events] == [event.kind for event in went.events]


def test_the_simultaneous_law_takes_no_energetic_restitution() -> None:
    question = TossQuestion(
        body="cube",
        state=THROWN,
        restitution_law=RestitutionLaw.ENERGETIC,
        several_contacts_law=SeveralContactsLaw.SIMULTANEOUS,
    )
    with pytest.raises(InvalidFieldError, match=r"restitution_law must be .*, got ENERGETIC"):
        ask(question, KNOWN)
