# SPDX-License-Identifier: Apache-2.0
"""Draws results in rerun. Nothing comes back from a picture. `view` is the call for what Python computed.

It draws the answers of `contact_dynamics.questions` and their parts. They may come from a question asked in
Python, from a live server, or from its log.

In reading order: how diagrams are drawn (`drawing`), names of what is drawn (`entities`), bodies and surfaces
(`scenery`), what was measured (`measured`) at many times (`columns`), what is in view of answers, also
lecture 25's picture of rotations (`in_view`), the diagrams of answers (`diagrams_in_view`), answers and
colours in words (`words`), the arrangement of the views and where they look (`blueprint`), all of it together
(`picture`), what Python computed (`from_python`), states that wait (`states_in_turn`), events beside each
other (`side_by_side`), and where it goes (`sinks`): files, a viewer (`viewer_process`), a browser. All of
these are places of one recording (`kept_recording`). The diagrams come from `contact_dynamics.diagrams`.

Everything is drawn on the timeline `stamp`: the stamps of the states, to the nanosecond. `kept_recording` has
two more, the time since the start and the order of events. An answer appears at the stamp of the state that
it was computed from, never later, so that a live view that follows the newest data is not pulled into the
future. Poses are stored as float32: this is a picture, not a record.
"""

import os
from typing import Final

_RUST_LOG: Final = "warn,re_log_encoding::rrd::file_sink=error"
"""This is rerun's own level of logging, without its warning about files that have no index at their end, as
`sinks` writes them."""

if "RUST_LOG" not in os.environ:  # rerun reads it only when it is first imported
    os.environ["RUST_LOG"] = _RUST_LOG
    try:
        import rerun as _rerun  # noqa: F401
    finally:
        del os.environ["RUST_LOG"]

from contact_dynamics.viewing.from_python import view  # noqa: E402  after rerun was imported with its level

__all__ = ["view"]
