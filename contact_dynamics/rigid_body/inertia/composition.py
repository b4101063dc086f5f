# SPDX-License-Identifier: Apache-2.0
"""Mass distributions of particles and of several parts, which are added and subtracted (lecture 24)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.rigid_body.inertia.distribution import (
    MassDistribution,
    difference,
    inertia_of_second_moments,
    point_inertia,
)
from contact_dynamics.validation import check_array, check_magnitude

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike


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
