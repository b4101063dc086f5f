# SPDX-License-Identifier: Apache-2.0
"""Each case over ROS 2: the response has the exact number where the case says."""

from __future__ import annotations

from functools import reduce
from typing import Any

import pytest
import yaml

from contact_dynamics.cases import CASES
from nodes.test_same_question import filled
from running_server import SERVICES, Client

SETTINGS = [(name, setting) for name, case in CASES.items() for setting in case.settings]


def field(response: Any, path: str) -> float:
    """The number at a path such as `modes[0].linear_acceleration[2]`."""
    steps = path.replace("[", ".").replace("]", "").split(".")
    return float(
        reduce(lambda msg, step: msg[int(step)] if step.isdigit() else getattr(msg, step), steps, response)
    )


@pytest.mark.parametrize(("name", "setting"), SETTINGS)
def test_the_service_gives_the_exact_number(client: Client, name: str, setting: float) -> None:
    case = CASES[name]
    service_name, path = case.answer.split(".", maxsplit=1)
    (service,) = (one for one, address in SERVICES.items() if address.endswith(f"/{service_name}"))
    response = client.ask(filled(service.Request(), yaml.safe_load(case.request_text(setting))))
    assert (response.status, response.message) == (response.OK, "")
    exact, tolerance = case.answer_of(setting)
    assert abs(field(response, path) - exact) <= tolerance
