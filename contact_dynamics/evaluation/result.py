# SPDX-License-Identifier: Apache-2.0
"""Results of an evaluation, as records, JSON, CSV and Parquet."""

from __future__ import annotations

import csv
import json
from dataclasses import dataclass, fields, replace
from enum import Enum
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.evaluation.comparison import Comparison
from contact_dynamics.evaluation.settings import Law, Method
from contact_dynamics.measured.events import EventKind, FoundEvent
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

FORMAT: Final = "contact_dynamics evaluation 2"  # value of ``format`` in the JSON of an evaluation

_ENUMS: Final[dict[str, type[Enum]]] = {"kind": EventKind, "method": Method, "law": Law}
_ARRAYS: Final = frozenset({"predicted", "orientation_std", "angular_velocity_std"})


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SourceResult(Record):
    """The evaluation of one recording."""

    source: str = ""  # name of the recording; may be empty
    digest: str = ""  # hash of its content; empty if unknown
    problem: str = ""  # reason why it was not evaluated; empty if it was
    damage: str = ""  # description of what could not be read; empty for an intact recording
    states: int = 0  # number of measured states
    seconds: float = 0.0  # duration of measured motion, summed over all bodies, s
    events: tuple[FoundEvent, ...] = ()  # the events, in the order of bodies and time
    comparisons: tuple[Comparison, ...] = ()  # a row for each prediction of each event


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Evaluation(Record):
    """The evaluation of all recordings."""

    versions: dict[str, str]  # versions of the software, by name, with a hash of the package's code
    configuration: str  # description of the source of bodies and surfaces
    results: tuple[SourceResult, ...]  # result of each recording, in the order given

    def rows(self) -> list[tuple[str, Comparison]]:
        """Return all comparisons, each with its recording's name."""
        return [(result.source, row) for result in self.results for row in result.comparisons]

    def write_json(self, path: Path) -> None:
        """Write the complete evaluation, which `read_evaluation` reads back to the last bit."""
        content = {"format": FORMAT, **self.to_dict()}
        path.write_text(json.dumps(content) + "\n", encoding="utf-8")


def read_evaluation(path: Path) -> Evaluation:
    """Return an evaluation that was written as JSON.

    Raise `InvalidFieldError` if the file does not contain an evaluation, and `OSError` if it cannot be read.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT:
            raise InvalidFieldError(f"{path}: format", content["format"], repr(FORMAT))
        return Evaluation(
            versions=dict(content["versions"]),
            configuration=str(content["configuration"]),
            results=tuple(source_result(each) for each in content["results"]),
        )
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        if isinstance(error, InvalidFieldError):
            raise
        allowed = "the JSON that evaluate --json has written"
        raise InvalidFieldError(str(path), f"{type(error).__name__}: {error}", allowed) from error


def source_result(content: dict[str, Any]) -> SourceResult:
    """Return the result from its `to_dict`; a missing field raises `KeyError`."""
    plain = {field.name: content[field.name] for field in fields(SourceResult)}
    plain["events"] = tuple(FoundEvent(**_typed(FoundEvent, each)) for each in plain["events"])
    plain["comparisons"] = tuple(Comparison(**_typed(Comparison, each)) for each in plain["comparisons"])
    return SourceResult(**plain)


def joined(parts: Sequence[SourceResult], shares: Sequence[int]) -> SourceResult:
    """Join the results of parts of a recording.

    A part with share 0 begins a group of bodies; the parts after it, with shares 1, 2, ..., contain the other
    shares of the same bodies' events.
    """
    events: list[FoundEvent] = []
    rows: list[Comparison] = []
    first, wholes = 0, [part for part, share in zip(parts, shares, strict=True) if share == 0]
    for part, share in zip(parts, shares, strict=True):
        if share == 0:
            first = len(events)
            events += part.events
        rows += (replace(row, event=row.event + first) if first else row for row in part.comparisons)
    return replace(
        parts[0],
        problem=next((part.problem for part in parts if part.problem), ""),
        states=sum(part.states for part in wholes),
        seconds=sum(part.seconds for part in wholes),
        events=tuple(events),
        comparisons=tuple(sorted(rows, key=lambda row: row.event)),  # each share has events of all stretches
    )


def _typed(kind: type[FoundEvent | Comparison], content: dict[str, Any]) -> dict[str, Any]:
    return {field.name: _value(field.name, content[field.name]) for field in fields(kind)}


def _value(name: str, plain: Any) -> Any:
    if plain is None:
        return None
    if name in _ENUMS:
        return _ENUMS[name][plain]
    if name in _ARRAYS:
        return np.array(plain, dtype=np.float64)
    if name == "state":
        return BodyState(**plain)
    return plain


_PREDICTED: Final = ("px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")

COLUMNS: Final = (
    "recording",
    *(field.name for field in fields(Comparison) if field.name != "predicted"),
    *(f"predicted_{name}" for name in _PREDICTED),
)
"""The names of the columns, in SI units and radians."""


def write_csv(path: Path, evaluation: Evaluation) -> None:
    """Write a row for each comparison; a cell without a value is empty. Raise `OSError` if that fails."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        writer.writerows(_cells(source, row) for source, row in evaluation.rows())


def write_parquet(path: Path, evaluation: Evaluation) -> None:
    """Write a row for each comparison; a cell without a value is null.

    Raise `NotSupportedError` if PyArrow is not installed, and `OSError` if the file cannot be written.
    """
    try:
        import pyarrow as pa
        from pyarrow import parquet
    except ImportError:
        raise NotSupportedError("--parquet needs pyarrow: pip install '.[evaluate]'") from None
    rows = [_cells(source, row) for source, row in evaluation.rows()]
    columns = {name: [row[i] for row in rows] for i, name in enumerate(COLUMNS)}
    parquet.write_table(pa.table(columns), path)


def _cells(source: str, row: Comparison) -> list[Any]:
    cells: list[Any] = [source]
    for field in fields(Comparison):
        if field.name != "predicted":
            value = getattr(row, field.name)
            cells.append(value.value if isinstance(value, Enum) else value)
    numbers = [None] * len(_PREDICTED) if row.predicted is None else row.predicted.tolist()
    return [*cells, *numbers]
