"""The interface files: a comment for each field, and enumerations that equal those of the physics."""

from __future__ import annotations

import re
from enum import IntEnum
from pathlib import Path

import pytest

from contact_dynamics.contact_modes.result import ModeVerdict, Refusal
from contact_dynamics.impact import ImpactOutcome, PathEvent, RestitutionLaw, SequenceEnd
from contact_dynamics.motion.integrated import Method
from contact_dynamics.questions import EventKind, Problem
from contact_dynamics_interfaces.msg import Impact, Poinsot
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact, PredictTumbling

INTERFACES = Path(__file__).parents[2] / "contact_dynamics_interfaces"
FILES = sorted([*INTERFACES.glob("msg/*.msg"), *INTERFACES.glob("srv/*.srv")])
FIELD = re.compile(r"^[a-zA-Z_][\w/]*(\[[<=\d]*\])? +[a-z]\w*\s*(#.*)?$")
CONSTANT = re.compile(r"^[a-z]\w* +[A-Z]\w* *= *\S+")


def blocks(path: Path) -> list[list[str]]:
    """Runs of lines without an empty line between them."""
    return [
        block.splitlines()
        for block in re.split(r"\n\s*\n|\n---\n", path.read_text(encoding="utf-8"))
        if block.strip()
    ]


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_block_of_fields_begins_with_a_comment(path: Path) -> None:
    fields = 0
    for block in blocks(path):
        declared = [line for line in block if FIELD.match(line)]
        fields += len(declared)
        assert not declared or block[0].startswith("#"), f"{path.name}: no comment for {declared}"
    assert fields > 0


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
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
        (Problem, PredictImpact.Request),
        (Problem, PredictContactMode.Request),
        (EventKind, PredictTumbling.Response),
        (Method, PredictTumbling.Response),
        (ModeVerdict, PredictContactMode.Response),
        (Refusal, PredictContactMode.Response),
    ],
    ids=lambda value: value.__name__,
)
def test_enumerations_equal_those_of_the_messages(enum: type[IntEnum], message: type) -> None:
    refused = {SequenceEnd.WINDOW_ENDED}  # the service answers a sequence without a strike with a status
    values = {member.name: int(member) for member in enum if member not in refused}
    assert values == constants(message, list(values))


def test_status_codes_have_one_meaning_at_one_offset() -> None:
    offsets: dict[str, set[int]] = {}
    for base, service in ((100, PredictContactMode), (200, PredictImpact), (300, PredictTumbling)):
        found = 0
        for name in dir(service.Response):
            if name.isupper() and name not in dir(Impact):
                value = getattr(service.Response, name)
                if base < value < base + 100:
                    offsets.setdefault(name, set()).add(value - base)
                    found += 1
        assert found >= 8, service
    assert all(len(values) == 1 for values in offsets.values()), offsets
    assert hasattr(Poinsot, "SEPARATRIX")
