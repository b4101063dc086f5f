# SPDX-License-Identifier: Apache-2.0
"""Whatever travels in an answer comes back as it was: each message and response has a pair of adapters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from architecture.test_interfaces import FILES
from contact_dynamics.questions.services import SERVICES, Service, service_of_type
from contact_dynamics.world import Body, World
from contact_dynamics_interfaces.msg import BodyStates as BodyStatesMsg
from contact_dynamics_interfaces.msg import Poinsot as PoinsotMsg
from contact_dynamics_interfaces.msg import Trajectory as TrajectoryMsg
from message_values.contact_modes import (
    bodies_contact_mode_answers,
    bodies_modes,
    contact_mode_answers,
    geometry_margins,
    modes_and_margins,
    wrench_sets,
)
from message_values.impact import impact_answers, resolved_impacts
from message_values.many import many_contact_modes_answers, many_impacts_answers, many_tumblings_answers
from message_values.shared import BRICK, NO_OFFSET, contact_sets, many_states, same, states, trajectories
from message_values.toss import (
    branches,
    event_regions,
    regions,
    toss_answers,
    toss_distributions,
    toss_events,
    toss_paths,
)
from message_values.tumbling import carried, rotations, tumbling_answers
from msg_adapters.batches import STATES
from msg_adapters.bodies_contact_mode import MODE_OF_BODIES
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg
from msg_adapters.contact_mode import GEOMETRY_MARGIN, MARGIN, MODE, WRENCH_SET
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg
from msg_adapters.fields import Frame, Kind, Row, Table
from msg_adapters.impact import RESOLVED_IMPACT
from msg_adapters.toss import BRANCH, DISTRIBUTION, EVENT, EVENT_REGIONS, PATH, REGION
from msg_adapters.tumbling import COVARIANCES, CURVES, FLIPS, POINSOT, TRAJECTORY

CENTER = np.array([0.02, -0.01, 0.005])  # m, of mass, in the body's frame
ROUNDING = 1e-12  # m, of positions up to 1 km that go through the published frame and back
FRAME: dict[str, Any] = {"world_frame": "map"}
BODY: dict[str, Any] = {**FRAME, "p_FB_F": NO_OFFSET}
AT = Frame(p_FB_F=NO_OFFSET, body_name="brick", stamp_ns=7, **FRAME)
NOWHERE = World()


@dataclass(frozen=True)
class Pair:
    """Adapters there and back, and what to send through them."""

    values: st.SearchStrategy[Any]
    to_msg: Callable[[Any], Any]
    from_msg: Callable[[Any], Any]


@st.composite
def _trajectories(draw: st.DrawFn) -> Any:
    trajectory = draw(trajectories())
    return trajectory, draw(carried(trajectory.seconds)) if len(trajectory) and draw(st.booleans()) else None


def _of_table(table: Table[Any, Any], values: st.SearchStrategy[Any]) -> Pair:
    """The pair of a table."""
    return Pair(values, partial(table.to_msg, frame=AT), partial(table.from_msg, frame=AT))


def _of_kinds(msg_type: Callable[[], Any], values: st.SearchStrategy[Any], *kinds: Kind) -> Pair:
    """The pair of kinds that fill one message together, of a value or a tuple of one for each kind."""
    names = [f"_{i}" for i in range(len(kinds))]
    table = Table(
        lambda **read: read["_0"] if len(kinds) == 1 else tuple(read.values()),
        lambda: SimpleNamespace(msg=msg_type()),
        *(Row(name, "msg", kind) for name, kind in zip(names, kinds, strict=True)),
    )

    def to_msg(value: Any) -> Any:
        parts = (value,) if len(kinds) == 1 else value
        return table.to_msg(SimpleNamespace(**dict(zip(names, parts, strict=True))), AT).msg

    return Pair(values, to_msg, lambda msg: table.from_msg(SimpleNamespace(msg=msg), AT))


def _mode_to_msg(value: Any) -> Any:
    msg = MODE.to_msg(value[0])
    return msg if value[1] is None else MARGIN.to_msg(value[1], into=msg)


PAIRS: dict[str, Pair] = {
    "BodiesContactMode": _of_table(MODE_OF_BODIES, bodies_modes(2, 3)),
    "BodyState": Pair(
        states,
        lambda value: body_state_to_msg(value, body_name="brick", **BODY),
        lambda msg: body_state_from_msg(msg, **BODY),
    ),
    "ContactMode": Pair(
        modes_and_margins(),
        _mode_to_msg,
        lambda msg: (MODE.from_msg(msg), MARGIN.from_msg(msg) if msg.margin_length else None),
    ),
    "ContactSet": Pair(contact_sets(), contacts_to_msg, contacts_from_msg),
    "Impact": _of_table(RESOLVED_IMPACT, resolved_impacts()),
    "GeometryMargin": _of_table(GEOMETRY_MARGIN, geometry_margins),
    "ModeWrenches": _of_table(WRENCH_SET, wrench_sets()),
    "Poinsot": _of_kinds(PoinsotMsg, rotations(), POINSOT, FLIPS, CURVES),
    "Trajectory": _of_kinds(TrajectoryMsg, _trajectories(), TRAJECTORY, COVARIANCES),
    "BodyStates": _of_kinds(BodyStatesMsg, many_states(3), STATES),
    "TossRegion": _of_table(REGION, regions),
    "TossEventRegions": _of_table(EVENT_REGIONS, event_regions),
    "TossBranch": _of_table(BRANCH, branches),
    "TossDistribution": _of_table(DISTRIBUTION, toss_distributions()),
    "TossEvent": _of_table(EVENT, toss_events()),
    "TossPath": _of_table(PATH, toss_paths()),
}

ANSWERS = {
    "PredictContactMode": contact_mode_answers,
    "PredictImpact": impact_answers,
    "PredictTumbling": tumbling_answers,
    "PredictToss": toss_answers,
    "PredictImpactBatch": many_impacts_answers,
    "PredictTumblingBatch": many_tumblings_answers,
    "PredictContactModeBatch": many_contact_modes_answers,
    "PredictBodiesContactMode": bodies_contact_mode_answers,
}
"""Answers from each service."""


def _pairs_of(service: Service) -> dict[str, Pair]:
    answers = ANSWERS[service.type_name]
    return {
        f"{service.type_name}.Response": Pair(
            answers(),
            partial(service.answer_to_msg, **FRAME),
            partial(service.answer_from_msg, world=NOWHERE),
        )
    }


for each in SERVICES:
    PAIRS |= _pairs_of(each)


def test_each_interface_has_a_pair() -> None:
    """An event of the monitor is only written: `monitoring/test_live.py` compares its fields."""
    names = {path.stem if path.suffix == ".msg" else f"{path.stem}.Response" for path in FILES}
    assert set(PAIRS) == names - {"MonitorEvent"}


@pytest.mark.parametrize("name", PAIRS)
@settings(suppress_health_check=[HealthCheck.too_slow], deadline=None, max_examples=15)
@given(data=st.data())
def test_a_value_comes_back_and_goes_again_as_it_was(name: str, data: st.DataObject) -> None:
    """Every field, to the last bit, of the value and of the message."""
    pair = PAIRS[name]
    value = data.draw(pair.values)
    msg = pair.to_msg(value)
    back = pair.from_msg(msg)
    assert same(back, value)
    assert same(pair.to_msg(back), msg)


@pytest.mark.parametrize("name", ["PredictContactMode", "PredictImpact", "PredictTumbling"])
@settings(suppress_health_check=[HealthCheck.too_slow], deadline=None, max_examples=15)
@given(data=st.data())
def test_answers_find_the_centre_of_mass_in_the_world(name: str, data: st.DataObject) -> None:
    """The message has the published frame: positions come back to rounding, all else as it was."""
    service = service_of_type(name)
    world = World(bodies=(Body(name="brick", mass_properties=BRICK.mass_properties, p_FB_F=CENTER),))
    answers: Any = ANSWERS[name]
    answer = data.draw(answers(CENTER))
    back = service.answer_from_msg(service.answer_to_msg(answer, **FRAME), world=world)
    assert same(back, answer, rounding=ROUNDING)


def test_messages_check_their_fields() -> None:
    """Without ROS_PYTHON_CHECK_FIELDS a wrong type would travel through the tests above unseen."""
    with pytest.raises(AssertionError):
        PoinsotMsg(regime="tumbles")
