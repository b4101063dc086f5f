# SPDX-License-Identifier: Apache-2.0
"""Impacts of mechanisms, which are known by their contact's inverse inertia alone, also a singular one."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from contact_dynamics import (
    BodyState,
    Contact,
    RestitutionLaw,
    response_impact,
    spatial_impact,
    spatial_pair_impact,
)
from contact_dynamics.errors import InvalidFieldError, SeparatingContactError
from contact_dynamics.impact import ImpactOutcome, PathEvent, ResponseImpact, SpatialImpact, response_impacts
from impact.spatial.drawn_problem import random_body, random_problem, solve
from sweeps import seeds

UP = (0.0, 0.0, 1.0)


def touch(friction: float, restitution: float, normal: Any = UP) -> Contact:
    return Contact(p_WC_W=[0, 0, 0], normal_W=normal, friction=friction, restitution=restitution)


def agrees(found: ResponseImpact, expected: SpatialImpact, tolerance: float) -> None:
    """Compare relative to the impulse and to the velocity before."""
    assert (found.outcome, found.jams) == (expected.outcome, expected.jams)
    size = float(abs(expected.impulse_W).max())
    for name in ("impulse_W", "compression_W", "restitution_W"):
        np.testing.assert_allclose(
            getattr(found, name), getattr(expected, name), rtol=0, atol=tolerance * size
        )
    speed = float(abs(expected.velocity_before_W).max())
    np.testing.assert_allclose(
        found.velocity_after_W, expected.velocity_after_W, rtol=0, atol=10.0 * tolerance * speed
    )
    assert found.creates_energy == expected.creates_energy
    assert found.path_events == expected.path_events


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_body_known_by_its_response_strikes_as_the_body_does(law: RestitutionLaw) -> None:
    for seed in range(60):
        problem = random_problem(seed)
        expected = solve(problem, law)
        contact = touch(problem["friction"], problem["restitution"], problem["n_W"])  # type: ignore[arg-type]
        velocity = problem["state"].velocity_of_point(problem["p_WC_W"])  # type: ignore[attr-defined]
        found = response_impact(expected.inverse_inertia_W, velocity, contact, restitution_law=law)
        agrees(found, expected, 1e-11)  # paths that turn long amplify rounding


@seeds(range(10))
def test_the_responses_of_two_that_strike_each_other_add(seed: int) -> None:
    rng = np.random.default_rng(seed)
    bodies = [random_body(rng) for _ in range(2)]
    states = [
        BodyState(p_WB_W=rng.normal(size=3), q_WB=[0, 0, 0, 1], v_WB_W=v, w_WB_W=rng.normal(size=3))
        for v in ([0, 0, -9], [0, 0, 9])
    ]
    contact = touch(0.4, 0.6)
    expected = spatial_pair_impact(bodies[0], states[0], bodies[1], states[1], contact)
    single = [
        spatial_impact(body, state, touch(0.4, 0.6, normal)).inverse_inertia_W
        for body, state, normal in zip(bodies, states, (UP, (0.0, 0.0, -1.0)), strict=True)
    ]
    relative = states[0].velocity_of_point(np.zeros(3)) - states[1].velocity_of_point(np.zeros(3))
    agrees(response_impact(single[0] + single[1], relative, contact), expected, 1e-12)


def test_the_sliding_rod_of_lecture_27_from_its_response_alone() -> None:
    # m = I = 1, r = (-1, -4): it slides into compression, and sticks.
    response = np.array([[1.0 + 16.0, 0.0, -4.0], [0.0, 1.0, 0.0], [-4.0, 0.0, 1.0 + 1.0]])
    found = response_impact(response, [-1, 0, 0], touch(math.tan(math.pi / 6), 0.5))
    assert found.jams
    assert found.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
    assert found.impulse_W == pytest.approx([0.1372549, 0.0, 1.0 / 3.0], abs=1e-7)
    assert found.compression_W == pytest.approx([1.0 / 9.0, 0.0, 2.0 / 9.0], abs=1e-12)
    assert found.velocity_after_W == pytest.approx([0.0, 0.0, 0.1176471], abs=1e-7)
    assert found.energy_change == pytest.approx(-0.0490196, abs=1e-7)


# A planar arm of two links in the plane x z. Its response is singular, since its tip cannot move along y.


def arm(q: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return the mass matrix and the tip's Jacobian, (3, 2), of rods of 1.2 and 0.8 kg, 0.5 and 0.4 m."""
    (m1, m2), (l1, l2) = (1.2, 0.8), (0.5, 0.4)
    a, b = q[0], q[0] + q[1]
    e1, e2 = np.array([-math.sin(a), 0, math.cos(a)]), np.array([-math.sin(b), 0, math.cos(b)])
    middle1, middle2 = np.array([e1 * l1 / 2, 0 * e1]).T, np.array([e1 * l1 + e2 * l2 / 2, e2 * l2 / 2]).T
    mass = m1 * middle1.T @ middle1 + m2 * middle2.T @ middle2
    mass += m1 * l1**2 / 12 * np.array([[1, 0], [0, 0]]) + m2 * l2**2 / 12 * np.ones((2, 2))
    return mass, np.array([e1 * l1 + e2 * l2, e2 * l2]).T


