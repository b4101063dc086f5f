# SPDX-License-Identifier: Apache-2.0
"""rerun's web viewer beside what is served."""

from __future__ import annotations

import http.client

from contact_dynamics.viewing.sinks import OpenRecording, Sinks, ViewerMode, WebViewer
from contact_dynamics.viewing.viewer_process import LOCAL, serving_problem
from viewing.viewers import PATIENCE_S, listeners, listens, wait_until


def page(port: int) -> bytes:
    """What a browser gets, as soon as something listens."""
    wait_until(lambda: listens(port))
    connection = http.client.HTTPConnection(LOCAL, port, timeout=PATIENCE_S)
    connection.request("GET", "/")
    content = connection.getresponse().read()
    connection.close()
    return content


def test_a_browser_of_this_machine_finds_it_until_it_is_closed(free_port: int) -> None:
    problems: list[str] = []
    served = "rerun%2Bhttp%3A%2F%2F127.0.0.1%3A1%2Fproxy"
    web = WebViewer(free_port, "rerun+http://127.0.0.1:1/proxy", on_problem=problems.append)
    try:
        assert web.address == f"http://{LOCAL}:{free_port}/?url={served}&theme=dark"
        assert b"<title>Rerun Viewer</title>" in page(free_port)
        assert listeners(free_port) == {f"0100007F:{free_port:04X}"}
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
