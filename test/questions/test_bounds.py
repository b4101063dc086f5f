# SPDX-License-Identifier: Apache-2.0
"""Questions that would take too long, or too much memory, are refused by name."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from contact_dynamics import Body, ContactSet, MassProperties
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact import SeveralContactsLaw
from contact_dynamics.motion import Drag
from contact_dynamics.questions import (
    AtRate,
    ContactModeQuestion,
    Context,
    ImpactQuestion,
    InTime,
    PublishedState,
    StateStore,
    TumblingQuestion,
    UncertainState,
    UntilPlane,
    ask,
)
from contact_dynamics.questions.subject import changed_body
from message_words import says
from questions.known_world import CONTEXT, CUBE, SIDE, WORLD, state

FAST_SPIN = (1e9, 1e8, 1e8)  # rad/s, as a broken driver sends


BRICK = Body(
    name="brick", mass_properties=MassProperties(mass=0.4, I_B=np.diag([0.000353333, 0.000833333, 0.00102]))
)


def ring(count: int) -> ContactSet:
    """Contacts around the lower face of a body."""
    angles = np.linspace(0.0, 2.0 * math.pi, count, endpoint=False)
    points = np.column_stack([0.05 * np.cos(angles), 0.04 * np.sin(angles), np.zeros(count)])
    return ContactSet(p_WC_W=points, normals_W=[0.0, 0.0, 1.0], frictions=0.3, restitutions=0.5)


TOO_LARGE = {
    "a spin that no search keeps up with": (
        ImpactQuestion(body="cube", state=state(1.0, w=FAST_SPIN)),
        "horizon must be ..., got more than 50000 steps of the search",
    ),
    "steps of a microsecond over contacts that stay": (
        ImpactQuestion(
            body="cube",
            state=state(0.5 * SIDE, v=(0.5, 0.0, -0.1), w=(0.0, 0.3, 0.1)),
            several_contacts_law=InTime(hold_step=1e-6),
        ),
        "strike_window must be ..., got more than 50000 steps of the search",
    ),
    "a point of the body far away": (
        TumblingQuestion(
            body="cube",
            state=state(1.0, w=(0.0, 0.0, 3.0)),
            sampling=UntilPlane(plane_point=[0, 0, 0], plane_normal=[0, 0, 1], body_point=[1e16, 0, 0]),
        ),
        "duration must be ..., got more than 50000 steps",
    ),
    "a thousand contacts at once": (
        ImpactQuestion(
            body=BRICK,
            state=state(0.025, v=(1.0, 0.3, -1.0), w=(1.0, 2.0, 3.0)),
            contacts=ring(1000),
            several_contacts_law=SeveralContactsLaw.SIMULTANEOUS,
        ),
        "contacts must be ..., got 1000 contacts at once",
    ),
    "covariances under a drag that stops the body in a millisecond": (
        TumblingQuestion(
            body="cube",
            state=UncertainState(state=state(w=(1.0, 2.0, 3.0)), covariance=1e-6 * np.eye(12)),
            drag=Drag(linear=5000.0),
            sampling=AtRate(duration=3.0, rate=10.0),
            include_covariance=True,
        ),
        "times must be ..., got 3 s, which takes",
    ),
}


@pytest.mark.parametrize("name", TOO_LARGE)
def test_what_takes_too_long_is_refused_by_name(name: str) -> None:
    question, words = TOO_LARGE[name]
    with pytest.raises(TooLargeError) as refused:
        ask(question, CONTEXT)
    assert says(str(refused.value), words)


FAR = ContactSet(p_WC_W=[[1.7e308, 0, 0]], normals_W=[[0, 0, 1]], frictions=[0.3], restitutions=[0.0])
GRIPPING = ContactSet(
    p_WC_W=[[0, 0, 0], [1, 1, 0]], normals_W=[[0.6, 0, 0.8], [0, 0, 1]], frictions=[1.0, 1e300]
)
DUST = Body(name="", mass_properties=MassProperties(mass=1e-31, I_B=np.eye(3)))


def modes(**changes: Any) -> ContactModeQuestion:
    return ContactModeQuestion(**{"body": "cube", "state": state(), "contacts": ring(3), **changes})


@pytest.mark.parametrize(
    ("question", "words"),
    [
        (ImpactQuestion(body="cube", state=state(1e300)), "p_WB_W must be ..., got 1e+300"),
        (
            ImpactQuestion(body="cube", state=state(1e16)),
            "p_WB_W must be at most 1e+15 for contacts..., got 1e+16",
        ),
        (
            modes(state=state(v=(0.0, 0.0, 1e16)), include_margins=True),
            "v_WB_W must be at most 1e+15..., got 1e+16",
        ),
        (modes(state=state(w=(0.0, 0.0, -1e16))), "w_WB_W must be at most 1e+15 for contacts..., got 1e+16"),
        (modes(body=DUST), "mass must be in [1e-30, 1e+30] for contacts..., got 1e-31"),
        (modes(force_W=[-1e100, 0, 0]), "force_W must be ..., got 1e+100"),
        (modes(contacts=FAR), "contacts.p_WC_W must be ..., got 1.7e+308 m"),
        (modes(contacts=GRIPPING), "contacts.frictions must be at most 1e+10..., got 1e+300"),
        (
            modes(include_statics=True, margin_length=5e-324),
            "margin_length must be in [1e-15, 1e+15]..., got 4.9",
        ),
    ],
)
def test_numbers_that_no_contact_has_are_refused_by_name(question: Any, words: str) -> None:
    with pytest.raises(InvalidFieldError) as refused:
        ask(question, CONTEXT)
    assert says(str(refused.value), words)


def test_a_window_of_any_length_takes_what_is_kept() -> None:
    """1e300 s is more nanoseconds than a double holds."""
    states = StateStore(history=5.0, timeout=0.5)
    for stamp_ns in range(0, 50_000_000, 10_000_000):
        states.add(
            "cube",
            state(1.0 - 0.5 * 9.80665e-18 * stamp_ns**2, v=(0, 0, -9.80665e-9 * stamp_ns), stamp_ns=stamp_ns),
        )
    known = Context(world=WORLD, states=states)
    answers = [
        ask(TumblingQuestion(body="cube", state=PublishedState(fit_window=window)), known)
        for window in (5.0, 1e300)
    ]
    assert [answer.fit.count for answer in answers if answer.fit is not None] == [5, 5]


def test_states_that_leave_a_motion_open_are_refused() -> None:
    """Where drag stops a ball within a millisecond, its states say nothing of the spin that it had."""
    ball = changed_body(CUBE, MassProperties(mass=0.1, I_B=4e-5 * np.eye(3)), np.zeros(3))
    states = StateStore(history=5.0, timeout=0.5)
    for stamp_ns in range(0, 20_000_000, 4_000_000):
        states.add("cube", state(1.0, v=(0.1, 0.0, -9.8e-9 * stamp_ns), stamp_ns=stamp_ns))
    question = TumblingQuestion(
        body=ball, state=PublishedState(fit_window=0.018), drag=Drag(linear_angular=1.0)
    )
    with pytest.raises(
        InvalidFieldError, match=r"fit_window must be .*, got .* numbers that leave a part of the motion open"
    ):
        ask(question, Context(world=WORLD, states=states))
