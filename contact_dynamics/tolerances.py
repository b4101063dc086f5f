# SPDX-License-Identifier: Apache-2.0
"""Every threshold of the physics stands here, by chapter, with its unit and the reason for its size.

A threshold decides whether a number counts as zero, whether two things count as one, or whether an iteration
is done. All thresholds up to a hundredth are in this file, and a test over the sources checks this. If a
caller may want to change a threshold, it is a default here and an argument or parameter there.

Some numbers are beside the code that uses them instead: bounds on work and length (`MOST_...`); sizes of
parts of a computation (`CHUNK`, `PIECE`); shares and angles above a hundredth that only choose between two
ways to the same answer; and the digits of each kind of number (`numerics.arithmetic`).
"""

from __future__ import annotations

from decimal import Decimal
from typing import Final

# What comes in

UNIT_LENGTH_TOLERANCE: Final = 1e-3
"""Dimensionless. A quaternion or normal whose norm is off by more is refused, not repaired.

Quaternions that went through float32 or four printed decimals are off by at most 2e-4. A quaternion that was
never normalised, or that lacks a component, is off by far more.
"""

LENGTH_ROUNDING: Final = 1e-15
"""Dimensionless. A vector whose length is 1 within this is not scaled again, so that scaling twice changes
nothing."""

SQUARES_UNDERFLOW: Final = 1e-140
"""Any unit. The length of a shorter vector is not found from squares, which lose digits below 1e-154."""

LARGEST_NUMBER: Final = 1e60
"""In SI units: s, rad/s, kg m^2, m, m/s, m/s^2. A motion is refused if its numbers are larger, or if its
moments of inertia are below the inverse, because fourth powers and products of such numbers leave the range
of doubles. Rates below the inverse count as rest, because such a body does not turn in the age of the
universe."""

MANGLED: Final = 2.0**-1042
"""Any unit. A positive number below it in a message is what rclpy sends of an int or a float32 whose type it
has not checked: their 32 bits, read as the last of a double's 64. Measured numbers are zero or far larger. A
velocity that a simulation damps forever may end there, as one of any sign."""

# What is shown

SHOWN_AS_ZERO: Final = 1e-12
"""Relative to the largest number of an array. Where an array is printed, a smaller one is rounding and 0."""

# contacts that are given

FAR_CONTACT: Final = 0.01
"""Relative to the reach of a body's shape: a contact that is out of it by more is a mistake, not noise."""

# the largest load

SAME_FACTOR: Final = 1e-9
"""Relative: factors of a load that differ by less are one."""

STRAIGHT_ARC: Final = 1e-4
"""rad. A wrench that turns by less is off a straight path by about 1e-9 of it."""

NEXT_TO_A_LIMIT: Final = 1e-6
"""Relative: this far from the largest factor of a load is what follows it, or goes before it."""

ONLY_REST_WITHIN: Final = 0.01
"""Relative: how exactly a smaller factor is found up to which rest is the only consistent mode."""

ANY_LOAD: Final = 1e12
"""A load this many times the wrench without it stands for any larger one."""

NO_LOAD: Final = 1e-18
"""Relative to the largest load, also to `ANY_LOAD`: a load this small stands for any smaller one."""

# numerics

SMALL_SHARE: Final = 1e-10
"""Share of the sum of squares of a fit's residuals. A round is the last if it reduces the sum by less, or if
the next one would, since rounds explain less and less at a growing rate. Another round would change the
parameters by about 1e-5 of their standard deviations at most."""

NO_PIVOT: Final = 1e-11
"""Relative to the largest entry of a column in Lemke's method. A smaller entry is rounding and no pivot."""

COVERED: Final = 1e-12
"""Relative to the largest of q in Lemke's method. A covering variable of this size counts as zero."""

WRENCH_ROUNDING: Final = 1e-13
"""Relative to the wrench that contact forces balance. A remainder up to this is rounding."""

NEAREST_SUM_ROUNDING: Final = 1e-9
"""Relative to the terms of a nearest non-negative sum. SciPy's rounding is some 1e-13. Where SciPy 1.15 is
wrong, it is wrong by more than 1e-3."""

INDEPENDENT_FORCES: Final = 1e-12
"""Ratio of singular values. Below it, directions of contact forces count as the same."""

DECIMALS_ZERO: Final = Decimal("1e-60")
"""Relative. Decimals of `DECIMALS.sums` leave at most this of a zero, even after products of products."""

TARGET_ROUNDING: Final = Decimal("1e-14")
"""Relative. This is the rounding of a target itself. Columns that differ by no more would need huge shares to
meet it."""

DECIMALS_MET: Final = Decimal("1e-30")
"""Relative. A target counts as met exactly if this much of it is left."""

# evaluation

LANDING_GAP: Final = 0.015
"""m. A flight that ends with the body this near to a surface ended by landing on it. Tracked frames and
shapes are off by some millimetres, and a body of 2 m/s comes 6 mm nearer between two frames of 150 Hz. A hand
that catches is farther from the floor."""

TOUCHING_GAP: Final = 0.003
"""m. A point of a body at rest or sliding that is this near to a surface touches it: the error of tracked
frame, shape and surface together."""

