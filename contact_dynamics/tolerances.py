"""Every threshold of the physics: its name, its unit, and why it has that size, chapter by chapter.

A threshold decides whether a number counts as zero, two things as one, or an iteration as done. All that are
a hundredth or less stand here, and a test over the sources holds it. A threshold that a caller may want to
change is a default here and an argument or parameter there.

What stands beside its code instead: bounds on work and length (`MOST_...`), how a computation is cut up
(`CHUNK`, `TERMS`, `PIECE`), shares and angles above a hundredth that only choose between two ways to the same
answer, and the digits of each kind of number (`numerics.arithmetic`), which belong to the kind.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Final

# What comes in

UNIT_LENGTH_TOLERANCE: Final = 1e-3
"""Dimensionless. A quaternion or normal whose norm is off by more is refused, not repaired.

Quaternions that went through float32 or four printed decimals are off by at most 2e-4; one that was never
normalised, or has its components in another order than expected with one missing, is off by far more.
"""

LENGTH_ROUNDING: Final = 1e-15
"""Dimensionless. A vector that was scaled to length 1 has it within this, and stays as it is: scaling twice
changes nothing."""

LARGEST_NUMBER: Final = 1e60
"""In SI units: s, rad/s, kg m^2, m, m/s, m/s^2. A motion is refused whose numbers are larger, or whose
moments of inertia are below the inverse: fourth powers and products of such numbers leave the range of
doubles. Rates below the inverse count as rest: in the age of the universe they turn nothing."""

# numerics

SMALL_SHARE: Final = 1e-10
"""Of the squares of the residuals of a fit: a round that explains less of them is the last. The parameters
are then changed by some 1e-5 of their standard deviations, and by far less in a round to come."""

NO_PIVOT: Final = 1e-11
"""Relative to the largest entry of a column in Lemke's method: what is smaller is rounding, not a pivot."""

COVERED: Final = 1e-12
"""Relative to the largest of q in Lemke's method: the size of the covering variable that counts as zero."""

WRENCH_ROUNDING: Final = 1e-13
"""Relative to the wrench that contact forces balance: what is left over and is no more is rounding."""

INDEPENDENT_FORCES: Final = 1e-12
"""Ratio of singular values below which directions of contact forces count as the same."""

# rigid_body

SYMMETRY_TOLERANCE: Final = 1e-9
"""Relative to the largest entry. An inertia matrix that is less symmetric than this was not meant as one."""

NEGATIVE_VARIANCE_TOLERANCE: Final = 1e-9
"""Dimensionless, of a correlation matrix, whose entries are at most 1: how negative an eigenvalue may be.
Rounding of a covariance that has no variance in some direction leaves 1e-15, of one that went through filters
some more."""

TRIANGLE_TOLERANCE: Final = 1e-6
"""Relative to the largest principal moment. I1 + I2 >= I3 holds with equality for flat bodies, and measured
or rounded moments of a flat body miss it by their last printed digit."""

EQUAL_MOMENTS_TOLERANCE: Final = Decimal("1e-12")
"""Relative to the largest principal moment. Two moments within it are called equal when a rotation is named:
turning an inertia matrix into other axes in doubles parts equal moments by some 1e-16, real bodies of one
shape differ by far more. The motion itself is computed with the moments as they are."""

SUM_ROUNDING: Final = 1e-14
"""Relative to the largest of a sum's terms: some ten times what they are rounded by, with room. What is left
of a difference and is no more counts as zero."""

VOLUME_ROUNDING: Final = 1e-13
"""Relative to a surface's area times its size, m^3. A volume within it is rounding: the surface is flat."""

SURFACES_TOUCH: Final = 1e-9
"""Relative to a part's size. Surfaces nearer than this touch; what lies between them is not looked for."""

EPSILON: Final = 2.0**-52
"""Relative, of coordinates: what rounding moves them by. Points within it of a plane lie in the plane; far
from the origin it is a volume too."""

