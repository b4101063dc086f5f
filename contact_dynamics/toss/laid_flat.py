# SPDX-License-Identifier: Apache-2.0
"""Replaces the rattling of a sample on a face by sliding flush on it.

A body that strikes with a face rattles from corner to corner while it slides, until it rests. The simulation
of the rattling takes most of a sample's computing time, but hardly affects the place of rest: the total
normal impulse is that of the weight, plus the momentum of the centre of mass along the normal. The friction
impulse is mu times that, as long as the body slides in one direction. The sample is therefore laid flat, with
the speed for which the friction impulse is the same. The duration of the rattling follows from bounces on
parabolas at constant pose (`_chatter`).

The condition is that the energy of the motion out of the plane could raise the centre of mass by only a share
of the height that tipping over an edge of the face requires.
"""

from __future__ import annotations

import math
from array import array
from itertools import combinations
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.impact.planar.routh import PlanarStrike
from contact_dynamics.numerics.vectors import tangents
from contact_dynamics.rotations.one import normalised, product
from contact_dynamics.tolerances import FACE_ROUNDING
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import kinetic_energy_of, low_corners, pose_of

if TYPE_CHECKING:
    from contact_dynamics.impact.law import RestitutionLaw
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Numbers, Pose, Solid

RATTLING: Final = 0.15
"""Largest energy of the motion out of the plane, relative to that for tipping over an edge. The place of rest
of a cube of a decimetre changes by a millimetre at this share, or at a tenth of it."""

NEARLY_FLUSH: Final = 0.1
"""Largest height of corners that may belong to the face below, relative to the reach."""

MAX_CORNERS: Final = 10
"""Largest number of corners near the plane. All combinations of three are tried as supports."""

SAME_FACE: Final = 0.03
"""Tolerance for corners of one face, relative to the reach. Sampled corners are not exactly in a plane."""

_MAX_BOUNCES: Final = 200
"""Largest number of bounces of a rattling body that are computed. About 40 are usual."""

_LEFT: Final = 0.05
"""Speed of the fastest corner after these bounces, relative to that before them. The rest takes this share of
the time of all bounces, because bounces at all speeds are alike."""

_INFINITE: Final = math.inf

_LEAST_REBOUND: Final = 0.05
"""Smallest rebound, relative to the speed of the fastest corner, so that a corner that stays on the plane
strikes a few times instead of infinitely often."""


class Face:
    """A face on which a body can stand.

    Attributes:
        up: Unit normal into the body, body axes.
        high: m, height of the centre of mass above the face.
        tipping: m, rise of the centre of mass when the body tips over the nearest edge.
        corners: Indices of its corners.
    """

    def __init__(self, up: Vector3, high: float, tipping: float, corners: list[int]) -> None:
        self.up, self.high, self.tipping, self.corners = up, high, tipping, corners


Faces: TypeAlias = "dict[tuple[int, ...], Face | None]"
"""The known faces by three corners each, or None for three corners that are not on one face."""


def laid_flat(solid: Solid, y: Numbers, faces: Faces, law: RestitutionLaw) -> tuple[Numbers, float] | None:
    """Return the state of the body laid flush on a face, or None if it does more than rattle on one.

    The state is that of the same instant. The second result is the duration of the rattling from then on, s.
    Only a body near a single plane is laid flat, with at most `MAX_CORNERS` corners near it. ``faces`` caches
    the faces of this body, and is extended.
    """
    low = NEARLY_FLUSH * solid.reach
    near = [touch for _, touch in low_corners(solid, y, low, _INFINITE)]
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
    laid = [
        y[0] - rise * n[0],
        y[1] - rise * n[1],
        y[2] - rise * n[2],
        *q,
        share * along[0],
        share * along[1],
        share * along[2],
        *flush[10:],
    ]
    return laid, _chatter(solid, pose, near[0][0], face, PlanarStrike(law))


