"""The requests that the interfaces' README gives for pasting, and the answers that it states."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics_interfaces.srv import PredictContactMode
from running_server import ROOT, Client, server_and_client

README = (ROOT / "contact_dynamics_interfaces" / "README.md").read_text(encoding="utf-8")
CALL = re.compile(
    r"^ros2 service call /contact_dynamics/predict_contact_mode contact_dynamics_interfaces/srv/"
    r'PredictContactMode \\\n  "([^"]*)"\n#> (.*)$',
    re.MULTILINE,
)
EXAMPLES = CALL.findall(README)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    with server_and_client(Path(tmp_path_factory.mktemp("log"))) as client:
        yield client


def fill(msg: Any, fields: dict[str, Any]) -> Any:
    """Set the fields of a message as `ros2 service call` does."""
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(msg, name), value)
        else:
            setattr(msg, name, value)
    return msg


def told(verdict: int, modes: list[Any]) -> str:
    letters = " ".join(sorted(mode.mode for mode in modes))
    return f"{ModeVerdict(verdict).name}: {letters}" if modes else ModeVerdict(verdict).name


def test_every_example_is_found() -> None:
    assert len(EXAMPLES) == README.count("ros2 service call /contact_dynamics/predict_contact_mode") == 7


@pytest.mark.parametrize(("request_text", "stated"), EXAMPLES)
def test_each_is_answered_as_stated(client: Client, request_text: str, stated: str) -> None:
    request = fill(PredictContactMode.Request(), yaml.safe_load(request_text))
    answer = client.ask(request)
    assert (answer.status, answer.message) == (answer.OK, "")
    said = told(answer.verdict, answer.modes)
    if answer.impact:
        said += f", after the impact {told(answer.verdict_after_impact, answer.modes_after_impact)}"
    assert said == stated
    asked_for = {
        "want_wrenches": answer.wrench_sets,
        "want_statics": answer.equilibrium,
        "want_impact": answer.impact,
        "want_margins": answer.modes and answer.modes[0].margin == answer.modes[0].margin,
    }
    for field, found in asked_for.items():
        assert bool(found) == getattr(request, field), field
