"""Reads a log: a bag folder or a bare ``.mcap``, ours or rosbag2's, in the order in which it was written.

Every checksum is checked (the MCAP library's own choice of reader drops the check on a damaged file, so this
reads front to back by its stream reader). A log cut short by a crash or a full disk gives all messages of its
whole chunks; `BagReader.damage` then says what is missing and a `DamagedLogWarning` is raised as a warning.

Needs no ROS: messages come as bytes, and `decoding` turns them into message objects where the packages are
installed.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from mcap.exceptions import InvalidMagic
from mcap.records import Channel, Message, Metadata, Schema
from mcap.stream_reader import StreamReader

from contact_dynamics.recording.bag_metadata import RUN_RECORD
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from mcap.records import McapRecord

_SPLIT_NUMBER: Final = re.compile(r"_(\d+)\.mcap$")


@dataclass(frozen=True, slots=True, kw_only=True)
class LoggedMessage:
    """One message as it was logged."""

    topic: str  # with its leading slash
    type_name: str  # "package/msg/Name" or "package/srv/Name_Event"
    data: bytes  # serialised (CDR)
    log_time_ns: int  # when it was received, ns since the epoch
    publish_time_ns: int  # when its source made it, ns since the epoch


class BagReader:
    """A log to read from; each call of a method reads the file anew."""

    def __init__(self, path: str | Path) -> None:
        """Find the files of a log.

        Args:
            path: a bag folder, whose ``.mcap`` files are read in the order of their numbers, or one such
                file.

        Raises:
            NotALogError: there is no such file.
        """
        path = Path(path)
        self.paths = sorted(path.glob("*.mcap"), key=_split_number) if path.is_dir() else [path]
        self.damage: str | None = None  # what the last reading met, None: it was whole
        if not self.paths or not self.paths[0].is_file():
            raise NotALogError(f"{path}: no MCAP file here")

    def messages(self, topics: Collection[str] | None = None) -> Iterator[LoggedMessage]:
        """Yield the messages, of all topics or of those named, in the order in which they were written."""
        self.damage = None
        for path in self.paths:
            schemas: dict[int, str] = {}
            channels: dict[int, tuple[str, str]] = {}
            for record in self._records(path):
                if isinstance(record, Message):
                    if record.channel_id not in channels:  # what defined it was damaged beyond recognition
                        return self._report_damage(path, "(a message of a channel that it does not define)")
                    topic, type_name = channels[record.channel_id]
                    if topics is None or topic in topics:
                        yield LoggedMessage(
                            topic=topic,
                            type_name=type_name,
                            data=record.data,
                            log_time_ns=record.log_time,
                            publish_time_ns=record.publish_time,
                        )
                elif isinstance(record, Schema):
                    schemas[record.id] = record.name
                elif isinstance(record, Channel):
                    channels[record.id] = record.topic, schemas.get(record.schema_id, "")

    def run(self) -> dict[str, str]:
        """Return what the writer of the log said of its run; empty where it is not one of ours."""
        for path in self.paths:
            for record in self._records(path):
                if isinstance(record, Metadata) and record.name == RUN_RECORD:
                    return record.metadata
        return {}

    def _records(self, path: Path) -> Iterator[McapRecord]:
        size = path.stat().st_size
        with path.open("rb") as stream:
            records = StreamReader(stream, validate_crcs=True, record_size_limit=size).records
            while True:
                try:
                    record = next(records)
                except StopIteration:
                    return
                except InvalidMagic as error:
                    if stream.tell() <= len(_MAGIC):
                        raise NotALogError(f"{path} is not an MCAP file") from error
                    return self._report_damage(path, _near(stream.tell(), error))
                except Exception as error:  # noqa: BLE001  damaged bytes make the library raise nearly anything
                    return self._report_damage(path, _near(stream.tell(), error))
                yield record

    def _report_damage(self, path: Path, what: str) -> None:
        self.damage = f"{path} is damaged or was cut short {what}"
        warnings.warn(self.damage, DamagedLogWarning, stacklevel=4)


def _near(position: int, error: Exception) -> str:
    return f"near byte {position} ({type(error).__name__}: {error})"


_MAGIC: Final = b"\x89MCAP0\r\n"


def _split_number(path: Path) -> tuple[int, str]:
    match = _SPLIT_NUMBER.search(path.name)
    return (int(match[1]) if match else 0, path.name)
