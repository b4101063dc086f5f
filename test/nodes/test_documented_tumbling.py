"""The questions about tumbling that the interfaces' README gives for pasting, and the answers it states."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from contact_dynamics.forced_motion import Method
from contact_dynamics.tumbling import Regime
from contact_dynamics_interfaces.srv import PredictTumbling
from running_server import ROOT, Client, server_and_client

README = (ROOT / "contact_dynamics_interfaces" / "README.md").read_text(encoding="utf-8")
CALL = re.compile(
    r"^ros2 service call /contact_dynamics/predict_tumbling contact_dynamics_interfaces/srv/"
    r'PredictTumbling \\\n  "([^"]*)"\n#> (.*)$',
    re.MULTILINE,
)
EXAMPLES = CALL.findall(README)
EVENTS = {
    PredictTumbling.Response.CONTACT: "CONTACT",
    PredictTumbling.Response.PLANE_REACHED: "PLANE_REACHED",
}


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


def numbers(values: Any) -> str:
    return "(" + ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in values) + ")"


def told(answer: Any) -> str:
    """What an answer says of the last sample, as the README puts it."""
    trajectory = answer.trajectory
    said = f"{Method(answer.method).name}, {Regime(answer.poinsot.regime).name}"
    said += f"; at {trajectory.times[-1]:.3f}: {numbers(trajectory.positions[-3:])}"
    said += f", {numbers(trajectory.orientations[-4:])}"
    if answer.event in EVENTS:
        point, surface = answer.event_point, f" {answer.event_surface}".rstrip()
        said += f"; {EVENTS[answer.event]}{surface} {numbers((point.x, point.y, point.z))}"
    if answer.poinsot.flip_times:
        said += f"; flips at {numbers(answer.poinsot.flip_times)}"
    return said


def test_every_example_is_found() -> None:
    assert len(EXAMPLES) == README.count("ros2 service call /contact_dynamics/predict_tumbling") == 4


@pytest.mark.parametrize(("request_text", "stated"), EXAMPLES)
def test_each_is_answered_as_stated(client: Client, request_text: str, stated: str) -> None:
    request = fill(PredictTumbling.Request(), yaml.safe_load(request_text))
    answer = client.ask(request)
    assert (answer.status, answer.message) == (answer.OK, "")
    assert told(answer) == stated
    assert len(answer.poinsot.polhode) == 3 * request.curve_points