AXIS_TIE: Final = 1e-9
"""Dimensionless, between components of a unit axis, of which the largest decides the sign: far above the
rounding of, say, (1, 1, 0) / sqrt(2)."""

EXACTLY_EQUAL_MOMENTS: Final = Decimal("1e-110")
"""Relative to the largest moment. Moments closer than this are equal in the tumbling formulas too: Jacobi's
rotations leave this much in 120 digits."""

# tumbling

STEADY_AXIS_TOLERANCE: Final = Decimal("1e-24")
"""Squared angle, rad^2, between L and the major or minor axis within which spin is called steady: an angle of
1e-12 rad, well above the rounding of a quaternion and an angular velocity."""

NEGLIGIBLE_TERM: Final = 1e-18
"""Relative to the largest term of a sum of theta functions: far below the last bit."""

SMALLEST: Final = 1e-300
"""In any unit: stands for zero where a quotient or a logarithm of it is wanted. Added to a sum that is 0, it
makes a quotient 0 that would be 0/0 and is meant as 0."""

SEPARATRIX_END: Final = 1e-6
"""rad of Jacobi's amplitude, where the polhode of a single flip is cut off. The motion is this near to spin
about the middle axis 14 time constants before and after its flip."""

SMALLEST_COMPLEMENT: Final = 1e-100
"""Of 1 - m, the parameter's complement. Below it the sensitivity of a tumbling body is beyond 1e90: it is
then called infinite."""

MOTIONLESS: Final = 1e-60
"""Squared angle, rad^2, between the angular velocity and the major or minor axis, below which the spin is
taken as steady. The motion left out is an angle of 1e-30 rad for ever, since spin about these axes is
stable."""

# motion

SMALL_TURN: Final = 1e-2
"""rad. Neighbours of a free rotation are followed in one piece where they turn by less; for larger turns the
derivative loses two digits at the most."""

GROWTH_ROUNDING: Final = 1e-15
"""Relative. What grew by a factor and shrank by it again carries this rounding, times the factor squared."""

LARGEST_DERIVATIVE_ERROR: Final = 1e-3
"""Relative. Where neighbours parted and met again by so much that less is known of the derivative, it is
NaN."""

SMALL_STEP: Final = 1e-9
"""rad of attitude, m of position, anywhere in the window of a fit: a round that changes less is the last."""

INTEGRATION_RELATIVE: Final = 3e-14
"""Relative error of each step of an integrated motion. SciPy allows 2e-14 at the least, where rounding begins
to make steps pointlessly short."""

INTEGRATION_ABSOLUTE: Final = 1e-15
"""m, m/s, rad and rad/s of each step of an integrated motion: far below what any sensor resolves."""

DIFFERENCE_STEP: Final = 1e-5
"""m, rad, m/s and rad/s, by which a user's function is differenced, or that part of a larger number. Central:
it errs by 1e-10 of the third derivative, and by 1e-11 of the force for rounding."""

LEAST_NOISE: Final = 1e-12
"""m and rad. Residuals of exact states are rounding, which is no measure of how positions weigh beside
orientations: the noise of a fit counts as at least this."""

# shapes

FLAT_HULL: Final = 1e-9
"""Relative to the size: a hull thinner than this is a plate or a rod. Corners carry 1e-16 of rounding."""

SAME_DIRECTION: Final = 1e-9
"""1 - cos of the angle, 4e-5 rad, within which normals, or directions of edges, are one."""

# contact

VELOCITY_TOLERANCE: Final = 1e-9
"""m/s. A contact's velocity below it counts as zero where no other tolerance is asked for: far above the
rounding of velocities of up to 1e4 m/s, far below what any sensor resolves. Measured states need their noise
level instead."""

DISTANCE_TOLERANCE: Final = 1e-6
"""m. A point within it of a surface touches, where no other tolerance is asked for."""

