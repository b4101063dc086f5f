# SPDX-License-Identifier: Apache-2.0
"""Arranges events in rows within one scene, with a table beside them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import rerun.blueprint as rrb

from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.records import Record
from contact_dynamics.viewing.blueprint import BACKGROUND, orbit, up_of

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray

MAX_DRAWN: Final = 48  # maximum number of drawn events; more could not be distinguished
COLUMN_COUNT: Final = 6  # events in one row
EVENTS: Final = "events"
TABLE: Final = "table"

_APART: Final = 2.6  # spacing, in sizes of the largest body


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SideBySide(Record):
    """The places of events."""

    count: int  # number of events
    size: float  # m, of the largest body
    gravity_W: FloatArray  # (3,), m/s^2, which defines up

    @property
    def up_W(self) -> FloatArray:
        """Return the unit vector against gravity, (3,), or z without gravity."""
        return up_of(self.gravity_W)

    def place(self, number: int) -> FloatArray:
        """Return the place of an event, (3,), m."""
        u_W, v_W = tangents_near_x(self.up_W)
        place: FloatArray = (
            _APART * self.size * ((number % COLUMN_COUNT) * u_W - (number // COLUMN_COUNT) * v_W)
        )
        return place

    def blueprint(self, name: str, table: str) -> rrb.Blueprint:
        """Return the arrangement: all events from above, and the table, each with its name."""
        apart, up_W = _APART * self.size, self.up_W
        u_W, v_W = tangents_near_x(up_W)
        columns = min(COLUMN_COUNT, max(1, self.count))
        row_count = math.ceil(max(1, self.count) / COLUMN_COUNT)
        middle = 0.5 * apart * ((columns - 1) * u_W - (row_count - 1) * v_W)
        distance = apart * max(0.95 * columns, 1.2 * row_count, 1.0)
        view = rrb.Spatial3DView(
            origin="/",
            contents=f"{EVENTS}/**",
            name=name,
            background=BACKGROUND,
            line_grid=False,
            eye_controls=orbit(middle + distance * (0.75 * up_W - 0.65 * v_W), middle, up_W),
        )
        return rrb.Blueprint(
            rrb.Horizontal(view, rrb.TextDocumentView(origin=TABLE, name=table), column_shares=[3, 2]),
            rrb.BlueprintPanel(state=rrb.PanelState.Collapsed),
            rrb.SelectionPanel(state=rrb.PanelState.Collapsed),
            rrb.TimePanel(state=rrb.PanelState.Hidden),
        )
