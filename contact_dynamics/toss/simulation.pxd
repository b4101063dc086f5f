# SPDX-License-Identifier: Apache-2.0
# The types with which simulation.py compiles.


cdef extern from *:
    # A checksum of simulation.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC
