# SPDX-License-Identifier: Apache-2.0
"""All numerical thresholds of the physics, by chapter, each with its unit and the reason for its size.

A threshold decides whether a number counts as zero, whether two things count as equal, or whether an
iteration has converged. All thresholds up to 0.01 are in this file, and a test over the sources enforces
this. A threshold that a caller may want to change is a default here and an argument or parameter elsewhere.

Some numbers are beside the code that uses them instead: limits on work and size (`MAX_...`), chunk sizes of
computations (`CHUNK`, `PIECE`), fractions and angles above 0.01 that only choose between two methods with the
same result, and the precision of each number type (`numerics.arithmetic`).
"""

from __future__ import annotations

from decimal import Decimal
from typing import Final

# input

UNIT_LENGTH_TOLERANCE: Final = 1e-3
"""Dimensionless. A quaternion or normal whose norm differs from 1 by more is rejected, not normalised.

Quaternions converted to float32 or printed with four decimals are off by at most 2e-4. A quaternion that was
never normalised, or that lacks a component, is off by far more.
"""

LENGTH_ROUNDING: Final = 1e-15
"""Dimensionless. A vector whose length is 1 within this is not normalised again, so that normalisation is
idempotent."""

SQUARES_UNDERFLOW: Final = 1e-140
"""Any unit. The length of a shorter vector is not computed from squares, which lose digits below 1e-154."""

LARGEST_NUMBER: Final = 1e60
"""In SI units: s, rad/s, kg m^2, m, m/s, m/s^2. A motion is rejected if its numbers are larger, or if its
moments of inertia are below the inverse, because fourth powers and products of such numbers overflow or
underflow in doubles. Rates below the inverse count as rest: such a body does not turn in the age of the
universe."""

MANGLED: Final = 2.0**-1042
"""Any unit. rclpy without type checks sends an int or a float32 as its 32 bits in the low half of a double's
64, which is a positive number below this. Measured numbers are zero or far larger. Only a velocity that a
simulation damps indefinitely may become as small, with either sign."""

# display

SHOWN_AS_ZERO: Final = 1e-12
"""Relative to the largest number of an array. Smaller numbers are rounding errors and are printed as 0."""

# contacts given by the caller

FAR_CONTACT: Final = 0.01
"""Relative to the reach of a body's shape. A contact further outside, or a body deeper in a surface, is a
mistake, not noise."""

MOVES_INTO: Final = 1e-6
"""Relative to the largest speed of a body's contact points. After an impact, points that approach a surface
faster were not among its contacts: impacts leave at most a thousandth of this."""

# the largest load

SAME_FACTOR: Final = 1e-9
"""Relative. Load factors that differ by less count as equal."""

STRAIGHT_ARC: Final = 1e-4
"""rad. A wrench that turns by less deviates from a straight path by about 1e-9 of its size."""

NEXT_TO_A_LIMIT: Final = 1e-6
"""Relative. Distance from the largest load factor at which the modes below and above it are evaluated."""

ONLY_REST_WITHIN: Final = 0.01
"""Relative accuracy of the smaller load factor up to which rest is the only consistent mode."""

ANY_LOAD: Final = 1e12
"""Relative to the wrench without the load. A load of this size represents all larger ones."""

NO_LOAD: Final = 1e-18
"""Relative to the largest load, or to `ANY_LOAD`. A load of this size represents all smaller ones."""

# numerics

SMALL_SHARE: Final = 1e-10
"""Relative to the sum of squared residuals of a fit. The iteration ends when it reduces the sum by less, or
when the next iteration would, by extrapolation of the convergence rate. Another iteration would change the
parameters by about 1e-5 of their standard deviations at most."""

NO_PIVOT: Final = 1e-11
"""Relative to the largest entry of a column in Lemke's method. A smaller entry is rounding and no pivot."""

COVERED: Final = 1e-12
"""Relative to the largest of q in Lemke's method. A covering variable of this size counts as zero."""

WRENCH_ROUNDING: Final = 1e-13
"""Relative to the wrench that contact forces balance. A residual up to this is rounding error."""

NEAREST_SUM_ROUNDING: Final = 1e-9
"""Relative to the terms of a non-negative least-squares sum. SciPy's rounding error is about 1e-13. Where
SciPy 1.15 returns a wrong solution, its error exceeds 1e-3."""

INDEPENDENT_FORCES: Final = 1e-12
"""Ratio of singular values. Below it, directions of contact forces count as linearly dependent."""

DECIMALS_ZERO: Final = Decimal("1e-60")
"""Relative. Bound on the rounding error of a zero in decimals of `DECIMALS.sums`, even after nested
products."""

TARGET_ROUNDING: Final = Decimal("1e-14")
"""Relative rounding error of the target itself. Columns that differ by no more would need huge coefficients
to reach it."""

DECIMALS_MET: Final = Decimal("1e-30")
"""Relative. A target counts as reached exactly if the residual is no larger."""

# evaluation

LANDING_GAP: Final = 0.015
"""m. A flight that ends with the body this close to a surface ended by landing on it. Tracked poses and
shapes have errors of some millimetres, a body at 2 m/s advances by 13 mm between two frames at 150 Hz, and a
hand that catches the body is farther from the floor."""

TOUCHING_GAP: Final = 0.003
"""m. A point of a resting or sliding body that is this close to a surface touches it. This is the combined
error of tracked pose, shape and surface."""

