# SPDX-License-Identifier: Apache-2.0
"""With `log_before_answer`, what a client has been told is in the log, however soon the server dies then."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.situations import Situation
from contact_dynamics.recording import BagReader, service_calls
from contact_dynamics.recording.cdr import EventType, event_info
from contact_dynamics.recording.limits import UNLIMITED
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from nodes.monitor import hang
from running_server import PATIENCE_S, ROOT, SERVICES, Client, process

TUMBLING = SERVICES[PredictTumbling]


def arguments(directory: Path) -> list[str]:
    file = str(ROOT / "config" / "server.yaml")
    given = ["--params-file", file, "--ros-args", "-p", f"log_directory:={directory}"]
    return [*given, "-p", "log_before_answer:=true"]


def flight(number: int) -> Any:
    """A question whose answer is told from the others' by its times."""
    request = PredictTumbling.Request(state_source=PredictTumbling.Request.STATE_EXPLICIT, body_name="brick")
    request.state.pose.position.z = 1.0
    request.state.pose.orientation.w = 1.0
    request.times = [0.1 * number]
    return request


def hard() -> Any:
    """A question that a worker answers."""
    request = PredictContactMode.Request(
        state_source=PredictContactMode.Request.STATE_EXPLICIT, body_name="brick", include_margins=True
    )
    request.state.pose.position.z = 0.025
    request.state.pose.orientation.w = 1.0
    return request


def last_answer(directory: Path) -> str:
    (folder,) = directory.iterdir()
    with pytest.warns(match="its writer was killed"):
        calls = list(service_calls(BagReader(folder).messages()))
    return str(calls[-1].response())


def test_an_answer_that_has_arrived_survives_a_kill(tmp_path: Path) -> None:
    with process("server", *arguments(tmp_path), ready="ready") as server:
        client = Client()
        client.ask(flight(1))
        answer = client.ask(flight(3))
        server.kill()
        server.wait(PATIENCE_S)
        client.close()
    assert answer.status == 0
    assert last_answer(tmp_path) == str(answer)


def test_each_answer_is_logged_once_and_as_its_event_is_and_a_workers_survives_a_kill(tmp_path: Path) -> None:
    """The log has what a subscriber to the events gets. Only the stamp is a moment earlier."""
    heard: list[bytes] = []
    with process("server", *arguments(tmp_path), "-p", "workers:=1", ready="ready") as server:
        client = Client()
        client.node.create_subscription(
            PredictTumbling.Event, f"{TUMBLING}/_service_event", heard.append, QoSProfile(depth=100), raw=True
        )
        client.wait_until_found()
        answers = [client.ask(flight(number)) for number in range(20)]
        refused = client.ask(PredictImpact.Request(body_name="nobody"))
        client.spin_until(lambda: len(heard) == 2 * len(answers))
        last = client.ask(hard())
        server.kill()
        server.wait(PATIENCE_S)
        client.close()
    assert last.status == 0
    assert last_answer(tmp_path) == str(last)
    (folder,) = tmp_path.iterdir()
    with pytest.warns(match="its writer was killed"):
        messages = list(BagReader(folder).messages())
    events = [message for message in messages if message.topic.startswith(TUMBLING)]
    assert len(events) == 2 * len(answers)
    logged, sent = (
        [data for data in each if is_response(data)] for each in ([m.data for m in events], heard)
    )
    assert [str(deserialize_message(data, PredictTumbling.Event).response[0]) for data in logged] == [
        str(answer) for answer in answers
    ]
    for one, other in zip(logged, sent, strict=True):
        # DDS fills the last four bytes. It leaves what was in memory in the gaps, so whole bytes can differ.
        assert len(one) <= len(other) < len(one) + 4
        assert 0 <= event_info(other).stamp_ns - event_info(one).stamp_ns < PATIENCE_S * 1e9
        assert text_without_stamp(one) == text_without_stamp(other)
    assert str(list(service_calls(messages))[-2].response()) == str(refused)
    assert verify_log(folder).others == []


def test_a_disk_that_hangs_is_told_of_and_not_waited_for_again(tmp_path: Path) -> None:
    told: list[str] = []
    log = Log(str(tmp_path), run={}, limits=UNLIMITED, on_problem=told.append, on_notice=pytest.fail)
    log.add_topic("/pose", "geometry_msgs/msg/Pose", QoSProfile(depth=1))
    log.start()
    log.settle()
    assert told == []
    fail = hang(log)  # the disk, which now blocks each write
    waited = []
    for _ in range(5):
        log.record("/pose", bytes([0, 1, 0, 0]) + bytes(56))
        begun = time.monotonic()
        log.settle()
        waited.append(time.monotonic() - begun)
    assert waited[0] >= 1.0
    assert min(waited[1:]) < 0.1  # the least of four, because a busy machine may let any of them wait
    assert told == ["the disk took longer than 1 s: for 10 s, responses are sent before they are on it"]
    assert log.present() == [Situation.LOG_NOT_AWAITED.present()]
    fail()
    log.close()


def is_response(data: bytes) -> bool:
    return event_info(data).event_type is EventType.RESPONSE_SENT


def text_without_stamp(data: bytes) -> str:
    event = deserialize_message(data, PredictTumbling.Event)
    event.info.stamp = Time()
    return str(event)
