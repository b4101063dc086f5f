# SPDX-License-Identifier: Apache-2.0
# The types with which law_spread.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.solid cimport Pose, Solid, pose_of

cdef extern from *:
    # A checksum of law_spread.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double BY_IMPULSE, FREEDOM, FULL, _SAME_MEDIAN


@cython.final
cdef class Kick:
    cdef double velocity, spin, first
    cdef public object chance

    @cython.locals(
        jump=cython.double, size=cython.double, surface=cython.int, corner=cython.int, pose=Pose,
        mass=cython.double, share=cython.double, least=cython.double, rate=cython.double, back=cython.double,
        arm=(double, double, double), axis=(double, double, double), each=(double, double, double),
        normal=(double, double, double), n=(double, double, double), moment=(double, double, double),
        turn=(double, double, double), v=(double, double, double), w=(double, double, double),
        pushed=cython.double, velocity=cython.double, spin=cython.double,
        a=cython.double, b=cython.double, c=cython.double, d=cython.double, e=cython.double, f=cython.double,
        g=cython.double, h=cython.double, i=cython.double, by_t=cython.double,
    )
    cpdef list changed(self, Solid solid, list before, list after, list touching, list drawn)
    cpdef list kicked(self, Solid solid, list before, list after, list touching)


cpdef (double, double, double) _parts(double velocity, double spin, double square) noexcept
