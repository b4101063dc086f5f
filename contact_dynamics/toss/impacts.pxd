# SPDX-License-Identifier: Apache-2.0
# The types with which impacts.py compiles.

cimport cython

from contact_dynamics.impact.spatial.response cimport Strike
from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.cone_forces cimport ConeForces
from contact_dynamics.toss.solid cimport Flat, Pose, Solid, pose_of

cdef extern from *:
    # A checksum of impacts.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double CONE_CREEPS, STRIKES


@cython.locals(pose=Pose, flat=Flat, one=Strike, surface=cython.int, corner=cython.int, outcome=cython.int)
cpdef routh(Solid solid, list y, tuple touch, law, double friction)
@cython.locals(pose=Pose, cones=ConeForces)
cpdef inelastic_impact(Solid solid, list y, list touching, list room=*)
@cython.locals(arm=(double, double, double), cones=ConeForces, surface=cython.int, corner=cython.int, i=cython.int)
cdef ConeForces _cones_of(Solid solid, Pose pose, list touching, list room)
@cython.locals(flat=Flat, surface=cython.int, corner=cython.int, i=cython.int)
cdef _pushed(Solid solid, list y, Pose pose, list touching, ConeForces cones)
