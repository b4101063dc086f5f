# SPDX-License-Identifier: Apache-2.0
"""Several contacts of one body whose impacts interleave: the set of outcomes, from inside and from outside.

Contacts that strike at once share the instant in any way (Halm and Posa, Set-valued rigid-body dynamics for
simultaneous, inelastic, frictional impact, 2023). So the impulses of all contacts grow in small increments,
and which contact gets the next one is open. Each increment follows the law for one contact: friction opposes
the contact's own sliding, compression collects work, and restitution gives back e^2 of it (Stronge 1990). A
contact is compressed while it approaches, and may be restored from when it does not. The impact is over when
no contact approaches and none has work to give back. Orders (`orders`) are the interleavings in which one
contact has all its increments before the next.

From inside, interleavings are drawn at random. From outside, three things hold for every interleaving: the
impulse of each contact is in its friction cone, the kinetic energy has not grown, and no contact approaches.
These constraints are convex, and each dual point of them is a bound that holds, whether or not it is the
best. The energetic law is the only one here, because no interleaving creates energy under it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.orders import outcomes_over_orders
from contact_dynamics.impact.several.sequential import Touching, check_touching
from contact_dynamics.numerics.nonnegative_least_squares import nearest_combination
from contact_dynamics.numerics.vectors import point_jacobians
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import HasMassProperties, inverse_mass_matrix
from contact_dynamics.tolerances import LARGEST_GRIP, NOTHING_DUE, VELOCITY_TOLERANCE
from contact_dynamics.validation import FloatArray, check_at_rest, check_positive, check_whole

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState

MAX_INTERLEAVINGS: Final = 10_000
"""Largest number of interleavings to draw, which bounds memory and time."""

INCREMENTS: Final = 200
"""Increments in which the impulse grows that stops the fastest approach. The errors of a drawn outcome are of
first order in them, below a hundredth of the change of velocity."""

MAX_INCREMENTS: Final = 5000
"""Increments after which an interleaving counts as not converged."""

_ORDERS: Final = 24
"""Orders that are tried besides: all of up to four contacts."""

_TURNS: Final = 0.02
"""Probability that an interleaving favours other contacts from the next increment on."""

_FACETS: Final = 32
"""Edges of the pyramid around each friction cone. It has 0.5 % more friction than the cone."""

_ROUNDS: Final = 16
"""Steps towards the best bound."""

_LEAST_SHRINKING: Final = 0.2
"""Bound on how much a step towards the best bound weakens the weight of the energy."""

_PROJECTIONS: Final = 5
"""Projections onto both sets in each step towards the best bound."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class InterleavedOutcomes(Record):
    """Outcomes of interleaved impacts, and bounds on the outcomes of all interleavings. World axes.

    Attributes:
        velocities_W: (m, 6), m/s and rad/s, linear then angular velocity after each interleaving that was
            tried. The first rows belong to orders of the contacts, and the others to random interleavings.
        lowest_W: (6,), m/s and rad/s, lower bounds on the components after any interleaving.
        highest_W: (6,), m/s and rad/s, upper bounds on the components after any interleaving.
        not_converged: Number of interleavings that are omitted because they reached the limit on increments.
    """

    velocities_W: FloatArray
    lowest_W: FloatArray
    highest_W: FloatArray
    not_converged: int

    @property
    def spread(self) -> FloatArray:
        """Return the largest difference between the outcomes found, (6,), m/s and rad/s."""
        spread: FloatArray = np.ptp(self.velocities_W, axis=0)
        return spread

    @property
    def gap(self) -> FloatArray:
        """Return the amount by which the bounds are wider than the spread, (6,), m/s and rad/s."""
        gap: FloatArray = self.highest_W - self.lowest_W - self.spread
        return gap


class _Set(NamedTuple):
    """The contacts of one body, in contact axes, which are two tangents and the normal."""

    rows: FloatArray  # (n, 3, 6), take the body's twist into velocities of the contacts, contact axes
    push: FloatArray  # (n, 6, 3), take impulses along contact axes into changes of the twist
    response: FloatArray  # (n, 3, 3), 1/kg, contact axes
    frictions: FloatArray  # (n,)
    shares: FloatArray  # (n,), e squared


