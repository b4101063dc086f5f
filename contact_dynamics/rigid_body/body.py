# SPDX-License-Identifier: Apache-2.0
"""A rigid body has mass properties and a state; momenta and energies follow (Mason, lectures 24 and 25).

Frames: W is the world. B is the body's frame, with its origin at the centre of mass. If a published frame has
its origin elsewhere, `published_frame` converts.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record, made
from contact_dynamics.rotations.one import cross_matrix, rotation_matrix
from contact_dynamics.tolerances import LARGEST_NUMBER, SYMMETRY_TOLERANCE, TRIANGLE_TOLERANCE
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_positive,
    check_size,
    check_stamp,
    check_unit,
    check_within,
)
from contact_dynamics.validation_batches import unit_rows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


class HasMassProperties(Record):
    """Argument that provides mass and inertia: a `Body`, or its `MassProperties`."""

    __slots__ = ()
    ALLOWED: ClassVar[str] = "a Body or its MassProperties"

    if TYPE_CHECKING:

        @property
        def mass_properties(self) -> MassProperties:
            """Mass and angular inertia about the centre of mass."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MassProperties(HasMassProperties):
    """Mass and angular inertia of a rigid body (lecture 24, "Angular inertia").

    Attributes:
        mass: kg, > 0.
        I_B: (3, 3), kg m^2, about the centre of mass, in body axes.

    Raises:
        InvalidFieldError: the mass is not > 0, or the inertia is not symmetric, not positive definite, or has
            principal moments that no distribution of mass has (I1 + I2 >= I3 is required). Or the mass or a
            moment is above `LARGEST_NUMBER` or below its inverse.
    """

    mass: float
    I_B: FloatArray

    HINT_IF_WRONG: ClassVar[str] = ", which Body(name=..., mass_properties=it, shape=...) takes"

    if TYPE_CHECKING:

        def __init__(self, *, mass: float, I_B: ArrayLike) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check both fields."""
        object.__setattr__(self, "mass", check_size("mass", check_positive("mass", self.mass)))
        object.__setattr__(self, "I_B", _check_inertia("I_B", self.I_B))

    @property
    def mass_properties(self) -> MassProperties:
        """Return these mass properties, so that functions accept them in place of a `Body`."""
        return self

    def inertia_in_world(self, R_WB: FloatArray) -> FloatArray:
        """Return the angular inertia in world axes, (3, 3), kg m^2 (lecture 25, eq. 11)."""
        return R_WB @ self.I_B @ R_WB.T

    def angular_inertia_about(self, axis_B: ArrayLike) -> float:
        """Return n^T I n, kg m^2, about a unit axis through the centre of mass (lecture 25, eq. 12)."""
        axis = check_unit("axis_B", axis_B, 3)
        return float(axis @ self.I_B @ axis)

    def radius_of_gyration(self, axis_B: ArrayLike) -> float:
        """Return k of I_n = m k^2, m, about a unit axis through the centre of mass (lecture 25, eq. 13)."""
        return math.sqrt(self.angular_inertia_about(axis_B) / self.mass)

    @property
    def mean_radius_of_gyration(self) -> float:
        """Return the root mean square of the radii of gyration about three orthogonal axes, m."""
        return mean_radius_of_gyration(self.mass, self.I_B)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False, init=False)
class BodyState(Record):
    """Pose and velocities of a body at one time.

    The arrays are read-only. ``state.R_WB @ vector`` rotates a vector. Pass copies to functions that require
    writable arrays, such as SciPy's ``Rotation.from_quat(state.q_WB.copy())``.

    Attributes:
        p_WB_W: (3,), m, position of the centre of mass, world.
        q_WB: (4,), unit quaternion x, y, z, w, which transforms body coordinates into world coordinates.
        v_WB_W: (3,), m/s, velocity of the centre of mass, world axes. The default is zero.
        w_WB_W: (3,), rad/s, angular velocity, world axes. The default is zero.
        stamp_ns: Time of this state, ns, on the caller's clock.

    Raises:
        InvalidFieldError: a number is not finite, the quaternion is not a unit quaternion, the stamp is not a
            whole number, or the attitude is given in both orders or in none.

    Examples:
        >>> import contact_dynamics as cd
        >>> state = cd.BodyState(p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[1.5, 0, 2], w_WB_W=[0, 9, 0])
        >>> print(state.velocity_of_point([0.1, 0, 1]))
        [1.5 0.  1.1]
    """

    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray
    stamp_ns: int = 0

    def __init__(
        self,
        *,
        p_WB_W: ArrayLike,
        q_WB: ArrayLike | None = None,
        v_WB_W: ArrayLike = (0.0, 0.0, 0.0),
        w_WB_W: ArrayLike = (0.0, 0.0, 0.0),
        stamp_ns: int = 0,
        quaternion_wxyz: ArrayLike | None = None,
    ) -> None:
        """Check all fields, and normalize the quaternion.

        Args:
            p_WB_W: As the attribute.
            q_WB: As the attribute.
            v_WB_W: As the attribute.
            w_WB_W: As the attribute.
            stamp_ns: As the attribute.
            quaternion_wxyz: (4,), quaternion in the order w, x, y, z, as an alternative to ``q_WB``.
        """
        if q_WB is not None and quaternion_wxyz is None:
            q = check_unit("q_WB", q_WB, 4)
        elif quaternion_wxyz is not None and q_WB is None:
            q = np.roll(check_unit("quaternion_wxyz", quaternion_wxyz, 4), -1)
            q.flags.writeable = False
        else:
            found = "neither" if q_WB is None else "both"
            raise InvalidFieldError("q_WB or quaternion_wxyz", found, "given, and not both")
        object.__setattr__(self, "p_WB_W", check_array("p_WB_W", p_WB_W, (3,)))
        object.__setattr__(self, "q_WB", q)
        object.__setattr__(self, "v_WB_W", check_array("v_WB_W", v_WB_W, (3,)))
        object.__setattr__(self, "w_WB_W", check_array("w_WB_W", w_WB_W, (3,)))
        object.__setattr__(self, "stamp_ns", check_stamp("stamp_ns", stamp_ns))

    def with_velocities(self, v_WB_W: ArrayLike, w_WB_W: ArrayLike) -> BodyState:
        """Return the state with the same pose and time and other velocities. Only these are checked."""
        v, w = check_array("v_WB_W", v_WB_W, (3,)), check_array("w_WB_W", w_WB_W, (3,))
        return made(BodyState, self.p_WB_W, self.q_WB, v, w, self.stamp_ns)

    @property
    def R_WB(self) -> FloatArray:
        """Return the rotation matrix, (3, 3), which transforms body coordinates into world coordinates."""
        return rotation_matrix(self.q_WB)

    def velocity_of_point(self, p_WP_W: FloatArray) -> FloatArray:
        """Return the velocities, (..., 3), m/s, world axes, of body points at ``p_WP_W``: v + w x r."""
        velocity: FloatArray = self.v_WB_W + (p_WP_W - self.p_WB_W) @ cross_matrix(self.w_WB_W).T
        return velocity


def states_of_rows(rows: ArrayLike, stamps_ns: Sequence[int]) -> list[BodyState]:
    """Return the states of rows of 13 numbers, position, quaternion, velocity and angular velocity.

    Quaternions are unit nearly, and are scaled. It takes a twentieth of the time of states made one by one.

    Raises:
        InvalidFieldError: a number is not finite.
    """
    numbers = np.array(rows, dtype=np.float64).reshape(-1, 13)
    numbers[:, 3:7] = unit_rows(numbers[:, 3:7])[0]
    numbers = check_array("states", numbers, (None, 13))
    return [
        made(BodyState, row[:3], row[3:7], row[7:10], row[10:], stamp_ns)
        for row, stamp_ns in zip(numbers, stamps_ns, strict=True)
    ]


def mean_radius_of_gyration(mass: float, inertia: FloatArray) -> float:
    """Return the root mean square, m, of the radii of gyration about three orthogonal axes.

    ``inertia`` is (3, 3), kg m^2, about the centre of mass in any axes, which change the result by rounding.
    """
    return math.sqrt(float(np.trace(inertia)) / (3.0 * mass))


def inverse_mass_matrix(mass: float, inertia_W: FloatArray) -> FloatArray:
    """Return the (6, 6) matrix that takes force and torque to linear and angular acceleration.

    ``inertia_W`` is (3, 3), kg m^2, about the centre of mass. The body is at rest, so there is no w x L.
    """
    inverse = np.zeros((6, 6))
    inverse[:3, :3] = np.eye(3) / mass
    inverse[3:, 3:] = np.linalg.inv(inertia_W)
    return inverse


def state_covariance(
    *,
    position: ArrayLike = 0.0,
    rotation: ArrayLike = 0.0,
    velocity: ArrayLike = 0.0,
    angular_velocity: ArrayLike = 0.0,
) -> FloatArray:
    """Return the covariance of a state, (12, 12), from standard deviations of independent errors.

    Each standard deviation is one number for all axes, or one number for each world axis, (3,). The order of
    rows and columns is that of the arguments.

    Args:
        position: m, >= 0, of the centre of mass.
        rotation: rad, >= 0, of a small rotation applied after the attitude.
        velocity: m/s, >= 0, of the centre of mass.
        angular_velocity: rad/s, >= 0.

    Examples:
        >>> import contact_dynamics as cd
        >>> covariance = cd.state_covariance(position=0.002, velocity=[0.05, 0.05, 0.1])
        >>> print(covariance.shape, covariance[6:9, 6:9].diagonal())
        (12, 12) [0.0025 0.0025 0.01  ]
    """
    named = {
        "position": position,
        "rotation": rotation,
        "velocity": velocity,
        "angular_velocity": angular_velocity,
    }
    deviations = [_three_deviations(name, value) for name, value in named.items()]
    return np.diag(np.square(np.concatenate(deviations)))


def _three_deviations(name: str, value: ArrayLike) -> FloatArray:
    """Return a standard deviation for each axis, (3,)."""
    if isinstance(value, (list, tuple, np.ndarray)) and np.ndim(value) > 0:
        return np.array([check_within(name, x, 0.0, LARGEST_NUMBER) for x in check_array(name, value, (3,))])
    return np.full(3, check_within(name, value, 0.0, LARGEST_NUMBER))


def momentum(body: HasMassProperties, state: BodyState) -> FloatArray:
    """Return the linear momentum m v, (3,), kg m/s, world axes (lecture 24)."""
    body = body.mass_properties
    return body.mass * state.v_WB_W


def angular_momentum(body: HasMassProperties, state: BodyState) -> FloatArray:
    """Return L = I w about the centre of mass, (3,), kg m^2/s, world axes (lecture 24)."""
    body = body.mass_properties
    return body.inertia_in_world(state.R_WB) @ state.w_WB_W


def kinetic_energy(body: HasMassProperties, state: BodyState) -> float:
    """Return the kinetic energy of translation and rotation, J (lecture 24; lecture 25, eq. 23)."""
    body = body.mass_properties
    v = check_magnitude("v_WB_W", state.v_WB_W)
    translation = 0.5 * body.mass * float(v @ v)
    return translation + rotational_energy(body, state)


def rotational_energy(body: HasMassProperties, state: BodyState) -> float:
    """Return the kinetic energy of rotation, w . L / 2, J (lecture 25, eq. 23)."""
    return 0.5 * float(check_magnitude("w_WB_W", state.w_WB_W) @ angular_momentum(body, state))


def _check_inertia(field: str, value: FloatArray) -> FloatArray:
    inertia = check_symmetric(field, value)
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] <= 0.0:
        raise InvalidFieldError(field, f"principal moments {moments.tolist()}", "a positive definite matrix")
    if moments[0] + moments[1] < moments[2] * (1.0 - TRIANGLE_TOLERANCE):
        raise InvalidFieldError(
            field, f"principal moments {moments.tolist()}", "moments that a body can have (I1 + I2 >= I3)"
        )
    for moment in (moments[0], moments[2]):
        check_size(field, moment)
    return inertia


def check_symmetric(field: str, value: ArrayLike) -> FloatArray:
    """Return a (3, 3) matrix, or raise `InvalidFieldError` where it is not symmetric."""
    matrix = check_magnitude(field, check_array(field, value, (3, 3)), LARGEST_NUMBER**2)
    if float(np.abs(matrix - matrix.T).max()) > SYMMETRY_TOLERANCE * float(np.abs(matrix).max()):
        raise InvalidFieldError(field, matrix.tolist(), "a symmetric matrix")
    return matrix
