# SPDX-License-Identifier: Apache-2.0
"""Parameters that change while the server serves: checked as a whole, taken at once, and logged."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest
import yaml
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter

from contact_dynamics.recording import BagReader
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from message_words import says
from running_server import PATIENCE_S, ROOT, SERVICES, Client, environment, process

NODE = "/contact_dynamics"
FILE = ROOT / "config" / "server.yaml"
UP = Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE
DOWN = Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP


class Configured(NamedTuple):
    """A client of a running server, and the folder that its log is in."""

    client: Client
    folder: Path

    def call(self, service: Any, name: str, request: Any) -> Any:
        """Call a service of the node that is not one of ours."""
        caller = self.client.node.create_client(service, f"{NODE}/{name}")
        assert caller.wait_for_service(PATIENCE_S)
        future = caller.call_async(request)
        self.client.spin_until(future.done)
        self.client.node.destroy_client(caller)
        return future.result()

    def move(self, *transitions: int) -> None:
        """Make transitions of the life cycle."""
        for each in transitions:
            request = ChangeState.Request(transition=Transition(id=each))
            assert self.call(ChangeState, "change_state", request).success

    def set(self, **values: Any) -> str:
        """Set parameters at once, with "__" for a point; return why they are refused, or nothing."""
        parameters = [
            Parameter(name.replace("__", "."), value=value).to_parameter_msg()
            for name, value in values.items()
        ]
        request = SetParametersAtomically.Request(parameters=parameters)
        result = self.call(SetParametersAtomically, "set_parameters_atomically", request).result
        assert result.successful == (not result.reason)
        return str(result.reason)

    def names(self) -> set[str]:
        """The names of all parameters."""
        return set(self.call(ListParameters, "list_parameters", ListParameters.Request()).result.names)

    def double(self, name: str) -> float:
        """The value of a parameter."""
        (value,) = self.call(GetParameters, "get_parameters", GetParameters.Request(names=[name])).values
        return float(value.double_value)


@pytest.fixture(scope="module")
def client() -> Iterator[Client]:
    arguments = ["--params-file", str(FILE), "--ros-args", "-p", "autostart:=false"]
    with process("server", *arguments, ready="autostart is false"):
        client = Client(wait=False)
        try:
            yield client
        finally:
            client.close()


@pytest.fixture
def configured(client: Client, tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Configured]:
    """The server as its file says, with a log of its own for each test."""
    configured = Configured(client, tmp_path)
    (settings,) = yaml.safe_load(FILE.read_text(encoding="utf-8")).values()
    values = settings["ros__parameters"] | {
        "state_timeout": 1000.0,
        "log_directory": str(tmp_path),
        "workers": 0,
    }
    values |= getattr(request, "param", {})
    assert configured.set(**{name.replace(".", "__"): value for name, value in values.items()}) == ""
    client.spin_until(lambda: client.ready() == 0)  # those of the test before are gone
    configured.move(*UP)
    client.spin_until(lambda: client.ready() == len(SERVICES))
    client.wait_until_found()
    yield configured
    if configured.call(GetState, "get_state", GetState.Request()).current_state.label == "active":
        configured.move(*DOWN)


def slide() -> PredictImpact.Request:
    """A question about a brick that strikes the floor while it slides."""
    request = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 0.5
    request.state.linear_velocity.x = 3.0
    request.state.angular_velocity.y = 2.0
    return request


def test_a_changed_friction_counts_from_the_next_answer_on_and_replay_reproduces_both(
    configured: Configured,
) -> None:
    before = configured.client.ask(slide())
    assert configured.set(surface__floor__friction=0.05) == ""
    after = configured.client.ask(slide())
    assert before.status == after.status == 0
    assert before.contacts.frictions[0] == 0.3
    assert after.contacts.frictions[0] == 0.05
    assert after.impact.state_after.linear_velocity.x > before.impact.state_after.linear_velocity.x
    assert configured.double("surface.floor.friction") == 0.05
    assert_reproduced(configured, questions=2)


def test_a_configuration_is_checked_as_a_whole_and_refused_as_a_whole(configured: Configured) -> None:
    refused = configured.set(surface__floor__friction=0.1, surface__floor__restitution=1.5)
    assert refused == "surface.floor.restitution must be in [0, 1], got 1.5"
    assert configured.double("surface.floor.friction") == 0.3
    assert configured.set(body__brick__inertia=[1.0, 0.1, 0.1, 0.0, 0.0, 0.0]).startswith(
        "body.brick.inertia"
    )
    assert "the nearest is surface.floor.friction" in configured.set(surface__floor__fricton=0.1)
    assert "must be in [0, 10000]" in configured.set(horizon=-1.0)
    refused = configured.set(bodies=["brick", "cup"])
    assert refused == "body.cup.mass is required (Mass, kg.)"
    refused = configured.set(body__brick__odometry_topic="/other", log=False)
    assert says(
        refused, "log, the topics of body.brick must be ..., got a change while the node is configured"
    )
    assert configured.client.ask(slide()).contacts.frictions[0] == 0.3
    assert_reproduced(configured, questions=1)


def test_bodies_and_surfaces_come_and_go(configured: Configured) -> None:
    names = configured.names()
    question = PredictImpact.Request(body_name="cup", state_source=PredictImpact.Request.STATE_EXPLICIT)
    question.state.pose.position.z = 1.0
    assert configured.client.ask(question).status == PredictImpact.Response.UNKNOWN_BODY
    cup = {"mass": 0.2, "inertia": [0.0], "sphere": [0.05]}
    table = {"point": [0.0, 0.0, 0.5], "friction": 0.2, "restitution": 0.9}
    added = {f"body__cup__{name}": value for name, value in cup.items()}
    added |= {f"surface__table__{name}": value for name, value in table.items()}
    assert configured.set(bodies=["brick", "cup"], surfaces=["floor", "table"], **added) == ""
    assert configured.names() > names
    answer = configured.client.ask(question)
    assert answer.contacts.surface_names == ["table"]
    assert configured.set(bodies=["brick"], surfaces=["floor"]) == ""
    assert configured.names() == names
    assert configured.client.ask(question).status == PredictImpact.Response.UNKNOWN_BODY
    assert_reproduced(configured, questions=3)


def test_states_are_read_with_the_centre_of_mass_of_their_time(configured: Configured) -> None:
    stream = subprocess.Popen(
        [sys.executable, str(ROOT / "test" / "nodes" / "state_stream.py"), "wall"],
        env={**environment(), "PYTHONPATH": str(ROOT)},
    )
    question = PredictTumbling.Request(body_name="brick", times=[0.1])
    try:
        configured.client.spin_until(lambda: configured.client.ask(question).status == 0)
        for offset in (0.01, 0.02, 0.03):
            assert configured.set(body__brick__center_of_mass=[0.0, offset, 0.0]) == ""
            configured.client.spin_until(lambda: configured.client.ask(question).status == 0)
            answer = configured.client.ask(question)
            # The brick turns about x at 3 rad/s, and its frame's origin stands still.
            assert answer.state.linear_velocity.z == pytest.approx(3.0 * offset, abs=1e-12)
            assert configured.set(state_timeout=10.0 + offset, gravity=[0.0, 0.0, -offset]) == ""
    finally:
        stream.terminate()
        stream.wait(PATIENCE_S)
    assert_reproduced(configured, questions=8)


def test_fewer_states_are_kept_from_now_on(configured: Configured) -> None:
    client = configured.client
    states = client.publisher(Odometry, "/brick/odometry")
    first = client.node.get_clock().now().to_msg()
    question = PredictTumbling.Request(body_name="brick", times=[0.0], stamp=first)
    question.state_source = question.STATE_AT_STAMP

    def publish() -> None:
        msg = Odometry(child_frame_id="brick")
        msg.header.frame_id, msg.header.stamp = "world", client.node.get_clock().now().to_msg()
        states.publish(msg)

    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id, msg.header.stamp = "world", first
    states.publish(msg)
    client.spin_until(lambda: client.ask(question).status == 0)
    assert configured.set(max_states=3, warn_every=0.0, silent_after=0.5, client_gone_for=0.0) == ""
    for _ in range(3):
        publish()
    client.spin_until(lambda: client.ask(question).status == PredictTumbling.Response.NO_STATE)
    assert says(configured.set(max_states=0), "max_states must be ..., got 0")
    assert_reproduced(configured, questions=2)


def test_what_stays_can_change_while_the_server_is_not_configured(configured: Configured) -> None:
    configured.move(*DOWN)
    assert configured.set(body__brick__odometry_topic="/other", surface__floor__friction=0.7) == ""
    configured.move(*UP)
    node = configured.client.node
    configured.client.spin_until(lambda: node.count_subscribers("/other") == 1)
    configured.client.spin_until(lambda: configured.client.ready() == len(SERVICES))
    assert configured.client.ask(slide()).contacts.frictions[0] == 0.7


def test_ros_own_way_to_set_one_parameter_works(configured: Configured) -> None:
    parameters = [
        Parameter("surface.floor.restitution", value=0.9).to_parameter_msg(),
        Parameter("surface.floor.friction", value=-0.9).to_parameter_msg(),
    ]
    request = SetParameters.Request(parameters=parameters)
    taken, refused = configured.call(SetParameters, "set_parameters", request).results
    assert taken.successful
    assert not refused.successful
    assert refused.reason == "surface.floor.friction must be >= 0, got -0.9"


@pytest.mark.parametrize("configured", [{"log_file_duration": 1.0}], indirect=True)
def test_each_file_of_a_log_says_how_its_part_is_configured(configured: Configured) -> None:
    client = configured.client
    client.ask(slide())
    assert configured.set(surface__floor__friction=0.1) == ""
    folder = next(configured.folder.iterdir())
    client.spin_until(lambda: client.ask(slide()) and len(list(folder.glob("*.mcap"))) > 1)
    client.ask(slide())
    assert_reproduced(configured, questions=3)
    files = sorted(folder.glob("*.mcap"))
    for path, friction in zip((files[0], files[-1]), (0.3, 0.1), strict=True):
        assert f'"surface.floor.friction": {friction}' in BagReader(path).run()["parameters"]
    tallies = verify_log(files[-1]).services.values()
    assert sum(tally.equal for tally in tallies) == sum(tally.questions for tally in tallies) > 0


def assert_reproduced(configured: Configured, *, questions: int) -> None:
    """End the server's log, and ask all of it again."""
    configured.move(*DOWN)
    found = verify_log(next(configured.folder.iterdir()))
    assert found.others == []
    assert sum(tally.equal for tally in found.services.values()) >= questions
