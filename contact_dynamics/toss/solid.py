# SPDX-License-Identifier: Apache-2.0
"""A body and the planes of the world in plain floats, and the contacts between them.

`solid.pxd` gives the C types with which this file compiles.

A *touch* is a corner of the body and a plane, here called a flat. If the shape is rounded, the corner is the
centre of a ball, and the contact point is below it. The arm from the centre of mass to that point is
R c - r n, with the corner c, the radius r and the normal n. Its rate of change is w x R c, so the
acceleration of the contact point is a + alpha x arm + w x (w x R c).
"""

from __future__ import annotations

import math
from array import array
from copy import copy
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.curvature import alike
from contact_dynamics.contact.found import check_has_shape
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.numerics.vectors import tangents
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import SETTLING_HEIGHT, SLIDING_DIRECTION_SPEED
from contact_dynamics.toss import vectors as vec
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.vectors import Matrix3
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

Touch: TypeAlias = tuple[int, int]
"""The index of a flat among the world's surfaces, and the index of a corner of the body's shape."""

Numbers: TypeAlias = "list[float]"
"""A state of 13 numbers: position, quaternion x y z w, velocity and angular velocity, world axes, SI."""

_INFINITE: Final = math.inf


class Flat:
    """A flat of the world.

    Attributes:
        name: The name of the surface.
        normal: Unit, into the free side, world axes.
        tangents: Two unit tangents, orthogonal to each other.
        level: m, the height of the flat along its normal.
        friction: Coefficient of friction mu of sustained contact.
        restitution: Coefficient of restitution e.
        strike_friction: Coefficient of friction mu in fast strikes.
        lasting_speed: m/s, the approach speed from which strikes are fast (`friction_at`).
        static_ratio: Static friction of sustained contact, relative to ``friction``.
    """

    def __init__(  # noqa: PLR0917
        self,
        name: str,
        normal: Vector3,
        level: float,
        friction: float,
        restitution: float,
        strike_friction: float,
        lasting_speed: float,
        tangents: tuple[Vector3, Vector3],
        static_ratio: float = 1.0,
    ) -> None:
        self.name, self.normal, self.level, self.tangents = name, normal, level, tangents
        self.friction, self.restitution, self.strike_friction = friction, restitution, strike_friction
        self.lasting_speed, self.static_ratio = lasting_speed, static_ratio

    def __reduce__(self) -> tuple[object, ...]:
        return Flat, (
            self.name,
            self.normal,
            self.level,
            self.friction,
            self.restitution,
            self.strike_friction,
            self.lasting_speed,
            self.tangents,
            self.static_ratio,
        )

    def friction_at(self, rate: float) -> float:
        """Return the friction in a strike at a normal velocity, m/s, which is negative for an approach."""
        if self.lasting_speed == 0.0 or -rate >= self.lasting_speed:
            return self.strike_friction
        share = max(-rate, 0.0) / self.lasting_speed
        return self.friction + share * (self.strike_friction - self.friction)

    def holding(self) -> float:
        """Return the friction of a contact that sticks."""
        return self.static_ratio * self.friction


