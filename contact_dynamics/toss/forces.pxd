# SPDX-License-Identifier: Apache-2.0
# The types with which forces.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.solid cimport Above, Flat, Held, Pose, Solid

cdef extern from *:
    # A checksum of forces.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double DISTANCE_TOLERANCE, FORCE_ROUNDING, HELD_DRIFT, SAME_FORCES, SLIDING_DIRECTION_SPEED
cdef double SLIDING_STOPPED, SUNK, _DIRECTION_SURE, _INFINITE
cdef int _ROW, _MOMENT, _FORCE, _TURNING, _WANTED, _SIZE, _WIDTH, _MAX_SWEEPS


# Without cycles, the garbage collector need not look at what is made for each state.
@cython.final
@cython.no_gc
@cython.freelist(8)
cdef class Equations:
    cdef int count
    cdef double[::1] table, matrix

    @cython.locals(t=cython.double[::1])
    cdef void add(self, Pose pose, (double, double, double) arm, (double, double, double) row, (double, double, double) force, double wanted) noexcept
    cdef (double, double, double) part(self, int k, int first) noexcept
    cdef void respond(self, double per_mass) noexcept
    @cython.locals(t=cython.double[::1], m=cython.double[::1])
    cdef int solve(self, double per_mass) except -1
    @cython.locals(row=cython.int, found=cython.int, k=cython.int, enough=cython.double, largest=cython.double,
                   square=cython.double)
    cdef int _solve_many(self) noexcept
    @cython.locals(n=cython.int, j=cython.int, total=cython.double)
    cdef double _product(self, int i, int k) noexcept
    @cython.locals(t=cython.double[::1], m=cython.double[::1], n=cython.int, i=cython.int, j=cython.int,
                   wanted=cython.double, along=cython.double)
    cdef void _meet(self, int row, double length) noexcept
    cdef double size(self, int k) noexcept
    cdef (double, double, double) summed(self, (double, double, double) start, int first, double factor) noexcept


@cython.final
@cython.no_gc
@cython.freelist(8)
cdef class HeldContacts:
    cdef readonly Solid solid
    cdef readonly tuple mode
    cdef readonly Pose pose
    cdef readonly double[13] rates
    cdef readonly int count
    cdef int others
    cdef bint is_flush, begins
    cdef Equations equations
    cdef double[::1] numbers
    cdef double[13] y

    cpdef (double, double, double) force(self, int i) noexcept
    cdef void set_force(self, int i, double x, double y, double z) noexcept
    @cython.locals(one=Held, flat=Flat, k=cython.int, i=cython.int)
    cdef void accelerate(self, double* y)
    cdef void push(self, double* y)
    cdef void choose_forces(self)
    cdef void _set_rates(self, double* y, (double, double, double) a, (double, double, double) alpha) noexcept
    cpdef (double, double, double) accelerated(self, int flat, int corner) noexcept
    @cython.locals(one=Held, flat=Flat, least=cython.double)
    cpdef double least_left(self) noexcept
    @cython.locals(flat=Flat, left=cython.double, pressing=cython.double, force=(double, double, double))
    cdef double friction_left(self) noexcept
    @cython.locals(one=Held, flat=Flat, numbers=cython.double[::1], begin=cython.int)
    cdef bint _slide_flush(self, double* y) noexcept
    @cython.locals(
        flat=Flat, k=cython.int, a=(double, double, double), b=(double, double, double),
        c=(double, double, double), moved=(double, double, double),
    )
    cdef bint _tips(self) except -1
    @cython.locals(one=Held, other=Held)
    cdef bint _share_between_two(self) noexcept
    @cython.locals(one=Held, other=Held, flat=Flat)
    cdef void _share_along_edge(self) noexcept
    @cython.locals(one=Held, other=Held, flat=Flat, flat_other=Flat)
    cdef void _squeeze(self) noexcept
    @cython.locals(one=Held)
    cdef void aim(self, double* y) noexcept
    cdef void aim_as(self, HeldContacts other) noexcept
    @cython.locals(one=Held, flat=Flat, largest=cython.double)
    cdef void hold(self, double* y)


cdef double _room_along((double, double, double) force, (double, double, double) n, double along, double friction) noexcept
cdef (double, double) _within_cone((double, double, double) force, (double, double, double) u, (double, double, double) n, double friction) noexcept
cpdef double force_rounding(Solid solid) noexcept
cdef void normalise(double* y) noexcept
cdef void slow_down(double* y, Equations equations, double per_mass) noexcept
cdef void move_back(double* y, Equations equations, double per_mass) noexcept
@cython.locals(pose=Pose, equations=Equations, flat=cython.int, corner=cython.int, now=cython.double, least=cython.double)
cdef void _lift(Solid solid, Above above, double* y)
cpdef HeldContacts pushed_by_contacts(Solid solid, list y, tuple mode)
cpdef list held_in_place(Solid solid, list y, tuple mode)
cpdef list held_as_they_are(Solid solid, list y, tuple mode)
cpdef list out_of_flats(Solid solid, list y, Above above=*)
@cython.locals(flat=Flat, pose=Pose, equations=Equations)
cpdef list without_rebounds(Solid solid, list y, list touching)
