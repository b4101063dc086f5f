"""A body and the world's flats in plain floats, as a whole toss needs them, and the points that touch.

A *touch* is a corner of the body and a flat. If the shape is rounded, a ball rolls over the corner, and the
point that touches is below the ball's centre. The arm from the centre of mass to that point is R c - r n,
with the corner c, the radius r and the flat's normal n. It changes with w x R c alone, so the point's
acceleration is a + alpha x arm + w x (w x R c).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.curvature import alike
from contact_dynamics.contact.found import check_has_shape
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.numerics.vectors import Vector3, cross, dot, norm, tangents
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import SETTLING_HEIGHT, SLIDING_DIRECTION_SPEED
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

Matrix3: TypeAlias = tuple[Vector3, Vector3, Vector3]

Touch: TypeAlias = tuple[int, int]
"""The index of a flat among the world's surfaces, and the index of a corner of the body's shape."""

Numbers: TypeAlias = "list[float]"
"""A state of 13 numbers: position, quaternion x y z w, velocity and angular velocity, world axes, SI."""


class Flat(NamedTuple):
    """A flat of the world.

    Attributes:
        name: The name of the surface.
        normal: Unit, into the free side, world axes.
        tangents: Two unit tangents, orthogonal to each other.
        level: m, the height of the flat along its normal.
        friction: Coulomb's mu where contact lasts.
        restitution: The coefficient e.
        strike_friction: Coulomb's mu in a strike.
    """

    name: str
    normal: Vector3
    tangents: tuple[Vector3, Vector3]
    level: float
    friction: float
    restitution: float
    strike_friction: float


class Solid(NamedTuple):
    """A body in a world.

    Attributes:
        mass: kg.
        inertia: (3, 3), kg m^2, body axes.
        inverse: Its inverse.
        corners: m, body axes.
        indices: Those of the corners among the vertices of the body's shape.
        rounding: m, the radius of the ball that rolls over the corners.
        reach: m, the distance of the farthest point of the body from its centre of mass.
        gravity: m/s^2, world axes.
        flats: The world's surfaces.
        settling: m, the height of rebounds that are not followed.
    """

    mass: float
    inertia: Matrix3
    inverse: Matrix3
    corners: tuple[Vector3, ...]
    indices: tuple[int, ...]
    rounding: float
    reach: float
    gravity: Vector3
    flats: tuple[Flat, ...]
    settling: float


class Held(NamedTuple):
    """A contact that stays.

    Attributes:
        touch: The corner and the flat.
        slides: Whether it slides. If it does not, it sticks, or it rolls if it is rounded.
        towards: Unit, world axes, the direction in which sliding begins, or zero if the contact sticks.
        begins: Whether it has just begun to slide, so that friction is against ``towards``. The velocity has
            no sure direction yet, and friction against it would turn in no time.
    """

    touch: Touch
    slides: bool = False
    towards: Vector3 = (0.0, 0.0, 0.0)
    begins: bool = False


class Pose(NamedTuple):
    """What follows from 13 numbers alone.

    Attributes:
        position: m, the centre of mass.
        rows: The rows of R_WB.
        inverse: (3, 3), 1/(kg m^2), the inverse inertia in world axes.
        v: m/s.
        w: rad/s.
    """

    position: Vector3
    rows: Matrix3
    inverse: Matrix3
    v: Vector3
    w: Vector3


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
        world: Flats, and gravity.
        indices: (k,), those by which the body's corners are known. Without any, they count from 0.
        settling: m. Rebounds that are lower are not followed.
        lasting_factors: (s,), the friction of each surface where contact lasts, relative to that of its
            strikes. Without any, those of the surfaces hold.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: the shape has rims, or a surface is an obstacle.
        InvalidFieldError: there are not as many factors as surfaces.
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
        flats.append(
            Flat(
                name=surface.name,
                normal=normal,
                tangents=tangents(normal),
                level=level,
                friction=factor * surface.friction,
                restitution=surface.restitution,
                strike_friction=surface.friction,
            )
        )
    I_B = body.mass_properties.I_B
    corners = tuple((x, y, z) for x, y, z in body.shape.vertices.tolist())
    g_x, g_y, g_z = world.gravity_W.tolist()
    return Solid(
        mass=body.mass_properties.mass,
        inertia=as_rows(I_B.tolist()),
        inverse=as_rows(np.linalg.inv(I_B).tolist()),
        corners=corners,
        indices=tuple(range(len(corners))) if indices is None else indices,
        rounding=body.shape.rounding,
        reach=max(map(norm, corners)) + body.shape.rounding,
        gravity=(g_x, g_y, g_z),
        flats=tuple(flats),
        settling=settling,
    )


def factors_of(lasting_factors: FloatArray | None, surfaces: Sequence[Surface]) -> FloatArray:
    """Return the factors of all surfaces, (s,). They are those of the surfaces if none is given.

    Raises:
        InvalidFieldError: there are not as many factors as surfaces.
    """
    if lasting_factors is None or len(lasting_factors) == 0:
        return np.array([surface.lasting_factor for surface in surfaces])
    if len(lasting_factors) != len(surfaces):
        allowed = f"one for each of {len(surfaces)} surfaces, or none"
        raise InvalidFieldError("lasting_factors", f"{len(lasting_factors)} numbers", allowed)
    return lasting_factors


def as_rows(matrix: list[list[float]]) -> Matrix3:
    """Return the rows of a matrix (3, 3)."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return ((a, b, c), (d, e, f), (g, h, i))


