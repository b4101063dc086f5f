# SPDX-License-Identifier: Apache-2.0
"""These processes answer questions, each within a time and a memory that are stated.

A question goes to a worker together with all that is known about it. A worker that is not ready when the time
is over is killed and replaced. It runs at a lower priority than the process that serves, ends when that one
ends, and ends by itself if nobody is left to kill it.
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
"""What a worker has imported before it is asked: an import of SciPy takes longer than most answers."""

_NICER: Final = 5
_LOOKS_EVERY_S: Final = 0.05  # whether a worker is ready, and whether there is a question for it
_TRIES_EVERY_S: Final = 1.0  # to start a worker that ended before it was ready
_HUNG_AFTER_S: Final = 10.0
"""Time in which the process that starts the workers uses no processor although a worker waits for it. Then it
counts as hung, and is replaced. One that imports slowly on a busy machine is left alone."""

_SPARE_S: Final = 1.0  # that a worker has to send its answer before it ends by itself
_MEGABYTE: Final = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkerLimits:
    """What workers may take.

    Attributes:
        count: How many there are. Zero answers every question in the process that asks.
        deadline: s, from when a question is handed over until it is answered or refused.
        memory: MB that one may take for an answer.
        max_waiting: How many questions may wait while all workers are busy.
    """

    count: int = 2
    deadline: float = 5.0
    memory: int = 1000
    max_waiting: int = 8


class _Ready:
    """What a worker says when it can be asked."""


class WorkerFault(Exception):  # noqa: N818  it is no error of a question
    """A fault of the code that a worker met; its text is the traceback."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Job:
    work: tuple[Callable[..., object], object, Context]
    seconds: float  # that it may take
    until: float  # s, monotonic
    done: Callable[..., object]


class Workers:
    """A few processes that answer questions, and threads that wait for them.

    Attributes:
        limits: What they may take. A change counts for the questions that are asked later; the number of
            processes and their memory stay as they were.
    """

    def __init__(self, limits: WorkerLimits) -> None:
        """Have the processes started. They need a second of processor time, and questions wait for that."""
        self.limits = limits
        self._jobs: queue.SimpleQueue[_Job | None] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._open = 0  # jobs that are not done yet
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
        """How many workers there are."""
        return len(self._workers)

    @property
    def ready(self) -> int:
        """How many of them are ready to be asked, or were so before they were killed."""
        return sum(worker.is_ready for worker in self._workers)

    @property
    def waiting(self) -> int:
        """How many questions are neither answered nor refused yet."""
        return self._open

    def ask(
        self,
        answer: Callable[[Question, Context], Answer],
        question: Question,
        context: Context,
        done: Callable[[Answer | Exception], object],
    ) -> None:
        """Have a question answered.

        Args:
            answer: answers it; a function of a module, which a worker imports.
            question: the question.
            context: what is known. It must not change, so ask with an `excerpt`.
            done: takes the answer, or an exception, in another thread: a `ContactDynamicsError` that the
                question met, or a `WorkerFault`.

        Raises:
            BusyError: as many questions as may wait are waiting.
        """
        most = len(self._workers) + self.limits.max_waiting
        with self._lock:
            if self._open >= most:
                message = (
                    f"{most} questions that take long are being answered or wait, which is the most (workers "
                    "and max_waiting)"
                )
                raise BusyError(message)
            self._open += 1
        seconds = self.limits.deadline
        job = _Job(
            work=(answer, question, context), seconds=seconds, until=time.monotonic() + seconds, done=done
        )
        self._jobs.put(job)

    def close(self) -> None:
        """Kill all workers, whatever they do. Questions that wait get no answer."""
        self._closing = True
        for _ in self._threads:
            self._jobs.put(None)
        for worker in self._workers:
            worker.close()
        for thread in self._threads:
            thread.join(_SPARE_S)

    def _run(self, worker: _Worker) -> None:
        # Ctrl-C reaches all processes of a terminal. Those that this thread starts inherit what it blocks, so
        # that they do not end with a traceback while they still import. They end with this process.
        with contextlib.suppress(OSError):  # the machine has no room for it
            resource_tracker.ensure_running()  # first, since its start unblocks the signal again
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        # What starts the workers imports for a second. As each thread of Linux has a priority of its own, and
        # its processes begin with that, this delays no answer.
        starter = threading.Thread(target=_start_fork_server)
        starter.start()
        starter.join()
        worker.start()
        asked: list[_Job | None] = []
        while not asked and not worker.has_begun():
            try:
                asked.append(self._jobs.get(timeout=_TRIES_EVERY_S if worker.is_killed else _LOOKS_EVERY_S))
            except queue.Empty:  # noqa: PERF203  it waits anyway
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
    with contextlib.suppress(OSError):  # the machine has no room for it; the first worker tries again
        forkserver.ensure_running()


def _kill_fork_server_if_it_hangs(done: threading.Event) -> None:
    used = None
    while not done.wait(_HUNG_AFTER_S):
        server = forkserver._forkserver  # noqa: SLF001  there is no public way to it
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
    """A process, and the pipe to it.

    Attributes:
        is_ready: Whether it has been ready to be asked.
        is_killed: Whether its process was killed, or has ended or failed to start before it was ready.
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
        except (EOFError, OSError):  # the machine has no room for it, or what starts it was killed
            self._process, self.is_killed = None, True
            return
        finally:
            done.set()
            self._its_end.close()
        self._process = process
        if self._is_closed:
            process.kill()

    def close(self) -> None:
        """Kill the process, also one that is being started in another thread."""
        self._is_closed = True
        self._kill()

    def _kill(self) -> None:
        if self._process is not None:
            self._process.kill()

    def has_begun(self) -> bool:
        """Return whether it is ready to be asked."""
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
        """Return the answer to a job, or the exception that it ends with. The process may be killed then."""
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
        except Exception:  # noqa: BLE001  a question that cannot be sent, an answer that cannot be received
            outcome = WorkerFault(traceback.format_exc())
        self._kill()
        self.is_killed = True
        return outcome

    def restart_if_dead(self) -> None:
        """Have another process started if this one was killed, here or by a machine short of memory."""
        if not self.is_killed and self._process is not None and self._process.is_alive():
            return
        self.is_killed = True
        self._pipe.close()
        with contextlib.suppress(OSError):  # the machine has no room for it; the next question tries again
            self._pipe, self._its_end = self._context.Pipe()
            self.is_killed = False
            self.start()


def _answer_questions(pipe: Connection, memory: int, priority: int) -> None:
    """Answer one question after another: what a worker does."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    os.setpriority(os.PRIO_PROCESS, 0, max(priority, os.getpriority(os.PRIO_PROCESS, 0)))
    leave_out_numpy_warnings()
    limit = _address_space() + memory
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    with contextlib.suppress(OSError):  # who asks is gone
        pipe.send(_Ready())
    while True:
        try:
            answer, question, context, seconds = pipe.recv()
        except (EOFError, OSError):  # who asks is gone
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
        except Exception:  # noqa: BLE001  told by who asked
            outcome = WorkerFault(traceback.format_exc())
        with contextlib.suppress(OSError):
            pipe.send(outcome)
        signal.setitimer(signal.ITIMER_REAL, 0.0)


def _address_space() -> int:
    """Return how much address space this process has, bytes."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    return pages * resource.getpagesize()
