# SPDX-License-Identifier: Apache-2.0
"""The interface files: a comment for each field, and enumerations that equal those of the physics."""

from __future__ import annotations

import re
from enum import IntEnum
from pathlib import Path
from typing import Any

import pytest

from contact_dynamics.contact.contact import MAX_CONTACTS
from contact_dynamics.contact_modes import ModeVerdict, Refusal
from contact_dynamics.impact import ImpactOutcome, PathEvent, RestitutionLaw, SequenceEnd
from contact_dynamics.measured.events import EventKind as MonitoredKind
from contact_dynamics.monitoring.evidence import REGIONS, Parameter
from contact_dynamics.motion import Method
from contact_dynamics.questions import EventKind, Problem
from contact_dynamics.questions.bodies_contact_modes import MAX_BODIES
from contact_dynamics.questions.many import MAX_STATES
from contact_dynamics.questions.many_contact_modes import MAX_CANDIDATES
from contact_dynamics.questions.sample_times import MAX_SAMPLES
from contact_dynamics.questions.tumbling import FLIPS, MAX_COVARIANCES, MAX_CURVE_POINTS
from contact_dynamics.toss import BranchKind, TossEnd, TossEventKind, UndecidedReason
from contact_dynamics.toss.uncertainty import MAX_PARAMETERS
from contact_dynamics_interfaces.msg import (
    BodyStates,
    ContactSet,
    Impact,
    MonitorEvent,
    Poinsot,
    TossBranch,
    TossEvent,
    TossPath,
    Trajectory,
)
from contact_dynamics_interfaces.srv import (
    PredictBodiesContactMode,
    PredictContactMode,
    PredictContactModeBatch,
    PredictImpact,
    PredictImpactBatch,
    PredictToss,
    PredictTumbling,
    PredictTumblingBatch,
)
from sweeps import each

INTERFACES = Path(__file__).parents[2] / "contact_dynamics_interfaces"
FILES = sorted([*INTERFACES.glob("msg/*.msg"), *INTERFACES.glob("srv/*.srv")])
FIELD = re.compile(r"^[a-zA-Z_][\w/]*(\[[<=\d]*\])? +[a-z]\w*( +-?[\d.]+)?\s*(#.*)?$")
CONSTANT = re.compile(r"^[a-z]\w* +[A-Z]\w* *= *\S+")


def blocks(path: Path) -> list[list[str]]:
    """Runs of lines without an empty line between them."""
    return [
        block.splitlines()
        for block in re.split(r"\n\s*\n|\n---\n", path.read_text(encoding="utf-8"))
        if block.strip()
    ]


@each("path", FILES)
def test_every_block_of_fields_begins_with_a_comment(path: Path) -> None:
    fields = 0
    for block in blocks(path):
        declared = [line for line in block if FIELD.match(line)]
        fields += len(declared)
        assert not declared or block[0].startswith("#"), f"{path.name}: no comment for {declared}"
    assert fields > 0


@each("path", FILES)
def test_every_line_is_understood(path: Path) -> None:
    for line in path.read_text(encoding="utf-8").splitlines():
        assert (
            not line
            or line.lstrip().startswith("#")
            or line == "---"
            or FIELD.match(line)
            or CONSTANT.match(line)
        ), line


def constants(message: type, names: list[str]) -> dict[str, int]:
    """The values of named constants of a message class."""
    return {name: getattr(message, name) for name in names}


