"""From space to a plane of motion and back: when a question is a planar one, and by how much it is not.

The plane passes through the centre of mass. Seen with its normal towards the eye and a contact's normal up,
*right* is right, so that turning the plane over swaps left and right.

A spatial problem is planar where nothing couples it to the motion out of the plane: velocities lie in the
plane, contact normals and the applied force too, and the plane's normal is a principal axis. Contacts at
different depths project onto one plane: their forces are taken to balance about the axes in the plane, as
they do where body and contacts are symmetric about it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from contact_dynamics.contact import ContactSet
from contact_dynamics.errors import OutOfPlaneError
from contact_dynamics.planar import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench, Vector2
from contact_dynamics.rigid_body import BodyState, MassProperties, cross_matrix
from contact_dynamics.tolerances import OUT_OF_PLANE_RATIO, OUT_OF_PLANE_SPEED
from contact_dynamics.validation import FloatArray, check_unit

_STEEP: Final = 0.8
"""Cosine to the world's up above which a normal counts as upright: it is then over 36 degrees off x."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PlaneOfMotion:
    """An oriented plane through the centre of mass, with axes x, y in it and z its normal.

    Raises:
        InvalidFieldError: the normal is not a unit vector of three finite numbers.
    """

    normal_W: FloatArray  # (3,), unit, world axes

    def __post_init__(self) -> None:
        """Check the normal."""
        object.__setattr__(self, "normal_W", check_unit("plane_normal", self.normal_W, 3))

    @property
    def axes_W(self) -> FloatArray:
        """Return x and y, (2, 3), world axes: y is the world's up as seen in the plane.

        Where the world's up is the normal, y is the world's x.
        """
        n_x, n_y, n_z = self.normal_W.tolist()
        along, up = (n_z, (0.0, 0.0, 1.0)) if abs(n_z) < _STEEP else (n_x, (1.0, 0.0, 0.0))
        y_x, y_y, y_z = up[0] - along * n_x, up[1] - along * n_y, up[2] - along * n_z
        length = math.sqrt(y_x * y_x + y_y * y_y + y_z * y_z)
        y_x, y_y, y_z = y_x / length, y_y / length, y_z / length
        x = (y_y * n_z - y_z * n_y, y_z * n_x - y_x * n_z, y_x * n_y - y_y * n_x)
        return np.array([x, (y_x, y_y, y_z)])

    def lift(self, vector: Vector2) -> FloatArray:
        """Return a vector of the plane, (x, y), in world axes, (3,)."""
        lifted: FloatArray = np.array(vector) @ self.axes_W
        return lifted


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarProblem:
    """A spatial problem as the plane of motion sees it."""

    plane: PlaneOfMotion
    body: PlanarBody
    velocity: PlanarVelocity
    contacts: tuple[PlanarContact, ...]
    wrench: PlanarWrench
    out_of_plane: (
        float  # m/s, the largest speed, at a contact or the centre of mass, that the plane leaves out
    )


def project(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    plane: PlaneOfMotion,
    force_W: FloatArray,
    torque_W: FloatArray,
    speed_tolerance: float = OUT_OF_PLANE_SPEED,
) -> PlanarProblem:
    """Return the problem in the plane.

    Args:
        body: mass properties.
        state: pose and velocity.
        contacts: the contacts in space.
        plane: the plane of motion.
        force_W: applied force, (3,), N, world axes, gravity included.
        torque_W: applied torque about the centre of mass, (3,), N m, world axes.
        speed_tolerance: largest speed out of the plane, m/s, that still counts as planar.

    Raises:
        OutOfPlaneError: velocity, a contact normal, the wrench or the inertia leaves the plane by more than
        its tolerance.
    """
    normal = plane.normal_W
    axes = plane.axes_W
    r_W = contacts.p_WC_W - state.p_WB_W
    out_of_plane = out_of_plane_speed(plane, state, contacts)
    if out_of_plane > speed_tolerance:
        raise OutOfPlaneError(
            "state",
            f"{out_of_plane:.6g} m/s out of the plane with normal {normal.tolist()}",
            f"at most {speed_tolerance:g} m/s",
        )
    _check_ratio("contact normals", float(np.abs(contacts.normals_W @ normal).max(initial=0.0)), plane)
    _check_ratio("inertia", _inertia_coupling(body, state, normal), plane)
    _check_ratio("applied force", _ratio(float(abs(force_W @ normal)), math.sqrt(force_W @ force_W)), plane)
    planar_body = PlanarBody(
        mass=body.mass, inertia=float(normal @ body.inertia_in_world(state.R_WB) @ normal)
    )
    torque_in_plane = torque_W - (torque_W @ normal) * normal
    torque_scale = math.sqrt(torque_W @ torque_W) + planar_body.radius_of_gyration * math.sqrt(
        force_W @ force_W
    )
    _check_ratio("applied torque", _ratio(math.sqrt(torque_in_plane @ torque_in_plane), torque_scale), plane)
    return PlanarProblem(
        plane=plane,
        body=planar_body,
        velocity=PlanarVelocity(v=_pair(axes @ state.v_WB_W), w=float(state.w_WB_W @ normal)),
        contacts=tuple(
            PlanarContact(
                r=_pair(r),
                normal=_unit_pair(n),
                friction=mu,
                restitution=e,
                body_curvature=k,
                surface_curvature=K,
            )
            for r, n, mu, e, (k, K) in zip(
                r_W @ axes.T,
                contacts.normals_W @ axes.T,
                contacts.frictions.tolist(),
                contacts.restitutions.tolist(),
                _curvatures_in(plane, contacts),
                strict=True,
            )
        ),
        wrench=PlanarWrench(f=_pair(axes @ force_W), moment=float(torque_W @ normal)),
        out_of_plane=out_of_plane,
    )


