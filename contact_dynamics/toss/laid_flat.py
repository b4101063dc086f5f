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
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from contact_dynamics.numerics.vectors import cross, dot, norm, tangents
from contact_dynamics.rotations.one import normalised, product
from contact_dynamics.tolerances import FACE_ROUNDING
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import heights_and_rates, kinetic_energy_of, pose_of

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


class _Face(NamedTuple):
    """A face on which a body can stand: three corners and what follows.

    Attributes:
        up: Unit normal into the body, body axes.
        high: m, the height of the mass centre above the corners.
        tipping: m, by how much the mass centre rises when the body tips over the nearest edge.
    """

    up: Vector3
    high: float
    tipping: float


Faces: TypeAlias = "dict[tuple[int, ...], _Face | None]"
"""The faces that have been looked for, by three corners each; None where these are not on one."""


def laid_flat(solid: Solid, y: Numbers, faces: Faces) -> Numbers | None:
    """Return the state of a body that slides flush on a face, or None if it does more than rattle on one.

    Only a body near a single flat is laid on it, and only with `MAX_CORNERS` there at most. ``faces`` are
    those of this body that are known, and gets others that are looked for.
    """
    low = NEARLY_FLUSH * solid.reach
    near = [touch for height, _, touch in heights_and_rates(solid, y) if height < low]
    if not 3 <= len(near) <= MAX_CORNERS or any(surface != near[0][0] for surface, _ in near):
        return None
    flat = solid.flats[near[0][0]]
    n, pressing = flat.normal, -dot(solid.gravity, flat.normal)
    if pressing <= 0.0:
        return None
    rows = pose_of(solid, y).rows
    v_n, w_n = dot(n, (y[7], y[8], y[9])), dot(n, (y[10], y[11], y[12]))
    along = (y[7] - v_n * n[0], y[8] - v_n * n[1], y[9] - v_n * n[2])
    turning = (w_n * n[0], w_n * n[1], w_n * n[2])
    speed = norm(along)
    share = max(1.0 + flat.friction * v_n / speed, 0.0) if speed > 0.0 else 0.0
    # Friction at the ground moves the place where the weight is borne ahead of the mass centre.
    rests = (share * speed) ** 2 <= 2.0 * pressing * flat.friction * solid.settling
    ahead = 0.0 if rests else flat.friction / speed
    lean = vec.transposed_times(rows, (ahead * along[0], ahead * along[1], ahead * along[2]))
    face = _face_below(solid, vec.transposed_times(rows, n), lean, [corner for _, corner in near], faces)
    if face is None:
        return None
    stands = flat.level + face.high + solid.rounding
    rattles = kinetic_energy_of(solid, y) - kinetic_energy_of(solid, [*y[:7], *along, *turning])
    rise = dot(n, (y[0], y[1], y[2])) - stands
    if max(rise, 0.0) + rattles / (solid.mass * pressing) > RATTLING * face.tipping:
        return None
    up = vec.times(rows, face.up)
    x, yy, z = cross(up, n)
    q = product(normalised((x, yy, z, 1.0 + dot(up, n))), normalised(y[3:7]))
    return [
        *(y[k] - rise * n[k] for k in range(3)),
        *q,
        *(share * each for each in along),
        *turning,
    ]


def _face_below(solid: Solid, n_B: Vector3, lean: Vector3, near: list[int], faces: Faces) -> _Face | None:
    """Return the face of some of the corners on which the body can stand, or None if there is none.

    ``lean`` says how far ahead the weight is borne, body axes, relative to the height of the mass centre.
    """
    for three in combinations(near, 3):
        if three not in faces:
            faces[three] = _face_of(solid, three)
        face = faces[three]
        if face is None or dot(face.up, n_B) < 0.0:
            continue
        x, y, z = face.high * lean[0], face.high * lean[1], face.high * lean[2]
        triangle = [(p - x, q - y, r - z) for p, q, r in (solid.corners[corner] for corner in three)]
        if _stands(face.up, triangle):
            return face
    return None


def _face_of(solid: Solid, three: tuple[int, ...]) -> _Face | None:
    """Return the face of the body on which three corners are, or None if they are not on one."""
    p, q, r = (solid.corners[corner] for corner in three)
    first = (q[0] - p[0], q[1] - p[1], q[2] - p[2])
    second = (r[0] - p[0], r[1] - p[1], r[2] - p[2])
    up = cross(first, second)
    size = math.copysign(norm(up), -dot(up, p))
    if size == 0.0:
        return None
    up = (up[0] / size, up[1] / size, up[2] / size)
    high = -dot(up, p)
    if high <= 0.0 or any(dot(up, corner) < -high - FACE_ROUNDING * solid.reach for corner in solid.corners):
        return None
    face = [corner for corner in solid.corners if dot(up, corner) < SAME_FACE * solid.reach - high]
    return _Face(up, high, _tipping(up, high, face))


def _stands(up: Vector3, triangle: list[Vector3]) -> bool:
    """Return whether the origin is above a triangle."""
    p, q, r = triangle
    sides = [dot(up, cross(a, b)) for a, b in ((p, q), (q, r), (r, p))]
    least = FACE_ROUNDING * max(map(abs, sides))
    return min(sides) >= -least or max(sides) <= least


def _tipping(up: Vector3, high: float, face: list[Vector3]) -> float:
    """Return by how much the mass centre rises at least, m, when the body tips over an edge of a face."""
    one, other = tangents(up)
    turn = sorted(face, key=lambda corner: math.atan2(dot(corner, other), dot(corner, one)))
    least = math.inf
    for a, b in zip(turn, [*turn[1:], turn[0]], strict=True):
        side = norm((b[0] - a[0], b[1] - a[1], b[2] - a[2]))
        # The distance of the edge from below the mass centre, seen along the normal.
        if side > 0.0:
            least = min(least, abs(dot(up, cross(a, b))) / side)
    return math.sqrt(high * high + least * least) - high
