# The types with which flight.py compiles.

cimport cython
cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec
from contact_dynamics.toss.solid cimport Pose, Solid

cdef extern from *:
    # A checksum of flight.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double GRAZING_DEPTH, NEGLIGIBLE_TERM, _INFINITE
cdef int _MAX_ROOT_STEPS, _ORDER


@cython.final
cdef class Descent:
    cdef Solid solid
    cdef object motion
    cdef (double, double, double) normal
    cdef double level, fall, turning, farthest, begin, end, high, rise, centre, centre_rate
    cdef double[63] w, momentum, n
    cdef double[::1] heights, rates, before

    @cython.locals(pose=Pose, h=cython.int, j=cython.int, k=cython.int)
    cdef void expand(self, double seconds)
    cdef void put(
        self, int k, (double, double, double) w, (double, double, double) momentum, (double, double, double) n
    ) noexcept
    cdef double reach(self, int k) noexcept
    cdef void look(self, double seconds) noexcept
    @cython.locals(now=cython.double, last=cython.double, found=cython.double, far=cython.double)
    cpdef double run(self, double start, double longest, work) except -1.0
    @cython.locals(least=cython.double)
    cdef double _free(self) noexcept
    @cython.locals(part=cython.int, least=cython.double, sinks=cython.bint)
    cdef double _arrival(self, double last, double now) noexcept
    @cython.locals(least=cython.double)
    cdef double _crossing(self, int part, double low, double high) noexcept
    @cython.locals(now=cython.double, following=cython.double)
    cdef double _root(self, int part, double low, double high) noexcept


cdef double free_for(double height, double rate, double pull) noexcept
cdef double ulp(double x) noexcept
