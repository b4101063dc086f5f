# SPDX-License-Identifier: Apache-2.0
# The types with which path.py compiles. Methods that tests call are cpdef.

cimport cython
cimport libc.math as math

cdef extern from *:
    # A checksum of path.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double AT_THE_STOP, ESCAPE_ARRIVED, EVENT_LOCATED, LARGEST_FRICTION, LAST_TERM, LEAST_FRICTION
cdef double SETTLED_TURN, SINGULAR_RESPONSE, SLOW_TURNING, SMALLEST, STOPPED, STRAIGHT, TRUNCATION, UNCOUPLED
cdef double FARTHEST, LONGEST, SURE, TERMS_ROUNDING, _INFINITE
cdef int ESCAPE_ROUNDS, MAX_ITERATIONS, MAX_STRETCHES, ORDER, ROUNDS, SLOW_TERMS, TERMS
cdef int _START, _SLIDING_STOPS, _COMPRESSION_ENDS, _RESTITUTION_ENDS, _SAMPLE
cdef int _NOT_ENDED, _NO_IMPULSE, _SLIDES, _STICKS_THROUGHOUT
cdef int _STICKS_IN_COMPRESSION, _REVERSES_IN_COMPRESSION, _STICKS_IN_RESTITUTION, _REVERSES_IN_RESTITUTION


@cython.final
cdef class SlidingLaw:
    cdef readonly double l1, l2, k1, k2, kn, mu
    cdef double x1, x2, rise

    cdef void take(self, double l1, double l2, double k1, double k2, double kn, double friction) noexcept nogil
    cdef bint round_rise(self, double least) noexcept nogil
    cdef bint holds(self) noexcept nogil
    cdef double coupling(self) noexcept nogil
    cdef double scale(self) noexcept nogil
    cdef double speeding(self, double d1, double d2) noexcept nogil
    cpdef double turning(self, double d1, double d2) noexcept nogil
    cdef double attraction(self, double d1, double d2) noexcept nogil
    cdef double lifting(self, double d1, double d2) noexcept nogil
    cdef bint keeps(self, double d1, double d2, bint started) noexcept nogil
    cdef (double, double) settled(self, double d1, double d2) noexcept nogil
    cdef (double, double, double) escape_step(self, double g) noexcept nogil
    @cython.locals(arrived=cython.bint)
    cdef (double, double, double, double) after_stop(self) noexcept nogil


cdef class RestitutionRule:
    cdef readonly bint needs_work

    cdef double share(self, double restitution, double v_n) noexcept nogil
    cdef double final(self, double restitution, double v_n) noexcept nogil
    cdef double amount(self, double p, double work) noexcept nogil
    cdef bint is_done(self, double p, double v_n, double work, double due, double final) noexcept nogil
    cdef double distance(self, double v_n, double lifting, double due, double final) noexcept nogil
    cdef double* meter(self, double* velocity, double* impulse, double* work) noexcept nogil
    cdef double level(self, double first, double due, double final) noexcept nogil


cdef class NewtonRule(RestitutionRule):
    pass


cdef class EnergeticRule(RestitutionRule):
    pass


@cython.final
cdef class SlidingSeries:
    cdef double[25] u1, u2, q, lifting
    cdef double[26] normal_impulse, t1, t2, normal_velocity, normal_work
    cdef double length

    @cython.locals(
        x=cython.p_double, y=cython.p_double, q=cython.p_double, p=cython.p_double,
        t1=cython.p_double, t2=cython.p_double, v=cython.p_double, work=cython.p_double,
    )
    cdef void expand(self, SlidingLaw law, double u1, double u2, double v_n, bint with_work) noexcept nogil
    cdef double _reach(self, double size, int n) noexcept nogil


cdef double reach(double size, double term, int n) noexcept nogil
cdef double value(double* series, int degree, double s) noexcept nogil
cdef double gain(double* series, int degree, double begin, double end) noexcept nogil
@cython.locals(rising=cython.bint)
cdef double crossing(double* series, int degree, double level, double begin, double end) noexcept nogil


@cython.final
cdef class Progress:
    cdef RestitutionRule rule
    cdef list vertices
    cdef bint keeps_vertices, compressing, over
    cdef double v_n, i1, i2, p, c1, c2, c, final_velocity, share, due

    cdef void begin(self, double restitution, double v_n) noexcept nogil
    cdef double go_straight(self, double length, double rate1, double rate2, double lifting) noexcept nogil
    @cython.locals(v_n=cython.p_double)
    cdef double go_curved(self, SlidingSeries series, double begin, double end) noexcept nogil
    cdef bint jump(self, double i1, double i2, double p, double v_n, double work) noexcept nogil
    cdef void sample(self, int event) noexcept nogil
    cdef bint stop_at(self, double v_n) noexcept nogil
    cdef void _add_vertex(self, int event) noexcept with gil
    cdef void _straight_step(self, double step, double rate1, double rate2, double lifting) noexcept nogil
    cdef double _curved_step(self, SlidingSeries series, double begin, double end, double v_n) noexcept nogil
    @cython.locals(meter=cython.p_double)
    cdef double _curved_finish(self, SlidingSeries series, double begin, double end) noexcept nogil
    cdef void _account(self, double p, double work) noexcept nogil
    cdef void _end_compression(self) noexcept nogil
    cdef void _compress_again(self) noexcept nogil
    cdef void _finish(self) noexcept nogil


@cython.final
cdef class Stop:
    cdef double p, dissipated, d1, d2
    cdef double[25] g, h

    cdef bint find(self, SlidingLaw law, double u1, double u2, double first_speed, bint with_work) noexcept nogil
    cdef bint _find_near(self, SlidingLaw law, double u1, double u2, double speed, bint with_work) noexcept nogil
    @cython.locals(g=cython.p_double, h=cython.p_double, f=cython.double[25])
    cdef (bint, double) _regular_solution(self, double x, double power) noexcept nogil
    @cython.locals(g=cython.p_double, h=cython.p_double, reciprocal=cython.double[11])
    cdef double _find_slow(self, SlidingLaw law, double d1, double d2, double speed, bint with_work) noexcept nogil
    @cython.locals(g=cython.p_double, h=cython.p_double)
    cdef void _expand(self, SlidingLaw law, double d1, double d2, int terms) noexcept nogil


@cython.locals(keeps_rate=cython.bint)
cdef bint turns_slowly(SlidingLaw law, double d1, double d2, double speed, double first_speed) noexcept nogil
@cython.locals(term=cython.double[11], slope=cython.double[11], product=cython.double[11])
cdef (double, double) slow_solution(double* reciprocal, double* h, double share) noexcept nogil
cdef double coefficient(double* a, double* b, int n) noexcept nogil


@cython.final
cdef class Tracer:
    cdef SlidingLaw law
    cdef Progress progress
    cdef SlidingSeries series
    cdef Stop stop
    cdef double u1, u2
    cdef readonly bint jams

    @cython.locals(held=cython.bint, in_compression=cython.bint, kept=cython.double)
    cdef int trace(self, double u1, double u2, double v_n, double restitution) noexcept nogil
    @cython.locals(ends_before=cython.int)
    cdef bint _slide(self, double first_speed) noexcept nogil
    cdef bint _jump_to_stop(self) noexcept nogil
    cdef void _slide_straight(self, double d1, double d2, double speed) noexcept nogil
    cdef void _slide_along(self, double lifting) noexcept nogil