ROW_TOLERANCE: Final = 1e-9
"""Dimensionless, on rows of unit length: the sine of the angle within which contact planes (and wrenches)
coincide, in the enumeration of modes as in their dynamics. Contact rows carry some 1e-15 of rounding, a
hundred times that for contacts far from the centre of mass; what is built from two planes that meet at 1e-5
is still right within it."""

SAME_POINT: Final = 1e-9
"""m. Points this close are one, and directions whose separation is less by no more are as good: rounding."""

PARALLEL_EDGES: Final = 1e-6
"""Sine of the angle within which edges, or the sides of outlines, do not cross; their ends are what
touches."""

# plane

OUT_OF_PLANE_SPEED: Final = 1e-6
"""m/s. Motion out of the plane of a planar question that still counts as none, where no other tolerance is
asked for."""

OUT_OF_PLANE_RATIO: Final = 1e-2
"""Dimensionless: the sine of the angle (0.6 degrees) by which normals, forces and principal axes may lean out
of a plane of motion. Motion capture resolves 0.1 degrees. The planar answer is then wrong by a part in 1e4,
the cosine's second order."""

# landing

SAME_ROWS: Final = 1e-11
"""Dimensionless, in the plane: the sine below which contact planes, and wrenches, are one where modes are
enumerated, and the part of the radius of gyration (or of the arm, if longer) and of the unit normal within
which contacts are one. Some 1e5 roundings of the input, and far below what any sensor resolves."""

CLEAR_ROWS: Final = 1e-4
"""Dimensionless: the sine above which floats tell contact planes, and wrenches, apart, to within `SAME_ROWS`.
Between the two, what is the case is found with more digits."""

DECIMALS_ZERO: Final = Decimal("1e-60")
"""Relative: what decimals of `DECIMALS.sums` leave of zero, with room for products of products."""

TARGET_ROUNDING: Final = Decimal("1e-14")
"""Relative: the target's own rounding. Columns that differ by no more would need huge shares to meet it."""

DECIMALS_MET: Final = Decimal("1e-30")
"""Relative: what may be left over where all is met."""

SAME_SHARP_ROWS: Final = 1e-14
"""The sine below which rows that are known better than to floats are one: friction that never slips leaves of
a contact's normal no more than 1e-10 of the tangent, and short arms less."""

INDEPENDENT_EQUATIONS: Final = 1e-6
"""The pivot of unit rows below which equations do not count as independent: their solution would carry more
rounding than the accuracy asked for."""

FORCES_ROUNDING: Final = 1e-13
"""Relative to the forces: what sums of them leave."""

SAME_IMPULSES: Final = 1e-8
"""Relative to the largest impulse: two ways to a solution that differ by less have found the same one."""

LARGEST_GRIP: Final = 1e10
"""Dimensionless, in the plane: a coefficient of friction above it, or above it divided by the contact's arm
in radii of gyration, acts as that one does. They differ in forces whose normal part is less than 1e-10 of
the wrench of the tangential one, below what wrenches are known to."""

GRAZING_DEPTH: Final = 1e-9
"""m. A point that dips into a plane by less, and rises again, may be overlooked by the search for the first
contact; deeper ones never are. Far below what sensors resolve, and enough for the search not to creep."""

RIM_ACCURACY: Final = 1e-9
"""Relative, of the last of Newton's steps towards the landing of a rim, after which the square of it is left;
at an all but double root as much again, where the depth is its square."""

LEAVING_STEP: Final = 1e-5
"""s, the step away from an obstacle where nothing pulls towards it."""

# contact_modes

ACCELERATION_TOLERANCE: Final = 1e-9
"""Relative to the applied wrench, and what centripetal terms add to it. An acceleration or a force counts as
zero where a change of the wrench by that part of it turns its sign: far more than rounding of the input, far
less than wrenches are known to."""

