# SPDX-License-Identifier: Apache-2.0
"""Finds which contacts of a body touch and rest, where its state is known with some noise.

No point of a measured body is exactly on a surface, and none is exactly at rest. With the covariance of the
state, "this corner touches" and "these contacts are at rest" are hypotheses: linear conditions on the error
of the state. A hypothesis holds unless a chi-square test rejects it: the squared size of the least error that
makes it true, in standard deviations, is beyond the quantile `REST_LEVEL` for as many degrees of freedom as
the conditions have. The state that is used from then on is the likeliest one under the conditions that hold,
so that corners that touch lie in their plane and contacts at rest have no velocity.

If the hypothesis that all contacts are at rest is rejected, those touch whose normal velocities can be zero,
and of these those stick whose tangential velocities can be zero. Each is tested beside those that hold
already, the likeliest first. In the same way, all points that may touch a flat are tested first, and then
each beside those that touch already.

Not covered: gaps to obstacles, whose contacts are found at the pose as it is; the effect of the pose's noise
on velocities, also of a turntable, which is a product of two errors for a body that is nearly at rest.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.pairs import pair_jacobians
from contact_dynamics.contact.touches import flat_touches
from contact_dynamics.contact.velocities import relative_velocities
from contact_dynamics.numerics.vectors import point_jacobians, tangent_rows
from contact_dynamics.rotations.many import turned
from contact_dynamics.tolerances import NO_NOISE
from contact_dynamics.world import Body, Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact.pairs import Pairs
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.shapes.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray

REST_LEVEL: Final = 0.999
"""Probability with which a hypothesis about touching or resting contacts passes its test if it is true."""

QUANTILES: Final = (0.0, 10.827566, 13.815511, 16.266236, 18.466827, 20.515006, 22.457744)
"""Quantiles of chi squared at `REST_LEVEL`, by degrees of freedom from 0 to 6."""

SAMPLES: Final = 1000
"""Measurements that are drawn for `possible_motions`. They give shares to 0.016."""

_ROUNDS: Final = 3
"""Each correction of a pose squares the turns that are left: 0.01 rad come to rounding."""


class NoisyState(NamedTuple):
    """A state and its noise."""

    state: BodyState
    root: FloatArray  # (12, k), a root of its covariance, root @ root.T, in the order of `motion.covariance`

    @classmethod
    def of(cls, state: BodyState, covariance: FloatArray) -> NoisyState:
        """Return a state with a covariance, (12, 12)."""
        variances, axes = np.linalg.eigh(covariance)
        return cls(state, axes * np.sqrt(np.maximum(variances, 0.0)))

    def corrected(self, error: FloatArray) -> BodyState:
        """Return the state without an error, (k,), in standard deviations."""
        change = -self.root @ error
        state = self.state
        return replace(
            state,
            p_WB_W=state.p_WB_W + change[:3],
            q_WB=turned(state.q_WB[None], change[None, 3:6])[0],
            v_WB_W=state.v_WB_W + change[6:9],
            w_WB_W=state.w_WB_W + change[9:],
        )


def touching(
    body: Body,
    noisy: NoisyState,
    surfaces: Sequence[Surface | Obstacle],
    *,
    distance_tolerance: float,
) -> NoisyState:
    """Return the likeliest state of a body with a shape in which all points that may touch a flat do so."""
    points = _points_near_flats(body, noisy, surfaces, distance_tolerance)
    if not points:
        return noisy
    gaps, rows = _gaps(points, noisy.state)
    everything = _hypothesis(rows, gaps, noisy, noisy, math.inf)
    if everything.passes:
        closed = _with_gaps_closed(points, noisy, everything.state.state)
        if np.abs(_gaps(points, closed.state)[0]).max() <= distance_tolerance:
            return closed
    held: list[_Point] = []
    closed = noisy
    for i in np.argsort(gaps):
        gap, row = _gaps([points[i]], closed.state)
        hypothesis = _hypothesis(row, gap, noisy, closed, distance_tolerance)
        if hypothesis.passes and hypothesis.state is not closed:
            held.append(points[i])
            closed = _with_gaps_closed(held, noisy, hypothesis.state.state)
    return closed


def _with_gaps_closed(points: Sequence[_Point], noisy: NoisyState, near: BodyState) -> NoisyState:
    """Return the likeliest state in which points have no gap, and its noise, from a state near it."""
    state = near
    for _ in range(_ROUNDS):
        gaps, rows = _gaps(points, state)
        there = noisy._replace(state=state)
        closed = _hypothesis(rows, gaps, there, there, math.inf).state
        state = closed.state
    return closed


def resting(noisy: NoisyState, contacts: ContactSet, *, velocity_tolerance: float) -> NoisyState:
    """Return the likeliest state in which all contacts that may rest or touch do so.

    A contact's velocity that is left within ``velocity_tolerance``, m/s, counts as zero.
    """
    frames, rows = _components(noisy.state, contacts)

    def that_zero(which: Sequence[int], axes: slice, beside: NoisyState) -> _Hypothesis:
        """Return the hypothesis that components of velocities are zero, beside what holds already."""
        velocities = relative_velocities(beside.state, contacts)[which]
        violation = np.einsum("cij,cj->ci", frames[which], velocities)[:, axes]
        return _hypothesis(
            rows[which, axes].reshape(-1, 12), violation.ravel(), noisy, beside, velocity_tolerance
        )

    def settled(found: NoisyState, held: Sequence[tuple[Sequence[int], slice]]) -> NoisyState:
        """Return a state whose components are zero though its pose, which velocities depend on, was moved."""
        state = found.state
        for _ in range(_ROUNDS if held and contacts.surfaces_move else 0):
            along = np.einsum("cij,cj->ci", frames, relative_velocities(state, contacts))
            violation = np.concatenate([along[which, axes].ravel() for which, axes in held])
            conditions = np.concatenate([rows[which, axes].reshape(-1, 12) for which, axes in held])
            there = noisy._replace(state=state)
            state = _hypothesis(conditions, violation, there, there, math.inf).state.state
        return found._replace(state=state)

    everything = that_zero(range(len(contacts)), slice(0, 3), noisy)
    if everything.passes:
        return settled(everything.state, [(range(len(contacts)), slice(0, 3))])
    found, may_hold = noisy, list(range(len(contacts)))
    held: list[tuple[Sequence[int], slice]] = []
    for axes in (slice(0, 1), slice(1, 3)):
        likeliest_first = sorted(may_hold, key=lambda i: that_zero([i], axes, noisy).size)
        may_hold = []
        for i in likeliest_first:
            hypothesis = that_zero([i], axes, found)
            if hypothesis.passes:
                found = hypothesis.state
                may_hold.append(i)
                held.append(([i], axes))
    return settled(found, held)


def resting_bodies(
    states: Sequence[BodyState],
    covariances: Sequence[FloatArray | None],
    contacts: ContactSet,
    pairs: Pairs,
    *,
    velocity_tolerance: float,
) -> tuple[BodyState, ...] | None:
    """Return the likeliest states of several bodies in which all their contacts rest, or None if none passes.

    Covariances, (12, 12), are those of the states, or None for exact ones. Only velocities are corrected.
    """
    from scipy.special import chdtri

    jacobians = pair_jacobians(states, contacts.p_WC_W, pairs).reshape(-1, 6 * len(states))
    velocities = np.concatenate([[*state.v_WB_W, *state.w_WB_W] for state in states])
    moving = 0.0 if contacts.surface_velocities_W is None else contacts.surface_velocities_W.ravel()
    violation = jacobians @ velocities - moving
    if float(np.abs(violation).max()) <= velocity_tolerance:
        return tuple(states)
    noise = np.zeros((len(velocities), len(velocities)))
    for i, covariance in enumerate(covariances):
        if covariance is not None:
            noise[6 * i : 6 * i + 6, 6 * i : 6 * i + 6] = covariance[6:, 6:]
    variances, axes = np.linalg.eigh(noise)
    root = axes * np.sqrt(np.maximum(variances, 0.0))
    U, sizes, V = np.linalg.svd(jacobians @ root, full_matrices=False)
    kept = sizes > NO_NOISE * sizes.max()
    components = (U.T[kept] @ violation) / sizes[kept]
    error = root @ (V[kept].T @ components)
    unexplained = float(np.abs(violation - jacobians @ error).max())
    limit = float(chdtri(len(components), 1.0 - REST_LEVEL))
    if unexplained > max(velocity_tolerance, NO_NOISE * float(np.abs(violation).max())) or not (
        components @ components <= limit
    ):
        return None
    rest = (velocities - error).reshape(-1, 2, 3)
    return tuple(state.with_velocities(*both) for state, both in zip(states, rest, strict=True))


def possible_motions(
    noisy: NoisyState, contacts: ContactSet, *, velocity_tolerance: float
) -> list[tuple[float, BodyState]]:
    """Return the states that `resting` could come to from other measurements, each with their share.

    `SAMPLES` measurements are drawn about the state, by its noise. Each comes to the first of these that
    passes: all contacts rest; those components of their velocities are zero that are so by `resting`; all
    touch. If none passes, contacts move as they are measured. The same state always has the same draws.
    """
    frames, rows = _components(noisy.state, contacts)
    found = resting(noisy, contacts, velocity_tolerance=velocity_tolerance).state

    def velocities(state: BodyState) -> FloatArray:
        along: FloatArray = np.einsum("cij,cj->ci", frames, relative_velocities(state, contacts))
        return along.ravel()

    whole = rows.reshape(-1, 12) @ noisy.root
    draws = np.random.default_rng(0).normal(size=(noisy.root.shape[1], SAMPLES))
    drawn = velocities(noisy.state)[:, None] + whole @ draws
    undecided = np.ones(SAMPLES, dtype=bool)
    motions = []
    touch = np.tile([True, False, False], len(contacts))
    zero = np.abs(velocities(found)) <= velocity_tolerance
    for conditions in (np.ones_like(touch), zero, touch):
        if not conditions.any():
            continue
        hypothesis = _hypothesis(
            rows.reshape(-1, 12)[conditions],
            velocities(noisy.state)[conditions],
            noisy,
            noisy,
            velocity_tolerance,
        )
        U, sizes, _ = np.linalg.svd(whole[conditions], full_matrices=False)
        kept = sizes > NO_NOISE * np.linalg.norm(whole[conditions])
        components = (U.T[kept] @ drawn[conditions]) / sizes[kept, None]
        passes = (
            undecided & (np.sum(components**2, axis=0) <= QUANTILES[int(kept.sum())]) & hypothesis.is_possible
        )
        undecided &= ~passes
        motions.append((float(passes.mean()), hypothesis.state.state))
    motions.append((float(undecided.mean()), noisy.state))
    return [(share, state) for share, state in motions if share > 0.0]


def _components(state: BodyState, contacts: ContactSet) -> tuple[FloatArray, FloatArray]:
    """Return normal and tangents of contacts, (n, 3, 3), and how velocities along them change, (n, 3, 12)."""
    jacobians = np.zeros((len(contacts), 3, 12))
    jacobians[:, :, 6:] = point_jacobians(contacts.p_WC_W - state.p_WB_W)
    frames = np.array([(n_W, *tangent_rows(n_W)) for n_W in contacts.normals_W])
    return frames, np.einsum("cij,cjk->cik", frames, jacobians)


class _Hypothesis(NamedTuple):
    """That the error of a state meets some conditions, beside those that it meets already."""

    is_possible: bool  # whether any error meets them
    passes: bool  # whether the test does not reject it
    size: float  # the square of the least error that meets the conditions, in standard deviations
    state: NoisyState  # the likeliest state that does


def _hypothesis(
    rows: FloatArray, violation: FloatArray, noisy: NoisyState, beside: NoisyState, tolerance: float
) -> _Hypothesis:
    """Return the hypothesis that the error of a state causes a violation of conditions, (m,).

    ``rows``, (m, 12), say how the conditions change with the state. The violation is at the state ``beside``,
    under the conditions that hold already, with the noise that they leave. ``tolerance`` of it may be left.
    """
    whole, left = rows @ noisy.root, rows @ beside.root
    U, sizes, V = np.linalg.svd(left, full_matrices=False)
    kept = sizes > NO_NOISE * np.linalg.norm(whole)
    components = (U.T[kept] @ violation) / sizes[kept]
    error = V[kept].T @ components
    unexplained = float(np.abs(violation - left @ error).max())
    size = float(components @ components)
    is_possible = unexplained <= max(tolerance, NO_NOISE * float(np.abs(violation).max()))
    return _Hypothesis(
        is_possible,
        is_possible and size <= QUANTILES[len(components)],
        size,
        NoisyState(beside.corrected(error), beside.root - (beside.root @ V[kept].T) @ V[kept])
        if len(components) > 0
        else beside,
    )


class _Point(NamedTuple):
    """A point of a body near a flat."""

    p_BP_B: FloatArray  # (3,), m, where it is in the body
    normal_W: FloatArray  # (3,), unit, of the flat
    level: float  # m, the flat's, and how far a ball around the point reaches


def _points_near_flats(
    body: Body, noisy: NoisyState, surfaces: Sequence[Surface | Obstacle], distance_tolerance: float
) -> list[_Point]:
    """Return the points that are nearer to flats than the noise of their gaps at `REST_LEVEL` allows."""
    state, shape, R_WB = noisy.state, body.shape, noisy.state.R_WB
    place, turn = (float(np.linalg.norm(noisy.root[i : i + 3])) for i in (0, 3))
    far = max(hull.reach - hull.rounding for hull in shape.hulls)
    noise = math.sqrt(QUANTILES[1]) * (place + turn * far)
    found = []
    for surface in surfaces:
        if not isinstance(surface, Surface):
            continue
        n_W, level = surface.normal_W, float(surface.p_WS_W @ surface.normal_W)
        for hull in shape.hulls:
            for touch in flat_touches(
                hull, state.p_WB_W, R_WB, n_W, level=level, tolerance=distance_tolerance + noise
            ):
                center = touch.p_WC_W + hull.rounding * n_W
                found.append(_Point((center - state.p_WB_W) @ R_WB, n_W, level + hull.rounding))
    return found


def _gaps(points: Sequence[_Point], state: BodyState) -> tuple[FloatArray, FloatArray]:
    """Return the gaps of points, (m,), m, and how they change with position and small turns, (m, 12)."""
    arms = np.array([point.p_BP_B for point in points]) @ state.R_WB.T
    normals = np.array([point.normal_W for point in points])
    gaps = np.einsum("ij,ij->i", state.p_WB_W + arms, normals) - [point.level for point in points]
    rows = np.zeros((len(points), 12))
    rows[:, :3], rows[:, 3:6] = normals, np.cross(arms, normals)
    return gaps, rows
