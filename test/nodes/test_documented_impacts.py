"""The requests for impacts that the interfaces' README gives for pasting, and the answers that it states."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from geometry_msgs.msg import Vector3

from contact_dynamics.impact import ImpactOutcome, SequenceEnd
from contact_dynamics_interfaces.msg import Impact
from contact_dynamics_interfaces.srv import PredictImpact
from running_server import ROOT, Client, server_and_client

README = (ROOT / "contact_dynamics_interfaces" / "README.md").read_text(encoding="utf-8")
CALL = re.compile(
    r"^ros2 service call /contact_dynamics/predict_impact contact_dynamics_interfaces/srv/"
    r'PredictImpact \\\n  "([^"]*)"\n#> (.*)$',
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
        field = getattr(msg, name)
        if isinstance(value, dict):
            fill(field, value)
        elif name == "other_state":
            setattr(msg, name, [fill(type(msg.state)(), state) for state in value])
        else:
            setattr(msg, name, value)
    return msg


def numbers(vector: Vector3) -> str:
    return ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in (vector.x, vector.y, vector.z))


def told(impact: Impact) -> str:
    """What the README says of an impact."""
    if impact.strike_times:
        said = f"{len(impact.strike_times)} strikes, {SequenceEnd(impact.sequence_end).name}"
    elif impact.outcome == Impact.NOT_TOLD:
        said = "NOT_TOLD"
    else:
        said = ImpactOutcome(impact.outcome).name
    states = [impact.state_after, *impact.other_state_after]
    velocities = "; ".join(
        f"({numbers(state.linear_velocity)}), ({numbers(state.angular_velocity)})" for state in states
    )
    return f"{said}: {velocities}"


def test_every_example_is_found() -> None:
    assert len(EXAMPLES) == README.count("ros2 service call /contact_dynamics/predict_impact") == 6


@pytest.mark.parametrize(("request_text", "stated"), EXAMPLES)
def test_each_is_answered_as_stated(client: Client, request_text: str, stated: str) -> None:
    answer = client.ask(fill(PredictImpact.Request(), yaml.safe_load(request_text)))
    assert (answer.status, answer.message) == (answer.OK, "")
    assert told(answer.impact) == stated