BEYOND_MARGIN: Final = 1e-5
"""Part of a margin (or of the wrench, where the margin is less) by which the boundary is passed to see what
lies behind: far more than the tolerances that make the boundary, far less than the way to the next one."""

SAME_MOTION: Final = 1e-6
"""Relative: how far two motions may lie apart that count as one. They are those of two modes, or the ends of
what one mode allows, which is then unique."""

FEASIBLE: Final = 1e-11
"""Relative to the largest acceleration, and to edge forces that cause it: what a condition of a mode may
miss. Some thousand roundings, and a hundredth of the least strictness asked for."""

STRICT: Final = 1e-8
"""Relative to the largest acceleration: what an inequality of a mode must have to hold strictly. A thousand
times `FEASIBLE`."""

AT_SECTORS_BORDER: Final = 1e-9
"""In sectors of a friction pyramid: how far beyond its border a sector's edge still counts as acting."""

TRIAL_TURN: Final = 1e-6
"""rad, by which a direction of friction is turned to see how the sliding turns; about the root of
rounding."""

SETTLED_DIRECTION: Final = 1e-11
"""rad. Directions of friction that are as close as that to those of sliding are those of the rounded
forces."""

ON_PYRAMIDS_SIDE: Final = 1e-9
"""Relative to the largest force: how far outside of a pyramid still counts as on its side. A force as small
as that has no direction either."""

BEHIND_BOUNDARY: Final = 1e-5
"""Relative to the wrench: how far behind a boundary of a mode's wrenches is looked, a thousand times
`STRICT`."""

ALONG_BOUNDARY: Final = 1e-3
"""Relative to the wrench: how far from the boundary's own borders that is done."""

ON_BOUNDARY: Final = 10.0 * ROW_TOLERANCE
"""On unit rows: how far outside of a cone of wrenches still counts as on its boundary."""

NO_DISTANCE: Final = 1e-7
"""Relative to the applied wrench: a distance to a mode's wrenches that counts as none. Ten times what the
weight of a wrench's height in that distance leaves."""

# impact

ENERGY_TOLERANCE: Final = 1e-12
"""Relative to the energy that an impact exchanges. A gain above it is a law that creates energy, not
rounding, which is some 1e-15 of the terms that energy is summed from."""

LEAST_PIVOT: Final = 1e-30
"""Relative to its diagonal entry: the least pivot of an inertia matrix, which is > 0 but for rounding."""

STRAIGHT: Final = 1e-12
"""Dimensionless, of the sliding law's scale. A direction of sliding that turns more slowly is invariant: what
turns it is the rounding of contact axes and inertia, some 1e-15, which an unstable direction would
amplify."""

UNCOUPLED: Final = 1e-15
"""Dimensionless, of the tangential inverse inertia. A slower turn than this is the rounding of a coupling
that is zero, as of a sphere's, whose scale is rounding too."""

STOPPED: Final = 1e-13
"""Dimensionless, of the first sliding speed. The error in impulse from going the rest of the way straight is
below this part of the impulse that stops the contact."""

LAST_TERM: Final = 1e-15
"""Relative to the sum, of the series that leads to a stop. What is left out is of the size of the last
term."""

AT_THE_STOP: Final = 1e-15
"""rad. The last of Newton's steps towards the direction in which sliding stops."""

SLOW_TURNING: Final = 1e-12
"""Relative. Turning counts as slow where (|h| + |h'|)/|g|, to the power of the terms and times the speed, is
below this part of the first speed: there the iteration has a prospect of `LAST_TERM`."""

TRUNCATION: Final = 1e-14
"""Relative. The last terms of the series of u and |u| may be this part of |u| where a stretch of sliding
ends; the terms left out are smaller."""

EVENT_LOCATED: Final = 1e-15
"""Relative. Newton's method has located an event of an impact where its next step is within it."""