SAME_COEFFICIENT: Final = 1e-5
"""Relative: coefficients of restitution or friction that differ by less are one, where one is sought that
explains a measured impact."""

IMPACT_SPAN: Final = 0.04
"""s. A flight that begins this soon after the end of the previous one is separated from it by one impact, at
one or several corners. Longer intervals without flight are mostly sliding or rocking."""

SHARP_VELOCITY: Final = 0.15
"""m/s, and rad/s times the radius of gyration. An impact is excluded from the comparison if the velocities
before or after it have larger standard deviations. Velocities change by 1 m/s and more."""

MODE_SPAN: Final = 0.05
"""s. Length of the windows in which a contact mode is identified. It is short because recordings end soon
after a body stops, but longer than a bounce of 2 mm."""

MODE_SPEED: Final = 0.02
"""m/s. A contact point that is slower over `MODE_SPAN` does not slide: friction of 0.2 ends such a slide in
10 ms. The noise of the window's velocity is added to this."""

LEAST_POSITION_NOISE: Final = 1e-6
"""m. Lower bound on the estimated noise, since no tracker is more accurate. Where the poses of a body at rest
are identical to the bit, their scatter does not show the noise of the other poses."""

LEAST_ORIENTATION_NOISE: Final = 1e-6
"""rad. Equivalent to `LEAST_POSITION_NOISE` at a distance of 1 m."""

SAME_EVENT: Final = 0.01
"""s. Events of one kind that two versions of the code detect in one recording are the same if they are this
close."""

HOLD_STEP: Final = 1e-3
"""s. Step of the motion about a corner that remains in contact, in the evaluation of successive strikes. In
one step a corner at 1 m/s moves by 1 mm, which is within the error of tracked poses and shapes."""

# rigid_body

SYMMETRY_TOLERANCE: Final = 1e-9
"""Relative to the largest entry. A matrix that is less symmetric than this is not an inertia matrix."""

NEGATIVE_VARIANCE_TOLERANCE: Final = 1e-9
"""Dimensionless. An eigenvalue of a correlation matrix may be this negative. If a covariance has no variance
in some direction, rounding leaves 1e-15, and more after a filter."""

TRIANGLE_TOLERANCE: Final = 1e-6
"""Relative to the largest principal moment. I1 + I2 >= I3 holds with equality for flat bodies, and measured
or rounded moments of a flat body miss it by their last printed digit."""

EQUAL_MOMENTS_TOLERANCE: Final = Decimal("1e-12")
"""Relative to the largest principal moment. Two moments within it count as equal when a rotation is
classified. Rotating an inertia matrix in doubles separates equal moments by about 1e-16, and real bodies of
one shape differ by far more. The motion itself is computed with the given moments."""

SUM_ROUNDING: Final = 1e-14
"""Relative to the largest term of a sum, whose rounding error is more than ten times smaller. A difference up
to this counts as zero."""

VOLUME_ROUNDING: Final = 1e-13
"""Relative to a surface's area times its size, m^3. A smaller volume is rounding error of a flat surface."""

DENSEST: Final = 30_000.0
"""kg/m^3. Osmium, the densest material, has 22,590. A file with a denser body uses other units."""

THINNEST: Final = 1.0
"""kg/m^3, about the density of air. The mean density of a body's bounding box is hardly lower."""

SURFACES_TOUCH: Final = 1e-9
"""Relative to a part's size. Surfaces closer than this touch, without a gap."""

EPSILON: Final = 2.0**-52
"""Relative rounding of coordinates. Points within it of a plane count as in the plane. It also determines the
rounding error of a volume far from the origin."""

AXIS_TIE: Final = 1e-9
"""Dimensionless. The largest component of a unit axis decides its sign, and components within this count as
equal. It is far above the rounding of, say, (1, 1, 0) / sqrt(2)."""

EXACTLY_EQUAL_MOMENTS: Final = Decimal("1e-110")
"""Relative to the largest moment. Moments closer than this are equal in the tumbling formulas too: Jacobi's
rotations leave this much in 120 digits."""

# tumbling

STEADY_AXIS_TOLERANCE: Final = Decimal("1e-24")
"""Squared angle, rad^2, between the angular momentum and the major or minor axis. Below it the spin counts as
steady. The angle is 1e-12 rad, well above the rounding of a quaternion and an angular velocity."""

NEGLIGIBLE_TERM: Final = 1e-18
"""Relative to the largest term of a sum of theta functions. Smaller terms are omitted, since they are far
below the last bit."""

SMALLEST: Final = 1e-300
"""In any unit. It replaces zero where a quotient or a logarithm would otherwise fail. Added to a divisor, it
makes 0/0 equal 0 where that is the right limit."""

SEPARATRIX_END: Final = 1e-6
"""rad. Distance from the ends of Jacobi's amplitude at which the polhode of a single flip is truncated. The
motion is this close to spin about the middle axis 14 time constants before and after its flip."""

SMALLEST_COMPLEMENT: Final = 1e-100
"""Value of 1 - m, the complement of the parameter. Below it the sensitivity of a tumbling body is beyond 1e90
and is given as infinite."""

MOTIONLESS: Final = 1e-60
"""Squared angle, rad^2, between the angular velocity and the major or minor axis. Below it the spin is
computed as steady. This leaves out an angle of 1e-30 rad, which does not grow, since spin about these axes is
stable."""

