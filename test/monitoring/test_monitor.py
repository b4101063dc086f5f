# SPDX-License-Identifier: Apache-2.0
"""States go in one by one, and events come out: simulated tosses, recorded ones, and the command."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmarks.flights import cube_tosses
from calibration.made_tosses import WORLD, Truth, made_tosses
from contact_dynamics.command_line import main
from contact_dynamics.evaluation.asking import Informed
from contact_dynamics.evaluation.model_error import ModelError
from contact_dynamics.evaluation.recording import Recording, recording_of_toss
from contact_dynamics.measured.events import EventKind, find_events
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.monitoring.evidence import Parameter
from contact_dynamics.monitoring.monitor import Monitor, MonitoredEvent, MonitorSettings
from contact_dynamics.monitoring.report import line_of
from contact_dynamics.monitoring.run import monitored
from contact_dynamics.questions.context import Defaults
from evaluation.made_logs import BRIEF, write_log

TOSSES = cube_tosses()
ROOT = Path(__file__).parents[2]
EXACT = Truth(friction=0.3, restitution=0.4, center=(0.0, 0.0, 0.0), inertia=1.0, gravity=9.81, tilt=0.0)
LAW = ModelError(velocity=0.02, spin=0.3)


def events_of(truth: Truth, count: int) -> list[MonitoredEvent]:
    informed = Informed(world=WORLD, defaults=Defaults(distance_tolerance=0.003), state_timeout=0.5)
    settings = MonitorSettings(error=LAW, noise=(truth.p_noise, truth.q_noise))
    monitor = Monitor(informed, settings)
    tosses = made_tosses(replace(truth, law_velocity=0.02, law_spin=0.3), count, 5)
    return [
        event
        for motion in tosses
        for event in monitored(monitor, Recording(motions=(motion,), informed=informed))
    ]


def test_tosses_as_configured_are_inside_their_regions_and_nothing_changes() -> None:
    events = events_of(EXACT, 40)
    for kind in (EventKind.FLIGHT, EventKind.LANDING, EventKind.IMPACT):
        regions = np.array([event.regions for event in events if event.kind is kind and event.regions])
        assert len(regions) >= 30
        # Of 40 at 99 %, two outside have a probability of 0.06, and four one of 0.0007.
        assert (~regions[:, 2]).sum() <= 3
        assert regions[:, 1].mean() > 0.75
    reports = [event.surface_report for event in events if event.surface_report is not None]
    assert not any(report.is_new for report in reports)
    assert np.abs((reports[-1].values - [0.4, 0.3]) / reports[-1].stds).max() < 4.0


@pytest.mark.parametrize(
    ("truth", "parameter"),
    [
        (replace(EXACT, friction=0.18), Parameter.FRICTION),
        (replace(EXACT, restitution=0.24), Parameter.RESTITUTION),
    ],
)
def test_tosses_with_another_coefficient_are_reported(truth: Truth, parameter: Parameter) -> None:
    reports = [event.surface_report for event in events_of(truth, 12) if event.surface_report is not None]
    assert reports[-1].changed is parameter
    k = list(Parameter).index(parameter)
    assert abs(reports[-1].values[k] - (truth.restitution, truth.friction)[k]) < 4.0 * reports[-1].stds[k]


def test_a_body_that_sticks_where_sliding_was_predicted_is_named() -> None:
    event = MonitoredEvent(
        kind=EventKind.REST,
        body="brick",
        surface="floor",
        stamp_ns=0,
        measured=np.zeros(13),
        measured_mode="ffff",
        predicted_mode="cccc",
        as_predicted=False,
    )
    assert line_of(event).endswith("ffff (it stays fixed) measured, predicted cccc (it slides)")


def test_states_one_by_one_give_the_events_of_the_whole() -> None:
    toss = read_toss()
    recorded = recording_of_toss(toss)
    settings = MonitorSettings(noise=(toss.position_noise, toss.orientation_noise))
    events = list(monitored(Monitor(recorded.informed, settings), recorded))
    (motion,) = recorded.motions
    for kind in (EventKind.FLIGHT, EventKind.LANDING, EventKind.IMPACT):
        expected = [event.time_ns for event in find_events(motion) if event.kind is kind]
        found = [event.stamp_ns for event in events if event.kind is kind]
        assert len(found) == len(expected)
        # The fits of a flight do not depend on what is kept, and its beginning may.
        assert np.allclose(sorted(found), expected, rtol=0.0, atol=2e6)
    kinds = [event.kind for event in events if event.kind in {EventKind.REST, EventKind.SLIDING}]
    assert kinds.count(EventKind.REST) == sum(event.kind is EventKind.REST for event in find_events(motion))


def test_a_recording_that_is_played_again_has_its_events_again() -> None:
    toss = read_toss()
    recorded = recording_of_toss(toss)
    (motion,) = recorded.motions
    monitor = Monitor(recorded.informed, MonitorSettings(noise=(toss.position_noise, toss.orientation_noise)))
    states = [
        each for each in motion.states(list(range(len(motion)))) if each.stamp_ns < 1.2e9 + motion.epoch_ns
    ]
    first, second = (
        [event for state in states for event in monitor.add("brick", state, state.stamp_ns)] for _ in range(2)
    )
    left = monitor.settle("brick")
    assert first
    # What was left of the first time comes when the second begins.
    assert [each.stamp_ns for each in second] == [each.stamp_ns for each in [*left, *first]]


def test_the_command_prints_the_events_of_a_log(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = write_log(tmp_path / "log", until=BRIEF)
    out = tmp_path / "events.jsonl"
    assert main(["monitor", str(log), "--json", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "landing" in printed
    assert "inside" in printed
    rows = [json.loads(line) for line in out.read_text(encoding="utf-8").splitlines()]
    assert {"flight", "landing"} <= {row["kind"].lower() for row in rows}


def test_the_command_names_a_file_that_is_no_calibration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = tmp_path / "wrong.json"
    wrong.write_text("{}", encoding="utf-8")
    assert main(["monitor", "brick.csv", "--calibration", str(wrong)]) == 2
    assert "calibrate --json" in capsys.readouterr().err


def test_a_calibration_of_another_body_and_its_problems_are_named(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log, found = write_log(tmp_path / "log", until=BRIEF), tmp_path / "cube.json"
    spread = {"velocity": 0.02, "spin": 0.3, "strike_height": 0.0}
    content = {"spread": spread, "body": {"name": "cube"}, "problems": ["Too few impacts."]}
    found.write_text(json.dumps(content), encoding="utf-8")
    main(["monitor", str(log), "--calibration", str(found)])
    told = capsys.readouterr().err
    assert "calibration: the model errors of 'cube' are applied to brick" in told
    assert "calibration: Too few impacts." in told
    main(["evaluate", str(log), "--calibration", str(found), "--horizons", "50", "--laws", "poisson"])
    told = capsys.readouterr().err
    assert "calibration: the model errors of 'cube' are applied to brick" in told
    found.write_text(json.dumps({"spread": spread, "body": {"name": "brick"}}), encoding="utf-8")
    main(["monitor", str(log), "--calibration", str(found)])
    assert "calibration" not in capsys.readouterr().err


@pytest.mark.skipif(not TOSSES.is_file(), reason=f"no published tosses at {TOSSES} (CUBE_TOSSES)")
def test_recorded_cubes_as_calibrated_and_with_less_friction(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What calibration finds explains other tosses; 40 % less friction is reported and named within 30."""
    split = json.loads((ROOT / "benchmarks" / "cube_split.json").read_text(encoding="utf-8"))
    yaml, found = tmp_path / "cube.yaml", tmp_path / "cube.json"
    few = [f"{TOSSES}#{number}" for number in split["few"]]
    main(["calibrate", *few, "--yaml", str(yaml), "--json", str(found), "--no-trajectories"])
    others = [f"{TOSSES}#{number}" for number in split["test"][:30]]
    assert main(["monitor", *others, "--config", str(yaml), "--calibration", str(found)]) == 0
    text = yaml.read_text(encoding="utf-8")
    (friction,) = re.findall(r"board.friction: (.*)", text)
    less = tmp_path / "less.yaml"
    less.write_text(text.replace(friction, repr(0.6 * float(friction))), encoding="utf-8")
    capsys.readouterr()
    assert main(["monitor", *others, "--config", str(less), "--calibration", str(found)]) == 1
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.endswith("friction changed")
    (estimate,) = re.findall(r"friction ([0-9.]+) ", last)
    assert abs(float(estimate) - float(friction)) < 0.15 * float(friction)
