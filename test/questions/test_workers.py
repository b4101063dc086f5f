# SPDX-License-Identifier: Apache-2.0
"""Workers as real processes: answers, a deadline, a limit of memory, a fault, and a queue that is full."""

from __future__ import annotations

import operator
import os
import pickle
import queue
import resource
import signal
import time
from collections.abc import Callable, Iterator
from multiprocessing import active_children
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.errors import BusyError, InvalidFieldError, TookTooLongError, TooLargeError
from contact_dynamics.questions import (
    AtTimes,
    Context,
    PublishedState,
    StateStore,
    TossQuestion,
    TumblingQuestion,
    UntilContact,
    ask,
    tumbling,
)
from contact_dynamics.questions.effort import MAX_QUICK_FITTED, excerpt
from contact_dynamics.questions.services import Answer, Question, service_of
from contact_dynamics.questions.workers import WorkerFault, WorkerLimits, Workers
from contact_dynamics.shapes.convex import box

PATIENCE_S = 60.0  # for a busy machine, on which a worker takes long to start
FOR_EVER = 10**10  # powers of three that no worker computes in this time


@pytest.fixture(scope="module")
def workers() -> Iterator[Workers]:
    workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=0))
    yield workers
    workers.close()


def outcome(workers: Workers, answer: Callable[..., Any], question: Any, known: Any) -> Any:
    outcomes: queue.SimpleQueue[Any] = queue.SimpleQueue()
    workers.ask(answer, question, known, outcomes.put)
    return outcomes.get(timeout=2.0 * PATIENCE_S)


def brick_world() -> Context:
    brick = Body(
        name="brick",
        mass_properties=MassProperties(mass=1.0, I_B=0.1 * np.eye(3)),
        shape=box(size=(0.2, 0.1, 0.1)),
    )
    floor = Surface(name="floor", p_WS_W=np.zeros(3), normal_W=(0.0, 0.0, 1.0), friction=0.3, restitution=0.5)
    states = StateStore(history=10.0, timeout=1.0)
    world = World(bodies=(brick,), surfaces=(floor,), gravity_W=STANDARD_GRAVITY_W)
    for i in range(200):
        state = BodyState(
            p_WB_W=(0.001 * i, 0.0, 5.0 + 0.5 * STANDARD_GRAVITY_W[2] * (0.001 * i) ** 2),
            q_WB=(0.0, 0.0, 0.0, 1.0),
            v_WB_W=(1.0, 0.0, 0.001 * i * STANDARD_GRAVITY_W[2]),
            stamp_ns=1_000_000 * i,
        )
        states.add_unread("brick", state.stamp_ns, lambda state=state: state)  # type: ignore[misc]
    return Context(world=world, states=states, now_ns=lambda: 200_000_000)


@pytest.mark.parametrize(
    "source",
    [
        PublishedState(),
        PublishedState(stamp_ns=55_500_000),
        PublishedState(fit_window=0.02),
        PublishedState(fit_window=0.01, stamp_ns=55_900_000),  # 9 ms before it, 10 ms before the last state
        PublishedState(fit_window=0.01, stamp_ns=205_000_000),  # after the newest state
    ],
)
def test_a_worker_answers_as_this_process_does(workers: Workers, source: PublishedState) -> None:
    question = TumblingQuestion(body="brick", state=source, sampling=AtTimes(times=[0.0, 0.1]))
    known = brick_world()
    answer = outcome(workers, tumbling.answer, question, excerpt(question, known))
    here = ask(question, known)
    np.testing.assert_array_equal(answer.trajectory.p_WB_W, here.trajectory.p_WB_W)
    assert answer.fit == here.fit
    assert len(pickle.dumps(excerpt(question, known))) < 20_000  # of 200 states only those that it needs


def test_an_error_arrives_as_it_was(workers: Workers) -> None:
    question = TumblingQuestion(body="brick", state=PublishedState(fit_window=1e-9))
    known = brick_world()
    with pytest.raises(InvalidFieldError) as here:
        ask(question, known)
    there = outcome(workers, tumbling.answer, question, excerpt(question, known))
    assert type(there) is type(here.value)
    assert str(there) == str(here.value)


def test_a_question_that_needs_much_memory_is_refused(workers: Workers) -> None:
    refused = outcome(workers, operator.mul, b"x", 2_000_000_000)
    assert isinstance(refused, TooLargeError)
    assert "(worker_memory)" in str(refused)
    assert "300 MB" in str(refused)


def test_a_fault_comes_back_with_its_place(workers: Workers) -> None:
    fault = outcome(workers, operator.getitem, (), 1)
    assert isinstance(fault, WorkerFault)
    assert "IndexError" in str(fault)


def test_past_its_deadline_a_worker_is_killed_and_the_next_question_is_answered() -> None:
    workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1))
    assert outcome(workers, pow, 2, 5) == 32  # it is warm
    workers.close()
    workers = Workers(WorkerLimits(count=1, deadline=2.0, memory=300, max_waiting=1))
    try:
        assert isinstance(outcome(workers, pow, 3, FOR_EVER), TookTooLongError)
        deadline = time.monotonic() + PATIENCE_S
        while outcome(workers, pow, 2, 5) != 32:  # a busy machine may need more than the 2 s to start one
            assert time.monotonic() < deadline
    finally:
        workers.close()