class Solid:
    """A body in a world.

    Attributes:
        mass: kg.
        inertia: (3, 3) row by row, kg m^2, body axes.
        inverse: Its inverse.
        points: m, the corners, three numbers each, body axes.
        indices: Indices of the corners among the vertices of the body's shape.
        rounding: m, radius of the balls at the corners.
        reach: m, the distance of the farthest point of the body from its centre of mass.
        gravity: m/s^2, world axes.
        flats: The world's surfaces.
        settling: m, largest height of rebounds that are not simulated.
        above: Buffer for the heights of its corners.
        properties: Cached result of `properties_of`.
    """

    def __init__(  # noqa: PLR0917
        self,
        mass: float,
        inertia: Matrix3,
        inverse: Matrix3,
        points: array[float],
        indices: tuple[int, ...],
        rounding: float,
        gravity: Vector3,
        flats: tuple[Flat, ...],
        settling: float,
    ) -> None:
        self.mass, self.inertia, self.inverse = mass, inertia, inverse
        self.points, self.indices, self.rounding = points, indices, rounding
        self.gravity, self.flats, self.settling = gravity, flats, settling
        self.count, self.reach = len(indices), 0.0
        for k in range(self.count):
            self.reach = max(self.reach, vec.norm(self.corner(k)))
        self.reach += rounding
        self.above = Above(self.count * len(flats))
        self.properties: MassProperties | None = None

    def __reduce__(self) -> tuple[object, ...]:
        return Solid, self._parts(self.flats)

    def among(self, flats: tuple[Flat, ...]) -> Solid:
        """Return the same body among other flats."""
        return Solid(*self._parts(flats))

    def sample(self, rows: Any, i: int) -> Solid:
        """Return the body of row ``i`` and its flats (`take`)."""
        own = self.among(tuple([copy(flat) for flat in self.flats]))
        own.take(rows, i)
        return own

    def take(self, rows: Any, i: int) -> None:
        """Take the parameters of the body and the flats from row ``i``.

        Rows, (n, 18 + 3 c + 3 s), contain the inertia and its inverse, c corners, and for each of s flats the
        friction of sustained contact, the restitution, and the friction in fast strikes.
        """
        self.inertia, self.inverse = matrix_in(rows, i, 0), matrix_in(rows, i, 9)
        self.properties, self.reach, k = None, 0.0, 18 + 3 * self.count
        for j in range(3 * self.count):
            self.points[j] = rows[i, 18 + j]
        for j in range(self.count):
            self.reach = max(self.reach, vec.norm(self.corner(j)))
        self.reach += self.rounding
        for flat in self.flats:
            flat.friction, flat.restitution, flat.strike_friction = rows[i, k], rows[i, k + 1], rows[i, k + 2]
            k += 3

    def _parts(self, flats: tuple[Flat, ...]) -> Any:
        points = array("d", self.points)
        body = [self.mass, self.inertia, self.inverse, points, self.indices, self.rounding]
        return (*body, self.gravity, flats, self.settling)

    def corner(self, k: int) -> Vector3:
        """Return a corner, m, body axes."""
        return (self.points[3 * k], self.points[3 * k + 1], self.points[3 * k + 2])

    @property
    def corners(self) -> list[Vector3]:
        """The corners, m, body axes."""
        return [self.corner(k) for k in range(self.count)]


class Held:
    """A closed contact.

    Attributes:
        touch: The corner and the flat.
        slides: True if it slides. Otherwise it sticks, or rolls if it is rounded.
        towards: Unit, world axes, the direction in which sliding begins, or zero if the contact sticks.
        begins: True if it has just begun to slide, so that friction acts against ``towards``. The direction
            of its velocity is still rounding error.
    """

    def __init__(
        self,
        touch: Touch,
        slides: bool = False,  # noqa: FBT001, FBT002  C has no keywords
        towards: Vector3 = (0.0, 0.0, 0.0),
        begins: bool = False,  # noqa: FBT001, FBT002  C has no keywords
    ) -> None:
        self.touch, self.slides, self.towards, self.begins = touch, slides, towards, begins
        self.flat, self.corner = touch

    def __reduce__(self) -> tuple[object, ...]:
        return Held, (self.touch, self.slides, self.towards, self.begins)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Held) and self.__reduce__() == other.__reduce__()

    def __hash__(self) -> int:
        return hash((self.touch, self.slides, self.towards, self.begins))


