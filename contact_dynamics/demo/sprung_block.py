# SPDX-License-Identifier: Apache-2.0
"""The physics of the examples: a body in the plane x, z with stiff spring-damper contacts at its corners.

It is independent of the laws with which the package predicts, so the examples test them: no contact mode is
chosen here. A spring and a damper push a penetrating corner out of a flat, and a tangential spring holds it
until its force reaches the limit of Coulomb friction and the corner slides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from contact_dynamics.world import Body, World

STEP: Final = 1e-4  # s. The stiffest oscillation, of 1 kg on two corners, takes 140 such steps.
STIFFNESS: Final = 1e5  # N/m of each corner: a block of 1 kg penetrates by 0.05 mm
DAMPING: Final = 200.0  # N s/m of each corner, slightly below critical damping of 1 kg on two corners


@dataclass(frozen=True, slots=True, kw_only=True)
class Load:
    """The applied force and moment on the block."""

    force_x: float  # N
    force_z: float  # N
    moment: float = 0.0  # N m, about the centre of mass and the axis y


@dataclass(frozen=True, slots=True, kw_only=True)
class _Flat:
    """A flat perpendicular to the plane: its point and unit normal, x and z of each, and its friction."""

    point: tuple[float, float]
    normal: tuple[float, float]
    friction: float

    @property
    def tangent(self) -> tuple[float, float]:
        return self.normal[1], -self.normal[0]


@dataclass(slots=True, kw_only=True)
class _Contact:
    """A corner and a flat; ``held_at`` is the end of the tangential spring, m, or None without contact."""

    corner: tuple[float, float]
    flat: _Flat
    held_at: float | None = None


@dataclass(slots=True, kw_only=True)
class SprungBlock:
    """A body that moves in the plane x, z in contact with flats."""

    mass: float  # kg
    inertia: float  # kg m^2, about the axis y
    x: float  # m, of the centre of mass
    z: float  # m
    angle: float = 0.0  # rad, about the y axis: positive tips the block toward x
    vx: float = 0.0  # m/s
    vz: float = 0.0  # m/s
    spin: float = 0.0  # rad/s
    _contacts: list[_Contact] = field(default_factory=list)

    @classmethod
    def resting(cls, body: Body, world: World) -> SprungBlock:
        """Return the body at rest on the first surface of the world, above the origin.

        Raises:
            NotSupportedError: the shape has no corners, or a surface is not a flat perpendicular to the plane
                x, z.
        """
        corners = sorted({(float(x), float(z)) for x, _, z in body.shape.vertices.tolist()})
        if len(corners) < 3 or body.shape.rounding > 0.0:
            raise NotSupportedError(f"body {body.name!r} must have corners, got a round shape")
        flats = [_flat(surface) for surface in world.surfaces]
        below = -min(z for _, z in corners)
        weight = -body.mass_properties.mass * float(world.gravity_W[2])
        feet = sum(z <= -below + 1e-9 for _, z in corners)
        return cls(
            mass=body.mass_properties.mass,
            inertia=float(body.mass_properties.I_B[1, 1]),
            x=0.0,
            z=flats[0].point[1] + below - weight / (feet * STIFFNESS),
            _contacts=[_Contact(corner=corner, flat=flat) for flat in flats for corner in corners],
        )

    def move(self, load: Load, seconds: float) -> None:
        """Advance by this time, s, under a constant load."""
        for _ in range(round(seconds / STEP)):
            self._step(load)

    def state(self, stamp_ns: int) -> BodyState:
        """Return the state in space."""
        return BodyState(
            p_WB_W=np.array([self.x, 0.0, self.z]),
            q_WB=np.array([0.0, math.sin(0.5 * self.angle), 0.0, math.cos(0.5 * self.angle)]),
            v_WB_W=np.array([self.vx, 0.0, self.vz]),
            w_WB_W=np.array([0.0, self.spin, 0.0]),
            stamp_ns=stamp_ns,
        )

    def _step(self, load: Load) -> None:
        force_x, force_z, moment = load.force_x, load.force_z, load.moment
        cos, sin = math.cos(self.angle), math.sin(self.angle)
        for contact in self._contacts:
            (bx, bz), flat = contact.corner, contact.flat
            rx, rz = cos * bx + sin * bz, cos * bz - sin * bx
            (px, pz), (nx, nz), (tx, tz) = flat.point, flat.normal, flat.tangent
            gap = nx * (self.x + rx - px) + nz * (self.z + rz - pz)
            if gap >= 0.0:
                contact.held_at = None
                continue
            ux, uz = self.vx + self.spin * rz, self.vz - self.spin * rx
            pressed = max(0.0, -STIFFNESS * gap - DAMPING * (nx * ux + nz * uz))
            along = tx * (self.x + rx) + tz * (self.z + rz)
            if contact.held_at is None:
                contact.held_at = along
            drag = -DAMPING * (tx * ux + tz * uz)
            held = STIFFNESS * (contact.held_at - along) + drag
            most = flat.friction * pressed
            if abs(held) > most:
                held = math.copysign(most, held)
                contact.held_at = along + (held - drag) / STIFFNESS
            fx, fz = pressed * nx + held * tx, pressed * nz + held * tz
            force_x, force_z, moment = force_x + fx, force_z + fz, moment + rz * fx - rx * fz
        self.vx += STEP * force_x / self.mass
        self.vz += STEP * force_z / self.mass
        self.spin += STEP * moment / self.inertia
        self.x += STEP * self.vx
        self.z += STEP * self.vz
        self.angle += STEP * self.spin


def _flat(surface: object) -> _Flat:
    if not isinstance(surface, Surface) or surface.normal_W[1] != 0.0:
        raise NotSupportedError(f"surface must be a flat whose normal has no part along y, got {surface!r}")
    (px, _, pz), (nx, _, nz) = surface.p_WS_W.tolist(), surface.normal_W.tolist()
    return _Flat(point=(px, pz), normal=(nx, nz), friction=surface.friction)
