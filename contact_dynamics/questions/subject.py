# SPDX-License-Identifier: Apache-2.0
"""Finds the body of a question, in its given or published state."""

from __future__ import annotations

import itertools
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.contact.found import NO_CONTACTS, contacts_within
from contact_dynamics.contact.noise import NoisyState, resting, touching
from contact_dynamics.contact.velocities import relative_velocities
from contact_dynamics.errors import InvalidFieldError, NotInFlightError, NotSupportedError
from contact_dynamics.motion.between_states import share_between, state_between
from contact_dynamics.motion.covariance import covariance_along
from contact_dynamics.motion.free_fit import FitResult, fit_free_motion
from contact_dynamics.motion.whole_turns import THIRD_OF_A_TURN
from contact_dynamics.questions.uncertain_state import KnownState, UncertainState, state_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rigid_body.published_frame import (
    covariance_of_other_point,
    origin_of_published_frame,
    state_of_center_of_mass,
    velocity_of_published_frame,
)
from contact_dynamics.tumbling import free_motion
from contact_dynamics.validation import FloatArray, check_not_negative, check_stamp
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.questions.context import Context
    from contact_dynamics.rigid_body.body import MassProperties

    Fitting: TypeAlias = Callable[[MassProperties, Sequence[BodyState]], FitResult]


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PublishedState(Record):
    """A reference to the published state of a body, or to a fit to several states.

    Attributes:
        stamp_ns: ns, the time of the state. Between two published states it is interpolated
            (`motion.between_states`). After the latest one it follows the free motion under gravity, at most
            the default horizon ahead. None means the latest state as it is.
        fit_window: s, >= 0. The motion is fitted to the states of this last time up to ``stamp_ns``, and
            followed to there. Zero means no fit.

    Raises:
        InvalidFieldError: the stamp is not a whole number, or the window is negative or not finite.
    """

    stamp_ns: int | None = None
    fit_window: float = 0.0

    def __post_init__(self) -> None:
        """Check the fields."""
        if self.stamp_ns is not None:
            object.__setattr__(self, "stamp_ns", check_stamp("stamp_ns", self.stamp_ns))
        object.__setattr__(self, "fit_window", check_not_negative("fit_window", self.fit_window))


NEWEST: Final = PublishedState()  # the newest published state

