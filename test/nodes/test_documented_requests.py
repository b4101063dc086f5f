# SPDX-License-Identifier: Apache-2.0
"""Requests of the documents and the cases over ROS 2: each has the answer that is stated."""

from __future__ import annotations

import re
from functools import reduce
from typing import Any

import pytest
import yaml

from contact_dynamics.cases import CASES
from contact_dynamics.contact_modes import ModeVerdict
from contact_dynamics.impact import ImpactOutcome, SequenceEnd
from contact_dynamics.motion.integrated import Method
from contact_dynamics.toss import TossEnd
from contact_dynamics.tumbling import Regime
from contact_dynamics_interfaces.msg import Impact
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
from nodes.test_same_question import filled
from running_server import ROOT, SERVICES, Client

README = (ROOT / "contact_dynamics_interfaces" / "README.md").read_text(encoding="utf-8")
CALL = re.compile(
    r'^ros2 service call (\S+) contact_dynamics_interfaces/srv/(\w+) \\\n  "([^"]*)"\n#> (.*)$', re.MULTILINE
)
EXAMPLES = CALL.findall(README)
COUNTS = {
    PredictContactMode: 8,
    PredictImpact: 6,
    PredictTumbling: 4,
    PredictToss: 2,
    PredictImpactBatch: 0,
    PredictTumblingBatch: 1,
    PredictContactModeBatch: 1,
    PredictBodiesContactMode: 1,
}


@pytest.mark.parametrize(
    ("service", "typed", "words"),
    [
        (
            PredictTumbling,
            "{body_name: brick}",
            "AT_TIMES (0), the default, got none (rate and duration need sampling: 2 (AT_RATE)",
        ),
        (
            PredictImpact,
            "{body_name: brick, state: {pose: {position: {z: 0.5}}}}",
            "state.pose.position.z must be left out unless state_source is STATE_EXPLICIT (1), got 0.5",
        ),
        (
            PredictImpact,
            "{body_name: brick, state_source: 1, state: {pose: {orientation: {w: 0.0}}}}",
            "state.pose.orientation must be a unit quaternion (w: 1 is no rotation)",
        ),
        (
            PredictImpact,
            "{state_source: 1, state: {body_name: brick}}",
            "body_name must be the name of a configured body",
        ),
        (
            PredictImpact,
            "{body_name: brick, state_source: 1, state: {body_name: cup}}",
            "state.body_name must be 'brick', or left out, got 'cup'",
        ),
        (PredictImpact, "{body_name: brick, state_source: 1, horizon: -5.0}", "horizon must be >= 0, got -5"),
    ],
)
def test_what_newcomers_type_gets_the_field_that_they_meant(
    client: Client, service: Any, typed: str, words: str
) -> None:
    answer = client.ask(filled(service.Request(), yaml.safe_load(typed)))
    assert answer.status == answer.INVALID_FIELD
    assert words in answer.message


@pytest.mark.parametrize(
    ("given", "status"), [("", "OK"), ("horizon: 2.0", "OK"), ("horizon: 0.0", "NO_CONTACT")]
)
def test_a_number_may_be_left_out_and_zero_is_zero(client: Client, given: str, status: str) -> None:
    """The server's own horizon is 10 s; the brick lands after 0.3 s."""
    typed = f"{{body_name: brick, state_source: 1, state: {{pose: {{position: {{z: 0.5}}}}}}, {given}}}"
    answer = client.ask(filled(PredictImpact.Request(), yaml.safe_load(typed)))
    assert answer.status == getattr(answer, status), answer.message


def numbers(values: Any) -> str:
    return "(" + ", ".join(f"{round(x, 3) + 0.0:.3f}" for x in values) + ")"


def vector(msg: Any) -> str:
    return numbers((msg.x, msg.y, msg.z))


def modes_told(verdict: int, modes: list[Any]) -> str:
    letters = " ".join(sorted(mode.mode for mode in modes))
    return f"{ModeVerdict(verdict).name}: {letters}" if modes else ModeVerdict(verdict).name


def contact_mode_told(request: Any, answer: Any) -> str:
    asked_for = {
        "include_wrenches": answer.wrench_sets,
        "include_statics": answer.equilibrium,
        "include_impact": answer.impact,
        "include_geometry_margins": answer.geometry_margins,
        "include_margins": answer.modes and answer.modes[0].margin == answer.modes[0].margin,
    }
    for field, found in asked_for.items():
        assert bool(found) == getattr(request, field), field
    said = modes_told(answer.verdict, answer.modes)
    if answer.impact:
        after = modes_told(answer.verdict_after_impact, answer.modes_after_impact)
        said += f", after the impact {after}"
    return said


def impact_told(_request: Any, answer: Any) -> str:
    impact = answer.impact
    if impact.strike_times:
        said = f"{len(impact.strike_times)} strikes, {SequenceEnd(impact.sequence_end).name}"
    elif impact.outcome == Impact.NOT_TOLD:
        said = "NOT_TOLD"
    else:
        said = ImpactOutcome(impact.outcome).name
    velocities = "; ".join(
        f"{vector(state.linear_velocity)}, {vector(state.angular_velocity)}"
        for state in (impact.state_after, *impact.other_state_after)
    )
    return f"{said}: {velocities}"


