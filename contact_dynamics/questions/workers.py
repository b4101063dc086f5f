# SPDX-License-Identifier: Apache-2.0
"""Worker processes that answer questions, with limits of time and memory.

A question is sent to a worker together with the required context. A worker that exceeds the time limit is
killed and replaced. Workers run at a lower priority than the server. They end with it, or by themselves if it
was killed.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import resource
import signal
import threading
import time
import traceback
from dataclasses import dataclass
from multiprocessing import forkserver, resource_tracker
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypeVar

from contact_dynamics.errors import BusyError, ContactDynamicsError, TookTooLongError, TooLargeError
from contact_dynamics.questions.extent import leave_out_numpy_warnings
from contact_dynamics.questions.services import SERVICES

if TYPE_CHECKING:
    from collections.abc import Callable
    from multiprocessing.connection import Connection
    from multiprocessing.process import BaseProcess

    from contact_dynamics.questions.context import Context

Question = TypeVar("Question")
Answer = TypeVar("Answer")

_NEEDED: Final = (
    *sorted({service.answer.module for service in SERVICES}),
    "scipy.linalg",
    "scipy.optimize",
    "scipy.spatial",
)
"""Modules that a worker imports before it is ready, since the import of SciPy takes longer than most answers.
"""

_NICER: Final = 5
_LOOKS_EVERY_S: Final = 0.05  # interval of checks for a ready worker and for a question
_TRIES_EVERY_S: Final = 1.0  # interval of attempts to start a worker
_HUNG_AFTER_S: Final = 10.0
"""s. The process that starts the workers is replaced if it uses no processor time for so long although a
worker waits for it. One that imports slowly on a busy machine does use some."""

_SPARE_S: Final = 1.0  # for sending the answer, after which a worker ends by itself
_MEGABYTE: Final = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerLimits:
    """Limits of workers."""

    count: int = 2  # Number of workers. With 0, the server answers every question itself.
    deadline: float = 5.0  # s, longest time from handing over a question to its answer or rejection
    memory: int = 1000  # MB, memory limit of a worker for an answer
    max_waiting: int = 8  # largest number of questions that wait while all workers are busy


class _Ready:
    """The message of a worker that is ready."""


class WorkerFault(Exception):  # noqa: N818  it is not caused by the question
    """An unexpected exception in a worker; its text is the traceback."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Job:
    work: tuple[Callable[..., object], object, Context]
    seconds: float  # time limit
    until: float  # s, monotonic
    done: Callable[..., object]


class Workers:
    """Worker processes, and a thread for each that waits for its answers.

    Attributes:
        limits: The limits. A change applies to later questions; the number of processes and their memory do
            not change.
    """

    def __init__(self, limits: WorkerLimits) -> None:
        """Start the processes in the background. It takes a second of processor time."""
        self.limits = limits
        self._jobs: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._open = 0  # number of unfinished jobs
        self._closing = False
        self._workers = [_Worker(limits.memory) for _ in range(limits.count)]
        self._threads = [
            threading.Thread(target=self._run, args=(worker,), name="contact_dynamics worker", daemon=True)
            for worker in self._workers
        ]
        for thread in self._threads:
            thread.start()

    @property
    def count(self) -> int:
        """Number of workers."""
        return len(self._workers)

    @property
    def ready(self) -> int:
        """Number of workers that are ready, or were ready before they were killed."""
        return sum(worker.is_ready for worker in self._workers)

    @property
    def waiting(self) -> int:
        """Number of questions that are neither answered nor rejected yet."""
        return self._open

    def ask(
        self,
        answer: Callable[[Question, Context], Answer],
        question: Question,
        context: Context,
        done: Callable[[Answer | Exception], object],
    ) -> None:
        """Send a question to a worker, or raise `BusyError` if the queue is full.

        The function ``answer`` is from a module that a worker can import. The ``context`` must not change
        (see `excerpt`). ``done`` is called, in another thread, with the answer, with the
        `ContactDynamicsError` that the question raises, or with a `WorkerFault`.
        """
        most = len(self._workers) + self.limits.max_waiting
        with self._lock:
            if self._open >= most:
                raise BusyError(
                    f"{most} questions that take long are being answered or wait, which is the most (workers "
                    "and max_waiting)"
                )
            self._open += 1
        seconds = self.limits.deadline
        job = _Job(
            work=(answer, question, context), seconds=seconds, until=time.monotonic() + seconds, done=done
        )
        self._jobs.put(job)

    def close(self) -> None:
        """Kill all workers. Waiting questions are not answered."""
        self._closing = True
        for _ in self._threads:
            self._jobs.put(None)
        for worker in self._workers:
            worker.close()
        for thread in self._threads:
            thread.join(_SPARE_S)

    def _run(self, worker: _Worker) -> None:
        # Ctrl-C reaches all processes of a terminal. Processes that this thread starts inherit its blocked
        # signals, so they do not end with a traceback while they import. They end with this process.
        with contextlib.suppress(OSError):  # out of memory
            resource_tracker.ensure_running()  # first, since its start unblocks the signal again
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        # The process that starts the workers imports for a second. It inherits the lower priority of its
        # thread, so this delays no answer.
        starter = threading.Thread(target=_start_fork_server)
        starter.start()
        starter.join()
        worker.start()
        asked: list[_Job | None] = []
        while not asked and not worker.has_begun():
            try:
                asked.append(self._jobs.get(timeout=_TRIES_EVERY_S if worker.is_killed else _LOOKS_EVERY_S))
            except queue.Empty:  # noqa: PERF203  the loop waits anyway
                if worker.is_killed:  # it ended before it was ready, or could not be started
                    worker.restart_if_dead()
        while not self._closing and (job := asked.pop() if asked else self._jobs.get()) is not None:
            worker.restart_if_dead()
            outcome = worker.outcome(job)
            with self._lock:
                self._open -= 1
            if self._closing:
                break
            job.done(outcome)
            worker.restart_if_dead()
        worker.close()