StateSource: TypeAlias = "BodyState | UncertainState | PublishedState"
"""The sources of a body's state: a question contains the state, or refers to a published one."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class FitQuality(Record):
    """Quality of the fit of a motion to the published states.

    Attributes:
        count: Number of fitted states.
        position_residual: m, root mean square distance of the positions.
        orientation_residual: rad, root mean square angle between the orientations.
    """

    count: int
    position_residual: float
    orientation_residual: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class NamedState(Record):
    """State of one of the bodies in an answer about several.

    Attributes:
        name: Name of the body, which may be empty.
        p_FB_F: (3,), m, centre of mass in the published frame F.
        state: Its state.
    """

    name: str
    p_FB_F: FloatArray
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Subject(Record):
    """The body of a question, and its state.

    Attributes:
        body: The body.
        state: Its state.
        covariance: (12, 12), of the state, in the order of `UncertainState`, or None if it is unknown.
        fit: Quality of the fit to published states, or None without a fit.
        by_gravity: s^2 and s, derivatives of position and velocity by gravity, over the flight from which the
            state was found.
    """

    body: Body
    state: BodyState
    covariance: FloatArray | None = None
    fit: FitQuality | None = None
    by_gravity: tuple[float, float] = (0.0, 0.0)


def at_stamp(source: StateSource, stamp_ns: int) -> StateSource:
    """Return the source of a second body's state, with the latest state replaced by that at ``stamp_ns``.

    The stamp, ns, is that of the first body's state, or 0 if it is unknown.
    """
    if isinstance(source, PublishedState) and source.stamp_ns is None and stamp_ns:
        return replace(source, stamp_ns=stamp_ns)
    return source


def at_one_time(
    bodies: Sequence[Body | str], sources: Sequence[StateSource], context: Context
) -> tuple[StateSource, ...]:
    """Return the sources of several bodies' states, with the latest states replaced by those at one time.

    It is the stamp of the oldest of them, so that no state is extrapolated: bodies in contact do not move
    freely. The errors are those of `subject_of`,
    and of `check_different`.
    """
    check_different(bodies, sources)
    newest = [
        subject_of(body, source, context).state.stamp_ns
        for body, source in zip(bodies, sources, strict=True)
        if isinstance(source, PublishedState) and source.stamp_ns is None
    ]
    return tuple(at_stamp(source, min(newest, default=0)) for source in sources)


def check_different(bodies: Sequence[Body | str], sources: Sequence[StateSource]) -> None:
    """Raise `InvalidFieldError` for a body that is named twice with its published state: it is not two."""
    pairs = zip(bodies, sources, strict=True)
    names = [getattr(body, "name", body) for body, source in pairs if isinstance(source, PublishedState)]
    if len(set(names)) < len(names):
        raise InvalidFieldError("body_name", names, "different, or have explicit states")


def subject_of(
    body: Body | str, source: StateSource, context: Context, *, fit: Fitting | None = None
) -> Subject:
    """Return the body of a question, in the state that the question contains or refers to.

    Args:
        body: The body, or its name in the world of the context.
        source: Its state, or a reference to a published one.
        context: The world and the published states.
        fit: A function that fits a motion to a window of published states. By default, it is a free flight.

    Raises:
        UnknownBodyError: the world has no body of that name.
        NoStateError: no state of it was published, or every stored one has a later stamp.
        StaleStateError: the latest state is too old, or those around the stamp are too far apart.
        InvalidFieldError: a published state is required and the body has no name; no motion can be fitted to
            the window, or several that differ by whole turns between states; or the stamp is further ahead of
            the latest state than the default horizon, or after it while the body moves on a surface.
        NotInFlightError: an impact lies in the window, or the body rests, slides or is carried.
        TooLargeError: the window has too many states.
    """
    if isinstance(body, str):
        body = context.world.body(body)
    if isinstance(source, BodyState):
        return Subject(body=body, state=source)
    if isinstance(source, UncertainState):
        return Subject(body=body, state=source.state, covariance=source.covariance)
    known, later = _published(body, source, context)
    if source.fit_window == 0.0:
        newest = Subject(body=body, state=state_of(known[-1]), covariance=_covariance(known[-1]))
        return _moved(newest, later, source.stamp_ns, context)
    states = [state_of(each) for each in known]
    try:
        if fit is None:
            best = kept_fit(body.mass_properties, states, gravity_W=context.world.gravity_W)
        else:
            best = fit(body.mass_properties, states)
    except InvalidFieldError as error:
        if error.field != "states":
            raise
        # The question's name for them.
        raise type(error)("fit_window", error.found, error.allowed, error.hint) from None
    _check_fit(best, states)
    quality = FitQuality(
        count=best.count,
        position_residual=best.position_residual,
        orientation_residual=best.orientation_residual,
    )
    found = Subject(
        body=body,
        state=best.state,
        covariance=best.covariance,
        fit=quality,
        by_gravity=best.by_gravity or (0.0, 0.0),
    )
    return _moved(found, None, source.stamp_ns, context)


_WITHOUT_FIT: Final = "0 takes the newest state as it is"


def _check_fit(fit: FitResult, states: Sequence[BodyState]) -> None:
    """Raise an error for a motion that does not fit the states, or may not be the only one that does.

    Without published angular velocities, a body is assumed to turn by less than half a turn between states if
    the fitted turn is less than a third.
    """
    if fit.velocity_jump is not None:
        raise NotInFlightError(
            "fit_window",
            f"a window whose velocity jumps as in an impact, {-fit.velocity_jump:.3g} s before its end",
            "a window that begins after the impact",
            _WITHOUT_FIT,
        )
    if not fit.falls:
        raise NotInFlightError(
            "fit_window",
            f"{fit.count} states of a body that does not fall: it rests, slides or is carried",
            "a window of free flight",
            _WITHOUT_FIT,
        )
    if not fit.converged:
        raise InvalidFieldError(
            "fit_window",
            f"one whose {fit.count} states the fitted flight misses by {fit.position_residual:.3g} m and "
            f"{fit.orientation_residual:.3g} rad (rms)",
            "a window in which nothing touches the body, and angular velocities if it spins fast",
        )
    longest = max(seconds_between(a.stamp_ns, b.stamp_ns) for a, b in itertools.pairwise(states))
    turn = float(np.linalg.norm(fit.state.w_WB_W)) * longest
    has_rates = any(state.w_WB_W.any() for state in states)
    if not fit.turns_known and (has_rates or turn >= THIRD_OF_A_TURN):
        rates = ", ".join(
            f"{float(np.linalg.norm(state.w_WB_W)):.4g}" for state in (fit.state, *fit.alternatives)
        )
        raise InvalidFieldError(
            "fit_window",
            f"states that do not show how many turns the body makes between them ({rates} rad/s)",
            "states with angular velocities, or more states a second",
        )


def covariance_of(subject: Subject) -> FloatArray:
    """Return the covariance of a subject's state, (12, 12), or raise `InvalidFieldError` if it has none."""
    if subject.covariance is None:
        raise InvalidFieldError(
            "state.covariance", "none", "144 numbers of an explicit or a published state, or a fit_window"
        )
    return subject.covariance


