# SPDX-License-Identifier: Apache-2.0
# The types with which routh.py compiles.

cimport cython
cimport libc.math as math

cdef extern from *:
    # A checksum of routh.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double _INFINITE, _MAX_FRICTION
cdef int _POISSON, _NEWTON, _NO_IMPULSE, _SLIDES, _STICKS_THROUGHOUT
cdef int _STICKS_IN_COMPRESSION, _REVERSES_IN_COMPRESSION, _STICKS_IN_RESTITUTION, _REVERSES_IN_RESTITUTION


@cython.final
cdef class PlanarStrike:
    cdef int law, outcome
    cdef bint jams
    cdef public double a, b, c, det
    cdef double p_stop, t_stop, p_compression, t_compression, v_t
    cdef readonly double p_end, t_end, v_n
    cdef readonly double v_t_before, v_n_before, i_x, i_y, v_x, v_y, w

    cpdef Py_ssize_t strike_all(
        self, const double[:] mass, const double[:] inertia, const double[:] friction,
        const double[:] restitution, const double[:] v_x, const double[:] v_y, const double[:] w,
        const double[:] r_x, const double[:] r_y, const double[:] n_x, const double[:] n_y,
        double tolerance, long[::1] outcomes, double[:, ::1] results,
    ) noexcept nogil
    cpdef bint strike(
        self, double mass, double inertia, double friction, double restitution, double v_x, double v_y,
        double w, double r_x, double r_y, double n_x, double n_y, double tolerance,
    ) noexcept nogil
    cdef void respond(self, double mass, double inertia, double r_t, double r_n) noexcept nogil
    @cython.locals(holds=cython.bint, stops_early=cython.bint, stops_late=cython.bint)
    cpdef void follow(self, double v_t, double v_n, double friction, double restitution) noexcept nogil
