# SPDX-License-Identifier: Apache-2.0
# The types with which impacts.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.impact.spatial.response cimport Strike
from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.cone_forces cimport ConeForces
from contact_dynamics.toss.solid cimport Flat, Pose, Solid, pose_of

cdef extern from *:
    # A checksum of impacts.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double CONE_CREEPS, NO_SHARED_RESPONSE, STRIKES, TIED_APPROACH


cdef class Shared


@cython.locals(pose=Pose, flat=Flat, surface=cython.int, corner=cython.int, outcome=cython.int, friction=cython.double)
cpdef tuple routh(Strike impact, Solid solid, list y, tuple touch, bint skips=*, bint lasts=*)
@cython.locals(fastest=cython.double, tie=cython.double, rate=cython.double, tied=cython.int)
cpdef list next_in_turn(Solid solid, list y, list touching, list rates)
@cython.locals(
    pose=Pose, flat=Flat, surface=cython.int, corner=cython.int, none_slides=cython.bint, one=Shared,
    other=Shared, along=Shared, a=(double, double, double), turning=(double, double, double),
    arm=(double, double, double), n=(double, double, double), across=(double, double, double),
    tendency=(double, double, double), first=(double, double, double), v=(double, double, double),
    w=(double, double, double), x=(double, double, double), z=(double, double, double),
    impulse=(double, double, double), size=cython.double, share=cython.double, c=cython.double,
    s=cython.double, i1=cython.double, i2=cython.double, p=cython.double,
)
cpdef tuple tied_strike(Solid solid, list y, list group, law)


@cython.final
cdef class Shared:
    cdef (double, double, double) force, moment, turning


@cython.locals(force=(double, double, double), moment=(double, double, double), arm=(double, double, double),
               axis=(double, double, double))
cdef Shared _shared(Pose pose, list arms, list axes)
cdef double _coupled(Shared one, Shared other, double per_mass) noexcept
cdef double _moving(Pose pose, Shared shared) noexcept
@cython.locals(pose=Pose, cones=ConeForces)
cpdef inelastic_impact(Solid solid, list y, list touching, list room=*)
@cython.locals(arm=(double, double, double), cones=ConeForces, surface=cython.int, corner=cython.int, i=cython.int)
cdef ConeForces _cones_of(Solid solid, Pose pose, list touching, list room)
@cython.locals(flat=Flat, surface=cython.int, corner=cython.int, i=cython.int)
cdef _pushed(Solid solid, list y, Pose pose, list touching, ConeForces cones)
