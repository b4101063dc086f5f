"""Keeps memory that DDS reserves and does not use from being touched, which is when a machine has to find it.

DDS sets aside room for messages as large as their lists may be, for each writer and reader: a hundred pieces,
each of some 100 kB for the services and of megabytes for some topics. Fresh memory costs nothing before it is
written to. But glibc takes pieces from its heap once a process has freed some, and clears them, so that all
of the room is found at once. A process that made server and visualizer for the third time took 7 GB in place
of 0.1 GB, and a server grew by 6 MB each time that it was cleaned up and configured. Pieces above a threshold
are always fresh, and go back to the machine when they are freed.
"""

from __future__ import annotations

import ctypes
from typing import Final

_M_MMAP_THRESHOLD: Final = -3  # as malloc.h of glibc has it
_THRESHOLD: Final = 64 * 1024
"""bytes, below the pieces of the services. glibc begins with twice as much, and raises it with each piece
that is freed unless it is set."""


def keep_reserved_memory_untouched() -> None:
    """Let large pieces of memory always be fresh ones. Without glibc there is nothing to do."""
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is not None:
        mallopt(_M_MMAP_THRESHOLD, _THRESHOLD)
