"""The server's parameters for a recorded toss: the body and the surface that the recording describes."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.demo.toss_publisher import WORLD_FRAME, topic_of

if TYPE_CHECKING:
    from pathlib import Path

    from contact_dynamics.measured.recorded_toss import Toss


TOUCHING: Final = 0.003
"""m. Corners this near the surface touch it. Tracked frame, shape and surface together have this error."""


def write_parameters(path: Path, toss: Toss, *, log_directory: Path) -> None:
    """Write the file that configures server and visualizer, as JSON, which is also YAML."""
    name, surface = toss.body.name, toss.surface
    (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = toss.body.mass_properties.I_B.tolist()
    parameters: dict[str, Any] = {
        "world_frame": WORLD_FRAME,
        "gravity": toss.gravity_W.tolist(),
        "bodies": [name],
        f"body.{name}.mass": toss.body.mass_properties.mass,
        f"body.{name}.inertia": [ixx, iyy, izz, ixy, ixz, iyz],
        f"body.{name}.box": toss.box_size.tolist(),
        f"body.{name}.odometry_topic": topic_of(toss),
        "surfaces": [surface.name],
        f"surface.{surface.name}.point": surface.p_WS_W.tolist(),
        f"surface.{surface.name}.normal": surface.normal_W.tolist(),
        f"surface.{surface.name}.friction": surface.friction,
        f"surface.{surface.name}.restitution": surface.restitution,
        # Measured states: what lies within their noise counts as none.
        "velocity_tolerance": 5.0 * toss.contact_speed_noise,
        "distance_tolerance": TOUCHING,
        "out_of_plane_tolerance": 5.0 * toss.contact_speed_noise,
        "log_directory": str(log_directory),
    }
    path.write_text(json.dumps({"/**": {"ros__parameters": parameters}}, indent=2) + "\n", encoding="utf-8")
