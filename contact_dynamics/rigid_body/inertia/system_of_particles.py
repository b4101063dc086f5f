"""Particles at fixed distances make a rigid body (lecture 24, "Angular inertia, part three")."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution, inertia_of_second_moments
from contact_dynamics.validation import check_array, check_magnitude

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


def particles(masses: ArrayLike, p_FP_F: ArrayLike) -> MassDistribution:
    """Return the distribution of n particles.

    Args:
        masses: (n,), kg, >= 0 and not all zero.
        p_FP_F: (n, 3), m, their places in F.

    Raises:
        InvalidFieldError: a mass is negative or all are zero, a number is not finite or beyond 1e60, the
            lengths differ.
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
