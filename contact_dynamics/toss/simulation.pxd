# SPDX-License-Identifier: Apache-2.0
# The types with which simulation.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.impact.spatial.response cimport Strike
from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.forces cimport HeldContacts, held_in_place, out_of_flats, pushed_by_contacts
from contact_dynamics.toss.flight cimport Descent
from contact_dynamics.toss.history cimport History
from contact_dynamics.toss.impacts cimport routh
from contact_dynamics.toss.laid_flat cimport laid_flat
from contact_dynamics.toss.law_spread cimport Kick
from contact_dynamics.toss.mode_choice cimport choose_mode
from contact_dynamics.toss.solid cimport Flat, Held, Solid, approaches, energy_of, kinetic_energy_of
from contact_dynamics.toss.strike cimport Unsettled, low_rebounds_ended, strike

cdef extern from *:
    # A checksum of simulation.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double BUSY, LIFT_OFF_PAUSE, LONGEST_SHORT_STEP, RESTING_ACCELERATION, SHORTEST_LINGER
cdef double SHORTEST_SHORT_STEP, SLIDING_STOPPED, STILL_TOUCHING, STRIKES
cdef double _LONGER, _LONGEST_LINGER, _SHARE, _SLOWER
cdef int _MAX_LAID, _NEVER, _ROUNDS, _ROUNDS_AT_ONCE, _ROUNDS_WHILE_BUSY


@cython.final
cdef class Simulation(History):
    cdef readonly object settings
    cdef double slow, quiet, mark, busy_mark, linger
    cdef double horizon, error
    cdef int struck, laid, steps, rounds, busy_rounds, max_events, flat_after
    cdef bint thorough, has_pieces
    cdef Descent descent
    cdef object settled
    cdef Unsettled unsettled
    cdef list looked_at
    cdef dict faces
    cdef tuple way_on
    cdef Kick kick
    cdef Strike impact

    @cython.locals(touching=list, rates=list, rate=cython.double, least=cython.double)
    cpdef to_end(self)
    cdef list _go_on(self, list touching)
    @cython.locals(left=cython.double, seconds=cython.double)
    cdef list _fly(self, double pause)
    cdef void _forget_instant(self) except *
    @cython.locals(y=list, before=cython.double, staying=list, fast=cython.double, rate=cython.double)
    cdef list _strike(self, list touching, list rates)
    cdef list _end_low_rebounds(self, list touching, list staying, double energy)
    cdef double _fast(self) except -1.0
    @cython.locals(thorough=cython.bint, way=cython.int, options=cython.int)
    cdef tuple _next_mode(self, list touching)
    cdef _known_since_strikes(self, list touching, bint thorough)
    @cython.locals(before=cython.double, one=Held)
    cdef list _follow(self, tuple mode)
    cdef bint _lingers(self) except -1
    cdef list _pass_over(self)
    @cython.locals(grip=cython.double, flat=Flat)
    cdef double _slow(self, list touching) except -1.0
    cdef double _stopped_within(self, double force) except -1.0
    @cython.locals(flat=tuple, rattles=cython.double)
    cdef list _laid_flat(self, list touching)
    @cython.locals(energy=cython.double, slowing=cython.double, still=list, pushed=HeldContacts, placed=list,
                   a=cython.double, b=cython.double, c=cython.double, d=cython.double, e=cython.double,
                   f=cython.double, fastest=cython.double)
    cdef bint _rests(self, list touching) except -1