IMPACT_SPAN: Final = 0.04
"""s. A flight that begins this soon after the end of the one before is separated from it by one impact, at
one corner or at several. Longer stretches without flight are mostly sliding or rocking."""

SHARP_VELOCITY: Final = 0.15
"""m/s, and rad/s times the radius of gyration. If the velocities beside an impact are measured with larger
standard deviations, the impact is not compared. Velocities change by 1 m/s and more."""

MODE_SPAN: Final = 0.05
"""s. A mode is looked for in windows of this length. It is short, because recordings stop soon after a body
does; longer than a bounce of 2 mm."""

MODE_SPEED: Final = 0.02
"""m/s. A contact point that is slower over `MODE_SPAN` does not move along its surface: friction of 0.2 ends
such a slide in 10 ms. The noise of the window's velocity is added."""

LEAST_POSITION_NOISE: Final = 1e-6
"""m. No tracker is better. Where a body's poses repeat to the bit, their scatter says nothing of the rest."""

LEAST_ORIENTATION_NOISE: Final = 1e-6
"""rad. As `LEAST_POSITION_NOISE`, at a metre."""

SAME_EVENT: Final = 0.01
"""s. Events of one kind, found in one recording by two versions of the code, are the same if they are this
close."""

HOLD_STEP: Final = 1e-3
"""s. Steps in which a body goes on over a corner that stays, where strikes in time are evaluated. In one step
a corner of 1 m/s moves by a millimetre, which is within the error of tracked frames and shapes."""

# rigid_body

SYMMETRY_TOLERANCE: Final = 1e-9
"""Relative to the largest entry. A matrix that is less symmetric than this is not an inertia matrix."""

NEGATIVE_VARIANCE_TOLERANCE: Final = 1e-9
"""Dimensionless. An eigenvalue of a correlation matrix, whose entries are at most 1, may be this negative. If
a covariance has no variance in some direction, rounding leaves 1e-15, and more after a filter."""

TRIANGLE_TOLERANCE: Final = 1e-6
"""Relative to the largest principal moment. I1 + I2 >= I3 holds with equality for flat bodies, and measured
or rounded moments of a flat body miss it by their last printed digit."""

EQUAL_MOMENTS_TOLERANCE: Final = Decimal("1e-12")
"""Relative to the largest principal moment. Two moments within it count as equal when a rotation gets its
name. Turning an inertia matrix into other axes in doubles separates equal moments by about 1e-16, and real
bodies of one shape differ by far more. The motion itself is computed with the moments as they are."""

SUM_ROUNDING: Final = 1e-14
"""Relative to the largest of a sum's terms, whose rounding is more than ten times smaller. A difference up to
this counts as zero."""

VOLUME_ROUNDING: Final = 1e-13
"""Relative to a surface's area times its size, m^3. A smaller volume is rounding, and the surface is flat."""

DENSEST: Final = 30_000.0
"""kg/m^3. No body is denser than osmium, 22,590. A file in which one is has other units."""

THINNEST: Final = 1.0
"""kg/m^3. The density of air. A body in a bounding box is hardly lighter."""

SURFACES_TOUCH: Final = 1e-9
"""Relative to a part's size. Surfaces that are nearer than this touch, with nothing in between."""

EPSILON: Final = 2.0**-52
"""Relative rounding of coordinates. Points within it of a plane count as in the plane. Far from the origin it
also gives the rounding of a volume."""

AXIS_TIE: Final = 1e-9
"""Dimensionless. The largest component of a unit axis decides its sign, and components within this count as
equal. It is far above the rounding of, say, (1, 1, 0) / sqrt(2)."""

EXACTLY_EQUAL_MOMENTS: Final = Decimal("1e-110")
"""Relative to the largest moment. Moments closer than this are equal in the tumbling formulas too: Jacobi's
rotations leave this much in 120 digits."""

# tumbling

STEADY_AXIS_TOLERANCE: Final = Decimal("1e-24")
"""Squared angle, rad^2, between L and the major or minor axis. Within it spin is called steady. The angle is
1e-12 rad, well above the rounding of a quaternion and an angular velocity."""

NEGLIGIBLE_TERM: Final = 1e-18
"""Relative to the largest term of a sum of theta functions. Terms below it are left out, since they are far
below the last bit."""

SMALLEST: Final = 1e-300
"""In any unit. It replaces zero where a quotient or a logarithm would otherwise fail. Added to a divisor, it
makes 0/0 a 0 where 0 is meant."""

SEPARATRIX_END: Final = 1e-6
"""rad of Jacobi's amplitude, from its ends, at which the polhode of a single flip is cut off. The motion is
this near to spin about the middle axis 14 time constants before and after its flip."""

SMALLEST_COMPLEMENT: Final = 1e-100
"""Value of 1 - m, the complement of the parameter. Below it the sensitivity of a tumbling body is beyond 1e90
and is given as infinite."""

MOTIONLESS: Final = 1e-60
"""Squared angle, rad^2, between the angular velocity and the major or minor axis. Below it the spin is
computed as steady. This leaves out an angle of 1e-30 rad, which does not grow, since spin about these axes is
stable."""