# motion

SMALL_TURN: Final = 1e-2
"""rad. The derivative of a free rotation by a smaller angle is found by integrating all neighbouring motions.
For larger angles the derivative uses symmetries, which cost at most two digits here."""

GROWTH_ROUNDING: Final = 1e-15
"""Relative. A number that grows by a factor and shrinks by it again has this error times the factor
squared."""

LARGEST_DERIVATIVE_ERROR: Final = 1e-3
"""Relative. The derivative loses digits where neighbouring motions diverge and converge again. It is NaN
where its error is larger than this."""

SMALL_STEP: Final = 1e-9
"""rad of attitude, m of position. A fit has converged when an iteration changes less everywhere in the
window."""

INTEGRATION_RELATIVE: Final = 3e-14
"""Relative error of each step of an integrated motion. The smallest that SciPy allows is 2e-14, where
rounding begins to shorten the steps without benefit."""

INTEGRATION_ABSOLUTE: Final = 1e-15
"""Absolute error of each step of an integrated motion, m, m/s, rad and rad/s, far below sensor resolution."""

DIFFERENCE_STEP: Final = 1e-5
"""Step of central differences of a user's function, m, rad, m/s and rad/s, or relative to a larger number.
The error is 1e-10 of the third derivative, plus 1e-11 of the force from rounding."""

LEAST_NOISE: Final = 1e-12
"""m and rad. Lower bound on the noise of a fit. The residuals of exact states are rounding errors, from which
the relative weight of positions and orientations cannot be estimated."""

ROUNDED_STAMP_TURN: Final = 1e-6
"""rad. Residuals below this do not determine the number of turns of a body. Stamps are whole nanoseconds, and
half a nanosecond at 1000 rad/s is 5e-7 rad."""

# shapes

FLAT_HULL: Final = 1e-9
"""Relative to the size. A hull thinner than this is a plate or a rod. Corners have rounding errors of
1e-16."""

INSIDE_HULL: Final = 1e-3
"""Relative to the size, and in rad. A shape with a corner this far inside the hull of its corners is not
convex. Coordinates of meshes are rounded to 1e-7 of the size."""

SAME_DIRECTION: Final = 1e-9
"""1 - cos of an angle of 4e-5 rad. Normals, or directions of edges, within it count as equal."""

# contact

NO_NOISE: Final = 1e-9
"""Relative to the largest singular value of the conditions on the error of a state. Dependent conditions
leave 1e-15, and distinct corners of a body more than this."""

VELOCITY_TOLERANCE: Final = 1e-9
"""m/s. A contact's velocity below it counts as zero, if the caller gives no other tolerance. It is far above
the rounding of velocities of up to 1e4 m/s, and far below what any sensor resolves. Measured states need
their noise level instead."""

STATES_APART: Final = 1e-4
"""s. States of two bodies whose stamps differ by more are not of one time. Within it, a free fall changes
velocities by 1 mm/s, less than the noise of measured ones."""

DISTANCE_TOLERANCE: Final = 1e-6
"""m. A point within it of a surface touches, if the caller gives no other tolerance."""

ROW_TOLERANCE: Final = 1e-9
"""Sine of an angle, for rows of unit length. Contact planes and wrenches within it coincide, in the
enumeration of modes and in their dynamics. Contact rows have rounding errors of about 1e-15, or 1e-13 for
contacts far from the centre of mass. Results from two planes that meet at 1e-5 rad are still correct to
this tolerance."""

SAME_POINT: Final = 1e-9
"""m. Points this close count as one. Separating directions whose separations differ by less are equivalent,
since the difference is rounding."""

PARALLEL_EDGES: Final = 1e-6
"""Sine of an angle. Edges, or sides of outlines, that meet at less do not cross; only their ends touch."""

# plane

OUT_OF_PLANE_SPEED: Final = 1e-6
"""m/s. Motion out of the plane of a planar problem counts as zero below this, if the caller gives no other
tolerance."""

OUT_OF_PLANE_RATIO: Final = 1e-2
"""Sine of the angle (0.6 degrees) by which normals, forces and principal axes may lean out of a plane of
motion. Motion capture resolves 0.1 degrees. The planar answer is then wrong by 1e-4, since the cosine is of
second order."""

# landing

GRAZING_DEPTH: Final = 1e-9
"""m. The search for the first contact may miss a point that dips into a plane by less and rises again. It
never misses a deeper one. Sensors do not resolve this depth, and it keeps the search from creeping."""

RIM_ACCURACY: Final = 1e-9
"""Relative size of the last of Newton's steps towards the landing of a rim. Its square is the error left. At
a nearly double root the error is as large as the step, but there the depth is its square."""

LEAVING_STEP: Final = 1e-5
"""s. Step away from an obstacle when no acceleration is towards it."""

# contact_modes

ACCELERATION_TOLERANCE: Final = 1e-9
"""Relative to the applied wrench plus centripetal terms. An acceleration or a force counts as zero if a
relative change of the wrench by this can change its sign. It is far above the rounding of the input, and far
below the accuracy to which wrenches are known."""

TURNS: Final = 1e-6
"""rad/s^2. A body whose contacts all stick turns if its angular acceleration is larger. Rounding leaves 1e-12
in bodies of 1 cm and larger, and at 1e-6 rad/s^2 a body takes twenty minutes to turn by 1 rad."""

