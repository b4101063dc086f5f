# SPDX-License-Identifier: Apache-2.0
"""Predicts each event from the states that were available some time before it, and compares the results."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import ns_after, seconds_between, to_ns
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.errors import (
    ContactDynamicsError,
    NoContactError,
    NotSupportedError,
    SeparatingContactError,
)
from contact_dynamics.evaluation.comparison import (
    Comparison,
    arrival_std,
    as_normal,
    in_deviations,
    pose_difference,
    velocity_difference,
)
from contact_dynamics.evaluation.settings import Method
from contact_dynamics.measured.events import EventKind
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.context import Context
from contact_dynamics.questions.impact_question import ImpactQuestion, InTime
from contact_dynamics.questions.sample_times import AtStamps, UntilContact
from contact_dynamics.questions.services import ask
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.subject import PublishedState, carried_over, subject_of
from contact_dynamics.questions.tumbling import TumblingQuestion
from contact_dynamics.questions.uncertain_state import UncertainState, state_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.tolerances import HOLD_STEP
from contact_dynamics.tumbling import free_motion

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from contact_dynamics.evaluation.settings import Law, Settings
    from contact_dynamics.measured.events import FoundEvent
    from contact_dynamics.measured.motion import MeasuredMotion
    from contact_dynamics.questions.context import Defaults
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.world import Body, World

FEWEST_ASKED: Final = 5
"""Smallest number of states since the start of a flight for a prediction of its end. A fit to three or four
states would mostly follow their noise. The prediction of a contact mode needs one state."""

_SPARSE: Final = 1.0  # Hz, sample rate of a flight until contact, of which only the end is used


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Informed(Record):
    """The configuration with which predictions are made.

    Attributes:
        world: Bodies, surfaces and gravity. They may differ from those with which the events were found.
        defaults: Tolerances and the look-ahead time for contacts.
        state_timeout: Largest age of the newest state, s.
    """

    world: World
    defaults: Defaults
    state_timeout: float


def asked_before(
    event: FoundEvent, motion: MeasuredMotion, informed: Informed, settings: Settings
) -> dict[float, Context]:
    """Return the context at each horizon, s, before an event. Horizons with too few states are left out."""
    found: dict[float, Context] = {}
    body = known_body(motion, informed)
    for horizon in settings.horizons:
        asked_ns = event.asked_ns(horizon)
        samples = motion.known_by(asked_ns, since=event.first_sample)
        if len(samples) < (1 if event.mode else FEWEST_ASKED):
            continue
        stamps_ns = motion.stamps_ns[samples]
        store = StateStore(history=settings.fit_window, timeout=informed.state_timeout)
        window = 0.0 if event.mode else settings.fit_window  # modes need only the newest
        for state in motion.states(samples[stamps_ns >= stamps_ns[-1] - to_ns(window)].tolist()):
            store.add(event.body, carried_over(state, motion.body, body))
        found[horizon] = Context(
            world=informed.world,
            states=store,
            defaults=informed.defaults,
            now_ns=lambda asked_ns=asked_ns: asked_ns,  # type: ignore[misc]  # binds the current value
        )
    return found


def known_body(motion: MeasuredMotion, informed: Informed) -> Body:
    """Return the body as configured for predictions. Its centre of mass may be another point of the body."""
    same = (body for body in informed.world.bodies if body.name == motion.body.name)
    return next(same, motion.body)


def of_known_center(event: FoundEvent, motion: MeasuredMotion, informed: Informed) -> FoundEvent:
    """Return an event with the state of the centre of mass that predictions use."""
    state = carried_over(event.state, motion.body, known_body(motion, informed))
    return replace(event, state=state_of(state))


def compare_event(
    number: int, event: FoundEvent, asked: Mapping[float, Context], settings: Settings
) -> Iterator[Comparison]:
    """Yield a row for each prediction of an event, from the context at each horizon before it."""
    event = next((settings.error.of_event(event, known.world) for known in asked.values()), event)
    for horizon, known in asked.items():
        for method, law in _ways(event.kind, settings):
            row = Comparison(
                event=number,
                kind=event.kind,
                body=event.body,
                surface=event.surface,
                time=event.time,
                horizon=horizon,
                method=method,
                law=law,
                measured_mode=event.mode,
                several=event.several,
            )
            try:
                yield _ANSWERS[event.kind](row, event, known, settings)
            except ContactDynamicsError as error:
                yield replace(row, refused=f"{type(error).__name__}: {error}")


def _ways(kind: EventKind, settings: Settings) -> list[tuple[Method, Law | None]]:
    """Return the combinations of method and law with which an event of this kind is predicted."""
    if kind is EventKind.IMPACT:
        fits = [(Method.FIT, law) for law in settings.laws]
        return [*fits, (Method.NEWEST, settings.laws[0]), (Method.NO_IMPACT, None)]
    if kind in {EventKind.REST, EventKind.SLIDING}:
        return [(Method.NEWEST, None)]
    return [(Method.FIT, None), (Method.NEWEST, None)]


def _source(row: Comparison, settings: Settings) -> PublishedState:
    return PublishedState(fit_window=0.0 if row.method is Method.NEWEST else settings.fit_window)


def _has_covariance(row: Comparison, known: Context) -> bool:
    """Return whether the initial state of a prediction has a covariance, which every fit has."""
    if row.method is Method.NEWEST:
        return isinstance(known.states.newest(row.body), UncertainState)
    return row.method is Method.FIT


def _tumbling(
    row: Comparison, known: Context, settings: Settings, sampling: AtStamps | UntilContact
) -> TumblingAnswer:
    question = TumblingQuestion(
        body=row.body,
        state=_source(row, settings),
        sampling=sampling,
        include_covariance=_has_covariance(row, known),
    )
    return ask(question, known)


def _flight(row: Comparison, event: FoundEvent, known: Context, settings: Settings) -> Comparison:
    answer = _tumbling(row, known, settings, AtStamps(stamps_ns=[event.time_ns]))
    state = _sample(answer.trajectory, 0)
    pose, distance = pose_difference(state, event.state), None
    if answer.covariance is not None:
        stds = np.array([*[event.position_std] * 3, *event.orientation_std])
        covariance = answer.covariance.covariances[0, :6, :6].copy()
        subject = subject_of(row.body, _source(row, settings), known)
        place, rate = subject.by_gravity
        ahead = seconds_between(subject.state.stamp_ns, event.time_ns)
        covariance[:3, :3] += (place + ahead * (rate + 0.5 * ahead)) ** 2 * settings.error.gravity_W
        distance = in_deviations(pose, covariance, stds)
    return _with_state(row, state, event, distance=distance, degrees=6)


def _landing(row: Comparison, event: FoundEvent, known: Context, settings: Settings) -> Comparison:
    answer = _tumbling(row, known, settings, UntilContact(rate=_SPARSE))
    if answer.event is None:
        return replace(row, refused="no contact within the horizon")
    state = _sample(answer.trajectory, len(answer.trajectory) - 1)
    landing_ns = ns_after(answer.state.stamp_ns, answer.event.seconds)
    error, distance = seconds_between(event.time_ns, landing_ns), None
    if answer.covariance is not None:
        std = arrival_std(answer.event, state, answer.covariance.covariances[-1, :6, :6], known.world)
        if std is not None and std + event.time_std > 0.0:
            distance = abs(error) / float(np.hypot(std, event.time_std))
    return replace(_with_state(row, state, event, distance=distance, degrees=1), time_error=error)


@lru_cache(maxsize=1)
def first_answer(event: FoundEvent, known: Context, settings: Settings) -> ImpactAnswer:
    """Return the answer from the fit under the first law. `Method.NO_IMPACT` continues its flight."""
    source = PublishedState(fit_window=settings.fit_window)
    return _asked_impact(event, known, settings.laws[0], source, include_covariance=True)


def _asked_impact(
    event: FoundEvent, known: Context, law: Law, source: PublishedState, *, include_covariance: bool
) -> ImpactAnswer:
    several = law.several_contacts_law
    question = ImpactQuestion(
        body=event.body,
        state=source,
        restitution_law=law.restitution_law,
        several_contacts_law=several,
        include_covariance=include_covariance,
    )
    try:
        if isinstance(several, InTime):
            # Strikes after the start of the next flight do not count, unless there are no earlier ones.
            brief = replace(several, strike_window=event.duration + HOLD_STEP)
            with suppress(NoContactError, SeparatingContactError):
                return ask(replace(question, several_contacts_law=brief), known)
        return ask(question, known)
    except NotSupportedError:  # covariances are supported for a single contact only
        if not include_covariance:
            raise
        return ask(replace(question, include_covariance=False), known)


def _impact(row: Comparison, event: FoundEvent, known: Context, settings: Settings) -> Comparison:
    """Return the row with the state that is predicted for the end of the measured impact."""
    law = row.law or settings.laws[0]
    if row.method is not Method.NEWEST and law is settings.laws[0]:
        answer = first_answer(event, known, settings)
    else:
        has_covariance = law is settings.laws[0] and _has_covariance(row, known)
        answer = _asked_impact(event, known, law, _source(row, settings), include_covariance=has_covariance)
    state, covariance, lasted = answer.impact.state, answer.impact.covariance, 0.0
    if row.method is Method.NO_IMPACT:
        state, covariance = answer.state, None
    elif answer.impact.strikes:  # only those before the next flight
        strike = [strike for strike in answer.impact.strikes if strike.seconds <= event.duration][-1]
        state, lasted = strike.state_after, strike.seconds
    body = known.world.body(event.body).mass_properties
    state = free_motion(body, state, gravity_W=known.world.gravity_W).state_at(event.duration - lasted)
    distance = None
    if covariance is not None:
        stds = np.array([*[event.velocity_std] * 3, *event.angular_velocity_std])
        of_law = settings.error.of_law(body, answer.state, answer.contacts.p_WC_W[0])
        off = velocity_difference(state, event.state)
        distance = in_deviations(off, covariance[6:, 6:] + of_law, stds)
        if distance is not None:
            distance = as_normal(distance, len(stds), settings.error.freedom)
    return _with_state(row, state, event, distance=distance, degrees=6)


def _mode(
    row: Comparison,
    event: FoundEvent,
    known: Context,
    settings: Settings,  # noqa: ARG001  same signature as the other entries of _ANSWERS
) -> Comparison:
    answer = ask(ContactModeQuestion(body=event.body), known)
    modes = [mode.mode for mode in answer.modes] if answer.verdict is not ModeVerdict.IMPACT else []
    return replace(
        row,
        predicted_mode="|".join(modes) or answer.verdict.name,
        mode_is_right=any(_does(mode) is event.kind for mode in modes),
    )


def _does(mode: str) -> EventKind | None:
    """Return the kind of motion in a mode: rest, sliding without a separating contact, or None."""
    if set(mode) <= {"f"}:
        return EventKind.REST
    return None if "s" in mode else EventKind.SLIDING


def _sample(trajectory: Trajectory, i: int) -> BodyState:
    return BodyState(
        p_WB_W=trajectory.p_WB_W[i],
        q_WB=trajectory.q_WB[i],
        v_WB_W=trajectory.v_WB_W[i],
        w_WB_W=trajectory.w_WB_W[i],
    )


def _with_state(
    row: Comparison, state: BodyState, event: FoundEvent, *, distance: float | None, degrees: int
) -> Comparison:
    pose, velocity = pose_difference(state, event.state), velocity_difference(state, event.state)
    return replace(
        row,
        position_error=float(np.linalg.norm(pose[:3])),
        attitude_error=float(np.linalg.norm(pose[3:])),
        velocity_error=float(np.linalg.norm(velocity[:3])),
        spin_error=float(np.linalg.norm(velocity[3:])),
        distance=distance,
        degrees=0 if distance is None else degrees,
        predicted=np.concatenate([state.p_WB_W, state.q_WB, state.v_WB_W, state.w_WB_W]),
    )


_ANSWERS: Final = {
    EventKind.FLIGHT: _flight,
    EventKind.LANDING: _landing,
    EventKind.IMPACT: _impact,
    EventKind.REST: _mode,
    EventKind.SLIDING: _mode,
}
