# SPDX-License-Identifier: Apache-2.0
"""Replaces the rattling of a sample on a face by sliding flush on it.

A body that strikes with a face rattles from corner to corner while it slides, until it rests. The simulation
of the rattling takes most of a sample's computing time, but hardly affects the place of rest: the total
normal impulse is that of the weight, plus the momentum of the centre of mass along the normal. The friction
impulse is mu times that, as long as the body slides in one direction. The sample is therefore laid flat, with
the speed for which the friction impulse is the same.

The condition is that the energy of the motion out of the plane could raise the centre of mass by only a share
of the height that tipping over an edge of the face requires.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.numerics.vectors import tangents
from contact_dynamics.rotations.one import normalised, product
from contact_dynamics.tolerances import FACE_ROUNDING
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import kinetic_energy_of, low_corners, pose_of

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Numbers, Solid

RATTLING: Final = 0.15
"""Largest energy of the motion out of the plane, relative to that for tipping over an edge. The place of rest
of a cube of a decimetre changes by a millimetre at this share, or at a tenth of it."""

NEARLY_FLUSH: Final = 0.1
"""Largest height of corners that may belong to the face below, relative to the reach."""

MAX_CORNERS: Final = 10
"""Largest number of corners near the plane. All combinations of three are tried as supports."""

SAME_FACE: Final = 0.03
"""Tolerance for corners of one face, relative to the reach. Sampled corners are not exactly in a plane."""


class Face:
    """A face on which a body can stand.

    Attributes:
        up: Unit normal into the body, body axes.
        high: m, height of the centre of mass above the face.
        tipping: m, rise of the centre of mass when the body tips over the nearest edge.
    """

    def __init__(self, up: Vector3, high: float, tipping: float) -> None:
        self.up, self.high, self.tipping = up, high, tipping


Faces: TypeAlias = "dict[tuple[int, ...], Face | None]"
"""The known faces by three corners each, or None for three corners that are not on one face."""


def laid_flat(solid: Solid, y: Numbers, faces: Faces) -> Numbers | None:
    """Return the state of the body laid flush on a face, or None if it does more than rattle on one.

    Only a body near a single plane is laid flat, with at most `MAX_CORNERS` corners near it. ``faces`` caches
    the faces of this body, and is extended.
    """
    low = NEARLY_FLUSH * solid.reach
    near = [touch for _, touch in low_corners(solid, y, low, math.inf)]
    if not 3 <= len(near) <= MAX_CORNERS or near[0][0] != near[len(near) - 1][0]:  # sorted by plane
        return None
    flat = solid.flats[near[0][0]]
    n, pressing = flat.normal, -vec.dot(solid.gravity, flat.normal)
    if pressing <= 0.0:
        return None
    v_n, w_n = vec.dot(n, (y[7], y[8], y[9])), vec.dot(n, (y[10], y[11], y[12]))
    along = (y[7] - v_n * n[0], y[8] - v_n * n[1], y[9] - v_n * n[2])
    turning = (w_n * n[0], w_n * n[1], w_n * n[2])
    flush = [*y[:7], along[0], along[1], along[2], turning[0], turning[1], turning[2]]
    pose = pose_of(solid, y)
    rattles = (pose.kinetic_energy() - kinetic_energy_of(solid, flush)) / (solid.mass * pressing)
    if rattles > RATTLING * solid.reach:  # tipping needs at most the reach
        return None
    rows, speed = pose.rows, vec.norm(along)
    share = max(1.0 + flat.friction * v_n / speed, 0.0) if speed > 0.0 else 0.0
    # Friction shifts the centre of pressure ahead of the centre of mass.
    rests = (share * speed) ** 2 <= 2.0 * pressing * flat.friction * solid.settling
    ahead = 0.0 if rests else flat.friction / speed
    lean = vec.transposed_times(rows, (ahead * along[0], ahead * along[1], ahead * along[2]))
    face = _face_below(solid, vec.transposed_times(rows, n), lean, [corner for _, corner in near], faces)
    if face is None:
        return None
    stands = flat.level + face.high + solid.rounding
    rise = vec.dot(n, (y[0], y[1], y[2])) - stands
    if max(rise, 0.0) + rattles > RATTLING * face.tipping:
        return None
    up = vec.times(rows, face.up)
    x, yy, z = vec.cross(up, n)
    q = product(normalised((x, yy, z, 1.0 + vec.dot(up, n))), normalised(y[3:7]))
    return [
        y[0] - rise * n[0],
        y[1] - rise * n[1],
        y[2] - rise * n[2],
        *q,
        share * along[0],
        share * along[1],
        share * along[2],
        *flush[10:],
    ]


def _face_below(solid: Solid, n_B: Vector3, lean: Vector3, near: list[int], faces: Faces) -> Face | None:
    """Return the face through three of the corners on which the body can stand, or None if there is none.

    ``lean`` is the shift of the centre of pressure, body axes, relative to the height of the centre of mass.
    """
    for three in combinations(near, 3):
        if three not in faces:
            faces[three] = _face_of(solid, three)
        face = faces[three]
        if face is None or vec.dot(face.up, n_B) < 0.0:
            continue
        high = face.high
        shift = (high * lean[0], high * lean[1], high * lean[2])
        i, j, k = three
        if _stands(
            face.up,
            _less(solid.corner(i), shift),
            _less(solid.corner(j), shift),
            _less(solid.corner(k), shift),
        ):
            return face
    return None


def _less(a: Vector3, b: Vector3) -> Vector3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _face_of(solid: Solid, three: tuple[int, ...]) -> Face | None:
    """Return the face of the body that contains three corners, or None if there is none."""
    i, j, k = three
    p, q, r = solid.corner(i), solid.corner(j), solid.corner(k)
    up = vec.cross(_less(q, p), _less(r, p))
    size = math.copysign(vec.norm(up), -vec.dot(up, p))
    if size == 0.0:
        return None
    up = (up[0] / size, up[1] / size, up[2] / size)
    high = -vec.dot(up, p)
    if high <= 0.0:
        return None
    face = []
    for each in range(solid.count):
        corner = solid.corner(each)
        along = vec.dot(up, corner)
        if along < -high - FACE_ROUNDING * solid.reach:
            return None
        if along < SAME_FACE * solid.reach - high:
            face.append(corner)
    return Face(up, high, _tipping(up, high, face))


def _stands(up: Vector3, p: Vector3, q: Vector3, r: Vector3) -> bool:
    """Return whether the origin is above a triangle."""
    a, b, c = vec.dot(up, vec.cross(p, q)), vec.dot(up, vec.cross(q, r)), vec.dot(up, vec.cross(r, p))
    least = FACE_ROUNDING * max(abs(a), abs(b), abs(c))
    return min(a, b, c) >= -least or max(a, b, c) <= least


def _tipping(up: Vector3, high: float, face: list[Vector3]) -> float:
    """Return the smallest rise of the centre of mass, m, when the body tips over an edge of a face."""
    one, other = tangents(up)
    turn = sorted(face, key=lambda corner: math.atan2(vec.dot(corner, other), vec.dot(corner, one)))
    least = math.inf
    for a, b in zip(turn, [*turn[1:], turn[0]], strict=True):
        side = vec.norm(_less(b, a))
        # The distance of the edge from the projection of the centre of mass along the normal.
        if side > 0.0:
            least = min(least, abs(vec.dot(up, vec.cross(a, b))) / side)
    return math.sqrt(high * high + least * least) - high
