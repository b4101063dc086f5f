"""Serves rerun's web viewer, for a browser on this machine.

The executable of rerun does it, as a process of its own. rerun's library would serve it to the whole network.
"""

from __future__ import annotations

import os
import subprocess
from typing import TYPE_CHECKING, Final
from urllib.parse import quote

from contact_dynamics.viewing.ports import LOCAL, serving_problem
from contact_dynamics.viewing.viewer_process import viewer_executable

if TYPE_CHECKING:
    from collections.abc import Callable

_END_S: Final = 2.0


class WebViewer:
    """A web viewer at a port of this machine, that looks at what is served at a URL."""

    def __init__(self, port: int, url: str, *, on_problem: Callable[[str], object]) -> None:
        """Serve it. If that is not possible, a message says so, and ``address`` is empty."""
        self.address = ""
        self._process: subprocess.Popen[bytes] | None = None
        problem = serving_problem(port)
        try:
            if not problem:
                self._process = subprocess.Popen(  # noqa: S603  rerun's own program
                    [
                        viewer_executable(),
                        "--serve-web",
                        "--bind",
                        LOCAL,
                        "--web-viewer-port",
                        str(port),
                        url,
                    ],
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    env={**os.environ, "RERUN_APP_ONLY": "true"},
                )
        except OSError as error:
            problem = str(error)
        if problem:
            on_problem(f"the web viewer is not served at port {port}: {problem}")
        else:
            # Words are chosen for rerun's dark look, which the native viewer has.
            self.address = f"http://{LOCAL}:{port}/?url={quote(url, safe='')}&theme=dark"

    def close(self) -> None:
        """Serve it no longer."""
        if self._process is not None:
            self._process.terminate()
            try:
                self._process.wait(_END_S)
            except subprocess.TimeoutExpired:
                self._process.kill()