class Pose:
    """The quantities that follow from the 13 numbers of a state, whose quaternion need not be unit.

    Attributes:
        solid: The body.
        position: m, the centre of mass.
        rows: R_WB, row by row.
        inverse: (3, 3) row by row, 1/(kg m^2), the inverse inertia in world axes.
        v: m/s.
        w: rad/s.
        alpha: rad/s^2, the angular acceleration in free flight (Euler's equations; lecture 25).
    """

    def __init__(self, solid: Solid) -> None:
        self.solid, self.y = solid, [0.0] * 13
        self.position = self.v = self.w = self.alpha = (0.0, 0.0, 0.0)
        self.rows: Matrix3 = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.inverse: Matrix3 = self.rows

    def take(self, y: Numbers) -> None:
        """Set the state from 13 numbers."""
        solid = self.solid
        self.position, self.v, self.w = (y[0], y[1], y[2]), (y[7], y[8], y[9]), (y[10], y[11], y[12])
        self.rows = rows_of(y[3], y[4], y[5], y[6])
        a, b, c, d, e, f, g, h, i = self.rows
        j_xx, j_xy, j_xz, _, j_yy, j_yz, _, _, j_zz = solid.inverse
        # R J R^T, by its six different entries.
        a1, a2, a3 = (
            a * j_xx + b * j_xy + c * j_xz,
            a * j_xy + b * j_yy + c * j_yz,
            a * j_xz + b * j_yz + c * j_zz,
        )
        d1, d2, d3 = (
            d * j_xx + e * j_xy + f * j_xz,
            d * j_xy + e * j_yy + f * j_yz,
            d * j_xz + e * j_yz + f * j_zz,
        )
        g1, g2, g3 = (
            g * j_xx + h * j_xy + i * j_xz,
            g * j_xy + h * j_yy + i * j_yz,
            g * j_xz + h * j_yz + i * j_zz,
        )
        xy, xz, yz = a1 * d + a2 * e + a3 * f, a1 * g + a2 * h + a3 * i, d1 * g + d2 * h + d3 * i
        xx, yy, zz = a1 * a + a2 * b + a3 * c, d1 * d + d2 * e + d3 * f, g1 * g + g2 * h + g3 * i
        self.inverse = (xx, xy, xz, xy, yy, yz, xz, yz, zz)
        w_B = vec.transposed_times(self.rows, self.w)
        torque_B = vec.cross(vec.times(solid.inertia, w_B), w_B)
        self.alpha = vec.times(self.rows, vec.times(solid.inverse, torque_B))

    def arm(self, flat: int, corner: int) -> Vector3:
        """Return the arm, m, from the centre of mass to the contact point, world axes."""
        solid = self.solid
        x, y, z = vec.times(self.rows, solid.corner(corner))
        touched = solid.flats[flat]
        a, b, c = touched.normal
        r = solid.rounding
        return (x - r * a, y - r * b, z - r * c)

    def velocity(self, arm: Vector3) -> Vector3:
        """Return the velocity, m/s, world axes, of the body at an arm."""
        turning = vec.cross(self.w, arm)
        return (self.v[0] + turning[0], self.v[1] + turning[1], self.v[2] + turning[2])

    def sliding(self, arm: Vector3, normal: Vector3, towards: Vector3) -> Vector3:
        """Return the unit direction in which the contact at an arm slides, or begins to slide."""
        velocity = self.velocity(arm)
        v_n = vec.dot(velocity, normal)
        e = SLIDING_DIRECTION_SPEED
        x = velocity[0] - v_n * normal[0] + e * towards[0]
        y = velocity[1] - v_n * normal[1] + e * towards[1]
        z = velocity[2] - v_n * normal[2] + e * towards[2]
        size = math.sqrt(x * x + y * y + z * z)
        if size == 0.0:
            return towards
        return (x / size, y / size, z / size)

    def acceleration(self, flat: int, arm: Vector3, a: Vector3, alpha: Vector3) -> Vector3:
        """Return the acceleration, m/s^2, of the contact point at an arm, which rolls if it is rounded.

        The acceleration of the centre of mass is ``a``, m/s^2, and that of the body ``alpha``, rad/s^2.
        """
        touched = self.solid.flats[flat]
        n_x, n_y, n_z = touched.normal
        w_x, w_y, w_z = self.w
        a_x, a_y, a_z = a
        t_x, t_y, t_z = alpha
        x, y, z = arm
        r = self.solid.rounding
        # alpha x arm and w x (w x corner), with u = w x corner, by component.
        p, q, s = x + r * n_x, y + r * n_y, z + r * n_z
        u_x, u_y, u_z = w_y * s - w_z * q, w_z * p - w_x * s, w_x * q - w_y * p
        return (
            a_x + (t_y * z - t_z * y) + (w_y * u_z - w_z * u_y),
            a_y + (t_z * x - t_x * z) + (w_z * u_x - w_x * u_z),
            a_z + (t_x * y - t_y * x) + (w_x * u_y - w_y * u_x),
        )

    def height(self, flat: int, corner: int) -> float:
        """Return the height, m, of a corner above a flat, or of the lowest point of its ball."""
        touched = self.solid.flats[flat]
        n, arm = touched.normal, self.arm(flat, corner)
        return vec.dot(self.position, n) + vec.dot(arm, n) - touched.level

    def kinetic_energy(self) -> float:
        """Return the kinetic energy, J."""
        solid, v_x, v_y, v_z = self.solid, self.v[0], self.v[1], self.v[2]
        w_B = vec.transposed_times(self.rows, self.w)
        turning = vec.dot(w_B, vec.times(solid.inertia, w_B))
        return 0.5 * (solid.mass * (v_x * v_x + v_y * v_y + v_z * v_z) + turning)


