# SPDX-License-Identifier: Apache-2.0
"""Draws what keeps its form: surfaces and the shapes of bodies. It can have another form from a time on.

What never changes is drawn without a time, so that it is there from the beginning. rerun shows such a drawing
at every time, whatever else is drawn in its place. So what changes is moved to places of its own, one for
each form, from the time when it came until it goes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import rerun as rr

from contact_dynamics.viewing.measured import set_time

if TYPE_CHECKING:
    from collections.abc import Mapping

Part: TypeAlias = rr.Mesh3D | rr.LineStrips3D | rr.Points3D


class Scenery:
    """Things, each drawn at a path in some parts."""

    def __init__(self, recording: rr.RecordingStream) -> None:
        """Begin without any."""
        self._recording = recording
        self._parts: dict[str, Mapping[str, Part]] = {}
        self._forms: dict[str, int] = {}  # which form a thing has, from 1 on, once it has changed
        self._since_ns: dict[str, int] = {}  # the stamp from which on it has this form

    @property
    def paths(self) -> frozenset[str]:
        """The paths of the things that are drawn now."""
        return frozenset(path for path, parts in self._parts.items() if parts)

    def draw(self, path: str, parts: Mapping[str, Part]) -> None:
        """Draw a thing by the names of its parts: for all times, or for those of its present form."""
        self._parts[path] = parts
        if path in self._forms:
            self._draw_form(path, parts, self._forms[path], stamp_ns=self._since_ns[path])
            return
        for name, part in parts.items():
            self._recording.log(f"{path}/{name}", part, static=True)

    def change(self, path: str, parts: Mapping[str, Part], *, first_ns: int, stamp_ns: int) -> None:
        """Draw a thing anew from a time on; without parts it is gone.

        Args:
            path: its path.
            parts: its parts by name.
            first_ns: ns, the time that the picture begins at.
            stamp_ns: ns, the time of the change.
        """
        before = self._parts.get(path, {})
        form = self._forms.get(path, 0)
        if form == 0:
            for name, part in before.items():
                self._recording.log(f"{path}/{name}", part.cleared(), static=True)
            form = 1
            self._draw_form(path, before, form, stamp_ns=first_ns)
        set_time(self._recording, stamp_ns)
        for name in before:
            self._recording.log(f"{path}/{name}/{form}", rr.Clear(recursive=False))
        form += 1
        self._draw_form(path, parts, form, stamp_ns=stamp_ns)
        self._parts[path], self._forms[path], self._since_ns[path] = parts, form, stamp_ns

    def _draw_form(self, path: str, parts: Mapping[str, Part], form: int, *, stamp_ns: int) -> None:
        set_time(self._recording, stamp_ns)
        for name, part in parts.items():
            self._recording.log(f"{path}/{name}/{form}", part)
