# SPDX-License-Identifier: Apache-2.0
"""The server as a managed node, whose parameters may change while it serves.

A lifecycle manager brings it up and down over its services. Parameters are checked as a whole, taken at once,
and logged.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from builtin_interfaces.msg import Time
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter as ParameterMsg
from rcl_interfaces.msg import ParameterValue
from rcl_interfaces.srv import GetParameters, ListParameters, SetParameters, SetParametersAtomically
from rclpy.parameter import Parameter
from rosgraph_msgs.msg import Clock

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.recording import BagReader
from contact_dynamics.recording.limits import UNLIMITED
from contact_dynamics.replay.verify import verify_log
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from message_words import says
from nodes.monitor import hard
from running_server import PATIENCE_S, ROOT, SERVICES, Client, environment, process, wait_for

NODE = "/contact_dynamics"
FILE = ROOT / "config" / "server.yaml"
UP = Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE
DOWN = Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP


class Managed:
    """A client of a server that moves it between its states, and the folder that its log is in."""

    def __init__(self, client: Client, folder: Path) -> None:
        self.client = client
        self.folder = folder
        self._callers: dict[str, Any] = {}

    def call(self, service: Any, name: str, request: Any) -> Any:
        """Call a service of the node that is not one of ours."""
        if name not in self._callers:
            self._callers[name] = self.client.node.create_client(service, f"{NODE}/{name}")
            assert self._callers[name].wait_for_service(PATIENCE_S)
            self.client.wait_until_found()
        future = self._callers[name].call_async(request)
        self.client.spin_until(future.done)
        return future.result()

    def change(self, transition: int) -> bool:
        """Ask for a transition; return whether it was made."""
        request = ChangeState.Request(transition=Transition(id=transition))
        return bool(self.call(ChangeState, "change_state", request).success)

    def move(self, *transitions: int) -> None:
        """Make transitions."""
        for each in transitions:
            assert self.change(each)

    def state(self) -> int:
        return int(self.call(GetState, "get_state", GetState.Request()).current_state.id)

    def wait_until_ready(self) -> None:
        self.client.spin_until(lambda: self.client.ready() == len(SERVICES))
        self.client.wait_until_found()

    def forget(self) -> None:
        for each in self._callers.values():
            self.client.node.destroy_client(each)

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
def managed(client: Client, tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Managed]:
    """The server, not configured yet, as its file says, with a log of its own for each test."""
    managed = Managed(client, tmp_path)
    (settings,) = yaml.safe_load(FILE.read_text(encoding="utf-8")).values()
    values = settings["ros__parameters"] | {
        "state_timeout": 1000.0,
        "log_directory": str(tmp_path),
        "workers": 0,
    }
    values |= getattr(request, "param", {})
    assert managed.set(**{name.replace(".", "__"): value for name, value in values.items()}) == ""
    client.spin_until(lambda: client.ready() == 0)  # those of the test before are gone
    yield managed
    if managed.state() == State.PRIMARY_STATE_ACTIVE:
        managed.move(*DOWN)
    managed.forget()


@pytest.fixture
def configured(managed: Managed) -> Managed:
    """The server, configured and active."""
    managed.move(*UP)
    managed.wait_until_ready()
    return managed


def slide() -> PredictImpact.Request:
    """A question about a brick that strikes the floor while it slides."""
    request = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    request.state.pose.position.z = 0.5
    request.state.linear_velocity.x = 3.0
    request.state.angular_velocity.y = 2.0
    return request


def test_a_changed_friction_counts_from_the_next_answer_on_and_replay_reproduces_both(
    configured: Managed,
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


def test_a_configuration_is_checked_as_a_whole_and_refused_as_a_whole(configured: Managed) -> None:
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


def test_bodies_and_surfaces_come_and_go(configured: Managed) -> None:
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


def test_states_are_read_with_the_centre_of_mass_of_their_time(configured: Managed) -> None:
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


def test_fewer_states_are_kept_from_now_on(configured: Managed) -> None:
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


def test_what_stays_can_change_while_the_server_is_not_configured(configured: Managed) -> None:
    configured.move(*DOWN)
    assert configured.set(body__brick__odometry_topic="/other", surface__floor__friction=0.7) == ""
    configured.move(*UP)
    node = configured.client.node
    configured.client.spin_until(lambda: node.count_subscribers("/other") == 1)
    configured.client.spin_until(lambda: configured.client.ready() == len(SERVICES))
    assert configured.client.ask(slide()).contacts.frictions[0] == 0.7


def test_ros_own_way_to_set_one_parameter_works(configured: Managed) -> None:
    parameters = [
        Parameter("surface.floor.restitution", value=0.9).to_parameter_msg(),
        Parameter("surface.floor.friction", value=-0.9).to_parameter_msg(),
    ]
    request = SetParameters.Request(parameters=parameters)
    taken, refused = configured.call(SetParameters, "set_parameters", request).results
    assert taken.successful
    assert not refused.successful
    assert refused.reason == "surface.floor.friction must be >= 0, got -0.9"


@pytest.mark.parametrize("managed", [{"log_file_duration": 1.0}], indirect=True)
def test_each_file_of_a_log_says_how_its_part_is_configured(configured: Managed) -> None:
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


def assert_reproduced(configured: Managed, *, questions: int) -> None:
    """End the server's log, and ask all of it again."""
    configured.move(*DOWN)
    found = verify_log(next(configured.folder.iterdir()))
    assert found.others == []
    assert sum(tally.equal for tally in found.services.values()) >= questions


