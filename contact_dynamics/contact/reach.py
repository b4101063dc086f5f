# SPDX-License-Identifier: Apache-2.0
"""Warns of contacts that are farther from a body than its shape reaches.

Mostly the state is of another time than the contacts: that of the throw with those of the landing.
"""

from __future__ import annotations

import math
import warnings
from functools import lru_cache
from typing import TYPE_CHECKING

from contact_dynamics.errors import FarContactWarning, frames_to_caller
from contact_dynamics.tolerances import FAR_CONTACT
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.validation import FloatArray


def warn_if_far(body: HasMassProperties, state: BodyState, points_W: FloatArray) -> None:
    """Warn of contact points, (3,) or (n, 3), m, world axes, out of reach of a `Body` that has a shape."""
    if not isinstance(body, Body) or body.shape.is_empty:
        return
    reach = _reach(body.shape)
    numbers = iter((points_W - state.p_WB_W).ravel().tolist())
    far = max((math.hypot(*arm) for arm in zip(numbers, numbers, numbers, strict=True)), default=0.0)
    if far > (1.0 + FAR_CONTACT) * reach:
        message = (
            f"a contact is {far:.4g} m from the centre of mass of {body.name!r}, whose shape reaches "
            f"{reach:.4g} m: state and contact must be of one time, as landing.state and landing.contacts"
        )
        warnings.warn(message, FarContactWarning, stacklevel=frames_to_caller())


@lru_cache(maxsize=64)
def _reach(shape: ConvexShape) -> float:
    """Return the largest distance of a shape's points from the centre of mass, m."""
    corners = [math.hypot(*corner) for corner in shape.vertices.tolist()]
    rims = [math.hypot(*rim.center) + rim.radius for rim in shape.rims]
    return max([*corners, *rims]) + shape.rounding
