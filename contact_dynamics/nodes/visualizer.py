"""The visualizer: shows bodies, surfaces, contacts and every answer of a server in rerun, live or to a file.

It is a process of its own: it listens to the bodies' states and to the service events that the server
publishes, and nothing goes back. It takes the server's parameters, which describe bodies, surfaces and
topics, and its own (`config/visualizer.yaml`). A drawing that fails is told once, and the rest goes on.

`replay.view` draws a log in the same way.
"""

from __future__ import annotations

import os
import sys
import time
import traceback
from functools import partial
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.clock import Clock, ClockType
from rclpy.qos import QoSProfile
from service_msgs.msg import ServiceEventInfo

from contact_dynamics.diagrams.words import CONTACT_MODE, IMPACT, TUMBLING
from contact_dynamics.nodes.arguments import visualizer_parser
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.node_parameters import NodeParameters, refuse_unknown_parameters
from contact_dynamics.nodes.parameters import ConfigurationError, read_server_parameters
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.state_subscriptions import subscribe_to_states
from contact_dynamics.nodes.topic_faults import TopicFaults
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.uncertain_state import state_of
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.sinks import DEFAULT_PORT, OpenRecording, Sinks, ViewerMode, raise_errors
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling
from msg_adapters.contact_mode import contact_mode_answer_from_msg
from msg_adapters.impact import impact_answer_from_msg
from msg_adapters.stamps import stamp_ns_from_msg
from msg_adapters.tumbling import tumbling_answer_from_msg

if TYPE_CHECKING:
    from collections.abc import Callable

    from rclpy.node import Node
    from rclpy.subscription import Subscription

    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.rigid_body.body import BodyState

NODE_NAME: Final = "contact_dynamics_visualizer"

EVENT_QOS: Final = QoSProfile(depth=10_000)
"""Queue depth of the service events. It equals the server's, so that a burst of questions is all drawn."""

DRAW_PERIOD_S: Final = 0.05
"""States are drawn in batches, because a batch costs what a single state does."""

SERVER_WAIT_S: Final = 3.0
"""How long a start waits for a server: as long as one that is started at the same time may take."""

_POLL_S: Final = 0.02


class _Shown(NamedTuple):
    """A service whose answers are drawn."""

    service_type: Any
    name: str  # below the server's
    kind: str  # the kind of its answers, in words
    from_msg: Callable[..., Any]  # makes an answer of a response
    show: Callable[..., None]  # draws an answer


_SHOWN: Final = (
    _Shown(PredictTumbling, "predict_tumbling", TUMBLING, tumbling_answer_from_msg, Picture.show_tumbling),
    _Shown(PredictImpact, "predict_impact", IMPACT, impact_answer_from_msg, Picture.show_impact),
    _Shown(
        PredictContactMode,
        "predict_contact_mode",
        CONTACT_MODE,
        contact_mode_answer_from_msg,
        Picture.show_contact_modes,
    ),
)