# motion

SMALL_TURN: Final = 1e-2
"""rad. A free rotation that turns by less is differentiated by integrating all its neighbours. For larger
turns the derivative uses symmetries, which cost at most two digits here."""

GROWTH_ROUNDING: Final = 1e-15
"""Relative. A number that grew by a factor and shrank by it again has this error times the factor squared."""

LARGEST_DERIVATIVE_ERROR: Final = 1e-3
"""Relative. Where neighbours of a motion part and meet again, the derivative loses digits. It is NaN where
its error is larger than this."""

SMALL_STEP: Final = 1e-9
"""rad of attitude, m of position. A round of a fit that changes less everywhere in the window is the last."""

INTEGRATION_RELATIVE: Final = 3e-14
"""Relative error of each step of an integrated motion. SciPy's smallest is 2e-14, where rounding begins to
make steps short without use."""

INTEGRATION_ABSOLUTE: Final = 1e-15
"""Absolute error of each step of an integrated motion, m, m/s, rad and rad/s. No sensor resolves it."""

DIFFERENCE_STEP: Final = 1e-5
"""Step of central differences of a user's function, m, rad, m/s and rad/s, or relative to a larger number.
The error is 1e-10 of the third derivative, plus 1e-11 of the force from rounding."""

LEAST_NOISE: Final = 1e-12
"""m and rad. The noise of a fit counts as at least this. The residuals of exact states are rounding alone,
which does not say how to weigh positions against orientations."""

ROUNDED_STAMP_TURN: Final = 1e-6
"""rad. Residuals below this do not decide how many turns a body made. Stamps are whole nanoseconds, and at
1000 rad/s half of one is 5e-7 rad."""

# shapes

FLAT_HULL: Final = 1e-9
"""Relative to the size. A hull thinner than this is a plate or a rod. Corners carry 1e-16 of rounding."""

INSIDE_HULL: Final = 1e-3
"""Relative to the size, and in rad. A corner this far inside the hull of all corners is not one of a convex
body. Coordinates of meshes are rounded to 1e-7 of the size."""

SAME_DIRECTION: Final = 1e-9
"""1 - cos of an angle of 4e-5 rad. Normals, or directions of edges, within it count as one."""

# contact

NO_NOISE: Final = 1e-9
"""Relative. Conditions on the error of a state that depend on each other leave singular values of 1e-15 of
the largest. Corners of a body that are told apart leave more than this."""

VELOCITY_TOLERANCE: Final = 1e-9
"""m/s. A contact's velocity below it counts as zero, if the caller gives no other tolerance. It is far above
the rounding of velocities of up to 1e4 m/s, and far below what any sensor resolves. Measured states need
their noise level instead."""

DISTANCE_TOLERANCE: Final = 1e-6
"""m. A point within it of a surface touches, if the caller gives no other tolerance."""

ROW_TOLERANCE: Final = 1e-9
"""Sine of an angle, for rows of unit length. Contact planes (and wrenches) within it coincide, in the
enumeration of modes and in their dynamics. Contact rows carry about 1e-15 of rounding, and a hundred times
that for contacts far from the centre of mass. Results from two planes that meet at 1e-5 rad are still right
within it."""

SAME_POINT: Final = 1e-9
"""m. Points this close count as one. Separating directions whose separations differ by less are equally
good, since the difference is rounding."""

PARALLEL_EDGES: Final = 1e-6
"""Sine of an angle. Edges, or sides of outlines, within it do not cross, and only their ends touch."""

# plane

OUT_OF_PLANE_SPEED: Final = 1e-6
"""m/s. Motion out of the plane of a planar question counts as zero below this, if the caller gives no other
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
"""Length of a step, s, away from an obstacle where no acceleration is towards it."""

# contact_modes

ACCELERATION_TOLERANCE: Final = 1e-9
"""Relative to the applied wrench plus centripetal terms. An acceleration or a force counts as zero if a
change of the wrench by this share can change its sign. It is far more than rounding of the input, and far
less than the accuracy to which wrenches are known."""

TURNS: Final = 1e-6
"""rad/s^2. A body whose contacts all stick turns if its angular acceleration is more. Rounding leaves 1e-12
in bodies of 1 cm and larger, and with this one a body takes twenty minutes to turn by 1 rad."""

FLUSH: Final = 1e-8
"""rad, or a share of the reach, in space. Normals and coordinates of contacts that agree within it are taken
as the same where modes are sought. It is `STRICT`: what this changes counts as no motion."""

FLUSH_ROUGHLY: Final = 1e-4
"""The same, where a verdict would otherwise be undecided. The answer then says so. Poses and meshes in single
precision are off by 1e-7, and faces of machined parts by 1e-4 and more."""

FLUSH_ROUNDING: Final = 1e-14
"""The same. Contacts that are flush to within it are left as they are, since rounding may move them by
1e-16."""

SAME_ROWS: Final = 1e-11
"""Dimensionless, in the plane. Contact planes, and wrenches, that meet at a smaller sine are one where modes
are enumerated. Contacts are one if their unit normals agree within it, and their places within this share of
the radius of gyration, or of the arm if it is longer. It is some 1e5 roundings of the input, and far below
what any sensor resolves."""

CLEAR_ROWS: Final = 1e-5
"""Dimensionless. Floats tell contact planes, and wrenches, apart that meet at a larger sine, to within
`SAME_ROWS`. Those between the two are told apart with more digits. With 1e-4, the planes of 32 ordinary
contacts would be between the two, which takes six times as long. With 1e-6, forces at rest missed the load by
more than 3e-9."""

CLEAR_ROWS_OF_MANY: Final = 1e-6
"""Dimensionless. It stands in for `CLEAR_ROWS` where there are more than 150 planes or wrenches. So many lie
closer together without being degenerate. With it, 60 sets of 150 to 400 contacts next to degeneracy got the
modes that decimals give."""

ROUGH_ROWS: Final = 10.0 * SAME_ROWS
"""Dimensionless, in the plane. Where decimals decide, floats still tell on which side of a row a ray is that
is this far from it. Their rounding is some 1e-15."""

LEAST_ROUGH_ROOT: Final = 1e-150
"""Dimensionless. Square roots of decimals begin with those of floats, unless they are smaller. Their squares
would lose digits below 2e-308."""

SAME_SHARP_ROWS: Final = 1e-14
"""Sine. Rows that are known to more digits than floats have are one if they meet at a smaller sine. If
friction never slips, a contact's normal is no more than 1e-10 of its tangent, and less if arms are short."""

