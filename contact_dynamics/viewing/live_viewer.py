"""A viewer that is drawn to, and that may die and come back.

rerun itself draws no more to a viewer that has gone, also when one listens there again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import rerun as rr

from contact_dynamics.viewing.ports import Presence, host_and_port, speaks_http2

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.viewing.kept_recording import KeptRecording


class LiveViewer:
    """A viewer at a URL."""

    def __init__(self, picture: KeptRecording, url: str, *, on_problem: Callable[[str], object]) -> None:
        """Draw a picture to the viewer that listens at a URL."""
        self._picture = picture
        self._url = url
        self._on_problem = on_problem
        self._place = picture.open(rr.GrpcSink(url))
        self._presence = self._present()
        self._is_there = True

    def look(self) -> None:
        """Find out whether the viewer lives, and give the picture to one that is back."""
        if self._presence is not None and self._presence.lasts():
            return
        if self._is_there:
            self._is_there, self._presence = False, None
            self._picture.reopen(self._place)
            self._on_problem(f"no viewer listens at {self._url} any more: one that does gets the picture")
        if speaks_http2(*host_and_port(self._url)):
            self._picture.reopen(self._place, rr.GrpcSink(self._url))
            self._is_there, self._presence = True, self._present()
            self._on_problem(f"a viewer listens at {self._url} again, and has the picture")

    def close(self) -> None:
        """Look no longer. The viewer stays open."""
        if self._presence is not None:
            self._presence.close()

    def _present(self) -> Presence | None:
        """Return a connection to the viewer, or None if it has gone already, which the next look finds."""
        try:
            return Presence(*host_and_port(self._url))
        except OSError:
            return None
