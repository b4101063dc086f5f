# SPDX-License-Identifier: Apache-2.0
"""The times in the log of a server that is asked while states stream in, also in a simulation.

What counts is that a log can be replayed: the states with a `log_time` up to a request's are those that its
answer was made from.
"""

from __future__ import annotations

import random
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from contact_dynamics.recording import BagReader, LoggedMessage, ServiceCall, decode, service_calls
from contact_dynamics.recording.cdr import event_info
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from msg_adapters.stamps import stamp_ns_from_msg
from running_server import PATIENCE_S, ROOT, Client, environment, process

QUESTIONS = 60
LONG_EVERY = 12  # one question in so many has a long answer
BURST = 900  # questions at once, which leave 1800 events while the server is busy
FEW = 60  # in a simulation, whose log has another clock and the same queues
SIMULATED_NS = range(1_000_000_000_000, 2_000_000_000_000)
UNSCHEDULED_S = 0.2  # how long a busy machine may let the server wait between two of its lines


@dataclass(frozen=True, kw_only=True)
class Session:
    """A session that is over: its log and what the client knows."""

    simulated: bool
    burst: int  # questions at once
    messages: list[LoggedMessage]
    calls: list[ServiceCall]
    answers: list[Any]  # responses that the client got, in the order of asking; first those of the burst
    began_ns: int  # by the wall clock
    ended_ns: int

    def of(self, topic: str) -> list[LoggedMessage]:
        """The messages of a topic, as they were received."""
        found = [message for message in self.messages if message.topic == topic]
        return sorted(found, key=lambda message: message.log_time_ns)


@pytest.fixture(scope="module", params=["wall", "simulated"])
def session(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Session:
    kind: str = request.param
    directory = tmp_path_factory.mktemp(kind)
    arguments = ["--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args"]
    arguments += ["-p", f"log_directory:={directory}", "-p", "state_timeout:=100.0"]
    arguments += ["-p", f"use_sim_time:={str(kind == 'simulated').lower()}"]
    draw = random.Random(8)
    burst = FEW if kind == "simulated" else BURST
    answers: list[Any] = []
    began_ns = time.time_ns()
    with process("server", *arguments, ready="ready"):
        client = Client()
        stream = subprocess.Popen(
            [sys.executable, str(Path(__file__).with_name("state_stream.py")), kind], env=environment()
        )
        try:
            ready = PredictTumbling.Request(body_name="brick", times=[0.0])
            client.spin_until(lambda: client.ask(ready).status == 0)
            futures = [client.begin_to_ask(ready) for _ in range(burst)]
            client.spin_until(lambda: all(future.done() for future in futures))
            answers += [future.result() for future in futures]
            for number in range(QUESTIONS):
                time.sleep(draw.uniform(0.0, 0.01))
                times = np.linspace(0.0, 2.0, 20_000 if number % LONG_EVERY == 0 else 1).tolist()
                question = PredictTumbling.Request(body_name="brick", times=times)
                answers.append(client.ask(question))
            client.ask(PredictImpact.Request(body_name="nobody"))
        finally:
            stream.terminate()
            assert stream.wait(PATIENCE_S) == 0
            client.close()
    (folder,) = directory.iterdir()
    messages = list(BagReader(folder).messages())
    return Session(
        simulated=kind == "simulated",
        burst=burst,
        messages=messages,
        calls=list(service_calls(messages)),
        answers=answers,
        began_ns=began_ns,
        ended_ns=time.time_ns(),
    )


def test_every_call_is_logged_whole_also_those_of_a_burst(session: Session) -> None:
    assert all(call.request_event and call.response_event for call in session.calls)
    logged = [call for call in session.calls if call.service.endswith("predict_tumbling")]
    assert len(logged) > session.burst + QUESTIONS
    logged = logged[-len(session.answers) :]
    assert [str(call.response()) for call in logged] == [str(answer) for answer in session.answers]


def test_log_times_are_of_one_clock(session: Session) -> None:
    """Log times are the machine's; publish times are those of the node's clock, which stamps states too."""
    for message in session.messages:
        assert session.began_ns <= message.log_time_ns <= session.ended_ns
        if session.simulated:
            assert message.publish_time_ns in SIMULATED_NS or message.publish_time_ns == 0
        else:
            assert session.began_ns <= message.publish_time_ns <= session.ended_ns


def test_the_states_up_to_a_request_are_those_that_its_answer_is_from(session: Session) -> None:
    states = session.of("/brick/odometry")
    received = np.array([message.log_time_ns for message in states])
    newest = np.maximum.accumulate([message.publish_time_ns for message in states])
    answered = [call for call in session.calls if call.request_event and call.response().status == 0]
    assert len(answered) > session.burst + QUESTIONS
    for call in answered:
        assert call.request_event is not None
        seen = np.searchsorted(received, call.request_event.log_time_ns, side="right")
        assert seen > 0
        assert newest[seen - 1] == stamp_ns_from_msg(call.response().state.header.stamp)
    assert len({stamp_ns_from_msg(answer.state.header.stamp) for answer in session.answers}) > QUESTIONS // 2


def test_a_request_is_logged_before_its_answer_by_the_time_that_the_answer_took(session: Session) -> None:
    took: list[float] = []
    late: list[float] = []
    for call in session.calls:
        assert call.request_event is not None
        assert call.response_event is not None
        took.append(call.response().computation_time)
        between = 1e-9 * (call.response_event.log_time_ns - call.request_event.log_time_ns)
        late.append(between - took[-1])
    assert max(took) > 0.005
    assert min(late) >= -1e-6
    assert np.median(late) < 1e-3
    # Where the whole machine stands still it may do so between the two lines, once or twice.
    assert sorted(late)[-3] < UNSCHEDULED_S


def test_a_simulations_clock_is_logged_and_says_what_time_a_request_came_at(session: Session) -> None:
    ticks = session.of("/clock")
    assert bool(ticks) == session.simulated
    if not session.simulated:
        return
    assert {message.type_name for message in ticks} == {"rosgraph_msgs/msg/Clock"}
    stamps = [stamp_ns_from_msg(decode(message).clock) for message in ticks]
    assert [message.publish_time_ns for message in ticks] == stamps
    for call in session.calls:
        assert call.request_event is not None
        assert event_info(call.request_event.data).stamp_ns in {0, *stamps}  # 0 before the first tick
