"""Runs a node until its process is told to stop. Every node of this package has this part of `main`.

rclpy's own signal handlers end the context at once, so that messages which have come already cannot be taken
any more, and Python's raise `KeyboardInterrupt` wherever the process happens to be, also while it closes its
files. Here the signals that end a process set an event, however often they come. The node then stops serving,
takes what has come, and closes.

With the Fast DDS profile of our nodes, a killed process neither blocks nor delays the others. Messages come
in over UDP, also from the same machine. In shared memory, which is the default there, a process that was
killed can leave a lock behind that blocks whoever writes to it next, and others go on to write into its
memory for one to three seconds, also if a new process has its port by then.

They come in at a port that differs at each start. At the port of a killed process, which is the default,
others answer the new one a second later.

The node announces itself every `_ANNOUNCED_EVERY_S` instead of every three seconds. A restarted client mostly
misses the first announcement (`introductions.py` explains why) and gets no answer before the second.

Unacknowledged messages are announced again every `_ASKED_EVERY_S` instead of every three seconds. A restarted
client has the port of the killed one, so that it misses the first answers, and later ones wait for these.

A user's own profile takes the place of this one.
"""

from __future__ import annotations

import gc
import os
import signal
import tempfile
import threading
import time
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final, Protocol

import rclpy
from rclpy.exceptions import InvalidHandle, ParameterException
from rclpy.experimental import EventsExecutor
from rclpy.logging import get_logger
from rclpy.signals import SignalHandlerOptions

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.arguments import ros_arguments
from contact_dynamics.nodes.domain_ports import PORTS_OF_PARTICIPANT
from contact_dynamics.nodes.own_process import (
    ensure_ros_log_directory,
    keep_reserved_memory_untouched,
    never_wait_for_readers,
)
from contact_dynamics.questions.numpy_warnings import leave_out_numpy_warnings

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator


_SPIN_S: Final = 0.01
_DRAIN_S: Final = 0.2  # for messages that have come and are not taken yet when the node is told to stop


class RunnableNode(Protocol):
    """What a node needs to be run."""

    def end_services(self) -> None:
        """Take no more requests."""

    @property
    def successor(self) -> Callable[[], RunnableNode] | None:
        """What makes the node that takes over in a participant of its own, or None while none has to."""

    def destroy_node(self) -> None:
        """End the node."""

    def attend(self) -> None:
        """Do what is due between two callbacks; it is called at least a hundred times a second."""

    def close(self) -> bool:
        """Finish files and sinks, and return whether all of them are finished."""


def run_node(
    make_node: Callable[[list[str]], RunnableNode],
    *,
    verb: str,
    parser: argparse.ArgumentParser,
    arguments: list[str],
) -> int:
    """Run a node until it is told to stop, and return the exit code.

    The code is 0, or 1 if something could not be finished, or 2 for a configuration that is refused.

    Args:
        make_node: makes the node, and is given ROS's arguments. It may raise `ContactDynamicsError`,
            `OSError`, or what rclpy raises for its own parameters, such as `use_sim_time`.
        verb: the verb of the command line that the node is.
        parser: the parser of the verb's arguments.
        arguments: all that follows the verb.
    """
    args = ros_arguments(parser, arguments)
    never_wait_for_readers()
    ensure_ros_log_directory()
    keep_reserved_memory_untouched()
    leave_out_numpy_warnings()
    with stop_signals() as stop:
        try:
            rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        except RuntimeError as error:  # what rclpy raises for arguments and files that it cannot read
            get_logger(verb).fatal(f"configuration: {error}")
            return 2
        try:
            return _run(partial(make_node, args), args, verb, stop)
        finally:
            rclpy.try_shutdown()


