# SPDX-License-Identifier: Apache-2.0
"""Runs a node until a signal stops its process. All nodes of this package share this part of `main`.

rclpy's own signal handlers end the context at once, so received messages can no longer be taken. Python's
handler raises `KeyboardInterrupt` anywhere, even while files are closed. Here, the signals that end a process
set an event. The node then stops serving, takes the received messages, and closes.
"""

from __future__ import annotations

import gc
import signal
import threading
import time
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Final, Protocol

import rclpy
from rclpy.exceptions import InvalidHandle, ParameterException
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.logging import get_logger
from rclpy.signals import SignalHandlerOptions

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.arguments import ros_arguments
from contact_dynamics.nodes.fast_dds import profile_of_fast_dds
from contact_dynamics.nodes.own_process import (
    ensure_ros_log_directory,
    keep_reserved_memory_untouched,
    never_wait_for_readers,
)
from contact_dynamics.questions.extent import leave_out_numpy_warnings

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator


_SPIN_S: Final = 0.01
_DRAIN_S: Final = 0.2  # for received messages that are not taken yet when the node stops


class RunnableNode(Protocol):
    """The methods that `run_node` requires of a node."""

    def end_services(self) -> None:
        """Remove the services."""

    def destroy_node(self) -> None:
        """Destroy the node."""

    def attend(self) -> None:
        """Do periodic work. It is called between callbacks, at least a hundred times per second."""

    def close(self) -> bool:
        """Finish files and sinks, and return whether all could be finished."""


def run_node(
    make_node: Callable[[list[str]], RunnableNode],
    *,
    verb: str,
    parser: argparse.ArgumentParser,
    arguments: list[str],
) -> int:
    """Run a node until a signal stops it, and return the exit code.

    The code is 0, or 1 if a file could not be finished, or 2 if the configuration is invalid.

    Args:
        make_node: creates the node from ROS's arguments. It may raise `ContactDynamicsError`, `OSError`, or
            the errors of rclpy for its own parameters, such as `use_sim_time`.
        verb: the node's verb of the command line.
        parser: the parser of the verb's arguments.
        arguments: the arguments after the verb.
    """
    args = ros_arguments(parser, arguments)
    never_wait_for_readers()
    keep_reserved_memory_untouched()
    leave_out_numpy_warnings()
    with ExitStack() as stack:
        try:
            stop = stack.enter_context(ros_until_stopped(args))
        except RuntimeError as error:  # rclpy cannot read the arguments or a file
            get_logger(verb).fatal(f"configuration: {error}")
            return 2
        return _run(partial(make_node, args), verb, stop)


@contextmanager
def ros_until_stopped(arguments: list[str]) -> Iterator[threading.Event]:
    """Initialize ROS with its arguments, and shut it down at the end; yield the event of `stop_signals`.

    Raise `RuntimeError` if rclpy cannot read the arguments, or a file that they name.
    """
    ensure_ros_log_directory()
    with stop_signals() as stop:
        rclpy.init(args=arguments, signal_handler_options=SignalHandlerOptions.NO)
        try:
            yield stop
        finally:
            rclpy.try_shutdown()


@contextmanager
def stop_signals() -> Iterator[threading.Event]:
    """Yield an event that is set by Ctrl-C, `kill` and a closed terminal.

    It must be used in the main thread, with ``rclpy.init(signal_handler_options=SignalHandlerOptions.NO)``.
    """
    stop = threading.Event()
    numbers = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # as nohup sets it
        numbers.append(signal.SIGHUP)

    came: list[int] = []

    def end(number: int, _frame: object) -> None:
        if not came:  # a second signal would wait for the event's lock, which the first one has
            came.append(number)
            stop.set()

    before = {number: signal.signal(number, end) for number in numbers}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _run(make_node: Callable[[], RunnableNode], verb: str, stop: threading.Event) -> int:
    try:
        with profile_of_fast_dds():
            node = make_node()
    except (ContactDynamicsError, OSError, ParameterException) as error:
        get_logger(verb).fatal(f"configuration: {error}")
        return 2
    complete = False
    try:
        _spin(node, stop)
    finally:
        complete = node.close()
    return 0 if complete else 1


def _fastest_executor() -> Executor:
    """Return the events executor, which costs a third of the standard one, or that one if it is missing."""
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def _spin(node: RunnableNode, stop: threading.Event) -> None:
    """Spin a node until it is stopped, and then take the received messages."""
    executor = _fastest_executor()
    executor.add_node(node)
    gc.freeze()  # to search the objects of all modules for garbage would stall an answer for 30 ms
    while not stop.is_set():
        executor.spin_once(timeout_sec=_SPIN_S)
        node.attend()
    node.end_services()
    drained = time.monotonic() + _DRAIN_S
    while time.monotonic() < drained:
        with suppress(InvalidHandle):  # a request to one of the removed services
            executor.spin_once(timeout_sec=0.1 * _DRAIN_S)
        node.attend()
