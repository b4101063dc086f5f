# SPDX-License-Identifier: Apache-2.0
"""Samples that several processes follow to rest: the numbers are those of one process."""

from __future__ import annotations

import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact import RestitutionLaw
from contact_dynamics.rigid_body.body import BodyState, state_covariance
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.toss import TossDistribution, TossUncertainty, sampled_toss
from contact_dynamics.toss.distribution import FEWEST
from contact_dynamics.toss.sampled import MAX_GHOSTS
from contact_dynamics.toss.to_rest import PART
from contact_dynamics.world import Body, Surface, World

if TYPE_CHECKING:
    from concurrent.futures import Executor

SIZE = (0.1, 0.12, 0.07)
BRICK = Body.box(SIZE, mass=0.4, name="brick")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.3)
CUBE = Body.box((0.1, 0.1, 0.1), mass=0.37, name="cube")
COUNT = int(1.6 * PART)  # two parts


def told(count: int, *, exact: bool = False, **given: Any) -> TossDistribution:
    """Return what can happen to a brick that is dropped nearly flat, and slides on."""
    if not exact:
        given["covariance"] = np.diag([1e-3] * 3 + [0.02] * 3 + [0.02] * 3 + [0.3] * 3) ** 2
        given["uncertainty"] = TossUncertainty(velocity=0.02, spin=0.4, height=5e-4)
    return sampled_toss(
        BRICK,
        BodyState(p_WB_W=[0, 0, 0.07], q_WB=[0.08, 0.06, 0.0, 0.995], v_WB_W=[0.4, 0, 0], w_WB_W=[0, 0, 1]),
        World(bodies=(BRICK,), surfaces=(FLOOR,)),
        count=count,
        to_rest=True,
        restitution_law=RestitutionLaw.POISSON,
        horizon=2.0,
        **given,
    )


@pytest.fixture(scope="module")
def alone() -> TossDistribution:
    """What one process tells of two parts. They end on their own, after strikes and slides."""
    found = told(COUNT)
    assert found.rest is not None
    assert found.face_probabilities.sum() > 0.9
    return found


def test_two_processes_give_the_numbers_of_one(alone: TossDistribution) -> None:
    assert pickle.dumps(told(COUNT, processes=2)) == pickle.dumps(alone)


def test_the_processes_of_an_executor_give_the_numbers_of_one(alone: TossDistribution) -> None:
    """They start as Python 3.14 does it by itself."""
    with ProcessPoolExecutor(2, mp_context=get_context("forkserver")) as executor:
        assert pickle.dumps(told(COUNT, processes=executor)) == pickle.dumps(alone)


def test_a_sample_among_others_is_the_sample_alone_bit_for_bit() -> None:
    """Exact samples are alike, strike by strike up to rest."""
    alone, among = (told(count, exact=True).ghosts for count in (1, 25))
    assert set(alone.strikes.tolist()) == {0, 1, 2}
    for i in range(25):
        which = among.samples == i
        for name in ("strikes", "p_WB_W", "q_WB", "v_WB_W", "w_WB_W"):
            np.testing.assert_array_equal(getattr(among, name)[which], getattr(alone, name))


def test_few_samples_start_no_process() -> None:
    """The executor is one that takes no more work."""
    executor = ProcessPoolExecutor(2)
    executor.shutdown()
    assert told(20, processes=executor).samples == 20


@pytest.mark.parametrize("processes", [0, -1, 1.5, True, "two", None])
def test_what_is_no_number_of_processes_is_refused_by_its_name(processes: Executor | float | str) -> None:
    with pytest.raises(InvalidFieldError, match=r"^processes must be a whole number >= 1, or.*, got .*"):
        told(20, processes=processes)


def test_printed_samples_have_their_probabilities(alone: TossDistribution) -> None:
    """The first line has the faces, and each branch its own."""
    first, *lines = str(alone).splitlines()
    best = f"{alone.faces_on_top[0]} {alone.face_probabilities[0]:.1%}"
    assert first.startswith(f"TossDistribution of {COUNT} samples, on top at rest: {best}")
    branches = [line for line in lines if line.startswith("    [") and "Branch(" in line]
    assert branches
    assert all("probability=" in line for line in branches)


