"""Comparisons as a table of columns, for pandas and its like: CSV, and Parquet by PyArrow."""

from __future__ import annotations

import csv
from dataclasses import fields
from enum import Enum
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.evaluation.comparison import Comparison

if TYPE_CHECKING:
    from pathlib import Path

    from contact_dynamics.evaluation.result import Evaluation

_PREDICTED: Final = ("px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")

COLUMNS: Final = (
    "recording",
    *(field.name for field in fields(Comparison) if field.name != "predicted"),
    *(f"predicted_{name}" for name in _PREDICTED),
)
"""The names of the columns, in SI units and radians."""


def write_csv(path: Path, evaluation: Evaluation) -> None:
    """Write a row for each comparison; a cell without a value is empty.

    Raises:
        OSError: the file cannot be written.
    """
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.writer(stream)
        writer.writerow(COLUMNS)
        writer.writerows(_cells(source, row) for source, row in evaluation.rows())


def write_parquet(path: Path, evaluation: Evaluation) -> None:
    """Write a row for each comparison; a cell without a value is null.

    Raises:
        NotSupportedError: PyArrow is not installed.
        OSError: the file cannot be written.
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
