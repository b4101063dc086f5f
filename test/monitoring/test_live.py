# SPDX-License-Identifier: Apache-2.0
"""The monitor as a node in a process of its own: states are published, and events come back."""

from __future__ import annotations

import csv
import io
import json
import math
import subprocess
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from lifecycle_msgs.msg import Transition
from lifecycle_msgs.srv import ChangeState
from nav_msgs.msg import Odometry
from rcl_interfaces.srv import SetParameters
from rclpy.parameter import Parameter

from calibration.made_tosses import BRICK, FLOOR, I_B, MASS, SIZE, Truth, made_tosses
from contact_dynamics.command_line import main
from contact_dynamics.demo.processes import claim_domain
from contact_dynamics.measured.events import EventKind
from contact_dynamics_interfaces.msg import MonitorEvent
from msg_adapters.odometry import odometry_from_body_state
from msg_adapters.stamps import stamp_ns_from_msg
from running_server import DEEP, PATIENCE_S, Client, process, wait_for

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    from viewing.drawn import read_drawn

TRUTH = Truth(
    friction=0.3,
    restitution=0.4,
    center=(0.0, 0.0, 0.0),
    inertia=1.0,
    gravity=9.81,
    tilt=0.0,
    law_velocity=0.02,
    law_spin=0.3,
)
NODE = "contact_dynamics_monitor"
GAP_NS = 2_000_000_000  # between the beginnings of two tosses


def arguments(folder: Path, **parameters: object) -> tuple[str, ...]:
    """The arguments of a monitor of the tosses of `made_tosses`, whose log is in a folder."""
    calibration = folder / "calibration.json"
    calibration.write_text(
        json.dumps({"spread": {"velocity": 0.02, "spin": 0.3, "strike_height": 0.0}}), encoding="utf-8"
    )
    values = {
        "gravity": [0.0, 0.0, -9.81],
        "bodies": ["brick"],
        "body.brick.mass": MASS,
        "body.brick.inertia": [*I_B.diagonal().tolist(), 0.0, 0.0, 0.0],
        "body.brick.box": SIZE.tolist(),
        "body.brick.odometry_topic": "/brick/odometry",
        "surfaces": ["floor"],
        "surface.floor.friction": FLOOR.friction,
        "surface.floor.restitution": FLOOR.restitution,
        "distance_tolerance": 0.003,
        "log_directory": str(folder / "logs"),
        "calibration": str(calibration),
        **parameters,
    }
    file = folder / "monitor.yaml"
    file.write_text(json.dumps({"/**": {"ros__parameters": values}}), encoding="utf-8")
    return ("--params-file", str(file))


class Listener:
    """Publishes tosses, and keeps what a monitor publishes."""

    def __init__(self, domain_id: int) -> None:
        self.client = Client(wait=False, domain_id=domain_id)
        self.events: list[MonitorEvent] = []
        self.statuses: list[DiagnosticStatus] = []
        node = self.client.node
        node.create_subscription(MonitorEvent, f"/{NODE}/events", self.events.append, DEEP)
        node.create_subscription(
            DiagnosticArray, "/diagnostics", lambda msg: self.statuses.extend(msg.status), DEEP
        )
        self._publisher = node.create_publisher(Odometry, "/brick/odometry", DEEP)
        self._epoch_ns = time.time_ns() - 3_600_000_000_000  # so that arrivals are of another clock
        self._set = node.create_client(SetParameters, f"/{NODE}/set_parameters")
        # The first status comes a second after the node found this one.
        self.client.spin_until(lambda: self._publisher.get_subscription_count() and self.statuses)

    def set_parameter(self, name: str, value: float) -> None:
        """Set a parameter of the monitor, as `ros2 param set` does."""
        parameter = Parameter(name, value=value).to_parameter_msg()
        future = self._set.call_async(SetParameters.Request(parameters=[parameter]))
        self.client.spin_until(future.done)
        assert all(result.successful for result in future.result().results)

    def publish(self, truth: Truth, count: int, seed: int) -> None:
        """Publish some tosses, one every two seconds by the stamps."""
        for motion in made_tosses(truth, count, seed):
            self._epoch_ns += GAP_NS
            for state in motion.states(list(range(len(motion)))):
                moved = replace(state, stamp_ns=self._epoch_ns + state.stamp_ns)
                msg = odometry_from_body_state(
                    moved, world_frame="world", child_frame="brick", p_FB_F=BRICK.p_FB_F
                )
                self._publisher.publish(msg)

    def newest_ns(self) -> int:
        """The stamp, ns, before which all states of the newest toss's predecessors are."""
        return self._epoch_ns

    def received(self) -> int:
        """How many states the monitor has received, as it says itself."""
        values = [value for status in self.statuses for value in status.values]
        return max(int(value.value) for value in values if value.key == "/brick/odometry: messages")

    def impacts(self) -> list[MonitorEvent]:
        """The events about restitution and friction so far."""
        return [event for event in self.events if event.kind == MonitorEvent.IMPACT]