FLUSH: Final = 1e-8
"""rad, or relative to the reach, in space. Normals and coordinates of contacts that agree within it are
merged in the search for modes. It equals `STRICT`, so that the resulting change counts as no motion."""

FLUSH_ROUGHLY: Final = 1e-4
"""As `FLUSH`, for verdicts that would otherwise be undecided. The answer reports this tolerance. Poses and
meshes in single precision have errors of 1e-7, and faces of machined parts of 1e-4 and more."""

FLUSH_ROUNDING: Final = 1e-14
"""As `FLUSH`. Contacts that are flush to within it are not moved, since rounding may move them by 1e-16."""

SAME_ROWS: Final = 1e-11
"""Dimensionless, in the plane. Contact planes, and wrenches, that meet at a smaller sine count as equal in
the enumeration of modes. Contacts count as equal if their unit normals agree within it, and their positions
relative to the radius of gyration, or to the arm if it is longer. It is about 1e5 roundings of the input, and
far below sensor resolution."""

CLEAR_ROWS: Final = 1e-5
"""Dimensionless. Contact planes, and wrenches, that meet at a larger sine are distinguished in floats, to
within `SAME_ROWS`; those between the two thresholds require more digits. With 1e-4, the planes of 32 ordinary
contacts would be between the two, which takes six times as long. With 1e-6, forces at rest missed the load by
more than 3e-9."""

CLEAR_ROWS_OF_MANY: Final = 1e-6
"""Dimensionless. It replaces `CLEAR_ROWS` for more than 150 planes or wrenches, which are closer together
without being degenerate. With it, 60 nearly degenerate sets of 150 to 400 contacts had the same modes as in
decimals."""

ROUGH_ROWS: Final = 10.0 * SAME_ROWS
"""Dimensionless, in the plane. When a cone is built in decimals, floats still determine the side of a row for
rays at least this far from it. Their rounding error is about 1e-15."""

LEAST_ROUGH_ROOT: Final = 1e-150
"""Dimensionless. The iteration for square roots of decimals starts from the root in floats, unless that is
smaller, since its square would lose digits below 2e-308."""

SAME_SHARP_ROWS: Final = 1e-14
"""Sine. Rows known to more digits than floats have count as equal if they meet at a smaller sine. If friction
never slips, a contact's normal is no more than 1e-10 of its tangent, and less if arms are short."""

INDEPENDENT_EQUATIONS: Final = 1e-6
"""Pivot of unit rows. Equations with a smaller pivot count as dependent, since the rounding error of their
solution would exceed the required accuracy."""

FORCES_ROUNDING: Final = 1e-13
"""Relative to the forces. Rounding error of sums of forces."""

NO_MOTION: Final = 1e-6
"""Relative to the applied wrench over the mass. Where contacts are uncertain, slower accelerations count as
rest. It is ten times the tolerance of SciPy's linear programs."""

PROVEN: Final = 1e-12
"""Relative to the applied wrench, in space. A proof that excludes letters of uncertain contacts is valid if
its contradiction is at least this large. Its terms are at most `NO_MOTION` or 1, and round to less than
1e-14."""

INSOLUBLE: Final = 1e-9
"""Relative to rows and limits of size 1, in the small simplex that finds contradictions. It does not divide
by smaller numbers, and ignores smaller violations. The caller verifies its results."""

REASON_MARGIN: Final = 3e-7
"""Relative to unit rows of forces, in space. Proofs that exclude letters of uncertain contacts increase the
errors by this, so that rounding of about 1e-12 does not invalidate them."""

REASON_ROUNDING: Final = 1e-9
"""Relative to the largest multiplier of a proof that excludes letters of uncertain contacts. Smaller
multipliers and directions are set to zero as rounding errors before the proof is verified."""

SAME_ARCS: Final = 1e-9
"""rad. Arcs of sliding that differ by less are equal, because all arise by halving the same three arcs. The
narrowest are 1e8 times as wide."""

LEAST_UNCERTAINTY: Final = 1e-5
"""Relative to unit rows, in space. Proofs about uncertain contacts increase smaller errors to this, which is
thirty times `REASON_MARGIN`. With 1e-6, SciPy's linear programs no longer distinguished some modes."""

LARGEST_PLANAR_ARM: Final = 1e8
"""In radii of gyration, in the plane. Several contacts are undecided if one of them is farther away. The
moments of forces of ordinary size then have larger rounding errors than the accuracy of wrenches."""

LARGEST_GRIP: Final = 1e10
"""Dimensionless, in the plane. Larger coefficients of friction are reduced to this, or to this divided by the
contact's arm in radii of gyration. The difference is in forces whose normal part is less than 1e-10 of the
wrench of the tangential part, and wrenches are not known to that accuracy."""

GRIP_TOLERANCE: Final = 1e-2
"""Dimensionless, in the plane. Upper bound on the tolerance of forces, times friction, times the arm in radii
of gyration. Otherwise the friction of a normal force that counts as zero would hold or stop the body."""

BEYOND_MARGIN: Final = 1e-5
"""Relative to a margin, or to the wrench if the margin is smaller. Distance beyond the boundary at which the
following modes are evaluated. It is far above the tolerances of the boundary, and far below the distance to
the next boundary."""

SAME_MOTION: Final = 1e-6
"""Relative. Two motions within it count as equal. They are the motions of two modes, or the ends of the range
that one mode allows, whose motion is then unique."""

