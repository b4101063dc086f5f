"""Each service has one record, and what the record names exists."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.nodes.services import SERVICES, ImportedOnUse, Service, service_of_type
from contact_dynamics.viewing.picture import Picture

INTERFACES = Path(__file__).parents[2] / "contact_dynamics_interfaces" / "srv"


def test_every_interface_has_a_record() -> None:
    assert sorted(service.type_name for service in SERVICES) == sorted(
        path.stem for path in INTERFACES.glob("*.srv")
    )


@pytest.mark.parametrize("service", SERVICES, ids=lambda service: service.name)
def test_what_a_record_names_exists(service: Service) -> None:
    named = [getattr(service, field.name) for field in fields(service)]
    found = [each.function for each in named if isinstance(each, ImportedOnUse)]
    assert all(callable(each) for each in found)
    assert len(found) >= 6
    assert vars(Picture)[service.draw.function.__name__] is service.draw.function
    assert service.service_type.__name__ == service.type_name
    assert service_of_type(f"contact_dynamics_interfaces/srv/{service.type_name}") is service


def types_of(function: Callable[..., Any]) -> tuple[str, str]:
    """The types of a function's first parameter and of its result, as they are written."""
    found = inspect.signature(function)
    return str(next(iter(found.parameters.values())).annotation), str(found.return_annotation)


@pytest.mark.parametrize("service", SERVICES, ids=lambda service: service.name)
def test_what_one_function_returns_the_next_one_takes(service: Service) -> None:
    """The functions are named by their places, which mypy does not follow."""
    request, question = types_of(service.question_from_msg.function)
    asked, answer = types_of(service.answer.function)
    assert (request, asked) == (f"{service.type_name}.Request", question)
    assert types_of(service.answer_to_msg.function) == (answer, f"{service.type_name}.Response")
    assert types_of(service.answer_from_msg.function) == (f"{service.type_name}.Response", answer)
    assert answer in types_of(service.rows.function)[0].split(" | ")
    drawn = list(inspect.signature(service.draw.function).parameters.values())[1].annotation
    assert answer in str(drawn).split(" | ")
    if service.predicted is not None:
        assert types_of(service.predicted.function)[0] == answer


def test_names_are_those_that_ros_would_give() -> None:
    assert [service.name for service in SERVICES][:1] == ["predict_contact_mode"]
    assert "predict_contact_mode_batch" in {service.name for service in SERVICES}


def test_another_type_is_refused_by_name() -> None:
    with pytest.raises(NotSupportedError, match=r"must be one of .*PredictToss.*, got std_srvs/srv/Empty"):
        service_of_type("std_srvs/srv/Empty")
