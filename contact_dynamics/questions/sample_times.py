"""At which times a trajectory is asked for, and what ends it."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.questions.knowledge import check_optional
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.validation import FloatArray, check_array, check_unit

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike

MOST_SAMPLES: Final = 20_000
"""Longest trajectory in one answer: 2.2 MB of numbers. More would stall the middleware for longer than the
answer takes."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AtTimes(Record):
    """Samples at given times after the state.

    Attributes:
        times: (n,), s after the state's stamp, ascending, >= 0 (`AtStamps` reaches into the past).

    Raises:
        InvalidFieldError: a time is negative, not finite, or before the one in front of it.
        TooLargeError: more than `MOST_SAMPLES` times.
    """

    times: FloatArray

    if TYPE_CHECKING:

        def __init__(self, *, times: ArrayLike) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check the times."""
        times = ascending("times", self.times)
        if len(times) > 0 and times[0] < 0.0:
            raise InvalidFieldError("times[0]", times[0], "a number >= 0 (AT_STAMPS reaches into the past)")
        object.__setattr__(self, "times", times)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class AtStamps(Record):
    """Samples at given stamps.

    Attributes:
        stamps_ns: (n,), ns on the clock of the state's stamp, ascending, before or after that stamp.

    Raises:
        InvalidFieldError: a stamp is before the one in front of it.
        TooLargeError: more than `MOST_SAMPLES` stamps.
    """

    stamps_ns: tuple[int, ...]

    if TYPE_CHECKING:

        def __init__(self, *, stamps_ns: Iterable[int]) -> None:
            """Take any whole numbers."""

    def __post_init__(self) -> None:
        """Check the stamps."""
        stamps = tuple(self.stamps_ns)
        check_count("stamps_ns", len(stamps))
        for i, (earlier, later) in enumerate(itertools.pairwise(stamps)):
            if later < earlier:
                before = (earlier - later) / NS_PER_S
                raise InvalidFieldError(
                    f"stamps_ns[{i + 1}]", f"{before:.9g} s before stamps_ns[{i}]", "ascending times"
                )
        object.__setattr__(self, "stamps_ns", stamps)


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class AtRate(Record):
    """Samples from the state on, at a steady rate.

    Attributes:
        rate: Hz, samples a second. None or zero: the default.
        duration: s, >= 0, how far to go. None: the default horizon.

    Raises:
        InvalidFieldError: a number is out of its range or not finite.
    """

    rate: float | None = None
    duration: float | None = None

    def __post_init__(self) -> None:
        """Check both numbers."""
        object.__setattr__(self, "rate", check_optional("rate", self.rate) or None)
        object.__setattr__(self, "duration", check_optional("duration", self.duration))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class UntilContact(AtRate):
    """Samples at a steady rate that end with the first contact of the body with a surface of the world."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class UntilPlane(AtRate):
    """Samples at a steady rate that end when a point of the body reaches a plane.

    Attributes:
        plane_point: (3,), m, a point of the plane, world.
        plane_normal: (3,), unit, its normal, world axes.
        body_point: (3,), m, the point of the body, in its published frame F.
        rate: Hz, samples a second. None or zero: the default.
        duration: s, >= 0, how far to go. None: the default horizon.

    Raises:
        InvalidFieldError: a number is out of its range or not finite, or the normal is not unit.
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
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check all five."""
        AtRate.__post_init__(self)
        object.__setattr__(self, "body_point", check_array("body_point", self.body_point, (3,)))
        object.__setattr__(self, "plane_point", check_array("plane_point", self.plane_point, (3,)))
        object.__setattr__(self, "plane_normal", check_unit("plane_normal", self.plane_normal, 3))


Sampling: TypeAlias = "AtTimes | AtStamps | AtRate"
"""When a trajectory is sampled; `UntilContact` and `UntilPlane` are kinds of `AtRate`."""


class EventKind(NamedInt):
    """What ends a trajectory; the numbers are those of the service."""

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
        surface: The name of the surface; empty for the plane of the question.
    """

    kind: EventKind
    seconds: float
    point_W: FloatArray
    velocity_W: FloatArray
    surface: str


def ascending(field: str, times: ArrayLike) -> FloatArray:
    """Return times, (n,), s, that ascend and are not too many.

    Raises:
        InvalidFieldError: a time is not finite, or before the one in front of it.
        TooLargeError: more than `MOST_SAMPLES` times.
    """
    listed = np.asarray(times)
    check_count(field, listed.size)
    checked = check_array(field, listed, (None,))
    steps = np.diff(checked)
    for i in np.flatnonzero(steps < 0.0)[:1]:
        raise InvalidFieldError(
            f"{field}[{i + 1}]", f"{-steps[i]:.9g} s before {field}[{i}]", "ascending times"
        )
    return checked


def check_count(field: str, count: float) -> None:
    """Refuse more than `MOST_SAMPLES` samples, with `TooLargeError`."""
    if count > MOST_SAMPLES:
        raise TooLargeError(field, f"{count:.9g} samples", f"at most {MOST_SAMPLES}")
