# SPDX-License-Identifier: Apache-2.0
"""Leaves NumPy's warnings of numbers out in processes that answer whatever they are sent.

What overflows or is not a number is refused by the field's name, counted and reported. NumPy's warning of it
tells nothing more, and each answer that is sent makes Python forget that it has been given.
"""

from __future__ import annotations

import numpy as np


def leave_out_numpy_warnings() -> None:
    """Let this thread compute with any numbers without warnings."""
    np.seterr(all="ignore")