def changed_body(known: Body, mass_properties: MassProperties, p_FB_F: FloatArray) -> Body:
    """Return a body with the name and the shape of a known one, and other mass properties.

    ``p_FB_F`` is the new centre of mass, (3,), m, in its published frame F.
    """
    return Body(
        name=known.name,
        mass_properties=mass_properties,
        p_FB_F=p_FB_F,
        shape=known.shape.moved(known.p_FB_F - p_FB_F),
    )


def _published(
    body: Body, source: PublishedState, context: Context
) -> tuple[Sequence[KnownState], KnownState | None]:
    """Return the required published states by time, as states of the body's centre of mass.

    The second value is the state after the given stamp, if that is between two states.
    """
    name = body.name
    if not name:
        raise InvalidFieldError("body_name", name, "the name of a known body, or a state of its own")
    now_ns = None if context.now_ns is None else context.now_ns()
    later: KnownState | None = None
    if source.stamp_ns is None:
        newest = context.states.newest(name, now_ns=now_ns)
    else:
        newest, later = context.states.around(name, source.stamp_ns, now_ns=now_ns)
    window = source.fit_window
    states = context.states.window(name, newest, window) if window > 0.0 else [newest]
    # States are published of the known body. The one asked about may share its name and have another mass.
    known = context.world.body(name)
    if body is not known:
        states = [carried_over(state, known, body) for state in states]
        later = None if later is None else carried_over(later, known, body)
    return states, later


def _moved(subject: Subject, later: KnownState | None, stamp_ns: int | None, context: Context) -> Subject:
    """Return a subject at a stamp: between its state and the later one, or in free motion."""
    state = subject.state
    if stamp_ns is None or stamp_ns == state.stamp_ns:
        return subject
    if later is not None:
        between = state_between(state, state_of(later), stamp_ns)
        covariance = _covariance(later)
        if subject.covariance is None or covariance is None:
            return replace(subject, state=between, covariance=None)
        share = share_between(state, state_of(later), stamp_ns)
        return replace(
            subject, state=between, covariance=(1.0 - share) * subject.covariance + share * covariance
        )
    ahead, horizon = seconds_between(state.stamp_ns, stamp_ns), context.defaults.horizon
    if ahead > horizon:
        found = f"{ahead:.9g} s after the latest state"
        raise InvalidFieldError("stamp", found, f"at most {horizon:g} s, the default horizon")
    if _stays(subject, ahead, context):
        return replace(subject, state=replace(state, stamp_ns=stamp_ns))
    motion = free_motion(subject.body.mass_properties, state, gravity_W=context.world.gravity_W)
    covariance = subject.covariance
    if covariance is not None:
        covariance = covariance_along(motion, covariance, [ahead]).covariances[0]
    place, rate = subject.by_gravity
    return replace(
        subject,
        state=replace(motion.state_at(ahead), stamp_ns=stamp_ns),
        covariance=covariance,
        by_gravity=(place + ahead * (rate + 0.5 * ahead), rate + ahead),
    )


