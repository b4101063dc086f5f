# SPDX-License-Identifier: Apache-2.0
"""This file projects questions onto a plane of motion, and says by how much they are not planar.

The plane passes through the centre of mass. Look at it with its normal towards you and a contact's normal up:
then the mode letter for *right* means to your right. Turning the plane over swaps left and right. A plane
that `plane_search` finds is seen from a side that does not depend on load and motion.

A spatial problem is planar if nothing couples it to motion out of the plane. This is so if velocities,
contact normals and the applied force lie in the plane, and the plane's normal is a principal axis. Contacts
at different depths project onto one plane. Their forces are assumed to balance about the axes in the plane,
as they do if body and contacts are symmetric about it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.numerics.vectors import Vector3, cross, dot, norm, normalised, scaled, without
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench, Vector2
from contact_dynamics.records import Record, made
from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
from contact_dynamics.tolerances import OUT_OF_PLANE_RATIO, OUT_OF_PLANE_SPEED
from contact_dynamics.validation import (
    FloatArray,
    check_at_rest,
    check_not_negative,
    check_unit,
    check_vector3,
)

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

STEEP: Final = 0.8
"""Cosine to the world's up above which a normal counts as upright. It is then over 36 degrees off x."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlaneOfMotion(Record):
    """An oriented plane through the centre of mass, with axes x, y in it and z its normal.

    Attributes:
        normal_W: (3,), unit, world axes.
        axes_W: (2, 3), unit, the plane's x and y in world axes, which follow from the normal.

    Raises:
        InvalidFieldError: the normal is not a unit vector of three finite numbers.
    """

    normal_W: FloatArray
    # x and y, (2, 3), world axes: y is the world's up as seen in the plane; its x where up is the normal
    axes_W: FloatArray = field(init=False)

    if TYPE_CHECKING:

        def __init__(self, *, normal_W: ArrayLike) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check the normal, and complete the axes."""
        object.__setattr__(self, "normal_W", check_unit("normal_W", self.normal_W, 3))
        normal = three_of(self.normal_W)
        y = normalised(without((0.0, 0.0, 1.0) if abs(normal[2]) < STEEP else (1.0, 0.0, 0.0), normal))
        axes = np.array((cross(y, normal), y))
        axes.flags.writeable = False
        object.__setattr__(self, "axes_W", axes)

    def lift(self, vector: Vector2) -> FloatArray:
        """Return a vector of the plane, (x, y), in world axes, (3,)."""
        lifted: FloatArray = np.array(vector) @ self.axes_W
        return lifted


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarProblem(Record):
    """The projection of a spatial problem onto the plane of motion.

    Attributes:
        plane: The plane of motion.
        body: The body's mass, and its angular inertia about the plane's normal.
        velocity: Its velocity in the plane.
        contacts: Its contacts in the plane, in their order.
        wrench: The applied wrench in the plane.
        out_of_plane: The largest speed out of the plane, at a contact or the centre of mass, m/s.
    """

    plane: PlaneOfMotion
    body: PlanarBody
    velocity: PlanarVelocity
    contacts: tuple[PlanarContact, ...]
    wrench: PlanarWrench
    out_of_plane: (
        float  # m/s, the largest speed, at a contact or the centre of mass, that the plane leaves out
    )


def project_onto_plane(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    plane: PlaneOfMotion,
    force_W: ArrayLike,
    torque_W: ArrayLike,
    speed_tolerance: float = OUT_OF_PLANE_SPEED,
) -> PlanarProblem:
    """Return the problem in the plane.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: pose and velocity.
        contacts: the contacts in space.
        plane: the plane of motion.
        force_W: applied force, (3,), N, world axes, gravity included.
        torque_W: applied torque about the centre of mass, (3,), N m, world axes.
        speed_tolerance: largest speed out of the plane, m/s, that still counts as planar.

    Raises:
        InvalidFieldError: the wrench is not three finite numbers each, or the tolerance is negative.
        OutOfPlaneError: velocity, a contact normal, the wrench or the inertia leaves the plane by more than
            its tolerance.
    """
    body = body.mass_properties
    seen = in_floats(body, state, contacts)
    force, torque = check_vector3("force_W", force_W), check_vector3("torque_W", torque_W)
    tolerance = check_not_negative("speed_tolerance", speed_tolerance)
    return projected(seen, fit_of(seen, plane), force, torque, tolerance)


class ProblemInFloats(NamedTuple):
    """A problem in space, in plain floats where these are faster."""

    body: MassProperties
    R_WB: FloatArray
    v_W: Vector3
    w_W: Vector3
    contacts: ContactSet
    arms_W: list[Vector3]  # from the centre of mass to the contacts
    normals_W: list[Vector3]


class PlaneFit(NamedTuple):
    """A plane, and how well a problem fits into it."""

    plane: PlaneOfMotion
    normal_W: Vector3
    speed: float  # m/s, the largest out of the plane
    inertia: float  # kg m^2, about the plane's normal
    coupling: float  # the ratio of angular momentum across the normal to that along it


def in_floats(body: MassProperties, state: BodyState, contacts: ContactSet) -> ProblemInFloats:
    """Return a problem in plain floats."""
    check_at_rest("contacts", contacts, "a plane of motion")
    return ProblemInFloats(
        body=body,
        R_WB=state.R_WB,
        v_W=three_of(state.v_WB_W),
        w_W=three_of(state.w_WB_W),
        contacts=contacts,
        arms_W=rows_of(contacts.p_WC_W - state.p_WB_W),
        normals_W=rows_of(contacts.normals_W),
    )


def fit_of(seen: ProblemInFloats, plane: PlaneOfMotion) -> PlaneFit:
    """Return how well a problem fits into a plane."""
    normal = three_of(plane.normal_W)
    speed = _speed_out_of(normal, seen.v_W, seen.w_W, seen.arms_W)
    return PlaneFit(plane, normal, speed, *_inertia_about(seen.body, seen.R_WB, normal))


def projected(
    seen: ProblemInFloats, fit: PlaneFit, force_W: FloatArray, torque_W: FloatArray, speed_tolerance: float
) -> PlanarProblem:
    """Return the problem in the plane that it was fitted into; see `project_onto_plane`."""
    plane, normal, out_of_plane, inertia, coupling = fit
    x, y = (three_of(axis) for axis in plane.axes_W)
    force, torque = three_of(force_W), three_of(torque_W)
    body, contacts, normals = seen.body, seen.contacts, seen.normals_W

    def in_plane(vector: Vector3) -> Vector2:
        return (dot(x, vector), dot(y, vector))

    if out_of_plane > speed_tolerance:
        raise OutOfPlaneError(
            "state",
            f"{out_of_plane:.6g} m/s out of the plane with normal {plane.normal_W.tolist()}",
            f"at most {speed_tolerance:g} m/s",
        )
    _check_ratio("contact normals", max((abs(dot(n, normal)) for n in normals), default=0.0), plane)
    _check_ratio("inertia", coupling, plane)
    _check_ratio("applied force", _ratio(abs(dot(force, normal)), norm(force)), plane)
    planar_body = made(PlanarBody, body.mass, inertia)  # both are checked, as the wrench is
    torque_scale = norm(torque) + planar_body.radius_of_gyration * norm(force)
    _check_ratio("applied torque", _ratio(norm(without(torque, normal)), torque_scale), plane)
    return PlanarProblem(
        plane=plane,
        body=planar_body,
        velocity=PlanarVelocity(v=in_plane(seen.v_W), w=dot(seen.w_W, normal)),
        contacts=tuple(
            PlanarContact(
                r=in_plane(r),
                normal=_unit(in_plane(n)),
                friction=mu,
                restitution=e,
                body_curvature=k_B,
                surface_curvature=k_S,
                static_friction=static,
            )
            for r, n, mu, e, static, (k_B, k_S) in zip(
                seen.arms_W,
                normals,
                contacts.frictions.tolist(),
                *(
                    [None] * len(contacts) if values is None else values.tolist()
                    for values in (contacts.restitutions, contacts.static_frictions)
                ),
                _curvatures_in(plane, contacts),
                strict=True,
            )
        ),
        wrench=made(PlanarWrench, in_plane(force), dot(torque, normal)),
        out_of_plane=out_of_plane,
    )


def _curvatures_in(plane: PlaneOfMotion, contacts: ContactSet) -> list[tuple[float, float]]:
    """Return the curvatures in a plane, 1/m, of the body and of the surface at each contact."""
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return [(math.inf, 0.0)] * len(contacts)
    pairs = []
    for i, normal in enumerate(contacts.normals_W):
        tangent = np.cross(plane.normal_W, normal)
        tangent /= math.sqrt(tangent @ tangent)
        sides = []
        for name, curvatures, default in (
            ("body_curvatures", contacts.body_curvatures, math.inf),
            ("surface_curvatures", contacts.surface_curvatures, 0.0),
        ):
            found = default if curvatures is None else curvatures.in_direction(i, tangent)
            if found is None:
                raise OutOfPlaneError(
                    f"contacts.{name}[{i}]", "a principal direction at an angle to the plane", "one within it"
                )
            sides.append(found)
        pairs.append((sides[0], sides[1]))
    return pairs


def _speed_out_of(normal: Vector3, v_W: Vector3, w_W: Vector3, arms: list[Vector3]) -> float:
    w = without(w_W, normal)
    v = scaled(normal, dot(v_W, normal))
    fastest = norm(v)
    if w == (0.0, 0.0, 0.0):
        return fastest
    for r in arms:
        turning = cross(w, r)
        fastest = max(fastest, norm((v[0] + turning[0], v[1] + turning[1], v[2] + turning[2])))
    return fastest


def _inertia_about(body: MassProperties, R_WB: FloatArray, normal_W: Vector3) -> tuple[float, float]:
    """Return the inertia about an axis, and the ratio of angular momentum across it to that along it."""
    axis_B = np.array(normal_W) @ R_WB
    momentum, axis = three_of(body.I_B @ axis_B), three_of(axis_B)
    along = dot(momentum, axis)
    return along, norm(without(momentum, axis)) / along


def _check_ratio(field: str, ratio: float, plane: PlaneOfMotion) -> None:
    if ratio > OUT_OF_PLANE_RATIO:
        raise OutOfPlaneError(
            field,
            f"a part of {ratio:.6g} out of the plane with normal {plane.normal_W.tolist()}",
            f"at most {OUT_OF_PLANE_RATIO:g}",
        )


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else 0.0


def three_of(vector: FloatArray) -> Vector3:
    """Return a vector, (3,), in plain floats."""
    x, y, z = vector.tolist()
    return (x, y, z)


def rows_of(vectors: FloatArray) -> list[Vector3]:
    """Return vectors, (n, 3), in plain floats."""
    return [(x, y, z) for x, y, z in vectors.tolist()]


def _unit(vector: Vector2) -> Vector2:
    x, y = vector
    length = math.hypot(x, y)
    return (x / length, y / length)
