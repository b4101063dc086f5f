# SPDX-License-Identifier: Apache-2.0
# The types with which cone_forces.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.forces cimport Equations
from contact_dynamics.toss.solid cimport Flat, Pose

cdef extern from *:
    # A checksum of cone_forces.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double CONE_SWEEPS_CONVERGED, FORCE_ROUNDING
cdef int FURTHER_SWEEPS, MAX_SWEEPS, PLAIN_SWEEPS, _DIRECTIONS, _MAX_FURTHER_SWEEPS, _MAX_TURNS, _WIDTH


@cython.final
cdef class ConeForces:
    cdef readonly int count
    cdef Equations equations
    cdef double[::1] numbers, motions

    @cython.locals(x=cython.double[::1])
    cpdef void add(self, Pose pose, (double, double, double) arm, Flat flat, (double, double, double) velocity, double rise)
    cpdef void slide(self, double x, double y) noexcept
    cpdef (double, double, double) push(self, int i) noexcept
    cpdef (double, double, double) motion(self, int i) noexcept
    cpdef (double, double, double) alone(self, int i) noexcept
    @cython.locals(scale=cython.double, change=cython.double)
    cpdef bint solve(self, double per_mass, double enough) except -1
    @cython.locals(n=cython.int, k=cython.int)
    cpdef bint solve_without_friction(self) except -1
    @cython.locals(m=cython.double[::1], change=cython.double, n=cython.int, k=cython.int)
    cdef double _sweep(self) noexcept
    @cython.locals(least=cython.double)
    cdef double _lowest(self) noexcept
    @cython.locals(m=cython.double[::1], n=cython.int, k=cython.int)
    cdef void _move(self) noexcept
    @cython.locals(m=cython.double[::1], n=cython.int, k=cython.int)
    cdef (double, double, double, double, double, double) _block(self, int i) noexcept
    @cython.locals(k=cython.int)
    cdef (double, double, double) _one(self, int i, (double, double, double) m) noexcept
    cdef (double, double, double) _against(self, int i, (double, double, double) m, double x, double y) noexcept
    cdef (double, double, double) _slide(self, int i, (double, double, double) m, double hold_x, double hold_y) noexcept
    cdef (double, double, double) _across(self, int i, (double, double, double) m, double angle) noexcept
    @cython.locals(low=cython.double, high=cython.double, middle=cython.double, p=cython.double)
    cdef (double, double, double) _slide_by_halves(self, int i, (double, double, double) m) noexcept
