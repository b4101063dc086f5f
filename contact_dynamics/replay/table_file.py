"""Writes rows as CSV or Parquet to a file, or as CSV to the terminal. Memory holds one batch of rows."""

from __future__ import annotations

import csv
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Final, TypeAlias

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.replay.rows import COLUMNS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from contact_dynamics.replay.answer_rows import Cell

    Write: TypeAlias = Callable[[dict[str, Cell]], None]

CSV: Final = ".csv"
PARQUET: Final = ".parquet"

_BATCH: Final = 1000  # rows


@contextmanager
def open_table(path: Path | None) -> Iterator[Write]:
    """Yield a function that takes a row; the table is whole when the context ends.

    Args:
        path: a file that ends in `CSV` or `PARQUET`, which is replaced. Without a file, CSV goes to
            the standard output.

    Raises:
        InvalidFieldError: the file has another ending.
        NotSupportedError: it is to be Parquet, and pyarrow is not installed.
    """
    if path is None:
        yield _csv(sys.stdout)
    elif path.suffix == CSV:
        with path.open("w", encoding="utf-8", newline="") as stream:
            yield _csv(stream)
    elif path.suffix == PARQUET:
        with _parquet(path) as write:
            yield write
    else:
        raise InvalidFieldError("out", str(path), f"a file that ends in {CSV} or {PARQUET}")


def _csv(stream: Any) -> Write:
    writer = csv.DictWriter(stream, list(COLUMNS))
    writer.writeheader()
    return writer.writerow


@contextmanager
def _parquet(path: Path) -> Iterator[Write]:
    try:
        import pyarrow as pa  # it is large, so it is an extra
        import pyarrow.parquet as pq
    except ModuleNotFoundError:
        message = "out: pyarrow is not installed; the extra [evaluate] brings it: pip install '.[evaluate]'"
        raise NotSupportedError(message) from None
    types = {str: pa.string(), int: pa.int64(), float: pa.float64()}
    schema = pa.schema([(name, types[kind]) for name, kind in COLUMNS.items()])
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
