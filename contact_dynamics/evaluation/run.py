# SPDX-License-Identifier: Apache-2.0
"""Runs `contact-dynamics evaluate`: evaluates recordings, prints the report and writes the output files."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Final

from contact_dynamics.evaluation.arguments import NOTHING, check_writable, evaluate_parser, run_on_recordings
from contact_dynamics.evaluation.jobs import (
    Job,
    ResultsFolder,
    code_versions,
    failed,
    processes_for,
    run_jobs,
)
from contact_dynamics.evaluation.log_states import parameters_of
from contact_dynamics.evaluation.model_error import model_error_of
from contact_dynamics.evaluation.plots import write_plots
from contact_dynamics.evaluation.report import report, report_changes
from contact_dynamics.evaluation.result import (
    Evaluation,
    SourceResult,
    read_evaluation,
    write_csv,
    write_parquet,
)
from contact_dynamics.evaluation.settings import Settings
from contact_dynamics.evaluation.significance import changes
from contact_dynamics.evaluation.sources import find_sources
from contact_dynamics.nodes.parameter_file import ParameterFile
from contact_dynamics.replay.progress import Progress

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from contact_dynamics.evaluation.sources import Source

SOME_BAD: Final = 1  # exit code: some recordings could not be evaluated


def main(arguments: list[str]) -> int:
    """Evaluate; return the exit code."""
    return run_on_recordings(evaluate_parser(), arguments, _evaluate)


def _evaluate(given: argparse.Namespace) -> int:
    chosen = {name: getattr(given, name) for name in ("horizons", "laws", "fit_window")}
    chosen["error"] = None if given.calibration is None else model_error_of(given.calibration)
    settings = Settings(**{name: value for name, value in chosen.items() if value is not None})
    _check_writable(given)
    against = _against(given.against)
    if given.config is not None:
        parameters_of(ParameterFile(given.config))  # reports an error once, not for each recording
    sources, refused = find_sources(given.recordings)
    nameless = [SourceResult(source=name, problem=reason) for name, reason in refused]
    evaluation = _all(given, settings, sources, nameless)
    bad = sum(bool(result.problem) for result in evaluation.results)
    if bad == len(evaluation.results):  # an empty report would hide the reasons
        for result in evaluation.results:
            print(f"contact-dynamics evaluate: {result.source}: {result.problem}", file=sys.stderr)
        return NOTHING
    print(report(evaluation), flush=True)
    bodies = (event.body for result in evaluation.results for event in result.events)
    for doubt in settings.error.doubts(bodies):
        print(doubt, file=sys.stderr)
    _write(given, evaluation)
    if given.against is not None:
        other = against or _all(given, settings, sources, [], asked_with=given.against)
        print(report_changes(changes(evaluation, other), names=(_name(given), str(given.against))))
    return SOME_BAD if bad else 0


def _name(given: argparse.Namespace) -> str:
    return "what the recordings say" if given.config is None else str(given.config)


def _against(path: Path | None) -> Evaluation | None:
    """Return the evaluation in a JSON file, or check a configuration before the evaluation starts."""
    if path is None:
        return None
    if path.suffix == ".json":
        return read_evaluation(path)
    parameters_of(ParameterFile(path))
    return None


def _check_writable(given: argparse.Namespace) -> None:
    """Check that the outputs can be written, before the evaluation starts."""
    check_writable(given.json, given.csv, given.parquet, given.rerun)
    for folder in (given.plots, given.results):
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)


def _all(
    given: argparse.Namespace,
    settings: Settings,
    sources: Sequence[Source],
    nameless: Sequence[SourceResult],
    *,
    asked_with: Path | None = None,
) -> Evaluation:
    """Evaluate the recordings that have no stored result yet, and return the complete evaluation."""
    jobs = [
        Job(source=source, settings=settings, config=given.config, asked_with=asked_with)
        for source in sources
    ]
    folder = None if given.results is None else ResultsFolder(given.results)
    found: dict[int, SourceResult] = {}
    left = []
    for number, job in enumerate(jobs):
        try:
            result = None if folder is None else folder.find(job)
        except OSError as error:
            result = failed(job, error)
        if result is None:
            left.append(number)
        else:
            found[number] = result
    before = len(found)
    if found:
        print(f"{len(found)} of {len(jobs)} recordings were evaluated before", file=sys.stderr)
    waiting = [jobs[i] for i in left]
    progress = Progress("evaluating", end=len(left))
    try:
        for done, result in run_jobs(
            waiting, processes=given.jobs or processes_for(waiting), dask=given.dask
        ):
            job = jobs[left[done]]
            if folder is not None:
                folder.put(job, result)
            found[left[done]] = result
            count = len(found) - before
            progress.tell(count, f"{count} of {len(left)}: {job.source.name[-60:]}")
    finally:
        progress.end()
    return Evaluation(
        versions=code_versions(),
        configuration=f"described by {_name(given)}",
        results=(*(found[number] for number in range(len(jobs))), *nameless),
    )


def _write(given: argparse.Namespace, evaluation: Evaluation) -> None:
    if given.json is not None:
        evaluation.write_json(given.json)
    if given.csv is not None:
        write_csv(given.csv, evaluation)
    if given.parquet is not None:
        write_parquet(given.parquet, evaluation)
    if given.plots is not None:
        for path in write_plots(given.plots, evaluation):
            print(f"drawn: {path}")
    if given.rerun is not None:
        from contact_dynamics.evaluation.picture import write_picture  # imports rerun

        drawn = write_picture(given.rerun, evaluation, find_sources(given.recordings)[0], config=given.config)
        print(f"drawn: {given.rerun} with {drawn} events")
