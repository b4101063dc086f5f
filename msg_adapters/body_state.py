# SPDX-License-Identifier: Apache-2.0
"""Converts `contact_dynamics_interfaces/BodyState` to a body's state and back.

The message has the pose of the published frame and the velocity of the centre of mass, both in world axes.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.uncertain_state import KnownState, UncertainState
from contact_dynamics.records import made
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rigid_body.published_frame import origin_of_published_frame, turned
from contact_dynamics.tolerances import LENGTH_ROUNDING
from contact_dynamics.validation import check_unit
from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg
from msg_adapters.field_names import renamed
from msg_adapters.rejected_fields import values_of
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg
from msg_adapters.transforms import check_frame

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import World

_COVARIANCE_LENGTH: Final = 144

_FIELDS: Final = {
    "p_WB_W": "pose.position",
    "q_WB": "pose.orientation",
    "v_WB_W": "linear_velocity",
    "w_WB_W": "angular_velocity",
}


def body_state_from_msg(
    msg: BodyStateMsg, *, world_frame: str, p_FB_F: FloatArray, field: str = "state"
) -> BodyState:
    """Return the state of the body whose centre of mass is at ``p_FB_F``, (3,), m, in its published frame.

    Errors call the message ``field``. Raise `FrameMismatchError` if `header.frame_id` is neither empty nor
    the world frame, and `InvalidFieldError` if a number is not finite, or the quaternion is not unit.
    """
    check_frame(f"{field}.header.frame_id", msg.header.frame_id or world_frame, world_frame)
    kind: type = type(msg)
    numbers, stamp_ns = np.array(_reader(kind)(msg)[:13]), stamp_ns_from_msg(msg.header.stamp)
    p_WB_W, q_WB, v_WB_W, w_WB_W = numbers[:3], numbers[3:7], numbers[7:10], numbers[10:]
    x, y, z, w = q_WB.tolist()
    if not any((x, y, z, w)):  # left out by a client whose messages begin with zeros
        raise InvalidFieldError(
            f"{field}.pose.orientation", "zeros", "a unit quaternion (w: 1 is no rotation)"
        )
    if any(p_FB_F.tolist()):
        q_WB = check_unit(f"{field}.pose.orientation", q_WB, 4)
        p_WB_W += turned(q_WB, p_FB_F)
    is_unit = abs(math.sqrt(x * x + y * y + z * z + w * w) - 1.0) <= LENGTH_ROUNDING
    if is_unit and math.isfinite(sum(numbers.tolist())):  # the constructor would check it in vain
        numbers.flags.writeable = False
        return made(BodyState, numbers[:3], numbers[3:7], numbers[7:10], numbers[10:], stamp_ns)
    try:
        return BodyState(p_WB_W=p_WB_W, q_WB=q_WB, v_WB_W=v_WB_W, w_WB_W=w_WB_W, stamp_ns=stamp_ns)
    except InvalidFieldError as error:
        raise renamed(error, {ours: f"{field}.{name}" for ours, name in _FIELDS.items()}) from None


@lru_cache
def _reader(message: type) -> Callable[[object], tuple[float, ...]]:
    """Return a function that reads the numbers of a state."""
    xyz = {"p_WB_W": "xyz", "q_WB": "xyzw", "v_WB_W": "xyz", "w_WB_W": "xyz"}
    return values_of(message, [f"{field}.{x}" for name, field in _FIELDS.items() for x in xyz[name]])


def body_state_to_msg(
    state: BodyState,
    *,
    body_name: str,
    world_frame: str,
    p_FB_F: FloatArray,
    into: BodyStateMsg | None = None,
) -> BodyStateMsg:
    """Return the state as a message, which is new unless one to fill is given."""
    msg = BodyStateMsg() if into is None else into
    stamp_to_msg(state.stamp_ns, into=msg.header.stamp)
    msg.header.frame_id = world_frame
    msg.body_name = body_name
    # A message costs more to build than to fill, so what it has already is filled.
    at, turn, v, w = msg.pose.position, msg.pose.orientation, msg.linear_velocity, msg.angular_velocity
    at.x, at.y, at.z = origin_of_published_frame(state, p_FB_F).tolist()
    turn.x, turn.y, turn.z, turn.w = state.q_WB.tolist()
    v.x, v.y, v.z = state.v_WB_W.tolist()
    w.x, w.y, w.z = state.w_WB_W.tolist()
    return msg


def center_of_mass(body_name: str, world: World) -> FloatArray:
    """Return a body's centre of mass in its published frame, (3,), m, which messages do not contain.

    For a body that is not in the world, it is the origin of that frame.
    """
    known = (body.p_FB_F for body in world.bodies if body.name == body_name)
    return next(known, np.zeros(3))


def known_state_from_msg(
    msg: BodyStateMsg, *, world_frame: str, p_FB_F: FloatArray, field: str = "state"
) -> KnownState:
    """Return the state, with its covariance if the message has one.

    The errors are those of `body_state_from_msg` and `UncertainState`, and `InvalidFieldError` for a
    covariance of another length than 144.
    """
    state = body_state_from_msg(msg, world_frame=world_frame, p_FB_F=p_FB_F, field=field)
    if len(msg.covariance) == 0:
        return state
    if len(msg.covariance) != _COVARIANCE_LENGTH:
        raise InvalidFieldError(
            f"{field}.covariance", f"{len(msg.covariance)} numbers", f"none or {_COVARIANCE_LENGTH}"
        )
    return UncertainState(state=state, covariance=np.array(msg.covariance).reshape(12, 12))
