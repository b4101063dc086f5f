"""What a question is about: a body in a state, as the question says or as it was published."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray, check_not_negative
from contact_dynamics.validation_batches import check_covariance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class UncertainState(Record):
    """A state and how uncertain it is.

    Attributes:
        state: The state.
        covariance: (12, 12), in the order position of the centre of mass (m), rotation vector (rad, world
            axes, a small rotation applied after the orientation), linear velocity (m/s), angular velocity
            (rad/s).

    Raises:
        InvalidFieldError: the covariance is none (`check_covariance`).
    """

    state: BodyState
    covariance: FloatArray

    if TYPE_CHECKING:

        def __init__(self, *, state: BodyState, covariance: ArrayLike) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check the covariance."""
        object.__setattr__(self, "covariance", check_covariance("state.covariance", self.covariance))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PublishedState(Record):
    """The state of a body that was published, or a fit to several.

    Attributes:
        stamp_ns: ns. The newest state with at most this stamp is taken. None: the newest of all.
        fit_window: s, >= 0. The motion is fitted to the states of this last time. Zero: one is taken as it
            is.

    Raises:
        InvalidFieldError: the window is negative or not finite.
    """

    stamp_ns: int | None = None
    fit_window: float = 0.0

    def __post_init__(self) -> None:
        """Check the window."""
        object.__setattr__(self, "fit_window", check_not_negative("fit_window", self.fit_window))


NEWEST: Final = PublishedState()
"""The newest published state."""

StateSource: TypeAlias = "BodyState | UncertainState | PublishedState"
"""Where a question takes a body's state from: it says the state itself, or names a published one."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class FitQuality(Record):
    """How well the motion fits the published states that a state was found from.

    Attributes:
        count: How many states were fitted.
        position_residual: m, root mean square distance of the positions.
        orientation_residual: rad, root mean square angle between the orientations.
    """

    count: int
    position_residual: float
    orientation_residual: float
