# SPDX-License-Identifier: Apache-2.0
"""Takes the pictures of the viewer in docs/: `python scripts/viewer_pictures.py [NAME ...]`.

rerun's own viewer opens recordings without a window and is asked for screenshots. It needs a Vulkan driver.
Without a graphics card, `apt-get install mesa-vulkan-drivers` brings one that draws on the processor.

`demo` plays the demo, which needs what `make setup` installs. The others ask in Python.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from rerun.experimental import ViewerClient

from contact_dynamics import Body, BodyState, ContactSet, Surface, World, free_motion, inertia
from contact_dynamics.constants import ns_after
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import (
    ContactModeQuestion,
    Context,
    Problem,
    TossQuestion,
    TossSampling,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    ask,
)
from contact_dynamics.shapes import box
from contact_dynamics.toss import TossUncertainty
from contact_dynamics.viewing import view
from contact_dynamics.viewing.viewer_process import LOCAL, local_url, viewer_executable

DOCS = Path(__file__).parents[1] / "docs"
PORT = 9877
WIDTH, HEIGHT = 1200, 676  # points
TOP, BOTTOM = 37, 30  # points: the viewer's menu, and the panel of times

START_NS = 1_760_000_000_000_000_000
ASKED = 20  # the recorded state that the whole toss is predicted from
TIMELINE = "time since start"
SLOWER = 4.0  # the moving picture, than the toss
FRAMES_PER_S = 12.0
BEGIN_S, END_S = 0.08, 1.5  # the part of the toss that it shows: the first prediction is made before it
LAST_FRAME_MS = 2000
MAX_BYTES = 3_000_000


class Viewer:
    """rerun's viewer with one recording."""

    def __init__(self, client: ViewerClient, recording: Path) -> None:
        """Open a recording, and wait until all of it is there."""
        self._client = client
        opened = client.open(str(recording))
        while opened.loading:
            time.sleep(0.1)
            opened = client.open(str(recording))

    def show_page(self, name: str) -> None:
        """Bring a page to the front."""
        all_of_it = self._client.get_blueprint().blueprint
        root = f"container/{all_of_it['/viewport']['ViewportBlueprint']['root_container']}"
        in_use = _reachable(all_of_it, root)
        # What earlier arrangements left behind is dropped: with it the request is too long for the viewer.
        found = {
            path: parts
            for path, parts in all_of_it.items()
            if not path.startswith(("/container", "/view/")) or "/".join(path.split("/")[1:3]) in in_use
        }
        pages = found[f"/{root}"]["ContainerBlueprint"]
        (pages["active_tab"],) = (
            page
            for page in pages["contents"]
            if found[f"/{page}"]["ContainerBlueprint"].get("display_name") == name
        )
        self._client.set_blueprint(found, "recording")

    def picture(self, seconds: float) -> Image.Image:
        """Return what it shows so many s after the start, without its menu and its panel of times."""
        self._client.set_time(TIMELINE, duration=seconds, play_state="paused")
        time.sleep(0.15)  # it draws before it takes the picture, but labels settle one frame later
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "shown.png"
            self._client.save_screenshot(str(path))
            shown = Image.open(path).convert("RGB")
        return shown.crop((0, TOP, shown.width, shown.height - BOTTOM))


def _reachable(blueprint: dict[str, Any], path: str) -> set[str]:
    """Return a container or a view, and all that it holds."""
    contents = blueprint.get(f"/{path}", {}).get("ContainerBlueprint", {}).get("contents", [])
    held = [contents] if isinstance(contents, str) else contents
    return {path}.union(*(_reachable(blueprint, each) for each in held))


@contextmanager
def viewer(recording: Path) -> Iterator[Viewer]:
    """Yield the viewer with a recording."""
    process = subprocess.Popen(
        [
            *(viewer_executable(), "--headless", "--bind", LOCAL, "--port", str(PORT)),
            *("--window-size", f"{WIDTH}x{HEIGHT}", "--hide-welcome-screen"),
        ],
        env={**os.environ, "RERUN_APP_ONLY": "true", "RUST_LOG": "error"},
    )
    try:
        deadline = time.monotonic() + 30.0
        while True:
            try:
                client = ViewerClient.connect(local_url(PORT))
                client.get_state()
                break
            except (ConnectionError, RuntimeError, ValueError):
                if process.poll() is not None or time.monotonic() > deadline:
                    raise
                time.sleep(0.2)
        yield Viewer(client, recording)
    finally:
        process.terminate()
        process.wait()


def demo(folder: Path) -> None:
    """Draw the moving picture of the README, and the page of the first impact."""
    command = [
        str(Path(sys.executable).parent / "contact-dynamics"),
        "demo",
        "--quiet",
        "--output",
        str(folder),
    ]
    subprocess.run(command, check=True)
    (recording,) = folder.glob("*/toss.rrd")
    with viewer(recording) as shown:
        count = round((END_S - BEGIN_S) * SLOWER * FRAMES_PER_S)
        frames = [shown.picture(seconds) for seconds in np.linspace(BEGIN_S, END_S, count)]
        shown.show_page("Impact")
        save(shown.picture(0.47), "viewer_impact.png")
    durations = [round(1000.0 / FRAMES_PER_S)] * (count - 1) + [LAST_FRAME_MS]
    path = DOCS / "demo.webp"
    frames[0].save(
        path, save_all=True, append_images=frames[1:], duration=durations, loop=0, quality=60, method=6
    )
    if path.stat().st_size > MAX_BYTES:
        message = f"{path} must have at most {MAX_BYTES} bytes, got {path.stat().st_size}"
        raise ValueError(message)


