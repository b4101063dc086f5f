# SPDX-License-Identifier: Apache-2.0
"""Drawings go to a file and are read back; whatever rerun finds wrong raises."""

from __future__ import annotations

import socket
import warnings
from typing import TYPE_CHECKING

import numpy as np
import pytest

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    import rerun as rr

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import free_motion
from contact_dynamics.viewing.measured import set_time
from contact_dynamics.viewing.viewer_process import LOCAL
from contact_dynamics.world import Body, Surface, World, box_vertices
from viewing.drawn import STAMP_NS, Drawn, read_drawn

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from contact_dynamics.tumbling import Trajectory

BOX = (0.15, 0.09, 0.05)


@pytest.fixture(autouse=True)
def strict() -> Iterator[None]:
    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(False)


@pytest.fixture
def free_port() -> int:
    """A port of this machine at which nothing listens."""
    with socket.socket() as probe:
        probe.bind((LOCAL, 0))
        port: int = probe.getsockname()[1]
        return port


@pytest.fixture
def silent_viewer() -> Iterator[int]:
    """A port where something listens and never answers."""
    with socket.socket() as listener:
        listener.bind((LOCAL, 0))
        listener.listen()
        yield listener.getsockname()[1]


@pytest.fixture
def recording(tmp_path: Path) -> rr.RecordingStream:
    stream = rr.RecordingStream("test")
    stream.save(tmp_path / "drawn.rrd")
    set_time(stream, STAMP_NS)
    return stream


@pytest.fixture
def read(recording: rr.RecordingStream, tmp_path: Path) -> Callable[[], Drawn]:
    def finish() -> Drawn:
        recording.disconnect()
        return read_drawn(tmp_path / "drawn.rrd")

    return finish


@pytest.fixture
def body() -> Body:
    inertia = np.diag([3.5e-4, 8.3e-4, 1.02e-3])
    return Body(
        name="brick", mass_properties=MassProperties(mass=0.4, I_B=inertia), vertices_B=box_vertices(BOX)
    )


@pytest.fixture
def floor() -> Surface:
    return Surface(
        name="floor",
        p_WS_W=np.zeros(3),
        normal_W=np.array([0.0, 0.0, 1.0]),
        friction=0.3,
        restitution=0.5,
    )


@pytest.fixture
def world(body: Body, floor: Surface) -> World:
    return World(bodies=(body,), surfaces=(floor,))


@pytest.fixture
def state() -> BodyState:
    return BodyState(
        p_WB_W=np.array([0.1, -0.2, 1.0]),
        q_WB=np.array([0.1, -0.5, 0.7, 0.5]),
        v_WB_W=np.array([0.5, 0.3, 1.0]),
        w_WB_W=np.array([3.0, -8.0, 1.0]),
        stamp_ns=STAMP_NS,
    )


@pytest.fixture
def trajectory(body: Body, state: BodyState) -> Trajectory:
    """0.4 s of flight at 100 Hz."""
    return free_motion(body.mass_properties, state).at(np.linspace(0.0, 0.4, 41))


@pytest.fixture
def two_contacts() -> ContactSet:
    return ContactSet(
        p_WC_W=np.array([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]]),
        normals_W=np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]),
        frictions=np.array([0.3, 0.3]),
        restitutions=np.array([0.5, 0.5]),
        surfaces=("floor", "floor"),
    )
