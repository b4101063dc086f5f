# SPDX-License-Identifier: Apache-2.0
"""Determines the times of the samples of a trajectory, and the event that ends it."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.contact.found import check_has_shape
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.landing.search_work import SearchWork
from contact_dynamics.motion.integrated import ForcedMotion
from contact_dynamics.questions.context import check_optional, or_default
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_magnitude,
    check_positive,
    check_stamp,
    check_unit,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.subject import Subject
    from contact_dynamics.tumbling import FreeMotion

MAX_SAMPLES: Final = 20_000
"""Largest number of samples in one answer, which has then 2.2 MB of numbers. More would stall the middleware
for longer than the answer takes."""

MAX_INTEGRATED_TURNS: Final = 100.0
"""Longest motion under torque or drag in one answer, in turns at the present rate. It takes 1 or 2 s of
computing, during which a server answers nobody else."""

MAX_INTEGRATED_STEPS: Final = 6000
"""Largest number of the integrator's steps in one answer. A body that a torque spins up takes more steps than
its present rate says, and a server answers nobody else meanwhile."""

MAX_SEARCHED_TURNS: Final = 1000.0
"""Longest search for a contact in one answer, in turns. A body that spins close to a surface without touching
it takes a millisecond a turn, during which a server answers nobody else."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AtTimes(Record):
    """Samples at given times after the state.

    Attributes:
        times: (n,), s after the state's stamp, ascending, >= 0 (`AtStamps` reaches into the past). At least
            one.

    Raises:
        InvalidFieldError: there is no time, or one is negative, not finite, or before the one in front of it.
        TooLargeError: more than `MAX_SAMPLES` times.
    """

    times: FloatArray

    if TYPE_CHECKING:

        def __init__(self, *, times: ArrayLike) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check the times."""
        times = _ascending("times", self.times)
        if len(times) == 0:
            raise InvalidFieldError("times", "none", "at least one time")
        if times[0] < 0.0:
            raise InvalidFieldError("times[0]", times[0], ">= 0 (stamps reach into the past)")
        object.__setattr__(self, "times", times)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class AtStamps(Record):
    """Samples at given stamps.

    Attributes:
        stamps_ns: (n,), ns on the clock of the state's stamp, ascending, before or after that stamp. At least
            one.

    Raises:
        InvalidFieldError: there is no stamp, or one is before the one in front of it.
        TooLargeError: more than `MAX_SAMPLES` stamps.
    """

    stamps_ns: tuple[int, ...]

    if TYPE_CHECKING:

        def __init__(self, *, stamps_ns: Iterable[int]) -> None:
            """Take any whole numbers."""

    def __post_init__(self) -> None:
        """Check the stamps."""
        try:
            stamps = tuple(self.stamps_ns)
        except TypeError:
            raise InvalidFieldError("stamps_ns", self.stamps_ns, "a sequence of whole numbers, ns") from None
        _check_count("stamps_ns", len(stamps))
        if not stamps:
            raise InvalidFieldError("stamps_ns", "none", "at least one stamp")
        stamps = tuple(check_stamp(f"stamps_ns[{i}]", one) for i, one in enumerate(stamps))
        for i, (earlier, later) in enumerate(itertools.pairwise(stamps)):
            if later < earlier:
                before = seconds_between(later, earlier)
                raise InvalidFieldError(
                    f"stamps_ns[{i + 1}]", f"{before:.9g} s before stamps_ns[{i}]", "ascending times"
                )
        object.__setattr__(self, "stamps_ns", stamps)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class AtRate(Record):
    """Samples from the state on, at a steady rate.

    Attributes:
        rate: Hz, > 0, number of samples a second. None means the default.
        duration: s, >= 0, how far to go. None means the default horizon.

    Raises:
        InvalidFieldError: a number is out of its range or not finite.
    """

    rate: float | None = None
    duration: float | None = None

    def __post_init__(self) -> None:
        """Check both numbers."""
        if self.rate is not None:
            object.__setattr__(self, "rate", check_positive("rate", self.rate))
        object.__setattr__(self, "duration", check_optional("duration", self.duration))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class UntilContact(AtRate):
    """Samples at a steady rate that end with the first contact of the body with a surface of the world.

    Attributes:
        rate: Hz, > 0, number of samples a second. None means the default.
        duration: s, >= 0, how far to go. None means the default horizon.
    """


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class UntilPlane(AtRate):
    """Samples at a steady rate that end when a point of the body reaches a plane from the normal's side.

    A point that begins behind the plane first has to pass it, as a ball thrown up past the height of a catch.

    Attributes:
        plane_point: (3,), m, a point of the plane, world.
        plane_normal: (3,), unit, its normal, world axes, towards the side from which the point comes.
        body_point: (3,), m, the point of the body, in its published frame F.
        rate: Hz, > 0, number of samples a second. None means the default.
        duration: s, >= 0, how far to go. None means the default horizon.

    Raises:
        InvalidFieldError: a number is out of its range, not finite or beyond `LARGEST_NUMBER`, or the normal
            is not unit.
    """

    plane_point: FloatArray
    plane_normal: FloatArray
    body_point: FloatArray

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            plane_point: ArrayLike,
            plane_normal: ArrayLike,
            body_point: ArrayLike,
            rate: float | None = ...,
            duration: float | None = ...,
        ) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check all five."""
        AtRate.__post_init__(self)
        for name in ("body_point", "plane_point"):
            point = check_magnitude(name, check_array(name, getattr(self, name), (3,)))
            object.__setattr__(self, name, point)
        object.__setattr__(self, "plane_normal", check_unit("plane_normal", self.plane_normal, 3))


