# SPDX-License-Identifier: Apache-2.0
"""Estimates the friction of sustained contact from bodies that slide on a face before they rest.

A body that slides flush on a surface without turning is decelerated by mu times the normal force per mass,
whatever its mass and its face. The path of its mass centre is therefore a parabola, whose curvature
determines mu. Strikes need not have the same friction: a striking corner touches for a millisecond, and with
another pressure.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.records import Record
from contact_dynamics.rotations.many import matrices_of, rotation_vectors

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.calibration.model import Described
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.validation import FloatArray

FLUSH: Final = 0.03
"""Share of the body's half size within which three corners are on the surface, so that the body is flush."""

FEWEST_SLIDING: Final = 8  # frames. The deceleration of a shorter slide is too uncertain.
FEWEST_SLIDES: Final = 5  # minimum number of slides on a surface to estimate their scatter

MAX_TURNING: Final = 0.3
"""How far corners of the face may turn, relative to the length of the slide. Friction of a body that turns is
not along its way. This share takes up to 2 % from its deceleration."""

SURE: Final = 0.1
"""Largest standard deviation of one slide's friction by the noise of positions, relative to it."""

LASTING_SPEED: Final = 0.5
"""m/s, the approach speed from which strikes have a friction of their own (`Surface.lasting_speed`). On 180
published tosses of the ContactNets cube, it gave the least errors at rest; 0.4 to 0.6 m/s are similar."""

_CENTRAL: Final = 1.4826  # from the median deviation to the standard one
_MEDIAN: Final = 1.2533  # the standard deviation of a median, relative to that of a mean


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class LastingFriction(Record):
    """Friction of sustained contact with one surface."""

    surface: str  # its name
    friction: float  # Coulomb's mu, the median of all slides
    std: float  # its standard deviation, by the scatter between slides
    scatter: float  # standard deviation from slide to slide, without the noise of measurement
    slides: int  # number of slides


class _Slide(NamedTuple):
    """One slide: the surface, its friction, and the standard deviation of that by the noise of positions."""

    surface: int
    friction: float
    std: float


def lasting_frictions(
    observed: Sequence[Observed], described: Described, gravity_W: FloatArray, names: Sequence[str]
) -> tuple[LastingFriction, ...]:
    """Return the friction of sustained contact, for each surface with enough observed slides.

    The body and the surfaces, whose names follow, are as calibrated, as is gravity, (3,), m/s^2.
    """
    slides = [slide for each in observed if (slide := _slide_of(each, described, gravity_W)) is not None]
    found = []
    for k, name in enumerate(names):
        mine = [slide for slide in slides if slide.surface == k]
        if len(mine) < FEWEST_SLIDES:
            continue
        values = np.array([slide.friction for slide in mine])
        friction = float(np.median(values))
        whole = _CENTRAL * float(np.median(np.abs(values - friction)))
        noise = float(np.median([slide.std for slide in mine]))
        found.append(
            LastingFriction(
                surface=name,
                friction=friction,
                std=_MEDIAN * whole / math.sqrt(len(mine)),
                scatter=math.sqrt(max(whole**2 - noise**2, 0.0)),
                slides=len(mine),
            )
        )
    return tuple(found)


def _slide_of(each: Observed, described: Described, gravity_W: FloatArray) -> _Slide | None:
    """Return the friction of the slide that ends at rest, or None if no slide determines it."""
    rest = each.rest
    if rest is None or len(described.points) == 0:
        return None
    motion, surface = each.motion, each.rest_surface
    n = described.normals[surface]
    pressing = -float(gravity_W @ n)
    stop = int(np.searchsorted(motion.times, rest.time))
    begin = _flush_since(each, described, stop)
    if stop - begin < FEWEST_SLIDING or pressing <= 0.0:
        return None
    frames = slice(begin, stop)
    times = motion.times[frames] - motion.times[frames].mean()
    path = motion.p_WB_W[frames] + matrices_of(motion.q_WB[frames]) @ described.center
    along = path - (path @ n)[:, None] * n
    way = along[-1] - along[0]
    length = float(np.linalg.norm(way))
    turn = np.linalg.norm(rotation_vectors(motion.q_WB[stop - 1][None], motion.q_WB[begin])[0])
    reach = float(np.linalg.norm(described.corners - described.center, axis=1).max())
    if length == 0.0 or turn * reach > MAX_TURNING * length:
        return None
    solver = np.linalg.pinv(np.column_stack([np.ones_like(times), times, 0.5 * times**2]))[2]
    deceleration = -(solver @ along - gravity_W) @ (way / length)
    friction = float(deceleration) / pressing
    std = float(np.linalg.norm(solver)) * motion.position_noise / pressing
    return _Slide(surface, friction, std) if std < SURE * friction else None


def _flush_since(each: Observed, described: Described, stop: int) -> int:
    """Return the first frame of those before ``stop`` in which the body stays flush on its surface."""
    motion, surface = each.motion, each.rest_surface
    R = matrices_of(motion.q_WB[:stop])
    corners = motion.p_WB_W[:stop, None] + np.einsum("nij,kj->nki", R, described.corners)
    heights = (corners - described.points[surface]) @ described.normals[surface] - described.rounding
    if heights.shape[1] < 3:
        return stop
    half_size = float(np.linalg.norm(described.corners - described.corners.mean(axis=0), axis=1).max())
    allowed = FLUSH * (half_size + described.rounding)
    off = np.flatnonzero(np.sort(np.abs(heights), axis=1)[:, 2] > allowed)
    return int(off[-1]) + 1 if len(off) else 0