def tumbling_told(request: Any, answer: Any) -> str:
    """What an answer says of the last sample."""
    assert len(answer.poinsot.polhode) == 3 * request.curve_points
    trajectory = answer.trajectory
    said = f"{Method(answer.method).name}, {Regime(answer.poinsot.regime).name}"
    said += f"; at {trajectory.times[-1]:.3f}: {numbers(trajectory.positions[-3:])}"
    said += f", {numbers(trajectory.orientations[-4:])}"
    event = {answer.CONTACT: "CONTACT", answer.PLANE_REACHED: "PLANE_REACHED"}.get(answer.event)
    if event:
        surface = f" {answer.event_surface}".rstrip()
        said += f"; {event}{surface} {vector(answer.event_point)}"
    if answer.poinsot.flip_times:
        said += f"; flips at {numbers(answer.poinsot.flip_times)}"
    return said


def toss_told(_request: Any, answer: Any) -> str:
    toss = answer.toss
    said = f"{TossEnd(toss.end).name} after {toss.end_time:.3f} on {' '.join(map(str, toss.resting_corners))}"
    said += f": {numbers(toss.trajectory.positions[-3:])}"
    for told in answer.distribution:
        first = [branch for branch in told.branches if branch.strike == 1]
        said += "; " + ", ".join(f"corner {branch.corner}" for branch in first)
        said += f" at {told.strikes[0].time.mean[0]:.3f}"
    return said


TOLD = {
    PredictToss: toss_told,
    PredictContactMode: contact_mode_told,
    PredictImpact: impact_told,
    PredictTumbling: tumbling_told,
    PredictTumblingBatch: lambda _request, answer: numbers(answer.states.positions),
    PredictContactModeBatch: lambda _request, answer: " ".join(answer.modes),
    PredictBodiesContactMode: lambda _request, answer: modes_told(answer.verdict, answer.modes),
}


@pytest.mark.parametrize("service", SERVICES)
def test_every_example_is_found(service: Any) -> None:
    found = [name for name, *_ in EXAMPLES if name == SERVICES[service]]
    assert len(found) == README.count(f"ros2 service call {SERVICES[service]} ") == COUNTS[service]


IN_PLANE = (
    "warning: margins and statics hold for wrench changes in the plane of motion; "
    "problem=SPATIAL has them for all"
)


@pytest.mark.parametrize(("name", "type_name", "request_text", "stated"), EXAMPLES)
def test_each_is_answered_as_stated(
    client: Client, name: str, type_name: str, request_text: str, stated: str
) -> None:
    (service,) = (service for service in SERVICES if service.__name__ == type_name)
    assert SERVICES[service] == name
    request = filled(service.Request(), yaml.safe_load(request_text))
    answer = client.ask(request)
    assert answer.status == answer.OK, answer.message
    has_margins = any(getattr(request, f"include_{what}", False) for what in ("margins", "statics"))
    assert answer.message == (IN_PLANE if has_margins else "")
    assert TOLD[service](request, answer) == stated


PASTED = re.compile(
    r'^ros2 service call (\S+) contact_dynamics_interfaces/srv/(\w+) \\\n  "([^"]*)"$', re.MULTILINE
)
WITHOUT_STATE = "docs/tutorials/catch.md"  # it asks about states that somebody publishes
ELSEWHERE = [
    (str(path.relative_to(ROOT)), *call)
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")))
    for call in PASTED.findall(path.read_text(encoding="utf-8"))
]


def test_the_other_pages_have_requests() -> None:
    assert {"README.md", "docs/quick-start-ros.md", "docs/tutorials/bounce.md"} < {
        page for page, *_ in ELSEWHERE
    }


@pytest.mark.parametrize(("page", "name", "type_name", "request_text"), ELSEWHERE)
def test_a_request_of_another_page_is_answered(
    client: Client, page: str, name: str, type_name: str, request_text: str
) -> None:
    (service,) = (service for service in SERVICES if service.__name__ == type_name)
    assert SERVICES[service] == name
    answer = client.ask(filled(service.Request(), yaml.safe_load(request_text)))
    expected = answer.NO_STATE if page == WITHOUT_STATE else answer.OK
    assert answer.status == expected, answer.message


IN_A_SENTENCE = re.compile(r"`(\{\w+: [^`]*\}|[a-z_]+: \S+)`")
TO_SET = [
    (str(path.relative_to(ROOT)), text)
    for path in (
        ROOT / "contact_dynamics_interfaces" / "README.md",
        ROOT / "README.md",
        *sorted((ROOT / "docs").rglob("*.md")),
    )
    for text in IN_A_SENTENCE.findall(path.read_text(encoding="utf-8"))
]


def takes(service: Any, fields: dict[str, Any]) -> bool:
    try:
        filled(service.Request(), fields)
    except AssertionError:  # of ROS's own checks, which refuse a number where a list is meant
        return False
    return True


@pytest.mark.parametrize(("page", "text"), TO_SET)
def test_what_a_sentence_says_to_set_is_taken_by_a_request(page: str, text: str) -> None:
    fields = yaml.safe_load(text if text.startswith("{") else f"{{{text}}}")
    asking = [each for each in SERVICES if all(hasattr(each.Request(), name) for name in fields)]
    assert not asking or any(takes(each, fields) for each in asking), page


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
