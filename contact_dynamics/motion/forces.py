# SPDX-License-Identifier: Apache-2.0
"""Constant wrenches and drag on a body, in addition to gravity (lecture 24).

A wrench is a force through the centre of mass and a torque about it. Drag follows the usual two laws for
still air or water: linear in creeping flow and quadratic in turbulent flow. It acts at the centre of mass,
equally in all directions. Not covered: wind, lift, added mass, a centre of pressure
elsewhere.

This file also contains the differential equations in the variables of the integrator, which
`motion.integrated` defines.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.rigid_body.body import BodyState, MassProperties, angular_momentum
from contact_dynamics.rotations.one import Quaternion, conjugate, normalised, product, rotated
from contact_dynamics.tumbling import Sample
from contact_dynamics.validation import FloatArray, check_array, check_not_negative

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


class WrenchAxes(NamedInt):
    """Axes in which a wrench is constant."""

    WORLD = 0
    BODY = 1  # it turns with the body


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ConstantWrench(Record):
    """Constant force through the centre of mass and constant torque about it.

    Attributes:
        force: (3,), N, in `axes`, zero by default.
        torque: (3,), N m, in `axes`, zero by default.
        axes: Axes of force and torque: world or body.

    Raises:
        InvalidFieldError: force or torque is not three finite numbers, or the axes are not a `WrenchAxes`.
    """

    force: FloatArray = field(default_factory=lambda: np.zeros(3))
    torque: FloatArray = field(default_factory=lambda: np.zeros(3))
    axes: WrenchAxes = WrenchAxes.WORLD

    if TYPE_CHECKING:

        def __init__(
            self, *, force: ArrayLike = ..., torque: ArrayLike = ..., axes: WrenchAxes = ...
        ) -> None:
            """Accept anything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check all fields."""
        object.__setattr__(self, "force", check_array("force", self.force, (3,)))
        object.__setattr__(self, "torque", check_array("torque", self.torque, (3,)))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Drag(Record):
    """Drag in still air, at the centre of mass.

    The force is -(linear + quadratic |v|) v, the torque -(linear_angular + quadratic_angular |w|) w.

    Attributes:
        linear: Coefficient of the force, N s/m, >= 0.
        quadratic: Coefficient of the force, N s^2/m^2, >= 0.
        linear_angular: Coefficient of the torque, N m s, >= 0.
        quadratic_angular: Coefficient of the torque, N m s^2, >= 0.

    Raises:
        InvalidFieldError: a coefficient is negative or not finite.
    """

    linear: float = 0.0
    quadratic: float = 0.0
    linear_angular: float = 0.0
    quadratic_angular: float = 0.0

    def __post_init__(self) -> None:
        """Check all coefficients."""
        for name in self.__slots__:
            object.__setattr__(self, name, check_not_negative(f"{name}_drag", getattr(self, name)))


NO_WRENCH: Final = ConstantWrench()
NO_DRAG: Final = Drag()


WrenchFunction: TypeAlias = Callable[[float, Sample], tuple[Sequence[float], Sequence[float]]]

VARIABLES: Final = 13
"""Deviations of position (m) and velocity (m/s) from the free parabola, quaternion, L / I_max (rad/s)."""


class MotionLaw:
    """The differential equations, in plain floats."""

    def __init__(
        self,
        body: MassProperties,
        state: BodyState,
        gravity_W: FloatArray,
        *,
        wrench: ConstantWrench,
        drag: Drag,
        wrench_of: WrenchFunction | None,
    ) -> None:
        self.gravity_W = gravity_W
        self.mass = body.mass
        self.scale = float(np.linalg.eigvalsh(body.I_B)[-1])  # so that tolerances of L are those of a rate
        self.inverse = (self.scale * np.linalg.inv(body.I_B)).tolist()
        self.parabola = list(
            zip(state.p_WB_W.tolist(), state.v_WB_W.tolist(), gravity_W.tolist(), strict=True)
        )
        self.force, self.torque = wrench.force.tolist(), wrench.torque.tolist()
        self.turns = wrench.axes is WrenchAxes.BODY
        self.drag = drag if drag != NO_DRAG else None
        self.wrench_of = wrench_of
        momentum = angular_momentum(body, state) / self.scale
        self.start = np.concatenate([np.zeros(6), state.q_WB, momentum])

    def sample(self, t: float, y: Sequence[float]) -> Sample:
        """Return the body's motion for the integrator's variables."""
        q = normalised(y[6:10])
        (px, vx, gx), (py, vy, gy), (pz, vz, gz) = self.parabola
        half = 0.5 * t
        a, b, c = rotated(conjugate(q), y[10:13])
        (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = self.inverse
        w_B = (ixx * a + ixy * b + ixz * c, ixy * a + iyy * b + iyz * c, ixz * a + iyz * b + izz * c)
        return Sample(
            (
                y[0] + (px + t * (vx + half * gx)),
                y[1] + (py + t * (vy + half * gy)),
                y[2] + (pz + t * (vz + half * gz)),
            ),
            q,
            (y[3] + (vx + t * gx), y[4] + (vy + t * gy), y[5] + (vz + t * gz)),
            rotated(q, w_B),
        )

    def rates(self, t: float, y: FloatArray) -> list[float]:
        """Return the rates of the integrator's variables."""
        values = y.tolist()
        sample = self.sample(t, values)
        q, v, w = sample.q_WB, sample.v_WB_W, sample.w_WB_W
        fx, fy, fz = rotated(q, self.force) if self.turns else self.force
        nx, ny, nz = rotated(q, self.torque) if self.turns else self.torque
        if self.drag is not None:
            drag = self.drag
            by_v = drag.linear + drag.quadratic * _length(v)
            by_w = drag.linear_angular + drag.quadratic_angular * _length(w)
            fx, fy, fz = fx - by_v * v[0], fy - by_v * v[1], fz - by_v * v[2]
            nx, ny, nz = nx - by_w * w[0], ny - by_w * w[1], nz - by_w * w[2]
        if self.wrench_of is not None:
            (ax, ay, az), (bx, by, bz) = _checked(self.wrench_of(t, sample))
            fx, fy, fz, nx, ny, nz = fx + ax, fy + ay, fz + az, nx + bx, ny + by, nz + bz
        # the rate of a quaternion that is not unit, so that its norm stays as it is
        norm = math.sqrt(sum(x * x for x in values[6:10]))
        spin: Quaternion = (0.5 * norm * w[0], 0.5 * norm * w[1], 0.5 * norm * w[2], 0.0)
        m, scale = self.mass, self.scale
        return [
            *values[3:6],
            fx / m,
            fy / m,
            fz / m,
            *product(spin, q),
            nx / scale,
            ny / scale,
            nz / scale,
        ]


def _checked(wrench: Any) -> tuple[Sequence[float], Sequence[float]]:
    try:
        force, torque = ([float(x) for x in vector] for vector in wrench)
    except (TypeError, ValueError, OverflowError):
        raise InvalidFieldError("wrench_of", wrench, "a function that returns two vectors") from None
    for name, vector in (("force", force), ("torque", torque)):
        if len(vector) != 3 or not all(map(math.isfinite, vector)):
            raise InvalidFieldError(f"wrench_of: {name}", vector, "three finite numbers")
    return force, torque


def _length(vector: Sequence[float]) -> float:
    x, y, z = vector
    return math.sqrt(x * x + y * y + z * z)
