# SPDX-License-Identifier: Apache-2.0
"""The memory and the work of the visualizer's drawing: 20 bodies at 250 Hz, and 20 questions a second.

The states of bodies that are thrown again and again, and answers of each kind about them, are drawn as the
visualizer draws them, at the pace that it would keep: into files that follow each other, and into what is
served, whose memory is limited. They come as fast as they can be drawn, so that an hour of the picture takes
less. With `--viewer`, rerun's viewer without a window looks at what is served, and its memory is told too.

The work is told in shares of one processor: of the drawing of states and of answers, which is the
visualizer's own, and of rerun's threads, which write and serve. What the benchmark itself needs for states
and answers is told apart.

The memory grows until all limits are reached: those of what is served and of what is kept for a viewer that
comes back. So the last half tells whether it grows for good.
`python -m benchmarks.pictures --seconds 3600` draws an hour.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import resource
import subprocess
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.constants import ns_after
from contact_dynamics.questions import (
    ContactModeQuestion,
    Context,
    ImpactQuestion,
    TumblingQuestion,
    UntilContact,
    ask,
)
from contact_dynamics.shapes import box
from contact_dynamics.tumbling import free_motion
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode
from contact_dynamics.viewing.states_in_turn import StatesInTurn
from contact_dynamics.viewing.viewer_process import LOCAL, local_url, viewer_executable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.questions.services import Answer

BODIES = 20
RATE = 250
QUESTIONS = 20  # a second
FLIGHT = 100  # states
SECONDS = 300.0
PARTS = 10
SERVED = "64MB"
FILE_SIZE = 20_000_000
FILES = 3
PORT = 9877
START_NS = 1_760_000_000_000_000_000

BRICK = MassProperties(mass=0.4, I_B=np.diag([0.000353333, 0.000833333, 0.00102]))
SIZE = (0.15, 0.09, 0.05)
FLOOR = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
WORLD = World(
    bodies=tuple(Body(name=f"brick_{i}", mass_properties=BRICK, shape=box(size=SIZE)) for i in range(BODIES)),
    surfaces=(FLOOR,),
)
KNOWN = Context(world=WORLD)


def run(seconds: float = SECONDS, *, with_viewer: bool = False) -> None:
    """Draw and print."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        sinks = Sinks(
            rrd_path=str(Path(folder) / "picture.rrd"),
            rrd_size=FILE_SIZE,
            rrd_files=FILES,
            viewer=ViewerMode.SERVE,
            port=PORT,
            memory=SERVED,
        )
        recording = OpenRecording(sinks, on_problem=print)
        viewer = stack.enter_context(_viewer()) if with_viewer else None
        drawing = _Drawing(Picture(recording.stream, WORLD, surface_side=4.0))
        marks = []  # s drawn, memory of each process, MB
        begin, began = _Work(), time.monotonic()
        while drawing.seconds < seconds:
            drawing.portion()
            recording.tend()
            if drawing.seconds >= (len(marks) + 1) / PARTS * seconds:
                recording.stream.flush()
                used = [_megabytes(pid) for pid in (os.getpid(), viewer) if pid is not None]
                marks.append((drawing.seconds, used))
                print(
                    f"after {marks[-1][0]:.0f} s: {' and '.join(f'{mb:.0f} MB' for mb in used)}", flush=True
                )
        took, work = time.monotonic() - began, _Work()
        recording.close()
        files = sorted(path.stat().st_size for path in Path(folder).iterdir())
    half = marks[PARTS // 2 :]
    drawn = np.array([mark[0] for mark in half])
    slopes = [3600.0 * np.polyfit(drawn, [mark[1][k] for mark in half], 1)[0] for k in range(len(half[0][1]))]
    rerun = (work.process - begin.process) - (work.thread - begin.thread)
    own = work.thread - begin.thread - drawing.for_states - drawing.for_answers
    shares = [part / drawing.seconds for part in (drawing.for_states, drawing.for_answers, rerun, own)]
    print(f"{len(files)} files of at most {1e-6 * files[-1]:.0f} MB; states drawn at {drawing.rate:.1f} Hz")
    print(
        "of a processor in real time: states {:.2f}, answers {:.2f}, rerun's threads {:.2f}; "
        "apart from that, the benchmark's own {:.2f}".format(*shares)
    )
    print(f"{drawing.seconds:.0f} s of the picture took {took:.0f} s")
    print(
        f"the memory grows by {' and '.join(f'{slope:+.0f} MB' for slope in slopes)} an hour in the last half"
    )


class _Work:
    """Processor seconds up to now, of all threads and of this one."""

    def __init__(self) -> None:
        self.process = time.process_time()
        self.thread = time.thread_time()


class _Drawing:
    """Draws states and answers in the order in which the visualizer would."""

    def __init__(self, picture: Picture) -> None:
        self.for_states = self.for_answers = 0.0  # processor seconds
        self._picture = picture
        self._states = StatesInTurn(picture, guarded=lambda _, draw: draw())
        self._flights = {body.name: _flight(i) for i, body in enumerate(WORLD.bodies)}
        self._count = 0  # each body has had so many states
        self._asked = 0
        self._portions = 0

    @property
    def seconds(self) -> float:
        return self._count / RATE

    @property
    def rate(self) -> float:
        return self._portions / self.seconds

    def portion(self) -> None:
        """Draw what comes until the visualizer would draw the next time."""
        until = self._count + max(1, round(self._states.pace.wait_s * RATE))
        while self._count < until:
            for name, flight in self._flights.items():
                stamp_ns = ns_after(START_NS, self.seconds)
                self._states.add(name, replace(flight[self._count % FLIGHT], stamp_ns=stamp_ns))
            self._count += 1
            if self._asked < self.seconds * QUESTIONS:
                self._answer()
        began = time.thread_time()
        self._states.draw()
        self.for_states += time.thread_time() - began
        self._portions += 1

    def _answer(self) -> None:
        """Ask about the newest state of a body, and draw the answer."""
        name = WORLD.bodies[self._asked % BODIES].name
        stamp_ns = ns_after(START_NS, (self._count - 1) / RATE)
        state = replace(self._flights[name][(self._count - 1) % FLIGHT], stamp_ns=stamp_ns)
        kind = self._asked // BODIES % 3
        self._asked += 1
        if kind == 0:
            question = TumblingQuestion(body=name, state=state, sampling=UntilContact(), curve_points=100)
            self._show(ask(question, KNOWN))
        elif kind == 1:
            self._show(ask(ImpactQuestion(body=name, state=state), KNOWN))
        else:
            resting = BodyState(
                p_WB_W=[*state.p_WB_W[:2], 0.5 * SIZE[2]],
                q_WB=[0, 0, 0, 1],
                v_WB_W=[0, 0, 0],
                w_WB_W=[0, 0, 0],
                stamp_ns=stamp_ns,
            )
            modes = ask(ContactModeQuestion(body=name, state=resting), KNOWN)
            self._show(modes)

    def _show(self, answer: Answer) -> None:
        began = time.thread_time()
        self._states.draw_before(answer)
        self._picture.show(answer)
        self.for_answers += time.thread_time() - began


def _flight(number: int) -> list[BodyState]:
    """Return the states of one flight of a body, at the rate."""
    thrown = BodyState(
        p_WB_W=[0.5 * (number % 5), 0.5 * (number // 5), 0.9],
        q_WB=[0, 0, 0, 1],
        v_WB_W=[0.2, 0.1, 0.0],
        w_WB_W=[3, 8, 0.1 * number],
    )
    path = free_motion(BRICK, thrown).at(np.arange(FLIGHT) / RATE)
    rows = zip(path.p_WB_W, path.q_WB, path.v_WB_W, path.w_WB_W, strict=True)
    return [BodyState(p_WB_W=p, q_WB=q, v_WB_W=v, w_WB_W=w) for p, q, v, w in rows]


@contextlib.contextmanager
def _viewer() -> Iterator[int]:
    command = [
        viewer_executable(),
        "--headless",
        "--bind",
        LOCAL,
        "--port",
        str(PORT + 1),
        "--memory-limit",
        "500MB",
    ]
    process = subprocess.Popen(  # noqa: S603  rerun's own program
        [*command, "--connect", local_url(PORT)],
        env={**os.environ, "RERUN_APP_ONLY": "true"},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield process.pid
    finally:
        process.kill()
        process.wait()


def _megabytes(pid: int) -> float:
    pages = int(Path(f"/proc/{pid}/statm").read_text(encoding="ascii").split()[1])
    return 1e-6 * pages * resource.getpagesize()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--seconds", type=float, default=SECONDS, help=f"of the picture (default {SECONDS:g})"
    )
    parser.add_argument("--viewer", action="store_true", help="with rerun's viewer, whose memory is told too")
    given = parser.parse_args()
    run(given.seconds, with_viewer=given.viewer)
