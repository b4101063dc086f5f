# SPDX-License-Identifier: Apache-2.0
"""The visualizer: states and service events over DDS in, a file out, which is read back."""

from __future__ import annotations

import time
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from rclpy.serialization import serialize_message
from scipy.spatial.transform import Rotation
from service_msgs.msg import ServiceEventInfo

with warnings.catch_warnings():
    warnings.simplefilter("ignore", DeprecationWarning)  # of Python 3.10, at rerun's import
    from viewing.drawn import STAMP_NS

from contact_dynamics.nodes.inbox import Taken
from contact_dynamics.nodes.parameter_reader import ParameterSource
from contact_dynamics.nodes.parameters import read_server_parameters
from contact_dynamics.questions import services
from contact_dynamics_interfaces.msg import ContactMode, Impact, MonitorEvent
from contact_dynamics_interfaces.srv import PredictContactMode, PredictImpact

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

from msg_adapters.stamps import stamp_to_msg
from nodes.visualizer_bench import (
    CENTER,
    CONFIGURATION,
    STAMP_NS,
    TURNED,
    Bench,
    body_state,
    impact_answer,
    odometry,
    tumbling_answer,
    two_contacts,
)


@pytest.fixture
def bench(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Bench]:
    bench = Bench(tmp_path / "drawn.rrd", strict=getattr(request, "param", True))
    yield bench
    bench.end()


def center_of_mass(position: list[float], orientation: list[float]) -> np.ndarray:
    return np.array(position) + Rotation.from_quat(orientation).apply(CENTER)


def test_an_event_of_a_monitor_is_listed(bench: Bench) -> None:
    events = bench.node.create_publisher(MonitorEvent, "/contact_dynamics_monitor/events", 10)
    bench.spin_until(lambda: events.get_subscription_count() == 1)
    msg = MonitorEvent(text="brick on floor: impact, outside 99 %", region=MonitorEvent.OUTSIDE_99)
    msg.header.stamp = stamp_to_msg(STAMP_NS)
    events.publish(msg)
    bench.spin_until(lambda: bench.received == 1)
    drawn = bench.drawn()
    assert f"monitor: {msg.text}" in drawn.last("/answers/log", "TextLog:text")
    assert drawn.last("/answers/log", "TextLog:level") == ["WARN"]


def test_states_are_drawn_where_the_centre_of_mass_is(bench: Bench) -> None:
    for i in range(5):
        bench.states.publish(odometry(STAMP_NS + i, 0.1 * i))
    bench.spin_until(lambda: bench.received == 5)
    drawn = bench.drawn()
    pose = "/world/bodies/brick"
    assert drawn.stamps(pose, "Transform3D:translation") == [STAMP_NS + i for i in range(5)]
    expected = [center_of_mass([0.1 * i, 0.0, 1.0], TURNED) for i in range(5)]
    np.testing.assert_allclose(drawn.series(pose, "Transform3D:translation"), expected, atol=1e-6)


def test_a_trajectory_is_that_of_the_centre_of_mass(bench: Bench) -> None:
    bench.answer("predict_tumbling", tumbling_answer())
    drawn = bench.drawn()
    path = drawn.array("/world/predicted/brick/path", "LineStrips3D:strips")[0]
    expected = [
        center_of_mass([0.5, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]),
        center_of_mass([0.6, 0.0, 0.8], TURNED),
    ]
    np.testing.assert_allclose(path, expected, atol=1e-6)
    (text,) = drawn.last("/answers/newest", "TextDocument:text")
    assert "brick reaches floor in 0.1 s at (0.6, 0, 0) m with 5 m/s" in text
    assert "it tumbles about its major axis (1.2 ms)" in text


def test_an_impact_is_drawn_when_it_was_asked_for(bench: Bench) -> None:
    bench.answer("predict_impact", impact_answer(two_contacts()))
    drawn = bench.drawn()
    label = "/world/impact/brick/impulse_label"
    assert drawn.stamps(label, "Points3D:labels") == [STAMP_NS - 50_000_000]
    assert drawn.last(label, "Points3D:labels") == ["0.5 N s"]
    path = drawn.array("/impulse_space/path", "LineStrips2D:strips")[0]
    np.testing.assert_allclose(path, [[0.0, 0.0], [0.3, -0.4]], atol=1e-7)  # the second axis down
    text = drawn.last("/answers/newest", "TextDocument:text")[0]
    assert "sticks in compression" in text
    assert "0.75 J lost" in text


