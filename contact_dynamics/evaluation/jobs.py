# SPDX-License-Identifier: Apache-2.0
"""Evaluates recordings in this process, in several processes, or on a Dask cluster, and stores the results.

One process, several processes and a cluster return the same numbers to the last bit. An interrupted
evaluation continues from its folder of results.

A process that dies (out of memory, a crash in a library) breaks its pool. The remaining jobs then run one by
one, each in its own process, which identifies the job that crashes. Dask does the same: it marks a job as
failed after it has killed several workers.
"""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import re
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import contact_dynamics.version as version_file
from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.evaluation.log_states import parameters_of
from contact_dynamics.evaluation.recording import evaluate_recording
from contact_dynamics.evaluation.result import SourceResult, joined, source_result
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.run_record import versions_here
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.evaluation.settings import Settings
    from contact_dynamics.evaluation.sources import Source


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Job(Record):
    """The evaluation of one recording."""

    source: Source
    settings: Settings  # horizons, laws and fit window
    # Parameter file with bodies, surfaces and topics. By default, the recording's own configuration is used.
    config: Path | None = None
    # Parameter file for the predictions, if it differs from ``config``, with which the events are found
    asked_with: Path | None = None

    def key(self) -> str:
        """Return the key of the result: a hash of content, configuration, settings and code.

        Raise `OSError` if a file cannot be read.
        """
        parts = {
            "content": self.source.digest(),
            "settings": self.settings.to_dict(),
            "config": _text_of(self.config),
            "asked_with": _text_of(self.asked_with),
            "versions": code_versions(),
        }
        return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def run_job(job: Job) -> SourceResult:
    """Return the result of a recording.

    Every error becomes its ``problem``, so that one bad recording does not stop the others.
    """
    try:
        digest = job.source.digest()
        recording = job.source.read(config=job.config)
        other = job.asked_with or job.config
        informed = None if other is None else parameters_of(ParameterFile(other))[1]
        evaluated = evaluate_recording(recording, job.settings, informed=informed, share=job.source.share)
        return replace(evaluated, source=job.source.name, digest=digest)
    except Exception as error:  # noqa: BLE001  not even a bug here may stop the others
        return failed(job, error)


def failed(job: Job, error: BaseException) -> SourceResult:
    """Return the result of a recording that could not be evaluated."""
    return SourceResult(source=job.source.name, problem=f"{type(error).__name__}: {error}")


@lru_cache(maxsize=1)
def code_versions() -> dict[str, str]:
    """Return the versions on which the results depend, with a hash of the package's code."""
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
    """A folder with one file of results for each recording.

    The file name contains the recording's name and the key of its job. A recording is evaluated again if its
    content, the configuration, the settings or the code have changed. Files are written atomically.
    """

    def __init__(self, path: Path) -> None:
        """Create the folder if it does not exist, or raise `OSError`."""
        path.mkdir(parents=True, exist_ok=True)
        self._path = path
        self._there = {file.stem.rpartition("-")[2]: file for file in path.glob("*.json")}

    def find(self, job: Job) -> SourceResult | None:
        """Return the stored result of a job, whatever its recording was named, or None without one.

        Raises:
            OSError: the recording cannot be read.
        """
        path = self._there.get(job.key()[:_KEY_DIGITS])
        if path is None:
            return None
        try:
            result = source_result(json.loads(path.read_text(encoding="utf-8")))
        except (ValueError, KeyError, TypeError):  # a damaged file is replaced
            return None
        return replace(result, source=job.source.name)

    def put(self, job: Job, result: SourceResult) -> None:
        """Store the result of a job. Failures are not stored, and are tried again next time.

        Raise `OSError` if the file cannot be written.
        """
        if result.problem:
            return
        name = _UNUSUAL.sub("_", job.source.name)[-_LONGEST_NAME:].lstrip("_.-")
        path = self._path / f"{name}-{job.key()[:_KEY_DIGITS]}.json"
        partial = path.with_suffix(f".{os.getpid()}.partial")
        partial.write_text(json.dumps(result.to_dict()), encoding="utf-8")
        partial.replace(path)


LOCAL: Final = "local:"  # prefix of a Dask address for workers on this machine, such as ``local:2``

PROCESS_BYTES: Final = 1 << 20
PROCESS_TOSSES: Final = 8
"""Bytes of logs, or number of tosses, whose evaluation takes several times as long as to start a process."""

Done = tuple[int, SourceResult]