def stepped(mass: np.ndarray, jacobian: np.ndarray, rates: np.ndarray, mu: float, e: float) -> np.ndarray:
    """Return the joint rates after an impact on z = 0 by Poisson's law, in small steps of normal impulse.

    Friction along x slides, or holds where less than its limit does so. First order in the step.
    """
    push, drag = (np.linalg.solve(mass, row) for row in (jacobian[2], jacobian[0]))
    step, p, due, compressing = 2e-4, 0.0, math.inf, True
    while p < due:
        free = jacobian[0] @ (rates + push * step)
        friction = float(np.clip(-free / (jacobian[0] @ drag), -mu * step, mu * step))
        rates = rates + push * step + drag * friction
        p += step
        if compressing and jacobian[2] @ rates >= 0.0:
            compressing, due = False, p * (1.0 + e)
    return rates


ARM, TIP = arm((0.7, -1.9))
ARM_RESPONSE = TIP @ np.linalg.solve(ARM, TIP.T)


@pytest.mark.parametrize(
    ("rates", "mu", "outcome"),
    [
        ((-2.0, 0.3), 0.2, ImpactOutcome.SLIDES),
        ((-2.0, 0.3), 0.6, ImpactOutcome.STICKS_IN_COMPRESSION),
        ((0.3, 1.0), 0.2, ImpactOutcome.REVERSES_IN_RESTITUTION),
        ((-0.8, -1.0), 0.2, ImpactOutcome.REVERSES_IN_COMPRESSION),
    ],
)
def test_a_planar_arm_strikes_a_table_as_small_steps_of_its_joints_do(
    rates: tuple[float, float], mu: float, outcome: ImpactOutcome
) -> None:
    velocity = TIP @ rates
    sign = 1.0 if velocity[2] < 0.0 else -1.0
    found = response_impact(ARM_RESPONSE, sign * velocity, touch(mu, 0.5))
    assert found.outcome is outcome
    assert found.impulse_W[1] == found.velocity_after_W[1] == 0.0
    after = sign * np.array(rates) + np.linalg.solve(ARM, TIP.T @ found.impulse_W)
    assert after == pytest.approx(stepped(ARM, TIP, sign * np.array(rates), mu, 0.5), abs=4e-3)
    assert TIP @ after == pytest.approx(found.velocity_after_W, abs=1e-14)


@pytest.mark.parametrize("rates", [(-2.0, 0.3), (-1.0, 3.0)])
def test_a_planar_arm_on_a_tilted_table_swerves_as_an_integration_in_its_joints_does(
    rates: tuple[float, float],
) -> None:
    normal, mu, e = np.array([0.0, 0.6, 0.8]), 0.3, 0.5

    def rate(_: float, joints: np.ndarray) -> np.ndarray:
        velocity = TIP @ joints
        sliding = velocity - (velocity @ normal) * normal
        force = normal - mu * sliding / np.linalg.norm(sliding)
        return np.asarray(np.linalg.solve(ARM, TIP.T @ force))

    def compressed(_: float, joints: np.ndarray) -> float:
        return float(normal @ TIP @ joints)

    compressed.terminal = True  # type: ignore[attr-defined]
    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
    first = solve_ivp(rate, (0.0, 10.0), rates, events=compressed, **options)
    last = solve_ivp(rate, (0.0, e * first.t[-1]), first.y[:, -1], **options)
    found = response_impact(ARM_RESPONSE, TIP @ rates, touch(mu, e, normal))
    assert found.outcome is ImpactOutcome.SLIDES
    assert found.impulse_W @ normal == pytest.approx((1.0 + e) * first.t[-1], rel=1e-10)
    after = rates + np.linalg.solve(ARM, TIP.T @ found.impulse_W)
    assert after == pytest.approx(last.y[:, -1], rel=1e-9)


