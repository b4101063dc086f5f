# SPDX-License-Identifier: Apache-2.0
"""Draws the shapes of bodies, and surfaces as patches of ground, which seldom change.

Shapes that never change are drawn without a time (static), so that they are visible from the beginning. rerun
shows static drawings at every time, whatever else is drawn at their path, so a shape that changes is moved to
paths of its own, one for each version, for the time in which it is valid.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.shape import Shape, drawn_shape
from contact_dynamics.diagrams.world_scene import body_marks, obstacle_marks, surface_marks
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.viewing.blueprint import up_of
from contact_dynamics.viewing.drawing import parts_of
from contact_dynamics.viewing.entities import BODIES, SCENE, SURFACES, TRAILS, entity
from contact_dynamics.viewing.measured import set_time, style_series
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from contact_dynamics.questions.carried_surface import CarriedSurface
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World


Part: TypeAlias = Any  # an archetype of rerun


class Scenery:
    """Entities, each drawn at a path in some parts."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._parts: dict[str, Mapping[str, Part]] = {}
        self._forms: dict[str, int] = {}  # version of each entity that has changed, from 1
        self._since_ns: dict[str, int] = {}  # stamp from which its version is valid

    @property
    def paths(self) -> frozenset[str]:
        """The paths of the entities that are currently drawn."""
        return frozenset(path for path, parts in self._parts.items() if parts)

    def draw(self, path: str, parts: Mapping[str, Part]) -> None:
        """Draw an entity by the names of its parts: for all times, or for those of its current version."""
        self._parts[path] = parts
        if path in self._forms:
            self._draw_form(path, parts, self._forms[path], stamp_ns=self._since_ns[path])
            return
        for name, part in parts.items():
            self._recording.log(f"{path}/{name}", part, static=True)

    def change(self, path: str, parts: Mapping[str, Part], *, first_ns: int, stamp_ns: int) -> None:
        """Redraw an entity from a stamp on, ns; without parts, remove it. The picture begins at first_ns."""
        before = self._parts.get(path, {})
        form = self._forms.get(path, 0)
        if form == 0:
            for name, part in before.items():
                self._recording.log(f"{path}/{name}", part.cleared(), static=True)
            form = 1
            self._draw_form(path, before, form, stamp_ns=first_ns)
        set_time(self._recording, stamp_ns)
        for name in before:
            self._recording.log(f"{path}/{name}/{form}", rr.Clear(recursive=False))
        form += 1
        self._draw_form(path, parts, form, stamp_ns=stamp_ns)
        self._parts[path], self._forms[path], self._since_ns[path] = parts, form, stamp_ns

    def _draw_form(self, path: str, parts: Mapping[str, Part], form: int, *, stamp_ns: int) -> None:
        set_time(self._recording, stamp_ns)
        for name, part in parts.items():
            self._recording.log(f"{path}/{name}/{form}", part)


_TRAIL_WIDTH: Final = -1.5  # a negative size is in points of the screen


def draw_axes(recording: rr.RecordingStream, up_W: FloatArray) -> None:
    """Set the viewer's up axis to the world's axis that is nearest to up."""
    axis = int(np.abs(up_W).argmax())
    names = ("RIGHT_HAND_X", "RIGHT_HAND_Y", "RIGHT_HAND_Z")
    sign = "UP" if up_W[axis] > 0.0 else "DOWN"
    recording.log(SCENE, getattr(rr.ViewCoordinates, f"{names[axis]}_{sign}"), static=True)


def draw_trail_style(
    recording: rr.RecordingStream, body_name: str, color: palette.Color = palette.MEASURED
) -> None:
    """Set the style of a body's trail."""
    trail = rr.LineStrips3D.from_fields(colors=palette.translucent(color, 0.9), radii=_TRAIL_WIDTH)
    recording.log(entity(TRAILS, body_name), trail, static=True)