FEASIBLE: Final = 1e-11
"""Relative to the largest acceleration, and to the edge forces that cause it. Allowed violation of a
condition of a mode. It is about a thousand roundings, and a thousandth of `STRICT`."""

STRICT: Final = 1e-8
"""Relative to the largest acceleration. Margin by which a strict inequality of a mode must hold, a thousand
times `FEASIBLE`."""

SURFACES_AS_ONE: Final = 1e-12
"""Relative to the largest velocity and acceleration of surfaces at contacts, which count as one rigid body if
they move like one within this. An applied wrench that inertial terms cancel within this counts as zero. It is
about a thousand roundings."""

HIDDEN_BY_FORCES: Final = 1e-4
"""Relative to the largest acceleration. If `FEASIBLE` times the accelerations caused by contact forces is
larger, their rounding error, about a 50,000th of this product, may hide the motion."""

AT_SECTORS_BORDER: Final = 1e-9
"""In sectors of a friction pyramid. An edge this far beyond the border of a sector still counts as acting."""

NEARLY_PARALLEL: Final = 1e-4
"""Sine. If distinct rows differ by less, rounding determines which of them vanish together."""

GIVES_WAY: Final = 1e-4
"""Relative to the largest acceleration. On the stiffest compliant contacts, a point with a smaller
acceleration stays or sticks. They yield by about 1e-6 under the load."""

COMPLIANT_SETTLED: Final = 1e-18
"""Square of the residual of the equations of motion on compliant contacts, relative to the load. It is far
below the compliance of those contacts."""

ON_PYRAMIDS_SIDE: Final = 1e-9
"""Relative to the largest force. A force this far outside a pyramid still counts as on its side. A smaller
force has no direction."""

LEAST_FORCE_SEEN: Final = 1e-13
"""Relative to the largest effect of unit forces. Smaller effects are within rounding, so forces without a
larger one are undetermined."""

LEAST_FORCE_MET: Final = 1e-12
"""Relative to the wrench. The search for the least forces ends when the unbalanced wrench is no larger."""

LEAST_FORCE_FLAT: Final = 1e-3
"""Relative to the unbalanced wrench, for unit curvature. It makes steps of the search for the least forces
finite, and is small enough for quadratic convergence."""

BEHIND_BOUNDARY: Final = 1e-5
"""Relative to the wrench. Distance beyond a boundary of a mode's wrenches at which neighbouring modes are
sought, a thousand times `STRICT`."""

NEAREST_GAIN: Final = 1e-10
"""Relative accuracy of the distance of a wrench from a sum of round cones."""

SQUEEZE_TRIED: Final = 1e5
"""Relative to the wrench. Size of the trial forces at contacts that press against each other."""

NEAREST_REACHED: Final = 1e-11
"""Relative to the wrench. A sum this close to the wrench counts as equal to it."""

STEP_BEHIND: Final = 1e-3
"""Relative to the wrench. Least distance beyond a boundary of the wrench that is projected on a mode's
wrenches; it is the distance to the boundary if that is larger. A smaller value takes fewer steps to the
nearest boundary."""

MARGIN_SETTLED: Final = 1e-9
"""Relative. The steps to the nearest boundary end when they reduce the distance by less."""

ON_BOUNDARY: Final = 10.0 * ROW_TOLERANCE
"""For unit rows. A wrench this far outside a cone still counts as on its boundary."""

NO_DISTANCE: Final = 1e-7
"""Relative to the applied wrench. A smaller distance to a mode's wrenches counts as zero. It is ten times the
error caused by the weight of a wrench's height in that distance."""

# impact

SAME_IMPULSES: Final = 1e-8
"""Relative to the largest impulse. Two solutions that differ by less are the same."""

TIED_APPROACH: Final = 1e-9
"""Relative to the largest velocity of the contacts just before the impact. Contacts whose approach velocities
differ by no more approach equally fast. Rounding of attitudes and of some strikes leaves 1e-14, and no
measurement is as accurate as this."""

NO_SHARED_RESPONSE: Final = 1e-12
"""Relative to the response along the normal. If equal impulses at tied contacts change their mean velocity by
no more, the change is rounding error."""

ENERGY_TOLERANCE: Final = 1e-12
"""Relative to the energy that an impact exchanges. If the gain is larger, the law creates energy. The
rounding error is about 1e-15 of the terms of the energy."""

LEAST_PIVOT: Final = 1e-30
"""Relative to its diagonal entry. Lower bound on a pivot of an inertia matrix, since only rounding can make
it smaller."""

LARGEST_ARM: Final = 1e7
"""In radii of gyration, about the axis with the largest. A contact in space that is farther from the centre
of mass is rejected in an impact. Its responses to impulses in different directions differ by the square of
this, which leaves two digits in doubles."""

SINGULAR_RESPONSE: Final = 1e-11
"""Relative to the largest response of a mechanism along a contact axis. A smaller response counts as zero.
The rounding error of J M^-1 J^T is about 1e-12 for a mass matrix with a condition number of 1e4."""

STRAIGHT: Final = 4e-15
"""Relative to the sliding law's scale. A repelling direction counts as invariant if its initial turning rate
is smaller. This rate is the rounding of contact axes and inertia, which the repulsion would amplify."""

SETTLED_TURN: Final = 8e-15
"""rad. A direction of sliding this close to an attracting invariant direction counts as equal to it. The
series of a stretch of sliding leave an error of up to 2e-15."""

