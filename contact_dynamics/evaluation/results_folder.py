"""A folder with a file for each evaluated recording, so that an evaluation that was ended goes on.

A file is named by its recording and by the key of its job: content, configuration, settings and code. If one
of them has changed, the recording is evaluated again. A file appears whole or not at all.
"""

from __future__ import annotations

import json
import os
import re
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.evaluation.result import source_result

if TYPE_CHECKING:
    from pathlib import Path

    from contact_dynamics.evaluation.job import Job

_KEY_DIGITS: Final = (
    24  # the key has 64; two of a billion jobs share the first 24 with a probability of 1e-11
)
_LONGEST_NAME: Final = 80
_UNUSUAL: Final = re.compile(r"[^A-Za-z0-9._-]+")


class ResultsFolder:
    """The results that are there, and those that come."""

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
