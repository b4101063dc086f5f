# SPDX-License-Identifier: Apache-2.0
"""What kind of rotation a free body makes, by name (lecture 25, polhodes)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from contact_dynamics.records import NamedInt
from contact_dynamics.tolerances import EQUAL_MOMENTS_TOLERANCE, STEADY_AXIS_TOLERANCE
from contact_dynamics.tumbling.polhode import Spin

if TYPE_CHECKING:
    from decimal import Decimal

    from contact_dynamics.rigid_body.inertia.principal_frame import PrincipalFrame
    from contact_dynamics.tumbling.polhode import Rotation


class Regime(NamedInt):
    """Kind of rotation, as a label. The formulas do not use it, and are also valid between the regimes."""

    UNKNOWN = 0  # a torque acts: Poinsot's picture does not apply
    AT_REST = 1  # no rotation
    SPHERICAL = 2  # three equal moments: the angular velocity is constant
    PRINCIPAL_AXIS = 3  # about a principal axis, or within rounding of the major or minor one: it is constant
    AXISYMMETRIC = 4  # two equal moments: steady precession
    ABOUT_MINOR_AXIS = 5  # the polhode encircles the axis of the smallest moment
    ABOUT_MAJOR_AXIS = 6  # the polhode encircles the axis of the largest moment
    SEPARATRIX = 7  # between the two: one flip, and an infinite period


def regime_of(frame: PrincipalFrame[Decimal], rotation: Rotation) -> Regime:
    """Return the name of a rotation. Moments within `EQUAL_MOMENTS_TOLERANCE` count as equal."""
    if isinstance(rotation, Spin) and rotation.rate == 0:
        return Regime.AT_REST
    small, middle, large = frame.moments
    equal = large * EQUAL_MOMENTS_TOLERANCE
    if large - small <= equal:
        return Regime.SPHERICAL
    if middle - small <= equal or large - middle <= equal:
        return Regime.AXISYMMETRIC
    if isinstance(rotation, Spin) or rotation.a2 <= STEADY_AXIS_TOLERANCE:
        return Regime.PRINCIPAL_AXIS
    if rotation.m1 == 0:
        return Regime.SEPARATRIX
    return Regime.ABOUT_MAJOR_AXIS if rotation.omega_p > 0 else Regime.ABOUT_MINOR_AXIS
