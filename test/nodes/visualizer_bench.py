# SPDX-License-Identifier: Apache-2.0
"""A visualizer on a bench: a node beside it publishes what a body and a server would."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
import rclpy
from geometry_msgs.msg import Point, Pose, Quaternion, Vector3
from nav_msgs.msg import Odometry
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from service_msgs.msg import ServiceEventInfo

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    from contact_dynamics.nodes.visualizer import Visualizer
    from viewing.drawn import STAMP_NS, Drawn, read_drawn

from contact_dynamics.questions import services
from contact_dynamics_interfaces.msg import BodyState, ContactSet, Impact, Poinsot, Trajectory
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from msg_adapters.stamps import stamp_to_msg
from running_server import DOMAIN_ID

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

CENTER = np.array([0.02, -0.01, 0.005])  # m, of mass, in the body's frame
CONFIGURATION = {
    "bodies": ["brick"],
    "body.brick.mass": 0.4,
    "body.brick.inertia": [0.00035, 0.00083, 0.00102, 0.0, 0.0, 0.0],
    "body.brick.center_of_mass": CENTER.tolist(),
    "body.brick.box": [0.15, 0.09, 0.05],
    "body.brick.odometry_topic": "/brick/odometry",
    "surfaces": ["floor"],
    "surface.floor.friction": 0.3,
    "surface.floor.restitution": 0.5,
}
TURNED = [0.1, -0.5, 0.7, 0.5]  # x, y, z, w
SERVICES = {each.name: each.service_type for each in services.SERVICES}
PATIENCE = 300  # spins of up to 0.1 s


class Bench:
    """A visualizer, and a node that publishes what a server and a body would."""

    def __init__(self, path: Path, *, strict: bool) -> None:
        self.path = path
        self._context = Context()
        rclpy.init(context=self._context, domain_id=DOMAIN_ID)
        values = {**CONFIGURATION, "rrd_path": str(path)}
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        self.visualizer = Visualizer(strict=strict, context=self._context, parameter_overrides=overrides)
        self.node = Node("outside", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.visualizer)
        self._executor.add_node(self.node)
        qos = QoSProfile(depth=1000)
        self.states = self.node.create_publisher(Odometry, "/brick/odometry", qos)
        self._events = {
            name: self.node.create_publisher(service.Event, f"/contact_dynamics/{name}/_service_event", qos)
            for name, service in SERVICES.items()
        }
        self.received = 0
        for subscription in [*self.visualizer.subscriptions, *self.visualizer.inbox]:
            if subscription.topic_name == "/parameter_events":
                continue  # every node publishes there
            subscription.callback = self._counting(subscription.callback)
        publishers = [self.states, *self._events.values()]
        self.spin_until(lambda: all(publisher.get_subscription_count() == 1 for publisher in publishers))

    def _counting(self, callback: Callable[[Any], None]) -> Callable[[Any], None]:
        def receive(msg: Any) -> None:
            self.received += 1
            callback(msg)

        return receive

    def spin_until(self, done: Callable[[], bool]) -> None:
        for _ in range(PATIENCE):
            if done():
                return
            self._executor.spin_once(timeout_sec=0.1)
        pytest.fail("nothing came")

    def answer(self, name: str, response: Any, kind: int = ServiceEventInfo.RESPONSE_SENT) -> None:
        """Publish a service event, and wait until it has been received."""
        info = ServiceEventInfo(event_type=kind, stamp=stamp_to_msg(STAMP_NS + 7))
        self._events[name].publish(SERVICES[name].Event(info=info, response=[response]))
        expected = self.received + 1
        self.spin_until(lambda: self.received == expected)

    def drawn(self) -> Drawn:
        assert self.visualizer.close()
        return read_drawn(self.path)

    def end(self) -> None:
        self._executor.shutdown()
        self.node.destroy_node()
        self.visualizer.destroy_node()
        rclpy.shutdown(context=self._context)


def odometry(stamp_ns: int, x: float) -> Odometry:
    msg = Odometry(child_frame_id="brick")
    msg.header.frame_id = "world"
    msg.header.stamp = stamp_to_msg(stamp_ns)
    msg.pose.pose = Pose(position=Point(x=x, y=0.0, z=1.0), orientation=quaternion(TURNED))
    return msg


def quaternion(numbers: list[float]) -> Quaternion:
    x, y, z, w = numbers
    return Quaternion(x=x, y=y, z=z, w=w)


def body_state(stamp_ns: int = STAMP_NS, body_name: str = "brick") -> BodyState:
    msg = BodyState(body_name=body_name)
    msg.header.frame_id = "world"
    msg.header.stamp = stamp_to_msg(stamp_ns)
    msg.pose = Pose(position=Point(x=0.5, y=0.0, z=1.0), orientation=quaternion(TURNED))
    msg.linear_velocity = Vector3(x=1.0, y=0.0, z=-2.0)
    return msg


def two_contacts() -> ContactSet:
    return ContactSet(
        positions=[0.1, 0.0, 0.0, -0.1, 0.0, 0.0],
        normals=[0.0, 0.0, 1.0, 0.0, 0.0, 1.0],
        frictions=[0.3, 0.3],
        restitutions=[0.5, 0.5],
        surface_names=["floor", "floor"],
    )


def tumbling_answer(stamp_ns: int = STAMP_NS) -> PredictTumbling.Response:
    return PredictTumbling.Response(
        state=body_state(stamp_ns),
        trajectory=Trajectory(
            times=[0.0, 0.1],
            positions=[0.5, 0.0, 1.0, 0.6, 0.0, 0.8],
            orientations=[0.0, 0.0, 0.0, 1.0, *TURNED],
            linear_velocities=[1.0, 0.0, -2.0, 1.0, 0.0, -3.0],
            angular_velocities=[0.0] * 6,
        ),
        event=PredictTumbling.Response.CONTACT,
        event_time=0.1,
        event_point=Point(x=0.6, y=0.0, z=0.0),
        event_velocity=Vector3(x=3.0, y=0.0, z=-4.0),
        event_surface="floor",
        poinsot=Poinsot(regime=Poinsot.ABOUT_MAJOR_AXIS, principal_moments=[0.01, 0.04, 0.0625]),
        computation_time=0.0012,
    )


def impact_answer(contacts: ContactSet) -> PredictImpact.Response:
    impact = Impact(
        outcome=Impact.STICKS_IN_COMPRESSION,
        state_after=body_state(),
        impulses=[0.3, 0.0, 0.4, 0.0, 0.0, 0.0],
        path=[0.0, 0.0, 0.0, 0.3, 0.0, 0.4],
        path_events=[Impact.START, Impact.RESTITUTION_ENDS],
        path_contacts=[0, 0],
        kinetic_energy_before=1.0,
        kinetic_energy_after=0.25,
    )
    return PredictImpact.Response(
        impact=impact, time_to_contact=0.05, state_before=body_state(), contacts=contacts, problem=2
    )