UNCOUPLED: Final = 1e-15
"""Relative to the tangential inverse inertia. A slower turn is the rounding error of a coupling that is zero.
For a sphere the sliding law's scale is rounding error too."""

STOPPED: Final = 1e-13
"""Relative to the initial sliding speed. A slower contact slides straight to its stop. The error in impulse
is below this fraction of the impulse that stops the contact."""

LAST_TERM: Final = 1e-15
"""Relative to the sum of the series that leads to a stop. The series is truncated at a term of this size, and
the sum of the omitted terms is about as large."""

AT_THE_STOP: Final = 1e-15
"""rad. Newton's method for the direction in which sliding stops has converged when its step is smaller."""

SLOW_TURNING: Final = 1e-12
"""Relative. Turning counts as slow if (|h| + |h'|)/|g|, to the power of the number of terms, times the speed
is below this fraction of the initial speed. The iteration can then reach `LAST_TERM`."""

TRUNCATION: Final = 1e-14
"""Relative. A stretch of sliding ends where the last terms of the series of u and |u| reach this fraction of
|u|. The omitted terms are smaller."""

EVENT_LOCATED: Final = 1e-15
"""Relative. Newton's method has located an event of an impact when its next step is smaller."""

NOTHING_DUE: Final = 1e-9
"""Relative to the work that the fastest approach could do. Smaller remaining work of restitution is neglected
in interleaved impacts, whose increments are far coarser."""

SWEEPS_CONVERGED: Final = 1e-13
"""Relative to the largest approach velocity. The sweeps over simultaneous impulses have converged when one
changes the contacts' velocities by less."""

SHORT_TIMES: Final = (1e-7, 1e-5, 1e-3)
"""Change of a jammed body's velocities by the wrench in the time for which it acts, relative to the largest
speed. They are tried in this order, up to the first for which rounding allows an answer."""

CHATTER_HEIGHT: Final = 1e-7
"""m. Lower rebounds are not simulated. This height is a hundred times `GRAZING_DEPTH`, and far below the
roughness of surfaces."""

LEAST_FRICTION: Final = 1e-20
"""Dimensionless. A smaller coefficient of friction in an impact in space counts as zero, since its effect on
velocities is far below their rounding. Below 1e-34, rounding in the energetic law created unbounded
energy."""

SAME_CORNER: Final = 1e-5
"""m. Corners of a body closer together count as one corner in a whole toss. It is ten times
`SETTLING_HEIGHT`. Of 200 random boxes with each corner doubled, at distances up to 10 micrometres, 12 did not
come to rest, all of them below 1 micrometre; of 700 others, 5 did not, none beyond 2.5 micrometres."""

SAME_CORNER_SHARE: Final = 1e-4
"""As `SAME_CORNER`, relative to the reach of the body, for small bodies."""

SETTLING_HEIGHT: Final = 1e-6
"""m. In a whole toss, a contact with lower rebounds remains in contact, and a body that can rise or slide by
no more than this is at rest. It is a hundredth of the resolution of motion capture, and below the roughness
of most surfaces."""

SAMPLED_SETTLING_HEIGHT: Final = 1e-4
"""m. As `SETTLING_HEIGHT`, in samples of an uncertain toss. It is far below the distances between samples,
which are centimetres at rest, and halves the computation time."""

EXACT_SHARE: Final = 1e-12
"""Relative to the largest variance of samples. Lower bound on the variance in each direction, so that
distances are defined if a quantity is exact in some direction. It is far above the rounding of variances,
1e-16."""

SAMPLED_ARRIVAL: Final = 1e-7
"""m. A corner of a sample that is closer to a flat has arrived. At 1 m/s this is 1e-7 s."""

SAMPLED_PHASE_ERROR: Final = 1e-3
"""m, or m/s. The error that a step of a contact phase of a sample may have. Velocities after strikes of
recorded cubes are twenty times as uncertain."""

FACE_ROUNDING: Final = 1e-9
"""Relative to the reach, or to the face. A point outside a face by less is on its border. Corners have
rounding errors of 1e-16."""

STRIKES: Final = 1e-9
"""m/s. A contact of a whole toss that approaches faster strikes. It equals `VELOCITY_TOLERANCE`."""

STILL_TOUCHING: Final = 1e-8
"""m/s. A contact of a whole toss that separates more slowly is resolved by contact modes. It is above the
rounding of impacts at several contacts, which end at `STRIKES`."""

SLIDING_STOPPED: Final = 1e-6
"""m/s. A contact of a whole toss that slides more slowly has stopped. Friction of 0.1 removes this speed in a
microsecond, in which the contact slides by less than 1e-12 m."""

RESOLVED_SLIDING: Final = 50.0
"""Relative to the error of a step of a contact phase. A decelerating contact below this speed has stopped if
friction holds it, since its direction turns within a step. Contacts continued to slide at 15 to 28 times the
error for tens of thousands of steps, although friction stops each in microseconds."""

COARSE_SLIDING_STOPPED: Final = 1e-4
"""m/s. As `SLIDING_STOPPED`, for large step errors, including those of samples. Friction of 0.1 stops the
contact within 5e-9 m."""

SLIDING_DIRECTION_SPEED: Final = 1e-9
"""m/s. At much lower speeds, the direction of incipient sliding is used instead of that of the velocity,
whose digits are rounding errors."""

