# SPDX-License-Identifier: Apache-2.0
"""Finds out whether messages still reach this process: the node's self-check.

A process can go deaf while everything else looks well: other nodes see it in the graph, and nothing that they
send arrives. It happens when the files in `/dev/shm`, by which DDS hands messages over, are removed under a
running process, as logind does when a user logs out, and it has happened on a starved machine. Within the
process nothing shows it, since messages from itself take another way. So from time to time another process
joins the domain for a moment, as a new client does, and sends a token. If two such processes in turn are not
heard, the node is deaf.

This file is also that other process, which ends with 0 when it has sent the token, whether or not somebody
received it.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
import uuid
from typing import TYPE_CHECKING, Final

import rclpy
from diagnostic_msgs.msg import KeyValue
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

from contact_dynamics.nodes.situations import Present, Situation

if TYPE_CHECKING:
    from contact_dynamics.nodes.inbox import InboxNode, Taken

TOPIC: Final = "~/self_check"
QOS: Final = QoSProfile(depth=10)
KEY: Final = "token"
SOON_S: Final = 10.0
"""s. The least time between two checks, where something looks wrong."""

UNHEARD_CHECKS: Final = 2
"""So many checks in turn must fail. On a starved machine a single one may fail for want of time."""

LONGEST_S: Final = 60.0
"""s. The process of a check needs a quarter of it at most, so that one that takes longer hangs in DDS."""

_SENDER: Final = "contact_dynamics.nodes.self_check"


class SelfCheck:
    """The self-check of a node.

    Attributes:
        unheard: How many checks in turn failed, up to now.
        heard: How many did not.
        is_deaf: Whether messages do not reach the node any more.
        problem: What was wrong with the last check, in words, or nothing.
    """

    def __init__(self, node: InboxNode, period: float | None) -> None:
        """Begin to listen. A check begins after each ``period``, s; with None there is none."""
        self._node = node
        self._period = period
        self._token = ""
        self._sender: subprocess.Popen[str] | None = None
        self._begun = time.monotonic()
        self.unheard = 0
        self.heard = 0
        self.problem = ""
        self._tokens = node.subscribe(KeyValue, TOPIC, self._receive, QOS, in_rounds=False)

    @property
    def is_deaf(self) -> bool:
        """Whether messages do not reach the node any more."""
        return self.unheard >= UNHEARD_CHECKS

    def look(self, *, is_suspicious: bool) -> str:
        """Begin or end a check if it is time to; return in words what has turned out wrong, or nothing.

        Args:
            is_suspicious: whether something looks as if the node were deaf, so that a check is due soon.
        """
        heard = self.heard
        found = self._look(is_suspicious=is_suspicious)
        if found or self.heard > heard:
            self.problem = found
        return found

    def present(self) -> list[Present]:
        """Return what is wrong."""
        if self.unheard:
            return [Situation.UNHEARD.present(problem=self.problem)]
        return [Situation.NOT_CHECKED.present(problem=self.problem)] if self.problem else []

    def _look(self, *, is_suspicious: bool) -> str:
        if self._sender is None:
            return self._begin() if self._is_due(is_suspicious=is_suspicious) else ""
        self._node.empty(self._tokens)
        code = self._sender.poll()
        if code is None and time.monotonic() - self._begun < LONGEST_S:
            return ""
        if code is None:
            self.end()
            return f"the self-check could not be made, since its process does not end within {LONGEST_S:g} s"
        said = self._sender.communicate()[1].strip()
        self._sender, token, self._token = None, self._token, ""
        if not token:  # it was heard
            self.unheard = 0
            self.heard += 1
            return ""
        if code != 0:
            return f"the self-check could not be made, since its process ended with {code}: {said[-200:]}"
        self.unheard += 1
        return "a process that joined the domain sent a message, and it was not received"

    def end(self) -> None:
        """End a check that is under way."""
        if self._sender is not None:
            self._sender.kill()
            self._sender.communicate()
            self._sender = None

    def _is_due(self, *, is_suspicious: bool) -> bool:
        if self._period is None:
            return False
        wait = SOON_S if is_suspicious or self.unheard else self._period
        return time.monotonic() - self._begun >= min(wait, self._period)

    def _begin(self) -> str:
        """Begin a check; return why it cannot be made, or nothing."""
        self._begun = time.monotonic()
        self._token = uuid.uuid4().hex
        topic: str = self._node.resolve_topic_name(TOPIC)
        try:
            self._sender = subprocess.Popen(  # noqa: S603  our own
                [sys.executable, "-m", _SENDER, topic, self._token, str(self._node.context.get_domain_id())],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
                errors="replace",
            )
        except OSError as error:  # the machine has no room for a process, or Python is being replaced
            return f"the self-check could not be made: {error}"
        return ""

    def _receive(self, taken: Taken) -> None:
        try:
            message = deserialize_message(taken.data, KeyValue)
        except RuntimeError:  # bytes that are no message
            return
        if self._token and message.value == self._token:
            self._token = ""
            if self._sender is not None:
                self._sender.terminate()


FIND_S: Final = 10.0
"""s for which the node is looked for. A node that is not found is not reached either."""

SEND_S: Final = 3.0
_EVERY_S: Final = 0.1
_NICE: Final = 10


def main(topic: str, token: str, domain_id: int) -> None:
    """Send the token to a topic."""
    os.nice(_NICE)  # answers go first
    # Without a file of its own in ROS's log folder, which would have one more every minute.
    rclpy.init(args=["--ros-args", "--disable-external-lib-logs"], domain_id=domain_id)
    node = Node("_contact_dynamics_self_check", enable_rosout=False, start_parameter_services=False)
    publisher = node.create_publisher(KeyValue, topic, QOS)
    deadline = time.monotonic() + FIND_S
    while not publisher.get_subscription_count() and time.monotonic() < deadline:
        time.sleep(_EVERY_S)
    deadline = time.monotonic() + SEND_S
    while time.monotonic() < deadline:
        publisher.publish(KeyValue(key=KEY, value=token))
        time.sleep(_EVERY_S)
    rclpy.shutdown()


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
