# SPDX-License-Identifier: Apache-2.0
# The types with which history.py compiles.

cimport cython

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.forces cimport out_of_flats
from contact_dynamics.toss.solid cimport Solid, energy_of, kinetic_energy_of, low_corners, pose_of

cdef extern from *:
    # A checksum of history.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC


cdef class History:
    cdef readonly Solid solid
    cdef readonly double now
    cdef readonly list y, pieces, events, resting
    cdef double lost_in_strikes, lost_in_contact, _first
    cdef readonly list undecided
    cdef tuple _ways
    cdef int count
    cdef bint is_sample
    cdef object _began_ns

    cpdef list touching_now(self, double leaving)
    @cython.locals(height=cython.double, apart=cython.double, flat=cython.int, corner=cython.int, s=cython.int, k=cython.int)
    cdef list _touching_together(self, list listed)
    cdef void note(self, kind, list touching, tuple mode=*, (double, double, double) impulse=*, outcome=*) except *
    cdef int way(self, reason, int options) except -1