INDEPENDENT_EQUATIONS: Final = 1e-6
"""Pivot of unit rows. Equations with a smaller one do not count as independent, since their solution would
carry more rounding than the accuracy asked for."""

FORCES_ROUNDING: Final = 1e-13
"""Relative to the forces. Sums of forces round by this much."""

NO_MOTION: Final = 1e-6
"""Relative to the applied wrench over the mass. Where contacts are uncertain, slower accelerations count as
rest. It is ten times the tolerance of SciPy's linear programs."""

PROVEN: Final = 1e-12
"""Relative to the applied wrench, in space. A reason against letters of uncertain contacts counts from this
on. Its terms have at most the size of `NO_MOTION` or 1, and round to less than 1e-14."""

INSOLUBLE: Final = 1e-9
"""Relative to rows and limits of size 1, in the small simplex that finds contradictions. It does not divide
by smaller numbers, and takes smaller violations for none. A caller checks what it finds."""

REASON_MARGIN: Final = 3e-7
"""Relative to unit rows of forces, in space. Where letters of uncertain contacts are excluded, errors are
taken for larger by this, so that rounding of some 1e-12 spoils no reason."""

REASON_ROUNDING: Final = 1e-9
"""Relative to the largest multiplier of a reason against letters of uncertain contacts. Smaller multipliers
and directions are rounding and count as zero. The reason is checked as it then is."""

SAME_ARCS: Final = 1e-9
"""rad. Arcs of sliding that differ by less are the same, because all are halves of the same three arcs. The
narrowest are 1e8 times as wide."""

LEAST_UNCERTAINTY: Final = 1e-5
"""Relative to unit rows, in space. Proofs about uncertain contacts take smaller errors for this, which is
thirty times what they add to errors against rounding. With 1e-6 SciPy's linear programs told some modes apart
no longer."""

LARGEST_PLANAR_ARM: Final = 1e8
"""In radii of gyration, in the plane. If a contact is further away than this, several contacts are not
decided about. Forces of ordinary size then round in their moments to more than wrenches are known to."""

LARGEST_GRIP: Final = 1e10
"""Dimensionless, in the plane. A coefficient of friction above it, or above it divided by the contact's arm
in radii of gyration, acts as that one does. The two differ in forces whose normal part is less than 1e-10 of
the wrench of the tangential one, and wrenches are not known to that accuracy."""

GRIP_TOLERANCE: Final = 1e-2
"""Dimensionless, in the plane. The tolerance of forces, times friction, times the arm in radii of gyration,
stays below it. Otherwise the friction of a normal force that counts as zero would hold or stop the body."""

BEYOND_MARGIN: Final = 1e-5
"""Share of a margin, or of the wrench if the margin is less. The wrench is moved this far beyond the boundary
to see which modes are there. It is far more than the tolerances of the boundary, and far less than the
distance to the next one."""

SAME_MOTION: Final = 1e-6
"""Relative. Two motions within it count as one. They are the motions of two modes, or the ends of the range
that one mode allows, whose motion is then unique."""

FEASIBLE: Final = 1e-11
"""Relative to the largest acceleration, and to edge forces that cause it. A condition of a mode may be missed
by this. It is some thousand roundings, and a thousandth of `STRICT`."""

STRICT: Final = 1e-8
"""Relative to the largest acceleration. A strict inequality of a mode must hold by this, a thousand times
`FEASIBLE`."""

SURFACES_AS_ONE: Final = 1e-12
"""Relative. Surfaces at contacts that move like one rigid body, to this share of their largest velocity and
acceleration, count as one. An applied wrench that inertial terms cancel to this share counts as zero. It is
some thousand roundings."""

