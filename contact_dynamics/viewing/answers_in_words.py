# SPDX-License-Identifier: Apache-2.0
"""Answers in words: the list of all of them, and the newest of each kind."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rerun as rr

from contact_dynamics.viewing.entities import ANSWER_LOG, NEWEST_ANSWERS, SUMMARY

if TYPE_CHECKING:
    from collections.abc import Sequence


class AnswersInWords:
    """What was told, in the order in which it came."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._newest: dict[str, str] = {}  # by kind

    def tell(self, kind: str, text: str, *, is_error: bool = False) -> None:
        """Write an answer into both, and its first words into the summary, at the time that was set."""
        level = rr.TextLogLevel.WARN if is_error else rr.TextLogLevel.INFO
        self._recording.log(ANSWER_LOG, rr.TextLog(f"{kind}: {text}", level=level))
        self._newest[kind] = text
        document = "\n\n".join(f"**{kind}**: {newest}" for kind, newest in self._newest.items())
        self._recording.log(NEWEST_ANSWERS, rr.TextDocument(document, media_type=rr.MediaType.MARKDOWN))
        summary = f"**{kind}**: {text.partition(';')[0]}"
        self._recording.log(SUMMARY, rr.TextDocument(summary, media_type=rr.MediaType.MARKDOWN))


def sentence(
    body_name: str, words: Sequence[str], *, remark: str = "", computation_time: float | None = None
) -> str:
    """Return what an answer about a body says, with a remark, and how long it took, s, if that is known."""
    said = [*words, remark] if remark else words
    took = "" if computation_time is None else f" ({_in_ms(computation_time)})"
    return f"{body_name or 'a body'} {'; '.join(said)}{took}"


def _in_ms(seconds: float) -> str:
    """Return a time in ms with two digits or more, and without a power of ten."""
    ms = seconds * 1e3
    return f"{ms:.0f} ms" if ms >= 10.0 else f"{ms:.2g} ms"
