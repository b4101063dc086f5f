# SPDX-License-Identifier: Apache-2.0
"""`contact-dynamics calibrate` from files to files, and its parameters as the server reads them."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import pytest

from calibration.made_tosses import Truth, made_tosses
from contact_dynamics.calibration import calibrate
from contact_dynamics.calibration.arguments import calibrate_parser
from contact_dynamics.calibration.report import content_of
from contact_dynamics.calibration.run import SOMETHING_OPEN, main
from contact_dynamics.evaluation.arguments import NOTHING
from contact_dynamics.measured.read_toss import DEFAULT_RECORDING
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.nodes.parameters import read_server_parameters
from message_words import says

needs_yaml = pytest.mark.skipif(
    importlib.util.find_spec("yaml") is None, reason="PyYAML of requirements/test.txt is not installed"
)


def test_what_was_not_asked_for_is_nan_or_null_in_the_content() -> None:
    alone = calibrate(made_tosses(Truth(), 2, 0), with_paths=False)
    content = json.loads(json.dumps(content_of(alone), allow_nan=False))
    assert content["estimates"][0]["by_paths"] == "nan"
    assert content["by_paths_covariance"] is None


@needs_yaml
def test_the_verb_reads_the_packages_toss_and_writes_what_it_was_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    yaml, content = tmp_path / "server.yaml", tmp_path / "found.json"
    arguments = [str(DEFAULT_RECORDING), "--no-trajectories", "--yaml", str(yaml), "--json", str(content)]
    assert main(arguments) in {0, 1}
    assert "Body 'brick' on" in capsys.readouterr().out
    assert read_server_parameters(ParameterFile(yaml)).world.body("brick").name == "brick"
    assert json.loads(content.read_text(encoding="utf-8"))["body"]["name"] == "brick"


def test_one_toss_does_not_tell_by_how_much_its_estimates_may_differ(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """It has no scatter between tosses. A deviation of zero would make any difference a contradiction."""
    assert main([str(DEFAULT_RECORDING)]) == SOMETHING_OPEN
    printed = capsys.readouterr().out
    assert "Problem: The 3 impacts of single corners are in 1 toss, too few" in printed
    assert "from trajectories" in printed
    assert "without a standard deviation (one toss)" in printed
    assert "difference" not in printed
    assert "The two estimates disagree" not in printed


def test_a_configuration_that_does_not_count_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [str(DEFAULT_RECORDING), "--no-trajectories", "--config"]
    assert main([*arguments, str(tmp_path / "nowhere.yaml")]) == NOTHING
    assert says(capsys.readouterr().err, "--config must be ..., got no file")
    (tmp_path / "server.yaml").write_text("/**:\n  ros__parameters: {}\n", encoding="utf-8")
    assert main([*arguments, str(tmp_path / "server.yaml")]) in {0, 1}
    assert "--config does not count for the body and surface of a toss" in capsys.readouterr().err


def some_rows(tmp_path: Path, rows: slice) -> str:
    """The package's toss with some of its 480 states, as a file."""
    lines = DEFAULT_RECORDING.read_text(encoding="utf-8").splitlines(keepends=True)
    path = tmp_path / "part.csv"
    path.write_text("".join([*lines[:-480], *lines[-480:][rows]]), encoding="utf-8")
    return str(path)


def test_a_recording_in_which_the_body_never_flies_is_refused_with_what_may_be_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([some_rows(tmp_path, slice(400, 480))]) == NOTHING
    said = capsys.readouterr().err
    assert "without a flight" in said
    assert "the unit of the stamps" in said


def test_a_recording_without_strikes_says_what_is_not_determined(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([some_rows(tmp_path, slice(0, 90))]) == SOMETHING_OPEN
    said = capsys.readouterr().out
    assert "no impact of a single corner in 1 tosses with 1 flights" in said
    assert "Not determined by the data: friction.floor" in said


def test_a_path_that_is_none_is_told_and_ends_with_2(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "missing.mcap")]) == NOTHING
    assert "/missing." in capsys.readouterr().err  # a long path is cut off


def test_an_unknown_parameter_is_refused_with_those_that_are_known(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit):
        calibrate_parser().parse_args(["log", "--free", "friction,mass"])
    assert says(capsys.readouterr().err, "must be one of friction, restitution..., got 'mass'")