def _chatter(solid: Solid, pose: Pose, surface: int, face: Face, strike: PlanarStrike) -> float:
    """Return the time, s, until the corners of a face that rattles on a plane have stopped.

    The strikes change the velocities of ``pose``. Corners that are not exactly on the face are moved onto it,
    because otherwise one of four would never come down.
    """
    flat, corners = solid.flats[surface], face.corners
    n, pull = flat.normal, -vec.dot(solid.gravity, flat.normal)
    count, least = len(corners), 0.0
    numbers = array("d", bytes(40 * count))  # moment of the normal, height and normal velocity of each
    for k in range(count):
        moment = vec.cross(pose.arm(surface, corners[k]), n)
        numbers[5 * k], numbers[5 * k + 1], numbers[5 * k + 2] = moment
        above_face = vec.dot(face.up, solid.corner(corners[k])) + face.high
        numbers[5 * k + 3] = pose.height(surface, corners[k]) - above_face
        least = min(least, numbers[5 * k + 3])
    for k in range(3, 5 * count, 5):
        numbers[k] -= least
    now, begun = 0.0, 0.0
    for _ in range(_MAX_BOUNCES):
        first, soonest, fastest, sinking = 0, _INFINITE, 0.0, vec.dot(pose.v, n)
        x, y, z = pose.w
        for k in range(0, 5 * count, 5):
            rate = sinking + x * numbers[k] + y * numbers[k + 1] + z * numbers[k + 2]
            landing = math.sqrt(rate * rate + 2.0 * pull * numbers[k + 3])
            numbers[k + 4] = rate
            fastest = max(fastest, landing)
            if rate + landing < soonest:
                first, soonest = k, rate + landing
        begun = max(begun, fastest)
        if fastest <= _LEFT * begun:
            break
        soonest /= pull
        for k in range(0, 5 * count, 5):
            rise = (numbers[k + 4] - 0.5 * pull * soonest) * soonest
            numbers[k + 3] = max(numbers[k + 3] + rise, 0.0)
        numbers[first + 3] = 0.0
        pose.v = vec.plus(pose.v, soonest, solid.gravity)
        now += soonest
        _bounce(solid, pose, surface, corners[first // 5], strike, _LEAST_REBOUND * fastest)
    return now / (1.0 - _LEFT)


def _bounce(  # noqa: PLR0917
    solid: Solid, pose: Pose, surface: int, corner: int, strike: PlanarStrike, least: float
) -> None:
    """Strike in the plane of sliding, with a rebound of at least ``least``, m/s."""
    flat, arm = solid.flats[surface], pose.arm(surface, corner)
    n, velocity = flat.normal, pose.velocity(arm)
    by_n, across = _turned_by(pose, arm, n), vec.without(velocity, n)
    if vec.norm(across) <= least:  # it does not slide, and friction acts against the beginning of sliding
        across = vec.without(vec.cross(by_n, arm), n)
    d = vec.normalised(across)
    by_d = _turned_by(pose, arm, d)
    strike.a = 1.0 / solid.mass + vec.dot(vec.cross(arm, d), by_d)
    strike.b = vec.dot(vec.cross(arm, d), by_n)
    strike.c = 1.0 / solid.mass + vec.dot(vec.cross(arm, n), by_n)
    strike.det = strike.a * strike.c - strike.b * strike.b
    rate = min(vec.dot(velocity, n), 0.0)
    strike.follow(vec.dot(velocity, d), rate, flat.friction_at(rate), flat.restitution)
    p = strike.p_end + max(least - strike.v_n, 0.0) / strike.c
    pose.v = vec.plus(pose.v, 1.0 / solid.mass, vec.combined(p, n, strike.t_end, d))
    pose.w = vec.plus(pose.w, 1.0, vec.combined(p, by_n, strike.t_end, by_d))


def _turned_by(pose: Pose, arm: Vector3, impulse: Vector3) -> Vector3:
    """Return the change of the angular velocity by a unit impulse at an arm."""
    return vec.times(pose.inverse, vec.cross(arm, impulse))


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
        # The projection is vertical, since a neighbouring face may also be below the centre of mass.
        if _stands(
            n_B,
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
    corners = []
    for each in range(solid.count):
        corner = solid.corner(each)
        along = vec.dot(up, corner)
        if along < -high - FACE_ROUNDING * solid.reach:
            return None
        if along < SAME_FACE * solid.reach - high:
            corners.append(each)
    return Face(up, high, _tipping(up, high, [solid.corner(each) for each in corners]), corners)


def _stands(up: Vector3, p: Vector3, q: Vector3, r: Vector3) -> bool:
    """Return whether the origin is above a triangle."""
    a, b, c = vec.dot(up, vec.cross(p, q)), vec.dot(up, vec.cross(q, r)), vec.dot(up, vec.cross(r, p))
    least = FACE_ROUNDING * max(abs(a), abs(b), abs(c))
    return min(a, b, c) >= -least or max(a, b, c) <= least


def _tipping(up: Vector3, high: float, face: list[Vector3]) -> float:
    """Return the smallest rise of the centre of mass, m, when the body tips over an edge of a face."""
    one, other = tangents(up)
    turn = sorted(face, key=lambda corner: math.atan2(vec.dot(corner, other), vec.dot(corner, one)))
    least = _INFINITE
    for a, b in zip(turn, [*turn[1:], turn[0]], strict=True):
        side = vec.norm(_less(b, a))
        # The distance of the edge from the projection of the centre of mass along the normal.
        if side > 0.0:
            least = min(least, abs(vec.dot(up, vec.cross(a, b))) / side)
    return math.sqrt(high * high + least * least) - high
