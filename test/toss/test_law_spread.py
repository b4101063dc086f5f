# SPDX-License-Identifier: Apache-2.0
"""The law's own spread is an impulse at the contact for the most part, for many samples and for one."""

from __future__ import annotations

from array import array

import numpy as np
import pytest

from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.toss import TossUncertainty, sampled_toss, toss
from contact_dynamics.toss.law_spread import LawSpread
from contact_dynamics.toss.solid import Solid, numbers_of, solid_of
from contact_dynamics.world import Body, Surface, World

SIZE = (0.1, 0.12, 0.07)
BRICK = Body.box(SIZE, mass=0.4, name="brick")
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.2, restitution=0.4)
WORLD = World(bodies=(BRICK,), surfaces=(FLOOR,))
STATE = BodyState(
    p_WB_W=[0, 0, 0.3],
    q_WB=np.array([0.3, 0.5, -0.2, 0.7]) / np.linalg.norm([0.3, 0.5, -0.2, 0.7]),
    v_WB_W=[0.5, -0.2, 0.1],
    w_WB_W=[1.0, -2.0, 0.5],
)
UNCERTAINTY = TossUncertainty(velocity=0.0068, spin=0.3)
"""An impulse that changes the velocity by 6.8 mm/s changes the spin by 0.3 rad/s."""


def changes_of_many() -> np.ndarray:
    """Of the first strikes of samples that differ in nothing else."""
    found = sampled_toss(
        BRICK,
        STATE,
        WORLD,
        uncertainty=UNCERTAINTY,
        count=60,
        strikes=1,
        restitution_law=RestitutionLaw.POISSON,
        horizon=5.0,
    ).ghosts
    strike = toss(BRICK, STATE, WORLD, max_events=1, max_alternatives=0).events[0].state
    return np.hstack([found.v_WB_W - strike.v_WB_W, found.w_WB_W - strike.w_WB_W])


def changes_of_one() -> np.ndarray:
    """Of the same strike, asked for one sample after the other."""
    event = toss(BRICK, STATE, WORLD, max_events=1, max_alternatives=0).events[0]
    after = [*event.state.p_WB_W, *event.state.q_WB, *event.state.v_WB_W, *event.state.w_WB_W]
    before = [*after[:7], *STATE.v_WB_W, *STATE.w_WB_W]
    spread = LawSpread(UNCERTAINTY, 60, np.random.default_rng(0))
    solid = solid_of(BRICK, WORLD)
    kicked = [spread.of_one(i).kicked(solid, before, after, [(0, event.corners[0])]) for i in range(60)]
    return np.array(kicked)[:, 7:] - np.array(after[7:])


@pytest.mark.parametrize("changes_of", [changes_of_many, changes_of_one])
def test_changes_of_spin_are_those_of_an_impulse_that_changes_the_velocity(changes_of: object) -> None:
    event = toss(BRICK, STATE, WORLD, max_events=1, max_alternatives=0).events[0]
    R = event.state.R_WB
    inertia_W = R @ BRICK.mass_properties.I_B @ R.T
    changes = changes_of()  # type: ignore[operator]
    moments = np.cross(event.p_WC_W[0] - event.state.p_WB_W, BRICK.mass_properties.mass * changes[:, :3])
    by_impulse = np.linalg.solve(inertia_W, moments.T).T
    # Medians are compared, since tails are heavy.
    # A tenth of both variances is left, and by that 0.45 of the size.
    left, whole = (
        np.median(np.linalg.norm(x, axis=1)) for x in (changes[:, 3:] - by_impulse, changes[:, 3:])
    )
    assert len(changes) >= 30
    assert left < 0.65 * whole


def test_both_spreads_are_kept_where_a_body_cannot_be_turned_at_its_contact() -> None:
    """No impulse at a contact that is the mass centre changes a spin."""
    spread, solid = LawSpread(UNCERTAINTY, 4000, np.random.default_rng(1)), solid_of(BRICK, WORLD)
    corner = array("d", bytes(24))
    center = Solid(
        solid.mass, solid.inertia, solid.inverse, corner, (0,), 0.0, solid.gravity, solid.flats, 0.0
    )
    before, after = [*[0.0] * 6, 1.0, *[0.0] * 6], [*[0.0] * 6, 1.0, 0.0, 0.0, 1.0, *[0.0] * 3]
    kicked = [spread.of_one(i).kicked(center, before, after, [(0, 0)]) for i in range(4000)]
    changes = np.array(kicked)[:, 7:] - after[7:]
    medians = [np.median(np.linalg.norm(part, axis=1)) for part in (changes[:, :3], changes[:, 3:])]
    np.testing.assert_allclose(medians, 1.538 * np.array([0.0068, 0.3]), rtol=0.06)  # as of normal numbers


def test_what_the_spread_does_to_a_sample_does_not_depend_on_which_goes_first() -> None:
    solid, y = solid_of(BRICK, WORLD), numbers_of(STATE)
    after = [*y[:7], *(x + 0.5 for x in y[7:])]
    changed = []
    for order in ((0, 1, 2), (2, 0, 1)):
        spread = LawSpread(UNCERTAINTY, 3, np.random.default_rng(1))
        kicks = {i: spread.of_one(i).kicked(solid, y, after, [(0, 0)]) for i in order}
        changed.append([kicks[i] for i in range(3)])
    assert changed[0] == changed[1]
    assert changed[0][0] != changed[0][1]


@pytest.mark.parametrize("together", list(SeveralContactsLaw))
@pytest.mark.parametrize("turned", [0.0, 0.3, 0.3 + 1e-4], ids=["face", "edge", "corner"])
def test_flush_landings_have_the_spread_of_those_on_a_corner(
    turned: float, together: SeveralContactsLaw
) -> None:
    """Face, edge and corner. Afterwards no corner approaches the floor."""
    q = np.array([turned - 0.3 if turned > 0.3 else 0.0, np.sin(turned / 2.0), 0.0, np.cos(turned / 2.0)])
    state = BodyState(p_WB_W=[0, 0, 0.3], q_WB=q / np.linalg.norm(q), v_WB_W=[0.1, 0, 0])
    found = sampled_toss(
        BRICK,
        state,
        WORLD,
        uncertainty=TossUncertainty(velocity=0.05, spin=0.5),
        count=1000,
        strikes=1,
        several_contacts_law=together,
        restitution_law=RestitutionLaw.POISSON,
    ).ghosts
    v = found.v_WB_W - np.median(found.v_WB_W, axis=0)
    w = found.w_WB_W - np.median(found.w_WB_W, axis=0)
    # Half of normal numbers are within 0.674 deviations. An approach that is turned back changes some samples
    # of the normal velocity, and of the spin about the edge, so the spread is compared along the floor only.
    widths = np.median(np.abs(v[:, :2]), axis=0) / 0.674
    np.testing.assert_allclose(widths, 0.05, rtol=0.35)
    assert np.median(np.abs(w[:, 2])) > 0.2 * 0.5 * 0.674
    for p, q_WB, after, spin in zip(found.p_WB_W, found.q_WB, found.v_WB_W, found.w_WB_W, strict=True):
        at = BodyState(p_WB_W=p, q_WB=q_WB, v_WB_W=after, w_WB_W=spin)
        points = p + BRICK.vertices_B @ at.R_WB.T
        low = points[:, 2] < points[:, 2].min() + 1e-12
        assert at.velocity_of_point(points[low])[:, 2].min() >= -1e-12