def _start_fork_server() -> None:
    os.nice(_NICER)
    with contextlib.suppress(OSError):  # out of memory; the first worker tries again
        forkserver.ensure_running()


def _kill_fork_server_if_it_hangs(done: threading.Event) -> None:
    used = None
    while not done.wait(_HUNG_AFTER_S):
        server = forkserver._forkserver  # noqa: SLF001  it has no public name
        pid: int | None = getattr(server, "_forkserver_pid", None)
        if pid is None:
            continue
        before, used = used, _processor_time(pid)
        if used == before:
            with contextlib.suppress(OSError):
                os.kill(pid, signal.SIGKILL)
            return


def _processor_time(pid: int) -> int:
    """Return the processor time that a process has used, in ticks of the kernel, or 0 if it has ended."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()
    except OSError:
        return 0
    return int(fields[11]) + int(fields[12])


class _Worker:
    """A worker process, and the pipe to it.

    Attributes:
        is_ready: Whether it has been ready.
        is_killed: Whether its process was killed, or ended or failed to start before it was ready.
    """

    def __init__(self, memory: int) -> None:
        self.is_ready = False
        self._memory = memory  # MB
        self._context = multiprocessing.get_context("forkserver")
        self._context.set_forkserver_preload(list(_NEEDED))
        self._process: BaseProcess | None = None
        self.is_killed = False
        self._is_closed = False
        self._pipe, self._its_end = self._context.Pipe()

    def start(self) -> None:
        priority = min(os.getpriority(os.PRIO_PROCESS, os.getpid()) + _NICER, 19)
        arguments = (self._its_end, self._memory * _MEGABYTE, priority)
        process = self._context.Process(target=_answer_questions, args=arguments, daemon=True)
        done = threading.Event()
        threading.Thread(target=_kill_fork_server_if_it_hangs, args=(done,), daemon=True).start()
        try:
            process.start()
        except (EOFError, OSError):  # out of memory, or the starting process was killed
            self._process, self.is_killed = None, True
            return
        finally:
            done.set()
            self._its_end.close()
        self._process = process
        if self._is_closed:
            process.kill()

    def close(self) -> None:
        """Kill the process, even if another thread is starting it."""
        self._is_closed = True
        self._kill()

    def _kill(self) -> None:
        if self._process is not None:
            self._process.kill()

    def has_begun(self) -> bool:
        """Return whether the worker is ready."""
        try:
            if self._pipe.poll():
                self._received()
        except (EOFError, OSError):
            self.is_killed = True
        return self.is_ready

    def _received(self) -> object:
        received = self._pipe.recv()
        self.is_ready = True
        return received

    def outcome(self, job: _Job) -> object:
        """Return the answer to a job, or an exception. The process may have been killed."""
        try:
            self._pipe.send((*job.work, job.seconds + _SPARE_S))
            while self._pipe.poll(max(0.0, job.until - time.monotonic())):
                received = self._received()
                if not isinstance(received, _Ready):
                    return received
            message = (
                f"no answer within {job.seconds:g} s: ask for less (samples, candidates, margins), "
                "or allow more time (answer_deadline)"
            )
            outcome: Exception = TookTooLongError(message)
        except (EOFError, OSError):
            outcome = WorkerFault("the process that computed the answer ended")
        except Exception:  # noqa: BLE001  such as a question that cannot be pickled
            outcome = WorkerFault(traceback.format_exc())
        self._kill()
        self.is_killed = True
        return outcome

    def restart_if_dead(self) -> None:
        """Start another process if this one was killed, here or for lack of memory."""
        if not self.is_killed and self._process is not None and self._process.is_alive():
            return
        self.is_killed = True
        self._pipe.close()
        with contextlib.suppress(OSError):  # out of memory; the next question tries again
            self._pipe, self._its_end = self._context.Pipe()
            self.is_killed = False
            self.start()


def _answer_questions(pipe: Connection, memory: int, priority: int) -> None:
    """Answer questions one after the other, in the worker process."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    os.setpriority(os.PRIO_PROCESS, 0, max(priority, os.getpriority(os.PRIO_PROCESS, 0)))
    leave_out_numpy_warnings()
    limit = _address_space() + memory
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    with contextlib.suppress(OSError):  # the server has ended
        pipe.send(_Ready())
    while True:
        try:
            answer, question, context, seconds = pipe.recv()
        except (EOFError, OSError):  # the server has ended
            return
        signal.setitimer(signal.ITIMER_REAL, seconds)
        outcome: object
        try:
            outcome = answer(question, context)
        except ContactDynamicsError as error:
            outcome = error
        except MemoryError:
            most = f"{memory // _MEGABYTE} MB"
            allowed = f"one that needs at most {most} (worker_memory)"
            outcome = TooLargeError("question", f"one that needs more than {most}", allowed)
        except Exception:  # noqa: BLE001  the server reports it
            outcome = WorkerFault(traceback.format_exc())
        with contextlib.suppress(OSError):
            pipe.send(outcome)
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _address_space() -> int:
    """Return the size of the address space of this process, bytes."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    return pages * resource.getpagesize()