@pytest.mark.parametrize(
    ("enum", "message"),
    [
        (ImpactOutcome, Impact),
        (PathEvent, Impact),
        (SequenceEnd, Impact),
        (RestitutionLaw, PredictImpact.Request),
        (RestitutionLaw, PredictImpactBatch.Request),
        (RestitutionLaw, PredictToss.Request),
        (TossEventKind, TossEvent),
        (TossEnd, TossPath),
        (UndecidedReason, TossPath),
        (BranchKind, TossBranch),
        (Problem, PredictImpact.Request),
        (Problem, PredictContactMode.Request),
        (EventKind, PredictTumbling.Response),
        (Method, PredictTumbling.Response),
        (ModeVerdict, PredictContactMode.Response),
        (ModeVerdict, PredictBodiesContactMode.Response),
        (Refusal, PredictContactMode.Response),
    ],
    ids=lambda value: value.__name__,
)
def test_enumerations_equal_those_of_the_messages(enum: type[IntEnum], message: type) -> None:
    refused = {SequenceEnd.WINDOW_ENDED}  # the service answers a sequence without a strike with a status
    values = {member.name: int(member) for member in enum if member not in refused}
    assert values == constants(message, list(values))


def test_the_names_in_a_monitor_event_are_those_of_the_monitor() -> None:
    assert {kind.name: kind.value for kind in MonitoredKind} == {
        name: getattr(MonitorEvent, name) for name in MonitoredKind.__members__
    }
    assert [one.value for one in Parameter] == [MonitorEvent.RESTITUTION, MonitorEvent.FRICTION]
    assert [round(100 * region) for region in REGIONS] == [
        MonitorEvent.INSIDE_50,
        MonitorEvent.INSIDE_90,
        MonitorEvent.INSIDE_99,
    ]


def test_status_codes_are_the_same_in_all_services() -> None:
    numbers: dict[str, set[int]] = {}
    for service in (
        PredictContactMode,
        PredictImpact,
        PredictTumbling,
        PredictToss,
        PredictContactModeBatch,
        PredictBodiesContactMode,
        PredictImpactBatch,
        PredictTumblingBatch,
    ):
        text = (INTERFACES / f"srv/{service.__name__}.srv").read_text(encoding="utf-8")
        names = re.findall(r"^uint16 ([A-Z_]+) = ", text, flags=re.MULTILINE)
        assert len(names) >= 5, service
        for name in names:
            numbers.setdefault(name, set()).add(getattr(service.Response, name))
    assert all(len(values) == 1 for values in numbers.values()), numbers
    every = [number for values in numbers.values() for number in values]
    assert len(set(every)) == len(every), numbers
    assert hasattr(Poinsot, "SEPARATRIX")


@pytest.mark.parametrize(
    ("message", "field", "most"),
    [
        (PredictTumbling.Request, "times", MAX_SAMPLES),
        (PredictTumbling.Request, "stamps_ns", MAX_SAMPLES),
        (Trajectory, "times", MAX_SAMPLES),
        (Trajectory, "orientations", 4 * MAX_SAMPLES),
        (Trajectory, "covariances", 144 * MAX_COVARIANCES),
        (Trajectory, "covariances_trusted", MAX_COVARIANCES),
        (Poinsot, "flip_times", FLIPS),
        (Poinsot, "curve_times", MAX_CURVE_POINTS),
        (Poinsot, "polhode", 3 * MAX_CURVE_POINTS),
        (ContactSet, "frictions", MAX_CONTACTS),
        (ContactSet, "positions", 3 * MAX_CONTACTS),
        (ContactSet, "surface_names", MAX_CONTACTS),
        (BodyStates, "orientations", 4 * MAX_STATES),
        (PredictImpactBatch.Response, "outcomes", MAX_STATES),
        (PredictContactModeBatch.Request, "contact_counts", MAX_CANDIDATES),
        (PredictContactModeBatch.Request, "torques", 3 * MAX_CANDIDATES),
        (PredictBodiesContactMode.Request, "states", MAX_BODIES),
        (PredictBodiesContactMode.Request, "applied_wrenches", MAX_BODIES),
        (PredictBodiesContactMode.Request, "other_bodies", MAX_CONTACTS),
        (PredictToss.Request, "parameter_covariance", MAX_PARAMETERS**2),
        (Impact, "outcome_probabilities", len(ImpactOutcome)),
    ],
)
def test_bounds_of_lists_are_those_of_the_physics(message: Any, field: str, most: int) -> None:
    assert f", {most}>" in message.get_fields_and_field_types()[field]