def outcomes_over_interleavings(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    samples: int = 200,
    seed: int = 0,
) -> InterleavedOutcomes:
    """Return outcomes of interleaved impacts at several contacts under the energetic law, and bounds on them.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Pose and velocities just before the impact.
        contacts: All touching contacts; at least one.
        velocity_tolerance: m/s, > 0. A contact that approaches more slowly has no impact.
        samples: Number of random interleavings, from 1 to `MAX_INTERLEAVINGS`.
        seed: Seed of the samples. The same seed yields the same result.

    Raises:
        SeparatingContactError: all contacts separate.
        InvalidFieldError: there are no contacts, the tolerance is not > 0, or a count is out of range.
        TooLargeError: the orders require more impacts in total than `outcomes_over_orders` allows.
    """
    check_at_rest("contacts", contacts, "outcomes_over_interleavings")
    body = body.mass_properties
    tolerance = check_positive("velocity_tolerance", velocity_tolerance)
    samples = check_whole("samples", samples, 1, MAX_INTERLEAVINGS)
    rng = np.random.default_rng(check_whole("seed", seed, 0))
    touching = Touching([body], contacts, [(0, None)] * len(contacts), RestitutionLaw.ENERGETIC, tolerance)
    check_touching(touching, [state])
    ordered = outcomes_over_orders(
        body,
        state,
        contacts,
        restitution_law=RestitutionLaw.ENERGETIC,
        velocity_tolerance=tolerance,
        max_orders=_ORDERS,
    )
    inverse = inverse_mass_matrix(body.mass, body.inertia_in_world(state.R_WB))
    twist = np.concatenate([state.v_WB_W, state.w_WB_W])
    seen = _in_contact_axes(contacts, contacts.p_WC_W - state.p_WB_W, inverse)
    drawn, resolved = _draw(seen, twist, tolerance, samples, rng)
    bounds = _bounds(contacts, contacts.p_WC_W - state.p_WB_W, inverse, twist, tolerance)
    return InterleavedOutcomes(
        velocities_W=np.concatenate([ordered.velocities_W, drawn[resolved]]),
        lowest_W=bounds[0],
        highest_W=bounds[1],
        not_converged=int((~resolved).sum()) + ordered.not_converged,
    )


def _in_contact_axes(contacts: ContactSet, arms: FloatArray, inverse: FloatArray) -> _Set:
    axes = []
    for normal in contacts.normals_W:
        edge = linearised_cone(normal, 1.0, 4)[0] - normal
        axes.append(np.array([edge, np.cross(normal, edge), normal]))
    rows = np.array(axes) @ point_jacobians(arms)
    push = inverse @ rows.transpose(0, 2, 1)
    frictions = np.minimum(contacts.frictions, LARGEST_GRIP)
    return _Set(rows, push, rows @ push, frictions, contacts.impact_restitutions**2)


def _draw(
    seen: _Set, twist: FloatArray, tolerance: float, samples: int, rng: np.random.Generator
) -> tuple[FloatArray, NDArray[np.bool_]]:
    """Return the twists after drawn interleavings, (samples, 6), and which of them came to an end."""
    n = len(seen.frictions)
    approach = -float((seen.rows[:, 2] @ twist).min())
    unit = approach / (INCREMENTS * seen.response[:, 2, 2])  # N s
    work = 0.5 * approach * approach / float(seen.response[:, 2, 2].min())  # J
    twists = np.tile(twist, (samples, 1))
    due = np.zeros((samples, n))
    favour = _favours(rng, (samples, n))
    live = np.arange(samples)
    for _ in range(MAX_INCREMENTS):
        v_n = twists[live] @ seen.rows[:, 2].T
        open_ = (v_n < -tolerance) | (due[live] > NOTHING_DUE * work)
        going = open_.any(axis=1)
        live, open_ = live[going], open_[going]
        if live.size == 0:
            break
        turning = live[rng.random(live.size) < _TURNS]
        favour[turning] = _favours(rng, (turning.size, n))
        chances = np.cumsum(np.where(open_, favour[live], 0.0), axis=1)
        at = (chances < rng.random(live.size)[:, None] * chances[:, -1:]).sum(axis=1)
        impulse, given = _increment(seen, twists[live], at, due[live, at], unit[at])
        twists[live] += np.einsum("ijk,ik->ij", seen.push[at], impulse)
        due[live, at] = given
    resolved = np.ones(samples, dtype=bool)
    resolved[live] = False
    return twists, resolved


def _favours(rng: np.random.Generator, shape: tuple[int, int]) -> FloatArray:
    """Return how likely the increments of each contact are, from alike to one contact nearly alone."""
    return np.exp(rng.normal(size=shape) * rng.uniform(0.0, 6.0, size=(shape[0], 1)))


