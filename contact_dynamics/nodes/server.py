# SPDX-License-Identifier: Apache-2.0
"""The server: one process with the services, one store of states, and the log.

It watches published states and answers the services of `questions.services`. Drawing happens in another
process (`visualizer`), which listens to the service events that this node publishes.

It is a managed node, as those of Nav2 are. `autostart` configures and activates it at its start. Otherwise it
waits for a lifecycle manager. Configured, it receives states and writes the log; active, it answers.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.parameter import Parameter

from contact_dynamics.errors import ConcaveShapeWarning, ContactDynamicsError
from contact_dynamics.nodes.arguments import server_parser
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.node_parameters import NodeParameters, refuse_lost_sections
from contact_dynamics.nodes.parameter_reader import NODE_NAME, ParameterSource, is_of_ros
from contact_dynamics.nodes.parameters import check_change, read_server_parameters
from contact_dynamics.nodes.run_record import event_of_change, plain, run_record
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.serving import Serving
from contact_dynamics.nodes.visualizer_parameters import VISUALIZER_PARAMETERS

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rclpy.lifecycle import LifecycleState

    from contact_dynamics.nodes.parameters import ServerParameters


class Server(InboxNode, LifecycleNode):
    """The node `contact_dynamics`."""

    def __init__(self, *, ros_arguments: Sequence[str] = (), **node_options: Any) -> None:
        """Read the parameters, and configure and activate the node where ``autostart`` says so.

        Args:
            ros_arguments: ROS's arguments, as `rclpy.init` was given them.
            node_options: options of `rclpy.node.Node`.

        Raises:
            ConfigurationError: a parameter is missing, unknown or not allowed.
        """
        self._serving: Serving | None = None
        self._problem: ContactDynamicsError | OSError | None = None
        self._configuration: ServerParameters | None = None
        self._says_ready = False  # once the workers are
        super().__init__(NODE_NAME, **node_options)
        refuse_lost_sections(self, ros_arguments)
        source = NodeParameters(
            self,
            ros_arguments=ros_arguments,
            also_known=VISUALIZER_PARAMETERS,  # one file may configure both nodes
            read_only=False,
        )
        self._source = source
        self._configuration = self._read(source)
        if not self._configuration.autostart:
            self.get_logger().info("waits to be configured and activated, since autostart is false")
            return
        self.trigger_configure()
        if self._problem is not None:
            raise self._problem
        self.trigger_activate()

    def _read(self, source: ParameterSource) -> ServerParameters:
        """Read every parameter, and tell in the log of bodies and obstacles that are not convex."""
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", ConcaveShapeWarning)
            parameters = read_server_parameters(source)
        for each in warned:
            self.get_logger().warning(str(each.message))
        return parameters

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002  it is known
        """Receive states, begin the log, and create the services."""
        self._problem = None
        configuration = self._configuration
        if configuration is None:  # nobody can ask for it before the parameters are read
            return TransitionCallbackReturn.FAILURE
        try:
            self._serving = Serving(self, configuration, run=self._run(self._values()))
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
            self._says_ready = True
            if not self._serving.is_ready:
                self.get_logger().info(self._serving.preparations)
        returned: TransitionCallbackReturn = super().on_activate(state)
        return returned

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Refuse questions from now on."""
        if self._serving is not None:
            self._serving.activate(is_active=False)
            self._says_ready = False
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

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set parameters, if the whole configuration is allowed with them; otherwise say why it is not.

        Parameters of bodies and surfaces that are listed from now on come with them. Those of others go.
        """
        if self._configuration is None or all(is_of_ros(each.name) for each in parameter_list):
            return super().set_parameters_atomically(parameter_list)
        before = self._values()
        proposed = {**before, **{each.name: plain(each.value) for each in parameter_list}}
        given = ParameterSource(proposed, also_known=before, resolve=self._source.resolved_topic)
        try:
            configuration = self._read(given)
            if self._serving is not None:
                check_change(self._configuration, configuration)
        except ContactDynamicsError as error:
            return SetParametersResult(successful=False, reason=str(error))
        new = [name for name in given.read if name not in before]
        for name in new:
            self._source.declare(given.read[name])
        result = super().set_parameters_atomically(parameter_list)
        unread = [name for name in self._values() if name not in given.read and not is_of_ros(name)]
        for name in unread if result.successful else new:
            self.undeclare_parameter(name)
        if result.successful:
            self._change(configuration, before)
        return result

    def _change(self, configuration: ServerParameters, before: Mapping[str, Any]) -> None:
        """Serve with another configuration from now on."""
        after = self._values()
        event = event_of_change(self, before, after)
        if event is None:
            return
        self._configuration = configuration
        if self._serving is not None:
            self._serving.change(configuration, event=event, run=self._run(after))
        names = sorted(name for name in {*before, *after} if before.get(name) != after.get(name))
        self.get_logger().info(f"configured anew: {', '.join(names)}")

    def _run(self, values: Mapping[str, Any]) -> dict[str, str]:
        """Return what the log says of the run."""
        return run_record(values, self._source.topics)

    def _values(self) -> dict[str, Any]:
        return {name: plain(self._parameters[name].value) for name in sorted(self._parameters)}

    def attend(self) -> None:
        """Take messages and events, and look around once a second."""
        super().attend()
        if self._serving is None:
            return
        self._serving.attend()
        if self._says_ready and self._serving.is_ready:
            self._says_ready = False
            self.get_logger().info(f"ready: {self._serving}")

    def end_services(self) -> None:
        """Refuse the questions whose answers are not there yet, and take no more requests."""
        if self._serving is not None:
            self._serving.refuse_all()
        super().end_services()

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
    return run_node(
        lambda ros_arguments: Server(ros_arguments=ros_arguments),
        verb="server",
        parser=server_parser(),
        arguments=arguments,
    )
