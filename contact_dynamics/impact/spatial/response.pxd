# SPDX-License-Identifier: Apache-2.0
# The types with which response.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.impact.spatial.path cimport Progress, SlidingLaw, Tracer

cdef extern from *:
    # A checksum of response.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double LARGEST_ARM, LARGEST_NUMBER, LEAST_NUMBER, LEAST_PIVOT, SINGULAR_RESPONSE, SMALLEST
cdef double SYMMETRY_TOLERANCE
cdef int _NOT_ENDED, _SEPARATES, _NO_RESPONSE, _NOT_POSITIVE, _NOT_SYMMETRIC, _NO_IMPULSE


@cython.final
cdef class BodyAtContact:
    cdef double per_mass, d1, d2, d3, l21, l31, l32
    cdef (double, double, double) e_x, e_y, e_z, r
    cdef readonly (double, double, double) v, w

    @cython.locals(largest=cython.double)
    cpdef bint take(
        self, double mass, (double, double, double, double, double, double, double, double, double) inertia,
        (double, double, double, double) q, (double, double, double) r, (double, double, double) v,
        (double, double, double) w,
    ) noexcept nogil
    cdef (double, double, double) velocity(self) noexcept nogil
    cdef (double, double, double) half_turned(self, (double, double, double) axis) noexcept nogil
    cdef double coupled(self, (double, double, double) a, (double, double, double) b) noexcept nogil
    cpdef (double, double, double, double, double, double) response(
        self, (double, double, double) a, (double, double, double) b, (double, double, double) n
    ) noexcept nogil
    cdef void push(self, (double, double, double) impulse) noexcept nogil


@cython.final
cdef class Strike:
    cdef readonly BodyAtContact body, other
    cdef SlidingLaw law
    cdef Progress progress
    cdef readonly Tracer tracer
    cdef readonly (double, double, double) t1, t2, n, impulse, compression, before, after
    cdef readonly double l1, l2, k1, k2, kn, v_n

    @cython.locals(outcome=cython.int)
    cpdef int strike(
        self, (double, double, double) normal, double friction, double restitution, bint has_other,
        double tolerance, bint skips=*,
    ) noexcept nogil
    @cython.locals(outcome=cython.int)
    cpdef int strike_mechanism(
        self, (double, double, double, double, double, double, double, double, double) inverse_inertia,
        (double, double, double) velocity, (double, double, double) normal, double friction,
        double restitution, double tolerance, bint skips=*,
    ) noexcept nogil
    cdef (double, double) possible(self, double response, double coupling, double least) noexcept nogil
    cdef void drop_sliding(self, (double, double, double) tangent, double size) noexcept nogil
    @cython.locals(still=cython.bint, rests=cython.bint, outcome=cython.int)
    cdef int follow(self, double restitution, double tolerance, bint skips) noexcept nogil
    @cython.locals(has_other=cython.bint, outcome=cython.int, i=cython.Py_ssize_t)
    cpdef Py_ssize_t strike_rows(
        self, const double[:, ::1] bodies, const double[:, ::1] others, const double[:, ::1] contacts,
        double tolerance, bint skips, long[::1] outcomes, double[:, ::1] results,
    ) noexcept nogil
    @cython.locals(outcome=cython.int, i=cython.Py_ssize_t)
    cpdef Py_ssize_t strike_mechanism_rows(
        self, const double[:, ::1] mechanisms, const double[:, ::1] contacts, double tolerance, bint skips,
        long[::1] outcomes, double[:, ::1] results,
    ) noexcept nogil
    cdef void put_contact(self, double[:, ::1] results, Py_ssize_t i, int first) noexcept nogil
    cdef void find_axes(
        self, (double, double, double) a, (double, double, double) b, (double, double, double) normal,
        (double, double, double, double, double, double) response,
    ) noexcept nogil
    cdef (double, double, double) in_world(self, double u1, double u2, double along) noexcept nogil


@cython.locals(q_w=cython.double)
cdef void take_row(BodyAtContact body, const double[:, ::1] rows, Py_ssize_t i) noexcept nogil
@cython.locals(x=cython.double, y=cython.double, z=cython.double)
cdef (double, double, double) vector_of(const double[:, ::1] rows, Py_ssize_t i, int first) noexcept nogil
cdef (double, double, double) turned(
    (double, double, double, double, double, double, double, double, double) matrix,
    (double, double, double) vector,
) noexcept nogil
cdef bint is_small((double, double, double) vector) noexcept nogil
cdef void put(double[:, ::1] rows, Py_ssize_t i, int first, (double, double, double) vector) noexcept nogil
cdef (double, double, double) first_tangent((double, double, double) n) noexcept nogil
cdef (double, double, double) second_tangent((double, double, double) n) noexcept nogil
cdef double dot((double, double, double) a, (double, double, double) b) noexcept nogil
cdef (double, double, double) cross((double, double, double) a, (double, double, double) b) noexcept nogil
cdef (double, double, double) combined(
    double x, (double, double, double) a, double y, (double, double, double) b
) noexcept nogil
