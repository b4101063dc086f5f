from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tumbling import free_motion
from contact_dynamics.tumbling.poinsot_construction import poinsot, rolling_curves
from contact_dynamics.viewing.poinsot import PoinsotPicture, draw_poinsot, draw_rolling, ellipsoid_net

if TYPE_CHECKING:
    from collections.abc import Callable

    import rerun as rr

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.world import Body
    from viewing.drawn import Drawn

PATH = "/poinsot/brick"


def test_the_net_lies_on_the_ellipsoid() -> None:
    semi_axes = np.array([3.0, 2.0, 0.5])
    points = np.vstack(ellipsoid_net(semi_axes))
    np.testing.assert_allclose(np.sum((points / semi_axes) ** 2, axis=1), 1.0, rtol=1e-12)


def test_the_ellipsoid_touches_the_plane_where_the_angular_velocity_ends(
    recording: rr.RecordingStream, read: Callable[[], Drawn], body: Body, state: BodyState
) -> None:
    motion = free_motion(body.mass_properties, state, gravity_W=(0.0, 0.0, 0.0))
    constants = poinsot(motion)
    curves = rolling_curves(motion, 50)
    picture = PoinsotPicture(
        semi_axes=constants.ellipsoid_semi_axes,
        principal_axes_B=constants.principal_axes_B,
        L_W=constants.L_W,
        distance=constants.invariable_plane_distance,
        polhode_B=curves.polhode_B,
        herpolhode_W=curves.herpolhode_W,
    )
    states = [motion.state_at(seconds) for seconds in curves.seconds.tolist()]
    draw_poinsot(recording, "brick", picture)
    draw_rolling(recording, "brick", sorted(states, key=lambda state: state.stamp_ns))
    draw_rolling(recording, "brick", [])
    drawn = read()
    view = drawn.array(PATH, "Transform3D:mat3x3")[0].reshape(3, 3).T  # stored by columns
    np.testing.assert_allclose(view @ view.T * constants.ellipsoid_semi_axes.max() ** 2, np.eye(3), atol=1e-5)
    down = view @ constants.L_W
    np.testing.assert_allclose(down / np.linalg.norm(down), [0.0, 0.0, -1.0], atol=1e-6)
    polhode = drawn.array(f"{PATH}/body/polhode", "LineStrips3D:strips")[0]
    turns = drawn.series(f"{PATH}/body", "Transform3D:quaternion")
    rates = drawn.series(f"{PATH}/angular_velocity", "Arrows3D:vectors")
    net = np.vstack(drawn.array(f"{PATH}/body/ellipsoid", "LineStrips3D:strips"))
    size = float(np.linalg.norm(rates, axis=1).max())
    for i, (turn, rate) in enumerate(zip(turns, rates, strict=True)):
        # float32 vectors carry 1e-7 of their size
        np.testing.assert_allclose(rotation_matrix(turn) @ polhode[i], rate, atol=1e-6 * size)
        heights = net @ rotation_matrix(turn).T @ view[2]
        assert heights.min() >= view[2] @ rate - 1e-6  # all of the ellipsoid is above the plane
    assert view[2] @ rates[0] == pytest.approx(view[2] @ rates[-1], abs=1e-6)
