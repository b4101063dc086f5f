# SPDX-License-Identifier: Apache-2.0
"""The command: its tables and files, what it goes on from, what it says of what went wrong."""

from __future__ import annotations

import csv
import itertools
import json
import os
import pty
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from contact_dynamics.evaluation.arguments import evaluate_parser
from contact_dynamics.evaluation.result import read_evaluation
from contact_dynamics.evaluation.run import main
from contact_dynamics.evaluation.settings import Settings
from contact_dynamics.measured.read_toss import DEFAULT_RECORDING, read_toss
from evaluation.made_logs import BRIEF, parameters_of_toss, write_log
from message_words import says
from replay.asked_log import BLOCKED
from running_server import ROOT
from viewing.drawn import read_drawn

QUICK = ("--horizons", "50", "--laws", "poisson")
BRICK = str(DEFAULT_RECORDING)
BOX_CORNERS = 0.5 * np.array([0.15, 0.09, 0.05]) * list(itertools.product((-1, 1), repeat=3))
COPIES = 8  # of a recording that is evaluated in a third of a second
COUNT = 5  # recordings that are evaluated in turn, each in a small part of a second


def test_help_names_the_defaults() -> None:
    text, default = " ".join(evaluate_parser().format_help().split()), Settings()
    assert f"impact laws: {', '.join(law.value for law in default.laws)} (default: all)" in text
    assert f"(default: {','.join(f'{1e3 * each:g}' for each in default.horizons)})" in text
    assert f"(default: {1e3 * default.fit_window:g})" in text


