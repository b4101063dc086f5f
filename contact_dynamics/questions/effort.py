# SPDX-License-Identifier: Apache-2.0
"""Estimates whether a question is quick: whether it is certainly answered within about 30 ms.

The server answers quick questions itself and sends others to workers (`questions.workers`). The estimate uses
the sizes of lists and the options, since the exact effort is only known afterwards. The records of services
refer to these functions.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.motion.forces import NO_DRAG, NO_WRENCH
from contact_dynamics.questions.context import Problem
from contact_dynamics.questions.sample_times import UntilContact, UntilPlane
from contact_dynamics.questions.subject import NEWEST, PublishedState, at_one_time, at_stamp, subject_of

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.contact_modes import ContactModeQuestion
    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.impact_question import ImpactQuestion
    from contact_dynamics.questions.many import ManyImpactsQuestion, ManyTumblingsQuestion
    from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
    from contact_dynamics.questions.services import Answer, Question
    from contact_dynamics.questions.subject import StateSource
    from contact_dynamics.questions.tumbling import TumblingQuestion
    from contact_dynamics.world import Body

MAX_QUICK_CONTACTS: Final = 4
"""Contacts of a quick question. The numbers of modes and orders grow exponentially with it."""

MAX_QUICK_IMPACTS: Final = 2000
"""Impacts of a quick batch. They take 15 to 25 ms, and a worker would add 1 ms to pass them on."""

MAX_QUICK_CANDIDATES: Final = 10
"""Candidates of a quick question about contact modes. Each takes about a millisecond."""

MAX_QUICK_CORNERS: Final = 64
"""Corners and rims of a shape, times the surfaces of the world, in a quick search for contacts."""

MAX_QUICK_TURNS: Final = 20.0
"""Turns of the body in a quick search for a contact, which takes a millisecond per turn near a surface."""

MAX_QUICK_FITTED: Final = 400
"""States of a quick fit. Such a fit takes 5 ms. Decoding them takes longer, but the server must also do that
for a worker."""

_CORNERS_OF_A_RIM: Final = 8  # in which the base of a cylinder touches


def excerpt(question: Question[Answer], context: Context) -> Context:
    """Return the part of the context with which another process gives the same answer."""
    about = question.about
    sources: list[tuple[Body | str, StateSource]] = []
    if hasattr(about, "bodies") and hasattr(about, "states"):
        sources += zip(about.bodies, about.states, strict=True)
        with suppress(ContactDynamicsError):  # the answer raises it
            sources += zip(about.bodies, at_one_time(about.bodies, about.states, context), strict=True)
    body, source = getattr(about, "body", None), getattr(about, "state", None)
    if body is not None and source is not None:
        sources.append((body, source))
        other = getattr(about, "other", None)
        if other is not None:
            stamp_ns = _stamp_of(body, source, context)
            sources.append((other, at_stamp(getattr(about, "other_state", NEWEST), stamp_ns)))
    wanted = [
        (body if isinstance(body, str) else body.name, source.stamp_ns, source.fit_window)
        for body, source in sources
        if isinstance(source, PublishedState)
    ]
    now_ns = None if context.now_ns is None else context.now_ns()
    states = context.states.excerpt(wanted, now_ns=now_ns)
    return replace(context, states=states, now_ns=partial(_same, now_ns))


def _stamp_of(body: Body | str, source: StateSource, context: Context) -> int:
    """Return the stamp of a body's state, ns, or 0 if there is none, which is an error of the answer."""
    if isinstance(source, PublishedState):
        source = replace(source, fit_window=0.0)
    stamp_ns = 0
    with suppress(ContactDynamicsError):
        stamp_ns = subject_of(body, source, context).state.stamp_ns
    return stamp_ns


def _same(now_ns: int | None) -> int | None:
    return now_ns


def is_quick_flight(question: TumblingQuestion, context: Context) -> bool:
    """Return whether the motion is free, and a search for its end is short."""
    sampling = question.sampling
    if question.wrench is not NO_WRENCH or question.drag is not NO_DRAG:
        return False
    if question.include_covariance or not _is_quick_fit(question.body, question.state, context):
        return False
    if not isinstance(sampling, UntilContact | UntilPlane):
        return True
    horizon = context.defaults.horizon if sampling.duration is None else sampling.duration
    return _is_quick_search(question.body, question.state, horizon, context)


def is_quick_impact(question: ImpactQuestion, context: Context) -> bool:
    """Return whether an impact has few contacts that are found quickly."""
    if question.include_orders or question.include_covariance:
        return False
    if not _is_quick_fit(question.body, question.state, context):
        return False
    if question.other is not None and not _is_quick_fit(question.other, question.other_state, context):
        return False
    if hasattr(question.several_contacts_law, "strike_window"):  # `InTime`, whose import loads all impacts
        return False
    if question.contacts is not None:
        return len(question.contacts) <= MAX_QUICK_CONTACTS
    horizon = context.defaults.horizon if question.horizon is None else question.horizon
    return _is_quick_search(question.body, question.state, horizon, context)


def are_quick_modes(question: ContactModeQuestion, context: Context) -> bool:
    """Return whether there are few contacts, and no expensive options."""
    if (
        question.include_geometry_margins
        or question.include_probabilities
        or not question.uncertainty.is_exact
    ):
        return False
    few = _are_few(question.contacts, question.body, context)
    extra = (
        question.include_margins
        or question.include_wrenches
        or question.include_statics
        or question.include_impact
    )
    return (
        few
        and not (extra and question.problem is not Problem.PLANAR)
        and _is_quick_fit(question.body, question.state, context)
    )


def are_quick_candidates(question: ManyContactModesQuestion, context: Context) -> bool:
    """Return whether there are few candidates, and each is quick."""
    return len(question) <= MAX_QUICK_CANDIDATES and are_quick_modes(question.asked, context)


def are_quick_impacts(question: ManyImpactsQuestion, context: Context) -> bool:  # noqa: ARG001  as all
    """Return whether impacts are few."""
    return len(question.states) <= MAX_QUICK_IMPACTS


def are_quick_flights(question: ManyTumblingsQuestion, context: Context) -> bool:  # noqa: ARG001  as all
    """Return that free flights are quick: 10 000 of them take 30 ms."""
    return True


def _are_few(contacts: ContactSet | None, body: Body | str, context: Context) -> bool:
    if contacts is not None:
        return len(contacts) <= MAX_QUICK_CONTACTS
    return _corners(body, context) <= 2 * MAX_QUICK_CONTACTS  # half of a box's corners touch at once


def _is_quick_search(body: Body | str, source: StateSource, horizon: float, context: Context) -> bool:
    if _corners(body, context) > MAX_QUICK_CORNERS:
        return False
    spin = math.hypot(*subject_of(body, source, context).state.w_WB_W.tolist())
    return spin * horizon <= 2.0 * math.pi * MAX_QUICK_TURNS


def _corners(body: Body | str, context: Context) -> int:
    """Return the number of pairs of a corner of the body and a surface. A rim counts as several corners."""
    known = context.world.body(body) if isinstance(body, str) else body
    shape = known.shape
    corners = sum(len(part.vertices) + _CORNERS_OF_A_RIM * len(part.rims) for part in shape.convex_parts)
    return corners * len(context.world.surfaces)


def _is_quick_fit(body: Body | str, source: StateSource, context: Context) -> bool:
    """Return whether a state is not fitted, or fitted to few states."""
    if not isinstance(source, PublishedState) or not source.fit_window > 0.0:
        return True
    name = body if isinstance(body, str) else body.name
    return context.states.count(name, source.stamp_ns, source.fit_window) <= MAX_QUICK_FITTED
