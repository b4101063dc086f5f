# SPDX-License-Identifier: Apache-2.0
"""Logs that are drawn: the file is read back and has what was logged."""

from __future__ import annotations

import signal
import socket
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from contact_dynamics.recording import BagReader, decode_without_ros, service_calls
from contact_dynamics.replay.run import main
from replay.asked_log import Asked, without_ros
from replay.flights import CONFIGURATION, flight, write_flight
from running_server import ROOT

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    from rerun.chunk import RrdReader

    from viewing.drawn import read_drawn


def test_a_log_is_drawn_without_ros(asked: Asked, tmp_path: Path) -> None:
    done = without_ros("view", asked.log, "--rrd", tmp_path / "drawn.rrd")
    assert done.returncode == 0, done.stderr
    assert f"{sum(asked.counts.values())} responses" in done.stderr
    drawn = read_drawn(tmp_path / "drawn.rrd")
    RrdReader(tmp_path / "drawn.rrd")  # it would warn about a missing footer
    stamps = sorted(message.publish_time_ns for message in BagReader(asked.log).messages({"/brick/odometry"}))
    assert drawn.stamps("/world/bodies/brick", "Transform3D:translation") == stamps
    landings = [
        decode_without_ros(call.response_event).response[0]
        for call in service_calls(BagReader(asked.log).messages())
        if call.service.endswith("predict_tumbling") and call.response_event is not None
    ]
    (*_, last) = (
        each for each in landings if each.state.body_name == "brick" and len(each.trajectory.positions) > 0
    )
    (strip,) = drawn.array("/world/predicted/brick/path", "LineStrips3D:strips")  # what was drawn last
    np.testing.assert_allclose(strip, np.array(last.trajectory.positions).reshape(-1, 3), atol=1e-6)
    (*_, many) = (  # both batches draw to one place, and the one about flights comes last
        decode_without_ros(call.response_event).response[0]
        for call in service_calls(BagReader(asked.log).messages())
        if call.service.endswith("predict_tumbling_batch") and call.response_event is not None
    )
    points = drawn.array("/world/many/brick/states/state_then", "Points3D:positions")
    np.testing.assert_allclose(points, np.array(many.states.positions).reshape(-1, 3), atol=1e-6)
    assert (
        "Impacts of many**: brick has 3 states; 2 " in drawn.last("/answers/newest", "TextDocument:text")[0]
    )


def test_questions_to_a_recording_of_others_are_drawn(tmp_path: Path) -> None:
    write_flight(tmp_path / "bag")
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    arguments = ["--config", tmp_path / "server.yaml", "--topics", "ball=/tracker/ball", "--ask", "impact"]
    path = tmp_path / "drawn.rrd"
    assert main(["view", str(tmp_path / "bag"), *map(str, arguments), "--rrd", str(path)]) == 0
    drawn = read_drawn(path)
    expected = [state.stamp_ns for number, state in enumerate(flight()) if number not in {50, 51}]
    assert drawn.stamps("/world/bodies/ball", "Transform3D:translation") == expected


def test_a_viewer_that_does_not_open_ends_with_the_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_flight(tmp_path / "bag")
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"):
        monkeypatch.delenv(name, raising=False)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = str(probe.getsockname()[1])
    view = ("view", tmp_path / "bag", "--config", tmp_path / "server.yaml", "--topics", "ball=/tracker/ball")
    reason = "neither DISPLAY nor WAYLAND_DISPLAY is set; draw into a file, or serve the picture"
    done = without_ros(*view, "--port", port)
    assert done.returncode == 2
    assert "nowhere to draw to: rerun's viewer has no screen" in done.stderr
    assert reason in done.stderr
    done = without_ros(*view, "--port", port, "--spawn", "--rrd", tmp_path / "drawn.rrd")
    assert done.returncode == 1  # the file is there, what was asked for was to see it
    assert reason in done.stderr
    assert (tmp_path / "drawn.rrd").stat().st_size > 0


def _heed_ctrl_c() -> None:
    """A shell that starts the tests in the background has SIGINT ignored."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_what_is_served_stays_until_it_is_stopped(tmp_path: Path) -> None:
    """It prints the address, which can be connected to after all is drawn, and ends with Ctrl-C."""
    write_flight(tmp_path / "bag")
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    command = [sys.executable, "-m", "contact_dynamics", "replay", "view", tmp_path / "bag", "--serve"]
    command += ["--port", str(port), "--config", tmp_path / "server.yaml", "--topics", "ball=/tracker/ball"]
    with subprocess.Popen(
        command,
        cwd=ROOT,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=_heed_ctrl_c,  # noqa: PLW1509
    ) as started:
        assert started.stderr is not None
        line = started.stderr.readline()
        assert f"served at rerun+http://127.0.0.1:{port}/proxy; press Ctrl-C to stop" in line
        assert "all 188 states and 0 responses are drawn" in started.stderr.readline()
        with pytest.raises(subprocess.TimeoutExpired):
            started.wait(1.0)
        socket.create_connection(("127.0.0.1", port), timeout=10.0).close()
        started.send_signal(signal.SIGINT)
        try:
            assert "drew 188 states" in started.communicate(timeout=60.0)[1]
        finally:
            started.kill()
        assert started.returncode == 0


def test_a_damaged_log_is_drawn_but_for_the_damage_which_is_told(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One chunk in the middle has a flipped bit."""
    (path,) = BagReader(asked.log).paths
    data = bytearray(path.read_bytes())
    places = [at for at in range(len(data)) if data.startswith(b"zstd", at)]
    data[places[len(places) // 4] + 20] ^= 1
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    assert main(["view", str(damaged), "--rrd", str(tmp_path / "drawn.rrd")]) == 0
    told = capsys.readouterr().err
    assert told.count("is damaged or was cut short") == 1
    stamps = read_drawn(tmp_path / "drawn.rrd").stamps("/world/bodies/brick", "Transform3D:translation")
    whole = list(BagReader(asked.log).messages({"/brick/odometry"}))
    assert 0 < len(stamps) <= len(whole)


def test_what_is_no_log_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["view", str(tmp_path), "--rrd", str(tmp_path / "drawn.rrd")]) == 2
    assert "no MCAP file here" in capsys.readouterr().err
