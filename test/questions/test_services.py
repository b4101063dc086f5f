# SPDX-License-Identifier: Apache-2.0
"""Each service has one record, and what the record names exists."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.questions import ask
from contact_dynamics.questions.services import (
    SERVICES,
    Answer,
    ImportedOnUse,
    Question,
    Service,
    service_of,
    service_of_type,
)

INTERFACES = Path(__file__).parents[2] / "contact_dynamics_interfaces"


def test_every_interface_has_a_record_and_a_row_in_the_index() -> None:
    types = sorted(path.stem for path in (INTERFACES / "srv").glob("*.srv"))
    assert sorted(service.type_name for service in SERVICES) == types
    index = (INTERFACES / "README.md").read_text(encoding="utf-8")
    assert [index.count(f"| [`{name}`](srv/{name}.srv) |") for name in types] == [1] * len(types)


@pytest.mark.parametrize("service", SERVICES, ids=lambda service: service.name)
def test_what_a_record_names_exists(service: Service) -> None:
    named = [getattr(service, field.name) for field in fields(service)]
    assert all(callable(each.function) for each in named if isinstance(each, ImportedOnUse))
    for path, base in ((service.question_type, Question), (service.answer_type, Answer)):
        assert base in inspect.getmro(ImportedOnUse[Any](path).function)
    assert service.service_type.__name__ == service.type_name
    assert service_of_type(f"contact_dynamics_interfaces/srv/{service.type_name}") is service


def types_of(function: Callable[..., Any]) -> tuple[str, str]:
    """The types of a function's first parameter but ``self`` and of its result, as they are written."""
    found = inspect.signature(function)
    first = next(each for name, each in found.parameters.items() if name != "self")
    return str(first.annotation), str(found.return_annotation)


@pytest.mark.parametrize("service", SERVICES, ids=lambda service: service.name)
def test_what_one_function_returns_the_next_one_takes(service: Service) -> None:
    """The functions are named by their places, which mypy does not follow."""
    question, answer = (each.partition(":")[2] for each in (service.question_type, service.answer_type))
    request = f"{service.type_name}.Request"
    assert types_of(service.question_from_msg.function) == (request, question)
    assert types_of(service.answer.function) == (question, answer)
    for adapter in (service.answer_to_msg, service.answer_from_msg):
        table = adapter.function.__self__  # type: ignore[attr-defined]  # bound to a table of fields
        assert table.record is ImportedOnUse[Any](service.answer_type).function
        assert table.msg_type is service.service_type.Response
    if service.is_quick is not None:
        assert types_of(service.is_quick.function) == (question, "bool")
    for show in (service.words, service.draw, service.figures, service.cells):
        if show is not None:
            assert answer in types_of(show.function)[0].split(" | ")


def test_names_are_those_that_ros_would_give() -> None:
    assert [service.name.replace("_", "") for service in SERVICES] == [
        service.type_name.lower() for service in SERVICES
    ]


def test_another_type_is_rejected_by_name() -> None:
    with pytest.raises(NotSupportedError, match=r"must be one of .*PredictToss.*, got std_srvs/srv/Empty"):
        service_of_type("std_srvs/srv/Empty")


def test_a_question_of_no_service_is_rejected_by_name() -> None:
    with pytest.raises(NotSupportedError, match=r"kinds: .*Toss.*, got .*services:Question"):
        service_of(Question())


def test_what_is_no_question_is_refused() -> None:
    with pytest.raises(InvalidFieldError, match="question must be a TumblingQuestion or an Imp"):
        ask("where?")  # type: ignore[call-overload]
