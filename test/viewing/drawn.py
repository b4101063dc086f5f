# SPDX-License-Identifier: Apache-2.0
"""What a finished .rrd file holds, read back with rerun's own reader."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import NDArray
from rerun.chunk import RrdReader

from contact_dynamics.viewing.measured import set_time

STAMP_NS = 1_760_000_000_123_456_789
"""When the tests draw, ns: a stamp that needs all of its digits."""


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """Values by entity and component, as ("/world/bodies/brick", "Transform3D:translation")."""

    values: dict[tuple[str, str], list[tuple[int, Any]]]  # (stamp in ns, or 0 where static; value), by stamp
    blueprints: int  # number of arrangements that were sent

    @property
    def entities(self) -> set[str]:
        return {entity for entity, _ in self.values}

    def stamps(self, entity: str, component: str) -> list[int]:
        return [stamp for stamp, _ in self.values[entity, component]]

    def last(self, entity: str, component: str) -> Any:
        return self.values[entity, component][-1][1]

    def array(self, entity: str, component: str) -> NDArray[np.float64]:
        """The newest value as numbers."""
        return np.array(self.last(entity, component), dtype=np.float64)

    def series(self, entity: str, component: str) -> NDArray[np.float64]:
        """The values of all stamps, each of one instance; (stamps, ...)."""
        return np.array([value[0] for _, value in self.values[entity, component]], dtype=np.float64)


def read_drawn(path: Path) -> Drawn:
    values: dict[tuple[str, str], list[tuple[int, Any]]] = {}
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "RRD file has no footer")  # it is read from its beginning
        reader = RrdReader(path)
    for chunk in reader.stream():
        batch = chunk.to_record_batch()
        names = batch.schema.names
        rows = batch.num_rows
        stamps = batch.column("stamp").cast("int64").to_pylist() if "stamp" in names else [0] * rows
        for name in names:
            if ":" in name:
                column = zip(stamps, batch.column(name).to_pylist(), strict=True)
                kept = [(stamp, value) for stamp, value in column if value is not None]
                values.setdefault((str(chunk.entity_path), name), []).extend(kept)
    for column in values.values():
        column.sort(key=lambda row: row[0])
    return Drawn(values=values, blueprints=len(reader.blueprints()))


class Canvas:
    """A recording into a file, and what is in it."""

    def __init__(self, path: Path) -> None:
        self.stream = rr.RecordingStream("test")
        self.stream.save(path)
        set_time(self.stream, STAMP_NS)
        self._path = path

    def read(self) -> Drawn:
        """Finish the file."""
        self.stream.disconnect()
        return read_drawn(self._path)