def solid_of(
    body: Body,
    world: World,
    *,
    indices: tuple[int, ...] | None = None,
    settling: float = SETTLING_HEIGHT,
    lasting_factors: FloatArray | None = None,
) -> Solid:
    """Return a body and a world in plain floats.

    Args:
        body: The body.
        world: Planes and gravity.
        indices: (k,), indices of the corners in results. If None, they count from 0.
        settling: m, largest height of rebounds that are not simulated.
        lasting_factors: (s,), friction of sustained contact with each surface, relative to that in strikes.
            If None or empty, the factors of the surfaces are used.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: the shape has rims, or a surface is an obstacle or has static friction alone.
        InvalidFieldError: the number of factors differs from the number of surfaces.
    """
    check_has_shape(body)
    if body.shape.rims:
        message = (
            f"body {body.name!r} must have corners or be made of balls for a whole toss, got a shape with "
            "rims: give a rim as a polygon of corners"
        )
        raise NotSupportedError(message)
    surfaces = [each for each in world.surfaces if isinstance(each, Surface)]
    for each in world.surfaces:
        if not isinstance(each, Surface):
            message = f"surface {each.name!r} must be an unbounded flat for a whole toss, got an obstacle"
            raise NotSupportedError(message)
    flats = []
    for surface, factor in zip(surfaces, factors_of(lasting_factors, surfaces).tolist(), strict=True):
        x, y, z = surface.normal_W.tolist()
        normal = (x, y, z)
        level = float(surface.p_WS_W @ surface.normal_W)
        lasting = factor * surface.friction
        e, mu, static = surface.restitution, surface.friction, surface.static_friction or surface.friction
        if mu == 0.0 and static > 0.0:
            message = (
                f"static_friction of {surface.name!r} must be 0 for a toss without friction, got {static:g}"
            )
            raise NotSupportedError(message)
        ratio = static / mu if mu > 0.0 else 1.0
        flats.append(
            Flat(surface.name, normal, level, lasting, e, mu, surface.lasting_speed, tangents(normal), ratio)
        )
    I_B = body.mass_properties.I_B
    vertices = body.shape.vertices
    g_x, g_y, g_z = world.gravity_W.tolist()
    return Solid(
        mass=body.mass_properties.mass,
        inertia=matrix_of(I_B),
        inverse=matrix_of(np.linalg.inv(I_B)),
        points=array("d", vertices.tobytes()),
        indices=tuple(range(len(vertices))) if indices is None else indices,
        rounding=body.shape.rounding,
        gravity=(g_x, g_y, g_z),
        flats=tuple(flats),
        settling=settling,
    )


