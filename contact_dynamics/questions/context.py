# SPDX-License-Identifier: Apache-2.0
"""The context that questions are answered with, and the choice between plane and space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from contact_dynamics.errors import InvalidFieldError, NotSupportedError
from contact_dynamics.questions.carried_surface import CarriedSurface, CarrierNoise
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.records import NamedInt, Record
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, OUT_OF_PLANE_SPEED, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative, check_positive
from contact_dynamics.world import Surface, World


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Defaults(Record):
    """Values for fields that a question leaves out.

    Attributes:
        velocity_tolerance: m/s, >= 0. Speed below which a contact counts as at rest.
        distance_tolerance: m, >= 0. Gap to a surface below which a body counts as touching.
        out_of_plane_tolerance: m/s, >= 0. Largest motion out of a plane that counts as planar.
        horizon: s, >= 0. Look-ahead time for a first contact, and duration of a trajectory.
        max_extrapolation: s, >= 0. Longest time by which the motion of a carried surface is extrapolated.
        rate: Sample rate of a trajectory, Hz, > 0.

    Raises:
        InvalidFieldError: a number is out of range or not finite.
    """

    velocity_tolerance: float = VELOCITY_TOLERANCE
    distance_tolerance: float = DISTANCE_TOLERANCE
    out_of_plane_tolerance: float = OUT_OF_PLANE_SPEED
    horizon: float = 2.0
    max_extrapolation: float = 0.1
    rate: float = 100.0

    def __post_init__(self) -> None:
        """Check all fields."""
        for name in (
            "velocity_tolerance",
            "distance_tolerance",
            "out_of_plane_tolerance",
            "horizon",
            "max_extrapolation",
        ):
            object.__setattr__(self, name, check_not_negative(name, getattr(self, name)))
        object.__setattr__(self, "rate", check_positive("rate", self.rate))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Context(Record):
    """World, published states and defaults with which questions are answered.

    Attributes:
        world: Bodies to which questions can refer by name, surfaces, and gravity. Surfaces may move if their
            motion is steady (`Surface.is_steady`), since questions are about states at different times.
        states: Published states, by body, for questions about the latest state. By default there are none.
        defaults: Values for fields that a question leaves out.
        now_ns: Function that returns the present time, ns, on the clock of the states' stamps, so that old
            states are rejected. If it is None or returns None, there is no clock, and the latest state is
            accepted at any age.
        carried: Further surfaces, which move with bodies of the world.
        notes: Warnings about carried surfaces in the context of one question, whose world contains them
            (`at_instant`), and None otherwise.
        carrier_noise: Noise with which the bodies that carry them are known, in the same context.

    Raises:
        NotSupportedError: the motion of a surface of the world is not steady.
        UnknownBodyError: the world has no body of a name in ``carried``.
    """

    world: World = field(default_factory=World)
    states: StateStore = field(default_factory=lambda: StateStore(history=5.0, timeout=0.5))
    defaults: Defaults = field(default_factory=Defaults)
    now_ns: Callable[[], int | None] | None = None
    carried: tuple[CarriedSurface, ...] = ()
    notes: tuple[str, ...] | None = None
    carrier_noise: tuple[CarrierNoise, ...] = ()

    def __post_init__(self) -> None:
        """Reject surfaces whose poses or velocities depend on the time, unless it is for one question."""
        for carried in self.carried:
            self.world.body(carried.body_name)
        for surface in self.world.surfaces if self.notes is None else ():
            if isinstance(surface, Surface) and not surface.is_steady:
                raise NotSupportedError(
                    "world must have surfaces that are at rest or move steadily in their own plane in "
                    f"questions, such as belts and turntables (others can be `carried`), got {surface.name!r}"
                )


class Problem(NamedInt):
    """Whether a contact question is solved as planar or spatial. Messages have the same numbers."""

    AUTOMATIC = 0
    """The server chooses, and the answer contains the choice. It solves impacts as spatial."""
    PLANAR = 1
    """The question is solved in a plane of motion through the centre of mass. A motion or load out of the
    plane is rejected."""
    SPATIAL = 2


def or_default(asked: float | None, default: float) -> float:
    """Return the value of a question's field, or the default if the field is None."""
    return default if asked is None else asked


def check_read(condition: str, *, is_met: bool, **values: object) -> None:
    """Raise `InvalidFieldError` for a value that is not None, unless the condition for reading it is met."""
    for name, value in values.items():
        if value is not None and not is_met:
            raise InvalidFieldError(name, value, f"left out unless {condition}")


def check_optional(field_name: str, value: float | None) -> float | None:
    """Return a number >= 0 as a float, or None for None; otherwise, raise `InvalidFieldError`."""
    return None if value is None else check_not_negative(field_name, value)
