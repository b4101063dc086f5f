# SPDX-License-Identifier: Apache-2.0
"""A toss from its initial state to rest: free flights, strikes and contact phases.

A flight ends at the first contact, which is computed to rounding (`flight`). Strikes follow Routh's impact
law (`strike`). A body in sustained contact moves in a contact mode (`mode_choice`), which is integrated until
it ends (`phase`). The body rests when its kinetic energy is so low that it could rise or slide by at most
`SETTLING_HEIGHT`, and friction and contacts hold it in place.

If mechanics does not determine the motion (several modes, or contacts that strike at one instant), the toss
follows one branch and lists the branch point. Other branches are followed as separate tosses, up to
``max_alternatives``.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import HORIZON
from contact_dynamics.contact.found import check_not_inside
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.result import SeveralContactsLaw
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, LARGEST_NUMBER, LEAST_PHASE_ERROR, PHASE_ERROR
from contact_dynamics.toss.distinct_corners import with_distinct_corners
from contact_dynamics.toss.impacts import check_laws
from contact_dynamics.toss.result import carried_by
from contact_dynamics.toss.simulation import Simulation, TossSettings
from contact_dynamics.toss.solid import numbers_of, solid_of
from contact_dynamics.toss.uncertainty import check_factors
from contact_dynamics.tumbling.motion import check_extent
from contact_dynamics.validation import check_positive, check_whole, check_within

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.toss.result import Toss
    from contact_dynamics.world import Body, World

MAX_EVENTS: Final = 10_000
"""Largest number of events of a toss. A toss of a box has ten to fifty, and one of a smooth body among four
planes has thousands."""


def toss(
    body: Body,
    state: BodyState,
    world: World,
    *,
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON,
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL,
    horizon: float = HORIZON,
    max_events: int = MAX_EVENTS,
    max_alternatives: int = 0,
    error: float = PHASE_ERROR,
    lasting_factors: ArrayLike = (),
    distance_tolerance: float = DISTANCE_TOLERANCE,
) -> Toss:
    """Return the motion of a body from an initial state, in flight or in contact, until it rests.

    docs/toss.md describes the methods and their errors. `sampled_toss` accepts uncertain inputs.

    Args:
        body: Mass properties and shape: corners, which may be rounded.
        state: Initial pose and velocities.
        world: Surfaces, which must be planes, and gravity. Surfaces may move if all have the same velocity
            and acceleration and none rotates. The body then comes to rest relative to them.
        restitution_law: Law of restitution. ENERGETIC requires SEQUENTIAL.
        several_contacts_law: Law for several simultaneous impacts.
        horizon: s, > 0. Duration of the longest motion that is followed.
        max_events: Largest number of events, >= 1.
        max_alternatives: Largest number of other branches to follow where mechanics does not determine the
            motion, >= 0. Each takes about as long as the toss itself. The branch points are listed in any
            case (`undecided`).
        error: m, m/s, at least `LEAST_PHASE_ERROR`. Largest error of one step of a contact phase. Angles are
            multiplied by the reach of the body (m).
        lasting_factors: (s,), >= 0, friction of sustained contact with each surface, relative to that of
            impacts. If it is empty, the factors of the surfaces are used.
        distance_tolerance: m, >= 0. Largest initial penetration of a surface; 1e-6 m is always accepted.

    Raises:
        NoContactError: the body has no shape that could touch anything.
        NotSupportedError: the shape has circular rims, a surface is an obstacle, or surfaces move differently
            or rotate.
        InvalidFieldError: a number is out of range, ENERGETIC and SIMULTANEOUS are combined, or the body
            penetrates a surface by more than the tolerance.
        TooLargeError: the search for the end of a flight takes too many steps.

    Examples:
        >>> import contact_dynamics as cd
        >>> brick = cd.Body.box((0.15, 0.09, 0.05), mass=0.4)
        >>> floor = cd.Surface(
        ...     name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.4
        ... )
        >>> thrown = cd.BodyState(
        ...     p_WB_W=[0, 0, 1], q_WB=[0, 0, 0, 1], v_WB_W=[1.5, 0, 2], w_WB_W=[0.5, 9, 0.3]
        ... )
        >>> toss = cd.toss(brick, thrown, cd.World(surfaces=(floor,)))
        >>> print(toss.end.name, f"after {toss.seconds:.2f} s, {toss.face_on_top} on top")
        RESTS after 1.19 s, -z on top
    """
    check_laws(restitution_law, several_contacts_law)
    factors = check_factors("lasting_factors", lasting_factors)
    check_extent(state, world.gravity_W)
    world, frame = world.seen_from_surfaces("toss")
    state = state if frame is None else frame.seen(state)
    check_not_inside(body, state, world.surfaces, distance_tolerance=distance_tolerance)
    body, indices = with_distinct_corners(body)
    solid = solid_of(body, world, indices=indices, lasting_factors=factors)
    settings = TossSettings(
        solid,
        restitution_law,
        several_contacts_law=several_contacts_law,
        horizon=check_positive("horizon", horizon),
        max_events=check_whole("max_events", max_events, 1),
        error=check_within("error", error, LEAST_PHASE_ERROR, LARGEST_NUMBER),
    )
    most = check_whole("max_alternatives", max_alternatives, 0)
    y, began_ns = numbers_of(state), state.stamp_ns
    main = Simulation(settings, y, (), began_ns)
    end = main.to_end()
    waiting = deque(_other_ways(main, 0))
    others: list[Toss] = []
    while waiting and len(others) < most:
        ways = waiting.popleft()
        other = Simulation(settings, y, ways, began_ns)
        others.append(other.as_toss(other.to_end(), restitution_law))
        waiting.extend(_other_ways(other, len(ways)))
    return carried_by(main.as_toss(end, restitution_law, tuple(others), not waiting), frame)


def _other_ways(one: Simulation, decided: int) -> list[tuple[int, ...]]:
    """Return the branches that leave a toss at one of its branch points after the first ``decided`` ones."""
    taken = tuple(point.taken for point in one.undecided)
    return [
        (*taken[:k], other)
        for k in range(decided, len(taken))
        for other in range(1, one.undecided[k].options)
    ]