@pytest.fixture(scope="module")
def evaluated(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The arguments for the brick's recording, with a folder of results in which it is after the first."""
    return [BRICK, *QUICK, "--results", str(tmp_path_factory.mktemp("results"))]


def test_everything_it_writes_has_the_same_rows(
    evaluated: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")
    names = {kind: tmp_path / f"out.{kind}" for kind in ("json", "csv", "parquet")}
    files = [text for kind, path in names.items() for text in (f"--{kind}", str(path))]
    assert main([*evaluated, *files, "--plots", str(tmp_path / "plots")]) == 0
    printed = capsys.readouterr().out
    assert "events: 4 flight, 4 landing, 3 impact, 1 rest, 1 sliding" in printed
    assert "first contacts: time and pose  (brick on floor)" in printed
    assert "impacts of a single corner: velocities after the impact  (brick on floor)" in printed
    assert re.search(
        r"coefficients, poisson has .* error: [\d.]+ m/s of a median velocity change of 2.6 m/s", printed
    )
    assert "impacts of several corners" not in printed
    rows = read_evaluation(names["json"]).results[0].comparisons
    with names["csv"].open(encoding="utf-8") as stream:
        listed = list(csv.DictReader(stream))
    columns = parquet.read_table(names["parquet"]).to_pydict()
    assert len(listed) == len(columns["kind"]) == len(rows) > 0
    for i, row in enumerate(rows):
        assert listed[i]["kind"] == columns["kind"][i] == row.kind.value
        assert columns["time_error"][i] == row.time_error
        assert listed[i]["time_error"] == ("" if row.time_error is None else repr(row.time_error))
        if row.predicted is not None:
            assert columns["predicted_qw"][i] == row.predicted[6]
    drawn = {path.name for path in (tmp_path / "plots").iterdir()}
    assert drawn == {"flight-brick.png", "landing-brick-floor.png", "impact-brick-floor.png", "coverage.png"}
    assert all((tmp_path / "plots" / name).read_bytes().startswith(b"\x89PNG") for name in drawn)


def test_the_picture_has_each_event_measured_and_predicted(evaluated: list[str], tmp_path: Path) -> None:
    assert main([*evaluated, "--rerun", str(tmp_path / "events.rrd")]) == 0
    paths = read_drawn(tmp_path / "events.rrd").entities
    events = {path.split("/")[2] for path in paths if path.startswith("/events/")}
    assert len(events) == 6  # 4 landings, with their flights and impacts, a slide and a rest
    landings = [name for name in events if "landing" in name]
    assert len(landings) == 4
    for name in landings:
        assert f"/events/{name}/measured/edges" in paths
        assert any(path.startswith(f"/events/{name}/predicted/50") for path in paths)
    struck = [name for name in landings if any(path.endswith("poisson") and name in path for path in paths)]
    assert len(struck) == 3


def test_the_picture_has_predictions_of_another_centre_of_mass_where_the_body_is(tmp_path: Path) -> None:
    """Each outline has the corners of the box, whose frame's origin is off the configured centre of mass."""
    offset = np.array([0.01, -0.02, 0.005])
    parameters = {**parameters_of_toss(tmp_path, read_toss()), "body.brick.center_of_mass": offset.tolist()}
    config, rows, drawn = (tmp_path / name for name in ("config.yaml", "rows.json", "events.rrd"))
    config.write_text(json.dumps({"/**": {"ros__parameters": parameters}}), encoding="utf-8")
    assert main([BRICK, *QUICK, "--config", str(config), "--json", str(rows), "--rerun", str(drawn)]) == 0
    expected = []
    for row in read_evaluation(rows).results[0].comparisons:
        if row.kind.value == "landing" and row.method.value == "fit" and row.predicted is not None:
            turn = Rotation.from_quat(row.predicted[3:7])
            expected.append(row.predicted[:3] + turn.apply(BOX_CORNERS - offset))
    values = read_drawn(drawn).values
    outlines = [
        np.unique(np.concatenate([np.reshape(strip, (-1, 3)) for strip in strips]), axis=0)
        for (path, name), column in values.items()
        if "landing" in path and "/predicted/" in path and name.endswith("strips")
        for _, strips in column
    ]
    assert len(outlines) == len(expected) == 4
    for corners in expected:  # to the rounding of single precision at a metre
        assert min(abs(found - np.unique(corners, axis=0)).max() for found in outlines) <= 1e-6


def test_a_folder_is_searched_and_what_is_bad_in_it_is_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_log(tmp_path / "deep" / "log", until=BRIEF)
    (tmp_path / "bad.mcap").write_bytes(b"no log")
    assert main([str(tmp_path), str(tmp_path / "nowhere"), *QUICK]) == 1
    printed = capsys.readouterr().out
    assert printed.startswith("1 recording, 193 states")
    assert "not evaluated: 2 recordings" in printed
    assert f"{tmp_path / 'bad.mcap'}: NotALogError" in printed
    assert says(printed, f"{tmp_path / 'nowhere'} must be ..., got no such file or folder")
    assert main([str(tmp_path / "bad.mcap"), *QUICK]) == 2
    printed, told = capsys.readouterr()
    assert printed == ""
    assert f"{tmp_path / 'bad.mcap'}: NotALogError" in told


def test_another_configuration_is_compared_on_the_same_events(
    evaluated: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With no friction and no restitution the brick's impacts are predicted far worse, its flights alike."""
    toss = read_toss()
    parameters = parameters_of_toss(tmp_path, toss)
    parameters[f"surface.{toss.surface.name}.friction"] = 0.0
    parameters[f"surface.{toss.surface.name}.restitution"] = 0.0
    other = tmp_path / "other.yaml"
    other.write_text(json.dumps({"/**": {"ros__parameters": parameters}}), encoding="utf-8")
    assert main([*evaluated, "--against", str(other)]) == 0
    lines = capsys.readouterr().out.splitlines()
    place = next(line.split() for line in lines if "flight, 50 ms, fit" in line and "position" in line)
    speed = next(line.split() for line in lines if "impact, 50 ms, poisson" in line and "velocity" in line)
    assert place[6:9] == ["4", place[7], place[7]]  # four events, equal errors
    assert float(speed[8]) > 3.0 * float(speed[7])


def test_two_results_are_compared_and_equal_ones_do_not_differ(
    evaluated: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = tmp_path / "before.json"
    assert main([*evaluated, "--json", str(before)]) == 0
    assert main([BRICK, *QUICK, "--against", str(before)]) == 0
    table = capsys.readouterr().out.partition("A: ")[2].splitlines()
    rows = [line for line in table if " ms, " in line and "error" not in line]
    assert len(rows) >= 6
    assert all(line.rstrip().endswith("0 to 0        1") for line in rows)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--against", "nowhere.json"], "nowhere.json"),
        (["--against", "nowhere.yaml"], "nowhere.yaml: cannot be read"),
        (["--config", "nowhere.yaml"], "nowhere.yaml: cannot be read"),
        (["--json", "nowhere/out.json"], "nowhere/out.json"),
    ],
)
def test_what_cannot_be_read_or_written_is_said_before_the_work(
    arguments: list[str],
    named: str,
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([BRICK, *arguments]) == 2
    told = capsys.readouterr()
    assert says(told.err, named)
    assert told.out == ""


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        (["--horizons", "20,soon"], "got 'soon'"),
        (["--horizons", "0.02"], "must be a number of milliseconds >= 1, got '0.02'"),
        (["--fit-window", "0.1"], "must be a number of milliseconds >= 1, got '0.1'"),
        (["--laws", "hooke"], "must be one of poisson, newton, energetic, in time..., got 'hooke'"),
        (["--jobs", "0"], "must be a whole number >= 1..., got '0'"),
        (["--jobs", "2", "--dask", "local:2"], "argument --dask: not allowed with argument --jobs"),
        ([], "at least one RECORDING is required"),
    ],
)
def test_a_wrong_argument_is_named(
    arguments: list[str], named: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([*([BRICK] if arguments else []), *arguments])
    assert says(capsys.readouterr().err, named)


def test_horizons_longer_than_every_flight_are_reported(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([BRICK, "--horizons", "20000"]) == 0
    assert (
        "no predictions: no event is preceded by states over one of the horizons" in capsys.readouterr().out
    )


@pytest.fixture(scope="module")
def logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of as many brief recordings."""
    folder = tmp_path_factory.mktemp("logs")
    for seed in range(COUNT):
        write_log(folder / f"log{seed}", seed=seed, until=BRIEF)
    return folder


def test_killed_in_the_middle_it_goes_on_with_the_rest(
    logs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The results that were there stay untouched, the others are made, and the numbers are the same."""
    results = tmp_path / "results"
    arguments = [str(logs), *QUICK, "--results", str(results), "--json", str(tmp_path / "resumed.json")]
    command = [sys.executable, "-m", "contact_dynamics", "evaluate", *arguments]
    first = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120.0
    while len(list(results.glob("*.json"))) < 2:
        assert first.poll() is None, "it ended before it could be killed"
        assert time.monotonic() < deadline
        time.sleep(0.01)
    first.send_signal(signal.SIGKILL)
    first.wait()
    there = {path: path.stat().st_mtime_ns for path in results.glob("*.json")}
    assert 2 <= len(there) < COUNT
    assert main(arguments) == 0
    assert f"{len(there)} of {COUNT} recordings were evaluated before" in capsys.readouterr().err
    after = {path: path.stat().st_mtime_ns for path in results.glob("*.json")}
    assert len(after) == COUNT
    assert {path: after[path] for path in there} == there
    assert main([str(logs), *QUICK, "--json", str(tmp_path / "at_once.json")]) == 0
    resumed, at_once = (
        json.loads((tmp_path / f"{name}.json").read_text()) for name in ("resumed", "at_once")
    )
    assert resumed == at_once


def test_without_ros_a_bar_tells_who_watches_how_far_it_is_and_leaves_no_trace(tmp_path: Path) -> None:
    """The recordings take several times as long as the half second before it tells."""
    recordings = [tmp_path / f"{k}{DEFAULT_RECORDING.suffix}" for k in range(COPIES)]
    for recording in recordings:
        shutil.copy(DEFAULT_RECORDING, recording)
    ours, theirs = pty.openpty()
    done = subprocess.run(
        [sys.executable, "-c", BLOCKED, "evaluate", *map(str, recordings)],
        stdout=subprocess.PIPE,
        stderr=theirs,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": str(ROOT), "AMENT_PREFIX_PATH": ""},
    )
    os.close(theirs)
    shown = os.read(ours, 10_000).decode()
    os.close(ours)
    assert done.returncode == 0, shown
    assert done.stdout.startswith(f"{COPIES} recordings, ")
    assert re.search(rf" left, [1-{COPIES - 1}] of {COPIES}: ", shown)
    assert shown.endswith("\r\x1b[K")


def test_a_damaged_result_is_made_again(tmp_path: Path) -> None:
    results = tmp_path / "results"
    assert main([BRICK, *QUICK, "--results", str(results)]) == 0
    (kept,) = results.glob("*.json")
    whole = kept.read_bytes()
    kept.write_bytes(whole[:-100])
    assert main([BRICK, *QUICK, "--results", str(results)]) == 0
    assert kept.read_bytes() == whole
