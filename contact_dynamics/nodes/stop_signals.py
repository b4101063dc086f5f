"""How a node is told to stop: Ctrl-C and SIGTERM set an event, and whoever spins looks at it.

rclpy's own handlers end the context at once, so that messages which have come already cannot be taken any more, and
Python's raise `KeyboardInterrupt` wherever the process happens to be, also while it closes its files.
"""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def stop_signals() -> Iterator[threading.Event]:
    """Yield an event that SIGINT and SIGTERM set, as often as they come, until the context is left.

    For the main thread, and with ``rclpy.init(signal_handler_options=SignalHandlerOptions.NO)``.
    """
    stop = threading.Event()
    before = {
        number: signal.signal(number, lambda _number, _frame: stop.set())
        for number in (signal.SIGINT, signal.SIGTERM)
    }
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
