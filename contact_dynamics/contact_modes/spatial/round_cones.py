"""Whether forces within Coulomb's round cones keep contacts from moving: yes with forces, no with a motion.

Contacts that stick ask the motion to vanish on some rows; with these merged (`careful_program.merged`) that
is one equation in at most six dimensions, whose left side is a sum of linear images of round cones. The point
of that sum nearest to the right side is found by Wolfe's method: the cones are stood for by few of their
edges, and where what is left over still has a positive product with some force of a cone, the one with the
largest becomes an edge. What is left over in the end is nothing, or a direction that separates the right side
from all that the cones can do: a virtual motion on which the load has power and no contact force takes it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.careful_program import merged
from contact_dynamics.numerics.linear_spaces import row_space

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_HELD: Final = 1e-11
"""Relative to the largest acceleration: what forces may leave over that hold the contacts."""

_NO_HELP: Final = 1e-12
"""Cosine, of a force's effect to what is left over, below which it is rounding."""

_MOST_FORCE: Final = 1e3
"""Times the load: a motion separates if only larger forces could take its power."""

_MOST_EDGES: Final = 400
"""Edges of cones that are tried. Some dozen are enough but on a cone's very border."""

_INDEPENDENT: Final = 1e-15

_REACHED: Final = 1e-10
"""Relative: what all forces together do less than that in some direction is nothing."""

_ROUNDING: Final = 1e-15


class Held(NamedTuple):
    """What came of the question."""

    forces: (
        FloatArray | None
    )  # (n, 3), in the units of the motion, that hold the contacts; None: there are none
    certain: bool  # False: rounding, or too slow a search, hides whether there are any


def sticking(search: Search) -> FloatArray:
    """Return rows, (k, 7), that vanish where all contacts stay, and stick if they have friction."""
    rows = [
        contact.point if contact.friction > 0.0 else (contact.normal @ contact.point)[None, :]
        for contact in search.touching
    ]
    return np.vstack([np.zeros((0, 7)), *rows])


def held_by_round_cones(search: Search, rows: FloatArray) -> Held:
    """Return forces at all touching contacts, within their round cones, that make rows of the motion vanish.

    Args:
        search: The case. What slides already counts as at rest.
        rows: (k, 7), about unit.
    """
    equations = merged(rows)
    if equations is None:
        return Held(None, certain=True)
    target = -(equations[:, :-1] @ search.motion[:, -1] + equations[:, -1])
    if len(search.touching) == 0:
        return Held(np.zeros((0, 3)) if float(np.linalg.norm(target)) <= _HELD else None, certain=True)
    effects = equations[:, :-1] @ search.of_forces
    images = np.ascontiguousarray(effects.reshape(len(target), -1, 3).transpose(1, 0, 2))
    return _nearest(images, search, target)


class Unique(NamedTuple):
    """Of what there is only one."""

    forces: bool
    motion: bool


def rests_in_one_way(search: Search, rows: FloatArray) -> Unique:
    """Return whether forces that make rows of the motion vanish are the only ones, and their motion."""
    of_forces = search.of_forces
    seen, moved = (len(row_space(of)) for of in (rows[:, :-1] @ of_forces, of_forces))
    return Unique(forces=seen == of_forces.shape[1], motion=seen == moved)


def _nearest(images: FloatArray, search: Search, target: FloatArray) -> Held:
    """Return forces whose images, (n, k, 3) for unit ones, sum to a target, (k,)."""
    # Nearly the same contacts do little in some directions. In these units they do as much in all.
    units, sizes, _ = np.linalg.svd(np.hstack(list(images)), full_matrices=False)
    sizes = np.where(sizes > _REACHED * sizes.max(initial=0.0), sizes, 0.0)
    beyond = target - units @ ((sizes > 0.0) * (units.T @ target))
    if float(np.linalg.norm(beyond)) > _HELD:
        return Held(None, certain=True)
    units, sizes = units[:, sizes > 0.0], sizes[sizes > 0.0]
    images = (units.T / sizes[:, None]) @ images
    target = units.T @ target / sizes
    load = float(np.linalg.norm(target))
    normals = np.array([one.normal for one in search.touching]).reshape(-1, 3)
    frictions = np.array([one.friction for one in search.touching])
    owners: list[int] = []
    edges: list[FloatArray] = []
    spans, shares = np.zeros((len(target), 0)), np.zeros(0)
    rest = target
    for _ in range(_MOST_EDGES):
        left = float(np.linalg.norm(rest))
        if float(np.linalg.norm(sizes * rest)) <= _HELD or left <= _ROUNDING * load:
            forces = np.zeros_like(normals)
            for i, edge, share in zip(owners, edges, shares.tolist(), strict=True):
                forces[i] += share * edge
            return Held(forces, certain=True)
        power = (rest / left) @ images  # (n, 3), of unit forces on what is left over
        along = (power * normals).sum(axis=1)
        across = power - along[:, None] * normals
        slopes = np.sqrt((across * across).sum(axis=1))
        best_of_each = normals + across * (frictions / np.where(slopes > 0.0, slopes, 1.0))[:, None]
        effects = np.sqrt(((images @ best_of_each[:, :, None]) ** 2).sum(axis=(1, 2)))
        cosines = (along + frictions * slopes) / np.where(effects > 0.0, effects, 1.0)
        best = int(cosines.argmax()) if len(cosines) else -1
        helps = float(cosines[best]) if len(cosines) else 0.0
        if helps * _MOST_FORCE * load <= left:
            return Held(None, certain=True)
        if helps <= _NO_HELP:
            break
        owners.append(best)
        edges.append(best_of_each[best] / effects[best])
        spans = np.column_stack([spans, images[best] @ edges[-1]])
        shares = _shares(spans, target, np.append(shares, 0.0))
        if shares[-1] <= 0.0:
            break
        acting = (shares > 0.0).nonzero()[0].tolist()
        owners, edges = [owners[k] for k in acting], [edges[k] for k in acting]
        spans, shares = spans[:, acting], shares[acting]
        rest = target - spans @ shares
        rest = rest - spans @ np.linalg.lstsq(spans, rest, rcond=_INDEPENDENT)[0]
    return Held(None, certain=False)


def _shares(spans: FloatArray, target: FloatArray, shares: FloatArray) -> FloatArray:
    """Return shares >= 0 of spans nearest to a target, from those without the last span."""
    acting = np.ones(len(shares), dtype=bool)
    while True:
        trial = np.zeros_like(shares)
        trial[acting] = np.linalg.lstsq(spans[:, acting], target, rcond=_INDEPENDENT)[0]
        pulling = (acting & (trial <= 0.0)).nonzero()[0]
        if pulling.size == 0:
            return trial
        parts = shares[pulling] / np.maximum(shares[pulling] - trial[pulling], np.finfo(float).tiny)
        shares = shares + float(parts.min()) * (trial - shares)
        ends = pulling[parts <= parts.min()]
        acting[ends] = False
        shares[~acting] = 0.0