def test_a_manager_brings_the_server_up_and_down_and_up_again(managed: Managed) -> None:
    question = PredictTumbling.Request(body_name="brick", times=[0.0])
    assert managed.state() == State.PRIMARY_STATE_UNCONFIGURED
    assert managed.client.ready() == 0
    for run in (1, 2):
        assert managed.change(Transition.TRANSITION_CONFIGURE)
        assert len(list(managed.folder.iterdir())) == run
        managed.client.spin_until(lambda: managed.client.ready() == len(SERVICES))
        states = managed.client.publisher(Odometry, "/brick/odometry")
        msg = Odometry(child_frame_id="brick")
        msg.header.frame_id, msg.header.stamp = "world", managed.client.node.get_clock().now().to_msg()
        states.publish(msg)
        refused = managed.client.ask(question)
        assert refused.status == refused.BUSY
        assert "not active" in refused.message
        assert managed.change(Transition.TRANSITION_ACTIVATE)
        managed.client.spin_until(lambda: managed.client.ask(question).status == 0)  # the state came before
        assert managed.state() == State.PRIMARY_STATE_ACTIVE
        assert managed.change(Transition.TRANSITION_DEACTIVATE)
        assert managed.client.ask(question).status == refused.BUSY
        assert managed.change(Transition.TRANSITION_CLEANUP)
        assert managed.state() == State.PRIMARY_STATE_UNCONFIGURED
        managed.client.node.destroy_publisher(states)
        managed.client.spin_until(lambda: managed.client.ready() == 0)
    readers = [BagReader(folder) for folder in managed.folder.iterdir()]
    assert all(any(message.topic == "/brick/odometry" for message in log.messages()) for log in readers)
    assert all(log.damage is None for log in readers)


@pytest.mark.parametrize("managed", [{"workers": 2}], indirect=True)
def test_a_question_that_is_being_answered_at_cleanup_is_refused(managed: Managed) -> None:
    for _ in range(2):
        managed.move(*UP)
        managed.wait_until_ready()
        answers = [managed.client.begin_to_ask(hard()) for _ in range(4)]
        quick = PredictTumbling.Request(body_name="brick", times=[0.0])
        managed.client.ask(quick)  # the others came before it
        managed.move(*DOWN)
        managed.client.spin_until(lambda answers=answers: all(answer.done() for answer in answers))
        for answer in answers:
            assert answer.result().status == answer.result().BUSY
            assert "was cleaned up" in answer.result().message


def test_transitions_that_are_none_of_the_state_are_refused_and_the_server_goes_on(managed: Managed) -> None:
    """Managers ask so: one that brings up all its nodes asks one to configure that is active already."""
    possible = {
        State.PRIMARY_STATE_UNCONFIGURED: {Transition.TRANSITION_CONFIGURE},
        State.PRIMARY_STATE_INACTIVE: {Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_CLEANUP},
        State.PRIMARY_STATE_ACTIVE: {Transition.TRANSITION_DEACTIVATE},
    }
    for then in (*UP, *DOWN):
        state = managed.state()
        for asked in {*UP, *DOWN, 77} - possible[state]:
            assert not managed.change(asked)
            assert managed.state() == state
        assert managed.change(then)


def test_a_parameter_of_no_type_is_refused_and_the_server_goes_on(managed: Managed) -> None:
    strange = ParameterMsg(name="state_timeout", value=ParameterValue(type=77))
    results = managed.call(
        SetParameters, "set_parameters", SetParameters.Request(parameters=[strange])
    ).results
    assert not any(result.successful for result in results)
    assert managed.state() == State.PRIMARY_STATE_UNCONFIGURED


def test_a_log_whose_disk_is_not_mounted_is_refused_and_written_once_it_is(tmp_path: Path) -> None:
    """The simulation begins anew meanwhile, of which a server that could not be configured hears, too."""
    disk = tmp_path / "disk"
    (tmp_path / "logs").symlink_to(disk)
    arguments = ("-p", f"log_directory:={tmp_path / 'logs'}", "-p", "use_sim_time:=true")
    domain_id = claim_domain()  # another server of this name is in that of this test run
    given = ("--params-file", str(FILE), "--ros-args", "-p", "autostart:=false", *arguments)
    with process("server", *given, ready="autostart is false", domain_id=domain_id) as server:
        client = Client(wait=False, domain_id=domain_id)
        managed = Managed(client, disk)
        try:
            clock = client.publisher(Clock, "/clock")
            for _ in range(20):
                assert not managed.change(Transition.TRANSITION_CONFIGURE)
            assert "log_directory must be" in wait_for(server, "cannot be configured")
            assert managed.state() == State.PRIMARY_STATE_UNCONFIGURED
            for seconds in range(200, 100, -1):
                clock.publish(Clock(clock=Time(sec=seconds)))
                managed.state()
            disk.mkdir()
            managed.move(*UP)
        finally:
            client.close()
    assert len(list(disk.iterdir())) == 1


@pytest.mark.parametrize("where", ["~nobody_of_this_name/logs", "{}/link", "{}/link/logs", "{}/file/logs"])
def test_a_log_that_nobody_can_write_is_refused_by_name(where: str, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "gone")
    (tmp_path / "file").touch()
    with pytest.raises(ConfigurationError, match=r"log_directory must be a folder to write to.*, got .*"):
        Log(where.format(tmp_path), run={}, limits=UNLIMITED, on_problem=print, on_notice=print)