HIDDEN_BY_FORCES: Final = 1e-4
"""Relative to the largest acceleration. If `FEASIBLE` of what forces cause is more, they are so large that
rounding hides the motion: a 50,000th of it is that rounding."""

AT_SECTORS_BORDER: Final = 1e-9
"""In sectors of a friction pyramid. An edge this far beyond the border of a sector still counts as acting."""

NEARLY_PARALLEL: Final = 1e-4
"""A sine. Rows that differ, and by less, leave it to rounding which of them vanish together."""

GIVES_WAY: Final = 1e-4
"""Relative to the largest acceleration. What the stiffest compliant contacts let move by less stays or
sticks. They give way by about 1e-6 under the load."""

COMPLIANT_SETTLED: Final = 1e-18
"""The square of what the equations of motion may miss on compliant contacts, relative to the load. It is far
less than those contacts give way."""

ON_PYRAMIDS_SIDE: Final = 1e-9
"""Relative to the largest force. A force this far outside of a pyramid still counts as on its side. A force
as small as this has no direction."""

LEAST_FORCE_SEEN: Final = 1e-13
"""Relative to the largest effect of unit forces. Rounding hides smaller effects, so forces without a larger
one are free."""

LEAST_FORCE_MET: Final = 1e-12
"""Relative to the wrench. The search for the least forces ends when they leave no more of it."""

LEAST_FORCE_FLAT: Final = 1e-3
"""Share of what is left of the wrench, for unit curvature. It makes steps of the search for the least forces
finite, and is small enough that they double the number of right digits."""

BEHIND_BOUNDARY: Final = 1e-5
"""Relative to the wrench. The search for neighbouring modes looks this far behind a boundary of a mode's
wrenches, a thousand times `STRICT`."""

NEAREST_GAIN: Final = 1e-10
"""Relative to the distance of a wrench from a sum of round cones. The distance is exact to this."""

SQUEEZE_TRIED: Final = 1e5
"""Relative to the wrench. Contacts that press against each other are tried with forces of this size."""

NEAREST_REACHED: Final = 1e-11
"""Relative to the wrench. A sum this near to it counts as the wrench itself."""

STEP_BEHIND: Final = 1e-3
"""Relative to the wrench. A wrench this far behind a boundary is projected on a mode's wrenches, or as far as
the boundary is if that is more. The nearer it is, the fewer steps lead to the nearest boundary."""

MARGIN_SETTLED: Final = 1e-9
"""Relative. Steps to a boundary end when they bring it nearer by less."""

ON_BOUNDARY: Final = 10.0 * ROW_TOLERANCE
"""For unit rows. A wrench this far outside of a cone still counts as on its boundary."""

NO_DISTANCE: Final = 1e-7
"""Relative to the applied wrench. A smaller distance to a mode's wrenches counts as zero. It is ten times the
error that the weight of a wrench's height in that distance leaves."""

# impact

SAME_IMPULSES: Final = 1e-8
"""Relative to the largest impulse. Two ways to a solution that differ by less have found the same one."""

TIED_APPROACH: Final = 1e-9
"""Relative to the largest velocity of the contacts just before the impact. Contacts whose approaches differ
by no more approach equally fast. Rounding of attitudes and of some strikes leaves 1e-14, and no measurement
is as good as this."""

NO_SHARED_RESPONSE: Final = 1e-12
"""Relative to the response along the normal. If equal impulses at tied contacts change their mean velocity by
no more, they change it by rounding."""

ENERGY_TOLERANCE: Final = 1e-12
"""Relative to the energy that an impact exchanges. If the gain is larger, the law creates energy. Rounding is
about 1e-15 of the terms of the energy."""

LEAST_PIVOT: Final = 1e-30
"""Relative to its diagonal entry. A pivot of an inertia matrix is at least this, since only rounding can make
it smaller."""

LARGEST_ARM: Final = 1e7
"""In radii of gyration, about the axis with the largest. A contact in space that is farther from the centre
of mass is refused in an impact. Its responses to impulses in different directions differ by the square of
this, which leaves doubles two digits."""

SINGULAR_RESPONSE: Final = 1e-11
"""Relative to the largest response of a mechanism along a contact axis. A smaller one counts as none. The
rounding of J M^-1 J^T is about 1e-12 for a mass matrix with a condition number of 1e4."""

STRAIGHT: Final = 4e-15
"""Relative to the sliding law's scale. A direction that repels its neighbours counts as invariant if it turns
more slowly at first. It then turns by the rounding of contact axes and inertia, which it would amplify."""

SETTLED_TURN: Final = 8e-15
"""rad. A direction of sliding this close to an invariant one that attracts it counts as that one. The series
of a stretch leave up to 2e-15 of it, and never less."""

UNCOUPLED: Final = 1e-15
"""Relative to the tangential inverse inertia. A slower turn than this is the rounding of a coupling that is
zero. For a sphere the sliding law's scale is rounding too."""

STOPPED: Final = 1e-13
"""Relative to the first sliding speed. A slower contact goes straight to its stop. The error in impulse is
below this share of the impulse that stops the contact."""

