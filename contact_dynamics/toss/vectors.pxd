# SPDX-License-Identifier: Apache-2.0
# The types with which vectors.py compiles.

cimport libc.math as math


cdef extern from *:
    # A checksum of vectors.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double SQUARES_UNDERFLOW

cpdef double dot((double, double, double) a, (double, double, double) b) noexcept nogil
cpdef (double, double, double) cross((double, double, double) a, (double, double, double) b) noexcept nogil
cpdef double norm((double, double, double) a) noexcept nogil
cpdef (double, double, double) normalised((double, double, double) a) noexcept nogil
cpdef (double, double, double) opposite((double, double, double) a) noexcept nogil
cpdef (double, double, double) without((double, double, double) a, (double, double, double) unit) noexcept nogil
cpdef (double, double, double) plus((double, double, double) a, double factor, (double, double, double) b) noexcept nogil
cpdef (double, double, double) combined(double p, (double, double, double) a, double q, (double, double, double) b) noexcept nogil
cpdef (double, double, double) times((double, double, double, double, double, double, double, double, double) matrix, (double, double, double) vector) noexcept nogil
cpdef (double, double, double) transposed_times((double, double, double, double, double, double, double, double, double) matrix, (double, double, double) vector) noexcept nogil
