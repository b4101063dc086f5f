# SPDX-License-Identifier: Apache-2.0
"""The world as it stands in the scene: its axes, its surfaces, and the bodies that have come into view."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import Shape, drawn_shape
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.viewing.after_impact import style_after_impact
from contact_dynamics.viewing.entities import body_entity
from contact_dynamics.viewing.measured import style_series
from contact_dynamics.viewing.scene import (
    body_parts,
    draw_axes,
    draw_trail_style,
    obstacle_parts,
    surface_parts,
    surface_path,
)
from contact_dynamics.viewing.scenery import Scenery
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    import rerun as rr

    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.shapes.obstacle import Obstacle
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.scenery import Part
    from contact_dynamics.world import World


class BodiesInWorld:
    """How the bodies of a world look, and others that were asked about. An unknown one has no shape."""

    def __init__(self, world: World) -> None:
        """Take the bodies of a world."""
        self.change(world)

    def change(self, world: World) -> None:
        """Take those of another world."""
        self._world = world
        self._shapes: dict[str, Shape] = {body.name: drawn_shape(body.shape) for body in world.bodies}

    @property
    def names(self) -> list[str]:
        """The names of all bodies that were drawn or asked about."""
        return list(self._shapes)

    @property
    def largest_size(self) -> float:
        """The size of the largest body, m, or 0 without one."""
        return max((shape.size for shape in self._shapes.values()), default=0.0)

    def mass_properties(self, name: str) -> MassProperties | None:
        """Return the mass properties of a body of the world, or None if the body is not known."""
        known = (body.mass_properties for body in self._world.bodies if body.name == name)
        return next(known, None)

    def shape(self, name: str) -> Shape:
        """Return the shape of a body."""
        if name not in self._shapes:
            self._shapes[name] = drawn_shape(NO_SHAPE)
        return self._shapes[name]

    def parts(self, name: str) -> dict[str, Part]:
        """Return the parts of a body. Where there are several bodies, each has its name."""
        written = name if len(self._world.bodies) > 1 else ""
        return body_parts(self.shape(name), color=self.color(name), name=written)

    def color(self, name: str) -> palette.Color:
        """Return the colour of a body, which is its own among `palette.BODIES` of the world."""
        names = [body.name for body in self._world.bodies]
        return palette.body_color(names.index(name) if name in names else 0)


GROUND: Final = 5.0
"""Side of the largest square that a surface is drawn as, relative to the extent of what is looked at. A wall
that is much larger than a body hides it."""


class WorldInView:
    """Surfaces and bodies in the scene. Both can have other forms from a time on.

    Attributes:
        bodies: How the bodies look.
        up_W: (3,), the unit vector against gravity, or the third axis without gravity.
    """

    def __init__(self, recording: rr.RecordingStream, world: World, *, surface_side: float) -> None:
        """Draw the surfaces of a world, as squares of ``surface_side``, m, and set how its bodies look."""
        self._recording = recording
        self._world = world
        self._surface_side = surface_side
        self._scenery = Scenery(recording)
        self._in_scene: list[str] = []  # the bodies that are drawn
        self._first_ns: int | None = None  # stamp of the first state
        self._center_W: FloatArray | None = None  # the middle of what is looked at
        self._extent = surface_side  # m, of what is looked at
        self.bodies = BodiesInWorld(world)
        gravity = float(np.linalg.norm(world.gravity_W))
        self.up_W = -world.gravity_W / gravity if gravity > 0.0 else np.array([0.0, 0.0, 1.0])
        draw_axes(recording, self.up_W)
        self._draw_surfaces()
        for name in self.bodies.names:
            style_series(recording, name, self.bodies.color(name))
            style_after_impact(recording, name, self.bodies.color(name))

    @property
    def surfaces(self) -> tuple[Surface | Obstacle, ...]:
        """The world's surfaces."""
        return tuple(self._world.surfaces)

    @property
    def gravity_W(self) -> FloatArray:
        """The world's gravity, (3,), m/s^2."""
        return self._world.gravity_W

    def add_body(self, name: str, *, stamp_ns: int) -> None:
        """Draw a body that has its first state at a stamp, ns."""
        self._scenery.draw(body_entity(name), self.bodies.parts(name))
        draw_trail_style(self._recording, name, self.bodies.color(name))
        self._in_scene.append(name)
        if self._first_ns is None:
            self._first_ns = stamp_ns

    def center_at(self, center_W: FloatArray, *, extent: float) -> None:
        """Put the ground below a point, (3,), m, where what is looked at has an extent, m."""
        self._center_W, self._extent = center_W, extent
        self._draw_surfaces()

    def change(self, world: World, *, stamp_ns: int) -> None:
        """Draw other surfaces and shapes of bodies from a time on, ns."""
        self._world = world
        self.bodies.change(world)
        wanted = self._surfaces()
        gone = self._scenery.paths - wanted.keys()
        wanted |= {body_entity(name): self.bodies.parts(name) for name in self._in_scene}
        wanted |= {path: {} for path in gone - wanted.keys()}
        for path, parts in wanted.items():
            if self._first_ns is None:
                self._scenery.draw(path, parts)
            else:
                first_ns = min(self._first_ns, stamp_ns)
                self._scenery.change(path, parts, first_ns=first_ns, stamp_ns=stamp_ns)

    def _draw_surfaces(self) -> None:
        for path, parts in self._surfaces().items():
            self._scenery.draw(path, parts)

    def _surfaces(self) -> dict[str, dict[str, Part]]:
        """Return the parts of the surfaces by their paths."""
        flats = [surface for surface in self._world.surfaces if isinstance(surface, Surface)]
        return {
            surface_path(surface.name): surface_parts(
                surface,
                center_W=surface.p_WS_W if self._center_W is None else self._center_W,
                side=min(self._surface_side, GROUND * self._extent or self._surface_side),
                among=flats,
            )
            if isinstance(surface, Surface)
            else obstacle_parts(surface)
            for surface in self._world.surfaces
        }
