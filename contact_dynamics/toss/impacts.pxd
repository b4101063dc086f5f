# The types with which impacts.py compiles.

from contact_dynamics.toss cimport vectors as vec

cdef extern from *:
    # A checksum of impacts.py and this file, which setup.py defines (see numerics/compiled.py).
    cpdef enum:
        SOURCE_CRC