Sampling: TypeAlias = "AtTimes | AtStamps | AtRate"
"""The ways to sample a trajectory. `UntilContact` and `UntilPlane` are kinds of `AtRate`."""


class EventKind(NamedInt):
    """What ends a trajectory. Messages have the same numbers."""

    CONTACT = 1
    """A vertex of the body reached a surface (`UntilContact`)."""
    PLANE_REACHED = 2
    """The point reached the plane (`UntilPlane`)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Event(Record):
    """What ends a trajectory.

    Attributes:
        kind: Contact with a surface, or the plane of the question.
        seconds: s after the state's stamp.
        point_W: (3,), m, the point of the body that arrives, world.
        velocity_W: (3,), m/s, its velocity, world axes.
        surface: The name of the surface, or empty for the plane of the question.
    """

    kind: EventKind
    seconds: float
    point_W: FloatArray
    velocity_W: FloatArray
    surface: str


def times_of(
    sampling: Sampling, subject: Subject, motion: FreeMotion | ForcedMotion, context: Context
) -> tuple[FloatArray, Event | None]:
    """Return the times of the samples, (n,), s after the state's stamp, and the event that ends the motion.

    Raises:
        InvalidFieldError: the motion would be integrated or searched for too long, or a point is behind its
            plane and moves away.
        TooLargeError: more samples than `MAX_SAMPLES`.
        NoContactError: the body of a search for contact has no shape.
    """
    if isinstance(sampling, AtTimes):
        _check_reach("times", motion, sampling.times)
        return sampling.times, None
    if isinstance(sampling, AtStamps):
        begin_ns = subject.state.stamp_ns
        times = np.array([seconds_between(begin_ns, stamp) for stamp in sampling.stamps_ns])
        _check_reach("stamps_ns", motion, times)
        return times, None
    duration = or_default(sampling.duration, context.defaults.horizon)
    rate = or_default(sampling.rate, context.defaults.rate)
    searches = isinstance(sampling, UntilContact | UntilPlane)
    _check_reach("duration", motion, np.array([duration]), search=searches)
    event = None
    if isinstance(sampling, UntilContact):
        event = _contact(subject, motion, context, duration)
    elif isinstance(sampling, UntilPlane):
        event = _plane_reached(sampling, subject, motion, duration, context.defaults.distance_tolerance)
    return _at_rate(rate, duration, None if event is None else event.seconds), event


def _contact(
    subject: Subject, motion: FreeMotion | ForcedMotion, context: Context, duration: float
) -> Event | None:
    check_has_shape(subject.body)
    landing = next_landing(
        subject.body,
        subject.state,
        context.world,
        horizon=duration,
        distance_tolerance=context.defaults.distance_tolerance,
        velocity_tolerance=context.defaults.velocity_tolerance,
        motion=motion,
        work=SearchWork("duration"),
    )
    if landing is None:
        return None
    return Event(
        kind=EventKind.CONTACT,
        seconds=landing.seconds,
        point_W=landing.contacts.p_WC_W[0],
        velocity_W=landing.velocities_W[0],
        surface=landing.contacts.surfaces[0],
    )


def _plane_reached(
    sampling: UntilPlane,
    subject: Subject,
    motion: FreeMotion | ForcedMotion,
    duration: float,
    tolerance: float,
) -> Event | None:
    point_B = sampling.body_point - subject.body.p_FB_F
    found = first_contact(
        motion,
        point_B[None, :],
        sampling.plane_point,
        sampling.plane_normal,
        horizon=duration,
        work=SearchWork("duration"),
    )
    if found is None:
        return None
    depth = float(sampling.plane_normal @ (sampling.plane_point - found.p_WC_W))
    if found.seconds == 0.0 and depth > tolerance:
        behind = f"a normal away from the point, which is {depth:.6g} m behind the plane and moves away"
        raise InvalidFieldError("plane_normal", behind, "a normal towards the side the point comes from")
    return Event(
        kind=EventKind.PLANE_REACHED,
        seconds=found.seconds,
        point_W=found.p_WC_W,
        velocity_W=found.v_WC_W,
        surface="",
    )


def _check_reach(
    field: str, motion: FreeMotion | ForcedMotion, times: FloatArray, *, search: bool = False
) -> None:
    """Reject an integration or a search that would take too long."""
    if isinstance(motion, ForcedMotion):
        most, when = MAX_INTEGRATED_TURNS, "under torque or drag"
    elif search:
        most, when = MAX_SEARCHED_TURNS, "to search for a contact"
    else:
        return  # the closed form reaches everywhere
    check_turns(field, motion, times, most, when)


def check_turns(
    field: str, motion: FreeMotion | ForcedMotion, times: FloatArray, most: float, when: str
) -> None:
    """Reject times, (n,), s, in which a body turns more than ``most`` at its present rate, with a reason."""
    w_WB_W = motion.state.w_WB_W
    turns = float(np.abs(times).max(initial=0.0)) * math.sqrt(w_WB_W @ w_WB_W) / (2.0 * math.pi)
    if turns > most:
        raise InvalidFieldError(field, f"{turns:.6g} turns of the body ahead", f"at most {most:g} {when}")


def _at_rate(rate: float, duration: float, end: float | None) -> FloatArray:
    """Return times from 0 at a rate, up to the duration or to the event, which is then the last time."""
    until = duration if end is None else end
    _check_count("rate * duration", until * rate)
    times = np.arange(math.floor(until * rate * (1.0 + 1e-12)) + 1) / rate
    return times if end is None else np.append(times[times < end], end)


def _ascending(field: str, times: ArrayLike) -> FloatArray:
    """Return times, (n,), s, or raise an error if they do not ascend or are too many."""
    listed = np.asarray(times)
    _check_count(field, listed.size)
    checked = check_array(field, listed, (None,))
    if len(checked) < 2:  # as in most questions; NumPy takes long to find that nothing descends
        return checked
    steps = np.diff(checked)
    for i in np.flatnonzero(steps < 0.0)[:1]:
        raise InvalidFieldError(
            f"{field}[{i + 1}]", f"{-steps[i]:.9g} s before {field}[{i}]", "ascending times"
        )
    return checked


def _check_count(field: str, count: float) -> None:
    if count > MAX_SAMPLES:
        raise TooLargeError(field, f"{count:.9g} samples", f"at most {MAX_SAMPLES}")
