# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from contact_dynamics.viewing.blueprint import FAR, LOWEST_DISTANCE, Eye, Framing, near_most

UP = np.array([0.0, 0.0, 1.0])
PATH = np.column_stack([np.linspace(0.0, 0.3, 20), np.zeros(20), np.linspace(1.0, 0.0, 20) ** 2])
MARGIN = 0.2
EXTENT = float(np.linalg.norm(np.ptp(PATH, axis=0) + MARGIN))
HALF_VIEW = np.radians(55.0 / 2)  # the viewer's field of view is 55 degrees or wider


def is_seen(eye: Eye, p_W: np.ndarray) -> bool:
    ahead, to = eye.target_W - eye.position_W, p_W - eye.position_W
    return bool(ahead @ to > np.cos(HALF_VIEW) * np.linalg.norm(ahead) * np.linalg.norm(to))


@pytest.mark.parametrize("distance", np.geomspace(1e-6, 1e4, 41))
@pytest.mark.parametrize("direction", [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.64, 0.48]])
def test_a_body_near_the_path_is_seen_whether_it_comes_before_or_after_the_prediction(
    distance: float, direction: list[float]
) -> None:
    place = 0.5 * (PATH[0] + PATH[-1]) + distance * np.array(direction)
    known = Framing(UP)
    assert known.add_body("other", place) is None  # there is nothing to look at yet
    eye = known.turn_to(PATH, margin=MARGIN)
    alone = Framing(UP)
    first = alone.turn_to(PATH, margin=MARGIN)
    later = alone.add_body("other", place)
    if distance < 0.99 * FAR * EXTENT:
        assert is_seen(eye, place)
        assert is_seen(first if later is None else later, place)
    elif distance > 1.01 * FAR * EXTENT:
        assert later is None  # the path could not be made out
        np.testing.assert_array_equal(eye.position_W, first.position_W)
    assert all(is_seen(eye, p_W) for p_W in PATH)


def test_the_order_in_which_bodies_come_does_not_matter() -> None:
    places = {"a": [0.5, 0.0, 0.3], "b": [0.0, 1.0, 0.3], "c": [2.0, 1.5, 0.3], "path": None}
    centers = []
    for names in permutations(places):
        framing = Framing(UP)
        for name in names:
            place = places[name]
            if place is None:
                framing.turn_to(PATH, margin=MARGIN)
            else:
                framing.add_body(name, np.array(place))
        centers.append(framing.center_W)
    np.testing.assert_allclose(centers, np.tile(centers[0], (len(centers), 1)))


def test_the_view_stays_when_a_body_comes_that_is_in_sight() -> None:
    framing = Framing(UP)
    framing.turn_to(PATH, margin=MARGIN)
    assert framing.add_body("other", PATH[7] + 0.5 * MARGIN) is None


@pytest.mark.parametrize("far", [1e3, 1e15, 1e160, 1e300])
def test_one_body_far_away_does_not_take_the_view_from_all_others(far: float) -> None:
    bodies = np.vstack(
        [PATH + np.array(aside) for aside in ([0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 2.0, 0.0])]
    )
    lost = np.full((10, 3), far)
    np.testing.assert_array_equal(near_most(np.vstack([bodies, lost])), bodies)
    np.testing.assert_array_equal(near_most(bodies), bodies)
    np.testing.assert_array_equal(near_most(lost), lost)


def test_a_single_point_without_size_is_looked_at_with_its_neighbours() -> None:
    framing = Framing(UP)
    framing.turn_to(PATH[:1], margin=0.0)
    eye = framing.add_body("other", PATH[0] + [LOWEST_DISTANCE, 0.0, 0.0])
    assert eye is not None
    assert is_seen(eye, PATH[0])
