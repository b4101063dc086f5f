# SPDX-License-Identifier: Apache-2.0
"""A mass distribution has a mass, a centre and an angular inertia in a frame (Mason, lectures 24 and 25).

Shapes are turned into a `MassDistribution`, and several of these can be combined. It may also be a point or a
line, whose inertia no rigid body has. Its `mass_properties` are what dynamics needs.

Frames: F is any frame fixed to the mass. B has F's axes and its origin at the centre of mass.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import MassProperties, check_symmetric
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tolerances import SUM_ROUNDING, TRIANGLE_TOLERANCE
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_positive,
    check_size,
    check_unit,
    check_vector3,
)
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MassDistribution(Record):
    """Rigid distribution of mass in a frame F.

    Attributes:
        mass: kg, > 0.
        p_FB_F: (3,), m, centre of mass, F's axes.
        I_B: (3, 3), kg m^2, about the centre of mass, F's axes.

    Raises:
        InvalidFieldError: the mass is not > 0, a number is not finite, the centre is beyond `LARGEST_NUMBER`,
            or no distribution of mass has the inertia: it is not symmetric, or its principal moments violate
            I1 + I2 >= I3.
    """

    mass: float
    p_FB_F: FloatArray
    I_B: FloatArray

    HINT_IF_WRONG: ClassVar[str] = (
        ', which Body.of("name", it, shape_F=...) takes with its centre of mass, and whose mass_properties '
        "are about that centre"
    )

    def __post_init__(self) -> None:
        """Check all fields."""
        object.__setattr__(self, "mass", check_positive("mass", self.mass))
        object.__setattr__(self, "p_FB_F", check_vector3("p_FB_F", self.p_FB_F))
        object.__setattr__(self, "I_B", _check_inertia("I_B", self.I_B))

    @classmethod
    @checks_types
    def of(cls, mass_properties: MassProperties, p_FB_F: ArrayLike = (0.0, 0.0, 0.0)) -> MassDistribution:
        """Return the distribution of a body whose centre of mass is at ``p_FB_F``, (3,), m."""
        return cls(mass=mass_properties.mass, p_FB_F=np.asarray(p_FB_F), I_B=mass_properties.I_B)

    @classmethod
    def from_inertia_about(
        cls, p_FQ_F: ArrayLike, I_Q: ArrayLike, *, mass: float, p_FB_F: ArrayLike
    ) -> MassDistribution:
        """Return the distribution whose inertia about a point Q is known, by the parallel-axis theorem.

        Args:
            p_FQ_F: (3,), m, the point.
            I_Q: (3, 3), kg m^2, angular inertia about it, F's axes.
            mass: kg.
            p_FB_F: (3,), m, centre of mass.

        Raises:
            InvalidFieldError: as in the class, and if the inertia is too small for a centre so far from Q.
        """
        mass = check_positive("mass", mass)
        center = check_vector3("p_FB_F", p_FB_F)
        arm = center - check_vector3("p_FQ_F", p_FQ_F)
        about = check_symmetric("I_Q", I_Q)
        I_B = difference(about, mass * point_inertia(arm), terms=float(np.abs(about).max()))
        try:
            return cls(mass=mass, p_FB_F=center, I_B=I_B)
        except InvalidFieldError as error:
            found = f"one that leaves {error.found} about the centre of mass"
            allowed = "inertia that a mass has whose centre (p_FB_F) is so far from the point (p_FQ_F)"
            raise InvalidFieldError("I_Q", found, allowed) from None

    @property
    def mass_properties(self) -> MassProperties:
        """The mass properties of a body with this mass, about the centre of mass.

        Raises:
            InvalidFieldError: the mass is a point or lies on a line, so it has no inertia about some axis.
        """
        return MassProperties(mass=self.mass, I_B=self.I_B)

    def placed(
        self, *, p_GF_G: ArrayLike = (0.0, 0.0, 0.0), q_GF: ArrayLike = (0.0, 0.0, 0.0, 1.0)
    ) -> MassDistribution:
        """Return the same mass in a frame G in which F has the given pose (lecture 25, eq. 11).

        Args:
            p_GF_G: (3,), m, F's origin in G.
            q_GF: (4,), unit quaternion x, y, z, w: F's coordinates into G's.

        Raises:
            InvalidFieldError: a number is not finite, or the quaternion is not unit.
        """
        R_GF = rotation_matrix(check_unit("q_GF", q_GF, 4))
        origin = check_vector3("p_GF_G", p_GF_G)
        return MassDistribution(
            mass=self.mass, p_FB_F=origin + R_GF @ self.p_FB_F, I_B=_symmetric(R_GF @ self.I_B @ R_GF.T)
        )

    def mirrored(self, normal_F: ArrayLike) -> MassDistribution:
        """Return the mirror image in the plane through F's origin with the given unit normal, (3,)."""
        normal = check_unit("normal_F", normal_F, 3)
        M = np.eye(3) - 2.0 * np.outer(normal, normal)
        return MassDistribution(mass=self.mass, p_FB_F=M @ self.p_FB_F, I_B=_symmetric(M @ self.I_B @ M.T))

    def with_mass(self, mass: float) -> MassDistribution:
        """Return the same shape with another mass, kg, such as a measured one."""
        mass = check_size("mass", mass)
        return MassDistribution(mass=mass, p_FB_F=self.p_FB_F, I_B=self.I_B * (mass / self.mass))

    def inertia_about(self, p_FQ_F: ArrayLike) -> FloatArray:
        """Return the angular inertia, (3, 3), kg m^2, about a point Q, F's axes (parallel axes)."""
        arm = self.p_FB_F - check_vector3("p_FQ_F", p_FQ_F)
        about: FloatArray = self.I_B + self.mass * point_inertia(arm)
        return about

    def angular_inertia_about(self, axis_F: ArrayLike, *, p_FQ_F: ArrayLike | None = None) -> float:
        """Return the scalar angular inertia, kg m^2, about a line (lecture 25, eq. 12).

        Args:
            axis_F: (3,), unit, the line's direction.
            p_FQ_F: (3,), m, a point of the line. The default is the centre of mass.
        """
        axis = check_unit("axis_F", axis_F, 3)
        about_center = max(
            float(axis @ self.I_B @ axis), 0.0
        )  # a line about itself has 0, or rounding below it
        if p_FQ_F is None:
            return about_center
        lever = np.cross(axis, self.p_FB_F - check_vector3("p_FQ_F", p_FQ_F))
        return about_center + self.mass * float(lever @ lever)

    def radius_of_gyration(self, axis_F: ArrayLike, *, p_FQ_F: ArrayLike | None = None) -> float:
        """Return k in I_n = m k^2, m, about the line of `angular_inertia_about` (lecture 25, eq. 13)."""
        return math.sqrt(self.angular_inertia_about(axis_F, p_FQ_F=p_FQ_F) / self.mass)


