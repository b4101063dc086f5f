# SPDX-License-Identifier: Apache-2.0
"""A lifecycle node with the server's parameters: the server or the monitor.

If `autostart` is set, the node configures and activates itself. Otherwise it waits for a lifecycle manager.
While it is configured, it receives states and writes the log. While it is active, it also does its own work.
"""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from rclpy.parameter import Parameter

from contact_dynamics.errors import ConcaveShapeWarning, ContactDynamicsError
from contact_dynamics.nodes.inbox import InboxNode
from contact_dynamics.nodes.node_parameters import NodeParameters, refuse_lost_sections
from contact_dynamics.nodes.other_parameters import PARAMETERS_OF_OTHERS
from contact_dynamics.nodes.parameter_reader import ParameterSource, is_of_ros
from contact_dynamics.nodes.parameters import check_change, read_server_parameters
from contact_dynamics.nodes.run_record import event_of_change, plain, run_record

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rclpy.lifecycle import LifecycleState

    from contact_dynamics.nodes.parameter_reader import DeclaredParameter
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.nodes.receiving import Receiving


class ManagedNode(InboxNode, LifecycleNode, ABC):
    """A lifecycle node that receives states."""

    def __init__(
        self,
        name: str,
        *,
        own: Mapping[str, DeclaredParameter] = MappingProxyType({}),
        ros_arguments: Sequence[str] = (),
        **node_options: Any,
    ) -> None:
        """Read the server's and the node's ``own`` parameters, and start the node if ``autostart`` is set.

        The ``ros_arguments`` are those of `rclpy.init`, and the ``node_options`` those of `rclpy.node.Node`.
        Raise `ConfigurationError` if a parameter is missing, unknown or not allowed.
        """
        self._work: Receiving | None = None
        self._own = own
        self._problem: ContactDynamicsError | OSError | None = None
        self._configuration: ServerParameters | None = None
        self._says_ready = False  # whether it still has to log that it is ready
        super().__init__(name, **node_options)
        refuse_lost_sections(self, ros_arguments)
        source = NodeParameters(
            self,
            ros_arguments=ros_arguments,
            also_known=PARAMETERS_OF_OTHERS,  # one file may configure all nodes
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
        """Read all parameters, and warn of bodies and obstacles that are not convex."""
        with warnings.catch_warnings(record=True) as warned:
            warnings.simplefilter("always", ConcaveShapeWarning)
            for declared in self._own.values():
                source.value(*declared)
            parameters = read_server_parameters(source)
        for each in warned:
            self.get_logger().warning(str(each.message))
        return parameters

    @abstractmethod
    def make_work(self, configuration: ServerParameters, run: Mapping[str, str]) -> Receiving:
        """Return the work of the configured node, with ``run`` as the log's record of the run.

        Raise `ContactDynamicsError` or `OSError` if that is impossible with these parameters.
        """

    def on_configure(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002  it is known
        """Create the work: subscribe, begin the log, and create what the node serves."""
        self._problem = None
        configuration = self._configuration
        if configuration is None:  # the parameters are not read yet
            return TransitionCallbackReturn.FAILURE
        try:
            self._work = self.make_work(configuration, self._run(self._values()))
        except (ContactDynamicsError, OSError) as error:
            self._problem = error
            self.get_logger().error(f"cannot be configured: {error}")
            self.unsubscribe()
            return TransitionCallbackReturn.FAILURE
        return TransitionCallbackReturn.SUCCESS

    def on_activate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Start the node's own work."""
        if self._work is not None:
            self._work.activate(is_active=True)
            self._says_ready = True
            if not self._work.is_ready:
                self.get_logger().info(self._work.preparations)
        returned: TransitionCallbackReturn = super().on_activate(state)
        return returned

    def on_deactivate(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Stop the node's own work, but continue to receive and log states."""
        if self._work is not None:
            self._work.activate(is_active=False)
            self._says_ready = False
        returned: TransitionCallbackReturn = super().on_deactivate(state)
        return returned

    def on_cleanup(self, state: LifecycleState) -> TransitionCallbackReturn:  # noqa: ARG002  it is known
        """Finish the log, and remove what `on_configure` created."""
        if self._work is not None:
            self.get_logger().info(self._work.close())
            self._work.remove()
            self._work = None
        return TransitionCallbackReturn.SUCCESS

    def on_shutdown(self, state: LifecycleState) -> TransitionCallbackReturn:
        """Clean up. Only a signal ends the process."""
        return self.on_cleanup(state)

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set parameters if the whole configuration is valid with them; otherwise return the reason.

        The parameters of newly listed bodies and surfaces are declared, and those of removed ones undeclared.
        """
        if self._configuration is None or all(is_of_ros(each.name) for each in parameter_list):
            return super().set_parameters_atomically(parameter_list)
        before = self._values()
        proposed = {**before, **{each.name: plain(each.value) for each in parameter_list}}
        given = ParameterSource(proposed, also_known=before, resolve=self._source.resolved_topic)
        try:
            configuration = self._read(given)
            if self._work is not None:
                others = [name for name in self._own if proposed[name] != before[name]]
                check_change(self._configuration, configuration, others)
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
        """Continue with another configuration."""
        after = self._values()
        event = event_of_change(self, before, after)
        if event is None:
            return
        self._configuration = configuration
        if self._work is not None:
            self._work.change(configuration, event=event, run=self._run(after))
        names = sorted(name for name in {*before, *after} if before.get(name) != after.get(name))
        self.get_logger().info(f"configured anew: {', '.join(names)}")

    def _run(self, values: Mapping[str, Any]) -> dict[str, str]:
        """Return the log's record of the run."""
        return run_record(values, self._source.topics)

    def _values(self) -> dict[str, Any]:
        return {name: plain(self._parameters[name].value) for name in sorted(self._parameters)}

    def attend(self) -> None:
        """Take messages and events, and publish /diagnostics once a second."""
        super().attend()
        if self._work is None:
            return
        self._work.attend()
        if self._says_ready and self._work.is_ready:
            self._says_ready = False
            self.get_logger().info(f"ready: {self._work}")

    def end_services(self) -> None:
        """End the processing of requests, and remove the services."""
        if self._work is not None:
            self._work.end()
        super().end_services()

    def close(self) -> bool:
        """Finish the log and report its path. Return True: failures of the log are already reported."""
        if self._work is not None:
            self.get_logger().info(self._work.close())
        return True

    def destroy_node(self) -> None:
        """End the workers and the node."""
        if self._work is not None:
            self._work.end_workers()
        super().destroy_node()
