# SPDX-License-Identifier: Apache-2.0
"""One process, several, and Dask: the same numbers to the bit; a bad recording or worker stops nobody."""

from __future__ import annotations

import json
import os
import signal
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import pytest

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.evaluation.jobs import Job, processes_for, run_job, run_jobs
from contact_dynamics.evaluation.recording import Recording
from contact_dynamics.evaluation.result import SourceResult, source_result
from contact_dynamics.evaluation.settings import Law, Settings
from contact_dynamics.evaluation.sources import Source
from contact_dynamics.measured.read_toss import DEFAULT_RECORDING
from evaluation.made_logs import BRIEF, write_log

QUICK = Settings(horizons=(0.05,), laws=(Law.POISSON,))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class DeadlySource(Source):
    """A recording that kills whoever reads it."""

    def read(self, *, config: Path | None = None) -> Recording:  # noqa: ARG002
        os.kill(os.getpid(), signal.SIGKILL)
        raise AssertionError


@pytest.fixture(scope="module")
def jobs(tmp_path_factory: pytest.TempPathFactory) -> list[Job]:
    """The beginnings of three tosses, the last two with noise, and a file that is none."""
    folder = tmp_path_factory.mktemp("logs")
    logs = [write_log(folder / f"log{seed}", seed=seed, until=BRIEF) for seed in (None, 0, 1)]
    bad = folder / "bad.mcap"
    bad.write_bytes(b"no log at all")
    sources = [Source(path=path) for path in (*logs, bad)]
    return [Job(source=source, settings=QUICK) for source in sources]


def results(done: Iterable[tuple[int, SourceResult]]) -> dict[int, dict[str, Any]]:
    """Every value of the results, by the numbers of their jobs."""
    return {number: result.to_dict() for number, result in done}


@pytest.fixture(scope="module")
def alone(jobs: list[Job]) -> list[dict[str, Any]]:
    return [run_job(job).to_dict() for job in jobs]


def test_a_bad_recording_is_named_and_the_rest_are_done(jobs: list[Job], alone: list[dict[str, Any]]) -> None:
    assert [bool(content["problem"]) for content in alone] == [False, False, False, True]
    assert alone[-1]["source"] == str(jobs[-1].source.path)
    assert alone[-1]["problem"].startswith("NotALogError: ")
    assert all(content["comparisons"] for content in alone[:-1])


def test_a_result_comes_back_from_json_to_the_bit(alone: list[dict[str, Any]]) -> None:
    for content in alone:
        assert source_result(json.loads(json.dumps(content))).to_dict() == content


def test_processes_share_logs_bodies_and_events_and_give_the_numbers_of_one(
    jobs: list[Job], alone: list[dict[str, Any]], tmp_path: Path
) -> None:
    """Two for each recording: by bodies where it has several, and by the events of one body."""
    several = write_log(tmp_path / "several", names=("one", "silent", "two"), until=BRIEF)
    empty = write_log(tmp_path / "empty", names=("one", "two"), until=-1.0)
    shared_jobs = [*(Job(source=Source(path=path), settings=QUICK) for path in (several, empty)), jobs[1]]
    shared = results(run_jobs(shared_jobs, processes=6))
    assert [shared[i] for i in range(3)] == [*(run_job(job).to_dict() for job in shared_jobs[:2]), alone[1]]
    bodies = [event["body"] for event in shared[0]["events"]]
    assert bodies == ["one"] * (len(bodies) // 2) + ["two"] * (len(bodies) // 2)
    assert "no state of a configured body" in shared[1]["problem"]
    halves = [run_job(Job(source=part, settings=QUICK)) for part in jobs[1].source.parts(2)]
    asked = [{row.event for row in half.comparisons} for half in halves]
    assert all(asked)
    assert not asked[0] & asked[1]


def test_only_long_or_many_recordings_start_processes_by_default(jobs: list[Job], tmp_path: Path) -> None:
    large = tmp_path / "large.mcap"
    with large.open("wb") as file:
        file.truncate(1 << 40)
    toss = Job(source=Source(path=DEFAULT_RECORDING), settings=QUICK)
    assert processes_for(jobs) == processes_for([toss] * 7) == 1
    assert processes_for([replace(toss, source=Source(path=tmp_path / "missing.mcap"))]) == 1
    assert processes_for([replace(toss, source=Source(path=large))]) == os.cpu_count()
    assert processes_for([toss] * 10_000) == os.cpu_count()


def test_a_recording_that_kills_its_process_is_named_and_the_rest_are_done(
    jobs: list[Job], alone: list[dict[str, Any]]
) -> None:
    deadly = Job(source=DeadlySource(path=jobs[0].source.path), settings=QUICK)
    done = results(run_jobs([jobs[0], deadly, jobs[3]], processes=2))
    assert done[0] == alone[0]
    assert done[2] == alone[3]
    assert done[1]["problem"].startswith("BrokenProcessPool")


@pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::ResourceWarning")
def test_dask_gives_the_numbers_of_one_process(jobs: list[Job], alone: list[dict[str, Any]]) -> None:
    pytest.importorskip("distributed", reason="dask[distributed] of requirements/test.txt is not installed")
    shared = results(run_jobs(jobs[2:], dask="local:1"))
    assert [shared[i] for i in range(2)] == alone[2:]


@pytest.mark.parametrize("address", ["local:", "local:0", "local:two"])
def test_an_address_that_is_none_is_refused(jobs: list[Job], address: str) -> None:
    pytest.importorskip("distributed", reason="dask[distributed] of requirements/test.txt is not installed")
    with pytest.raises(InvalidFieldError, match="--dask"):
        list(run_jobs(jobs, dask=address))


def test_a_key_tells_content_settings_and_configuration_apart(jobs: list[Job], tmp_path: Path) -> None:
    config = tmp_path / "a.yaml"
    config.write_text("/**: {ros__parameters: {horizon: 1.0}}", encoding="utf-8")
    job = jobs[0]
    others = [
        jobs[1],
        replace(job, settings=Settings(horizons=(0.06,), laws=(Law.POISSON,))),
        replace(job, config=config),
        replace(job, asked_with=config),
    ]
    keys = {each.key() for each in [job, *others]}
    assert len(keys) == 5
    config.write_text("/**: {ros__parameters: {horizon: 2.0}}", encoding="utf-8")
    assert {each.key() for each in others[2:]}.isdisjoint(keys)


def test_a_key_does_not_depend_on_where_a_recording_lies(tmp_path: Path) -> None:
    moved = tmp_path / "moved.csv"
    moved.write_bytes(DEFAULT_RECORDING.read_bytes())
    keys = {Job(source=Source(path=path), settings=QUICK).key() for path in (DEFAULT_RECORDING, moved)}
    assert len(keys) == 1
