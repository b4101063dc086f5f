# The types with which mode_choice.py compiles.

cimport libc.math as math

from contact_dynamics.toss cimport vectors as vec

cdef extern from *:
    # A checksum of mode_choice.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC
