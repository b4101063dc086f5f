# SPDX-License-Identifier: Apache-2.0
# The types with which solid.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec

cdef extern from *:
    # A checksum of solid.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double SLIDING_DIRECTION_SPEED, _INFINITE


@cython.final
cdef class Flat:
    cdef readonly str name
    cdef readonly (double, double, double) normal
    cdef readonly ((double, double, double), (double, double, double)) tangents
    cdef readonly double level, friction, restitution, strike_friction, lasting_speed, static_ratio

    cpdef double friction_at(self, double rate) noexcept
    cpdef double holding(self) noexcept


cdef class Above


@cython.final
@cython.no_gc
cdef class Solid:
    cdef readonly double mass, rounding, reach, settling
    cdef readonly (double, double, double, double, double, double, double, double, double) inertia, inverse
    cdef readonly tuple indices, flats
    cdef readonly (double, double, double) gravity
    cdef readonly int count
    cdef double[::1] points
    cdef Above above
    cdef object properties

    cpdef (double, double, double) corner(self, int k) noexcept
    @cython.locals(j=cython.int, k=cython.int, flat=Flat)
    cpdef void take(self, const double[:, ::1] rows, Py_ssize_t i) except *


@cython.final
@cython.no_gc
@cython.freelist(16)
cdef class Held:
    cdef readonly tuple touch
    cdef readonly bint slides, begins
    cdef readonly (double, double, double) towards
    cdef readonly int flat, corner


@cython.final
@cython.no_gc
@cython.freelist(8)
cdef class Pose:
    cdef readonly Solid solid
    cdef double[13] y
    cdef readonly (double, double, double) position, v, w, alpha
    cdef readonly (double, double, double, double, double, double, double, double, double) rows, inverse

    cdef void take(self, double* y) noexcept
    @cython.locals(touched=Flat)
    cpdef (double, double, double) arm(self, int flat, int corner) noexcept
    cpdef (double, double, double) velocity(self, (double, double, double) arm) noexcept
    cpdef (double, double, double) sliding(self, (double, double, double) arm, (double, double, double) normal, (double, double, double) towards) noexcept
    @cython.locals(touched=Flat)
    cpdef (double, double, double) acceleration(self, int flat, (double, double, double) arm, (double, double, double) a, (double, double, double) alpha) noexcept
    @cython.locals(touched=Flat)
    cpdef double height(self, int flat, int corner) noexcept
    cpdef double kinetic_energy(self) noexcept


@cython.final
@cython.no_gc
cdef class Above:
    cdef readonly int count
    cdef double[::1] heights, rates
    cdef readonly double least
    cdef double[13] y

    @cython.locals(flat=Flat, least=cython.double)
    cdef void take(self, Solid solid, double* y) noexcept


cpdef (double, double, double, double, double, double, double, double, double) rows_of(double x, double yy, double z, double w) noexcept nogil
cdef (double, double, double, double, double, double, double, double, double) matrix_in(const double[:, ::1] rows, Py_ssize_t i, int k) noexcept
cpdef Pose pose_of(Solid solid, list y)
cpdef properties_of(Solid solid)
cpdef double energy_of(Solid solid, list y)
cpdef double kinetic_energy_of(Solid solid, list y)
@cython.locals(above=Above)
cpdef list heights_and_rates(Solid solid, list y)
@cython.locals(above=Above, flat=cython.int, corner=cython.int)
cpdef list low_corners(Solid solid, list y, double high, double leaving)
@cython.locals(flat=cython.int, corner=cython.int, touched=Flat, pose=Pose)
cpdef list approaches(Solid solid, list y, list touching)
