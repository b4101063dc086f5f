# SPDX-License-Identifier: Apache-2.0
"""Draws results in rerun. `view` draws what Python computed. No results are returned.

It draws the answers of `contact_dynamics.questions` and their parts, whether computed in Python, received
from a live server, or read from its log.

In reading order: drawing of diagrams (`drawing`), entity names (`entities`), bodies and surfaces (`scenery`),
measurements (`measured`) as columns over many times (`columns`), the lifetime of predictions in the scene,
including lecture 25's picture of rotations (`in_view`), the diagrams of answers (`diagrams_in_view`), answers
and colours in words (`words`), the layout of the views and the eye (`blueprint`), the whole picture
(`picture`), results from Python (`from_python`), the queue of states (`states_in_turn`), events side by side
(`side_by_side`), and the sinks (`sinks`): files, a viewer (`viewer_process`), a browser. All sinks share one
recording (`kept_recording`). The diagrams come from `contact_dynamics.diagrams`.

Everything is drawn on the timeline `stamp`: the stamps of the states, to the nanosecond. `kept_recording`
adds two timelines, the time since the start and the order of events. An answer appears at the stamp of the
state that it was computed from, never later, so that a live view that follows the newest data does not jump
into the future. Poses are stored as float32: the picture does not replace a log.
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