def drawn_mechanism(seed: int, rank: int) -> tuple[np.ndarray, np.ndarray, Contact]:
    """Return W, a velocity that such a mechanism can have, and a contact that approaches.

    Of a rank below 3, every third normal is one along which it can move without sliding.
    """
    rng = np.random.default_rng(seed)
    ways = rng.normal(size=(3, rank)) * 10.0 ** rng.uniform(-1.0, 1.0, size=rank)
    velocity = ways @ rng.normal(size=rank)
    normal = ways @ rng.normal(size=rank) if seed % 3 == 0 else rng.normal(size=3)
    normal /= -math.copysign(float(np.linalg.norm(normal)), normal @ velocity)
    friction, restitution = (
        float(10.0 ** rng.uniform(-1.5, 0.7)),
        float(rng.choice([0.0, 1.0, rng.uniform()])),
    )
    return ways @ ways.T, velocity, touch(friction, restitution, normal)


@pytest.mark.parametrize("law", RestitutionLaw)
@pytest.mark.parametrize("rank", [1, 2, 3])
@given(seed=st.integers(0, 2**32))
@example(seed=1547015711)  # of rank 2, a normal almost in its plane
def test_impacts_of_mechanisms_obey_their_laws(law: RestitutionLaw, rank: int, seed: int) -> None:
    response, velocity, contact = drawn_mechanism(seed, rank)
    normal, mu = contact.normal_W, contact.friction
    try:
        found = response_impact(response, velocity, contact, restitution_law=law)
    except InvalidFieldError as error:
        # A wedge: an impulse in the friction cone moves nothing. Only these laws demand that it does.
        if "wedges" not in str(error):
            raise
        assert law is not RestitutionLaw.POISSON
        assert contact.impact_restitution > 0.0
        tangents = np.linalg.svd(normal[None])[2][1:].T
        friction = np.linalg.lstsq(response @ tangents, -response @ normal, rcond=1e-9)[0]
        assert np.linalg.norm(friction) <= mu
        assert response @ (normal + tangents @ friction) == pytest.approx([0, 0, 0], abs=1e-9)
        return
    speed, size = float(abs(velocity).max()), float(abs(found.impulse_W).max())
    # Impulses that all but wedge are huge, and so are the terms whose sum is the velocity.
    rounding = 1e-9 * speed + 1e-11 * size * float(abs(response).max())
    np.testing.assert_allclose(
        found.velocity_after_W, velocity + response @ found.impulse_W, rtol=0, atol=rounding
    )
    steps = np.diff(found.path_W, axis=0)
    along = steps @ normal
    across = np.linalg.norm(steps - along[:, None] * normal, axis=1)
    assert (along >= -1e-12 * size).all()
    assert (across <= mu * along + 1e-9 * size).all()
    assert found.path_W[-1] == pytest.approx(found.impulse_W, abs=1e-12 * size)
    assert found.velocity_after_W @ normal >= -1e-10 * speed
    if found.outcome.sticks:
        sliding = found.velocity_after_W - (found.velocity_after_W @ normal) * normal
        assert abs(sliding).max() <= 1e-9 * speed
    if law is not RestitutionLaw.NEWTON:
        assert found.energy_change <= 1e-9 * size * speed
    if found.path_events.count(PathEvent.COMPRESSION_ENDS) != 1:
        return
    e = contact.restitution
    if law is RestitutionLaw.POISSON:
        assert found.restitution_W @ normal == pytest.approx(
            e * (found.compression_W @ normal), rel=1e-8, abs=1e-12 * size
        )
    elif law is RestitutionLaw.NEWTON:
        assert found.velocity_after_W @ normal == pytest.approx(-e * (velocity @ normal), abs=1e-8 * speed)


