"""One recording's work, as it is given to a process or a machine, and what identifies it.

A job is plain data, and what it returns is plain data, so that one process, several, and a cluster do the
same and give the same numbers to the last bit. A folder of their results lets an evaluation that was ended
go on.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import contact_dynamics.version as version_file
from contact_dynamics.evaluation.log_states import parameters_of
from contact_dynamics.evaluation.recording import evaluate_recording
from contact_dynamics.evaluation.result import SourceResult, result_of, source_result
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.run_record import versions_here
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.evaluation.settings import Settings
    from contact_dynamics.evaluation.sources import Source


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Job(Record):
    """A recording, and what is asked about it.

    Attributes:
        source: The recording.
        settings: What is asked.
        config: File of parameters that describes bodies, surfaces and topics. If it is None, the
            recording says so itself.
        asked_with: File of parameters that whoever asks knows instead, where it is not that of the events.
    """

    source: Source
    settings: Settings
    config: Path | None = None
    asked_with: Path | None = None

    def key(self) -> str:
        """Return what identifies the result: a hash of content, configuration, settings and code.

        Raises:
            OSError: a file cannot be read.
        """
        parts = {
            "content": self.source.digest(),
            "settings": self.settings.to_dict(),
            "config": _text_of(self.config),
            "asked_with": _text_of(self.asked_with),
            "versions": code_versions(),
        }
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def run_job(job: Job) -> dict[str, Any]:
    """Return the `SourceResult` of a recording as a dict that JSON takes.

    Whatever goes wrong becomes its ``problem``, so that one bad recording does not stop the rest.
    """
    try:
        digest = job.source.digest()
        recording = job.source.read(config=job.config)
        other = job.asked_with or job.config
        informed = None if other is None else parameters_of(ParameterFile(other))[1]
        evaluated = evaluate_recording(recording, job.settings, informed=informed)
        return result_of(job.source.name, digest, evaluated).to_dict()
    except Exception as error:  # noqa: BLE001  a fault of ours too must not stop the others
        return failed(job, error).to_dict()


def failed(job: Job, error: BaseException) -> SourceResult:
    """Return the result of a recording that could not be evaluated."""
    return SourceResult(source=job.source.name, problem=f"{type(error).__name__}: {error}")


@lru_cache(maxsize=1)
def code_versions() -> dict[str, str]:
    """Return the versions that the numbers depend on, with a hash of the package's own code."""
    return {**versions_here(), "code": _code_hash()}


def _code_hash() -> str:
    package = Path(version_file.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        digest.update(path.relative_to(package).as_posix().encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def _text_of(path: Path | None) -> str:
    return "" if path is None else path.read_text(encoding="utf-8")


_KEY_DIGITS: Final = (
    24  # the key has 64; two of a billion jobs share the first 24 with a probability of 1e-11
)
_LONGEST_NAME: Final = 80
_UNUSUAL: Final = re.compile(r"[^A-Za-z0-9._-]+")


class ResultsFolder:
    """The results that are there, and those that come: a file for each recording.

    A file is named by its recording and by the key of its job: content, configuration, settings and code. If
    one of them has changed, the recording is evaluated again. A file appears whole or not at all.
    """

    def __init__(self, path: Path) -> None:
        """Make the folder if it is missing.

        Raises:
            OSError: it cannot be made.
        """
        path.mkdir(parents=True, exist_ok=True)
        self._path = path
        self._there = {file.stem.rpartition("-")[2]: file for file in path.glob("*.json")}

    def find(self, job: Job) -> dict[str, Any] | None:
        """Return the result of a job that was done before under any name, or None if there is none.

        Raises:
            OSError: the recording cannot be read.
        """
        path = self._there.get(job.key()[:_KEY_DIGITS])
        if path is None:
            return None
        try:
            content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            source_result(content)
        except (ValueError, KeyError, TypeError):  # a damaged file is made again
            return None
        return {**content, "source": job.source.name}

    def put(self, job: Job, content: dict[str, Any]) -> None:
        """Keep the result of a job; one that could not be evaluated is not kept, and is tried again.

        Raises:
            OSError: the file cannot be written.
        """
        if content["problem"]:
            return
        name = _UNUSUAL.sub("_", job.source.name)[-_LONGEST_NAME:].lstrip("_.-")
        path = self._path / f"{name}-{job.key()[:_KEY_DIGITS]}.json"
        partial = path.with_suffix(f".{os.getpid()}.partial")
        partial.write_text(json.dumps(content), encoding="utf-8")
        partial.replace(path)