SAME_FORCES: Final = 1e-10
"""Ratio of singular values. Combinations of contact forces below it cause no acceleration, and the forces of
least norm are chosen."""

FORCE_ROUNDING: Final = 1e-9
"""Relative to the weight, or to the largest force. A contact with a smaller tensile force may remain."""

CONE_SWEEPS_CONVERGED: Final = 1e-12
"""Relative to the largest velocity or acceleration. The sweeps over the contacts end when one changes less,
which is near rounding."""

CONE_CREEPS: Final = 1e-6
"""Relative to the largest velocity. If opposing impulses of contacts keep growing slowly from sweep to sweep
and hardly change the velocities, the sweeps end when one changes less."""

SHORT_STEP_CREEPS: Final = 1e-4
"""As `CONE_CREEPS`, in short steps (`toss.short_step`), whose own first-order error is larger."""

BEGINNING_ROUNDING: Final = 1e-7
"""Relative to gravity. The acceleration of a contact that begins to slide may deviate from the direction of
friction by this. The rounding error of accelerations is about ten times `FORCE_ROUNDING`."""

BEGINNING_TURN: Final = 1e-4
"""rad. Step of the direction of incipient sliding for numerical derivatives of accelerations. Their rounding
and truncation errors are then a thousandth of the change."""

BEGUN_TO_SLIDE: Final = 1e-3
"""m/s. Below this speed, a contact that begins to slide does so along its acceleration. At 1e-3 m/s, friction
of 10 m/s^2 turns the sliding in 1e-4 s, which is as short as a step of a phase should be."""

HELD_DRIFT: Final = 1e-11
"""m, or m/s. A smaller drift of a held contact is not corrected. It is a hundredth of `GRAZING_DEPTH` and of
`STRIKES`."""

SUNK: Final = 1e-10
"""m. A body of a whole toss whose corners penetrate a flat more deeply is moved out of it. It is a tenth of
`GRAZING_DEPTH`."""

PHASE_ERROR: Final = 1e-7
"""m, or m/s. Allowed error of a step of a contact phase. It is a tenth of `SETTLING_HEIGHT`."""

LEAST_PHASE_ERROR: Final = 1e-15
"""m, or m/s. Smallest step error of a toss that doubles resolve. A smaller one would force the shortest steps
without benefit."""

PHASE_LEAST_STEP: Final = 1e-13
"""s. A step this short is accepted whatever its error, and events are located to this accuracy."""

COMES_DOWN_FOUND: Final = 1e-12
"""m. A corner that is below a flat by less has just come down. It is a thousandth of `GRAZING_DEPTH`."""

FORCE_END_FOUND: Final = 1e-3
"""Relative to the force that counts as zero. A force that exceeds it by less has just left its cone."""

LIFT_OFF_PAUSE: Final = 1e-6
"""s. A contact lifts off with zero velocity. Its next landing is sought only after this time, in which the
body moves by less than 1e-11 m relative to it."""

RESTING_ACCELERATION: Final = 1e-6
"""Relative to gravity. A body with a smaller acceleration, and hardly any velocity, is at rest. A cube on an
edge is then off balance by less than 1e-7 of its size."""

HELD_STILL: Final = 0.01
"""Relative to the speed that a step of free motion gives to a held contact. Allowed residual speed when
several held contacts push each other away."""

CHATTER_PAUSE: Final = 1e-6
"""s. If rounding makes a separating contact appear to approach, the search continues after this time."""

HELD_INDEPENDENT: Final = 1e-9
"""Ratio of singular values. Below it, the constraint directions of jammed contacts count as dependent."""

ESCAPE_ARRIVED: Final = 1e-16
"""Relative. Newton's method for the direction in which a contact leaves its stop has converged when its step
is smaller, which is below the last bit."""

MODE_STRAIGHT: Final = 1e-8
"""rad. Friction within this angle of the direction opposite to sliding opposes it exactly, up to rounding."""

SLIDING_ROUNDED: Final = 8e-16
"""Relative to the largest acceleration, or to the largest force over the mass. A smaller acceleration across
friction is rounding error of a sum of forces, about four roundings."""

MODE_RESTS: Final = 1e-12
"""Relative to the load. Allowed residual of forces that hold a body."""

MODE_BETTER: Final = 1e-2
"""Relative. Forces replace others if their residual is below this fraction of the previous residual. A
smaller improvement would be rounding."""

CAREFUL_UNMET: Final = 1e-9
"""Relative to the largest acceleration. Equations that count as the same may differ by this in the required
accelerations, for example by rounding of centripetal terms."""

CAREFUL_LEAST_PIVOT: Final = 1e-13
"""Smaller entries of the tableau may be rounding errors of the doubles from which it is made."""

TABLE_SMALL_PIVOT: Final = 1e-3
"""Division by a larger entry is harmless, since the rounding error that it adds is within `FEASIBLE`."""

TABLE_ROUNDING: Final = 1e-16
"""Relative rounding error of doubles in one or two steps."""

SLOWEST_SHARED: Final = (1e-3, 1e-5, 1e-7, 3e-8)
"""Relative to the largest acceleration. Lower bounds, tried in turn, on the sliding of contacts that share a
load, since forces at rest would also satisfy a bound of zero."""