def numbers_of(state: BodyState) -> Numbers:
    """Return the 13 numbers of a state."""
    numbers: Numbers = [
        *state.p_WB_W.tolist(),
        *state.q_WB.tolist(),
        *state.v_WB_W.tolist(),
        *state.w_WB_W.tolist(),
    ]
    return numbers


def rows_at(y: Numbers) -> Matrix3:
    """Return the rows of R_WB from 13 numbers, whose quaternion need not be unit."""
    x, yy, z, w = y[3], y[4], y[5], y[6]
    twice = 2.0 / (x * x + yy * yy + z * z + w * w)
    a, b, c = twice * x, twice * yy, twice * z
    xx, xy, xz, xw = a * x, a * yy, a * z, a * w
    sq, yz, yw = b * yy, b * z, b * w
    zz, zw = c * z, c * w
    return (
        (1.0 - (sq + zz), xy - zw, xz + yw),
        (xy + zw, 1.0 - (xx + zz), yz - xw),
        (xz - yw, yz + xw, 1.0 - (xx + sq)),
    )


def pose_of(solid: Solid, y: Numbers) -> Pose:
    """Return the pose of 13 numbers, whose quaternion need not be unit."""
    p_x, p_y, p_z, _, _, _, _, v_x, v_y, v_z, w_x, w_y, w_z = y
    rows = rows_at(y)
    (a, b, c), (d, e, f), (g, h, i) = rows
    (j_xx, j_xy, j_xz), (_, j_yy, j_yz), (_, _, j_zz) = solid.inverse
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
    inverse = (
        (a1 * a + a2 * b + a3 * c, xy, xz),
        (xy, d1 * d + d2 * e + d3 * f, yz),
        (xz, yz, g1 * g + g2 * h + g3 * i),
    )
    return Pose((p_x, p_y, p_z), rows, inverse, (v_x, v_y, v_z), (w_x, w_y, w_z))


def times(matrix: Matrix3, vector: Vector3) -> Vector3:
    """Return the product of a matrix, by rows, and a vector."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = vector
    return (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z)


def transposed_times(matrix: Matrix3, vector: Vector3) -> Vector3:
    """Return the product of a matrix's transpose and a vector."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    x, y, z = vector
    return (a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z)


def responses(
    per_mass: float, rows: list[tuple[Vector3, Vector3]], pushes: list[tuple[Vector3, Vector3]]
) -> list[list[float]]:
    """Return how much of each row's motion each push makes.

    Rows have a direction and its moment about the centre of mass, and pushes have a force and the angular
    acceleration that it causes, or an impulse and the change of angular velocity.
    """
    return [
        [per_mass * (a * x + b * y + c * z) + (d * u + e * v + f * w) for (x, y, z), (u, v, w) in pushes]
        for (a, b, c), (d, e, f) in rows
    ]


def arm_of(solid: Solid, pose: Pose, touch: Touch) -> Vector3:
    """Return the arm, m, from the centre of mass to the point that touches or would touch, world axes."""
    x, y, z = times(pose.rows, solid.corners[touch[1]])
    r, (a, b, c) = solid.rounding, solid.flats[touch[0]].normal
    return (x - r * a, y - r * b, z - r * c)


def velocity_of(pose: Pose, arm: Vector3) -> Vector3:
    """Return the velocity, m/s, world axes, of the body's point at an arm."""
    (v_x, v_y, v_z), (x, y, z) = pose.v, cross(pose.w, arm)
    return (v_x + x, v_y + y, v_z + z)