def test_printed_samples_that_do_not_rest_say_so() -> None:
    """Where it was asked for; some that rest and some that do not have the share of the latter."""
    few = {"covariance": np.diag([1e-4] * 12) ** 2, "count": 20}
    args = (BRICK, BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], w_WB_W=[1, 0, 0]))
    world = World(bodies=(BRICK,), surfaces=(FLOOR,))
    exact = "; taken as exact: friction, restitution, impact law"
    none = f"TossDistribution of 20 samples, none of which came to rest before the horizon{exact}"
    assert (
        str(sampled_toss(*args, world, horizon=0.5, to_rest=True, **few))
        .partition("\n  samples")[0]
        .replace("\n ", "")
        == none
    )
    unasked = f"TossDistribution of 20 samples, not followed to rest (to_rest=False){exact}"
    assert sampled_toss(*args, world, horizon=0.5, **few).in_short() == unasked
    alike = sampled_toss(*args, world, horizon=0.5, count=20)
    assert alike.exact == ("state", "friction", "restitution", "impact law")
    times = sampled_toss(*args, world, to_rest=True, **few).rest
    assert times is not None
    some = sampled_toss(*args, world, to_rest=True, horizon=float(times.seconds[2]), **few)
    still = 1.0 - some.face_probabilities.sum()
    assert 0.0 < still < 1.0
    assert (
        str(some).partition("\n  samples")[0].replace("\n ", "").endswith(f"not at rest {still:.1%}{exact}")
    )


@pytest.mark.parametrize(
    ("uncertainty", "exact"),
    [
        (TossUncertainty(height=1e-3), ("friction", "restitution", "impact law")),
        (TossUncertainty(spin=0.1), ("friction", "restitution")),
        (TossUncertainty(covariance=np.diag([0, 1, 0, 0, 0, 0]) * 1e-4), ("friction", "impact law")),
        (TossUncertainty(covariance=np.diag([1] + [0] * 8) * 1e-4), ("restitution", "impact law")),
        (TossUncertainty(lasting_factors=[1], lasting_factor_stds=[0.1]), ("restitution", "impact law")),
    ],
)
def test_samples_name_the_inputs_that_were_taken_as_exact(
    uncertainty: TossUncertainty, exact: tuple[str, ...]
) -> None:
    state = BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1])
    found = sampled_toss(BRICK, state, World(surfaces=(FLOOR,)), uncertainty=uncertainty, count=2, strikes=1)
    assert found.exact == ("state", *exact)


def test_each_face_has_the_places_of_the_samples_that_rest_on_it() -> None:
    """Of so few samples all poses are shown. Their faces are found here by the vertical in the body."""
    found = sampled_toss(
        CUBE,
        BodyState(p_WB_W=[0, 0, 0.5], q_WB=[0.3, 0.2, 0.1, 0.9273618495], v_WB_W=[1, 0, 0], w_WB_W=[0, 3, 0]),
        World(bodies=(CUBE,), surfaces=(FLOOR,)),
        covariance=state_covariance(velocity=0.02, angular_velocity=0.1),
        count=MAX_GHOSTS,
        to_rest=True,
    )
    at_rest = found.ghosts.strikes == 0
    places = found.ghosts.p_WB_W[at_rest]
    vertical_B = matrices_of(found.ghosts.q_WB[at_rest])[:, 2]
    counts = []
    for normal_B, share, region in zip(
        found.face_normals_B, found.face_probabilities, found.face_positions, strict=True
    ):
        own = places[vertical_B @ normal_B > 0.99]
        counts.append(len(own))
        assert share == len(own) / MAX_GHOSTS
        np.testing.assert_allclose(region.mean, own.mean(axis=0), rtol=0.0, atol=1e-14)  # sums of 30 places
        if len(own) < FEWEST:
            assert np.isnan(region.covariance).all()
            assert np.isnan(region.radii).all()
        else:
            np.testing.assert_allclose(region.covariance, np.cov(own.T), rtol=0.0, atol=1e-16)
    assert max(counts) >= FEWEST
    assert 0 < min(counts) < FEWEST


def test_the_quantiles_of_rest_are_printed_and_named(alone: TossDistribution) -> None:
    assert alone.rest is not None
    shown = str(alone.rest)
    assert shown.startswith("RestSpread, quantiles 5%, 25%, 50%, 75%, 95% of time (s) and place (m)")
    assert f"    [{alone.rest.positions[2, 0]:.6g}, " in shown