ALONE_WITHIN: Final = (0.3, 0.1, 0.03, 0.01, 0.003)
"""rad. Ranges of directions around a solution, tried in turn until one contains no other solution. For
smaller ranges, bisection is as fast."""

NARROWEST_RANGE: Final = 1e-5
"""rad. A narrower range of sliding directions is not bisected further. Whether it contains a mode is then
undecided."""

SAME_SLIDING: Final = 1e-3
"""rad. Modes with the same letters may count as one if no direction of sliding differs by more. Bounds cannot
separate them where the equations are nearly singular."""

LETTERS_SETTLED: Final = 1e-13
"""Relative to the largest acceleration. Allowed residual of the equations in the last step."""

LETTERS_REGULAR: Final = 1e-11
"""Ratio of singular values. Below it, the unknowns count as dependent, because loads are shared."""

NARROWLY: Final = 1e-11
"""Relative to the largest acceleration. If no mode holds by `STRICT`, one must hold by this. It is a hundred
times `LETTERS_SETTLED`."""

LETTERS_NO_FORCE: Final = 1e-9
"""Relative to the largest force. A smaller force of one of several contacts that share loads counts as
zero."""

LETTERS_ON_CONE: Final = 1e-10
"""Relative. The force of a sticking contact may exceed its cone by this."""

ONE_CONTACT_ON_CONE: Final = 1e-9
"""Relative. The force of a sticking contact may exceed its cone by this. The condition for incipient sliding
has the same tolerance."""

ONE_CONTACT_ZERO: Final = 1e-13
"""Relative to the largest acceleration, and to the largest coefficient. Smaller values are rounding."""

ONE_CONTACT_ON_CIRCLE: Final = 1e-3
"""Allowed distance of a root from the unit circle before it is refined. Double roots are accurate to half the
digits."""

ONE_CONTACT_SAME_ANGLE: Final = 1e-6
"""rad. Two roots within it count as one."""

ROUND_CONE_HELD: Final = 1e-11
"""Relative to the load. Allowed residual of forces that hold the contacts."""

ROUND_CONE_NO_HELP: Final = 1e-12
"""Cosine of the angle between the effect of a force and the residual. A smaller value is rounding."""

ROUND_CONE_ACROSS: Final = 1e-9
"""As `ROUND_CONE_NO_HELP`. Below this cosine, rounding of the contacts' normals may decide whether a force
reduces the residual."""

ROUND_CONE_INDEPENDENT: Final = 1e-15
"""Ratio of singular values. Smaller ratios are rounding."""

ROUND_CONE_APART: Final = 1e-13
"""Dimensionless, for rows of unit length. A larger difference between rows exceeds rounding."""

ROUND_CONE_ON_CONE: Final = 1e-12
"""Relative to the largest force. A force may exceed its cone by this."""

ROUND_CONE_REACHED: Final = 1e-10
"""Relative. Lower bound on the effect of all forces together in every direction, so that their residual is
not divided by a rounding error."""

ROUND_CONE_ROUNDING: Final = 1e-13
"""Relative. A smaller residual is rounding, and refutes nothing."""

ROUND_CONE_NEAR: Final = 1e-3
"""Relative to the load. Only a smaller residual is corrected for the rounding of the forces, which is
negligible compared with a larger one."""

ROUND_CONE_WIDE: Final = 1e-6
"""Relative to the load. Wide friction cones certainly do not hold it only if the residual is larger, because
forces in them are found in many steps."""

# calibration

NEGLIGIBLE_GAIN: Final = 1e-4
"""Squared standard deviations. A calibration has converged when the next step would gain less. The estimate
is then within a hundredth of its own standard deviation."""

DERIVATIVE_STEP: Final = 1e-5
"""Standard units of parameters. Step of numerical derivatives. The impact's rounding of 1e-13 becomes 1e-8 of
the slope, and its curvature adds 1e-5."""

SPREAD_FOUND: Final = 1e-3
"""Relative accuracy to which a variance is computed, far better than its estimate from any number of
strikes."""

SAME_FACE: Final = 1e-6
"""Half sizes. A corner this close to a face's plane belongs to the face. Configured corners have six
digits."""

LEAST_STEP_OF_SURFACE: Final = 0.01
"""Half sizes. A surface that bends by less over the touched area counts as flat."""

LEAST_LAW_VELOCITY: Final = 1e-3
"""m/s. Lower bound on the spread of the impact law in fits of trajectories. Without it, a velocity after a
strike would depend on rounding. It is below the resolution of tracking systems."""

LEAST_LAW_SPIN: Final = 1e-2
"""rad/s. As `LEAST_LAW_VELOCITY`, for angular velocities."""

# toss

SWEEPS_CHANGE_ALIKE: Final = 1e-3
"""Ratio of singular values. Below it, changes by sweeps over contacts count as linearly dependent."""

SHORTEST_LINGER: Final = 1e-5
"""s. If rounds of a toss advance it by less time, short steps replace them for this long."""

BUSY: Final = 0.01
"""s. If a toss needs hundreds of strikes and modes within this time, its contacts chatter."""

CREEPING_STEP: Final = 1e-6
"""s. A contact phase with many successive steps this short is creeping."""

LONGEST_SHORT_STEP: Final = 2e-4
"""s. Maximum length of a short step. A body with 10 rad/s turns by a tenth of a degree in it."""

SHORTEST_SHORT_STEP: Final = 1e-7
"""s. Minimum length of a short step, used when a corner comes down."""