def contact_mode_answer(**fields: Any) -> PredictContactMode.Response:
    modes = [
        ContactMode(
            mode=mode,
            contact_forces=[0.0, 0.0, 2.0, 0.0, 0.0, 2.0],
            contact_accelerations=[0.0] * 6,
            tangential_directions=[0.0] * 6,
            forces_unique=mode == "fl",
            margin=0.25,
            margin_length=0.05,
            margin_modes=["ff"],
        )
        for mode in ("fl", "ff")
    ]
    return PredictContactMode.Response(
        verdict=PredictContactMode.Response.INDETERMINATE,
        modes=modes,
        refused_modes=["ss"],
        refusals=[PredictContactMode.Response.NO_SOLUTION],
        refused_contacts=[-1],
        refusal_amounts=[1.0],
        contact_velocities=[0.0] * 6,
        state=body_state(),
        contacts=two_contacts(),
        problem=PredictContactMode.Request.SPATIAL,
        **fields,
    )


def test_contact_modes_are_drawn_with_every_mode_in_words(bench: Bench) -> None:
    bench.answer("predict_contact_mode", contact_mode_answer(equilibrium=2, jammed=1, wedged=1))
    drawn = bench.drawn()
    assert drawn.last("/world/contacts/brick/letters", "Points3D:labels") == [
        "stays fixed",
        "slides left or stays fixed",
    ]
    assert drawn.last("/world/contacts/brick/mode_2/forces", "Arrows3D:labels") == ["2 N", "2 N"]
    text = drawn.last("/answers/newest", "TextDocument:text")[0]
    assert "selects none: fl (margin 0.25 N to ff), ff (margin 0.25 N to ff); the contact" in text
    assert "inconsistent: ss" in text
    assert "the contact forces of ff are not unique" in text
    assert "equilibrium possible, jammed no, wedged no" in text


def in_words(name: str, response: Any) -> str:
    """What the answer of a response is in words."""
    world = read_server_parameters(ParameterSource(CONFIGURATION)).world
    (service,) = (each for each in services.SERVICES if each.name == name)
    return "; ".join(service.in_words(service.answer_from_msg(response, world=world)))


def test_a_struck_body_and_strikes_in_sequence_are_told() -> None:
    answer = impact_answer(two_contacts())
    bat = body_state(body_name="bat")
    answer.other_state_before = [bat]
    answer.impact.other_state_after = [bat]
    answer.impact.strike_times, answer.impact.strike_contacts = [0.0, 0.004], [0, 1]
    answer.impact.strike_outcomes = [Impact.SLIDES, Impact.SLIDES]
    answer.impact.strike_positions = [0.1, 0.0, 0.0, -0.1, 0.0, 0.0]
    answer.impact.strike_impulses = [0.0, 0.0, 0.4, 0.0, 0.0, 0.2]
    answer.impact.strike_body_positions = [0.5, 0.0, 1.0] * 2
    answer.impact.strike_body_orientations = TURNED * 2
    answer.impact.strike_velocities_before = answer.impact.strike_velocities_after = [0.0] * 12
    answer.impact.sequence_end = Impact.STAYS
    text = in_words("predict_impact", answer)
    assert "that of bat becomes (1, 0, -2) m/s" in text
    assert "2 impacts within 4 ms; then a contact stays" in text
    assert "J lost" not in text


def test_several_contacts_at_once_and_probable_outcomes_are_told() -> None:
    answer = impact_answer(two_contacts())
    answer.impact.outcome = Impact.NOT_TOLD
    text = in_words("predict_impact", answer)
    assert "strikes in 0.05 s: several at once" in text
    assert "0.75 J lost" in text
    answer.impact.outcome_probabilities = [0.0, 0.25, 0.7, 0.0, 0.0, 0.0, 0.0]
    answer.impact.miss_probability = 0.05
    told = "outcomes: sticks in compression 70 %, slides 25 %, separates 5 %"
    assert told in in_words("predict_impact", answer)