class BodiesInWorld:
    """The appearance of the bodies of a world and of requests. An unknown body has no shape."""

    def __init__(self, world: World) -> None:
        """Use the bodies of a world."""
        self.change(world)

    def change(self, world: World) -> None:
        """Use the bodies of another world."""
        self._world = world
        self._shapes: dict[str, Shape] = {body.name: drawn_shape(body.shape) for body in world.bodies}

    @property
    def names(self) -> list[str]:
        """The names of all bodies that were drawn or requested."""
        return list(self._shapes)

    @property
    def largest_size(self) -> float:
        """The size of the largest body, m, or 0 without one."""
        return max((shape.size for shape in self._shapes.values()), default=0.0)

    def mass_properties(self, name: str) -> MassProperties | None:
        """Return the mass properties of a body of the world, or None if the body is unknown."""
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
        return parts_of(body_marks(self.shape(name), color=self.color(name), name=written))

    def color(self, name: str) -> palette.Color:
        """Return the colour of a body, which is its own among `palette.BODIES` of the world."""
        names = [body.name for body in self._world.bodies]
        return palette.body_color(names.index(name) if name in names else 0)


GROUND: Final = 5.0
"""Side of the largest square for a surface, relative to the extent of the region in view. A much larger wall
would hide the bodies."""


class WorldInView:
    """Surfaces and bodies in the scene. The shapes of both can change over time.

    Attributes:
        world: The current world.
        bodies: The appearance of the bodies.
        up_W: (3,), the unit vector against gravity, or the third axis without gravity.
    """

    def __init__(
        self,
        recording: rr.RecordingStream,
        world: World,
        *,
        surface_side: float,
        carried: Sequence[CarriedSurface] = (),
    ) -> None:
        """Draw the surfaces of a world, as squares of ``surface_side``, m, and those carried by bodies."""
        self._recording = recording
        self.world = world
        self._carried = carried
        self._surface_side = surface_side
        self._scenery = Scenery(recording)
        self._in_scene: list[str] = []  # the bodies that are drawn
        self._first_ns: int | None = None  # stamp of the first state
        self._center_W: FloatArray | None = None  # centre of the region in view
        self._extent = surface_side  # m, of the region in view
        self.bodies = BodiesInWorld(world)
        self.up_W = up_of(world.gravity_W)
        draw_axes(recording, self.up_W)
        self._draw_surfaces()
        for name in self.bodies.names:
            style_series(recording, name, self.bodies.color(name))

    def add_body(self, name: str, *, stamp_ns: int) -> None:
        """Draw a body that has its first state at a stamp, ns."""
        self._scenery.draw(entity(BODIES, name), self.bodies.parts(name))
        draw_trail_style(self._recording, name, self.bodies.color(name))
        self._in_scene.append(name)
        if self._first_ns is None:
            self._first_ns = stamp_ns

    def center_at(self, center_W: FloatArray, *, extent: float) -> None:
        """Centre the ground below a point, (3,), m, with the extent of the region in view, m."""
        self._center_W, self._extent = center_W, extent
        self._draw_surfaces()

    def change(self, world: World, *, stamp_ns: int, carried: Sequence[CarriedSurface] = ()) -> None:
        """Replace the surfaces and shapes of bodies from a time on, ns."""
        self.world = world
        self._carried = carried
        self.bodies.change(world)
        wanted = self._surfaces()
        gone = self._scenery.paths - wanted.keys()
        wanted |= {entity(BODIES, name): self.bodies.parts(name) for name in self._in_scene}
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
        flats = [surface for surface in self.world.surfaces if isinstance(surface, Surface)]
        side = min(self._surface_side, GROUND * self._extent or self._surface_side)
        parts: dict[str, dict[str, Part]] = {}
        for surface in self.world.surfaces:
            if isinstance(surface, Surface):
                center_W = surface.p_WS_W if self._center_W is None else self._center_W
                marks = surface_marks(surface, center_W=center_W, side=side, among=flats)
            else:
                marks = obstacle_marks(surface)
            parts[entity(SURFACES, surface.name)] = parts_of(marks)
        for each in self._carried:
            carrier = self.world.body(each.body_name)
            plane = replace(each.surface, p_WS_W=each.surface.p_WS_W - carrier.p_FB_F)
            marks = surface_marks(plane, center_W=plane.p_WS_W, side=self.bodies.shape(carrier.name).size)
            parts[entity(BODIES, carrier.name, plane.name)] = parts_of(marks)
        return parts
