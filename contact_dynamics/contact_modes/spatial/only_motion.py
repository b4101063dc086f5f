# SPDX-License-Identifier: Apache-2.0
"""Whether one mode's motion is the only one, by one matrix, without looking for others.

Let A* be the motion of a mode with forces f*, and A another one with forces f, with d = A - A*. Then d M d is
the sum of (f - f*) (a - a*) over the contacts, whose accelerations are a. A contact that begins to slide in
the direction u has f = n (N - mu u), with N its normal, and u* is that direction in the first mode. There,
the turn of its friction takes mu n (1 - u u*) (|a| + |a*|). Normal forces and separations exclude each other,
so that their share is negative. What is left is - sum mu (n - n*) u* (a - a*).

If some virtual motion z, linear in d, has the acceleration mu u* (a - a*) along N - mu u* at every contact,
the equations of motion turn what is left into - z M d - sum mu n z (u - u*). The turns of friction make this
larger than what they take by n mu |z|^2 / (2 |a*|) at most, with the tangential part of z at the contact. So
if M + z M, less these parts, is positive definite, d is zero.

A contact that slides already has friction in a known direction, which does not turn. A contact that sticks
has f* = n* (N - mu s) with |s| <= 1, which takes the place of u*. There z must vanish along the surface.
Where contacts share friction, s is that of a common virtual motion, so that there is a z. Where all contacts
of a body are on one plane, it vanishes everywhere. Where normal forces alone hold a body, z is zero.
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
"""The largest number of Newton's steps to forces that friction of a common motion allows. Five are enough."""

_SHARED: Final = 2
"""The least number of contacts that stick whose friction can be shared in several ways."""


class _Contacts(NamedTuple):
    """Touching contacts."""

    normals: FloatArray  # (n, 3), unit
    frictions: FloatArray  # (n,), Coulomb's mu
    points: FloatArray  # (n, 3, d), their accelerations on unit motions
    rising: FloatArray  # (n, d), the normal ones
    across: FloatArray  # (n, 3, d), the tangential ones
    turns: FloatArray  # (n,), whether their friction may turn, which is that of contacts at rest


def is_only_motion(search: Search, forces: FloatArray, staying: Sequence[int] | None = None) -> bool:
    """Return whether it is proven that no mode has another motion than the one that forces bring about.

    Where contacts stick, other forces may bring about the same motion. If the given ones, (n, 3), prove
    nothing, those are tried with which friction is that of a common virtual motion. If ``staying`` is given,
    only modes are meant in which just these contacts stay, as in the first.
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
    ways[leans] = -((own - pressing[:, None] * contacts.normals)[leans] / friction[leans, None])
    for k, i in enumerate(everyone):
        speed = float(np.linalg.norm(search.touching[i].sliding))
        if speed > 0.0:
            ways[k] = search.touching[i].sliding / speed
    within = staying is not None
    if _excludes_others(search, contacts, ways, speeds * slides, within=within):
        return True
    sticks = contacts.turns * (contacts.frictions > 0.0) * ~slides > 0.0
    rests = np.abs(motion).max() <= SAME_MOTION  # `rests_alone` has tried these forces
    if np.count_nonzero(sticks & (rising <= SAME_MOTION)) < _SHARED or (rests and not within):
        return False
    slid = np.where(sticks[:, None], 0.0, ways)
    evened = _evened(search, contacts, motion, slid, sticks=sticks, rising=rising)
    return evened is not None and _excludes_others(search, contacts, evened, speeds * slides, within=within)


def rests_alone(search: Search) -> bool:
    """Return whether it is proven that a body rests and can do nothing else.

    Normal forces alone may hold it. Otherwise forces are sought that hold it with friction of one common
    virtual motion, in parts of what slides with it would have.
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
    """Return friction, (n, 3), with which forces bring a motion about, or None if none was found.

    Where contacts stick, it is that of a common virtual motion, in parts of what slides would have. That of
    contacts that slide is given as ``ways``, (n, 3), reversed, in parts of the largest. Those that leave do
    not press.
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
    )


def _excludes_others(
    search: Search, contacts: _Contacts, ways: FloatArray, speeds: FloatArray, *, within: bool
) -> bool:
    """Return whether it is proven that no mode has another motion.

    Only modes are meant in which all contacts stay, if ``within``. In the first mode, friction is ``ways``,
    (n, 3), as parts of the largest, reversed. Contacts begin to slide at ``speeds``, (n,), which are zero
    where they stick, or slide already.
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
    # The virtual motions that have these accelerations and turn friction least are taken.
    tangents = contacts.turns[:, None, None] * contacts.across
    # Where contacts stick, they may turn it not at all, so that these come first.
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
    """Return a bound on the sum of the normal forces of any mode, which is infinite if none is known.

    Friction dissipates: a body at rest accelerates by A with A M A <= A w, where w is the applied wrench.
    This confines A to a ball and bounds the forces that press in one direction.
    """
    way = contacts.normals.sum(axis=0)
    size = float(np.linalg.norm(way))
    if size == 0.0 or not search.at_rest:
        return math.inf
    along = contacts.normals @ (way / size)
    helps = along - contacts.frictions * np.sqrt(np.maximum(1.0 - along * along, 0.0))
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
