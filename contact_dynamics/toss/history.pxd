# SPDX-License-Identifier: Apache-2.0
# The types with which history.py compiles.

from contact_dynamics.toss cimport vectors as vec

cdef extern from *:
    # A checksum of history.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC
