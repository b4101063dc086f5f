"""Who does the jobs: this process, several processes of this machine, or a cluster by Dask.

A process that dies (out of memory, a fault in a library) breaks the pool that it belongs to. The jobs that
were not done then run one by one, each in a process of its own, so that the one that kills its process is
known. Dask does this by itself: it gives up on a job that has killed several workers.
"""

from __future__ import annotations

import multiprocessing
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.evaluation.job import failed, run_job

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from contact_dynamics.evaluation.job import Job

LOCAL: Final = "local:"
"""What a Dask address begins with that means workers of this machine, ``local:2``."""

Done = tuple[int, dict[str, Any]]


def run_jobs(jobs: Sequence[Job], *, processes: int = 1, dask: str = "") -> Iterator[Done]:
    """Yield the number of each job and its result as `run_job` returns it, in the order in which they end.

    Args:
        jobs: What is to be done.
        processes: How many processes of this machine share the work; 1: this one alone.
        dask: Address of a Dask scheduler, or ``local:N`` for N workers here. If it is
            empty, Dask takes no part.

    Raises:
        InvalidFieldError: the address is none.
        NotSupportedError: Dask is not installed.
        OSError: the scheduler cannot be reached.
    """
    if dask:
        yield from _on_dask(jobs, dask)
    elif processes == 1 or len(jobs) < 2:
        yield from ((number, run_job(job)) for number, job in enumerate(jobs))
    else:
        yield from _in_processes(jobs, processes)


def _in_processes(jobs: Sequence[Job], processes: int) -> Iterator[Done]:
    left = dict(enumerate(jobs))
    try:
        for number, content in _in_one_pool(left, min(processes, len(jobs))):
            del left[number]
            yield number, content
    except BrokenProcessPool:
        for number, job in list(left.items()):
            try:
                yield from _in_one_pool({number: job}, 1)
            except BrokenProcessPool as error:  # noqa: PERF203  one job, one process
                yield number, failed(job, error).to_dict()


def _in_one_pool(jobs: dict[int, Job], processes: int) -> Iterator[Done]:
    # Spawned: a fork would copy the locks of this process's threads.
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(processes, mp_context=context) as pool:
        try:
            numbers = {pool.submit(run_job, job): number for number, job in jobs.items()}
            pending = set(numbers)
            while pending:
                done, pending = wait(pending, return_when=FIRST_COMPLETED)
                for future in done:
                    yield numbers[future], future.result()
        finally:
            pool.shutdown(cancel_futures=True)


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
            yield number, future.result() if error is None else failed(jobs[number], error).to_dict()
            future.release()


def _cluster(address: str, local_cluster: Any) -> Any:
    """Return the workers of this machine, or a context with the address of a scheduler."""
    from contextlib import nullcontext

    if not address.startswith(LOCAL):
        return nullcontext(address)
    count = address.removeprefix(LOCAL)
    if not count.isdigit() or int(count) < 1:
        raise InvalidFieldError("--dask", address, f"the address of a scheduler, or {LOCAL}N with N >= 1")
    return local_cluster(n_workers=int(count), threads_per_worker=1, processes=True, dashboard_address=None)