def factors_of(lasting_factors: FloatArray | None, surfaces: Sequence[Surface]) -> FloatArray:
    """Return the factors of all surfaces, (s,), by default those of the surfaces themselves.

    Raises:
        InvalidFieldError: the number of factors differs from the number of surfaces.
    """
    if lasting_factors is None or len(lasting_factors) == 0:
        return np.array([surface.lasting_factor for surface in surfaces])
    if len(lasting_factors) != len(surfaces):
        allowed = f"one for each of {len(surfaces)} surfaces, or none"
        raise InvalidFieldError("lasting_factors", f"{len(lasting_factors)} numbers", allowed)
    return lasting_factors


def matrix_of(array: NDArray[np.floating[Any]]) -> Matrix3:
    """Return an array (3, 3) row by row."""
    a, b, c, d, e, f, g, h, i = array.ravel().tolist()
    return (a, b, c, d, e, f, g, h, i)


def matrix_in(rows: Any, i: int, k: int) -> Matrix3:
    """Return the matrix in row ``i`` from column ``k`` on."""
    return (
        rows[i, k], rows[i, k + 1], rows[i, k + 2],
        rows[i, k + 3], rows[i, k + 4], rows[i, k + 5],
        rows[i, k + 6], rows[i, k + 7], rows[i, k + 8],
    )  # fmt: skip


def numbers_of(state: BodyState) -> Numbers:
    """Return the 13 numbers of a state."""
    numbers: Numbers = [
        *state.p_WB_W.tolist(),
        *state.q_WB.tolist(),
        *state.v_WB_W.tolist(),
        *state.w_WB_W.tolist(),
    ]
    return numbers


def rows_of(x: float, yy: float, z: float, w: float) -> Matrix3:
    """Return R_WB, row by row, of a quaternion that need not be unit."""
    twice = 2.0 / (x * x + yy * yy + z * z + w * w)
    a, b, c = twice * x, twice * yy, twice * z
    xx, xy, xz, xw = a * x, a * yy, a * z, a * w
    sq, yz, yw = b * yy, b * z, b * w
    zz, zw = c * z, c * w
    return (
        1.0 - (sq + zz), xy - zw, xz + yw,
        xy + zw, 1.0 - (xx + zz), yz - xw,
        xz - yw, yz + xw, 1.0 - (xx + sq),
    )  # fmt: skip


def pose_of(solid: Solid, y: Numbers) -> Pose:
    """Return the pose of 13 numbers, whose quaternion need not be unit."""
    pose = Pose(solid)
    for k in range(13):
        pose.y[k] = y[k]
    pose.take(pose.y)
    return pose


def heights_and_rates(solid: Solid, y: Numbers) -> list[tuple[float, float, Touch]]:
    """Return the height, m, and its rate, m/s, of every corner above every flat."""
    above = solid.above
    for k in range(13):
        above.y[k] = y[k]
    above.take(solid, above.y)
    n = solid.count
    touches = [(flat, corner) for flat in range(len(solid.flats)) for corner in range(n)]
    return [(above.heights[k], above.rates[k], touches[k]) for k in range(len(touches))]


def low_corners(solid: Solid, y: Numbers, high: float, leaving: float) -> list[tuple[float, Touch]]:
    """Return heights and touches of corners at most ``high``, m, that rise at most at ``leaving``, m/s."""
    above = solid.above
    for k in range(13):
        above.y[k] = y[k]
    above.take(solid, above.y)
    n = solid.count
    return [
        (above.heights[n * flat + corner], (flat, corner))
        for flat in range(len(solid.flats))
        for corner in range(n)
        if above.heights[n * flat + corner] <= high and above.rates[n * flat + corner] <= leaving
    ]


def approaches(solid: Solid, y: Numbers, touching: list[Touch]) -> list[float]:
    """Return the normal velocities, m/s, of contacts, negative if they approach."""
    pose = pose_of(solid, y)
    rates = []
    for flat, corner in touching:
        touched = solid.flats[flat]
        rates.append(vec.dot(pose.velocity(pose.arm(flat, corner)), touched.normal))
    return rates