SWEEPS_CONVERGED: Final = 1e-13
"""Relative to the largest approach velocity: what a sweep over impulses at once may still change in the
contacts' velocities."""

SHORT_TIMES: Final = (1e-7, 1e-5, 1e-3)
"""What the wrench may change of a jammed body's velocities in the time it acts, relative to the largest
speed: the first that rounding does not keep from an answer is taken."""

CHATTER_HEIGHT: Final = 1e-7
"""m. Rebounds lower than this are not followed: a hundred times what the search for the first contact may
overlook, and far below the roughness of surfaces."""

HELD_STILL: Final = 0.01
"""Of the speed that a step of free motion gives a contact that is held: what may be left of it, where several
contacts that are held throw each other back."""

CHATTER_PAUSE: Final = 1e-6
"""s. When to look again where a contact that leaves, at the height of rounding, was found as arriving."""

HELD_INDEPENDENT: Final = 1e-9
"""Ratio of singular values below which the directions in which jammed contacts are held count as the same."""

ESCAPE_ARRIVED: Final = 1e-16
"""Relative. The last of Newton's steps towards the direction in which a contact leaves its stop: below the
last bit."""

MODE_STRAIGHT: Final = 1e-8
"""rad, misdirection of friction that is rounding."""

MODE_OBLIQUE: Final = 1e-3
"""rad: surfaces that lean less are flush. Several modes are rare there with usual friction."""

MODE_RESTS: Final = 1e-12
"""Relative to the load: what forces that hold a body may leave over."""

MODE_BETTER: Final = 1e-2
"""Relative: less is rounding."""

CAREFUL_UNMET: Final = 1e-9
"""Relative to the largest acceleration: by how much equations that count as the same may ask for different
accelerations, as where centripetal terms are rounded."""

CAREFUL_LEAST_PIVOT: Final = 1e-13
"""Entries of the table up to it may be rounding of the doubles that it is made from."""

TABLE_SMALL_PIVOT: Final = 1e-3
"""Division by a larger one counts as harmless: what rounding it adds is in `_FEASIBLE`."""

TABLE_ROUNDING: Final = 1e-16
"""Relative: what doubles lose in a step or two."""

LETTERS_SETTLED: Final = 1e-13
"""Relative to the largest acceleration: what the equations may miss, in its last step."""

LETTERS_REGULAR: Final = 1e-11
"""Ratio of singular values below which the unknowns count as dependent: loads are shared."""

LETTERS_ON_CONE: Final = 1e-9
"""Relative: how far outside of its cone a force that sticks may lie."""

ONE_CONTACT_ON_CONE: Final = 1e-9
"""Relative: how far outside of its cone a force that sticks may lie. Sliding begins as strictly."""

ONE_CONTACT_ZERO: Final = 1e-13
"""Relative to the largest acceleration, and to the largest coefficient: rounding."""

ONE_CONTACT_ON_CIRCLE: Final = 1e-3
"""How far from the unit circle a root may lie before it is polished: double roots are half as exact."""

ONE_CONTACT_SAME_ANGLE: Final = 1e-6
"""rad, within which two roots are one."""

ROUND_CONE_HELD: Final = 1e-11
"""Relative to the load: what forces may leave over that hold the contacts."""

ROUND_CONE_NO_HELP: Final = 1e-12
"""Cosine, of a force's effect to what is left over, below which it is rounding."""

ROUND_CONE_INDEPENDENT: Final = 1e-15
"""Relative: less is rounding."""

ROUND_CONE_APART: Final = 1e-13
"""Dimensionless, on rows of unit length: those that differ by more do so by more than rounding."""

ROUND_CONE_ON_CONE: Final = 1e-12
"""Relative to the largest force."""

ROUND_CONE_REACHED: Final = 1e-10
"""Relative: what all forces together do less than that in some direction is nothing."""

ROUND_CONE_ROUNDING: Final = 1e-15
"""Relative: what doubles lose in a step or two."""