@pytest.mark.parametrize("noise", [1e-17, 1e-15, 1e-13, 1e-12])
@pytest.mark.parametrize("law", RestitutionLaw)
def test_rounding_of_a_singular_response_changes_nothing(law: RestitutionLaw, noise: float) -> None:
    rng = np.random.default_rng(2)
    for rates in ((-2.0, 0.3), (-0.3, -1.0)):
        exact = response_impact(ARM_RESPONSE, TIP @ rates, touch(0.6, 0.5), restitution_law=law)
        for _ in range(20):
            off = noise * rng.normal(size=(3, 3))
            found = response_impact(
                ARM_RESPONSE + off + off.T, TIP @ rates, touch(0.6, 0.5), restitution_law=law
            )
            assert found.outcome is exact.outcome
            assert found.impulse_W == pytest.approx(exact.impulse_W, abs=1e-10)
            assert found.velocity_after_W == pytest.approx(exact.velocity_after_W, abs=1e-10)


@pytest.mark.parametrize("law", RestitutionLaw)
def test_a_lever_that_friction_holds_wedges(law: RestitutionLaw) -> None:
    # One degree of freedom: its contact moves along (1, 0, 2) only, and does not separate while it sticks.
    way = np.array([1.0, 0.0, 2.0])
    response, velocity = np.outer(way, way), -0.7 * way
    for mu, e in ((0.3, 0.5), (3.0, 0.0)):
        found = response_impact(response, velocity, touch(mu, e), restitution_law=law)
        assert np.cross(found.velocity_after_W, way) == pytest.approx([0, 0, 0], abs=1e-12)
        assert (found.velocity_after_W @ way > 0.1) == (mu < 0.5)
    if law is RestitutionLaw.POISSON:
        found = response_impact(response, velocity, touch(3.0, 0.5))
        assert found.outcome is ImpactOutcome.STICKS_IN_COMPRESSION
        assert found.velocity_after_W == pytest.approx([0, 0, 0], abs=1e-14)
        # Sliding stops it by (3, 0, 1) p, way . (3, 0, 1) p = 0.7, and sticking takes half of p once more.
        assert found.impulse_W == pytest.approx([0.42 - 0.14, 0.0, 0.14 + 0.07])
    else:
        with pytest.raises(InvalidFieldError, match=r"^inverse_inertia_W must .* wedges"):
            response_impact(response, velocity, touch(3.0, 0.5), restitution_law=law)
    # A surface that drags it into itself: what approaches is more than the lever can give.
    with pytest.raises(InvalidFieldError, match=r"^inverse_inertia_W must .* wedges"):
        response_impact(response, velocity + np.array([5.0, 1.0, 0.0]), touch(3.0, 0.5), restitution_law=law)
    with pytest.raises(InvalidFieldError, match=r"^inverse_inertia_W must .* wedges"):
        response_impact(response, velocity + np.array([5.0, 0.0, 0.0]), touch(3.0, 0.0), restitution_law=law)


def test_a_contact_that_moves_along_its_normal_only_keeps_its_sliding() -> None:
    found = response_impact(np.diag([0.0, 0.0, 2.0]), [3.0, 4.0, -1.0], touch(0.5, 0.5))
    assert found.velocity_after_W == pytest.approx([3.0, 4.0, 0.5])
    assert found.impulse_W == pytest.approx([-0.225, -0.3, 0.75])


