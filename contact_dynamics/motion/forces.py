# SPDX-License-Identifier: Apache-2.0
"""Besides gravity, constant wrenches and drag act on a body (lecture 24).

A wrench is a force through the centre of mass and a torque about it. Drag follows the usual two laws for
still air or water: it is linear where the flow creeps and quadratic where it is turbulent. It acts at the
centre of mass and equally in all directions. Not covered: wind, lift, added mass, a centre of pressure
elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.records import NamedInt, Record
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
            """Take whatever NumPy makes arrays of."""

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
