# SPDX-License-Identifier: Apache-2.0
# The types with which mode_choice.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.cone_forces cimport ConeForces
from contact_dynamics.toss.forces cimport HeldContacts, force_rounding, pushed_by_contacts
from contact_dynamics.toss.solid cimport Flat, Held, Pose, Solid, pose_of

cdef extern from *:
    # A checksum of mode_choice.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double BEGINNING_ROUNDING, SAME_FORCES, SLIDING_STOPPED
cdef int _FEW_CORRECTIONS, _MAX_CORRECTIONS


@cython.locals(pose=Pose, cones=ConeForces, flat=Flat, surface=cython.int, corner=cython.int, paradox=cython.bint,
               all_slide=cython.bint, moves=cython.bint, slides=cython.bint, u=cython.double, v=cython.double,
               across=cython.double, d=(double, double, double))
cpdef choose_mode(Solid solid, list y, list touching, bint thorough=*)
@cython.locals(one=Held)
cdef ConeForces _cones_of(Solid solid, Pose pose, list guess, list ways)
@cython.locals(one=Held, flat=Flat)
cdef bint _several_forces(Solid solid, Pose pose, list sliding) except -1
cdef Held _beginning(tuple touch, (double, double, double) towards)
@cython.locals(pushed=HeldContacts, first=Held, one=Held, force=(double, double, double), i=cython.int,
               k=cython.int)
cpdef corrected(Solid solid, list y, tuple guess)
@cython.locals(flat=Flat, least=cython.double, slowest=cython.double, holds=cython.bint)
cdef Held _correction(Solid solid, Held first, Held one, (double, double, double) force, HeldContacts pushed)