LAST_TERM: Final = 1e-15
"""Relative to the sum of the series that leads to a stop. The series ends with a term of this size, and the
terms left out are together about as large."""

AT_THE_STOP: Final = 1e-15
"""rad. Newton's method has found the direction in which sliding stops when its step is smaller."""

SLOW_TURNING: Final = 1e-12
"""Relative. Turning counts as slow if (|h| + |h'|)/|g|, to the power of the number of terms, times the speed
is below this share of the first speed. Then the iteration can reach `LAST_TERM`."""

TRUNCATION: Final = 1e-14
"""Relative. A stretch of sliding ends where the last terms of the series of u and |u| reach this share of
|u|. The terms left out are smaller."""

EVENT_LOCATED: Final = 1e-15
"""Relative. Newton's method has located an event of an impact when its next step is smaller."""

NOTHING_DUE: Final = 1e-9
"""Relative to the work that the fastest approach could do. What restitution still owes below it is left, in
interleaved impacts, whose increments are far coarser."""

SWEEPS_CONVERGED: Final = 1e-13
"""Relative to the largest approach velocity. The sweeps over simultaneous impulses are done when one changes
the contacts' velocities by less."""

SHORT_TIMES: Final = (1e-7, 1e-5, 1e-3)
"""Change of a jammed body's velocities by the wrench in the time for which it acts, relative to the largest
speed. They are tried in this order, and the first is taken for which rounding allows an answer."""

CHATTER_HEIGHT: Final = 1e-7
"""m. Lower rebounds are not followed. This height is a hundred times `GRAZING_DEPTH`, and far below the
roughness of surfaces."""

LEAST_FRICTION: Final = 1e-20
"""Dimensionless. Less friction in an impact in space counts as none: it changes velocities by far less than
they are rounded by. Below 1e-34 the energetic law gave bodies energy out of rounding, without a limit."""

SAME_CORNER: Final = 1e-5
"""m. Corners of a body nearer to each other are one corner in a whole toss: ten times the height of rebounds
that are not followed. Of 200 drawn boxes with two corners in place of each, up to 10 micrometres apart, 12
did not come to rest, all of them below 1 micrometre. Of 700 others 5 did not, none beyond 2.5."""

SAME_CORNER_SHARE: Final = 1e-4
"""The same, relative to the reach of the body, for small bodies."""

SETTLING_HEIGHT: Final = 1e-6
"""m. In a whole toss, a contact whose rebounds are lower stays, and a body that can only rise or slide so far
rests. It is a hundredth of what motion capture resolves, and below the roughness of most surfaces."""

SAMPLED_SETTLING_HEIGHT: Final = 1e-4
"""m. The same in samples of an uncertain toss. It is far below how far samples are apart, which is some
centimetres at rest, and it takes half of the time."""

EXACT_SHARE: Final = 1e-12
"""Share of the largest variance of samples that each direction has at least, so that a quantity which is
exact in some direction has distances. It is far above the rounding of variances, 1e-16."""

SAMPLED_ARRIVAL: Final = 1e-7
"""m. A corner of a sample that is nearer to a flat has arrived. At 1 m/s this is 1e-7 s."""

SAMPLED_PHASE_ERROR: Final = 1e-3
"""m, or m/s. The error that a step of a contact phase of a sample may have. Velocities after strikes of
recorded cubes are twenty times as uncertain."""

FACE_ROUNDING: Final = 1e-9
"""Relative to the reach, or to the face. What is outside a face by less is on its border. Corners carry 1e-16
of rounding."""

STRIKES: Final = 1e-9
"""m/s. A contact of a whole toss that approaches faster strikes. As `VELOCITY_TOLERANCE`."""

STILL_TOUCHING: Final = 1e-8
"""m/s. A contact of a whole toss that leaves more slowly stays for contact modes to judge. It is above the
rounding of impacts at several contacts, which end at `STRIKES`."""

SLIDING_STOPPED: Final = 1e-6
"""m/s. A contact of a whole toss that slides more slowly has stopped. Friction of 0.1 takes a microsecond for
the rest, in which the contact slides by less than 1e-12 m."""

RESOLVED_SLIDING: Final = 50.0
"""Relative to the error of a step of a contact phase. Slower contacts that are stopping have stopped, if
friction holds them: their direction turns within a step. Contacts were seen to slide on at 15 to 28 times the
error, for ten thousands of steps, although friction took the speed of each in microseconds."""

COARSE_SLIDING_STOPPED: Final = 1e-4
"""m/s. The same for large errors, of samples too. Friction of 0.1 stops that within 5e-9 m."""

SLIDING_DIRECTION_SPEED: Final = 1e-9
"""m/s. At much lower speeds, the direction in which sliding begins counts, and not that of the velocity,
whose digits are rounding."""

SAME_FORCES: Final = 1e-10
"""Ratio of singular values. Below it, combinations of contact forces cause no acceleration, and the least
ones are taken."""

FORCE_ROUNDING: Final = 1e-9
"""Relative to the weight, or to the largest force. A contact that pulls by less may stay."""