class Visualizer(InboxNode):
    """The node `contact_dynamics_visualizer`."""

    def __init__(self, *, strict: bool = False, server_wait: float = 0.0, **node_options: Any) -> None:
        """Read the parameters, open the sinks, draw the scene and listen.

        Args:
            strict: let errors in drawing raise, instead of telling each kind once.
            server_wait: s, how long to wait for the server before listening to states.
            node_options: options of `rclpy.node.Node`.

        Raises:
            ConfigurationError: a parameter is missing, unknown or not allowed.
            NowhereToDrawError: a viewer was asked for alone, and there is none.
            OSError: the file cannot be written.
        """
        super().__init__(NODE_NAME, **node_options)
        raise_errors()
        self._strict = strict
        self._told: set[str] = set()
        parameters = read_server_parameters(NodeParameters(self))
        self._world = parameters.world
        server, surface_side, self._sinks = _read_own_parameters(self)
        refuse_unknown_parameters(self)
        self._recording = OpenRecording(self._sinks, on_problem=self.get_logger().warning)
        self._picture = Picture(self._recording.stream, self._world, surface_side=surface_side)
        self._states = _WaitingStates()
        events = [self._listen(shown, f"{server}/{shown.name}") for shown in _SHOWN]
        self._wait_for_server(server, events, server_wait)
        subscribe_to_states(
            self,
            parameters,
            states=self._states,
            record=lambda _topic, _taken: None,
            faults=TopicFaults(self.get_logger().warning),
        )
        self.create_timer(DRAW_PERIOD_S, self.draw_states, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.get_logger().info(f"ready: draws {server} to {self._recording.description}")

    def draw_states(self) -> None:
        """Draw the states that came since the last time."""
        self.take_messages()
        for body_name, states in self._states.take().items():
            self._guarded("states", partial(self._picture.add_states, body_name, states))

    def close(self) -> bool:
        """Draw what is left and close the sinks. Return whether they took everything."""
        self.draw_states()
        if self._sinks.viewer is ViewerMode.NONE:
            self._guarded("the last look", self._picture.frame_all)
        return self._recording.close()

    def _wait_for_server(self, server: str, events: list[Subscription], patience: float) -> None:
        """Wait for the server's events, so that nothing is missed by who plays states to their listeners."""
        deadline = time.monotonic() + patience
        while not all(subscription.get_publisher_count() for subscription in events):
            if time.monotonic() > deadline:
                self.get_logger().info(f"no {server} yet: its answers are drawn from when it comes")
                return
            time.sleep(_POLL_S)

    def _listen(self, shown: _Shown, service: str) -> Subscription:
        def receive(event: Any) -> None:
            if event.info.event_type == ServiceEventInfo.RESPONSE_SENT and event.response:
                self._guarded(service, lambda: self._show(shown, event))

        event_type = shown.service_type.Event
        return self.create_subscription(event_type, f"{service}/_service_event", receive, EVENT_QOS)

    def _show(self, shown: _Shown, event: Any) -> None:
        response = event.response[0]
        self.draw_states()
        now_ns = self._picture.newest_stamp_ns() or stamp_ns_from_msg(event.info.stamp)
        if response.status != response.OK:
            refused = f"refused ({response.status}): {response.message}"
            self._picture.tell(shown.kind, refused, stamp_ns=now_ns, is_error=True)
            return
        shown.show(
            self._picture,
            shown.from_msg(response, world=self._world),
            now_ns=now_ns,
            remark=response.message,
            computation_time=response.computation_time,
        )

    def _guarded(self, kind: str, draw: Callable[[], None]) -> None:
        try:
            draw()
        except Exception:
            if self._strict:
                raise
            if kind not in self._told:
                self._told.add(kind)
                self.get_logger().warning(f"cannot draw {kind}; not told again:\n{traceback.format_exc()}")


class _WaitingStates(StateStore):
    """Keeps the states that are not drawn yet."""

    def __init__(self) -> None:
        super().__init__(history=0.0, timeout=0.0)
        self._waiting: dict[str, list[BodyState]] = {}

    def add(self, body_name: str, state: KnownState, *, now_ns: int | None = None) -> None:  # noqa: ARG002
        """Keep a state whatever its stamp: those of a log are not of this clock."""
        self._waiting.setdefault(body_name, []).append(state_of(state))

    def add_unread(
        self,
        body_name: str,
        stamp_ns: int,  # noqa: ARG002  the state has it too
        read: Callable[[], KnownState | None],
        *,
        now_ns: int | None = None,  # noqa: ARG002  as above
    ) -> None:
        """Read and keep a state, as all are drawn."""
        state = read()
        if state is not None:
            self.add(body_name, state)

    def take(self) -> dict[str, list[BodyState]]:
        waiting, self._waiting = self._waiting, {}
        return {name: sorted(states, key=lambda state: state.stamp_ns) for name, states in waiting.items()}


def _read_own_parameters(node: Node) -> tuple[str, float, Sinks]:
    def read(name: str, default: Any, description: str, **ranges: Any) -> Any:
        try:
            descriptor = ParameterDescriptor(description=description, read_only=True, **ranges)
            return node.declare_parameter(name, default, descriptor).value
        except Exception as error:  # noqa: BLE001  rclpy raises several unrelated types for a wrong type or range
            message = f"{name}: {error} ({description})"
            raise ConfigurationError(message) from None

    server = read("server", "/contact_dynamics", "Full name of the server node whose answers are drawn.")
    side = read(
        "surface_side",
        2.0,
        "Side of the square that a surface is drawn as, m.",
        floating_point_range=[FloatingPointRange(from_value=1e-3, to_value=1e4)],
    )
    rrd_path = read("rrd_path", "", "File to draw into, which is replaced. Empty: none.")
    spawn = read("spawn", False, "Start rerun's viewer, unless one listens at the port already.")  # noqa: FBT003
    serve = read("serve", False, "Serve the picture at the port, for viewers that connect.")  # noqa: FBT003
    url = read(
        "connect", "", "URL of a viewer to draw in, as rerun+http://127.0.0.1:9876/proxy. Empty: none."
    )
    port = read(
        "port",
        DEFAULT_PORT,
        "Port of this machine that the viewer which is started listens at, or that the picture is served at.",
        integer_range=[IntegerRange(from_value=1, to_value=65535)],
    )
    chosen = [name for name, on in (("spawn", spawn), ("serve", serve), ("connect", bool(url))) if on]
    if len(chosen) > 1:
        message = f"{' and '.join(chosen)}: found {len(chosen)} ways to a viewer, allowed is one"
        raise ConfigurationError(message)
    if not chosen and not rrd_path:
        message = "rrd_path, spawn, serve, connect: found none, needed is somewhere to draw to"
        raise ConfigurationError(message)
    viewer = ViewerMode(chosen[0]) if chosen else ViewerMode.NONE
    return server, side, Sinks(rrd_path=rrd_path, viewer=viewer, port=port, url=url)


def main(arguments: list[str]) -> int:
    """Run the visualizer until it is told to stop; return the exit code."""
    exit_code = run_node(
        lambda: Visualizer(server_wait=SERVER_WAIT_S),
        verb="visualizer",
        parser=visualizer_parser(),
        arguments=arguments,
    )
    if exit_code == 1:
        sys.stdout.flush()
        os._exit(exit_code)  # a usual exit would wait for a viewer that hangs
    return exit_code
