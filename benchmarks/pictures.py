"""The memory and the work of the visualizer's drawing: 20 bodies at 250 Hz, and 20 questions a second.

The states of bodies that are thrown again and again, and answers of each kind about them, are drawn as the
visualizer draws them, in portions of 50 ms: into files that follow each other, and into what is served, whose
memory is limited. They come as fast as they can be drawn, so that minutes of the picture take less. With
`--viewer`, rerun's viewer without a window looks at what is served, and its memory is told too.

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
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics import Body, BodyState, MassProperties, Surface, World
from contact_dynamics.constants import ns_after
from contact_dynamics.questions import (
    ContactModeQuestion,
    ImpactQuestion,
    Knowledge,
    TumblingQuestion,
    UntilContact,
    ask,
)
from contact_dynamics.shapes import box
from contact_dynamics.tumbling import free_motion
from contact_dynamics.viewing.picture import Picture
from contact_dynamics.viewing.ports import LOCAL, local_url
from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode
from contact_dynamics.viewing.viewer_process import viewer_executable

if TYPE_CHECKING:
    from collections.abc import Iterator

BODIES = 20
RATE = 250
PORTION_S = 0.05  # as the visualizer draws
FLIGHT_S = 0.4
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
KNOWN = Knowledge(world=WORLD)


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
        picture = Picture(recording.stream, WORLD, surface_side=4.0)
        marks = []  # s drawn, processor seconds, memory of each process, MB
        portions = round(seconds / PORTION_S)
        for i in range(portions):
            _draw(picture, i)
            recording.tend()
            if (i + 1) % (portions // PARTS) == 0:
                recording.stream.flush()
                used = [_megabytes(pid) for pid in (os.getpid(), viewer) if pid is not None]
                marks.append(((i + 1) * PORTION_S, time.process_time(), used))
                print(
                    f"after {marks[-1][0]:.0f} s: {' and '.join(f'{mb:.0f} MB' for mb in used)}", flush=True
                )
        recording.close()
        files = sorted(path.stat().st_size for path in Path(folder).iterdir())
    half = marks[PARTS // 2 :]
    drawn = np.array([mark[0] for mark in half])
    slopes = [3600.0 * np.polyfit(drawn, [mark[2][k] for mark in half], 1)[0] for k in range(len(half[0][2]))]
    load = (marks[-1][1] - marks[0][1]) / (marks[-1][0] - marks[0][0])
    print(f"{len(files)} files of at most {1e-6 * files[-1]:.0f} MB; {load:.2f} cores' work in real time")
    print(
        f"the memory grows by {' and '.join(f'{slope:+.0f} MB' for slope in slopes)} an hour in the last half"
    )


def _draw(picture: Picture, portion: int) -> None:
    """Draw a portion of states of each body, and an answer about one of them."""
    begin = portion * PORTION_S
    flight = int(begin / FLIGHT_S + 1e-9)
    times = begin - flight * FLIGHT_S + np.arange(0.0, PORTION_S - 1e-9, 1.0 / RATE)
    states = {}
    for i, body in enumerate(WORLD.bodies):
        thrown = BodyState(
            p_WB_W=[0.5 * (i % 5), 0.5 * (i // 5), 0.9],
            q_WB=[0, 0, 0, 1],
            v_WB_W=[0.2, 0.1, 0.0],
            w_WB_W=[3, 8, 0.1 * i],
        )
        path = free_motion(BRICK, thrown).at(times)
        stamps_ns = [ns_after(START_NS, flight * FLIGHT_S + t) for t in times.tolist()]
        rows = zip(path.p_WB_W, path.q_WB, path.v_WB_W, path.w_WB_W, stamps_ns, strict=True)
        states[body.name] = [
            BodyState(p_WB_W=p, q_WB=q, v_WB_W=v, w_WB_W=w, stamp_ns=stamp_ns)
            for p, q, v, w, stamp_ns in rows
        ]
        picture.add_states(body.name, states[body.name])
    name = WORLD.bodies[portion % BODIES].name
    state = states[name][-1]
    kind = portion // BODIES % 3
    if kind == 0:
        question = TumblingQuestion(body=name, state=state, sampling=UntilContact(), curve_points=100)
        picture.show_tumbling(ask(question, KNOWN))
    elif kind == 1:
        picture.show_impact(ask(ImpactQuestion(body=name, state=state), KNOWN))
    else:
        resting = BodyState(
            p_WB_W=[*state.p_WB_W[:2], 0.5 * SIZE[2]],
            q_WB=[0, 0, 0, 1],
            v_WB_W=[0, 0, 0],
            w_WB_W=[0, 0, 0],
            stamp_ns=state.stamp_ns,
        )
        picture.show_contact_modes(ask(ContactModeQuestion(body=name, state=resting), KNOWN))


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