CONE_SWEEPS_CONVERGED: Final = 1e-12
"""Relative to the largest velocity or acceleration. A sweep over the contacts that changes less is the last,
since it is near rounding."""

CONE_CREEPS: Final = 1e-6
"""Relative to the largest velocity. Where impulses of contacts against each other creep on from sweep to
sweep, and hardly change the velocities, a sweep that changes less is the last."""

SHORT_STEP_CREEPS: Final = 1e-4
"""The same in short steps (`toss.short_step`). Their own error, of first order, is larger."""

BEGINNING_ROUNDING: Final = 1e-7
"""Relative to gravity. Where a contact begins to slide, its acceleration may be off the direction of friction
by this much. Accelerations carry the rounding of forces, `FORCE_ROUNDING`, times some ten."""

BEGINNING_TURN: Final = 1e-4
"""rad. By so much the direction in which a contact begins to slide is turned, to see how accelerations
change. Their rounding is then a thousandth of the change, and so is what a straight line misses of it."""

BEGUN_TO_SLIDE: Final = 1e-3
"""m/s. Below this speed, a contact that begins to slide does so along its acceleration. At 1e-3 m/s, friction
of 10 m/s^2 turns the sliding in 1e-4 s, which is as short as a step of a phase should be."""

HELD_DRIFT: Final = 1e-11
"""m, or m/s. A held contact that is off by less is left as it is. It is a hundredth of `GRAZING_DEPTH` and of
`STRIKES`."""

SUNK: Final = 1e-10
"""m. A body of a whole toss whose corners are deeper in a flat is taken out of it. It is a tenth of
`GRAZING_DEPTH`."""

PHASE_ERROR: Final = 1e-7
"""m, or m/s. The error that a step of a contact phase may have. It is a tenth of `SETTLING_HEIGHT`."""

LEAST_PHASE_ERROR: Final = 1e-15
"""m, or m/s. Doubles tell no less apart on the way of a toss. It would take its shortest steps in vain."""

PHASE_LEAST_STEP: Final = 1e-13
"""s. A step this short is taken whatever its error, and events are found to this time."""

COMES_DOWN_FOUND: Final = 1e-12
"""m. A corner that is below a flat by less has just come down. It is a thousandth of `GRAZING_DEPTH`."""

FORCE_END_FOUND: Final = 1e-3
"""Relative to the force that counts as none. A force that is beyond that by less has just left its cone."""

LIFT_OFF_PAUSE: Final = 1e-6
"""s. A contact that lifts off begins without speed. It is looked for again after this time, in which the body
moves by less than 1e-11 m relative to it."""

RESTING_ACCELERATION: Final = 1e-6
"""Relative to gravity. A body with less acceleration, and hardly any velocity, rests. A cube that balances on
an edge is off balance by less than 1e-7 of its size then."""

HELD_STILL: Final = 0.01
"""Share of the speed that a step of free motion gives to a held contact. This much may be left where several
held contacts throw each other back."""

CHATTER_PAUSE: Final = 1e-6
"""s. If rounding makes a leaving contact look like an arriving one, the search goes on after this time."""

HELD_INDEPENDENT: Final = 1e-9
"""Ratio of singular values. Below it, the directions in which jammed contacts are held count as the same."""

ESCAPE_ARRIVED: Final = 1e-16
"""Relative. The last of Newton's steps towards the direction in which a contact leaves its stop: below the
last bit."""

MODE_STRAIGHT: Final = 1e-8
"""rad. Friction that misses the direction against the sliding by no more opposes it to rounding."""

MODE_RESTS: Final = 1e-12
"""Relative to the load. Forces that hold a body may leave so much of it unbalanced."""

MODE_BETTER: Final = 1e-2
"""Relative. Forces replace others where they leave less than this part of what those left unbalanced. A
smaller gain would be rounding."""

CAREFUL_UNMET: Final = 1e-9
"""Relative to the largest acceleration. Equations that count as the same may demand accelerations that differ
by so much, as where centripetal terms are rounded."""

CAREFUL_LEAST_PIVOT: Final = 1e-13
"""Entries of the table that are no larger may be the rounding of the doubles from which it is made."""

TABLE_SMALL_PIVOT: Final = 1e-3
"""Division by a larger entry counts as harmless. The rounding that it adds is within `FEASIBLE`."""

TABLE_ROUNDING: Final = 1e-16
"""Relative. Doubles lose so much in a step or two."""

SLOWEST_SHARED: Final = (1e-3, 1e-5, 1e-7, 3e-8)
"""Relative to the largest acceleration. Contacts that share a load are made to slide at least so fast, one
after another, since forces at rest would also do at zero."""

ALONE_WITHIN: Final = (0.3, 0.1, 0.03, 0.01, 0.003)
"""rad. These ranges of directions around a solution are tried, and the first is taken that has no other one.
Instead of smaller ones it is as fast to part ranges."""

NARROWEST_RANGE: Final = 1e-5
"""rad. A range of sliding directions is not parted further if it is narrower. Then it is undecided whether
there is a mode in it."""

SAME_SLIDING: Final = 1e-3
"""rad. Modes with the same letters may count as one where no direction of sliding differs by more. Bounds
cannot tell them apart where the equations are nearly singular."""

