"""A viewer that is drawn to, and that may die and come back, or hang and go on.

rerun itself draws no more to a viewer that has gone, also when one listens there again. And it keeps in
memory, without bound, what a viewer that hangs does not take.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import rerun as rr

from contact_dynamics.viewing.ports import Presence, host_and_port, speaks_http2

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.viewing.kept_recording import KeptRecording

MAX_BEHIND: Final = 30
"""Looks at a viewer, of which each finds that it has not taken all that was drawn. Then it hangs."""

_PATIENCE_S: Final = 0.01  # a viewer that takes what is drawn has taken it within a millisecond


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
        self._behind = 0  # the looks since it has taken all

    @property
    def hangs(self) -> bool:
        """Whether nothing is drawn to it, because it has not taken what was drawn before."""
        return self._behind >= MAX_BEHIND

    def look(self) -> None:
        """Find out whether the viewer lives and keeps up, and give the picture to one that is back."""
        if self._presence is not None and self._presence.lasts():
            self._look_how_far_behind()
            return
        if self._is_there:
            self._is_there, self._presence, self._behind = False, None, 0
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

    def _look_how_far_behind(self) -> None:
        hung = self.hangs
        self._behind = 0 if self._has_taken_all() else self._behind + 1
        if self.hangs and not hung:
            self._picture.leave(self._place)
            self._on_problem(f"the viewer at {self._url} hangs: it gets the picture when it goes on")
        elif hung and not self.hangs:
            self._picture.reopen(self._place, rr.GrpcSink(self._url))
            self._on_problem(f"the viewer at {self._url} goes on, and has the picture")

    def _has_taken_all(self) -> bool:
        try:
            self._place.flush(timeout_sec=_PATIENCE_S)
        except RuntimeError:
            return False
        return True

    def _present(self) -> Presence | None:
        """Return a connection to the viewer, or None if it has gone already, which the next look finds."""
        try:
            return Presence(*host_and_port(self._url))
        except OSError:
            return None
