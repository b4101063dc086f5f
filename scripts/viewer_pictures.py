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
from pathlib import Path
from typing import Any

from PIL import Image
from rerun.experimental import ViewerClient

from contact_dynamics.viewing.ports import LOCAL, local_url
from contact_dynamics.viewing.viewer_process import viewer_executable

DOCS = Path(__file__).parents[1] / "docs"
PORT = 9877
WIDTH, HEIGHT = 1200, 676  # points
TOP, BOTTOM = 37, 30  # points: the viewer's menu, and the panel of times

TIMELINE = "time since start"
SLOWER = 4.0  # the moving picture, than the toss
FRAMES_PER_S = 12.0
TOSS_S = 1.5  # s of the toss that it shows
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
        count = round(TOSS_S * SLOWER * FRAMES_PER_S)
        frames = [shown.picture(TOSS_S * (i + 1) / count) for i in range(count)]
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


def save(picture: Image.Image, name: str) -> None:
    """Save a picture with 256 colours, which is a third of the size."""
    picture.quantize(256, dither=Image.Dither.NONE).save(DOCS / name, optimize=True)


PICTURES: dict[str, Callable[[Path], None]] = {"demo": demo}


def main() -> None:
    """Draw the pictures that are named, or all."""
    parser = argparse.ArgumentParser(description="Take the pictures of the viewer in docs/.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(PICTURES)}; default: all")
    for name in parser.parse_args().names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            PICTURES[name](Path(folder))


if __name__ == "__main__":
    main()