def processes_for(jobs: Sequence[Job]) -> int:
    """Return the default number of processes: one per processor, and fewer if there is little work."""
    work = 0.0
    for source in (job.source for job in jobs):
        if source.is_toss:
            work += 1.0 / PROCESS_TOSSES
        else:
            with suppress(OSError):  # `run_job` reports it
                files = source.path.iterdir() if source.path.is_dir() else [source.path]
                work += sum(file.stat().st_size for file in files) / PROCESS_BYTES
    return min(os.cpu_count() or 1, 1 + int(work))


def run_jobs(jobs: Sequence[Job], *, processes: int = 1, dask: str = "") -> Iterator[Done]:
    """Yield the number of each job and the result of `run_job`, in the order of completion.

    The jobs run in this process, in several ``processes``, or by ``dask``, which is the address of a Dask
    scheduler or ``local:N`` for N workers on this machine. Raise `InvalidFieldError` if the address is
    invalid, `NotSupportedError` if Dask is not installed, and `OSError` if the scheduler cannot be reached.
    """
    if dask:
        yield from _on_dask(jobs, dask)
    elif processes == 1:
        yield from ((number, run_job(job)) for number, job in enumerate(jobs))
    else:
        yield from _in_parts(jobs, processes)


def _in_parts(jobs: Sequence[Job], processes: int) -> Iterator[Done]:
    """Distribute the jobs over processes. If there are more processes than jobs, split the logs too."""
    share = processes // len(jobs) if jobs else 1
    parts = [
        [replace(job, source=each) for each in job.source.parts(share, config=job.config)] for job in jobs
    ]
    places = [(number, place) for number, each in enumerate(parts) for place in range(len(each))]
    tasks = [part for each in parts for part in each]
    found: list[list[SourceResult]] = [[SourceResult()] * len(each) for each in parts]
    left = [len(each) for each in parts]
    done = _in_processes(tasks, processes) if len(tasks) > 1 else run_jobs(tasks)
    for task, result in done:
        number, place = places[task]
        found[number][place] = result
        left[number] -= 1
        if left[number] == 0:
            whole = joined(found[number], [part.source.share[0] for part in parts[number]])
            found[number] = []
            if len(parts[number]) > 1 and (whole.problem or not whole.states):  # for its error
                ((_, whole),) = _in_processes([jobs[number]], 1)
            yield number, whole


def _in_processes(jobs: Sequence[Job], processes: int) -> Iterator[Done]:
    left = dict(enumerate(jobs))
    try:
        for number, result in _in_one_pool(left, min(processes, len(jobs))):
            del left[number]
            yield number, result
    except BrokenProcessPool:
        for number, job in list(left.items()):
            try:
                yield from _in_one_pool({number: job}, 1)
            except BrokenProcessPool as error:  # noqa: PERF203  one job, one process
                yield number, failed(job, error)


def _in_one_pool(jobs: dict[int, Job], processes: int) -> Iterator[Done]:
    with ProcessPoolExecutor(processes, mp_context=_clean_processes()) as pool:
        try:
            numbers = {pool.submit(run_job, job): number for number, job in jobs.items()}
            pending = set(numbers)
            while pending:
                done, pending = wait(pending, return_when=FIRST_COMPLETED)
                for future in done:
                    yield numbers[future], future.result()
        finally:
            pool.shutdown(cancel_futures=True)


def _clean_processes() -> multiprocessing.context.BaseContext:
    """Return a context that starts processes without copies of locks that threads of this process hold.

    Processes are forked from a server that has imported this package, since the import takes most of the
    start-up time. On systems without fork, each process imports the package.
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload([__name__])
    return context


def _on_dask(jobs: Sequence[Job], address: str) -> Iterator[Done]:
    try:
        from dask.distributed import Client, LocalCluster, as_completed
    except ImportError:
        raise NotSupportedError("--dask needs dask[distributed]: pip install '.[evaluate]'") from None
    with _cluster(address, LocalCluster) as cluster, Client(cluster) as client:
        futures = client.map(run_job, jobs, pure=False)
        numbers = {future.key: number for number, future in enumerate(futures)}
        for future in as_completed(futures):
            number = numbers[future.key]
            error = future.exception()
            yield number, future.result() if error is None else failed(jobs[number], error)
            future.release()


def _cluster(address: str, local_cluster: Any) -> Any:
    """Return a context of workers on this machine, or of the address of a scheduler."""
    from contextlib import nullcontext

    if not address.startswith(LOCAL):
        return nullcontext(address)
    count = address.removeprefix(LOCAL)
    if not count.isdigit() or int(count) < 1:
        raise InvalidFieldError("--dask", address, f"the address of a scheduler, or {LOCAL}N with N >= 1")
    return local_cluster(n_workers=int(count), threads_per_worker=1, processes=True, dashboard_address=None)
