"""How the bodies of a world look: their shapes, colours and names. An unknown body has no shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.diagrams.shape import Shape, drawn_shape
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.viewing import palette
from contact_dynamics.viewing.scene import body_parts

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.viewing.scenery import Part
    from contact_dynamics.world import World


class BodiesInWorld:
    """The bodies of a world, and others that were asked about."""

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