def test_a_worker_that_was_killed_while_it_waited_costs_no_question() -> None:
    """As by a kernel that is short of memory: it was not the question that is asked next."""
    others = active_children()
    workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1))
    try:
        for _ in range(3):
            assert outcome(workers, pow, 2, 5) == 32
            (process,) = set(active_children()) - set(others)
            process.kill()
            process.join(PATIENCE_S)
    finally:
        workers.close()


def test_a_worker_that_ends_before_it_is_ready_is_started_again_without_a_question() -> None:
    for _ in range(10):  # where this process is held up, the worker is ready before it is killed
        others = active_children()
        workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1))
        give_up = time.monotonic() + PATIENCE_S
        while not (begun := set(active_children()) - set(others)) and time.monotonic() < give_up:
            pass
        for process in begun:
            process.kill()
        if workers.ready == 0:
            break
        workers.close()
    try:
        assert workers.ready == 0
        while workers.ready == 0 and time.monotonic() < give_up:
            time.sleep(0.05)
        assert workers.ready == 1
        assert outcome(workers, pow, 2, 5) == 32
    finally:
        workers.close()


def test_what_starts_the_workers_is_replaced_if_it_hangs(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is stopped here, and then has to start a worker in the place of one that was killed."""
    monkeypatch.setattr("contact_dynamics.questions.workers._HUNG_AFTER_S", 1.0)
    others = active_children()
    workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1))
    try:
        assert outcome(workers, pow, 2, 5) == 32
        (process,) = set(active_children()) - set(others)
        starter = int(Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()[1])
        process.kill()
        process.join(PATIENCE_S)
        os.kill(starter, signal.SIGSTOP)
        deadline = time.monotonic() + PATIENCE_S
        while outcome(workers, pow, 2, 5) != 32:  # the question that waited for it has a fault
            assert time.monotonic() < deadline
    finally:
        workers.close()


def test_a_worker_for_whom_there_was_no_room_is_started_when_there_is() -> None:
    workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1))
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    try:
        assert outcome(workers, pow, 2, 5) == 32
        workers.limits = WorkerLimits(count=1, deadline=0.1, memory=300, max_waiting=1)
        lowest_free = os.dup(0)
        os.close(lowest_free)
        resource.setrlimit(resource.RLIMIT_NOFILE, (lowest_free, before[1]))
        assert isinstance(outcome(workers, pow, 3, FOR_EVER), TookTooLongError)
        assert isinstance(outcome(workers, pow, 2, 5), WorkerFault)
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
        workers.limits = WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1)
        assert outcome(workers, pow, 2, 5) == 32
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)
        workers.close()


def test_when_all_work_and_the_queue_is_full_a_question_is_refused_at_once() -> None:
    workers = Workers(WorkerLimits(count=1, deadline=PATIENCE_S, memory=300, max_waiting=1))
    workers.ask(pow, 3, FOR_EVER, lambda _: None)  # type: ignore[arg-type]
    workers.ask(pow, 3, FOR_EVER, lambda _: None)  # type: ignore[arg-type]
    with pytest.raises(BusyError, match="2 questions"):
        workers.ask(pow, 3, FOR_EVER, lambda _: None)  # type: ignore[arg-type]
    begun = time.monotonic()
    workers.close()
    assert time.monotonic() - begun < 100.0  # it takes milliseconds, and the powers would take years


def at_rest(stamp_ns: int) -> BodyState:
    return BodyState(p_WB_W=(0.0, 0.0, 1.0), q_WB=(0.0, 0.0, 0.0, 1.0), stamp_ns=stamp_ns)


def is_quick(question: Question[Answer], known: Context) -> bool:
    return service_of(question).is_answered_at_once(question, known)


def test_what_counts_as_quick() -> None:
    known = brick_world()
    falling = TumblingQuestion(body="brick", sampling=UntilContact())
    assert is_quick(falling, known)
    assert is_quick(TumblingQuestion(body="nobody"), known)  # it is refused at once
    spinning = BodyState(p_WB_W=(0.0, 0.0, 1.0), q_WB=(0.0, 0.0, 0.0, 1.0), w_WB_W=(1e9, 1e8, 1e8))
    assert not is_quick(TumblingQuestion(body="brick", state=spinning, sampling=UntilContact()), known)
    known = Context(world=known.world)
    fit = TumblingQuestion(body="brick", state=PublishedState(fit_window=1.0))
    assert is_quick(fit, known)  # it is refused at once, since no state was published
    for number in range(MAX_QUICK_FITTED + 1):
        assert is_quick(fit, known)
        known.states.add("brick", at_rest(stamp_ns=1_000_000 * number))
    assert not is_quick(fit, known)
    assert is_quick(TumblingQuestion(body="brick", state=PublishedState(fit_window=0.1)), known)
    assert not is_quick(TossQuestion(body="nobody"), known)  # no toss is
