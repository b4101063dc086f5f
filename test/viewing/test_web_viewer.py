# SPDX-License-Identifier: Apache-2.0
"""rerun's web viewer beside what is served."""

from __future__ import annotations

import http.client
import time
from pathlib import Path
from typing import TYPE_CHECKING

from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode, WebViewer
from contact_dynamics.viewing.viewer_process import LOCAL, connection_problem, serving_problem

if TYPE_CHECKING:
    from collections.abc import Iterator

PATIENCE_S = 120.0


def page(port: int) -> bytes:
    """What a browser gets, as soon as something listens."""
    deadline = time.monotonic() + PATIENCE_S
    while connection_problem(LOCAL, port):
        assert time.monotonic() < deadline
        time.sleep(0.05)
    connection = http.client.HTTPConnection(LOCAL, port, timeout=PATIENCE_S)
    connection.request("GET", "/")
    content = connection.getresponse().read()
    connection.close()
    return content


def listeners(port: int) -> Iterator[str]:
    listening = f":{port:04X} 00000000:0000 0A"
    for kind in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{kind}").read_text(encoding="ascii").splitlines():
            if listening in line:
                yield line.split()[1]


def test_a_browser_of_this_machine_finds_it_until_it_is_closed(free_port: int) -> None:
    problems: list[str] = []
    served = "rerun%2Bhttp%3A%2F%2F127.0.0.1%3A1%2Fproxy"
    web = WebViewer(free_port, "rerun+http://127.0.0.1:1/proxy", on_problem=problems.append)
    try:
        assert web.address == f"http://{LOCAL}:{free_port}/?url={served}&theme=dark"
        assert b"<title>Rerun Viewer</title>" in page(free_port)
        assert set(listeners(free_port)) == {f"0100007F:{free_port:04X}"}
    finally:
        web.close()
    assert serving_problem(free_port) == ""
    assert problems == []


def test_the_picture_is_served_although_the_browsers_port_is_taken(
    free_port: int, silent_viewer: int
) -> None:
    problems: list[str] = []
    sinks = Sinks(viewer=ViewerMode.SERVE, port=free_port, web_port=silent_viewer)
    recording = OpenRecording(sinks, on_problem=problems.append)
    assert recording.description == f"served at rerun+http://{LOCAL}:{free_port}/proxy"
    assert not recording.viewer_failed
    assert recording.close()
    (problem,) = problems
    assert problem.startswith(f"the web viewer is not served at port {silent_viewer}: ")
    assert "Address already in use" in problem
