# SPDX-License-Identifier: Apache-2.0
"""Finds recordings to evaluate, which are logs with states and recorded tosses, and reads them."""

from __future__ import annotations

import hashlib
import re
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.evaluation.log_states import bodies_of_log, recording_of_log
from contact_dynamics.evaluation.recording import recording_of_toss
from contact_dynamics.measured.cube_tosses import count_cube_tosses
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from contact_dynamics.evaluation.recording import Recording

TOSS: Final = ".csv"
TOSSES: Final = ".npz"

LOG: Final = re.compile(r"\.(mcap|db3)(\.(zstd|zst|lz4))?$")  # suffixes of a log's files

_WHAT: Final = f"a log (.mcap, .db3), a toss ({TOSS}), tosses ({TOSSES}), or a folder with any"

_BLOCK: Final = 1 << 20  # bytes per read


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Source(Record):
    """One recording to evaluate, before it is read."""

    path: Path  # folder of a log or one of its files, or a file of tosses
    index: int | None = None  # number of the toss in an ``.npz``, or None if the file is one recording
    # Names of the log's bodies to evaluate, or all if empty. Name and digest do not depend on them.
    bodies: tuple[str, ...] = ()
    # Share of their events to predict, as in `evaluate_recording`. Name and digest do not depend on it.
    share: tuple[int, int] = (0, 1)

    @property
    def name(self) -> str:
        """Name in tables: the path, with the number of the toss."""
        return str(self.path) if self.index is None else f"{self.path}#{self.index}"

    def digest(self) -> str:
        """Return a hash of the content, 64 hexadecimal digits, which does not depend on the path.

        Raise `NotALogError` if the path contains no log, and `OSError` if a file cannot be read.
        """
        files = [self.path] if self.is_toss else BagReader(self.path).paths
        hashes = [_hash_of(file.resolve(), file.stat().st_mtime_ns) for file in files]
        return hashlib.sha256(" ".join([*hashes, str(self.index)]).encode()).hexdigest()

    @property
    def is_toss(self) -> bool:
        """True for a toss, which contains its own body and surface; False for a log."""
        return self.path.suffix in {TOSS, TOSSES}

    def read(self, *, config: Path | None = None) -> Recording:
        """Return the content of the recording.

        The parameter file ``config`` contains the bodies, surfaces and topics of a log, by default the log's
        own record. A toss contains its own body and surface. Raise `ContactDynamicsError` if the content is
        invalid, and `OSError` if a file cannot be read.
        """
        if self.is_toss:
            return recording_of_toss(read_toss(self.path, index=self.index))
        return recording_of_log(self.path, config=config, only=self.bodies)

    def parts(self, most: int, *, config: Path | None = None) -> list[Source]:
        """Return a log as at most ``most`` sources with about the same amount of work. A toss is not split.

        Each source has the same number of bodies, or a share of the events of one of the remaining bodies.
        """
        names: list[str] = []
        if most > 1 and not self.is_toss:
            with suppress(ContactDynamicsError, OSError):  # `read` reports the error
                names = bodies_of_log(self.path, config=config)
        each, left = divmod(len(names), max(most, 1))
        groups = [tuple(names[each * k : each * (k + 1)]) for k in range(most if each else 0)]
        shares = most // max(left, 1)
        return [
            *(replace(self, bodies=group) for group in groups),
            *(
                replace(self, bodies=(name,), share=(k, shares))
                for name in names[each * most :]
                for k in range(shares)
            ),
        ] or [self]


def find_sources(paths: Iterable[str]) -> tuple[list[Source], list[tuple[str, str]]]:
    """Return the recordings at the paths of a command line, in their order.

    The second value is the paths without a recording, each with the reason. A path is a log's folder, one
    file of a log (MCAP or SQLite), a toss in CSV, an ``.npz`` of tosses, one toss of it (``tosses.npz#17``),
    or a folder that is searched for all of these at any depth.
    """
    sources: list[Source] = []
    refused: list[tuple[str, str]] = []
    for text in paths:
        try:
            found = list(_sources_at(text))
            if not found:
                raise InvalidFieldError(text, "no recording in it", _WHAT)
            sources += found
        except (ContactDynamicsError, OSError) as error:  # noqa: PERF203  the other paths remain
            refused.append((text, str(error)))
    return list(dict.fromkeys(sources)), refused


def _sources_at(text: str) -> Iterator[Source]:
    path, mark, index = text.rpartition("#")
    if mark and index.isdigit() and not Path(text).exists():
        yield Source(path=Path(path), index=int(index))
        return
    at = Path(text)
    if at.is_file():
        yield from _sources_of_file(at)
        return
    if not at.is_dir():
        raise InvalidFieldError(text, "no such file or folder", _WHAT)
    files = sorted(file for file in at.rglob("*") if _is_known(file) and file.is_file())
    yield from dict.fromkeys(source for file in files for source in _sources_of_file(file))


def _is_known(file: Path) -> bool:
    return file.suffix in {TOSS, TOSSES} or LOG.search(file.name) is not None


def _sources_of_file(file: Path) -> Iterator[Source]:
    if file.suffix == TOSSES:
        yield from (Source(path=file, index=index) for index in range(count_cube_tosses(file)))
    elif LOG.search(file.name) and (file.parent / "metadata.yaml").is_file():
        yield Source(path=file.parent)  # a bag's folder, whose files are one log
    else:
        yield Source(path=file)


@lru_cache(maxsize=1024)
def _hash_of(file: Path, modified_ns: int) -> str:  # noqa: ARG001  part of the cache's key
    digest = hashlib.sha256()
    with file.open("rb") as stream:
        while block := stream.read(_BLOCK):
            digest.update(block)
    return digest.hexdigest()
