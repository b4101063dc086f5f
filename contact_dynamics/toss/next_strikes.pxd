# SPDX-License-Identifier: Apache-2.0
# The types with which next_strikes.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.impact.spatial.response cimport Strike
from contact_dynamics.toss.flight cimport Descent
from contact_dynamics.toss.impacts cimport routh
from contact_dynamics.toss.law_spread cimport Kick
from contact_dynamics.toss.solid cimport Solid, approaches, low_corners
from contact_dynamics.toss.strike cimport Unsettled, strike

cdef extern from *:
    # A checksum of next_strikes.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double SAMPLED_ARRIVAL


@cython.final
cdef class Flights:
    cdef Solid solid
    cdef const double[:, ::1] rows
    cdef list kicks
    cdef object law, together
    cdef Descent descent
    cdef Strike impact

    @cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, k=cython.int, solid=Solid, descent=Descent,
                   gravity=(double, double, double), seconds=cython.double, part=cython.int, y=list, after=list,
                   touching=list, kick=Kick)
    cpdef void fly(
        self, double horizon, const long[::1] which, const double[:, ::1] gravities,
        const double[:, ::1] drawn, double[:, ::1] states, double[::1] now, long[::1] parts,
        double[::1] rebounds,
    ) except *
