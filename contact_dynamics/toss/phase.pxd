# SPDX-License-Identifier: Apache-2.0
# The types with which phase.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.forces cimport HeldContacts, force_rounding, out_of_flats
from contact_dynamics.toss.solid cimport Above, Flat, Held, Pose, Solid

cdef extern from *:
    # A checksum of phase.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double BEGUN_TO_SLIDE, COARSE_SLIDING_STOPPED, COMES_DOWN_FOUND, CREEPING_STEP, FORCE_END_FOUND
cdef double GRAZING_DEPTH, PHASE_LEAST_STEP, RESOLVED_SLIDING, SAMPLED_PHASE_ERROR, SLIDING_STOPPED
cdef double FIRST_STEP, LARGEST_STEP, SHORT_STEP, _INFINITE, _TOWARDS_STOP
cdef int MAX_PHASE_STEPS, _HEIGHT, _FORCE, _BEGUN, _MAX_ROOT_STEPS, _MAX_SHORT_STEPS, _NONE
cdef int _FORCES, _SLIDING_STOPS, _COMES_DOWN, _SLOW, _TIME, _STEPS, _CREEPS
cdef double[::1] _STAGES, _ERRORS, _INTERPOLANT


@cython.final
@cython.no_gc
cdef class PhaseStep:
    cdef readonly Solid solid
    cdef readonly double start, span, whole
    cdef readonly double[13] y
    cdef readonly double[52] rates

    @cython.locals(rate=cython.double)
    cdef void interpolate(self, double* y, double* stages) noexcept
    @cython.locals(r=cython.p_double)
    cdef void within(self, double x, double* y) noexcept


@cython.final
cdef class _Run:
    cdef Solid solid
    cdef HeldContacts held
    cdef Above here, there
    cdef readonly double[13] y
    cdef double[13] trial, scales, probe
    cdef double[91] stages
    cdef double[::1] depths
    cdef double error, resolved, before_stop, span
    cdef readonly double now
    cdef readonly int count
    cdef readonly list steps
    cdef list stopped
    cdef bint fast
    cdef PhaseStep step

    cdef void _set_scales(self) noexcept
    @cython.locals(held=HeldContacts, y=cython.p_double, trial=cython.p_double, size=cython.double,
                   step=cython.double, short=cython.int, end=cython.int, done=PhaseStep)
    cpdef int go(self, double start, double until, double slow, bint has_steps) except -2
    cdef int _end_here(self, double until, double slow) except -2
    cdef void _note_rates(self) noexcept
    @cython.locals(least=cython.double)
    cdef double _before_arrival(self) noexcept
    @cython.locals(y=cython.p_double, trial=cython.p_double, stages=cython.p_double, rates=cython.p_double,
                   rate=cython.double, row=cython.int, k=cython.int, largest=cython.double)
    cdef double _try(self, double step) except -1.0
    cdef PhaseStep _interpolated(self)
    @cython.locals(held=HeldContacts, one=Held, flat=Flat, longest=cython.double)
    cdef void _look_at_sliding(self)
    @cython.locals(mode=list, flat=Flat, still=HeldContacts)
    cdef bint _friction_holds(self, int i) except -1
    @cython.locals(mode=list, still=HeldContacts)
    cdef void _stop(self)
    @cython.locals(before=HeldContacts, one=Held, other=Held, slow=cython.bint)
    cdef void _turn_beginning(self)
    cdef void _forget_risen(self) noexcept
    @cython.locals(no_force=cython.bint, goes_back=cython.bint, end=cython.int, x=cython.double)
    cdef (int, double) _first_end(self)
    @cython.locals(least=cython.double, pose=Pose, one=Held)
    cdef double _least_begun(self) except? -1.0
    @cython.locals(least=cython.double)
    cdef double _least_height(self) noexcept
    cdef double _left_at(self, int kind, double x) except? -1.0
    cdef double _first_dip(self) except? -1.0
    @cython.locals(a=cython.double, f_a=cython.double, b=cython.double, f_b=cython.double, c=cython.double,
                   f_c=cython.double, share=cython.double, x=cython.double, f_x=cython.double)
    cdef double _crossing(self, int kind, double bad, double enough) except? -1.0