LETTERS_SETTLED: Final = 1e-13
"""Relative to the largest acceleration. The equations may be missed by so much in the last step."""

LETTERS_REGULAR: Final = 1e-11
"""Ratio of singular values. Below it, the unknowns count as dependent, because loads are shared."""

NEARLY_ALIKE: Final = 1e-3
"""rad. Normals that differ by less and by more than `FLUSH`, or are opposite but for that, as in a slot whose
walls lean by 1e-5 rad, may have forces between them that are a million times the load. The modes of
friction pyramids are sought then, too."""

NARROWLY: Final = 1e-11
"""Relative to the largest acceleration. Where no mode holds by `STRICT`, one must hold by this. It is a
hundred times `LETTERS_SETTLED`."""

LETTERS_NO_FORCE: Final = 1e-9
"""Relative to the largest force. Where contacts share loads, one with less force has none."""

LETTERS_ON_CONE: Final = 1e-10
"""Relative. A force that sticks may lie so far outside of its cone."""

ONE_CONTACT_ON_CONE: Final = 1e-9
"""Relative. A force that sticks may lie so far outside of its cone. Sliding begins just as strictly."""

ONE_CONTACT_ZERO: Final = 1e-13
"""Relative to the largest acceleration, and to the largest coefficient. Less counts as rounding."""

ONE_CONTACT_ON_CIRCLE: Final = 1e-3
"""A root may lie so far from the unit circle before it is polished. Double roots are known to half the
digits."""

ONE_CONTACT_SAME_ANGLE: Final = 1e-6
"""rad. Two roots within it are one."""

ROUND_CONE_HELD: Final = 1e-11
"""Relative to the load. Forces that hold the contacts may leave so much of it unbalanced."""

ROUND_CONE_NO_HELP: Final = 1e-12
"""A cosine, between the effect of a force and the remainder. A smaller one counts as rounding."""

ROUND_CONE_ACROSS: Final = 1e-9
"""The same cosine. Below it, rounding of the contacts' normals may decide whether a force helps."""

ROUND_CONE_INDEPENDENT: Final = 1e-15
"""Ratio of singular values. Smaller ones count as rounding."""

ROUND_CONE_APART: Final = 1e-13
"""Dimensionless, for rows of unit length. Rows that differ by more do so by more than rounding."""

ROUND_CONE_ON_CONE: Final = 1e-12
"""Relative to the largest force. A force may lie so far outside of its cone."""

ROUND_CONE_REACHED: Final = 1e-10
"""Relative. All forces together count as having at least this effect in every direction. So what they leave
unbalanced is not divided by rounding."""

ROUND_CONE_ROUNDING: Final = 1e-13
"""Relative. A smaller remainder is rounding, and refutes nothing."""

ROUND_CONE_NEAR: Final = 1e-3
"""Relative to the load. A remainder is freed from the rounding of the forces only if it is smaller. Their
rounding is nothing beside a larger one."""

ROUND_CONE_WIDE: Final = 1e-6
"""Relative to the load. That wide friction cones do not hold it is certain only if they leave more than this,
because forces in them are found in many steps."""

# calibration

NEGLIGIBLE_GAIN: Final = 1e-4
"""Squares of standard deviations. A calibration has converged where the next step would gain less: the
estimate is then within a hundredth of its own standard deviation."""

DERIVATIVE_STEP: Final = 1e-5
"""Standard units of parameters. Step of numerical derivatives: the impact's rounding of 1e-13 becomes 1e-8 of
the slope, and its curvature adds 1e-5."""

SPREAD_FOUND: Final = 1e-3
"""Relative. A variance is known to this, which is far better than its estimate from any number of strikes."""

SAME_FACE: Final = 1e-6
"""Half sizes. A corner so near to a face's plane belongs to the face. Configured corners have six digits."""

LEAST_STEP_OF_SURFACE: Final = 0.01
"""Half sizes. A surface that bends by less over the places that were touched counts as flat."""

LEAST_LAW_VELOCITY: Final = 1e-3
"""m/s. Least spread of the law of impact in fits of trajectories. Without any, a velocity after a strike
would hang on rounding; this is below what any tracking system tells."""

LEAST_LAW_SPIN: Final = 1e-2
"""rad/s. The same for angular velocities."""

# toss

SWEEPS_CHANGE_ALIKE: Final = 1e-3
"""Ratio of singular values. Below it, changes by sweeps over contacts count as the same."""

SHORTEST_LINGER: Final = 1e-5
"""s. If rounds of a toss take less time, it is not followed by them, but for so long in short steps."""

BUSY: Final = 0.01
"""s. If a toss needs hundreds of strikes and modes within this time, its contacts chatter."""

CREEPING_STEP: Final = 1e-6
"""s. A contact phase whose steps are that short again and again creeps."""

LONGEST_SHORT_STEP: Final = 2e-4
"""s. A short step is no longer. A body that turns by 10 rad/s meanwhile turns by a tenth of a degree."""

SHORTEST_SHORT_STEP: Final = 1e-7
"""s. A short step may be this short, where a corner comes down."""