def sliding_direction(velocity: Vector3, normal: Vector3, towards: Vector3) -> Vector3:
    """Return the unit direction in which a contact slides, from its velocity, m/s."""
    v_n = dot(velocity, normal)
    e = SLIDING_DIRECTION_SPEED
    x = velocity[0] - v_n * normal[0] + e * towards[0]
    y = velocity[1] - v_n * normal[1] + e * towards[1]
    z = velocity[2] - v_n * normal[2] + e * towards[2]
    size = math.sqrt(x * x + y * y + z * z)
    return (x / size, y / size, z / size) if size > 0.0 else towards


def height_of(solid: Solid, pose: Pose, touch: Touch) -> float:
    """Return the height, m, of a corner above a flat, of its ball's lowest point if it is rounded."""
    flat, arm = solid.flats[touch[0]], arm_of(solid, pose, touch)
    return dot(pose.position, flat.normal) + dot(arm, flat.normal) - flat.level


def heights_and_rates(solid: Solid, y: Numbers) -> list[tuple[float, float, Touch]]:
    """Return the height, m, and its rate, m/s, of every corner above every flat."""
    (a, b, c), (d, e, f), (g, h, i) = rows_at(y)
    w_x, w_y, w_z = y[10], y[11], y[12]
    found = []
    for s, flat in enumerate(solid.flats):
        n_x, n_y, n_z = flat.normal
        # The normal n in body axes, and n x w there, since n . (w x r) = r . (n x w).
        u, v, w = a * n_x + d * n_y + g * n_z, b * n_x + e * n_y + h * n_z, c * n_x + f * n_y + i * n_z
        m_x, m_y, m_z = n_y * w_z - n_z * w_y, n_z * w_x - n_x * w_z, n_x * w_y - n_y * w_x
        p, q, r = a * m_x + d * m_y + g * m_z, b * m_x + e * m_y + h * m_z, c * m_x + f * m_y + i * m_z
        height = y[0] * n_x + y[1] * n_y + y[2] * n_z - flat.level - solid.rounding
        rate = y[7] * n_x + y[8] * n_y + y[9] * n_z
        found += [
            (height + u * j + v * k + w * m, rate + p * j + q * k + r * m, (s, corner))
            for corner, (j, k, m) in enumerate(solid.corners)
        ]
    return found


def energy_of(solid: Solid, y: Numbers) -> float:
    """Return the kinetic energy and that in uniform gravity together, J. It is zero at rest at the origin."""
    return kinetic_energy_of(solid, y) - solid.mass * dot(solid.gravity, (y[0], y[1], y[2]))


def kinetic_energy_of(solid: Solid, y: Numbers) -> float:
    """Return the kinetic energy, J."""
    v_x, v_y, v_z = y[7], y[8], y[9]
    w_B = transposed_times(rows_at(y), (y[10], y[11], y[12]))
    return 0.5 * (solid.mass * (v_x * v_x + v_y * v_y + v_z * v_z) + dot(w_B, times(solid.inertia, w_B)))


def properties_of(solid: Solid) -> MassProperties:
    """Return mass and inertia as questions take them."""
    return MassProperties(mass=solid.mass, I_B=solid.inertia)


def state_of(y: Numbers, stamp_ns: int = 0) -> BodyState:
    """Return 13 numbers, whose quaternion is nearly unit, as a state."""
    numbers = np.array(y)
    q = numbers[3:7].copy()
    q /= math.sqrt(float(q @ q))
    return BodyState(p_WB_W=numbers[:3], q_WB=q, v_WB_W=numbers[7:10], w_WB_W=numbers[10:], stamp_ns=stamp_ns)


def points_of(solid: Solid, y: Numbers, touching: list[Touch]) -> FloatArray:
    """Return where contacts are, (n, 3), m, world."""
    pose = pose_of(solid, y)
    arms = [arm_of(solid, pose, touch) for touch in touching]
    points: FloatArray = np.array(arms) + np.array(pose.position)
    return points


def contacts_of(solid: Solid, y: Numbers, touching: list[Touch]) -> ContactSet:
    """Return touching contacts as questions take them."""
    flats = [solid.flats[touch[0]] for touch in touching]
    return ContactSet(
        p_WC_W=points_of(solid, y, touching),
        normals_W=np.array([flat.normal for flat in flats]),
        frictions=np.array([flat.friction for flat in flats]),
        restitutions=np.array([flat.restitution for flat in flats]),
        surfaces=[flat.name for flat in flats],
        body_curvatures=alike(len(touching), 1.0 / solid.rounding) if solid.rounding > 0.0 else None,
    )
