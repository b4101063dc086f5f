# SPDX-License-Identifier: Apache-2.0
"""Tables of logs of a server, and of recordings that no server was part of."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import numpy as np
import pyarrow.csv as arrow_csv
import pyarrow.parquet as pq
import pytest
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.errors import NotSupportedError
from contact_dynamics.recording import BagReader, DamagedLogWarning, decode_without_ros, service_calls
from contact_dynamics.replay.rows import COLUMNS
from contact_dynamics.replay.run import main
from contact_dynamics.replay.table_file import log_to_frame
from message_words import says
from replay.asked_log import MANY, Asked, without_ros
from replay.flights import CONFIGURATION, RATE, START_NS, write_flight

EXACT = 1e-6
"""Stamps are whole ns, and a serialised state has the rounding of a double: both are far below."""


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_a_row_for_each_question_of_a_log(asked: Asked, tmp_path: Path) -> None:
    assert main(["table", str(asked.log), "--output", str(tmp_path / "table.csv")]) == 0
    rows = rows_of(tmp_path / "table.csv")
    assert list(rows[0]) == list(COLUMNS)
    counts = {service: sum(row["service"] == service for row in rows) for service in ("predict_impact",)}
    assert counts["predict_impact"] == asked.counts["PredictImpact"]
    assert len(rows) == asked.rows
    published = {
        message.publish_time_ns
        for message in BagReader(asked.log).messages({"/brick/odometry", "/ball/pose"})
    }
    landings = [row for row in rows if '"sampling": 3' in row["request"]]
    assert landings
    assert {row["summary"] for row in landings} == {"contact"}
    assert {row["surface"] for row in landings} == {"floor"}
    assert {int(row["state_stamp_ns"]) for row in landings} <= published
    fitted = [row for row in rows if "fit_window" in row["request"]]
    assert all(row["status"] != "OK" or int(row["states_fitted"]) > 0 for row in fitted)
    cats = [row for row in rows if row["body"].startswith("cat")]
    assert {row["status"] for row in cats} == {"UNKNOWN_BODY"}
    assert rows[-1]["status"] == "STALE_STATE"
    for row in rows:
        is_later = row["state"] not in {"", "0"}  # the first one has the question of a batch
        asked_about = {} if is_later else json.loads(row["request"])
        names = [asked_about.get("body_name", "")]
        if row["service"] == "predict_bodies_contact_mode":
            names = [state["body_name"] for state in asked_about["states"]]
        assert is_later or ", ".join(names) == row["body"]
        assert not row["predicted_qw"] or float(row["predicted_qw"]) >= 0.0
        is_impact = row["service"] == "predict_impact" and row["status"] == "OK"
        assert all((row[f"contact_{axis}"] != "") == is_impact for axis in "xyz")
    heights = [float(row["contact_z"]) for row in rows if row["contact_z"] and row["surface"] == "floor"]
    assert heights == pytest.approx([0.0] * len(heights), abs=EXACT)


def test_a_question_about_many_states_has_a_row_for_each(asked: Asked, tmp_path: Path) -> None:
    assert main(["table", str(asked.log), "--output", str(tmp_path / "table.csv")]) == 0
    rows = rows_of(tmp_path / "table.csv")
    impacts = [row for row in rows if row["service"] == "predict_impact_batch"]
    flights = [row for row in rows if row["service"] == "predict_tumbling_batch"]
    responses = [
        decode_without_ros(call.response_event).response[0]
        for call in service_calls(BagReader(asked.log).messages())
        if call.service.endswith("predict_impact_batch") and call.response_event is not None
    ]
    for number, response in enumerate(responses, start=1):
        group = [row for row in impacts if int(row["number"]) == number]
        assert [int(row["state"]) for row in group] == list(range(MANY))
        assert [float(row[f"predicted_v{axis}"]) for row in group for axis in "xyz"] == list(
            response.states_after.linear_velocities
        )
        assert [float(row[f"predicted_{axis}"]) for row in group for axis in "xyz"] == pytest.approx(
            list(response.states_after.positions), abs=EXACT
        )
    assert [row["summary"] for row in impacts[:MANY]][-1] == "separates"
    assert "separates" not in {row["summary"] for row in impacts[: MANY - 1]}
    first = json.loads(impacts[0]["request"])
    assert first["states"]["positions"][3:6] == [0.5, 0.0, 1.0]
    assert json.loads(flights[0]["request"])["times"] == [0.1, 0.2, 0.3]
    assert {row["request"] for rows in (impacts, flights) for row in rows if row["state"] != "0"} == {""}
    assert {row["summary"] for row in flights} == {"flight"}


def test_a_question_about_many_candidates_has_a_row_for_each(asked: Asked, tmp_path: Path) -> None:
    assert main(["table", str(asked.log), "--output", str(tmp_path / "table.csv")]) == 0
    rows = [row for row in rows_of(tmp_path / "table.csv") if row["service"] == "predict_contact_mode_batch"]
    responses = [
        decode_without_ros(call.response_event).response[0]
        for call in service_calls(BagReader(asked.log).messages())
        if call.service.endswith("contact_mode_batch") and call.response_event is not None
    ]
    assert len(rows) == MANY * len(responses)
    for number, response in enumerate(responses, start=1):
        group = [row for row in rows if int(row["number"]) == number]
        assert [int(row["state"]) for row in group] == list(range(MANY))
        modes = iter(response.modes)
        for row, verdict, count in zip(group, response.verdicts, response.mode_counts, strict=True):
            name = ModeVerdict(verdict).name.lower()
            expected = [f"{mode} ({mode_in_words(mode)})" for mode in (next(modes) for _ in range(count))]
            assert row["summary"] == (f"{name}: {', '.join(expected)}" if expected else name)
            assert (row["body"], row["status"], row["states_fitted"]) == ("brick", "OK", "0")
    pushed, standing = rows[:MANY], rows[MANY : 2 * MANY]
    assert json.loads(pushed[0]["request"])["forces"] == [0.0, 0.0, 0.0, 0.1, 0.0, 0.0, 9.0, 0.0, 0.0]
    assert len({row["summary"] for row in pushed}) > 1
    assert pushed[0]["summary"] == "unique: ffff (every contact stays fixed)"
    assert [row["surface"] for row in standing] == ["floor", "table", "ramp"]
    assert json.loads(standing[0]["request"])["contact_counts"] == [2, 1, 1]


def test_parquet_has_the_cells_of_csv_and_needs_no_ros(asked: Asked, tmp_path: Path) -> None:
    assert main(["table", str(asked.log), "--output", str(tmp_path / "table.csv")]) == 0
    done = without_ros("table", asked.log, "--output", tmp_path / "table.parquet")
    assert done.returncode == 0, done.stderr
    table = pq.read_table(tmp_path / "table.parquet")
    assert table.column_names == list(COLUMNS)
    rows = rows_of(tmp_path / "table.csv")
    for name in ("request_ns", "service", "status", "summary", "predicted_x", "state_stamp_ns"):
        cells = ["" if cell is None else str(cell) for cell in table.column(name).to_pylist()]
        assert cells == [row[name] for row in rows], name


def test_a_part_of_a_log(asked: Asked, tmp_path: Path) -> None:
    """The last second has one question, the one whose state was too old."""
    begin, end = BagReader(asked.log).extent()
    seconds = (end - begin) / 1e9
    out = tmp_path / "table.csv"
    assert main(["table", str(asked.log), "--start", str(seconds - 1.0), "--output", str(out)]) == 0
    assert len(rows_of(out)) == 1
    assert main(["table", str(asked.log), "--end", str(seconds - 1.0), "--output", str(out)]) == 0
    assert len(rows_of(out)) == asked.rows - 1


@pytest.mark.parametrize(
    ("part", "range_told"),
    [(("--start", "1000"), "1000 s to its end"), (("--start", "0.2", "--end", "0.1"), "0.2 s to 0.1 s")],
)
def test_a_part_that_the_log_does_not_have_is_an_error(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str], part: tuple[str, ...], range_told: str
) -> None:
    out = tmp_path / "table.csv"
    begin, end = BagReader(asked.log).extent()
    for mode in (["table", "--output", str(out)], ["view", "--rrd", str(tmp_path / "drawn.rrd")]):
        assert main([*mode, str(asked.log), *part]) == 2
        told = capsys.readouterr().err
        assert says(told, f"--start and --end must be a part of {asked.log}..., got {range_told}")
        assert f"lasts {(end - begin) / 1e9:.9g} s (log_time {begin} to {end} ns)" in told
    assert list(tmp_path.iterdir()) == []


def test_a_log_that_was_cut_short_has_the_part_up_to_its_end(asked: Asked, tmp_path: Path) -> None:
    """It has no index, so that its length is not known before it is read."""
    (whole,) = asked.log.glob("*.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size * 6 // 10])
    assert BagReader(cut).extent()[0] == BagReader(cut).extent()[1]
    out = tmp_path / "table.csv"
    assert main(["table", str(cut), "--start", "0.05", "--output", str(out)]) == 0
    assert len(rows_of(out)) > 0


def test_a_table_without_rows_is_an_error_and_leaves_no_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_flight(tmp_path / "bag")
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    out = tmp_path / "table.csv"
    out.write_text("before\n")
    common = ["table", str(tmp_path / "bag"), "--config", str(tmp_path / "server.yaml"), "--output", str(out)]
    assert main([*common, "--topics", "ball=/tracker/ball"]) == 1
    told = "no rows: no prediction was requested; --ask must be one of landing, impact, modes"
    assert told in capsys.readouterr().err
    assert main([*common, "--ask", "landing", "--topics", "ball=/tracker/bell"]) == 1
    told = "no rows: the configured topics (/tracker/bell) contain no state of ball; --topics selects others"
    assert says(capsys.readouterr().err, told)
    assert main([*common[:-4], "--ask", "landing", "--output", str(out)]) == 2
    assert "the log does not contain a configuration; specify one with --config" in capsys.readouterr().err
    assert out.read_text() == "before\n"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bag", "server.yaml", "table.csv"]


def test_times_keep_their_nanoseconds_beside_empty_cells(asked: Asked, tmp_path: Path) -> None:
    """Read as the page says, or with the types of Parquet. pandas makes floats of integers else."""
    out = tmp_path / "table.csv"
    assert main(["table", str(asked.log), "--output", str(out)]) == 0
    assert main(["table", str(asked.log), "--output", str(tmp_path / "table.parquet")]) == 0
    rows, table = rows_of(out), pq.read_table(tmp_path / "table.parquet")
    for name in ("state_stamp_ns", "predicted_ns", "states_fitted"):
        cells = [row[name] for row in rows]
        assert "" in cells
        assert any(cells)
        expected = [int(cell) if cell else None for cell in cells]
        assert table.column(name).to_pylist() == expected
        assert arrow_csv.read_csv(out).column(name).to_pylist() == expected
    pandas = json.loads(table.schema.metadata[b"pandas"])
    assert {each["name"] for each in pandas["columns"]} == {name for name in COLUMNS if COLUMNS[name] is int}


@pytest.mark.parametrize(
    ("storage", "mode"),
    [
        (StoragePlugin.SQLITE3, CompressionMode.NONE),
        (StoragePlugin.SQLITE3, CompressionMode.FILE),
        (StoragePlugin.MCAP, CompressionMode.MESSAGE),
    ],
)
def test_what_would_it_have_said(tmp_path: Path, storage: StoragePlugin, mode: CompressionMode) -> None:
    """A stack that never ran our node recorded an exact flight: landing and impact are as it went on."""
    write_flight(tmp_path / "bag", storage=storage, mode=mode)
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    asking = ["--ask", "landing", "--ask", "impact", "--ask", "modes", "--every", "0.1"]
    configured = ["--config", tmp_path / "server.yaml", "--topics", "ball=/tracker/ball"]
    done = without_ros("table", tmp_path / "bag", *configured, *asking, "--output", tmp_path / "table.csv")
    assert done.returncode == 0, done.stderr
    assert "/tracker/ball: 2 messages are not states; reason of the first: header.frame_id" in done.stderr
    rows = rows_of(tmp_path / "table.csv")
    assert len(rows) == 3 * 10
    landings = [row for row in rows if row["service"] == "predict_tumbling"]
    impacts = [row for row in rows if row["service"] == "predict_impact"]
    assert {row["status"] for row in landings + impacts} == {"OK"}
    seen = [row for row in landings + impacts if row["measured_ns"]]
    assert len(seen) == 12  # those before the strike; what comes after the next one is not recorded
    for row in seen:
        assert int(row["request_ns"]) - START_NS < int(0.65e9)
        for kind in ("position", "angle", "velocity", "spin"):
            assert float(row[f"{kind}_error"]) < EXACT, (row["service"], kind)


def test_questions_come_as_often_as_they_are_asked_for(tmp_path: Path) -> None:
    write_flight(tmp_path / "bag")
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    out = tmp_path / "table.csv"
    common = [str(tmp_path / "bag"), "--config", str(tmp_path / "server.yaml"), "--output", str(out)]
    common += ["--topics", "ball=/tracker/ball", "--ask", "modes"]
    assert main(["table", *common, "--every", "0"]) == 0
    assert len(rows_of(out)) == int(0.95 * RATE) - 2
    assert main(["table", *common, "--every", "0.25"]) == 0
    gaps = np.diff([int(row["request_ns"]) for row in rows_of(out)])
    assert (gaps >= 250_000_000).all()
    assert (gaps < 250_000_000 + 3 * 1_000_000_000 // RATE).all()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (
            ["--output", "table.xls"],
            "--output must be a file that ends in .csv or .parquet..., got table.xls",
        ),
        (["--config", "none.yaml"], "none.yaml"),
        (["--config", "empty.yaml"], "empty.yaml must have parameters of"),
        (["--config", "broken.yaml"], "broken.yaml: no YAML: "),
        (["--config", "server.yaml", "--topics", "ball"], "--topics must be BODY=ODOMETRY..., got 'ball'"),
        (
            ["--config", "server.yaml", "--topics", "cat=/tracker/cat"],
            "body.cat.odometry_topic must be about one of the names in bodies ['ball'], got body 'cat'",
        ),
        (
            ["--config", "server.yaml", "--ask", "modes", "--body", "cat"],
            "body must be one of ['ball']..., got cat",
        ),
        ([], "not a log of the server: no service of it in the log's types"),
    ],
)
def test_what_is_wrong_is_named(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    arguments: list[str],
    told: str,
) -> None:
    monkeypatch.chdir(tmp_path)
    write_flight(tmp_path / "bag")
    (tmp_path / "server.yaml").write_text(CONFIGURATION)
    (tmp_path / "empty.yaml").write_text("")
    (tmp_path / "broken.yaml").write_text("a: [")
    assert main(["table", "bag", *arguments]) == 2
    assert says(capsys.readouterr().err, told)


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["table", "--topics", "ball=/tracker/ball"], "--topics must be used with --config"),
        (["table", "--body", "ball"], "--body must be used with --ask"),
        (["view", "--every", "0.5"], "--every must be used with --ask"),
        (["view", "--fit-window", "0.1"], "--fit-window must be used with --ask"),
        (["publish", "--tolerance", "1e-9"], "--tolerance must be used with --requests"),
    ],
)
def test_an_option_that_would_be_ignored_is_an_error(
    arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main([*arguments, "log"])
    assert told in capsys.readouterr().err


def test_contact_modes_have_their_forces_and_margins(asked: Asked, tmp_path: Path) -> None:
    """As the responses of the log have them, one list for each mode."""
    out = tmp_path / "table.csv"
    assert main(["table", str(asked.log), "--output", str(out)]) == 0
    rows = [row for row in rows_of(out) if row["service"] == "predict_contact_mode" and row["status"] == "OK"]
    responses = [
        decode_without_ros(call.response_event).response[0]
        for call in service_calls(BagReader(asked.log).messages())
        if call.service.endswith("predict_contact_mode") and call.response_event is not None
    ]
    assert len(rows) == len(responses) > 0
    for row, response in zip(rows, responses, strict=True):
        assert int(row["mode_count"]) == len(response.modes) > 0
        assert json.loads(row["margins"]) == [mode.margin for mode in response.modes]
        for name in ("contact_forces", "contact_accelerations"):
            vectors = [np.reshape(getattr(mode, name), (-1, 3)) for mode in response.modes]
            np.testing.assert_array_equal(json.loads(row[name]), vectors)
    batches = [row for row in rows_of(out) if row["service"] == "predict_contact_mode_batch"]
    assert all(int(row["mode_count"]) == row["summary"].count("(") for row in batches)


def test_a_log_is_a_table_of_pandas(asked: Asked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It has the types and the cells of the table in Parquet."""
    pandas = pytest.importorskip("pandas", reason="pandas of requirements/test.txt is not installed")
    frame = log_to_frame(asked.log)
    assert main(["table", str(asked.log), "--output", str(tmp_path / "table.parquet")]) == 0
    pandas.testing.assert_frame_equal(
        frame, pandas.read_parquet(tmp_path / "table.parquet"), check_dtype=False
    )
    assert {str(frame[name].dtype) for name, kind in COLUMNS.items() if kind is int} == {"Int64"}
    (whole,) = asked.log.glob("*.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size * 3 // 10])
    with pytest.warns(DamagedLogWarning, match=r"cut.mcap"):
        assert 0 < len(log_to_frame(str(cut))) < len(frame)
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(NotSupportedError, match="log_to_frame needs pandas: pip install pandas"):
        log_to_frame(asked.log)
