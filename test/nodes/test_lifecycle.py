# SPDX-License-Identifier: Apache-2.0
"""The server as a managed node, over the services by which a lifecycle manager brings nodes up and down."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from lifecycle_msgs.msg import State, Transition
from lifecycle_msgs.srv import ChangeState, GetState
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter, ParameterValue
from rcl_interfaces.srv import SetParameters
from rosgraph_msgs.msg import Clock

from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.nodes.log import Log
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.recording import BagReader
from contact_dynamics.recording.limits import UNLIMITED
from contact_dynamics_interfaces.srv import PredictTumbling
from nodes.monitor import hard
from running_server import DOMAIN_ID, PATIENCE_S, ROOT, SERVICES, Client, process, wait_for


class Manager:
    """A client that also moves the server between its states."""

    def __init__(self, *, domain_id: int = DOMAIN_ID) -> None:
        self.client = Client(wait=False, domain_id=domain_id)
        node = self.client.node
        self._change = node.create_client(ChangeState, "/contact_dynamics/change_state")
        self._get = node.create_client(GetState, "/contact_dynamics/get_state")
        assert self._change.wait_for_service(PATIENCE_S)
        assert self._get.wait_for_service(PATIENCE_S)
        self.client.wait_until_found()

    def change(self, transition: int) -> bool:
        return bool(
            self._call(self._change, ChangeState.Request(transition=Transition(id=transition))).success
        )

    def state(self) -> int:
        return int(self._call(self._get, GetState.Request()).current_state.id)

    def _call(self, client: Any, request: Any) -> Any:
        future = client.call_async(request)
        self.client.spin_until(future.done)
        return future.result()


WAITS = ("--params-file", str(ROOT / "config" / "server.yaml"), "--ros-args", "-p", "autostart:=false")


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("logs")


@pytest.fixture(scope="module")
def manager(logs: Path) -> Iterator[Manager]:
    """Of a server that each test leaves as it is at first: unconfigured."""
    limits = ("-p", "state_timeout:=1000.0", "-p", "workers:=2")
    with process("server", *WAITS, "-p", f"log_directory:={logs}", *limits, ready="autostart is false"):
        manager = Manager()
        try:
            yield manager
        finally:
            manager.client.close()


def test_a_manager_brings_the_server_up_and_down_and_up_again(manager: Manager, logs: Path) -> None:
    question = PredictTumbling.Request(body_name="brick", times=[0.0])
    assert manager.state() == State.PRIMARY_STATE_UNCONFIGURED
    assert manager.client.ready() == 0
    for run in (1, 2):
        assert manager.change(Transition.TRANSITION_CONFIGURE)
        assert len(list(logs.iterdir())) == run
        manager.client.spin_until(lambda: manager.client.ready() == len(SERVICES))
        states = manager.client.publisher(Odometry, "/brick/odometry")
        msg = Odometry(child_frame_id="brick")
        msg.header.frame_id, msg.header.stamp = "world", manager.client.node.get_clock().now().to_msg()
        states.publish(msg)
        refused = manager.client.ask(question)
        assert refused.status == refused.BUSY
        assert "not active" in refused.message
        assert manager.change(Transition.TRANSITION_ACTIVATE)
        manager.client.spin_until(lambda: manager.client.ask(question).status == 0)  # the state came before
        assert manager.state() == State.PRIMARY_STATE_ACTIVE
        assert manager.change(Transition.TRANSITION_DEACTIVATE)
        assert manager.client.ask(question).status == refused.BUSY
        assert manager.change(Transition.TRANSITION_CLEANUP)
        assert manager.state() == State.PRIMARY_STATE_UNCONFIGURED
        manager.client.node.destroy_publisher(states)
        manager.client.spin_until(lambda: manager.client.ready() == 0)
    readers = [BagReader(folder) for folder in logs.iterdir()]
    assert all(any(message.topic == "/brick/odometry" for message in log.messages()) for log in readers)
    assert all(log.damage is None for log in readers)


def test_a_question_that_is_being_answered_at_cleanup_is_refused(manager: Manager) -> None:
    for _ in range(2):
        assert manager.change(Transition.TRANSITION_CONFIGURE)
        assert manager.change(Transition.TRANSITION_ACTIVATE)
        manager.client.spin_until(lambda: manager.client.ready() == len(SERVICES))
        manager.client.wait_until_found()
        answers = [manager.client.begin_to_ask(hard()) for _ in range(4)]
        quick = PredictTumbling.Request(body_name="brick", times=[0.0])
        manager.client.ask(quick)  # the others came before it
        assert manager.change(Transition.TRANSITION_DEACTIVATE)
        assert manager.change(Transition.TRANSITION_CLEANUP)
        manager.client.spin_until(lambda answers=answers: all(answer.done() for answer in answers))
        for answer in answers:
            assert answer.result().status == answer.result().BUSY
            assert "was cleaned up" in answer.result().message


def test_transitions_that_are_none_of_the_state_are_refused_and_the_server_goes_on(manager: Manager) -> None:
    """Managers ask so: one that brings up all its nodes asks one to configure that is active already."""
    up = (Transition.TRANSITION_CONFIGURE, Transition.TRANSITION_ACTIVATE)
    down = (Transition.TRANSITION_DEACTIVATE, Transition.TRANSITION_CLEANUP)
    possible = {
        State.PRIMARY_STATE_UNCONFIGURED: {Transition.TRANSITION_CONFIGURE},
        State.PRIMARY_STATE_INACTIVE: {Transition.TRANSITION_ACTIVATE, Transition.TRANSITION_CLEANUP},
        State.PRIMARY_STATE_ACTIVE: {Transition.TRANSITION_DEACTIVATE},
    }
    for then in (*up, *down):
        state = manager.state()
        for asked in {*up, *down, 77} - possible[state]:
            assert not manager.change(asked)
            assert manager.state() == state
        assert manager.change(then)


def test_a_parameter_of_no_type_is_refused_and_the_server_goes_on(manager: Manager) -> None:
    client = manager.client.node.create_client(SetParameters, "/contact_dynamics/set_parameters")
    assert client.wait_for_service(PATIENCE_S)
    strange = Parameter(name="state_timeout", value=ParameterValue(type=77))
    future = client.call_async(SetParameters.Request(parameters=[strange]))
    manager.client.spin_until(future.done)
    assert not any(result.successful for result in future.result().results)
    assert manager.state() == State.PRIMARY_STATE_UNCONFIGURED


def test_a_log_whose_disk_is_not_mounted_is_refused_and_written_once_it_is(tmp_path: Path) -> None:
    """The simulation begins anew meanwhile, of which a server that could not be configured hears, too."""
    disk = tmp_path / "disk"
    (tmp_path / "logs").symlink_to(disk)
    arguments = ("-p", f"log_directory:={tmp_path / 'logs'}", "-p", "use_sim_time:=true")
    domain_id = claim_domain()  # another server of this name is in that of this test run
    with process("server", *WAITS, *arguments, ready="autostart is false", domain_id=domain_id) as server:
        manager = Manager(domain_id=domain_id)
        try:
            clock = manager.client.publisher(Clock, "/clock")
            for _ in range(20):
                assert not manager.change(Transition.TRANSITION_CONFIGURE)
            assert "log_directory must be" in wait_for(server, "cannot be configured")
            assert manager.state() == State.PRIMARY_STATE_UNCONFIGURED
            for seconds in range(200, 100, -1):
                clock.publish(Clock(clock=Time(sec=seconds)))
                manager.state()
            disk.mkdir()
            assert manager.change(Transition.TRANSITION_CONFIGURE)
            assert manager.change(Transition.TRANSITION_ACTIVATE)
        finally:
            manager.client.close()
    assert len(list(disk.iterdir())) == 1


@pytest.mark.parametrize("where", ["~nobody_of_this_name/logs", "{}/link", "{}/link/logs", "{}/file/logs"])
def test_a_log_that_nobody_can_write_is_refused_by_name(where: str, tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "gone")
    (tmp_path / "file").touch()
    with pytest.raises(ConfigurationError, match=r"log_directory must be a folder to write to.*, got .*"):
        Log(where.format(tmp_path), run={}, limits=UNLIMITED, on_problem=print, on_notice=print)
