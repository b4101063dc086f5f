# SPDX-License-Identifier: Apache-2.0
"""Whether forces within Coulomb's round cones keep contacts from moving.

The answer yes comes with such forces, and the answer no with a virtual motion.

Contacts that stick demand that some rows of the motion vanish. When rows that nearly agree are merged
(`dual_simplex.merged`), this is one equation in at most six dimensions: a sum of linear images of round
cones is to be equal to a given vector. Wolfe's method finds the point of that sum nearest to the vector. A
few edges replace the cones at first. While the remainder, which is the vector less the nearest point, has a
positive product with some force of a cone, the force with the largest product becomes a further edge. In the
end the remainder vanishes, or it separates the vector from all sums that the cones allow. Then it is a
virtual motion on which the load has power, and on which no contact force takes that power.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.dual_simplex import merged
from contact_dynamics.numerics.linear_spaces import row_space
from contact_dynamics.tolerances import (
    LETTERS_NO_FORCE,
    ROUND_CONE_ACROSS,
    ROUND_CONE_APART,
    ROUND_CONE_HELD,
    ROUND_CONE_INDEPENDENT,
    ROUND_CONE_NEAR,
    ROUND_CONE_NO_HELP,
    ROUND_CONE_ON_CONE,
    ROUND_CONE_REACHED,
    ROUND_CONE_ROUNDING,
    ROUND_CONE_WIDE,
    ROW_TOLERANCE,
)

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_MAX_FORCE: Final = 1e5
"""This is a multiple of the load. A motion separates if only larger forces could take its power."""

_MAX_FORCE_ACROSS: Final = 1e3
"""The same for forces that are so nearly across the motion that rounding may decide whether they help."""

_MAX_EDGES: Final = 400
"""The largest number of edges that are tried. A dozen are enough, unless the load lies on the border of the
sum."""

_NOTHING: Final = np.zeros(1)

_WIDE: Final = 10.0
"""Coefficient of friction. The edges of a wider cone lean by more than 84 degrees from its axis."""


class Held(NamedTuple):
    """Whether forces hold the contacts."""

    forces: FloatArray | None  # (n, 3), such forces, in the units of the motion; None if none were found
    certain: bool  # not where rounding decides, or where the search was given up


def sticking(search: Search) -> FloatArray:
    """Return rows, (k, d + 1), that vanish where all contacts stay, and those with friction stick."""
    rows = [
        contact.point if contact.holding > 0.0 else (contact.normal @ contact.point)[None, :]
        for contact in search.touching
    ]
    return np.vstack([np.zeros((0, search.freedoms + 1)), *rows])


def held_by_round_cones(
    search: Search, rows: FloatArray, *, smooth: bool = False, tolerance: float = ROW_TOLERANCE
) -> Held:
    """Return forces at all touching contacts, within their round cones, that make rows of the motion vanish.

    What slides already counts as at rest. The rows, (k, d + 1), are of about unit length, and those that
    differ by less than the tolerance are one. If ``smooth``, friction is left out.
    """
    demand = _demand(search, rows, tolerance)
    if demand is None:
        return Held(None, certain=True)
    normals, frictions = search.normals, search.holding
    return _nearest(demand, normals, 0.0 * frictions if smooth else frictions)


def moved_by_round_cones(search: Search, axes: FloatArray, frictions: FloatArray, way: FloatArray) -> Held:
    """Return forces that move a body in a given direction, by at least ``way``, (d,).

    The axes, (n, 3), of the cones have a unit normal part, or are zero for a contact without force, and
    forces may lean from them by ``frictions``, (n,).
    """
    acting = axes.any(axis=1)
    of_forces = search.of_forces.reshape(search.freedoms, -1, 3)[:, acting]
    # The motion's further size counts as one more force.
    sizes = np.zeros((search.freedoms, 1, 3))
    sizes[:, 0, 0] = -way / np.linalg.norm(way)
    effects = search.mass @ np.concatenate([of_forces, sizes], axis=1).reshape(search.freedoms, -1)
    demand = _balanced(effects, search.mass @ (way - search.motion[:, -1]))
    cones = np.vstack([axes[acting], [1.0, 0.0, 0.0]])
    held = _nearest(demand, cones, np.append(frictions[acting], 0.0))
    if held.forces is None:
        return held
    forces = np.zeros_like(axes)
    forces[acting] = held.forces[:-1]
    return Held(forces, certain=True)


def wedged_by_round_cones(search: Search) -> Held:
    """Return forces within the round cones of all touching contacts that balance each other, not all zero."""
    normals, frictions = search.normals, search.holding
    wrenches = search.mass @ search.of_forces
    effects = np.vstack([wrenches, normals.ravel()])  # the last row is the sum of normal forces, which is one
    images = effects.reshape(len(effects), len(normals), 3).transpose(1, 0, 2)
    target = np.eye(len(effects))[-1]
    return _nearest(_Demand(np.ascontiguousarray(images), target, np.ones(len(target))), normals, frictions)


def summed_by_round_cones(
    effects: FloatArray, target: FloatArray, axes: FloatArray, frictions: FloatArray
) -> Held:
    """Return forces within round cones whose effects, (k, 3 n), sum to a target, (k,).

    Forces lean from the axes, (n, 3), by at most ``frictions``, (n,). A cone with 0 is a ray.
    """
    return _nearest(_balanced(effects, target), axes, frictions)


def polished(search: Search, rows: FloatArray, forces: FloatArray) -> FloatArray:
    """Return forces, (n, 3), that make rows of the motion vanish to rounding, where the cones allow that.

    The given ones lie in the cones, and do so to a tolerance. They are returned if better ones would leave
    the cones.
    """
    demand = _demand(search, rows, ROUND_CONE_APART)
    if demand is None or demand.images.size == 0:
        return forces
    effects = np.hstack(list(demand.images))
    found = forces
    for _ in range(2):
        rest = demand.target - effects @ found.ravel()
        found = found + np.linalg.lstsq(effects, rest, rcond=ROUND_CONE_INDEPENDENT)[0].reshape(-1, 3)
    for contact, force in zip(search.touching, found, strict=True):
        pressing = float(contact.normal @ force)
        across = float(np.linalg.norm(force - pressing * contact.normal))
        if across > contact.holding * pressing + ROUND_CONE_ON_CONE * float(np.abs(found).max()):
            return forces
    return found


def hold_alone(search: Search, forces: FloatArray) -> bool:
    """Return whether no other forces in the round cones do the same as forces, (n, 3), that hold a body.

    Those of contacts that press must be independent, and the others must not press against what these
    balance.
    """
    normals, frictions = search.normals, search.holding
    wrenches = (
        (search.mass @ search.of_forces).reshape(search.freedoms, -1, 3).transpose(1, 0, 2)
    )  # (n, d, 3)
    wrenches = wrenches / max(float(np.abs(wrenches).max(initial=0.0)), np.finfo(float).tiny)
    sizes = np.linalg.norm(forces, axis=1)
    idle = sizes <= LETTERS_NO_FORCE * sizes.max(initial=0.0)
    acting = [
        one if friction > 0.0 else (one @ normal)[:, None]
        for one, normal, friction, rests in zip(wrenches, normals, frictions, idle, strict=True)
        if not rests
    ]
    columns = np.hstack([np.zeros((search.freedoms, 0)), *acting])
    basis = row_space(columns.T)
    if len(basis) < columns.shape[1] or not idle.any():
        return bool(len(basis) == columns.shape[1])
    left = wrenches[idle] - basis.T @ (basis @ wrenches[idle])
    images = np.concatenate([left, normals[idle][:, None, :]], axis=1)  # the last row sums normal forces
    one = np.ones(search.freedoms + 1)
    held = _nearest(_Demand(images, np.eye(len(one))[-1], one), normals[idle], frictions[idle])
    return held.forces is None and held.certain


class _Demand(NamedTuple):
    """What forces must sum to, in units in which all contacts together do as much in every direction."""

    images: FloatArray  # (n, k, 3), the effects of unit forces
    target: FloatArray  # (k,), what the effects must sum to
    sizes: FloatArray  # (k,), the sizes of the units, in parts of the load


def _demand(search: Search, rows: FloatArray, tolerance: float) -> _Demand | None:
    """Return what makes rows of the motion, merged within a tolerance, vanish, or None if no forces do."""
    equations = merged(rows, tolerance)
    if equations is None:
        return None
    start = search.motion[:, -1] + equations[:, :-1].T @ equations[:, -1]
    # Where the whole motion vanishes, wrenches are compared, and not accelerations of very unequal size.
    units = search.mass if len(equations) == len(start) else equations[:, :-1]
    target, effects = -(units @ start), units @ search.of_forces
    return _balanced(effects, target)


def _balanced(effects: FloatArray, target: FloatArray) -> _Demand:
    """Return a demand, in units in which all contacts together do as much in every direction."""
    n = effects.shape[1] // 3
    load = float(np.linalg.norm(target))
    # Contacts that are nearly the same have little effect in some directions, where little is demanded. The
    # further columns give units of directions in which they have no effect at all.
    units, sizes, _ = np.linalg.svd(np.hstack([effects, np.zeros((len(effects),) * 2)]), full_matrices=False)
    sizes = np.maximum(sizes, ROUND_CONE_REACHED * sizes.max(initial=0.0) if n > 0 else 1.0)
    images = ((units.T / sizes[:, None]) @ effects).reshape(len(sizes), n, 3).transpose(1, 0, 2)
    return _Demand(
        np.ascontiguousarray(images), units.T @ target / sizes, sizes / load if load > 0.0 else sizes
    )


def _nearest(demand: _Demand, normals: FloatArray, frictions: FloatArray) -> Held:
    """Return forces within the round cones whose images sum to the target, or are nearest to it."""
    images, target, sizes = demand
    load = float(np.linalg.norm(target))
    wide = bool(np.any(frictions > _WIDE))
    owners: list[int] = []
    edges: list[FloatArray] = []
    spans, shares = np.zeros((len(target), 0)), np.zeros(0)
    rest = target
    for _ in range(_MAX_EDGES):
        left = math.sqrt(rest @ rest)
        sized = sizes * rest
        unbalanced = math.sqrt(sized @ sized)
        if unbalanced <= ROUND_CONE_HELD:
            forces = np.zeros_like(normals)
            for i, edge, share in zip(owners, edges, shares.tolist(), strict=True):
                forces[i] += share * edge
            return Held(forces, certain=True)
        best_of_each, help_of_each = _extremes((rest / left) @ images, normals, frictions)
        moved = (images @ best_of_each[:, :, None])[:, :, 0]
        effects = np.sqrt((moved * moved).sum(axis=1))
        cosines = help_of_each / np.where(effects > 0.0, effects, 1.0)
        best = int(cosines.argmax()) if len(cosines) else -1
        helps = float(cosines[best]) if len(cosines) else 0.0
        most = _MAX_FORCE if helps > ROUND_CONE_ACROSS else _MAX_FORCE_ACROSS
        if helps * most * load <= left and left > ROUND_CONE_ROUNDING * load:
            return Held(None, certain=not wide or unbalanced > ROUND_CONE_WIDE)
        if helps <= ROUND_CONE_NO_HELP:
            break
        owners.append(best)
        edges.append(best_of_each[best] / effects[best])
        spans = np.concatenate([spans, (moved[best] / effects[best])[:, None]], axis=1)
        shares = _shares(spans, target, np.concatenate([shares, _NOTHING]))
        if shares[-1] <= 0.0:
            break
        acting = (shares > 0.0).nonzero()[0].tolist()
        owners, edges = [owners[k] for k in acting], [edges[k] for k in acting]
        spans, shares = spans[:, acting], shares[acting]
        rest = target - spans @ shares
        if rest @ rest <= (ROUND_CONE_NEAR * load) ** 2:
            rest = rest - spans @ np.linalg.lstsq(spans, rest, rcond=ROUND_CONE_INDEPENDENT)[0]
    return Held(None, certain=False)


def _extremes(power: FloatArray, axes: FloatArray, frictions: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return forces of unit normal part in cones that have the most power, (n, 3), and that power, (n,)."""
    along = (power * axes).sum(axis=1)
    across = power - along[:, None] * axes
    slopes = np.sqrt((across * across).sum(axis=1))
    # Where the remainder is inside of a wide cone, the force is along it, since edges hardly press.
    inside = (frictions > _WIDE) & (slopes < frictions * along)
    leans = np.where(inside, slopes / np.where(inside, along, 1.0), frictions)
    leans[slopes <= ROUND_CONE_ROUNDING * np.abs(along)] = 0.0  # rounding has no direction
    ways = across / np.where(slopes > 0.0, slopes, 1.0)[:, None]
    return axes + leans[:, None] * ways, along + leans * slopes


def _shares(spans: FloatArray, target: FloatArray, shares: FloatArray) -> FloatArray:
    """Return shares >= 0 of spans nearest to a target, from those without the last span."""
    acting = np.ones(len(shares), dtype=bool)
    while True:
        trial = np.zeros_like(shares)
        trial[acting] = np.linalg.lstsq(spans[:, acting], target, rcond=ROUND_CONE_INDEPENDENT)[0]
        pulling = (acting & (trial <= 0.0)).nonzero()[0]
        if pulling.size == 0:
            return trial
        parts = shares[pulling] / np.maximum(shares[pulling] - trial[pulling], np.finfo(float).tiny)
        shares = shares + float(parts.min()) * (trial - shares)
        ends = pulling[parts <= parts.min()]
        acting[ends] = False
        shares[~acting] = 0.0
