# SPDX-License-Identifier: Apache-2.0
# The types with which laid_flat.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.impact.planar.routh cimport PlanarStrike
from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.solid cimport Flat, Pose, Solid, kinetic_energy_of, low_corners, pose_of

cdef extern from *:
    # A checksum of laid_flat.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double FACE_ROUNDING, _INFINITE, _LEAST_REBOUND, _LEFT
cdef int _MAX_BOUNCES


@cython.final
cdef class Face:
    cdef (double, double, double) up
    cdef double high, tipping
    cdef list corners


@cython.locals(
    flat=Flat, face=Face, pose=Pose, near=list, low=cython.double, rise=cython.double, rattles=cython.double, pressing=cython.double,
    speed=cython.double, share=cython.double, ahead=cython.double, v_n=cython.double, w_n=cython.double,
)
cpdef laid_flat(Solid solid, list y, dict faces, law)
@cython.locals(flat=Flat, pull=cython.double, now=cython.double, begun=cython.double, fastest=cython.double,
               soonest=cython.double, rate=cython.double, landing=cython.double, first=cython.int, k=cython.int,
               count=cython.int, sinking=cython.double, least=cython.double, above_face=cython.double, rise=cython.double, x=cython.double, y=cython.double,
               z=cython.double, numbers="double[::1]")
cdef double _chatter(Solid solid, Pose pose, int surface, Face face, PlanarStrike strike) except -1.0
@cython.locals(flat=Flat, p=cython.double, rate=cython.double, across=(double, double, double))
cdef void _bounce(Solid solid, Pose pose, int surface, int corner, PlanarStrike strike, double least) except *
cdef (double, double, double) _turned_by(Pose pose, (double, double, double) arm, (double, double, double) impulse) noexcept
@cython.locals(i=cython.int, j=cython.int, k=cython.int, high=cython.double, face=Face)
cdef Face _face_below(Solid solid, (double, double, double) n_B, (double, double, double) lean, list near, dict faces)
@cython.locals(i=cython.int, j=cython.int, k=cython.int, each=cython.int, size=cython.double,
               high=cython.double, along=cython.double, p=(double, double, double), q=(double, double, double),
               r=(double, double, double), up=(double, double, double), corner=(double, double, double))
cdef Face _face_of(Solid solid, tuple three)
cdef (double, double, double) _less((double, double, double) a, (double, double, double) b) noexcept
cdef bint _stands((double, double, double) up, (double, double, double) p, (double, double, double) q, (double, double, double) r) noexcept
