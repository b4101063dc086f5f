# SPDX-License-Identifier: Apache-2.0
"""Runs a node until its process is told to stop. Every node of this package has this part of `main`.

rclpy's own signal handlers end the context at once, so that messages which have come already cannot be taken
any more, and Python's raise `KeyboardInterrupt` wherever the process happens to be, also while it closes its
files. Here the signals that end a process set an event, however often they come. The node then stops serving,
takes what has come, and closes.
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
_DRAIN_S: Final = 0.2  # for messages that have come and are not taken yet when the node is told to stop


class RunnableNode(Protocol):
    """What a node needs to be run."""

    def end_services(self) -> None:
        """Take no more requests."""

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
    keep_reserved_memory_untouched()
    leave_out_numpy_warnings()
    with ExitStack() as stack:
        try:
            stop = stack.enter_context(ros_until_stopped(args))
        except RuntimeError as error:  # what rclpy raises for arguments and files that it cannot read
            get_logger(verb).fatal(f"configuration: {error}")
            return 2
        return _run(partial(make_node, args), verb, stop)


@contextmanager
def ros_until_stopped(arguments: list[str]) -> Iterator[threading.Event]:
    """Begin ROS with its arguments, and end it when the context is left; yield what `stop_signals` yields.

    Raises:
        RuntimeError: rclpy cannot read the arguments, or a file that they name.
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
    """Yield an event that Ctrl-C, `kill` and a terminal that is closed set, until the context is left.

    For the main thread, and with ``rclpy.init(signal_handler_options=SignalHandlerOptions.NO)``.
    """
    stop = threading.Event()
    numbers = [signal.SIGINT, signal.SIGTERM]
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # which is what nohup makes of it
        numbers.append(signal.SIGHUP)

    came: list[int] = []

    def end(number: int, _frame: object) -> None:
        if not came:  # otherwise a signal could wait for the event's lock, which the one before has
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
    """Return the executor that costs a third of the standard one, or that one where rclpy is too old."""
    try:
        from rclpy.experimental import EventsExecutor
    except ImportError:
        return SingleThreadedExecutor()
    return EventsExecutor()


def _spin(node: RunnableNode, stop: threading.Event) -> None:
    """Spin a node until it is to stop, and then take what has come."""
    executor = _fastest_executor()
    executor.add_node(node)
    gc.freeze()  # the objects made so far stay, and to search them for garbage stalls an answer for 30 ms
    while not stop.is_set():
        executor.spin_once(timeout_sec=_SPIN_S)
        node.attend()
    node.end_services()
    drained = time.monotonic() + _DRAIN_S
    while time.monotonic() < drained:
        with suppress(InvalidHandle):  # a request that came to one of these services before it was destroyed
            executor.spin_once(timeout_sec=0.1 * _DRAIN_S)
        node.attend()
