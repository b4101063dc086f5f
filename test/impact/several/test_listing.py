# SPDX-License-Identifier: Apache-2.0
"""No answer about several contacts depends on the order in which contacts are listed, but where it says so.

The bounds over interleavings are held in `test_interleavings.py`, and ties in `test_tied.py`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, World
from contact_dynamics.impact import (
    RestitutionLaw,
    SeveralContactsLaw,
    bodies_impact,
    impact_sequence,
    jamming_impact,
    outcomes_over_orders,
    several_impact,
)

Landing = tuple[MassProperties, BodyState, ContactSet]


def landing(seed: int) -> Landing:
    """Draw a tilted box that lands on three corners, each with a friction and a restitution of its own."""
    rng = np.random.default_rng(seed)
    turn = rng.normal(size=4) * [0.05, 0.05, 0.05, 0.0] + [0.0, 0.0, 0.0, 1.0]
    return (
        MassProperties(mass=1.0, I_B=np.diag([0.02, 0.03, 0.04])),
        BodyState(
            p_WB_W=np.zeros(3),
            q_WB=turn / np.linalg.norm(turn),
            v_WB_W=rng.normal(size=3) - [0.0, 0.0, 2.0],
            w_WB_W=rng.normal(size=3),
        ),
        ContactSet(
            p_WC_W=[[0.2, 0.15, -0.1], [-0.2, 0.14, -0.11], [0.1, -0.16, -0.09]],
            normals_W=[0.0, 0.0, 1.0],
            frictions=rng.uniform(0.1, 0.8, size=3),
            restitutions=rng.uniform(0.1, 0.7, size=3),
        ),
    )


def velocity(state: BodyState) -> np.ndarray:
    return np.concatenate([state.v_WB_W, state.w_WB_W])


def rows(outcomes: np.ndarray) -> np.ndarray:
    """Return rows in an order of their own, so that sets can be compared."""
    return outcomes[np.lexsort(np.round(outcomes, 6).T)]


def slid(body: MassProperties, state: BodyState, contacts: ContactSet) -> dict[str, object]:
    """Return a sliding body whose contacts do not approach, under its weight."""
    return {
        "body": body,
        "state": BodyState(p_WB_W=state.p_WB_W, q_WB=state.q_WB, v_WB_W=[-1.0, 0.1, 0.0]),
        "contacts": contacts,
        "force_W": [0.0, 0.0, -9.8],
    }


SIMULTANEOUS = SeveralContactsLaw.SIMULTANEOUS
WAYS: dict[str, Callable[[MassProperties, BodyState, ContactSet], np.ndarray]] = {
    **{
        f"in turn, {law.name}": lambda b, s, c, law=law: velocity(
            several_impact(b, s, c, restitution_law=law).state
        )
        for law in RestitutionLaw
    },
    "at once": lambda b, s, c: velocity(several_impact(b, s, c, several_contacts_law=SIMULTANEOUS).state),
    "of bodies": lambda b, s, c: velocity(bodies_impact([b], [s], c, [(0, None)] * len(c)).states[0]),
    "of bodies at once": lambda b, s, c: velocity(
        bodies_impact([b], [s], c, [(0, None)] * len(c), several_contacts_law=SIMULTANEOUS).states[0]
    ),
    "all orders": lambda b, s, c: rows(outcomes_over_orders(b, s, c).velocities_W),
    "jamming": lambda b, s, c: velocity(jamming_impact(**slid(b, s, c)).state),  # type: ignore[arg-type]
    "settling": lambda b, s, c: velocity(
        jamming_impact(**slid(b, s, c), is_settled=lambda _: True).state  # type: ignore[arg-type]
    ),
    "in time": lambda b, s, c: velocity(
        impact_sequence(Body(name="box", mass_properties=b), s, World(), contacts=c).state
    ),
}


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("seed", [0, 1])
def test_the_list_does_not_matter(way: str, seed: int) -> None:
    body, state, contacts = landing(seed)
    answer = WAYS[way](body, state, contacts)
    for order in ([2, 0, 1], [1, 0, 2]):
        again = WAYS[way](body, state, contacts.subset(order))
        assert again.shape == answer.shape
        # Sums in another order, and iterations that end within 1e-8 of their solution.
        assert again == pytest.approx(answer, abs=1e-6)