def test_a_batch_has_the_numbers_of_single_calls() -> None:
    drawn = [drawn_mechanism(seed, 1 + seed % 3) for seed in range(60)]
    laws = [RestitutionLaw(0 if i % 3 < 2 else i % 9 // 3) for i in range(len(drawn))]
    table = {
        "normals_W": [contact.normal_W for _, _, contact in drawn],
        "frictions": [contact.friction for _, _, contact in drawn],
        "restitutions": [contact.restitution for _, _, contact in drawn],
        "restitution_laws": laws,
    }
    found = response_impacts([w for w, _, _ in drawn], [v for _, v, _ in drawn], **table)
    for i, ((response, velocity, contact), law) in enumerate(zip(drawn, laws, strict=True)):
        one = response_impact(response, velocity, contact, restitution_law=law)
        assert (found.outcomes[i], found.restitution_laws[i]) == (one.outcome, law)
        for name in ("impulse", "compression", "velocity_before", "velocity_after"):
            plural = name.replace("velocity", "velocities") if "vel" in name else f"{name}s"
            assert getattr(found, f"{plural}_W")[i].tolist() == getattr(one, f"{name}_W").tolist()
        assert found.energy_changes[i] == one.energy_change
    alone = response_impacts(
        ARM_RESPONSE, TIP @ (-2.0, 0.3), **{**table, "restitution_laws": 0}, skip_separating=True
    )
    assert len(alone.outcomes) == len(drawn)
    assert (alone.impulses_W[alone.velocities_before_W @ UP > 0.0] == 0.0).all()


SLANTED = touch(0.3, 0.5)


@pytest.mark.parametrize(
    ("response", "velocity", "contact", "text"),
    [
        (np.diag([1.0, -1.0, 2.0]), [1, 0, -1], SLANTED, r"inverse_inertia_W must be positive semidefinite"),
        ([[1, 0, 2], [0, 1, 0], [2, 0, 1]], [1, 0, -1], SLANTED, r"inverse_inertia_W must be positive semid"),
        ([[1, 0, 2], [0, 1, 0], [0, 0, 1]], [1, 0, -1], SLANTED, r"inverse_inertia_W must be symmetric"),
        (np.diag([1.0, 1.0, 0.0]), [1, 0, -1], SLANTED, r"inverse_inertia_W must .* along the normal"),
        (np.zeros((3, 3)), [1, 0, -1], SLANTED, r"inverse_inertia_W must .* along the normal"),
        (
            np.eye(2),
            [1, 0, -1],
            SLANTED,
            r"inverse_inertia_W must be of shape \(3, 3\), got .* a row and a column of zeros",
        ),
        (1e70 * np.eye(3), [1, 0, -1], SLANTED, r"inverse_inertia_W must be at most 1e\+60"),
        (
            np.eye(3),
            [1, 0, -1],
            Contact(p_WC_W=[0, 0, 0], normal_W=UP, friction=0),
            r"contact.restitution must",
        ),
    ],
)
def test_what_is_no_mechanism_is_an_error_that_names_it(
    response: Any, velocity: Any, contact: Contact, text: str
) -> None:
    with pytest.raises(InvalidFieldError, match=f"^{text}"):
        response_impact(response, velocity, contact)
    row = re.sub(r"^inverse_inertia_W must (?=be s|be pos|.*along)", r"inverse_inertias_W\\[1\\] must ", text)
    if contact.restitution is None or row == text:
        return
    with pytest.raises(InvalidFieldError, match=f"^{row}"):
        response_impacts([np.eye(3), response], velocity, normals_W=UP, frictions=0.3, restitutions=0.5)


def test_a_contact_that_separates_is_an_error() -> None:
    with pytest.raises(SeparatingContactError, match=r"got v_n = 1 m/s"):
        response_impact(np.eye(3), [0, 0, 1], SLANTED)
    with pytest.raises(SeparatingContactError, match=r"of case 1"):
        response_impacts(np.eye(3), [[0, 0, -1], [0, 0, 1]], normals_W=UP, frictions=0.3, restitutions=0.5)


RECIPES = re.findall(
    r"```py\n(.*?)```\n\n```text\n(.*?)```",
    (Path(__file__).parents[3] / "docs" / "impact.md").read_text("utf-8"),
    re.DOTALL,
)


@pytest.mark.parametrize("library", ["mujoco", "pinocchio"])
def test_the_recipe_of_the_documents(library: str, capsys: pytest.CaptureFixture[str]) -> None:
    ((code, printed),) = [(code, printed) for code, printed in RECIPES if f"import {library}" in code]
    pytest.importorskip(library)
    exec(compile(code, library, "exec"), {})  # noqa: S102  our own
    assert capsys.readouterr().out == printed
