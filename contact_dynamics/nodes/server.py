"""The server: one process with the services, one store of states, and the log.

It watches published states and answers `~/predict_contact_mode`, `~/predict_impact` and `~/predict_tumbling`.
Drawing happens in another process (`visualizer`), which listens to the service events that this node
publishes.

It is a managed node, as those of Nav2 are. `autostart` configures and activates it at its start. Otherwise it
waits for a lifecycle manager. Configured, it receives states and writes the log; active, it answers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.arguments import VISUALIZER_PARAMETERS, server_parser
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.node_parameters import NodeParameters, refuse_unknown_parameters
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.nodes.run_record import NODE_NAME, run_record
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.serving import Serving

if TYPE_CHECKING:
    from rclpy.lifecycle import LifecycleState


class Server(InboxNode, LifecycleNode):
    """The node `contact_dynamics`."""

    def __init__(self, **node_options: Any) -> None:
        """Read the parameters, and configure and activate the node where ``autostart`` says so.

        Raises:
            ConfigurationError: a parameter is missing, unknown or not allowed.
        """
        self._serving: Serving | None = None
        self._problem: ContactDynamicsError | OSError | None = None
        super().__init__(NODE_NAME, **node_options)
        source = NodeParameters(self)
        self._configuration = read_server_parameters(source)
        # One file may configure both nodes.
        refuse_unknown_parameters(self, also_known=VISUALIZER_PARAMETERS)
        self._topics_by_parameter = source.topics
        if not self._configuration.autostart:
            self.get_logger().info("waits to be configured and activated, since autostart is false")
            return
        self.trigger_configure()
        if self._problem is not None:
            raise self._problem
        self.trigger_activate()

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002  it is known
        """Receive states, begin the log, and create the services."""
        parameters = {name: self._parameters[name].value for name in sorted(self._parameters)}
        run = run_record(parameters, self._topics_by_parameter)
        self._problem = None
        try:
            self._serving = Serving(self, self._configuration, run=run)
        except (ContactDynamicsError, OSError) as error:
            self._problem = error
            self.get_logger().error(f"cannot be configured: {error}")
            self.unsubscribe()
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Answer questions from now on."""
        if self._serving is not None:
            self._serving.activate(is_active=True)
            self.get_logger().info(f"ready: {self._serving}")
        returned: TransitionCallbackReturn = super().on_activate(state)
        return returned

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Refuse questions from now on."""
        if self._serving is not None:
            self._serving.activate(is_active=False)
        returned: TransitionCallbackReturn = super().on_deactivate(state)
        return returned

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002  it is known
        """Finish the log, and take back what configuring made."""
        if self._serving is not None:
            self.get_logger().info(self._serving.close())
            self._serving.remove()
            self._serving = None
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Do as when it is cleaned up; a signal ends the process."""
        return self.on_cleanup(state)

    def attend(self) -> None:
        """Take messages and events, and look around once a second."""
        super().attend()
        if self._serving is not None:
            self._serving.attend()

    def close(self) -> bool:
        """Finish the log and say where it is; return True, since a log that fails has been told."""
        if self._serving is not None:
            self.get_logger().info(self._serving.close())
        return True

    def destroy_node(self) -> None:
        """End the workers and the node."""
        if self._serving is not None:
            self._serving.end_workers()
        super().destroy_node()


def main(arguments: list[str]) -> int:
    """Run the server until it is told to stop; return the exit code."""
    return run_node(Server, verb="server", parser=server_parser(), arguments=arguments)
