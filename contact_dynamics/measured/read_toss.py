# SPDX-License-Identifier: Apache-2.0
"""Reads a recorded toss by its path: the package's own recording, another CSV file, or a cube toss."""

from __future__ import annotations

from pathlib import Path
from typing import Final

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.measured.cube_tosses import read_cube_toss
from contact_dynamics.measured.recorded_toss import Toss, read_toss_csv

__all__ = ["DEFAULT_RECORDING", "Toss", "read_toss"]

DEFAULT_RECORDING: Final = Path(__file__).parent / "tosses" / "brick.csv"
"""The recording of a brick that is part of the package."""


def read_toss(path: str | Path = DEFAULT_RECORDING, *, index: int | None = None) -> Toss:
    """Return the toss at a path: a recording in this project's CSV format, or a cube toss in an `.npz` file.

    ``index``, or a path that ends in ``#17`` or ``:17``, selects a toss of an `.npz` file, by default the
    first one. Raise `FileNotFoundError` if there is no such file, and `InvalidFieldError` if it is neither
    `.csv` nor `.npz`, its content is invalid, or the index is out of range.
    """
    file, chosen = _split_index(path)
    if index is not None:
        chosen = index
    if not file.is_file():
        raise FileNotFoundError(f"TOSS must be a toss recording (.csv or .npz), got no file {str(file)!r}")
    if file.suffix == ".npz":
        return read_cube_toss(file, index=chosen or 0)
    if file.suffix == ".csv":
        if chosen is not None:
            raise InvalidFieldError("TOSS", str(path), "a path without an index, since a .csv has one toss")
        return read_toss_csv(file)
    raise InvalidFieldError("TOSS", str(path), "a toss recording (.csv or .npz)")


def _split_index(path: str | Path) -> tuple[Path, int | None]:
    text = str(path)
    if Path(text).is_file():
        return Path(text), None
    for mark in "#:":
        file, found, index = text.rpartition(mark)
        if found and index.isdigit():
            return Path(file), int(index)
    return Path(text), None