def test_flips_are_told() -> None:
    answer = tumbling_answer()
    answer.poinsot.flip_times, answer.poinsot.flip_time_deviations = [0.4, 1.25], [0.01, float("nan")]
    told = "its middle axis turns over after 0.4 s (±0.01 s), 1.25 s"
    assert told in in_words("predict_tumbling", answer)


def test_the_impact_that_settles_a_case_is_told_with_what_follows() -> None:
    answer = contact_mode_answer(approaching_contacts=[1], impact=[impact_answer(two_contacts()).impact])
    answer.verdict, answer.modes = answer.IMPACT, []
    answer.contact_velocities = [0.0, 0.0, 0.0, 0.0, 0.0, -0.5]
    answer.verdict_after_impact = answer.UNIQUE
    answer.modes_after_impact = [ContactMode(mode="fs", forces_unique=True)]
    text = in_words("predict_contact_mode", answer)
    assert "contact 2 approaches with 0.5 m/s" in text
    assert "an impact settles it: sticks in compression; velocity becomes (1, 0, -2) m/s" in text
    assert "then it has one consistent mode: fs" in text


def test_a_refusal_is_told(bench: Bench) -> None:
    response = PredictImpact.Response(
        status=PredictImpact.Response.UNKNOWN_BODY,
        message="body_name must be one of the known bodies ('brick'), got 'x'",
    )
    bench.answer("predict_impact", response)
    drawn = bench.drawn()
    assert drawn.last("/answers/log", "TextLog:text") == [
        "Impact: rejected (2): body_name must be one of the known bodies ('brick'), got 'x'"
    ]
    assert drawn.last("/answers/log", "TextLog:level") == ["WARN"]
    assert drawn.stamps("/answers/log", "TextLog:text") == [STAMP_NS + 7]  # no state: the event's own time


def test_an_answer_about_a_state_without_stamp_appears_at_the_events(bench: Bench) -> None:
    bench.answer("predict_tumbling", tumbling_answer(stamp_ns=0))
    assert bench.drawn().stamps("/world/predicted/brick/path", "LineStrips3D:strips") == [STAMP_NS + 7]


def test_what_others_than_the_server_report_is_not_drawn(bench: Bench) -> None:
    bench.answer("predict_tumbling", tumbling_answer(), ServiceEventInfo.RESPONSE_RECEIVED)
    assert not any("predicted/brick" in entity for entity in bench.drawn().entities if "world" in entity)


@pytest.mark.parametrize("bench", [False], indirect=True)
def test_what_cannot_be_drawn_is_told_once_and_the_rest_goes_on(bench: Bench) -> None:
    told: list[str] = []
    bench.visualizer.get_logger().warning = told.append
    broken = two_contacts()
    broken.positions = [0.1]
    for _ in range(3):
        bench.answer("predict_impact", impact_answer(broken))
    bench.answer("predict_tumbling", tumbling_answer())
    assert len(told) == 1
    assert "contacts.positions" in told[0]
    drawn = bench.drawn()
    assert "/world/predicted/brick/path" in drawn.entities
    assert "/world/impact/brick/impulse" not in drawn.entities


def test_it_stops_in_time_although_many_answers_wait(bench: Bench, capfd: pytest.CaptureFixture[str]) -> None:
    """A launch kills a process that does not stop, and the end of its file is lost then."""
    count = 5000
    info = ServiceEventInfo(event_type=ServiceEventInfo.RESPONSE_SENT)
    event = PredictImpact.Event(info=info, response=[impact_answer(two_contacts())])
    data = bytes(serialize_message(event))
    topic = "/contact_dynamics/predict_impact/_service_event"
    (events,) = (one for one in bench.visualizer.inbox if one.topic_name == topic)
    for _ in range(count):
        events.callback(Taken(data, time.time_ns(), None))
    drawn = bench.drawn()
    assert 0 < len(drawn.values["/answers/log", "TextLog:text"]) < count
    assert "responses are not drawn: they still waited after 2 s" in capfd.readouterr().err


def test_strictly_it_raises(bench: Bench) -> None:
    broken = two_contacts()
    broken.positions = [0.1]
    with pytest.raises(ValueError, match="positions"):
        bench.answer("predict_impact", impact_answer(broken))
