# SPDX-License-Identifier: Apache-2.0
"""Checks the names of frames: every message must be in the frame that is expected."""

from __future__ import annotations

from contact_dynamics.errors import FrameMismatchError


def check_frame(field: str, found: str, expected: str) -> None:
    """Raise `FrameMismatchError` if a message's frame is not the expected one."""
    if found != expected:
        message = f"{field} must be {expected!r}, got {found!r}"
        raise FrameMismatchError(message)
