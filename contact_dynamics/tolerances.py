"""Every threshold of the project: its name, its unit, and why it has that size.

A threshold that a caller may want to change is a default here and an argument or parameter there.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Final

UNIT_LENGTH_TOLERANCE: Final = 1e-3
"""Dimensionless. A quaternion or normal whose norm is off by more is refused, not repaired.

Quaternions that went through float32 or four printed decimals are off by at most 2e-4; one that was never
normalised, or has its components in another order than expected with one missing, is off by far more.
"""

SYMMETRY_TOLERANCE: Final = 1e-9
"""Relative to the largest entry. An inertia matrix that is less symmetric than this was not meant as one."""

NEGATIVE_VARIANCE_TOLERANCE: Final = 1e-9
"""Dimensionless, of a correlation matrix, whose entries are at most 1: how negative an eigenvalue may be.
Rounding of a covariance that has no variance in some direction leaves 1e-15, of one that went through filters
some more."""

TRIANGLE_TOLERANCE: Final = 1e-6
"""Relative to the largest principal moment. I1 + I2 >= I3 holds with equality for flat bodies, and measured
or rounded moments of a flat body miss it by their last printed digit."""

VELOCITY_TOLERANCE: Final = 1e-9
"""m/s. A contact's velocity below it counts as zero where no other tolerance is asked for: far above the
rounding of velocities of up to 1e4 m/s, far below what any sensor resolves. Measured states need their noise
level instead."""

ACCELERATION_TOLERANCE: Final = 1e-9
"""Relative to the applied wrench, and what centripetal terms add to it. An acceleration or a force counts as
zero where a change of the wrench by that part of it turns its sign: far more than rounding of the input, far
less than wrenches are known to."""

DISTANCE_TOLERANCE: Final = 1e-6
"""m. A point within it of a surface touches, where no other tolerance is asked for."""

ENERGY_TOLERANCE: Final = 1e-12
"""Relative to the energy that an impact exchanges. A gain above it is a law that creates energy, not
rounding, which is some 1e-15 of the terms that energy is summed from."""

OUT_OF_PLANE_SPEED: Final = 1e-6
"""m/s. Motion out of the plane of a planar question that still counts as none, where no other tolerance is
asked for."""

OUT_OF_PLANE_RATIO: Final = 1e-2
"""Dimensionless: the sine of the angle (0.6 degrees) by which normals, forces and principal axes may lean out
of a plane of motion. Motion capture resolves 0.1 degrees. The planar answer is then wrong by a part in 1e4,
the cosine's second order."""

EQUAL_MOMENTS_TOLERANCE: Final = Decimal("1e-12")
"""Relative to the largest principal moment. Two moments within it are called equal when a rotation is named:
turning an inertia matrix into other axes in doubles parts equal moments by some 1e-16, real bodies of one
shape differ by far more. The motion itself is computed with the moments as they are."""

STEADY_AXIS_TOLERANCE: Final = Decimal("1e-24")
"""Squared angle, rad^2, between L and the major or minor axis within which spin is called steady: an angle of
1e-12 rad, well above the rounding of a quaternion and an angular velocity."""

ROW_TOLERANCE: Final = 1e-9
"""Dimensionless, on rows of unit length: the sine of the angle within which contact planes (and wrenches)
coincide, in the enumeration of modes as in their dynamics. Contact rows carry some 1e-15 of rounding, a
hundred times that for contacts far from the centre of mass; what is built from two planes that meet at 1e-5
is still right within it."""

SAME_ROWS: Final = 1e-11
"""Dimensionless, in the plane: the sine below which contact planes, and wrenches, are one where modes are
enumerated, and the part of the radius of gyration (or of the arm, if longer) and of the unit normal within
which contacts are one. Some 1e5 roundings of the input, and far below what any sensor resolves."""

CLEAR_ROWS: Final = 1e-4
"""Dimensionless: the sine above which floats tell contact planes, and wrenches, apart, to within `SAME_ROWS`.
Between the two, what is the case is found with more digits."""

LARGEST_GRIP: Final = 1e10
"""Dimensionless, in the plane: a coefficient of friction above it, or above it divided by the contact's arm
in radii of gyration, acts as that one does. They differ in forces whose normal part is less than 1e-10 of
the wrench of the tangential one, below what wrenches are known to."""

GRAZING_DEPTH: Final = 1e-9
"""m. A point that dips into a plane by less, and rises again, may be overlooked by the search for the first
contact; deeper ones never are. Far below what sensors resolve, and enough for the search not to creep."""

LARGEST_NUMBER: Final = 1e60
"""In SI units: s, rad/s, kg m^2, m, m/s, m/s^2. A motion is refused whose numbers are larger, or whose
moments of inertia are below the inverse: fourth powers and products of such numbers leave the range of
doubles. Rates below the inverse count as rest: in the age of the universe they turn nothing."""