def point_inertia(arm: FloatArray) -> FloatArray:
    """Return |x|^2 1 - x x^T, (3, 3), m^2, of a particle of unit mass at ``arm``, (3,), m (lecture 24)."""
    return inertia_of_second_moments(np.outer(arm, arm))


def inertia_of_second_moments(second: FloatArray) -> FloatArray:
    """Return the inertia tr(S) 1 - S, (3, 3), kg m^2, of S = integral of x x^T dm (lecture 25, eq. 4)."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = second.tolist()
    xy, xz, yz = 0.0 - xy, 0.0 - xz, 0.0 - yz  # never -0.0
    # Summed entry by entry: tr(S) - S_zz would lose a thin body's small moment.
    return np.array([[yy + zz, xy, xz], [xy, xx + zz, yz], [xz, yz, xx + yy]])


def difference(minuend: FloatArray, subtrahend: FloatArray, *, terms: float) -> FloatArray:
    """Return the difference of two inertias, (3, 3), kg m^2, corrected where rounding makes it impossible.

    If a point or a line is left, the difference may be rounding alone and have I1 + I2 < I3. If that is
    within the rounding of its ``terms``, kg m^2, the nearest possible inertia is returned.
    """
    inertia: FloatArray = minuend - subtrahend
    half_trace = 0.5 * float(np.trace(inertia))
    spreads, axes = np.linalg.eigh(half_trace * np.eye(3) - _symmetric(inertia))  # integrals of x^2, y^2, z^2
    if not -SUM_ROUNDING * terms <= spreads[0] < 0.0:
        return inertia
    return inertia_of_second_moments(_symmetric((axes * np.maximum(spreads, 0.0)) @ axes.T))


def _symmetric(matrix: FloatArray) -> FloatArray:
    return 0.5 * (matrix + matrix.T)


def _check_inertia(field: str, value: ArrayLike) -> FloatArray:
    """Return the matrix if a mass can have it. I1 + I2 >= I3 >= I2 also makes every moment >= 0."""
    inertia = check_symmetric(field, value)
    moments = np.linalg.eigvalsh(inertia)
    if moments[0] + moments[1] < moments[2] - TRIANGLE_TOLERANCE * abs(moments[2]):
        raise InvalidFieldError(
            field, f"principal moments {moments.tolist()}", "moments that a mass can have (I1 + I2 >= I3)"
        )
    return inertia


def combined(parts: Iterable[MassDistribution]) -> MassDistribution:
    """Return all parts as one rigid mass.

    All parts are in the same frame F; `MassDistribution.placed` converts them to it. If parts overlap, the
    mass of the overlap counts twice.

    Raises:
        InvalidFieldError: there is no part.
    """
    parts = list(parts)
    if not parts:
        raise InvalidFieldError("parts", "none", "at least one")
    mass = sum(part.mass for part in parts)
    origin = parts[0].p_FB_F  # measured from a part, so that a far frame costs no digits
    offsets = [part.p_FB_F - origin for part in parts]
    center = sum(
        (part.mass / mass * offset for part, offset in zip(parts, offsets, strict=True)), np.zeros(3)
    )
    inertia = np.zeros((3, 3))
    for part, offset in zip(parts, offsets, strict=True):
        inertia += part.I_B + part.mass * point_inertia(offset - center)
    return MassDistribution(mass=mass, p_FB_F=origin + center, I_B=inertia)


def without(whole: MassDistribution, part: MassDistribution) -> MassDistribution:
    """Return ``whole`` without ``part``, such as a bore, in the same frame F.

    Raises:
        InvalidFieldError: the part is not lighter than the whole, or no mass has the remaining inertia,
            because the part is not inside the whole.
    """
    mass = whole.mass - part.mass
    if mass <= 0.0:
        raise InvalidFieldError("part", f"mass {part.mass:g} kg", f"less than the whole's {whole.mass:g} kg")
    to_part = part.p_FB_F - whole.p_FB_F
    apart = whole.mass * part.mass / mass * point_inertia(to_part)
    rounding = whole.mass / mass * float(np.trace(whole.I_B) + np.trace(part.I_B) + np.trace(apart))
    try:
        return MassDistribution(
            mass=mass,
            p_FB_F=whole.p_FB_F - part.mass / mass * to_part,
            I_B=difference(whole.I_B, part.I_B + apart, terms=rounding),
        )
    except InvalidFieldError as error:
        raise InvalidFieldError(
            "part", f"one that leaves {error.found}", "a part that lies within the whole"
        ) from None


def particles(masses: ArrayLike, p_FP_F: ArrayLike) -> MassDistribution:
    """Return the distribution of n particles.

    Args:
        masses: (n,), kg, >= 0 and not all zero.
        p_FP_F: (n, 3), m, positions in F.

    Raises:
        InvalidFieldError: a mass is negative, all masses are zero, a number is not finite or exceeds 1e60, or
            the lengths differ.
    """
    m = check_magnitude("masses", check_array("masses", masses, (None,)))
    points = check_magnitude("p_FP_F", check_array("p_FP_F", p_FP_F, (len(m), 3)))
    if (m < 0.0).any():
        raise InvalidFieldError("masses", float(m.min()), "numbers >= 0")
    total = float(m.sum())
    if total <= 0.0:
        raise InvalidFieldError("masses", m.tolist(), "at least one number > 0")
    origin = points[int(m.argmax())]  # measured from a particle, so that a far frame costs no digits
    arms = points - origin
    center = m @ arms / total
    arms = arms - center
    return MassDistribution(
        mass=total, p_FB_F=origin + center, I_B=inertia_of_second_moments((arms * m[:, None]).T @ arms)
    )