@contextmanager
def stop_signals() -> Iterator[threading.Event]:
    """Yield an event that Ctrl-C, `kill` and a terminal that is closed set, until the context is left.

    For the main thread, and with ``rclpy.init(signal_handler_options=SignalHandlerOptions.NO)``.
    """
    stop = threading.Event()
    numbers = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # which is what nohup makes of it
        numbers.append(signal.SIGHUP)
    before = {number: signal.signal(number, lambda _number, _frame: stop.set()) for number in numbers}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _run(make_node: Callable[[], RunnableNode], args: list[str], verb: str, stop: threading.Event) -> int:
    complete = True
    while True:
        try:
            with profile_of_fast_dds():
                node = make_node()
        except (ContactDynamicsError, OSError, ParameterException) as error:
            get_logger(verb).fatal(f"configuration: {error}")
            return 2
        try:
            successor = _spin(node, stop)
        finally:
            complete = node.close() and complete
        if successor is None:
            return 0 if complete else 1
        get_logger(verb).error("messages do not reach this process any more, so it joins the domain anew")
        node.destroy_node()
        rclpy.shutdown()
        rclpy.init(args=args, signal_handler_options=SignalHandlerOptions.NO)
        make_node = successor


def _spin(node: RunnableNode, stop: threading.Event) -> Callable[[], RunnableNode] | None:
    """Spin a node until it is to stop, or until another one has to take over; return what makes that."""
    executor = EventsExecutor()
    executor.add_node(node)
    gc.freeze()  # the objects made so far stay, and to search them for garbage stalls an answer for 30 ms
    successor: Callable[[], RunnableNode] | None = None
    while not stop.is_set() and (successor := node.successor) is None:
        executor.spin_once(timeout_sec=_SPIN_S)
        node.attend()
    node.end_services()
    drained = time.monotonic() + _DRAIN_S
    while time.monotonic() < drained:
        with suppress(InvalidHandle):  # a request that came to one of these services before it was destroyed
            executor.spin_once(timeout_sec=0.1 * _DRAIN_S)
        node.attend()
    return successor


VARIABLE: Final = "FASTRTPS_DEFAULT_PROFILES_FILE"
_IN_THIS_FOLDER: Final = "DEFAULT_FASTRTPS_PROFILES.xml"

_ANNOUNCED_EVERY_S: Final = 0.5
"""s. 64 small messages a second to this machine, which take half a thousandth of a processor."""

_ASKED_EVERY_S: Final = 0.1
"""s. Only a writer some of whose messages are not confirmed asks."""

FIRST_OFFSET: Final = 101
"""Ports count from the first one of the domain. Below are those that Fast DDS chooses for 45 participants."""

PORTS: Final = 60
"""They are `PORTS_OF_PARTICIPANT` apart, and end so far below the next domain that ten further participants
find one."""

_PROFILE: Final = """<?xml version="1.0" encoding="UTF-8"?>
<profiles xmlns="http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles">
  <participant profile_name="contact_dynamics" is_default_profile="true">
    <rtps>
      <builtin>
        <discovery_config>
          <leaseAnnouncement><sec>0</sec><nanosec>{announced_every_ns}</nanosec></leaseAnnouncement>
        </discovery_config>
      </builtin>
      <defaultUnicastLocatorList><locator><udpv4/></locator></defaultUnicastLocatorList>
      <port><offsetd3>{offset}</offsetd3></port>
    </rtps>
  </participant>
  <data_writer profile_name="contact_dynamics_writer" is_default_profile="true">
    <times><heartbeatPeriod><sec>0</sec><nanosec>{asked_every_ns}</nanosec></heartbeatPeriod></times>
  </data_writer>
</profiles>
"""


@contextmanager
def profile_of_fast_dds() -> Iterator[None]:
    """Give participants that are made meanwhile the profile, unless the user has one.

    The environment is as before afterwards, so that processes that are started later do not inherit it.
    """
    if os.environ.get(VARIABLE) or Path(_IN_THIS_FOLDER).exists():
        yield
        return
    text = _PROFILE.format(
        offset=FIRST_OFFSET + PORTS_OF_PARTICIPANT * (int(time.monotonic()) % PORTS),
        announced_every_ns=round(NS_PER_S * _ANNOUNCED_EVERY_S),
        asked_every_ns=round(NS_PER_S * _ASKED_EVERY_S),
    )
    with ExitStack() as stack:
        with suppress(OSError):  # where no file can be written, Fast DDS goes by its own choice
            file = stack.enter_context(tempfile.NamedTemporaryFile("w", suffix=".xml"))
            file.write(text)
            file.flush()
            os.environ[VARIABLE] = file.name
            stack.callback(os.environ.pop, VARIABLE)
        yield