class Above:
    """The heights of all corners above all flats, flat after flat, and their rates.

    Attributes:
        count: Number of heights.
        heights: m.
        rates: m/s.
        least: m, smallest height.
    """

    def __init__(self, count: int) -> None:
        self.count = count
        self.heights = array("d", bytes(16 * self.count))
        self.rates = self.heights[self.count :]
        self.least = _INFINITE
        self.y = [0.0] * 13

    def take(self, solid: Solid, y: Numbers) -> None:
        """Compute heights and rates from 13 numbers, whose quaternion need not be unit."""
        a, b, c, d, e, f, g, h, i = rows_of(y[3], y[4], y[5], y[6])
        w_x, w_y, w_z = y[10], y[11], y[12]
        k, least = 0, _INFINITE
        for s in range(len(solid.flats)):
            flat = solid.flats[s]
            n_x, n_y, n_z = flat.normal
            # The normal n in body axes, and n x w there, since n . (w x r) = r . (n x w).
            u, v, w = a * n_x + d * n_y + g * n_z, b * n_x + e * n_y + h * n_z, c * n_x + f * n_y + i * n_z
            m_x, m_y, m_z = n_y * w_z - n_z * w_y, n_z * w_x - n_x * w_z, n_x * w_y - n_y * w_x
            p, q, r = a * m_x + d * m_y + g * m_z, b * m_x + e * m_y + h * m_z, c * m_x + f * m_y + i * m_z
            height = y[0] * n_x + y[1] * n_y + y[2] * n_z - flat.level - solid.rounding
            rate = y[7] * n_x + y[8] * n_y + y[9] * n_z
            for corner in range(solid.count):
                c_x, c_y, c_z = solid.corner(corner)
                self.heights[k] = height + u * c_x + v * c_y + w * c_z
                self.rates[k] = rate + p * c_x + q * c_y + r * c_z
                least = min(least, self.heights[k])
                k += 1
        self.least = least


def energy_of(solid: Solid, y: Numbers) -> float:
    """Return the sum of kinetic and potential energy, J, which is zero at rest at the origin."""
    return kinetic_energy_of(solid, y) - solid.mass * vec.dot(solid.gravity, (y[0], y[1], y[2]))


def kinetic_energy_of(solid: Solid, y: Numbers) -> float:
    """Return the kinetic energy, J."""
    return pose_of(solid, y).kinetic_energy()


def properties_of(solid: Solid) -> MassProperties:
    """Return mass and inertia as `MassProperties`."""
    if solid.properties is None:
        solid.properties = MassProperties(mass=solid.mass, I_B=np.array(solid.inertia).reshape(3, 3))
    return solid.properties


def state_of(y: Numbers, stamp_ns: int = 0) -> BodyState:
    """Return 13 numbers, whose quaternion is nearly unit, as a `BodyState`."""
    numbers = np.array(y)
    q = numbers[3:7].copy()
    q /= math.sqrt(float(q @ q))
    return BodyState(p_WB_W=numbers[:3], q_WB=q, v_WB_W=numbers[7:10], w_WB_W=numbers[10:], stamp_ns=stamp_ns)


def points_of(solid: Solid, y: Numbers, touching: list[Touch]) -> list[Vector3]:
    """Return the contact points, m, world."""
    pose = pose_of(solid, y)
    p_x, p_y, p_z = pose.position
    return [(p_x + x, p_y + y, p_z + z) for x, y, z in [pose.arm(*touch) for touch in touching]]


def contacts_of(solid: Solid, y: Numbers, touching: list[Touch]) -> ContactSet:
    """Return touching contacts as a `ContactSet`."""
    flats = [solid.flats[touch[0]] for touch in touching]
    grips = any(flat.static_ratio > 1.0 for flat in flats)
    return ContactSet(
        p_WC_W=np.array(points_of(solid, y, touching)),
        normals_W=np.array([flat.normal for flat in flats]),
        frictions=np.array([flat.friction for flat in flats]),
        restitutions=np.array([flat.restitution for flat in flats]),
        surfaces=[flat.name for flat in flats],
        body_curvatures=alike(len(touching), 1.0 / solid.rounding) if solid.rounding > 0.0 else None,
        static_frictions=np.array([flat.holding() for flat in flats]) if grips else None,
    )
