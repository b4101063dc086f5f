"""A question or a published message may give a state with its covariance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray
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
        InvalidFieldError: the matrix is not a covariance (`check_covariance`).
    """

    state: BodyState
    covariance: FloatArray

    if TYPE_CHECKING:

        def __init__(self, *, state: BodyState, covariance: ArrayLike) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check the covariance."""
        object.__setattr__(self, "covariance", check_covariance("state.covariance", self.covariance))

    @property
    def stamp_ns(self) -> int:
        """Time of the state, ns."""
        return self.state.stamp_ns


KnownState: TypeAlias = "BodyState | UncertainState"
"""A state, with its covariance where that is known."""


def state_of(known: KnownState) -> BodyState:
    """Return the state without its covariance."""
    return known if isinstance(known, BodyState) else known.state
