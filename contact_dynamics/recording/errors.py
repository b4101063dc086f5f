# SPDX-License-Identifier: Apache-2.0
"""Errors and warnings about misused or damaged logs. A full disk raises `OSError`."""

from __future__ import annotations

from contact_dynamics.errors import ContactDynamicsError


class LogExistsError(ContactDynamicsError, FileExistsError):
    """The file or folder of a new log already exists. Logs are never overwritten."""


class LogFailedError(ContactDynamicsError):
    """The log is closed, or an earlier write to its disk failed."""


class NotALogError(ContactDynamicsError):
    """There is no MCAP file at the path, or the file does not begin as one."""


class DamagedLogWarning(UserWarning):
    """A log ends early (crash, full disk) or fails its checksums. All but the damage was read."""


class UnfinishedLogWarning(DamagedLogWarning):
    """A log is still being written, or its writer was killed. All that it contains was read."""
