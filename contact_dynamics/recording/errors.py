"""What goes wrong with a log by misuse or by damage; a full disk stays the `OSError` that it is."""

from __future__ import annotations

from contact_dynamics.errors import ContactDynamicsError


class LogExistsError(ContactDynamicsError, FileExistsError):
    """A new log was to be written where a file or folder already stands; logs are never overwritten."""


class LogFailedError(ContactDynamicsError):
    """A message for a log that is closed or whose disk refused an earlier write."""


class NotALogError(ContactDynamicsError):
    """A path that holds no MCAP file, or a file that does not begin as one."""


class DamagedLogWarning(UserWarning):
    """A log ends early (crash, full disk) or fails its checksums; all but the damage was still read."""
