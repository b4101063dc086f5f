# SPDX-License-Identifier: Apache-2.0
"""The command on the log of a real server, with and without ROS and Matplotlib."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from contact_dynamics.command_line import main as command_line
from contact_dynamics.diagrams.impulse_space import main_contact
from contact_dynamics.impact.law import PathEvent
from contact_dynamics.plots.run import NO_LOG, NOTHING_DRAWN, main
from contact_dynamics.questions.impact_question import ImpactAnswer
from contact_dynamics.replay.events import Answered, LoggedEvents
from contact_dynamics_interfaces.srv import (
    PredictBodiesContactMode,
    PredictContactMode,
    PredictImpact,
    PredictTumbling,
)
from message_words import says
from nodes.test_same_question import REQUESTS, filled
from replay.asked_log import BLOCKED, about_many
from running_server import ROOT, server_and_client

WITHOUT_RERUN = BLOCKED.replace('"rclpy",', '"rclpy", "rerun",')
"""The command line where neither ROS nor its messages nor rerun can be found."""


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The log of a server that was asked one question of each kind, and one that it refused."""
    folder = tmp_path_factory.mktemp("plotted")
    tumbling = PredictTumbling.Request(
        body_name="brick",
        state_source=PredictTumbling.Request.STATE_EXPLICIT,
        times=[0.1, 0.2],
        curve_points=50,
    )
    tumbling.state.angular_velocity.y = 6.0
    tumbling.state.angular_velocity.z = 0.5
    impact = PredictImpact.Request(body_name="brick", state_source=PredictImpact.Request.STATE_EXPLICIT)
    impact.state.pose.position.z = 0.4
    impact.state.pose.orientation.x, impact.state.pose.orientation.w = 0.3, 0.9539392
    impact.state.linear_velocity.x = 0.5
    standing = PredictContactMode.Request(
        body_name="brick", state_source=PredictContactMode.Request.STATE_EXPLICIT, include_margins=True
    )
    standing.state.pose.position.z = 0.025
    with server_and_client(folder, params_file=ROOT / "config" / "server.yaml") as client:
        several = (standing, PredictImpact.Request(body_name="cat"), impact, tumbling, *about_many(0))
        for request in several:
            answer = client.ask(request)
            assert (answer.status == answer.OK) == (request.body_name == "brick"), answer.message
        answer = client.ask(
            filled(PredictBodiesContactMode.Request(), REQUESTS["contact modes of bodies"][1])
        )
        assert answer.status == answer.OK, answer.message
    (found,) = folder.iterdir()
    return found


def test_each_answer_has_its_diagrams_without_ros(log: Path, tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_RERUN, "plot", str(log), "--output", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), "AMENT_PREFIX_PATH": ""},
    )
    assert run.returncode == 0, run.stderr
    files = {path.name for path in (tmp_path / "out").iterdir()}
    assert {
        "004-tumbling-brick-motion.svg",
        "004-tumbling-brick-poinsot.svg",
        "003-impact-brick-impulse-space.svg",
        "003-impact-brick-impulse-space-in-3d.svg",
        "001-contact-modes-brick-contact-forces-1.svg",
        "005-impacts-of-many-brick-states.svg",
        "006-tumbling-of-many-brick-states.svg",
        "009-contact-modes-of-bodies-rod_brick-contact-forces-1.svg",
    } <= files
    assert set(run.stdout.split()) == {str(tmp_path / "out" / name) for name in files}
    answers = [event.answer for event in LoggedEvents(log) if isinstance(event, Answered)]
    impact = next(each for each in answers if isinstance(each, ImpactAnswer))
    words = "".join(ET.parse(tmp_path / "out" / "003-impact-brick-impulse-space.svg").getroot().itertext())
    contact = main_contact(impact.impact)
    vertices = zip(impact.impact.path_W, impact.impact.path_contacts, impact.impact.path_events, strict=True)
    end_W = next(
        impulse_W
        for impulse_W, owner, event in vertices
        if owner == contact and event is PathEvent.RESTITUTION_ENDS
    )
    normal = float(end_W @ impact.contacts.normals_W[contact])
    assert f"{normal:.3g}) N s" in words


def test_pictures_and_few_answers(log: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(log), "--output", str(tmp_path), "--format", "png", "--max-responses", "1"]) == 0
    assert capsys.readouterr().err == "2 diagrams of 1 responses\n"
    for path in tmp_path.iterdir():
        assert path.read_bytes().startswith(b"\x89PNG"), path


def test_a_missing_matplotlib_is_named_with_what_brings_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)  # as Python marks a module that it does not find
    with pytest.raises(SystemExit, match=r"^0$"):
        command_line(["plot", "--help"])
    assert "--output DIR" in capsys.readouterr().out
    assert command_line(["plot", "log", "--output", str(tmp_path)]) == 3
    said = capsys.readouterr().err
    assert "matplotlib" in said
    assert "pip install matplotlib" in said
    assert "ROS" not in said


def test_what_is_no_log_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path / "nowhere"), "--output", str(tmp_path / "out")]) == NO_LOG
    assert "nowhere" in capsys.readouterr().err


def test_a_log_without_answers_has_nothing_to_draw(log: Path, tmp_path: Path) -> None:
    from contact_dynamics.recording import BagReader, BagWriter

    reader = BagReader(log)
    with BagWriter(tmp_path / "empty", run=reader.run()) as writer:
        writer.add_topic(
            "/contact_dynamics/predict_impact/_service_event",
            "contact_dynamics_interfaces/srv/PredictImpact_Event",
        )
    assert main([str(tmp_path / "empty"), "--output", str(tmp_path / "out")]) == NOTHING_DRAWN


@pytest.mark.parametrize(("given", "missing"), [(["--output", "out"], "LOG"), (["log"], "--output DIR")])
def test_log_and_folder_are_needed(
    given: list[str], missing: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(given)
    assert f"error: {missing} is required" in capsys.readouterr().err


@pytest.mark.parametrize("most", ["0", "-3", "many"])
def test_a_count_that_is_none_is_refused(most: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["log", "--output", "out", "--max-responses", most])
    assert says(capsys.readouterr().err, f"must be a whole number >= 1..., got {most}")
