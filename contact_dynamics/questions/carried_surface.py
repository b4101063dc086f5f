# SPDX-License-Identifier: Apache-2.0
"""Surfaces carried by bodies: a tray in a gripper, the floor of a vehicle, the palm of a hand.

A carried surface moves with a body whose states are published. A question is about one instant, at which the
surface has the pose, the velocities and the accelerations of that body.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import seconds_between
from contact_dynamics.errors import InvalidFieldError, NoStateError, StaleStateError
from contact_dynamics.motion.between_states import state_between
from contact_dynamics.questions.uncertain_state import UncertainState, state_of
from contact_dynamics.records import Record
from contact_dynamics.rotations.many import turned
from contact_dynamics.validation import check_not_negative
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.questions.state_store import StateStore
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World

ACCELERATION_WINDOW: Final = 0.05
"""Duration over which the accelerations of a carrying body are estimated by default, s."""

_LEAST_STATES: Final = 3
"""Number of states from which accelerations are estimated at least, over a longer time where necessary."""

_SLOWEST_S: Final = 1.0  # longest time that these may take, s


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class CarriedSurface(Record):
    """A plane that moves with a body.

    Between two published states of the body, its pose is interpolated. After the latest one, it is
    extrapolated with constant linear acceleration and angular velocity, for at most
    `Defaults.max_extrapolation`.

    Attributes:
        body_name: Name of the body.
        surface: The plane in the body's published frame F: its fields ``p_WS_W`` and ``normal_W`` are in F.
            It is at rest in F.
        acceleration_window: s, >= 0. The linear and angular accelerations of the body are the slopes of its
            velocities over this time, or over three states if that is longer, by least squares. With 0 s they
            are zero.

    Raises:
        InvalidFieldError: the surface moves in F, or the window is negative or not finite.
    """

    body_name: str
    surface: Surface
    acceleration_window: float = ACCELERATION_WINDOW

    def __post_init__(self) -> None:
        """Check the surface and the window."""
        if self.surface.moves:
            raise InvalidFieldError("surface", "one that moves", "at rest in the frame of its body")
        window = check_not_negative("acceleration_window", self.acceleration_window)
        object.__setattr__(self, "acceleration_window", window)


class CarrierNoise(NamedTuple):
    """The noise with which a plane is known that a body carries, if the body's states have covariances."""

    carrier: str
    plane: Surface  # at the instant of the question
    state: BodyState  # that of the carrier, for which the covariance is published
    covariance: FloatArray  # (12, 12), in the order of `UncertainState`


def with_carried(
    world: World,
    carried: Iterable[CarriedSurface],
    states: StateStore,
    *,
    stamp_ns: int | None,
    now_ns: int | None,
    max_extrapolation: float,
) -> tuple[World, tuple[str, ...], tuple[CarrierNoise, ...]]:
    """Return a world with carried surfaces at an instant, warnings about their motion, and their noise.

    The instant ``stamp_ns``, ns, is that of each body's latest state if it is None. The present time
    ``now_ns``, ns, is None without a clock. Motions are extrapolated by at most ``max_extrapolation``, s.

    Raises:
        NoStateError: a carrying body has no state at that time, or too few for its acceleration.
        StaleStateError: its latest state is too old.
    """
    planes: list[Surface] = []
    warnings: list[str] = []
    noise: list[CarrierNoise] = []
    for each in carried:
        name = each.body_name
        if stamp_ns is None:
            earlier, later = states.newest(name, now_ns=now_ns), None
        else:
            earlier, later = states.around(name, stamp_ns, now_ns=now_ns)
        instant_ns = earlier.stamp_ns if stamp_ns is None else stamp_ns
        ahead = seconds_between(earlier.stamp_ns, instant_ns)
        if later is None and ahead > max_extrapolation:
            raise StaleStateError(
                f"surface {each.surface.name!r}: the latest state of {name!r}, which carries it, must be at "
                f"most {max_extrapolation:g} s before the question's state (max_extrapolation), "
                f"got {ahead:.3f} s"
            )
        known = [state_of(state) for state in states.window(name, earlier, each.acceleration_window)]
        if len(known) < _LEAST_STATES and each.acceleration_window > 0.0:  # slowly published
            kept = states.window(name, earlier, _SLOWEST_S)[-_LEAST_STATES:]
            known = [state_of(state) for state in kept]
        known += [] if later is None else [state_of(later)]
        if len(known) < _LEAST_STATES and each.acceleration_window > 0.0:
            raise NoStateError(
                f"surface {each.surface.name!r}: at least {_LEAST_STATES} states of {name!r} are required to "
                f"estimate its acceleration, got {len(known)} (with an acceleration_window of 0, it is zero)"
            )
        planes.append(_plane_at(each, world.body(name), known, instant_ns))
        nearest = earlier if later is None else later
        if isinstance(nearest, UncertainState):
            noise.append(CarrierNoise(name, planes[-1], nearest.state, nearest.covariance))
        if later is None and ahead > 0.0:
            age = f"{1e3 * ahead:.3g} ms older than the question's state"
            warnings.append(f"surface {each.surface.name!r}: the latest state of {name!r} is {age}")
    return replace(world, surfaces=(*world.surfaces, *planes)), tuple(warnings), tuple(noise)


def _plane_at(carried: CarriedSurface, carrier: Body, states: Sequence[BodyState], stamp_ns: int) -> Surface:
    """Return a carried plane in the world at a time, ns.

    The last two of the carrier's states enclose the time, or the last one precedes it.
    """
    a_W, alpha_W = _accelerations(states)
    state = _state_at(states, stamp_ns, a_W)
    r_W = state.R_WB @ (carried.surface.p_WS_W - carrier.p_FB_F)
    w_W = state.w_WB_W
    turning = np.cross(w_W, r_W)
    return replace(
        carried.surface,
        p_WS_W=state.p_WB_W + r_W,
        normal_W=state.R_WB @ carried.surface.normal_W,
        v_WS_W=state.v_WB_W + turning,
        w_WS_W=w_W,
        a_WS_W=a_W + np.cross(alpha_W, r_W) + np.cross(w_W, turning),
        alpha_WS_W=alpha_W,
    )


def _accelerations(states: Sequence[BodyState]) -> tuple[FloatArray, FloatArray]:
    """Return linear and angular acceleration, (3,) each, m/s^2 and rad/s^2, as slopes of the velocities."""
    if len(states) < _LEAST_STATES:
        return np.zeros(3), np.zeros(3)
    times = np.array([seconds_between(states[-1].stamp_ns, state.stamp_ns) for state in states])
    velocities = np.array([[*state.v_WB_W, *state.w_WB_W] for state in states])
    centered = times - times.mean()
    slopes = centered @ velocities / (centered @ centered)
    return slopes[:3], slopes[3:]


def _state_at(states: Sequence[BodyState], stamp_ns: int, a_W: FloatArray) -> BodyState:
    """Return a body's state at a time, ns, between its last two states or after the last one."""
    last = states[-1]
    if stamp_ns == last.stamp_ns:
        return last
    if stamp_ns < last.stamp_ns:
        return state_between(states[-2], last, stamp_ns)
    t = seconds_between(last.stamp_ns, stamp_ns)
    return replace(
        last,
        p_WB_W=last.p_WB_W + t * last.v_WB_W + 0.5 * t * t * a_W,
        q_WB=turned(last.q_WB[None], t * last.w_WB_W[None])[0],
        v_WB_W=last.v_WB_W + t * a_W,
        stamp_ns=stamp_ns,
    )
