# SPDX-License-Identifier: Apache-2.0
"""The context that questions are answered with: the world, the published states, and defaults."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.records import Record
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, OUT_OF_PLANE_SPEED, VELOCITY_TOLERANCE
from contact_dynamics.validation import check_not_negative, check_positive
from contact_dynamics.world import World


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Defaults(Record):
    """Values for what a question leaves out.

    Attributes:
        velocity_tolerance: m/s, >= 0. A contact that is slower counts as at rest.
        distance_tolerance: m, >= 0. A body with a smaller gap to a surface touches it.
        out_of_plane_tolerance: m/s, >= 0. Motion out of a plane up to this still counts as planar.
        horizon: s, >= 0. How far ahead a first contact is sought, and how long a trajectory is.
        rate: Hz, > 0. Number of samples a second of a trajectory.

    Raises:
        InvalidFieldError: a number is out of its range or not finite.
    """

    velocity_tolerance: float = VELOCITY_TOLERANCE
    distance_tolerance: float = DISTANCE_TOLERANCE
    out_of_plane_tolerance: float = OUT_OF_PLANE_SPEED
    horizon: float = 2.0
    rate: float = 100.0

    def __post_init__(self) -> None:
        """Check all fields."""
        for name in ("velocity_tolerance", "distance_tolerance", "out_of_plane_tolerance", "horizon"):
            object.__setattr__(self, name, check_not_negative(name, getattr(self, name)))
        object.__setattr__(self, "rate", check_positive("rate", self.rate))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Context(Record):
    """What is known when a question is asked.

    Attributes:
        world: Bodies that questions can name, the surfaces they meet, and gravity.
        states: The states that were published, by body. A question about the newest one reads them here. By
            default there are none.
        defaults: Values for what a question leaves out.
        now_ns: A function that returns the present time, ns, on the clock of the states' stamps, so that an
            old state is refused. If it is None or returns None, there is no clock yet, and the newest state
            counts as fresh.
    """

    world: World = field(default_factory=World)
    states: StateStore = field(default_factory=lambda: StateStore(history=5.0, timeout=0.5))
    defaults: Defaults = field(default_factory=Defaults)
    now_ns: Callable[[], int | None] | None = None

    def __post_init__(self) -> None:
        """Leave the fields as they are, now that `Record` has checked their types."""


def or_default(asked: float | None, default: float) -> float:
    """Return the value of a question's field, or the default if the field is None."""
    return default if asked is None else asked


def check_optional(field_name: str, value: float | None) -> float | None:
    """Return a number >= 0 as a float, or None for None. Refuse anything else.

    Raises:
        InvalidFieldError: the number is negative or not finite.
    """
    return None if value is None else check_not_negative(field_name, value)
