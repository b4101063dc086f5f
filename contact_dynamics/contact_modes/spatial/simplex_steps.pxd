# SPDX-License-Identifier: Apache-2.0
# The types with which simplex_steps.py compiles.

cimport cython

cdef extern from *:
    # A checksum of simplex_steps.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC

cdef double FEASIBLE, TABLE_SMALL_PIVOT

ctypedef fused Real:
    double
    cython.longdouble


@cython.locals(
    n=cython.Py_ssize_t, head=cython.Py_ssize_t, i=cython.Py_ssize_t, worst=cython.Py_ssize_t, at=cython.Py_ssize_t,
    enters=cython.Py_ssize_t, grown=cython.double, missed=Real, value=Real, sign=cython.double, size=cython.double,
)
cpdef (double, double, double) solved(
    Real[:, ::1] table, double[::1] fixed, list rows, list columns, int dead, double least_pivot, int most
)
@cython.locals(
    n=cython.Py_ssize_t, head=cython.Py_ssize_t, i=cython.Py_ssize_t, worst=cython.Py_ssize_t, missed=Real, value=Real,
    short=Real,
)
cdef Py_ssize_t _most_missed(Real[:, ::1] table, double[::1] fixed) noexcept nogil
@cython.locals(
    n=cython.Py_ssize_t, j=cython.Py_ssize_t, enters=cython.Py_ssize_t, least=Real, helps=Real, ratio=Real
)
cdef Py_ssize_t _entering(Real[:, ::1] table, Py_ssize_t at, double sign, double least_pivot) noexcept nogil
@cython.locals(j=cython.Py_ssize_t, largest=cython.double)
cdef double _largest(Real[:, ::1] table, Py_ssize_t at, double sign) noexcept nogil
@cython.locals(i=cython.Py_ssize_t, j=cython.Py_ssize_t, pivot=Real, share=Real)
cdef void _exchange(Real[:, ::1] table, Py_ssize_t at, Py_ssize_t enters) noexcept nogil