def _stays(subject: Subject, ahead: float, context: Context) -> bool:
    """Return whether a body rests on a surface in its state, s before the one asked about.

    With a covariance, it rests if the noise explains its gaps and velocities (`contact.noise`).

    Raises:
        InvalidFieldError: it touches a surface and moves, and free motion does not follow.
    """
    body, state, surfaces = subject.body, subject.state, context.world.surfaces
    distance, tolerance = context.defaults.distance_tolerance, context.defaults.velocity_tolerance
    noisy = None if subject.covariance is None else NoisyState.of(state, subject.covariance)
    touched = NO_CONTACTS
    if not body.shape.is_empty:
        with suppress(NotSupportedError):  # a rim at the edge of an obstacle
            if noisy is not None:
                noisy = touching(body, noisy, surfaces, distance_tolerance=distance)
                state = noisy.state
            touched = contacts_within(body, state, surfaces, distance)
    if len(touched) == 0:
        return False
    if noisy is not None:
        state = resting(noisy, touched, velocity_tolerance=tolerance).state
    rests = max(np.abs(state.v_WB_W).max(), np.abs(state.w_WB_W).max()) <= tolerance
    rates = np.einsum("ij,ij->i", relative_velocities(state, touched), touched.normals_W)
    # A measured body that approaches may be in flight, just above the surface.
    flies = (rates > tolerance).all() if noisy is None else (np.abs(rates) > tolerance).all()
    if rests or flies:
        return bool(rests)
    raise InvalidFieldError(
        "stamp",
        f"{ahead:.3g} s after the latest state, in which {body.name!r} moves and touches "
        f"{touched.surfaces[int(rates.argmin())]!r}",
        "at most that of the latest state, unless the body flies or rests",
    )


def _covariance(known: KnownState) -> FloatArray | None:
    return None if isinstance(known, BodyState) else known.covariance


def carried_over(published: KnownState, known: Body, body: Body) -> KnownState:
    """Return the state of a body's centre of mass, from that of the known body with another centre."""
    if np.array_equal(known.p_FB_F, body.p_FB_F):
        return published
    state = state_of(published)
    moved = state_of_center_of_mass(
        p_WF_W=origin_of_published_frame(state, known.p_FB_F),
        q_WF=state.q_WB,
        v_WF_W=velocity_of_published_frame(state, known.p_FB_F),
        w_WF_W=state.w_WB_W,
        p_FB_F=body.p_FB_F,
        stamp_ns=state.stamp_ns,
    )
    if isinstance(published, BodyState):
        return moved
    covariance = covariance_of_other_point(published.covariance, state, body.p_FB_F - known.p_FB_F)
    return UncertainState(state=moved, covariance=covariance)


_KEPT: Final = 4


def kept_fit(body: MassProperties, states: Sequence[BodyState], *, gravity_W: FloatArray) -> FitResult:
    """Return the free motion that fits ``states`` best; see `fit_free_motion`, and its errors.

    The last few results are cached, since several questions refer to one window of states, and a fit takes
    longer than the rest of an answer.
    """
    return _fit(body, tuple(states), tuple(gravity_W.tolist()))


@lru_cache(maxsize=_KEPT)
def _fit(body: MassProperties, states: tuple[BodyState, ...], gravity_W: tuple[float, ...]) -> FitResult:
    return fit_free_motion(body, states, gravity_W=gravity_W)
