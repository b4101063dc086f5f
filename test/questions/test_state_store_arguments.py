# SPDX-License-Identifier: Apache-2.0
"""A store of states and logs reject arguments of wrong types and sizes by name."""

from __future__ import annotations

import math
from typing import Any

import pytest

from contact_dynamics.errors import InvalidFieldError, WrongTypeError
from contact_dynamics.questions import StateStore
from contact_dynamics.recording import BagReader, BagWriter, service_calls

LIMITS = {"history": 5.0, "timeout": 0.5}


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("history", b"ab"),
        ("history", "5"),
        ("history", -5.0),
        ("timeout", None),
        ("timeout", math.inf),
        ("future_tolerance", math.nan),
        ("max_states", "3"),
        ("max_states", 0),
    ],
)
def test_a_limit_that_is_none_is_rejected_by_name(name: str, value: Any) -> None:
    with pytest.raises(InvalidFieldError, match=name):
        StateStore(**{**LIMITS, name: value})


@pytest.mark.parametrize(
    ("method", "arguments", "name"),
    [
        ("add", ("brick", 1), "state"),
        ("add", (1, None), "body_name"),
        ("newest", (None,), "body_name"),
        ("window", ("brick", "newest", 1.0), "newest"),
    ],
)
def test_a_wrong_type_is_rejected_by_name(method: str, arguments: tuple[Any, ...], name: str) -> None:
    with pytest.raises(WrongTypeError, match=f"{name} must be"):
        getattr(StateStore(**LIMITS), method)(*arguments)


@pytest.mark.parametrize(
    ("function", "name"), [(BagReader, "path"), (BagWriter, "folder"), (service_calls, "messages")]
)
def test_a_log_is_rejected_by_name(function: Any, name: str) -> None:
    with pytest.raises(WrongTypeError, match=f"{name} must be"):
        function(3)
