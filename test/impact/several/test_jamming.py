# SPDX-License-Identifier: Apache-2.0
"""Contacts that jam although none approaches: closed forms, Routh's path at one, laws on drawn sets."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    SpatialContactProblem,
    contact_modes,
)
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact import ResolvedImpact, planar_impact
from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.numerics.lemke import solve_complementarity
from contact_dynamics.plane.lifting import planar_in_space
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body.body import BodyState, MassProperties, kinetic_energy
from contact_modes.evidence import planar_problem
from oracles.contact_mode_cases import FloatCase, draw, rounded
from sweeps import seeds

AXES = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
OUT = np.array([0.0, 0.0, 1.0])
SHORT = 1e-6  # relative: what the wrench does in the short time that it acts for is given back in part
SOLVED = 1e-9  # relative: linear algebra of a few dozen unknowns, of condition up to 1e5


def jam(case: FloatCase, *, in_space: bool = False) -> tuple[ResolvedImpact, MassProperties, BodyState]:
    body, velocity, contacts, wrench = case
    contacts = [replace(one, restitution=one.restitution or 0.0) for one in contacts]
    solid, state, touching = planar_in_space(body, velocity, contacts, axes_W=AXES)
    impact = jamming_impact(
        solid,
        state,
        touching,
        force_W=(*wrench.f, 0.0),
        torque_W=(0.0, 0.0, wrench.moment),
        plane_normal_W=None if in_space else OUT,
    )
    return impact, solid, state


def velocity_of(state: BodyState) -> PlanarVelocity:
    x, y = state.v_WB_W[:2].tolist()
    return PlanarVelocity(v=(x, y), w=float(state.w_WB_W[2]))


@pytest.mark.parametrize("in_space", [False, True])
@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_one_contact_that_sticks_ends_where_rouths_path_does(*, restitution: float, in_space: bool) -> None:
    # Lecture 27's sliding rod: sliding drives it into compression, in which it sticks.
    tip = PlanarContact(
        r=(-1.0, -4.0), normal=(0.0, 1.0), friction=math.tan(math.pi / 6.0), restitution=restitution
    )
    body, velocity = PlanarBody(mass=1.0, inertia=1.0), PlanarVelocity(v=(-1.0, 0.0), w=0.0)
    impact, _, _ = jam((body, velocity, [tip], PlanarWrench(f=(0.0, -9.81))), in_space=in_space)
    routh = planar_impact(body, velocity, tip)
    assert routh.jams
    assert impact.converged
    near = SOLVED if restitution == 0.0 else SHORT
    np.testing.assert_allclose(impact.impulses_W[0], [*routh.impulse, 0.0], atol=near)
    np.testing.assert_allclose(impact.state.v_WB_W, [*routh.velocity.v, 0.0], atol=near)
    assert impact.state.w_WB_W[2] == pytest.approx(routh.velocity.w, abs=near)


def slot(friction: float) -> FloatCase:
    """A point of the body in a slot along x, sliding left, pressed by the wrench."""
    sides = [
        PlanarContact(r=(1.0, -3.0), normal=(0.0, side), friction=friction, restitution=0.0)
        for side in (1.0, -1.0)
    ]
    body = PlanarBody(mass=2.0, inertia=1.0 / 3.0)
    return body, PlanarVelocity(v=(2.0, 1.0), w=-1.0), sides, PlanarWrench(f=(3.0, 3.0), moment=1.0)


def test_a_point_in_a_slot_stops_dead() -> None:
    case = slot(2.0)
    body, _, (side, _), wrench = case
    assert contact_modes(planar_problem(*case)).verdict == ModeVerdict.INCONSISTENT
    impact, _, _ = jam(case)
    # By hand: the point's inverse inertia takes its velocity (-1, 0) to zero.
    x, y = side.r
    K = np.eye(2) / body.mass + np.array([[y * y, -x * y], [-x * y, x * x]]) / body.inertia
    expected = np.linalg.solve(K, [1.0, 0.0])
    np.testing.assert_allclose(impact.impulses_W.sum(axis=0)[:2], expected, atol=SOLVED)
    np.testing.assert_allclose(impact.velocities_after_W, 0.0, atol=SOLVED)
    # Then the body turns about the point, freely.
    after = contact_modes(
        PlanarContactProblem(body=body, velocity=velocity_of(impact.state), contacts=case[2], wrench=wrench)
    )
    assert [mode.mode for mode in after.modes] == ["ff"]


def test_a_slot_with_little_friction_does_not_jam() -> None:
    assert contact_modes(planar_problem(*slot(0.1))).verdict != ModeVerdict.INCONSISTENT


def inconsistent_cases(seeds: range) -> list[FloatCase]:
    cases = [rounded(draw(seed, most_contacts=4)) for seed in seeds]
    found = [
        case for case in cases if contact_modes(planar_problem(*case)).verdict == ModeVerdict.INCONSISTENT
    ]
    assert len(found) > 20
    return found


@pytest.mark.parametrize("in_space", [False, True])
def test_laws_of_impact_on_drawn_sets(*, in_space: bool) -> None:
    settled = 0
    cases = inconsistent_cases(range(600))
    for case in cases:
        impact, body, before = jam(case, in_space=in_space)
        if not impact.converged:
            continue
        touching = planar_in_space(*case[:3], axes_W=AXES)[2]
        impulses, size = impact.impulses_W, float(np.abs(impact.impulses_W).max())
        # Momentum and angular momentum change by the impulses.
        jump = body.mass * (impact.state.v_WB_W - before.v_WB_W)
        np.testing.assert_allclose(impulses.sum(axis=0), jump, atol=SOLVED * (1.0 + size))
        turn = body.I_B @ (impact.state.w_WB_W - before.w_WB_W)
        moment = np.cross(touching.p_WC_W, impulses).sum(axis=0)
        np.testing.assert_allclose(moment, turn, atol=10.0 * SOLVED * (1.0 + size))
        # They lie in their cones, and leave no contact approaching; energy falls. The cones hold to what the
        # short time of the wrench leaves out.
        normal = np.einsum("ij,ij->i", impulses, touching.normals_W)
        across = np.linalg.norm(impulses - normal[:, None] * touching.normals_W, axis=1)
        assert (normal >= -1e-5 * size).all()
        assert (across <= touching.frictions * normal + 1e-4 * size).all()
        v_n = np.einsum("ij,ij->i", impact.velocities_after_W, touching.normals_W)
        assert (v_n >= -1e-7).all()
        assert kinetic_energy(body, impact.state) <= kinetic_energy(body, before) * (1.0 + SOLVED)
        after = contact_modes(
            PlanarContactProblem(
                body=case[0], velocity=velocity_of(impact.state), contacts=case[2], wrench=case[3]
            )
        )
        settled += after.verdict in {ModeVerdict.UNIQUE, ModeVerdict.INDETERMINATE}
    # A few of these sets, degenerate by design, jam again.
    assert settled >= 0.9 * len(cases)


def inconsistent_in_space(seed: int) -> tuple[MassProperties, BodyState, ContactSet, np.ndarray] | None:
    """Return a body that slides, without turning, along surfaces; None where a mode is consistent."""
    chance = np.random.default_rng(seed)
    way = chance.normal(size=3)
    way /= np.linalg.norm(way)
    n = int(chance.integers(2, 5))
    normals = chance.normal(size=(n, 3))
    normals -= np.outer(normals @ way, way)
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    touching = ContactSet(
        p_WC_W=2.0 * chance.normal(size=(n, 3)),
        normals_W=normals,
        frictions=chance.uniform(0.3, 2.0, n),
        restitutions=0.0,
    )
    body = MassProperties(mass=1.0, I_B=np.diag([0.1, 0.2, 0.25]))
    state = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=way)
    force = chance.normal(size=3) - 2.0 * normals.sum(axis=0)
    answer = contact_modes(SpatialContactProblem(body=body, state=state, contacts=touching, force_W=force))
    return (body, state, touching, force) if answer.verdict == ModeVerdict.INCONSISTENT else None


def test_what_jams_in_space_is_settled() -> None:
    cases = [case for case in map(inconsistent_in_space, range(60)) if case is not None]
    assert len(cases) > 7
    for body, state, touching, force in cases:

        def verdict(
            now: BodyState,
            body: MassProperties = body,
            touching: ContactSet = touching,
            force: np.ndarray = force,
        ) -> ModeVerdict:
            return contact_modes(
                SpatialContactProblem(body=body, state=now, contacts=touching, force_W=force)
            ).verdict

        impact = jamming_impact(
            body,
            state,
            touching,
            force_W=force,
            is_settled=lambda now: verdict(now) != ModeVerdict.INCONSISTENT,
        )
        assert impact.converged
        assert verdict(impact.state) in {ModeVerdict.UNIQUE, ModeVerdict.INDETERMINATE}
        assert kinetic_energy(body, impact.state) < kinetic_energy(body, state)
        jump = body.mass * (impact.state.v_WB_W - state.v_WB_W)
        size = float(np.abs(impact.impulses_W).max())
        np.testing.assert_allclose(impact.impulses_W.sum(axis=0), jump, atol=SOLVED * (1.0 + size))


def test_what_never_settles_says_so() -> None:
    body, state, touching = planar_in_space(*slot(2.0)[:3], axes_W=AXES)
    how = {"force_W": (3.0, 3.0, 0.0), "torque_W": (0.0, 0.0, 1.0), "plane_normal_W": OUT}
    asked = []
    impact = jamming_impact(body, state, touching, is_settled=lambda now: bool(asked.append(now)), **how)
    assert not impact.converged
    assert len(asked) == 1  # since the second impact changes nothing, further ones would not either
    once = jamming_impact(body, state, touching, **how)
    np.testing.assert_allclose(impact.state.v_WB_W, once.state.v_WB_W, atol=1e-6)


def test_restitution_throws_a_jammed_rod_off() -> None:
    body, velocity, sides, wrench = slot(2.0)
    lively = [replace(side, restitution=0.5) for side in sides]
    impact, solid, before = jam((body, velocity, lively, wrench))
    # Both sides of the slot hold the point: what one gives back, the other takes.
    np.testing.assert_allclose(impact.velocities_after_W[:, 1], 0.0, atol=SOLVED)
    assert kinetic_energy(solid, impact.state) < kinetic_energy(solid, before)


def test_misuse_is_refused_by_name() -> None:
    body, state, touching = planar_in_space(*slot(2.0)[:3], axes_W=AXES)
    none = ContactSet(
        p_WC_W=np.zeros((0, 3)), normals_W=np.zeros((0, 3)), frictions=np.zeros(0), restitutions=np.zeros(0)
    )
    with pytest.raises(InvalidFieldError, match="contacts"):
        jamming_impact(body, state, none, force_W=(0, 0, -1))
    with pytest.raises(TooLargeError, match="contacts"):
        jamming_impact(body, state, touching.subset([0] * 65), force_W=(0, 0, -1))
    with pytest.raises(InvalidFieldError, match="friction_facets"):
        jamming_impact(body, state, touching, force_W=(0, 0, -1), friction_facets=2)


@seeds(range(20))
def test_complementarity_of_positive_definite_problems(seed: int) -> None:
    chance = np.random.default_rng(seed)
    m = int(chance.integers(1, 12))
    root = chance.normal(size=(m, m))
    M, q = root @ root.T + 0.1 * np.eye(m), chance.normal(size=m)
    z = solve_complementarity(M, q)
    assert z is not None
    w = M @ z + q
    assert z.min() >= 0.0
    assert w.min() >= -1e-9
    assert abs(z @ w) <= 1e-9


def test_complementarity_without_a_solution() -> None:
    assert solve_complementarity(np.array([[-1.0]]), np.array([-1.0])) is None