def contact_modes(folder: Path) -> None:
    """Draw a block that leans on the rim of a tilted tray, as in launch/tray.launch.py."""
    size = (0.08, 0.08, 0.06)
    block = Body(
        name="block", mass_properties=inertia.box(size=size, mass=1.0).mass_properties, shape=box(size=size)
    )
    base = Surface(name="base", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.0)
    rim = Surface(name="rim", p_WS_W=[0.15, 0, 0], normal_W=[-1, 0, 0], friction=0.3, restitution=0.0)
    leans = BodyState(p_WB_W=[0.11, 0, 0.03], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=[0, 0, 0])
    touching = ContactSet(
        p_WC_W=[[0.07, 0, 0], [0.15, 0, 0], [0.15, 0, 0], [0.15, 0, 0.06]],
        normals_W=[[0, 0, 1], [0, 0, 1], [-1, 0, 0], [-1, 0, 0]],
        frictions=0.3,
    )
    tilt = np.radians(25.0)
    question = ContactModeQuestion(
        body=block,
        state=at(leans, 0.0),
        contacts=touching,
        gravity_W=9.81 * np.array([np.sin(tilt), 0.0, -np.cos(tilt)]),
        problem=Problem.PLANAR,
        plane=PlaneOfMotion(normal_W=[0.0, -1.0, 0.0]),
        include_margins=True,
        include_wrenches=True,
    )
    world = World(bodies=(block,), surfaces=(base, rim))
    path, motion = folder / "picture.rrd", [at(leans, k / 100.0) for k in range(10)]
    view(world, [ask(question, Context(world=world))], motions={"block": motion}, path=path)
    with viewer(path) as shown:
        shown.show_page("Contact modes")
        save(shown.picture(0.09), "viewer_contact_modes.png")


def toss(folder: Path) -> None:
    """Draw where the demo's brick may come to rest, as predicted while it falls."""
    recorded = read_toss()
    world = World(bodies=(recorded.body,), surfaces=(recorded.surface,))
    deviations = (recorded.position_noise, recorded.orientation_noise)
    rates = (recorded.velocity_noise, recorded.angular_velocity_noise)
    known = UncertainState(
        state=at(recorded.state(ASKED), 0.0), covariance=np.diag(np.repeat([*deviations, *rates], 3) ** 2)
    )
    uncertainty = TossUncertainty(velocity=0.02, spin=0.4, height=0.001)
    question = TossQuestion(
        body=recorded.body,
        state=known,
        sampling=TossSampling(count=80, to_rest=True, uncertainty=uncertainty),
    )

    states = [at(recorded.state(k), (k - ASKED) / recorded.rate) for k in range(ASKED + 70)]
    path, answer = folder / "picture.rrd", ask(question, Context(world=world))
    view(world, [answer], motions={recorded.body.name: states}, path=path)
    with viewer(path) as shown:
        shown.show_page("Toss")
        save(shown.picture((ASKED + 69) / recorded.rate), "viewer_toss.png")


def twenty(folder: Path) -> None:
    """Draw the overview with twenty bricks in flight."""
    size = (0.15, 0.09, 0.05)
    mass_properties = inertia.box(size=size, mass=0.4).mass_properties
    bricks = [
        Body(name=f"brick_{i}", mass_properties=mass_properties, shape=box(size=size)) for i in range(20)
    ]
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.45)
    world = World(bodies=tuple(bricks), surfaces=(floor,))

    noise = np.random.default_rng(0)
    answers, motions = [], {}
    for i, brick in enumerate(bricks):
        place = [0.5 * (i % 5), 0.5 * (i // 5), 0.9]
        thrown = BodyState(p_WB_W=place, q_WB=[0, 0, 0, 1], v_WB_W=[0.2, 0.1, 0], w_WB_W=[3, 8, 0.1 * i])
        motion = free_motion(mass_properties, thrown)
        seen = [at(motion.state_at(k / 250.0), k / 250.0) for k in range(60)]
        seen = [replace(one, p_WB_W=one.p_WB_W + noise.normal(0.0, 3e-4, 3)) for one in seen]
        motions[brick.name] = seen
        question = TumblingQuestion(body=brick, state=seen[0], sampling=UntilContact())
        answers.append(ask(question, Context(world=world)))
    path = folder / "picture.rrd"
    view(world, answers, motions=motions, path=path, surface_side=4.0)
    with viewer(path) as shown:
        save(shown.picture(0.236), "viewer_twenty.png")


def at(state: BodyState, seconds: float) -> BodyState:
    """Return a state with a stamp so many s after the start."""
    return replace(state, stamp_ns=ns_after(START_NS, seconds))


def save(picture: Image.Image, name: str) -> None:
    """Save a picture with 256 colours, which is a third of the size."""
    picture.quantize(256, dither=Image.Dither.NONE).save(DOCS / name, optimize=True)


PICTURES: dict[str, Callable[[Path], None]] = {
    each.__name__: each for each in (demo, contact_modes, toss, twenty)
}


def main() -> None:
    """Draw the pictures that are named, or all."""
    parser = argparse.ArgumentParser(description="Take the pictures of the viewer in docs/.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}; default: all")
    for name in parser.parse_args().names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            PICTURES[name](Path(folder))


if __name__ == "__main__":
    main()
