# SPDX-License-Identifier: Apache-2.0
"""Proof that the motion of a mode is unique, by the definiteness of a matrix, without a search for others.

Let A* be the motion of a mode with forces f*, and A another one with forces f, with d = A - A*. Then d M d is
the sum of (f - f*) (a - a*) over the contacts, whose accelerations are a. A contact that begins to slide in
the direction u has f = n (N - mu u), with N its normal, and u* is that direction in the first mode. There,
the rotation of its friction contributes - mu n (1 - u u*) (|a| + |a*|). Normal forces and separations are
complementary, so that their contribution is not positive. The remainder is - sum mu (n - n*) u* (a - a*).

If some virtual motion z, linear in d, has the acceleration mu u* (a - a*) along N - mu u* at every contact,
the equations of motion turn the remainder into - z M d - sum mu n z (u - u*). The rotation of friction
increases this sum, beyond its own negative contribution, by at most n mu |z|^2 / (2 |a*|), with the
tangential part of z at the contact. Therefore d is zero if M + z M, less these terms, is positive definite.

A contact that already slides has friction in a known, fixed direction. A contact that sticks has
f* = n* (N - mu s) with |s| <= 1, where s replaces u*, and z must vanish along its surface. If contacts share
friction, s is that of a common virtual motion, so that a z exists. If all contacts of a body are on one
plane, z vanishes everywhere. If normal forces alone hold a body, z is zero.

Where static friction is larger than mu, |u| may exceed 1 at a contact that sticks in the other mode. The
contribution of such a contact is zero if it sticks in the first mode too, with |s| <= 1. Otherwise the proof
is about modes without such contacts.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact_modes.spatial.round_cones import held_by_round_cones
from contact_dynamics.numerics.linear_spaces import seen_and_unseen
from contact_dynamics.tolerances import FEASIBLE, ROW_TOLERANCE, SAME_MOTION

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.contact_modes.spatial.search import Search
    from contact_dynamics.validation import FloatArray

_MAX_STEPS: Final = 12
"""Maximum number of Newton steps to forces with friction of a common motion. Five are usually enough."""

_SHARED: Final = 2
"""Minimum number of sticking contacts whose friction can be shared in several ways."""


class _Contacts(NamedTuple):
    """Touching contacts."""

    normals: FloatArray  # (n, 3), unit
    frictions: FloatArray  # (n,), Coulomb's mu
    points: FloatArray  # (n, 3, d), their accelerations on unit motions
    rising: FloatArray  # (n, d), the normal ones
    across: FloatArray  # (n, 3, d), the tangential ones
    turns: FloatArray  # (n,), whether their friction may turn, which is that of contacts at rest
    holding: FloatArray  # (n,), Coulomb's mu of those that stick


def is_only_motion(search: Search, forces: FloatArray, staying: Sequence[int] | None = None) -> bool:
    """Return whether it is proven that all modes have the motion that the forces cause.

    If contacts stick, other forces may cause the same motion. If the given forces, (n, 3), do not yield a
    proof, forces with the friction of a common virtual motion are tried. If ``staying`` is given, only modes
    in which exactly these contacts stay, without more friction at any contact than it has when it slides, are
    considered.
    """
    if not search.touching:
        return True
    motion = search.motion_of(forces)
    everyone = list(range(len(search.touching))) if staying is None else list(staying)
    contacts = _contacts(search, everyone)
    own = forces[everyone]
    points = search.points[everyone] @ np.append(motion, 1.0)
    rising = np.sum(points * contacts.normals, axis=1)
    across = points - rising[:, None] * contacts.normals
    speeds = np.linalg.norm(across, axis=1) * contacts.turns
    slides = speeds > SAME_MOTION
    ways = across / np.where(slides, speeds, 1.0)[:, None] * slides[:, None]
    pressing = np.sum(own * contacts.normals, axis=1)
    friction = contacts.frictions * pressing
    leans = ~slides & (friction > 0.0)
    grips = contacts.turns * (contacts.holding > contacts.frictions) > 0.0
    if staying is None and np.any(grips & slides):
        return False  # these contacts could stick
    off = np.linalg.norm(own - pressing[:, None] * contacts.normals, axis=1)
    beyond = grips.any() and np.any(grips & ~slides & (off > friction))
    ways[leans] = -((own - pressing[:, None] * contacts.normals)[leans] / friction[leans, None])
    for k, i in enumerate(everyone):
        speed = float(np.linalg.norm(search.touching[i].sliding))
        if speed > 0.0:
            ways[k] = search.touching[i].sliding / speed
    within = staying is not None
    if not beyond and _excludes_others(search, contacts, ways, speeds * slides, within=within):
        return True
    sticks = contacts.turns * (contacts.frictions > 0.0) * ~slides > 0.0
    rests = np.abs(motion).max() <= SAME_MOTION  # `rests_alone` has tried these forces
    if np.count_nonzero(sticks & (rising <= SAME_MOTION)) < _SHARED or (rests and not within):
        return False
    slid = np.where(sticks[:, None], 0.0, ways)
    evened = _evened(search, contacts, motion, slid, sticks=sticks, rising=rising)
    return evened is not None and _excludes_others(search, contacts, evened, speeds * slides, within=within)


def rests_alone(search: Search) -> bool:
    """Return whether it is proven that rest is the only motion of a body.

    Normal forces alone may hold it. Otherwise forces are sought whose friction is that of one common virtual
    motion, relative to the friction limit.
    """
    if not search.at_rest or not search.touching:
        return False
    rest = np.eye(search.freedoms, search.freedoms + 1)
    if held_by_round_cones(search, rest, smooth=True).forces is not None:
        return True
    contacts = _contacts(search, list(range(len(search.touching))))
    nothing = np.zeros(len(search.touching))
    ways = _evened(
        search,
        contacts,
        np.zeros(search.freedoms),
        np.zeros((len(nothing), 3)),
        sticks=nothing == 0.0,
        rising=nothing,
    )
    return ways is not None and _excludes_others(search, contacts, ways, nothing, within=False)


def _evened(
    search: Search,
    contacts: _Contacts,
    motion: FloatArray,
    ways: FloatArray,
    *,
    sticks: NDArray[np.bool_],
    rising: FloatArray,
) -> FloatArray | None:
    """Return the friction, (n, 3), of forces that cause a motion, or None if none was found.

    The friction of sticking contacts is that of a common virtual motion, relative to the friction limit.
    ``ways``, (n, 3), is the reversed friction of sliding contacts, relative to the limit. Separating contacts
    have no force.
    """
    left = search.mass @ (search.motion[:, -1] - motion)
    normal = contacts.rising.T * (rising <= SAME_MOTION)  # (d, n)
    gripping = (contacts.frictions * sticks)[:, None, None] * contacts.across
    seen = seen_and_unseen(gripping.reshape(-1, search.freedoms) / max(1.0, float(contacts.frictions.max())))[
        0
    ].T
    sliding = contacts.frictions[:, None] * ways
    pressing = np.linalg.lstsq(normal, -left, rcond=ROW_TOLERANCE)[0]
    common = np.zeros(seen.shape[1])
    acting = (rising <= SAME_MOTION)[:, None]
    enough = FEASIBLE * float(np.linalg.norm(search.mass @ search.motion[:, -1]))
    for _ in range(_MAX_STEPS):
        leaning = sliding + gripping @ (seen @ common)  # (n, 3), times the coefficient of friction
        edges = normal - np.einsum("ijk,ij->ki", contacts.points, leaning * acting)
        missed = left + edges @ pressing
        if float(np.linalg.norm(missed)) <= enough:
            slips = np.linalg.norm(leaning, axis=1) > contacts.frictions
            if pressing.min() < 0.0 or np.any(slips & sticks):
                return None
            found: FloatArray = leaning / np.where(contacts.frictions > 0.0, contacts.frictions, 1.0)[:, None]
            return found
        turned = np.einsum("ijk,i,ijl->kl", contacts.points, pressing, gripping * acting[:, :, None]) @ seen
        step = np.linalg.lstsq(np.column_stack([edges, -turned]), -missed, rcond=ROW_TOLERANCE)[0]
        pressing = pressing + step[: len(pressing)]
        common = common + step[len(pressing) :]
    return None


def _contacts(search: Search, everyone: list[int]) -> _Contacts:
    normals, points = search.normals[everyone], search.points[everyone, :, :-1]
    rising = np.einsum("ij,ijk->ik", normals, points)
    return _Contacts(
        normals=normals,
        frictions=search.frictions[everyone],
        points=points,
        rising=rising,
        across=points - normals[:, :, None] * rising[:, None, :],
        turns=np.array([search.pyramids[i].frame is not None for i in everyone], dtype=float),
        holding=search.holding[everyone],
    )


def _excludes_others(
    search: Search, contacts: _Contacts, ways: FloatArray, speeds: FloatArray, *, within: bool
) -> bool:
    """Return whether it is proven that no mode has another motion.

    If ``within``, only modes in which all contacts stay are considered. ``ways``, (n, 3), is the reversed
    friction of the first mode, relative to its limit. Contacts begin to slide with accelerations ``speeds``,
    (n,), which are zero for contacts that stick or already slide.
    """
    basis = seen_and_unseen(contacts.rising)[1].T if within else np.eye(search.freedoms)
    if basis.size == 0:
        return True
    if len(ways) == 0:
        return False
    leaning = contacts.frictions[:, None] * ways
    along = np.einsum("ij,ijk->ik", leaning, contacts.points)
    E, U = contacts.rising - along, along @ basis
    z = np.linalg.pinv(E, rcond=ROW_TOLERANCE) @ U
    if np.abs(E @ z - U).max() > ROW_TOLERANCE * max(1.0, float(np.abs(U).max())):
        return False
    # Choose the virtual motions with these accelerations that rotate friction least.
    tangents = contacts.turns[:, None, None] * contacts.across
    # Sticking contacts come first, since their friction must not rotate.
    others, rests = seen_and_unseen(E)[1].T, speeds == 0.0
    for chosen in (rests, ~rests) if rests.any() and not rests.all() else (slice(None),):
        tangential = tangents[chosen].reshape(-1, search.freedoms)
        z -= others @ (np.linalg.pinv(tangential @ others, rcond=ROW_TOLERANCE) @ (tangential @ z))
        others = others @ seen_and_unseen(tangential @ others)[1].T if others.size else others
    turned = tangents @ z  # (n, 3, p)
    mass = basis.T @ search.mass @ basis
    scale = np.linalg.inv(np.linalg.cholesky(mass))
    cross = z.T @ search.mass @ basis
    form = mass + 0.5 * (cross + cross.T)
    worst = [form]
    turning = np.abs(turned).max(axis=(1, 2)) > ROW_TOLERANCE
    if np.any(turning):
        if np.any(turning & (speeds == 0.0)):
            return False
        most = _most_pressing(search, contacts)
        if not math.isfinite(most):
            return False
        for k in np.flatnonzero(turning).tolist():
            part = float(contacts.frictions[k]) * most / (2.0 * float(speeds[k]))
            worst.append(form - part * turned[k].T @ turned[k])
    return all(float(np.linalg.eigvalsh(scale @ one @ scale.T)[0]) > SAME_MOTION for one in worst)


def _most_pressing(search: Search, contacts: _Contacts) -> float:
    """Return an upper bound on the sum of the normal forces of any mode, or infinity if none is known.

    Friction dissipates: a body at rest accelerates by A with A M A <= A w, where w is the applied wrench.
    This confines A to a ball and bounds the forces that press in one direction.
    """
    way = contacts.normals.sum(axis=0)
    size = float(np.linalg.norm(way))
    if size == 0.0 or not search.at_rest:
        return math.inf
    along = contacts.normals @ (way / size)
    helps = along - contacts.holding * np.sqrt(np.maximum(1.0 - along * along, 0.0))
    if helps.min() <= 0.0:
        return math.inf
    points, ways = contacts.points.reshape(-1, search.freedoms), np.tile(way / size, len(contacts.normals))
    virtual = np.linalg.lstsq(points, ways, rcond=ROW_TOLERANCE)[0]
    if np.abs(points @ virtual - ways).max() > ROW_TOLERANCE:  # no motion moves all contacts alike
        return math.inf
    free = search.motion[:, -1]
    wrench = search.mass @ free
    most = math.sqrt(float(free @ wrench) * float(virtual @ search.mass @ virtual))
    return 0.5 * (most - float(virtual @ wrench)) / float(helps.min())