def _increment(
    seen: _Set, twists: FloatArray, at: NDArray[np.integer[Any]], due: FloatArray, unit: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return one increment of the impulse at contact ``at`` of each sample, and what it then owes, J."""
    response, mu = seen.response[at], seen.frictions[at]
    velocity = np.einsum("ijk,ik->ij", seen.rows[at], twists)
    u, v_n = velocity[:, :2], velocity[:, 2]
    slip = np.sqrt(np.einsum("ij,ij->i", u, u))
    # The impulse of friction for each N s: what holds the contact if it can, or else against the sliding.
    push = -(u / unit[:, None] + response[:, :2, 2])
    hold = np.linalg.solve(response[:, :2, :2], push[:, :, None])[:, :, 0]
    size = np.sqrt(np.einsum("ij,ij->i", hold, hold))
    largest = np.maximum(response[:, 0, 0], response[:, 1, 1])
    slides = slip > 2.0 * mu * largest * unit
    against = np.where(
        slides[:, None],
        -u / np.where(slides, slip, 1.0)[:, None],
        hold / np.where(size > 0.0, size, 1.0)[:, None],
    )
    friction = np.where((size <= mu)[:, None], hold, mu[:, None] * against)
    rate = response[:, 2, 2] + np.einsum("ij,ij->i", response[:, 2, :2], friction)
    compresses = v_n < 0.0
    # Compression stops at v_n = 0, and restitution where all work is given back.
    root = np.sqrt(np.maximum(v_n * v_n + 2.0 * rate * due, 0.0))
    to_stop = np.where(rate > 0.0, -v_n / np.where(rate > 0.0, rate, 1.0), math.inf)
    to_end = np.where(v_n + root > 0.0, 2.0 * due / np.where(v_n + root > 0.0, v_n + root, 1.0), math.inf)
    p = np.minimum(unit, np.where(compresses, to_stop, to_end))
    work = p * (v_n + 0.5 * rate * p)
    owed = np.where(compresses, due + seen.shares[at] * np.maximum(-work, 0.0), np.maximum(due - work, 0.0))
    owed[~compresses & (to_end <= unit)] = 0.0
    return np.column_stack([friction * p[:, None], p]), owed


def _bounds(
    contacts: ContactSet, arms: FloatArray, inverse: FloatArray, twist: FloatArray, tolerance: float
) -> tuple[FloatArray, FloatArray]:
    """Return numbers, (6,) each, below and above every outcome's velocities."""
    # In z, the twist times the root of the mass matrix, energy is a length: |z| does not grow.
    values, vectors = np.linalg.eigh(inverse)
    root = vectors * np.sqrt(values) @ vectors.T
    z = vectors / np.sqrt(values) @ vectors.T @ twist
    jacobians = point_jacobians(arms)
    edges = np.concatenate(
        [
            _around(normal, min(float(mu), LARGEST_GRIP)) @ jacobian @ root
            for normal, mu, jacobian in zip(contacts.normals_W, contacts.frictions, jacobians, strict=True)
        ]
    )
    normals = np.einsum("ij,ijk->ik", contacts.normals_W, jacobians) @ root
    highest = np.array([_bound(row, z, edges, normals, tolerance) for row in root])
    lowest = -np.array([_bound(-row, z, edges, normals, tolerance) for row in root])
    return lowest, highest


def _around(normal: FloatArray, friction: float) -> FloatArray:
    """Return the edges, (k, 3), of a pyramid around a friction cone."""
    if friction == 0.0:
        return normal[None]
    edges = linearised_cone(normal, friction / math.cos(math.pi / _FACETS), _FACETS)
    return edges / math.sqrt(1.0 + friction * friction)


def _bound(
    towards: FloatArray, z: FloatArray, edges: FloatArray, normals: FloatArray, tolerance: float
) -> float:
    """Return a bound on ``towards`` . y over y with |y| <= |z|, y - z in the edges' cone and normals y >= 0.

    If d . edge <= 0 for all edges and c is a sum of normals with weights >= 0, then it is at most
    d . z + |z| |towards - d + c|. Dykstra's projections onto the two sets of y lead to the best d and c.
    """
    length = float(np.linalg.norm(z))
    if length == 0.0:  # a body at rest stays at rest
        return 0.0
    best = length * float(np.linalg.norm(towards))
    scale = float(np.linalg.norm(towards)) / length
    from_cone = from_normals = np.zeros_like(z)
    weights = np.zeros(len(normals))
    for _ in range(_ROUNDS):
        point = towards / scale - from_cone - from_normals
        for _ in range(_PROJECTIONS):
            moved = point + from_cone - z
            pushed = nearest_combination(edges.T, moved)
            if pushed is None:
                return best
            inside = edges.T @ pushed[0]
            from_cone, point = moved - inside, z + inside
            moved = point + from_normals
            lifted = nearest_combination(normals.T, -moved)
            if lifted is None:
                return best
            weights = lifted[0]
            against = normals.T @ weights
            from_normals, point = -against, moved + against
        left = towards - scale * (from_cone + from_normals)
        bound = scale * float(from_cone @ z) + length * float(np.linalg.norm(left))
        best = min(best, bound + tolerance * scale * float(weights.sum()))
        # At the best bound the two lengths are equal, or the energy does not matter and has no weight.
        shrink = max((float(np.linalg.norm(left)) / (length * scale)) ** 2, _LEAST_SHRINKING)
        scale, from_cone, from_normals = scale * shrink, from_cone / shrink, from_normals / shrink
    return best
