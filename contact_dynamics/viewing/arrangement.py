"""How the views are arranged, sent again and again at no lasting cost.

`rr.send_blueprint` makes a recording for each blueprint that it sends, which rerun keeps to the end of the
process: two threads and 2 MB each time, and pictures in rolling files send one with each file. Here all
blueprints go through one recording. It uses what `rr.send_blueprint` uses itself; a test with the real rerun
counts the threads.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import rerun as rr
import rerun_bindings as bindings

if TYPE_CHECKING:
    import rerun.blueprint as rrb


class Arrangement:
    """The arrangement of the views of one picture.

    Attributes:
        newest: The newest one, or None while there is none.
    """

    def __init__(self, application: str) -> None:
        """Begin without any, for the pictures of an application."""
        self.newest: rrb.Blueprint | None = None
        self._stream = rr.RecordingStream._from_native(  # noqa: SLF001
            bindings.new_blueprint(
                application_id=application,
                make_default=False,
                make_thread_default=False,
                default_enabled=True,
            )
        )
        self._stream.set_time("blueprint", sequence=0)

    def change(self, blueprint: rrb.Blueprint) -> None:
        """Arrange the views otherwise from now on."""
        self.newest = blueprint

    def send_to(
        self, place: rr.RecordingStream, *, make_active: bool = True, make_default: bool = True
    ) -> None:
        """Send the newest arrangement to a place, if there is one."""
        if self.newest is None:
            return
        for path in ("view", "container"):  # those before have other names, and would stay unseen
            self._stream.log(path, rr.Clear(recursive=True))
        self.newest._log_to_stream(self._stream)  # noqa: SLF001
        storage = self._stream.memory_recording().storage
        bindings.send_blueprint(storage, make_active, make_default, recording=place.to_native())
