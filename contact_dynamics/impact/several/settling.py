"""Jammed contacts go through jamming impacts until some contact mode is consistent.

After one jamming impact (`jamming`) contacts may slide on in another direction, and jam again. Each impact
takes energy, so this ends. In hundreds of drawn sets it ended after at most three.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.impact.several.result import SeveralVerdict
from contact_dynamics.tolerances import VELOCITY_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.impact.several.result import SeveralImpact
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

MOST_JAMS: Final = 10
"""Jamming impacts after which the case counts as not settled."""


def settling_impact(
    body: MassProperties,
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
    """Return the impact of jammed contacts after which ``is_settled`` holds of the state, as one.

    Its impulses are the sums over the impacts. Its verdict is NOT_CONVERGED where it does not come to that.

    Args:
        body: As for `jamming_impact`.
        state: As for `jamming_impact`.
        contacts: As for `jamming_impact`.
        is_settled: Whether some mode of a state is consistent, or a contact approaches.
        force_W: As for `jamming_impact`.
        torque_W: As for `jamming_impact`.
        plane_normal_W: As for `jamming_impact`.
        friction_facets: As for `jamming_impact`.
        velocity_tolerance: As for `jamming_impact`.

    Raises:
        InvalidFieldError: as `jamming_impact`.
        TooLargeError: as `jamming_impact`.
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
    for _ in range(MOST_JAMS - 1):
        if total.verdict != SeveralVerdict.RESOLVED or is_settled(total.state):
            return total
        again = jam(total.state)
        total = replace(
            again,
            impulses_W=total.impulses_W + again.impulses_W,
            velocities_before_W=total.velocities_before_W,
        )
    if is_settled(total.state):
        return total
    return replace(total, verdict=SeveralVerdict.NOT_CONVERGED)