def _curvatures_in(plane: PlaneOfMotion, contacts: ContactSet) -> list[tuple[float, float]]:
    """Return the curvatures in a plane, 1/m, of the body and of the surface at each contact."""
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return [(math.inf, 0.0)] * len(contacts)
    pairs = []
    for i, normal in enumerate(contacts.normals_W):
        tangent = _normalised(cross_matrix(plane.normal_W) @ normal)
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


def out_of_plane_speed(plane: PlaneOfMotion, state: BodyState, contacts: ContactSet) -> float:
    """Return the largest speed, m/s, at contacts and centre of mass that the plane leaves out."""
    normal = plane.normal_W
    v_out = (state.v_WB_W @ normal) * normal
    w_out = state.w_WB_W - (state.w_WB_W @ normal) * normal
    r_W = np.vstack([np.zeros(3), contacts.p_WC_W - state.p_WB_W])
    left_out = v_out + r_W @ cross_matrix(w_out).T
    return math.sqrt(float(np.einsum("ij,ij->i", left_out, left_out).max()))


def best_plane(
    body: MassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    force_W: FloatArray,
    torque_W: FloatArray,
    speed_tolerance: float = OUT_OF_PLANE_SPEED,
) -> PlaneOfMotion:
    """Return a plane in which a problem is planar, or the one in which it nearly is.

    Contact normals and the applied force must lie in it. Where they leave a choice (a body on a floor), the
    candidates are normal to the rotation's axis, to the sliding motion, to the torque, to each of the body's
    principal axes and to the world's, made to contain them. The first that leaves out no motion above
    ``speed_tolerance`` (m/s) and couples no inertia beyond `OUT_OF_PLANE_RATIO` is taken; if none does, the
    one that leaves out least.

    Raises:
        OutOfPlaneError: contact normals and force span space: no plane contains them.
    """
    fixed = _orthonormal_span([*contacts.normals_W, _normalised(force_W)])
    if len(fixed) > 2:
        raise OutOfPlaneError(
            "contact normals", "normals and an applied force that span space", "vectors in a common plane"
        )
    if len(fixed) == 2:
        return PlaneOfMotion(normal_W=cross_matrix(fixed[0]) @ fixed[1])
    best: tuple[float, PlaneOfMotion] | None = None
    for seed in _axis_candidates(body, state, fixed, torque_W):
        across = seed - sum(((seed @ direction) * direction for direction in fixed), np.zeros(3))
        length = math.sqrt(across @ across)
        if length <= OUT_OF_PLANE_RATIO * math.sqrt(seed @ seed):
            continue
        plane = PlaneOfMotion(normal_W=across / length)
        speed = out_of_plane_speed(plane, state, contacts)
        coupling = _inertia_coupling(body, state, plane.normal_W)
        if speed <= speed_tolerance and coupling <= OUT_OF_PLANE_RATIO:
            return plane
        if best is None or speed < best[0]:
            best = (speed, plane)
    if best is None:  # cannot be: of the world's axes at least two are not parallel to one direction
        raise OutOfPlaneError("plane_normal", "no candidate", "an explicit normal")
    return best[1]


def _axis_candidates(
    body: MassProperties, state: BodyState, fixed: list[FloatArray], torque_W: FloatArray
) -> Iterator[FloatArray]:
    yield state.w_WB_W
    for direction in fixed:
        yield cross_matrix(direction) @ state.v_WB_W
    yield torque_W
    yield from (state.R_WB @ np.linalg.eigh(body.I_B)[1]).T
    yield from np.eye(3)


def _inertia_coupling(body: MassProperties, state: BodyState, normal_W: FloatArray) -> float:
    momentum = body.inertia_in_world(state.R_WB) @ normal_W
    along = float(momentum @ normal_W)
    across = momentum - along * normal_W
    return math.sqrt(across @ across) / along


def _check_ratio(field: str, ratio: float, plane: PlaneOfMotion) -> None:
    if ratio > OUT_OF_PLANE_RATIO:
        raise OutOfPlaneError(
            field,
            f"a part of {ratio:.6g} out of the plane with normal {plane.normal_W.tolist()}",
            f"at most {OUT_OF_PLANE_RATIO:g}",
        )


def _ratio(part: float, whole: float) -> float:
    return float(part) / whole if whole > 0.0 else 0.0


def _normalised(vector: FloatArray) -> FloatArray:
    length = math.sqrt(vector @ vector)
    return vector / length if length > 0.0 else vector


def _orthonormal_span(vectors: list[FloatArray]) -> list[FloatArray]:
    span: list[FloatArray] = []
    for vector in vectors:
        rest = vector - sum(((vector @ direction) * direction for direction in span), np.zeros(3))
        length = math.sqrt(rest @ rest)
        if length > OUT_OF_PLANE_RATIO:
            span.append(rest / length)
    return span


def _pair(vector: FloatArray) -> Vector2:
    x, y = vector.tolist()
    return (x, y)


def _unit_pair(vector: FloatArray) -> Vector2:
    x, y = vector.tolist()
    length = math.hypot(x, y)
    return (x / length, y / length)
