"""A calibration as the server's parameters, in YAML with a comment for what was found."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.calibration.result import Calibration


def server_parameters(found: Calibration) -> str:
    """Return a file of parameters that the server takes as it is. Topics are left to whoever adds them."""
    body = found.body
    name = body.name
    I_B = body.mass_properties.I_B
    shape = body.shape
    corners = (shape.vertices + body.p_FB_F).ravel()
    lines = [
        f"# Calibrated from tosses: {found.clusters}. Add the topics of the body's states.",
        "/**:",
        "  ros__parameters:",
        f"    gravity: {_list(found.gravity_W)}",
        f"    bodies: [{name}]",
        "    # No motion tells the mass: this is what was configured, and the inertia is relative to it.",
        f"    body.{name}.mass: {float(body.mass_properties.mass)!r}",
        f"    body.{name}.center_of_mass: {_list(body.p_FB_F)}",
        f"    body.{name}.inertia: {_list([*I_B.diagonal(), I_B[0, 1], I_B[0, 2], I_B[1, 2]])}",
        f"    body.{name}.vertices: {_list(corners)}",
        f"    body.{name}.rounding: {float(shape.rounding)!r}",
        f"    surfaces: [{', '.join(surface.name for surface in found.surfaces)}]",
    ]
    for surface in found.surfaces:
        key = f"    surface.{surface.name}"
        lines += [
            f"{key}.point: {_list(surface.p_WS_W)}",
            f"{key}.normal: {_list(surface.normal_W)}",
            f"{key}.friction: {float(surface.friction)!r}",
            f"{key}.restitution: {float(surface.restitution)!r}",
            f"{key}.lasting_factor: {float(surface.lasting_factor)!r}",
        ]
    return "\n".join(lines) + "\n"


def _list(values: Iterable[float]) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"
