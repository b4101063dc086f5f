# SPDX-License-Identifier: Apache-2.0
"""Limits the numbers of a question about contacts, so that their sums and products do not overflow."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MAX_IN_CONTACT: Final = 1e15
"""Largest allowed number, in m, m/s, rad/s, N or N m. Larger ones are rounded to more than 1 of them."""

MAX_FRICTION: Final = 1e10
"""Largest coefficient of friction. To the last digit, contacts with a larger one never slide."""

MAX_INERTIA: Final = 1e30
"""Largest allowed mass and moment of inertia, in kg and kg m^2. The smallest is its inverse."""


MAX_PUBLISHED_DISTANCE: Final = 1e12
"""m from the world's origin, almost seven times the distance to the Sun. Doubles resolve 0.1 mm there."""

MAX_PUBLISHED_SPEED: Final = 1e5  # m/s, ten times the escape velocity of the Earth
MAX_PUBLISHED_SPIN: Final = 1e6  # rad/s, ten times the fastest turbines


def check_believable(state: BodyState) -> None:
    """Reject a published state that is faulty since it is too far away or too fast, and name the field.

    The limits are `MAX_PUBLISHED_DISTANCE`, `MAX_PUBLISHED_SPEED` and `MAX_PUBLISHED_SPIN`.
    """
    for name, vector, most, unit in (
        ("p_WB_W", state.p_WB_W, MAX_PUBLISHED_DISTANCE, "m"),
        ("v_WB_W", state.v_WB_W, MAX_PUBLISHED_SPEED, "m/s"),
        ("w_WB_W", state.w_WB_W, MAX_PUBLISHED_SPIN, "rad/s"),
    ):
        size = math.hypot(*vector.tolist())
        if size > most:
            raise InvalidFieldError(name, f"{size:g} {unit}", f"at most {most:g} {unit} in a published state")


def check_extent(body: MassProperties, state: BodyState) -> None:
    """Reject a body or a state with a number that is too large for contact mechanics, and name it.

    The limits are `MAX_IN_CONTACT`, and `MAX_INERTIA` for a mass or moment.
    """
    for name, vector in (("p_WB_W", state.p_WB_W), ("v_WB_W", state.v_WB_W), ("w_WB_W", state.w_WB_W)):
        check_vector(name, vector)
    check_mass(body)


def check_mass(body: MassProperties) -> None:
    """Reject a mass or a moment of inertia that is too large or too small, and name it."""
    moments = body.I_B.diagonal().tolist()
    for name, value in (("mass", body.mass), *(("I_B", moment) for moment in moments)):
        if not 1.0 / MAX_INERTIA <= value <= MAX_INERTIA:
            allowed = f"in [{1.0 / MAX_INERTIA:g}, {MAX_INERTIA:g}] for contacts"
            raise InvalidFieldError(name, f"{value:g}", allowed)


def check_place(name: str, points: FloatArray) -> None:
    """Reject a point or points, in m, that are too far away, with their name."""
    largest = max(map(abs, points.ravel().tolist()), default=0.0)
    if not largest <= MAX_IN_CONTACT:
        raise InvalidFieldError(name, f"{largest:g} m", f"at most {MAX_IN_CONTACT:g} m")


def check_friction(name: str, friction: float) -> None:
    """Reject a coefficient of friction that is too large, with its name."""
    if friction > MAX_FRICTION:
        raise InvalidFieldError(name, f"{friction:g}", f"at most {MAX_FRICTION:g}")


def check_contacts(contacts: ContactSet) -> None:
    """Reject contacts that are too far away, or whose surfaces move too fast, and name the first."""
    check_place("contacts.p_WC_W", contacts.p_WC_W)
    for name in contacts.SURFACE_MOTION if contacts.surfaces_move else ():
        if (motion := getattr(contacts, name)) is not None:
            check_vector(f"contacts.{name}", motion.ravel())
    check_friction("contacts.frictions", max(contacts.frictions.tolist(), default=0.0))
    if contacts.static_frictions is not None:
        check_friction("contacts.static_frictions", max(contacts.static_frictions.tolist(), default=0.0))


def check_margin_length(length: float | None) -> None:
    """Reject a length by which torques cannot be divided."""
    if length is not None and not 1.0 / MAX_IN_CONTACT <= length <= MAX_IN_CONTACT:
        allowed = f"in [{1.0 / MAX_IN_CONTACT:g}, {MAX_IN_CONTACT:g}]"
        raise InvalidFieldError("margin_length", f"{length:g}", allowed)


def check_wrench(force_W: FloatArray, torque_W: FloatArray) -> None:
    """Reject a force or a torque, (3,), that is too large, and name it."""
    check_vector("force_W", force_W)
    check_vector("torque_W", torque_W)


def check_vector(name: str, vector: FloatArray) -> None:
    """Reject a vector, (n,), with a number that is too large, with its name."""
    largest = max(map(abs, vector.tolist()))
    if not largest <= MAX_IN_CONTACT:
        raise InvalidFieldError(name, f"{largest:g}", f"at most {MAX_IN_CONTACT:g} for contacts")


def leave_out_numpy_warnings() -> None:
    """Disable NumPy's warnings in this thread."""
    np.seterr(all="ignore")
