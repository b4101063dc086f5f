# SPDX-License-Identifier: Apache-2.0
"""Takes out of view what an answer left in the scene once it only hides the bodies.

Of several bodies, the one that the newest answer is about has labels. An impact loses its labels some time
after it, and is gone then if another body's is newer.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import rerun as rr

from contact_dynamics.constants import ns_after
from contact_dynamics.diagrams.contact_scene import LETTERS
from contact_dynamics.diagrams.impact_scene import LABELS
from contact_dynamics.viewing.entities import WHOSE, contacts_entity, entity, impact_entity
from contact_dynamics.viewing.measured import OF_ONE_BODY, set_time

if TYPE_CHECKING:
    from collections.abc import Iterable

LABELS_S: Final = 0.5
"""s. The labels of an impact go this long after it, since they would cover the body."""


class ImpactsInView:
    """The bodies with an impact in the scene, and until when it has labels."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._until_ns: dict[str, int] = {}
        self._newest = ""
        self._labelled = ""

    def come(self, body_name: str, *, stamp_ns: int, strike_ns: int) -> None:
        """Note the impact that is drawn at a stamp, ns, and happens at another. It is the newest."""
        if self._newest != body_name:
            self._clear_labels(stamp_ns)
            if self._until_ns.get(self._newest, stamp_ns) < stamp_ns:
                self._clear(self._newest, stamp_ns)
        self._newest = self._labelled = body_name
        self._until_ns[body_name] = ns_after(strike_ns, LABELS_S)

    def pass_by(self, body_name: str, stamp_ns: int) -> None:
        """Clear what is in the way of a body that was measured at a stamp, ns."""
        if stamp_ns <= self._until_ns.get(body_name, stamp_ns):
            return
        if body_name != self._newest:
            self._clear(body_name, stamp_ns)
        elif body_name == self._labelled:
            self._clear_labels(stamp_ns)

    def _clear(self, body_name: str, stamp_ns: int) -> None:
        set_time(self._recording, stamp_ns)
        self._recording.log(impact_entity(body_name), rr.Clear(recursive=True))
        self._until_ns.pop(body_name, None)

    def _clear_labels(self, stamp_ns: int) -> None:
        if self._labelled:
            _clear_each(
                self._recording, (f"{impact_entity(self._labelled)}/{label}" for label in LABELS), stamp_ns
            )
            self._labelled = ""


class ConservedInView:
    """The body whose energy and momenta are drawn as curves.

    Of several bodies it is the one that was asked about, until its predicted motion is over and another is
    asked about. Curves of many bodies could not be told apart, and would cost what all else costs.
    """

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._until_ns = 0
        self.body_name: str | None = None

    def come(self, body_name: str, *, stamp_ns: int, end_ns: int) -> bool:
        """Note a prediction that begins and ends at these stamps, ns, and return if a turn begins."""
        begins = self.body_name != body_name
        if self.body_name not in {None, body_name}:
            if stamp_ns < self._until_ns:
                return False
            _clear_each(
                self._recording,
                [
                    entity(quantity, self.body_name, kind)
                    for quantity in OF_ONE_BODY
                    for kind in ("measured", "predicted")
                ],
                stamp_ns,
            )
        self.body_name, self._until_ns = body_name, end_ns
        if begins:
            set_time(self._recording, stamp_ns)
            whose = rr.TextDocument(f"The curves are those of **{body_name}**.", media_type="text/markdown")
            self._recording.log(WHOSE, whose)
        return begins


class LettersInView:
    """The body whose contacts have letters."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._lettered = ""

    def come(self, body_name: str, stamp_ns: int) -> None:
        """Note the body that the newest answer is about, and clear the letters of another, at a stamp, ns."""
        if self._lettered not in {"", body_name}:
            _clear_each(self._recording, [f"{contacts_entity(self._lettered)}/{LETTERS}"], stamp_ns)
        self._lettered = body_name


def _clear_each(recording: rr.RecordingStream, paths: Iterable[str], stamp_ns: int) -> None:
    set_time(recording, stamp_ns)
    for path in paths:
        recording.log(path, rr.Clear(recursive=False))
