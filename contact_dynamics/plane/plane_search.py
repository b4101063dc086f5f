# SPDX-License-Identifier: Apache-2.0
"""Finds the plane in which a problem in space is planar, or most nearly so.

Its normal is chosen so that the letters for left and right mean the same under every load and motion: seen
with the normal towards the viewer and up as up, +x is to the right, or +y if the plane is nearer to y. In the
vertical plane halfway between +x and -y, +x is to the right. A plane that is nearly level is seen from above.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.numerics.linear_spaces import rough_span
from contact_dynamics.numerics.vectors import Vector3, cross, dot, norm, normalised, scaled, without
from contact_dynamics.plane.projection import (
    STEEP,
    PlanarProblem,
    PlaneFit,
    PlaneOfMotion,
    ProblemInFloats,
    fit_of,
    in_floats,
    projected,
    rows_of,
    three_of,
)
from contact_dynamics.tolerances import OUT_OF_PLANE_RATIO, OUT_OF_PLANE_SPEED
from contact_dynamics.validation import FloatArray, check_not_negative, check_vector3

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties


def project_onto_best_plane(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force_W: FloatArray,
    torque_W: FloatArray,
    speed_tolerance: float = OUT_OF_PLANE_SPEED,
) -> PlanarProblem:
    """Return the problem in the plane that `best_plane` finds. Arguments and errors are those of both."""
    seen = in_floats(body, state, contacts)
    return projected(
        seen, _best_fit(seen, force_W, torque_W, speed_tolerance), force_W, torque_W, speed_tolerance
    )


def best_plane(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force_W: ArrayLike,
    torque_W: ArrayLike,
    speed_tolerance: float = OUT_OF_PLANE_SPEED,
) -> PlaneOfMotion:
    """Return a plane in which a problem is planar, or the plane in which it is most nearly planar.

    Contact normals and the applied force must lie in the plane. If they leave a choice (a body on a floor),
    these planes are tried in turn, each turned such that it contains them: normal to the rotation axis; along
    the sliding motion; normal to the torque; through all contacts, if there is such a plane; normal to each
    of the body's principal axes, and to the world's. The result is the first plane out of which no speed
    exceeds ``speed_tolerance`` (m/s) and no coupling of inertia exceeds `OUT_OF_PLANE_RATIO`, or otherwise
    the plane with the smallest motion out of it.

    The sign of its normal depends neither on load nor on motion (docs/notation.md).

    Raises:
        InvalidFieldError: the wrench is not three finite numbers each, or the tolerance is negative.
        OutOfPlaneError: no plane contains all contact normals and the force.
    """
    body = body.mass_properties
    force, torque = check_vector3("force_W", force_W), check_vector3("torque_W", torque_W)
    tolerance = check_not_negative("speed_tolerance", speed_tolerance)
    return _best_fit(in_floats(body, state, contacts), force, torque, tolerance).plane


def _best_fit(
    seen: ProblemInFloats, force_W: FloatArray, torque_W: FloatArray, speed_tolerance: float
) -> PlaneFit:
    fixed = rough_span([*seen.normals_W, _normalised(three_of(force_W))], tolerance=OUT_OF_PLANE_RATIO)
    if len(fixed) > 2:
        raise OutOfPlaneError(
            "contact normals", "normals and an applied force that span space", "vectors in a common plane"
        )
    if len(fixed) == 2:
        return fit_of(seen, PlaneOfMotion(normal_W=np.array(_seen_from(cross(fixed[0], fixed[1])))))
    best: PlaneFit | None = None
    for seed in _axis_candidates(seen, fixed, three_of(torque_W)):
        across = seed
        for direction in fixed:
            across = without(across, direction)
        length = norm(across)
        if length <= OUT_OF_PLANE_RATIO * norm(seed):
            continue
        fit = fit_of(seen, PlaneOfMotion(normal_W=np.array(_seen_from(scaled(across, 1.0 / length)))))
        if fit.speed <= speed_tolerance and fit.coupling <= OUT_OF_PLANE_RATIO:
            return fit
        if best is None or fit.speed < best.speed:
            best = fit
    if best is None:  # cannot be: of the world's axes at least two are not parallel to one direction
        raise OutOfPlaneError("plane_normal", "no candidate", "an explicit normal")
    return best


def _seen_from(normal: Vector3) -> Vector3:
    """Return the unit normal of a plane, or its opposite, that points to whom the letters are meant for."""
    n_x, n_y, n_z = normal
    right_x, right_y = -n_y, n_x  # times the sine of its slope: what is to the right of whom the normal sees
    towards = right_x + right_y
    if abs(towards) <= OUT_OF_PLANE_RATIO:
        towards = right_x
    return normal if (n_z if abs(n_z) >= STEEP else towards) > 0.0 else scaled(normal, -1.0)


def _axis_candidates(seen: ProblemInFloats, fixed: list[Vector3], torque: Vector3) -> Iterator[Vector3]:
    """Yield normals of planes, which are not unit and may be zero."""
    yield seen.w_W
    for direction in fixed:
        yield cross(direction, seen.v_W)
    yield torque
    for direction in fixed:
        yield _normal_through(direction, seen.arms_W)
    yield from rows_of((seen.R_WB @ _principal_axes(seen.body)).T)
    yield from ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def _normal_through(direction: Vector3, points: list[Vector3]) -> Vector3:
    """Return the normal, not unit, of the plane of a direction and points, or zero if they span none."""
    farthest = max((cross(direction, point) for point in points), key=norm)
    size = norm(farthest)
    off = max(abs(dot(farthest, point)) for point in points)
    named = size > OUT_OF_PLANE_RATIO * max(map(norm, points)) and off <= OUT_OF_PLANE_RATIO * size * size
    return farthest if named else (0.0, 0.0, 0.0)


@lru_cache(maxsize=64)
def _principal_axes(body: MassProperties) -> FloatArray:
    axes: FloatArray = np.linalg.eigh(body.I_B)[1]
    return axes


def _normalised(vector: Vector3) -> Vector3:
    return normalised(vector) if vector != (0.0, 0.0, 0.0) else vector
