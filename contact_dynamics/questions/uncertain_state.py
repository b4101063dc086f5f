# SPDX-License-Identifier: Apache-2.0
"""States with covariances, in questions and published messages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, state_covariance
from contact_dynamics.validation import FloatArray
from contact_dynamics.validation_batches import check_covariance

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class UncertainState(Record):
    """State with a covariance.

    Attributes:
        state: The state.
        covariance: (12, 12), of position of the centre of mass (m), rotation vector (rad, world axes, a small
            rotation applied after the orientation), linear velocity (m/s) and angular velocity (rad/s), in
            this order.

    Raises:
        InvalidFieldError: the matrix is not a covariance (`check_covariance`).
    """

    state: BodyState
    covariance: FloatArray

    if TYPE_CHECKING:

        def __init__(self, *, state: BodyState, covariance: ArrayLike) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check the covariance."""
        object.__setattr__(self, "covariance", check_covariance("state.covariance", self.covariance))

    @property
    def stamp_ns(self) -> int:
        """Return the time of the state, ns."""
        return self.state.stamp_ns


KnownState: TypeAlias = "BodyState | UncertainState"  # a state, with its covariance if it is known


def with_deviations(known: KnownState, deviations: Sequence[float]) -> KnownState:
    """Return a state with its covariance, or else with one of given standard deviations.

    They are those of the position of the centre of mass (m), the orientation (rad), the linear velocity (m/s)
    and the angular velocity (rad/s), equal along all axes. Without any, the state is unchanged.
    """
    if not deviations or not isinstance(known, BodyState):
        return known
    position, rotation, velocity, angular_velocity = deviations
    covariance = state_covariance(
        position=position, rotation=rotation, velocity=velocity, angular_velocity=angular_velocity
    )
    return UncertainState(state=known, covariance=covariance)


def state_of(known: KnownState) -> BodyState:
    """Return the state without its covariance."""
    return known if isinstance(known, BodyState) else known.state
