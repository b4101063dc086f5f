# SPDX-License-Identifier: Apache-2.0
# The types with which strike.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.impact.spatial.response cimport Strike
from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.forces cimport held_as_they_are, without_rebounds
from contact_dynamics.toss.impacts cimport inelastic_impact, next_in_turn, routh
from contact_dynamics.toss.mode_choice cimport choose_mode
from contact_dynamics.toss.solid cimport Flat, Held, Pose, Solid, approaches, kinetic_energy_of, pose_of

cdef extern from *:
    # A checksum of strike.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double SLIDING_STOPPED, STILL_TOUCHING, STRIKES


@cython.final
cdef class Unsettled:
    cdef list touching, y

    @cython.locals(last=list, moved=cython.double, turned=cython.double)
    cdef bint are(self, Solid solid, list y, list touching) except -1
    cdef void note(self, list y, list touching) noexcept


@cython.locals(k=cython.int, outcome=cython.int, group=list)
cpdef strike(Solid solid, list y, list touching, Strike impact, law, list rates, Unsettled unsettled, together, tuple first)
@cython.locals(fast=cython.double, rate=cython.double, is_slow=cython.bint)
cpdef low_rebounds_ended(Solid solid, list y, list touching, Unsettled unsettled)
cdef double _slow(Solid solid) noexcept
@cython.locals(fast=cython.double, rate=cython.double, one=Held)
cdef _settled(Solid solid, list y, list touching, list rates, Unsettled unsettled)
@cython.locals(allowed=cython.double)
cdef bint _loses_little(Solid solid, list before, list after) except -1
@cython.locals(motion=(double, double, double), flat=Flat, speed=cython.double)
cdef list _slow_ones(Solid solid, list touching, list motions, double fast)
cdef _modes_of(Solid solid, list y, list touching, Unsettled unsettled)
cdef list _held(Solid solid, list y, list slow, list touching)
@cython.locals(pose=Pose, flat=Flat, surface=cython.int, corner=cython.int, rate=cython.double,
               rebound=cython.double, pull=cython.double, motion=(double, double, double),
               force=(double, double, double))
cdef list _pressed(Solid solid, list y, choice, list touching, list before, list motions)

