# SPDX-License-Identifier: Apache-2.0
"""What a visualizer that watches costs the services: round trips with it and without it, in turns.

One server is asked ten kinds of questions, in blocks at a steady rate. In every second block a visualizer
draws all answers into a file. A block is compared with that before it and that after it, so that a change of
the machine's speed affects both. The medians over the pairs are told, with their quartiles.

The target is that no difference can be measured: the quartiles of the ratios have 1 between them.
"""

from __future__ import annotations

import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
import time
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from benchmarks._quotes import quote
from benchmarks._service_calls import PATIENCE_S, ROOT, Asker, questions
from contact_dynamics.demo.processes import claim_domain

if TYPE_CHECKING:
    from collections.abc import Iterator

PAIRS = 10
ROUNDS = 20
"""How often each kind of question is asked in a block."""

RATE = 50.0
"""Hz of the questions. A visualizer draws each answer while nothing is asked."""


def run() -> None:
    """Measure and print."""
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ["ROS_DOMAIN_ID"] = str(claim_domain())
    parameters = ["--params-file", str(ROOT / "config" / "server.yaml")]
    with tempfile.TemporaryDirectory() as folder, _process("server", *parameters, log_directory=folder):
        rclpy.init()
        node = Node("benchmark")
        executor = SingleThreadedExecutor()
        executor.add_node(node)
        asked = [
            (Asker(node, executor, "contact_dynamics", name), request) for _, name, request in questions()
        ]
        _block(asked)  # the first answers take longer
        blocks = [_block(asked)]
        for pair in range(PAIRS):
            picture = f"{folder}/{pair}.rrd"
            with _process("visualizer", *parameters, rrd_path=picture):
                _block(asked)  # a visualizer's first drawings take longer
                blocks.append(_block(asked))
            drawn = Path(picture).stat().st_size
            blocks.append(_block(asked))
            print(f"pair {pair + 1} of {PAIRS}: {drawn / 1e6:.1f} MB drawn", flush=True)
        rclpy.shutdown()
    _tell(blocks)


def _block(asked: list[tuple[Asker, object]]) -> list[float]:
    """Ask each question some times at the rate, and return the round trips, ms."""
    for asker, _ in asked:
        asker.trips.clear()
    due = time.perf_counter()
    for _ in range(ROUNDS):
        for asker, request in asked:
            due += 1.0 / RATE
            time.sleep(max(0.0, due - time.perf_counter()))
            asker.ask(request)
    return [trip for asker, _ in asked for trip in asker.trips]


def _tell(blocks: list[list[float]]) -> None:
    """Print medians of blocks, of which every second one was watched."""
    for title, figure in (("p50", statistics.median), ("p90", _p90)):
        figures = [figure(block) for block in blocks]
        alone, watched = figures[::2], figures[1::2]
        ratios = [
            seen / statistics.mean(beside) for seen, beside in zip(watched, pairwise(alone), strict=True)
        ]
        low, middle, high = statistics.quantiles(ratios, n=4)
        print(
            f"{title}: {statistics.median(alone):.2f} ms alone, {statistics.median(watched):.2f} ms watched; "
            f"ratio {middle:.3f}, quartiles {low:.3f} to {high:.3f}"
        )
        quote(f"watched.{title}", middle, digits=3)


def _p90(times: list[float]) -> float:
    return statistics.quantiles(times, n=10)[8]


@contextlib.contextmanager
def _process(verb: str, *arguments: str, **parameters: str) -> Iterator[None]:
    """Run a verb of the command line until the block ends, from when it says that it is ready."""
    command = [sys.executable, "-m", "contact_dynamics", verb, *arguments, "--ros-args"]
    for name, value in parameters.items():
        command += ["-p", f"{name}:={value}"]
    process = subprocess.Popen(  # noqa: S603  our own
        command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert process.stdout is not None
    try:
        if not any("ready" in line for line in iter(process.stdout.readline, "")):
            raise RuntimeError(f"the {verb} ended before it was ready")
        yield
    finally:
        process.terminate()
        process.communicate(timeout=PATIENCE_S)
