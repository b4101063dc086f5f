# SPDX-License-Identifier: Apache-2.0
"""Jammed contacts go through jamming impacts until some contact mode is consistent.

After one jamming impact (`jamming`), contacts may slide on in another direction and jam again. Each impact
takes energy, so this ends. In hundreds of drawn sets it ended after at most three impacts.

`settling_impact` states the arguments of `jamming_impact` again, because it hands them on and callers should
see their types. The physics stands in `jamming` alone.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.impact.several.result import SeveralVerdict
from contact_dynamics.tolerances import VELOCITY_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.several.result import SeveralImpact
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
    from contact_dynamics.validation import FloatArray

MAX_JAMS: Final = 10
"""Jamming impacts after which the case counts as not settled."""


def settling_impact(
    body: HasMassProperties,
    state: BodyState,
    contacts: ContactSet,
    *,
    is_settled: Callable[[BodyState], bool],
    force_W: ArrayLike,
    torque_W: ArrayLike = (0.0, 0.0, 0.0),
    plane_normal_W: FloatArray | None = None,
    friction_facets: int = 8,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> SeveralImpact:
    """Return one impact that combines all jamming impacts until ``is_settled`` is true for the state.

    Its impulses are the sums over the impacts. The verdict is NOT_CONVERGED if the contacts are not settled
    after `MAX_JAMS` impacts. The arguments are those of `jamming_impact`, except ``is_settled``.

    Args:
        body: A `Body`, or its `MassProperties`.
        state: Pose and velocities just before the impact.
        contacts: All touching contacts; at least one.
        is_settled: Function of a state that returns whether a contact mode is consistent, or a contact
            approaches.
        force_W: (3,), N, applied force, including gravity but not contact forces, world axes.
        torque_W: (3,), N m, applied torque about the centre of mass, world axes.
        plane_normal_W: (3,), unit normal of a plane of motion, or None in space.
        friction_facets: Number of directions of friction in space, >= 3.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of a contact's velocity up to it count
            as zero.

    Raises:
        InvalidFieldError: there are no contacts, or `jamming_impact` rejects a number.
        TooLargeError: there are more than `MAX_JAMMED_CONTACTS` contacts.
    """
    jam = partial(
        jamming_impact,
        body,
        contacts=contacts,
        force_W=force_W,
        torque_W=torque_W,
        plane_normal_W=plane_normal_W,
        friction_facets=friction_facets,
        velocity_tolerance=velocity_tolerance,
    )
    total = jam(state)
    for _ in range(MAX_JAMS - 1):
        if total.verdict != SeveralVerdict.RESOLVED or is_settled(total.state):
            return total
        again = jam(total.state)
        changes = np.abs(again.velocities_after_W - again.velocities_before_W)
        if changes.max() <= velocity_tolerance:  # every further impact would leave the same state
            return replace(total, verdict=SeveralVerdict.NOT_CONVERGED)
        total = replace(
            again,
            impulses_W=total.impulses_W + again.impulses_W,
            velocities_before_W=total.velocities_before_W,
        )
    if is_settled(total.state):
        return total
    return replace(total, verdict=SeveralVerdict.NOT_CONVERGED)
