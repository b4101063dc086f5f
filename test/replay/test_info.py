# SPDX-License-Identifier: Apache-2.0
"""The contents of a log on the terminal."""

from __future__ import annotations

from pathlib import Path

import pytest

from contact_dynamics.recording import BagReader
from contact_dynamics.replay.run import main
from replay.asked_log import Asked, without_ros
from replay.flights import RATE, write_flight


def table(text: str, head: str) -> dict[str, list[str]]:
    """The rows of a table by their first cells, and its heads."""
    lines = text.partition(f"\n  {head} ")[2].partition("\n\n")[0].splitlines()
    return {"": lines[0].split()} | {line.split()[0]: line.split()[1:] for line in lines[1:]}


def test_the_contents_of_a_log(asked: Asked) -> None:
    """The counts are those of the session. ROS is not needed."""
    done = without_ros("info", asked.log)
    assert done.returncode == 0, done.stderr
    begin, end = BagReader(asked.log).extent()
    assert f"UTC, {(end - begin) / 1e9:.3f} s\n" in done.stdout
    assert "\n  bodies: brick, ball, crate\n  surfaces: floor\n" in done.stdout
    sent = BagReader(asked.log).messages({"/brick/odometry"})
    expected = ["nav_msgs/msg/Odometry", str(sum(1 for _ in sent))]
    assert table(done.stdout, "topic")["/brick/odometry"] == expected
    services = table(done.stdout, "service")
    statuses = services.pop("")
    assert statuses[0] == "OK"
    assert {"STALE_STATE", "UNKNOWN_BODY", "INVALID_FIELD"} < set(statuses)
    counts = {name.rpartition("/")[2].replace("_", ""): sum(map(int, row)) for name, row in services.items()}
    assert counts == {name.lower(): count for name, count in asked.counts.items()}
    cats = dict(zip(statuses, services["/contact_dynamics/predict_impact"], strict=True))
    assert int(cats["UNKNOWN_BODY"]) == int(cats["OK"])


def test_other_bags_and_damaged_ones(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "runs").mkdir()
    write_flight(tmp_path / "runs" / "bag")
    (whole,) = asked.log.glob("*.mcap")
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size * 3 // 10])
    assert main(["info", str(tmp_path / "runs"), str(cut)]) == 0
    bag, damaged = capsys.readouterr().out.split("\n\n" + str(cut))
    assert table(bag, "topic")["/tracker/ball"] == ["nav_msgs/msg/Odometry", str(int(0.95 * RATE))]
    assert "bodies" not in bag
    assert "service" not in bag
    assert "cut.mcap is damaged or was cut short" in damaged
    assert bag.startswith(str(tmp_path / "runs" / "bag"))
    assert main(["info", str(tmp_path / "none")]) == 2
    assert "no such file or folder" in capsys.readouterr().err