@contextmanager
def monitor(folder: Path, **parameters: Any) -> Iterator[tuple[subprocess.Popen[str], Listener]]:
    """Run a monitor and a listener."""
    domain_id = claim_domain()
    with process("live_monitor", *arguments(folder, **parameters), ready="ready", domain_id=domain_id) as one:
        listener = Listener(domain_id)
        try:
            yield one, listener
        finally:
            listener.client.close()


def test_events_of_tosses_as_configured_and_their_log(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with monitor(tmp_path) as (_, listener):
        listener.publish(TRUTH, 4, 5)
        # The last event is the flight after the last impact, once the body has been silent for a while.
        listener.client.spin_until(
            lambda: len(listener.impacts()) == 4 and listener.events[-1].kind == MonitorEvent.FLIGHT
        )
        first = listener.impacts()[0]
        assert (first.header.frame_id, first.body_name, first.surface_name) == ("world", "brick", "floor")
        # The smallest region follows from the probability.
        regions = [MonitorEvent.INSIDE_50, MonitorEvent.INSIDE_90, MonitorEvent.INSIDE_99]
        inside = [region for region in regions if first.probability >= 1.0 - 0.01 * region]
        assert first.region == (inside or [MonitorEvent.OUTSIDE_99])[0]
        assert abs(first.restitution - TRUTH.restitution) < 4.0 * first.restitution_std
        assert [event.impacts for event in listener.impacts()] == [1, 2, 3, 4]
        assert not any(event.changed or event.alarm for event in listener.events)
        events = listener.events
    (log,) = (tmp_path / "logs").iterdir()
    out = tmp_path / "events.jsonl"
    assert (
        main(["monitor", str(log), "--calibration", str(tmp_path / "calibration.json"), "--json", str(out)])
        == 0
    )
    rows = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    live = {(event.kind, stamp_ns_from_msg(event.header.stamp)): event for event in events}
    logged = {(EventKind[row["kind"]].value, row["stamp_ns"]): row for row in rows}
    assert live.keys() == logged.keys()
    for key, event in live.items():
        row = logged[key]
        report = row["surface_report"] or {"values": [None] * 2, "stds": [None] * 2, "impacts": 0}
        for number, expected in (
            (event.probability, row["probability"]),
            (event.time_error, row["time_error"]),
            *zip((event.restitution, event.friction), row["impact_values"], strict=True),
            *zip((event.restitution_std, event.friction_std), row["impact_stds"], strict=True),
            *zip((event.estimated_restitution, event.estimated_friction), report["values"], strict=True),
            *zip(
                (event.estimated_restitution_std, event.estimated_friction_std), report["stds"], strict=True
            ),
        ):
            assert number == expected or (math.isnan(number) and expected in {None, "nan"})
        assert event.impacts == report["impacts"]
        for name in ("predicted_mode", "measured_mode", "problem"):
            assert getattr(event, name) == row[name]
    capsys.readouterr()
    assert main(["replay", "table", str(log)]) == 0
    table = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert {row["service"] for row in table} == {"monitor"}
    assert {event.text for event in events} == {row["summary"] for row in table}
    picture = tmp_path / "picture.rrd"
    assert main(["replay", "view", str(log), "--rrd", str(picture)]) == 0
    assert events[-1].text in read_drawn(picture).last("/answers/newest", "TextDocument:text")[0]


def test_another_restitution_raises_an_alarm_until_it_is_configured(tmp_path: Path) -> None:
    with monitor(tmp_path) as (started, listener):
        listener.publish(replace(TRUTH, restitution=0.24), 12, 5)
        listener.client.spin_until(lambda: len(listener.impacts()) >= 12)
        (alarm,) = (event for event in listener.impacts() if event.alarm)
        assert alarm.changed == MonitorEvent.RESTITUTION
        assert "restitution of floor" in wait_for(started, "CHANGED")
        last = listener.impacts()[-1]
        assert abs(last.estimated_restitution - 0.24) < 4.0 * last.estimated_restitution_std
        wanted = f"{NODE}: events"
        listener.statuses.clear()
        listener.client.spin_until(lambda: wanted in [status.name for status in listener.statuses])
        status = next(status for status in listener.statuses if status.name == wanted)
        assert status.level == DiagnosticStatus.WARN
        assert "the restitution of floor has changed: restitution 0.2" in status.message
        assert {"impact", "floor"} <= {value.key for value in status.values}
        listener.set_parameter("surface.floor.restitution", 0.24)
        count = len(listener.impacts())
        listener.publish(replace(TRUTH, restitution=0.24), 4, 6)
        listener.client.spin_until(lambda: len(listener.impacts()) >= count + 4)
        assert not any(event.changed for event in listener.impacts()[count:])


def change_state(client: Client, transition: int) -> None:
    """Do what a lifecycle manager does."""
    change = client.node.create_client(ChangeState, f"/{NODE}/change_state")
    assert change.wait_for_service(PATIENCE_S)
    future = change.call_async(ChangeState.Request(transition=Transition(id=transition)))
    client.spin_until(future.done)
    assert future.result().success


def test_a_monitor_that_is_not_active_receives_states_and_publishes_no_event(tmp_path: Path) -> None:
    domain_id = claim_domain()
    given = arguments(tmp_path, autostart=False)
    with process("live_monitor", *given, ready="autostart is false", domain_id=domain_id):
        manager = Client(wait=False, domain_id=domain_id)
        change_state(manager, Transition.TRANSITION_CONFIGURE)
        listener = Listener(domain_id)
        client = listener.client
        listener.publish(TRUTH, 1, 5)
        client.spin_until(lambda: listener.received() > 0)
        change_state(manager, Transition.TRANSITION_ACTIVATE)
        listener.publish(TRUTH, 1, 6)
        begin = listener.newest_ns()
        client.spin_until(lambda: bool(listener.impacts()))
        change_state(manager, Transition.TRANSITION_DEACTIVATE)  # which publishes what is left
        assert min(stamp_ns_from_msg(event.header.stamp) for event in listener.events) >= begin
        client.close()
        manager.close()


@pytest.mark.parametrize(
    ("parameters", "words"),
    [
        ({"calibration": "nowhere.json"}, "calibration must be a readable file that calibrate --json"),
        ({"body.brick.odometry_topic": ""}, "odometry_topic, or another topic of states, is required"),
        ({"surface.floor.restitution": 1.5}, "surface.floor.restitution must be"),
        ({"calibartion": ""}, "calibartion: there is no such parameter; the nearest is calibration"),
    ],
)
def test_what_is_configured_wrong_is_named(tmp_path: Path, parameters: dict[str, object], words: str) -> None:
    given = arguments(tmp_path, **parameters)
    with process("live_monitor", *given, ready=words, domain_id=claim_domain()) as started:
        assert started.wait(PATIENCE_S) == 2
