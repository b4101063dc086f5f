# SPDX-License-Identifier: Apache-2.0
"""The table of a log: a `DataFrame` of pandas, or CSV or Parquet in a file, or CSV on the terminal.

When a file is written, memory holds one batch of rows.
"""

from __future__ import annotations

import csv
import json
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TextIO, TypeAlias

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.replay.events import LoggedEvents
from contact_dynamics.replay.rows import COLUMNS, Rows

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from contact_dynamics.replay.rows import Cell

    Write: TypeAlias = Callable[[dict[str, Cell]], None]

CSV: Final = ".csv"
PARQUET: Final = ".parquet"

_BATCH: Final = 1000  # rows

_FOR_PANDAS: Final = {
    "pandas": json.dumps(
        {
            "columns": [
                {
                    "name": name,
                    "field_name": name,
                    "pandas_type": "int64",
                    "numpy_type": "Int64",
                    "metadata": None,
                }
                for name, kind in COLUMNS.items()
                if kind is int
            ],
            "index_columns": [],
            "column_indexes": [],
        }
    )
}
"""Makes pandas read columns with empty cells as integers instead of floats, which cannot represent ns."""


def log_to_frame(log: Path | str) -> Any:
    """Return the requests and responses of a log of the server as a `DataFrame` of pandas.

    Its rows and columns are those of `contact-dynamics replay table` (docs/replay.md). Empty cells are
    missing values, and whole numbers, such as times in ns, remain whole.

    Args:
        log: the folder of the log, or one of its files.

    Raises:
        NotSupportedError: pandas is not installed.
        NotALogError: it is no log, or none of the server.

    Warns:
        DamagedLogWarning: a part of the log could not be read; `UnfinishedLogWarning` if only its end is
            missing.
    """
    try:
        import pandas as pd  # optional
    except ModuleNotFoundError:
        raise NotSupportedError("log_to_frame needs pandas: pip install pandas") from None
    events = LoggedEvents(Path(log))
    rows = list(Rows(events, log=str(log)))
    events.warn_of_damage()
    types = {str: "string", int: "Int64", float: "float64"}
    return pd.DataFrame(
        {name: pd.Series([row[name] for row in rows], dtype=types[kind]) for name, kind in COLUMNS.items()}
    )


@contextmanager
def open_table(path: Path | None) -> Iterator[Write]:
    """Yield a function that writes a row. The file appears when the context ends, unless there are no rows.

    The file has the suffix `CSV` or `PARQUET`, and is replaced. If the path is None, CSV is written to the
    standard output. Raise `InvalidFieldError` for another suffix, and `NotSupportedError` if pyarrow is not
    installed.
    """
    if path is None:
        yield _csv(sys.stdout)
        return
    if path.suffix not in {CSV, PARQUET}:
        raise InvalidFieldError("--output", str(path), f"a file that ends in {CSV} or {PARQUET}")
    part, count = path.with_name(f"{path.name}.part"), 0
    try:
        with _csv_file(part) if path.suffix == CSV else _parquet(part) as write:

            def counted(row: dict[str, Cell]) -> None:
                nonlocal count
                count += 1
                write(row)

            yield counted
        if count > 0:
            part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def _csv_file(path: Path) -> Iterator[Write]:
    with path.open("w", encoding="utf-8", newline="") as stream:
        yield _csv(stream)


def _csv(stream: TextIO) -> Write:
    writer = csv.DictWriter(stream, list(COLUMNS))
    is_begun = False

    def write(row: dict[str, Cell]) -> None:
        nonlocal is_begun
        if not is_begun:
            is_begun = True
            writer.writeheader()
        writer.writerow(row)

    return write


@contextmanager
def _parquet(path: Path) -> Iterator[Write]:
    try:
        import pyarrow as pa  # large, hence an extra
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        raise NotSupportedError("a .parquet file requires pyarrow: pip install '.[evaluate]'") from None
    types = {str: pa.string(), int: pa.int64(), float: pa.float64()}
    schema = pa.schema([(name, types[kind]) for name, kind in COLUMNS.items()], metadata=_FOR_PANDAS)
    waiting: list[dict[str, Cell]] = []
    with pq.ParquetWriter(path, schema) as writer:

        def flush() -> None:
            writer.write_table(pa.Table.from_pylist(waiting, schema=schema))
            waiting.clear()

        def write(row: dict[str, Cell]) -> None:
            waiting.append(row)
            if len(waiting) == _BATCH:
                flush()

        yield write
        flush()
