"""What the viewer looks at: the first predicted path, and the bodies that are not far from it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.viewing.blueprint import LOWEST_DISTANCE, Eye, eye_on

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

FAR: Final = 20.0
"""Relative to the extent of what is looked at, or to `LOWEST_DISTANCE` if that is more. A body that is
farther from it is not looked at, because nothing else could be made out any more."""


def near_most(points_W: FloatArray) -> FloatArray:
    """Return those of some points, (n, 3), m, that are not far from most of them."""
    with np.errstate(over="ignore"):  # a distance that overflows is far
        distances = np.linalg.norm(points_W - np.median(points_W, axis=0), axis=1)
    reach = FAR * max(LOWEST_DISTANCE, float(np.median(distances)))
    return np.asarray(points_W[distances <= reach])


class Framing:
    """Turns the eye to a path and its neighbours.

    It turns again only when a neighbour comes that is out of sight.
    """

    def __init__(self, up_W: FloatArray) -> None:
        """Look at nothing yet. ``up_W`` is (3,), unit, world axes."""
        self._up_W = up_W
        self._first_W: dict[str, FloatArray] = {}  # where each body was first seen, (3,), m
        self._path_W: FloatArray | None = None
        self._margin = 0.0
        self._low_W, self._high_W = np.zeros(3), np.zeros(3)  # what is in sight

    @property
    def center_W(self) -> FloatArray:
        """The middle of what is in sight, (3,), m."""
        return 0.5 * (self._low_W + self._high_W)

    @property
    def extent(self) -> float:
        """The extent of what is in sight with its margin, m."""
        return float(np.linalg.norm(self._high_W - self._low_W)) + self._margin

    def turn_to(self, path_W: FloatArray, *, margin: float) -> Eye:
        """Return the eye that looks at a path, (n, 3), m, and the bodies about it, and has a margin, m."""
        self._path_W, self._margin = path_W, margin
        low, high = path_W.min(axis=0), path_W.max(axis=0)
        reach = FAR * max(LOWEST_DISTANCE, float(np.linalg.norm(high - low + margin)))
        near = [p_W for p_W in self._first_W.values() if np.linalg.norm(p_W - 0.5 * (low + high)) <= reach]
        in_sight_W = np.vstack([path_W, *near])
        self._low_W, self._high_W = in_sight_W.min(axis=0), in_sight_W.max(axis=0)
        return eye_on(path_W, about_W=in_sight_W, up_W=self._up_W, margin=margin)

    def add_body(self, name: str, p_WB_W: FloatArray) -> Eye | None:
        """Note where a new body is first seen, (3,), m.

        Return the eye that sees it too, if it is out of sight and not far.
        """
        self._first_W[name] = p_WB_W
        if self._path_W is None:
            return None
        outside = np.maximum(self._low_W - p_WB_W, p_WB_W - self._high_W)
        if np.all(outside <= self._margin):
            return None
        before = self._low_W, self._high_W
        eye = self.turn_to(self._path_W, margin=self._margin)
        return None if np.array_equal(before, (self._low_W, self._high_W)) else eye
