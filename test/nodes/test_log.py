# SPDX-License-Identifier: Apache-2.0
"""The log of a real server beside what its client sent and received, read back by three readers.

The session ends in the least convenient way: the server is told to stop, twice, right behind a burst of
states.
"""

from __future__ import annotations

import dataclasses
import json
import platform
import random
import re
import signal
import subprocess
import sys
from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from rosbags.highlevel import AnyReader

from contact_dynamics.recording import BagReader, decode, service_calls
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.msg import BodyState, BodyStates
from contact_dynamics_interfaces.srv import (
    PredictBodiesContactMode,
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from msg_adapters.stamps import stamp_ns_from_msg
from running_server import PATIENCE_S, PATIENT, ROOT, SERVICES, Client, process

STATES_TOPIC = "/brick/odometry"
EVENTS = {f"{name}/_service_event": service for service, name in SERVICES.items()}
ROUNDS = 12
STATES_A_ROUND = 20
BURST = 200
STATES = ROUNDS * STATES_A_ROUND + BURST
REQUEST_RECEIVED, RESPONSE_SENT = 1, 2


@dataclass(frozen=True, kw_only=True)
class Session:
    """What the client knows of a session that is over."""

    folder: Path  # of the log
    path: Path  # of its file
    states: list[Odometry]  # in the order of publishing
    asked: dict[str, list[tuple[Any, Any]]]  # event topic: requests and responses, in the order of asking
    goodbye: str  # what the server printed at the end
    exit_code: int
    began_ns: int
    ended_ns: int

    @property
    def counts(self) -> dict[str, int]:
        """How many messages each topic must have."""
        return {
            STATES_TOPIC: len(self.states),
            **{topic: 2 * len(calls) for topic, calls in self.asked.items()},
        }


def state(client: Client, draw: random.Random) -> Odometry:
    """A state a metre above the floor, with numbers of its own in every field."""
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id = "world"
    msg.header.stamp = client.node.get_clock().now().to_msg()
    msg.pose.pose.position.x = draw.uniform(-1.0, 1.0)
    msg.pose.pose.position.z = draw.uniform(0.9, 1.1)
    half = draw.uniform(-0.1, 0.1)
    msg.pose.pose.orientation.z, msg.pose.pose.orientation.w = float(np.sin(half)), float(np.cos(half))
    msg.pose.covariance = [draw.random() for _ in range(36)]
    msg.twist.twist.linear.y = draw.uniform(-1.0, 1.0)
    msg.twist.twist.angular.x = draw.uniform(-9.0, 9.0)
    msg.twist.covariance = [draw.random() for _ in range(36)]
    return msg


def questions(number: int) -> list[Any]:
    """A good and a bad request to each service."""
    tumbling = PredictTumbling.Request(body_name="brick", sampling=PredictTumbling.Request.UNTIL_CONTACT)
    tumbling.rate = 100.0 * (number + 1)
    mode = PredictContactMode.Request(
        state_source=PredictContactMode.Request.STATE_EXPLICIT, body_name="brick"
    )
    mode.state.pose.position.z = 0.025  # flat on the floor
    mode.applied_wrench.force.x = 0.1 * number
    falling = BodyStates(
        positions=[0.0, 0.0, 1.0],
        orientations=[0.0, 0.0, 0.0, 1.0],
        linear_velocities=[0.1 * number, 0.0, -1.0],
        angular_velocities=[0.0, 3.0, 0.0],
    )
    strikes = PredictImpactBatch.Request(body_name="brick", states=falling, restitutions=[0.5])
    strikes.contact_positions, strikes.contact_normals, strikes.frictions = (
        [0.1, 0.0, 1.0],
        [0.0, 0.0, 1.0],
        [0.3],
    )
    modes = PredictContactModeBatch.Request(state_source=mode.STATE_EXPLICIT, body_name="brick")
    modes.state, modes.forces = mode.state, [0.1 * number, 0.0, 0.0, 0.0, 0.0, 9.0]
    toss = PredictToss.Request(body_name="brick", max_alternatives=0, samples=5, seed=number)
    toss.state_source, toss.state.pose.position.z = toss.STATE_EXPLICIT, 0.2
    held = PredictBodiesContactMode.Request(states=[BodyState(body_name="brick")], velocity_tolerance=100.0)
    held.contacts.positions, held.contacts.normals = [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]
    held.contacts.frictions, held.contact_bodies, held.other_bodies = [0.1 * number], [0], [-1]
    return [
        modes,
        tumbling,
        PredictImpact.Request(body_name="brick"),
        mode,
        strikes,
        PredictTumblingBatch.Request(body_name="brick", states=falling, times=[0.25]),
        PredictTumbling.Request(body_name=f"cat {number}"),
        PredictImpact.Request(body_name="brick", horizon=float("nan")),
        PredictContactMode.Request(body_name="brick"),  # in the air: no contact
        PredictImpactBatch.Request(body_name="brick", states=falling),  # no contact is given
        PredictTumblingBatch.Request(body_name="brick", states=falling, times=[float("inf")]),
        PredictContactModeBatch.Request(body_name="brick"),  # in the air
        toss,
        PredictToss.Request(body_name="brick", rate=0.0),
        held,
        PredictBodiesContactMode.Request(states=held.states),  # no contact is given
    ]


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Session:
    directory = tmp_path_factory.mktemp("log")
    draw = random.Random(27)
    states: list[Odometry] = []
    asked: dict[str, list[tuple[Any, Any]]] = {topic: [] for topic in EVENTS}
    file = str(ROOT / "config" / "server.yaml")
    arguments = ["--params-file", file, "--ros-args", "-p", f"log_directory:={directory}"]
    arguments += ["-p", PATIENT, "-p", "workers:=2"]
    with process("server", *arguments, ready="ready") as server:
        client = Client()
        publisher = client.publisher(Odometry, STATES_TOPIC)

        def publish(count: int) -> None:
            for _ in range(count):
                states.append(state(client, draw))
                publisher.publish(states[-1])

        began_ns = client.node.get_clock().now().nanoseconds
        for number in range(ROUNDS):
            publish(STATES_A_ROUND)
            for request in questions(number):
                topic = next(
                    topic for topic, service in EVENTS.items() if isinstance(request, service.Request)
                )
                asked[topic].append((request, client.ask(request)))
        publish(BURST)
        assert publisher.wait_for_all_acked(Duration(seconds=PATIENCE_S))
        server.send_signal(signal.SIGINT)
        server.send_signal(signal.SIGTERM)
        assert server.stdout is not None
        goodbye, exit_code = server.stdout.read(), server.wait(PATIENCE_S)
        ended_ns = client.node.get_clock().now().nanoseconds
        client.close()
    (folder,) = directory.iterdir()
    return Session(
        folder=folder,
        path=folder / f"{folder.name}_0.mcap",
        states=states,
        asked=asked,
        goodbye=goodbye,
        exit_code=exit_code,
        began_ns=began_ns,
        ended_ns=ended_ns,
    )


def plain(value: Any) -> Any:
    """A message of rclpy, rosbags or mcap_ros2 as dicts and lists of Python's own numbers."""
    names: list[str] = []
    if hasattr(value, "get_fields_and_field_types"):
        names = list(value.get_fields_and_field_types())
    elif dataclasses.is_dataclass(value):
        # rosbags makes fields of constants too, whose names begin with a capital, and has one of its own
        names = [field.name for field in dataclasses.fields(value) if field.name[0].islower()]
    elif hasattr(value, "__slots__"):
        names = list(value.__slots__)
    if names:
        return {name: plain(getattr(value, name)) for name in names}
    if isinstance(value, (str, int, float)):
        return value
    if isinstance(value, np.generic):
        return value.item()
    return [plain(item) for item in value]


def text(message: Any) -> str:
    """A message as text that is the same for equal messages, NaN being equal to itself."""
    return json.dumps(plain(message), sort_keys=True)


def stamps_ns(session: Session) -> list[int]:
    """The stamps of the states that were sent."""
    return [stamp_ns_from_msg(state.header.stamp) for state in session.states]


def test_the_server_ends_well_and_says_where_its_log_is(session: Session) -> None:
    assert session.exit_code == 0
    total = sum(session.counts.values())
    assert f"log: {session.path} ({total} messages)" in session.goodbye
    assert "Traceback" not in session.goodbye


def test_good_and_bad_questions_were_asked(session: Session) -> None:
    """Else the tests below would compare nothing."""
    for calls in session.asked.values():
        statuses = Counter(response.status for _, response in calls)
        assert statuses[0] == ROUNDS
        assert sum(statuses.values()) == 2 * ROUNDS
    assert len(session.states) == STATES


def test_rosbags_reads_what_was_sent_and_received(session: Session) -> None:
    states: list[str] = []
    requests: dict[str, list[str]] = {topic: [] for topic in EVENTS}
    responses: dict[str, list[str]] = {topic: [] for topic in EVENTS}
    with AnyReader([session.folder]) as reader:
        assert reader.message_count == sum(session.counts.values())
        for connection, log_time_ns, data in reader.messages():
            assert session.began_ns <= log_time_ns <= session.ended_ns
            # rosbags files an event type under a name of its own
            message: Any = reader.deserialize(data, connection.msgtype.replace("/srv/", "/srv/msg/"))
            if connection.topic == STATES_TOPIC:
                states.append(text(message))
            elif message.info.event_type == REQUEST_RECEIVED:
                requests[connection.topic].extend(map(text, message.request))
            elif message.info.event_type == RESPONSE_SENT:
                responses[connection.topic].extend(map(text, message.response))
    assert states == [text(state) for state in session.states]
    for topic, calls in session.asked.items():
        assert requests[topic] == [text(request) for request, _ in calls]
        assert responses[topic] == [text(response) for _, response in calls]


def test_mcap_finds_all_by_its_index(session: Session) -> None:
    with session.path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
        assert summary is not None
        channels = summary.channels.values()
        types = {each.topic: summary.schemas[each.schema_id].name for each in channels}
        assert types[STATES_TOPIC] == "nav_msgs/msg/Odometry"
        assert all(channel.metadata["topic_type_hash"].startswith("RIHS01_") for channel in channels)
        assert Counter(channel.topic for _, channel, _ in reader.iter_messages()) == session.counts
    with AnyReader([session.path]) as rosbags:  # one file of the folder
        assert rosbags.message_count == sum(session.counts.values())


def test_mcap_ros2_reads_the_states_that_were_sent(session: Session) -> None:
    with session.path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        messages = list(reader.iter_decoded_messages(topics=[STATES_TOPIC]))
    assert [text(message.decoded_message) for message in messages] == [
        text(state) for state in session.states
    ]
    assert [message.message.publish_time for message in messages] == stamps_ns(session)


def test_our_reader_finds_each_call_with_its_request_and_response(session: Session) -> None:
    reader = BagReader(session.folder)
    calls = list(service_calls(reader.messages()))
    assert reader.damage is None
    for topic, pairs in session.asked.items():
        found = [call for call in calls if call.service == topic.removesuffix("/_service_event")]
        assert [text(call.request()) for call in found] == [text(request) for request, _ in pairs]
        assert [text(call.response()) for call in found] == [text(response) for _, response in pairs]
        assert [call.sequence_number for call in found] == list(range(1, len(pairs) + 1))
        assert len({call.client_gid for call in found}) == 1
    states = list(reader.messages({STATES_TOPIC}))
    assert [text(decode(message)) for message in states] == [text(state) for state in session.states]
    assert [message.publish_time_ns for message in states] == stamps_ns(session)


def test_the_run_record_has_every_parameter(session: Session) -> None:
    run = BagReader(session.folder).run()
    (node,) = yaml.safe_load((ROOT / "config" / "server.yaml").read_text(encoding="utf-8")).values()
    configured = {**node["ros__parameters"], "log_directory": str(session.folder.parent)}
    configured["answer_deadline"] = PATIENCE_S  # as all servers of tests have it
    configured["state_timeout"] = float(PATIENT.rpartition("=")[2])
    parameters = json.loads(run["parameters"])
    assert {name: parameters.get(name) for name in configured} == configured
    assert json.loads(run["state_topics"]) == {"body.brick.odometry_topic": STATES_TOPIC}
    assert run["version"]
    versions = {"python": platform.python_version(), "numpy": np.__version__, "scipy": scipy.__version__}
    assert {name: run[name] for name in versions} == versions


def test_asked_again_every_answer_is_equal_to_the_bit(session: Session) -> None:
    found = verify_log(session.folder)
    assert found.others == []
    assert [tally.equal for tally in found.services.values()] == [
        len(calls) for calls in session.asked.values()
    ]


def test_rerun_finds_nothing_to_complain_of(session: Session) -> None:
    rerun = Path(sys.executable).with_name("rerun")
    done = subprocess.run(
        [str(rerun), "mcap", "check", "--full", str(session.path)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    lines = [
        line for line in done.stdout.splitlines() if any(f" {topic} " in line for topic in session.counts)
    ]
    assert [line.split()[0] for line in lines] == ["ok"] * len(session.counts), done.stdout


def test_rerun_draws_nothing_of_a_log_by_itself(session: Session, tmp_path: Path) -> None:
    """As `docs/log.md` says, the values are there, but nothing that its 3D view would show."""
    rerun, converted = Path(sys.executable).with_name("rerun"), tmp_path / "log.rrd"
    subprocess.run([str(rerun), "mcap", "convert", str(session.path), "-o", str(converted)], check=True)
    printed = subprocess.run(
        [str(rerun), "rrd", "print", "-v", str(converted)], capture_output=True, text=True, check=True
    ).stdout
    assert "nav_msgs.msg.Odometry:message" in printed
    drawn = "Transform3D|Transform|Points3D|Boxes3D|Mesh3D|Asset3D|Arrows3D|LineStrips3D"
    assert re.findall(rf"\b(?:{drawn}):", printed) == []
    assert "listed over time, not drawn" in (ROOT / "docs" / "log.md").read_text(encoding="utf-8")
