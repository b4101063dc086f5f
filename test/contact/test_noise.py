# SPDX-License-Identifier: Apache-2.0
"""Contacts of noisy states: hypotheses pass as often as stated, and corrections are the least ones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from scipy.stats import chi2

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, Surface, World
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.contact.noise import QUANTILES, REST_LEVEL, NoisyState, resting, touching
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.shapes import ConvexShape
from contact_dynamics.shapes.convex import box as box_of
from contact_dynamics.shapes.convex import cylinder, rounded, sphere
from sweeps import seeds

SIZE = np.array([0.15, 0.09, 0.05])
DEVIATIONS = np.repeat([2e-4, 2e-3, 0.02, 0.2], 3)  # m, rad, m/s, rad/s
COVARIANCE = np.diag(DEVIATIONS**2)
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.4)
WALL = Surface(name="wall", p_WS_W=[0, 0, 0], normal_W=[1, 0, 0], friction=0.3, restitution=0.4)
DRAWS = 60
EXACT = 1e-13  # m and m/s: rounding of a few operations
HOW = {"distance_tolerance": 1e-6}
STILL = {"velocity_tolerance": 1e-9}


def body(shape: ConvexShape) -> Body:
    return Body(name="it", mass_properties=MassProperties(mass=0.4, I_B=1e-3 * np.eye(3)), shape=shape)


BOX = body(box_of(size=SIZE))


def state(p: Any, *, v: Any = (0, 0, 0), w: Any = (0, 0, 0), turn: Rotation | None = None) -> BodyState:
    q = np.array([0.0, 0.0, 0.0, 1.0]) if turn is None else turn.as_quat()
    return BodyState(p_WB_W=p, q_WB=q, v_WB_W=v, w_WB_W=w)


def measured(true: BodyState, chance: np.random.Generator, deviations: np.ndarray = DEVIATIONS) -> NoisyState:
    """Return a state with an error drawn from the deviations, and these."""
    error = chance.normal(size=12) * deviations
    turn = Rotation.from_rotvec(error[3:6]) * Rotation.from_quat(true.q_WB)
    seen = state(true.p_WB_W + error[:3], v=true.v_WB_W + error[6:9], w=true.w_WB_W + error[9:], turn=turn)
    return NoisyState.of(seen, np.diag(deviations**2))


def settled(of: Body, noisy: NoisyState, *surfaces: Surface) -> tuple[BodyState, ContactSet]:
    noisy = touching(of, noisy, surfaces, **HOW)
    contacts = find_contacts(of, noisy.state, World(surfaces=tuple(surfaces)), **HOW)
    return resting(noisy, contacts, **STILL).state, contacts


def velocities(found: BodyState, contacts: ContactSet) -> np.ndarray:
    """Return the normal and the tangential speed of each contact, (n, 2)."""
    v = found.velocity_of_point(contacts.p_WC_W)
    along = np.einsum("ij,ij->i", v, contacts.normals_W)
    return np.column_stack([along, np.linalg.norm(v - along[:, None] * contacts.normals_W, axis=1)])


def test_the_quantiles_are_those_of_chi_squared() -> None:
    np.testing.assert_allclose(QUANTILES[1:], chi2.ppf(REST_LEVEL, range(1, 7)), rtol=1e-7)


@pytest.mark.parametrize(
    ("shape", "height", "feet"),
    [
        (box_of(size=SIZE), 0.5 * SIZE[2], 4),
        (sphere(radius=0.05), 0.05, 1),
        (cylinder(radius=0.04, length=0.1), 0.05, 8),
        (rounded(box_of(size=SIZE), radius=0.01), 0.5 * SIZE[2] + 0.01, 4),
    ],
)
def test_a_body_at_rest_touches_with_all_its_feet_and_none_moves(
    shape: ConvexShape, height: float, feet: int
) -> None:
    """The test of each condition rejects one of a thousand: of 60 draws more than two hardly ever."""
    chance, rejected = np.random.default_rng(5), 0
    for _ in range(DRAWS):
        turn = Rotation.from_rotvec([0.0, 0.0, chance.uniform(-3.0, 3.0)])
        seen = measured(state([0.3, 0.2, height], turn=turn), chance)
        try:
            found, contacts = settled(body(shape), seen, FLOOR)
        except InvalidFieldError:  # deeper in the floor than the noise explains
            rejected += 1
            continue
        touches = len(contacts) == feet and np.abs(contacts.p_WC_W[:, 2]).max() < 1e-12
        rejected += not touches or np.abs(velocities(found, contacts)).max() > EXACT
    assert rejected <= 2


def test_a_box_in_a_corner_touches_both_walls() -> None:
    chance = np.random.default_rng(6)
    at_rest = state([0.5 * SIZE[0], 0.0, 0.5 * SIZE[2]])
    counts = [len(settled(BOX, measured(at_rest, chance), FLOOR, WALL)[1]) for _ in range(DRAWS)]
    assert counts.count(8) >= DRAWS - 2


def test_a_box_that_slides_keeps_its_feet_on_the_floor_and_its_speed() -> None:
    chance, wrong = np.random.default_rng(7), 0
    for _ in range(DRAWS):
        noisy = measured(state([0, 0, 0.5 * SIZE[2]], v=(0.3, 0.0, 0.0)), chance)
        found, contacts = settled(BOX, noisy, FLOOR)
        speeds = velocities(found, contacts)
        wrong += len(contacts) != 4 or np.abs(speeds[:, 0]).max() > EXACT or speeds[:, 1].min() < 0.2
    assert wrong <= 2


def test_a_box_that_rocks_on_an_edge_rests_on_two_feet_and_lifts_the_others() -> None:
    chance, wrong = np.random.default_rng(8), 0
    spin = np.array([0.0, -6.0, 0.0])  # about the lower edge at +x: the feet at -x come up by 0.9 m/s
    arm = np.array([-0.5 * SIZE[0], 0.0, 0.5 * SIZE[2]])
    true = state([0, 0, 0.5 * SIZE[2]], v=np.cross(-spin, arm), w=-spin)
    for _ in range(DRAWS):
        found, contacts = settled(BOX, measured(true, chance), FLOOR)
        lifted = contacts.p_WC_W[:, 0] < 0.0
        speeds = velocities(found, contacts)
        rests = sum(~lifted) == sum(lifted) == 2 and np.abs(speeds[~lifted]).max() < EXACT
        wrong += not rests or speeds[lifted, 0].min() < 0.5
    assert wrong <= 2


def test_a_box_that_falls_and_one_in_flight_stay_as_they_are() -> None:
    falls = NoisyState.of(state([0, 0, 0.5 * SIZE[2]], v=(0.0, 0.0, -1.0)), COVARIANCE)
    contacts = find_contacts(BOX, falls.state, World(surfaces=(FLOOR,)), **HOW)
    found = resting(falls, contacts, **STILL).state
    assert found.velocity_of_point(contacts.p_WC_W)[:, 2].max() < -0.9
    flies = NoisyState.of(state([0, 0, 0.5 * SIZE[2] + 0.01]), COVARIANCE)
    assert touching(BOX, flies, [FLOOR], **HOW).state is flies.state


def test_without_noise_nothing_changes() -> None:
    exact = NoisyState.of(state([0, 0, 0.5 * SIZE[2]], v=(1e-6, 0.0, 0.0)), np.zeros((12, 12)))
    found = touching(BOX, exact, [FLOOR], **HOW)
    assert found.state is exact.state
    contacts = find_contacts(BOX, exact.state, World(surfaces=(FLOOR,)), **HOW)
    assert resting(exact, contacts, **STILL).state is exact.state


@seeds(range(5))
def test_the_correction_is_the_least_one_by_the_covariance(seed: int) -> None:
    """A minimiser finds the same state from the conditions and a covariance of errors that hang together."""
    chance = np.random.default_rng(seed)
    root = np.diag(DEVIATIONS) @ chance.normal(size=(12, 12)) / math.sqrt(12.0)
    at = state([0.3, 0.2, 0.5 * SIZE[2]])
    error = root @ chance.normal(size=12)
    seen = state(at.p_WB_W + error[:3], v=error[6:9], w=error[9:], turn=Rotation.from_rotvec(error[3:6]))
    noisy = NoisyState.of(seen, root @ root.T)
    contacts = ContactSet(
        p_WC_W=[[0.2, 0.2, 0], [0.4, 0.2, 0], [0.3, 0.3, 0]],
        normals_W=[0, 0, 1],
        frictions=0.3,
        restitutions=0.0,
    )
    inverse = np.linalg.inv(noisy.root @ noisy.root.T)
    scale = DEVIATIONS

    def size(x: np.ndarray) -> float:
        return float((scale * x) @ inverse @ (scale * x))

    def conditions(x: np.ndarray) -> np.ndarray:
        v, w = seen.v_WB_W + scale[6:9] * x[6:9], seen.w_WB_W + scale[9:] * x[9:]
        return np.ravel(v + np.cross(w, contacts.p_WC_W - seen.p_WB_W))

    best = minimize(
        size,
        np.zeros(12),
        constraints={"type": "eq", "fun": lambda x: conditions(x)[[0, 1, 2, 4, 5, 8]]},
        method="SLSQP",
        options={"ftol": 1e-14, "maxiter": 500},
    )
    assert size(best.x) < QUANTILES[6]
    found = resting(noisy, contacts, **STILL).state
    np.testing.assert_allclose(found.p_WB_W, seen.p_WB_W + scale[:3] * best.x[:3], rtol=0.0, atol=1e-7)
    np.testing.assert_allclose(found.w_WB_W, seen.w_WB_W + scale[9:] * best.x[9:], rtol=0.0, atol=1e-6)
    assert np.abs(velocities(found, contacts)).max() < EXACT
