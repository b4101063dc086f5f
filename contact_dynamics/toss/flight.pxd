# SPDX-License-Identifier: Apache-2.0
# The types with which flight.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.solid cimport Above, Flat, Solid, rows_of

cdef extern from *:
    # A checksum of flight.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double GRAZING_DEPTH, NEGLIGIBLE_TERM, _GYROSCOPIC, _INFINITE, _MANY
cdef int MAX_SEARCH_STEPS, SEARCH_BEGUN, _MAX_ROOT_STEPS, _ORDER


@cython.final
cdef class Descent:
    cdef Solid solid
    cdef Above above
    cdef (double, double, double) gravity
    cdef double begin, end, looked
    cdef double[13] start
    cdef double[84] q
    cdef double[63] w, momentum
    cdef double[::1] pulls, before

    @cython.locals(corner=cython.int)
    cpdef void set_out(self, Solid solid, (double, double, double) gravity, list y) except *
    @cython.locals(seconds=cython.double)
    cpdef double fly(self, list y, double pause, double longest) except -1.0
    @cython.locals(x=cython.double, y=cython.double, z=cython.double, s=cython.double, u=cython.double,
                   v=cython.double, t=cython.double, g=cython.int, h=cython.int, j=cython.int, k=cython.int)
    cdef void _expand(self, double seconds, (double, double, double, double) q, (double, double, double) w) noexcept
    cdef void _expand_from(self, double seconds, list y) except *
    cdef void _put_q(self, int k, double x, double y, double z, double s) noexcept
    cdef void _put_w(self, int k, (double, double, double) w, (double, double, double) momentum) noexcept
    cdef double _reach(self, int k) noexcept
    @cython.locals(t=cython.double)
    cpdef void look(self, double seconds) except *
    @cython.locals(k=cython.int)
    cdef (double, double, double, double) _turned(self, double t) noexcept
    @cython.locals(k=cython.int)
    cdef (double, double, double) _turning(self, double t) noexcept
    @cython.locals(y=cython.p_double, first=cython.p_double, k=cython.int)
    cdef void _set_state(self, double seconds) noexcept
    cpdef list state(self)
    @cython.locals(rate=cython.double)
    cpdef int striking(self, double near) noexcept
    @cython.locals(now=cython.double, steps=cython.int, last=cython.double, found=cython.double)
    cpdef double run(self, double start, double longest) except -1.0
    @cython.locals(y=cython.p_double, flat=Flat, fall=cython.double, first=cython.double, least=cython.double,
                   k=cython.int)
    cdef double _free(self) noexcept
    @cython.locals(part=cython.int, least=cython.double, sinks=cython.bint)
    cdef double _arrival(self, double last, double now) except -2.0
    @cython.locals(least=cython.double)
    cdef double _crossing(self, int part, double low, double high) except -2.0
    @cython.locals(now=cython.double, following=cython.double)
    cdef double _root(self, int part, double low, double high) except -2.0


cdef double free_for(double height, double rate, double pull) noexcept
cdef double ulp(double x) noexcept
cdef double _row_sum((double, double, double, double, double, double, double, double, double) matrix) noexcept
