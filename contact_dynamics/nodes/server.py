# SPDX-License-Identifier: Apache-2.0
"""The server: one process with the services, one store of states, and the log.

It watches published states and answers the services of `questions.services`. Drawing happens in another
process (`visualizer`), which listens to the service events that this node publishes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from contact_dynamics.nodes.arguments import server_parser
from contact_dynamics.nodes.managed_node import ManagedNode
from contact_dynamics.nodes.parameter_reader import NODE_NAME
from contact_dynamics.nodes.running import run_node
from contact_dynamics.nodes.serving import Serving

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from contact_dynamics.nodes.parameters import ServerParameters


class Server(ManagedNode):
    """The node `contact_dynamics`."""

    def __init__(self, *, ros_arguments: Sequence[str] = (), **node_options: Any) -> None:
        """Read the parameters, and begin where ``autostart`` says so (see `ManagedNode`)."""
        super().__init__(NODE_NAME, ros_arguments=ros_arguments, **node_options)

    def make_work(self, configuration: ServerParameters, run: Mapping[str, str]) -> Serving:
        """Return what answers while the node is active."""
        return Serving(self, configuration, run=run)


def main(arguments: list[str]) -> int:
    """Run the server until a signal or a shutdown ends it; return the exit code."""
    return run_node(
        lambda ros_arguments: Server(ros_arguments=ros_arguments),
        verb="server",
        parser=server_parser(),
        arguments=arguments,
    )
