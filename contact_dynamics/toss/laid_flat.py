# SPDX-License-Identifier: Apache-2.0
"""A sample that only rattles on a face from now on is laid flat on it, and slides on.

A body that strikes with a face rattles from corner to corner while it slides, up to its rest. That takes most
of a sample's time, and hardly moves the place of rest: the normal impulse over the whole rattling is that of
the weight, plus what stops the mass centre's motion along the normal. Friction is mu times that as long as
the body slides one way. So the sample is laid flat, with the speed by which this impulse is the same.

It is done where the energy out of the plane could not raise the mass centre by more than a share of what
tipping over an edge of the face takes.
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
"""Energy out of the plane that is left, as a share of what tipping over an edge takes. The place of rest of a
cube of a decimetre moves by a millimetre at this share, or at a tenth of it."""

NEARLY_FLUSH: Final = 0.1
"""Share of the reach within which corners can belong to the face below."""

MAX_CORNERS: Final = 10
"""Corners of a face, of which any three are tried as those that it stands on."""

SAME_FACE: Final = 0.03
"""Share of the reach within which corners belong to one face. Corners of samples are not quite in a plane."""


class Face:
    """A face on which a body can stand: three corners and what follows.

    Attributes:
        up: Unit normal into the body, body axes.
        high: m, the height of the mass centre above the corners.
        tipping: m, by how much the mass centre rises when the body tips over the nearest edge.
    """

    def __init__(self, up: Vector3, high: float, tipping: float) -> None:
        self.up, self.high, self.tipping = up, high, tipping


Faces: TypeAlias = "dict[tuple[int, ...], Face | None]"
"""The faces that have been looked for, by three corners each; None where these are not on one."""


def laid_flat(solid: Solid, y: Numbers, faces: Faces) -> Numbers | None:
    """Return the state of a body that slides flush on a face, or None if it does more than rattle on one.

    Only a body near a single flat is laid on it, and only with `MAX_CORNERS` there at most. ``faces`` are
    those of this body that are known, and gets others that are looked for.
    """
    low = NEARLY_FLUSH * solid.reach
    near = [touch for _, touch in low_corners(solid, y, low, math.inf)]
    if not 3 <= len(near) <= MAX_CORNERS or near[0][0] != near[len(near) - 1][0]:  # they come flat after flat
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
    if rattles > RATTLING * solid.reach:  # no face takes more than the reach to tip over
        return None
    rows, speed = pose.rows, vec.norm(along)
    share = max(1.0 + flat.friction * v_n / speed, 0.0) if speed > 0.0 else 0.0
    # Friction at the ground moves the place where the weight is borne ahead of the mass centre.
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
    """Return the face of some of the corners on which the body can stand, or None if there is none.

    ``lean`` says how far ahead the weight is borne, body axes, relative to the height of the mass centre.
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
    """Return the face of the body on which three corners are, or None if they are not on one."""
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
    """Return by how much the mass centre rises at least, m, when the body tips over an edge of a face."""
    one, other = tangents(up)
    turn = sorted(face, key=lambda corner: math.atan2(vec.dot(corner, other), vec.dot(corner, one)))
    least = math.inf
    for a, b in zip(turn, [*turn[1:], turn[0]], strict=True):
        side = vec.norm(_less(b, a))
        # The distance of the edge from below the mass centre, seen along the normal.
        if side > 0.0:
            least = min(least, abs(vec.dot(up, vec.cross(a, b))) / side)
    return math.sqrt(high * high + least * least) - high
