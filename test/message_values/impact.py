# SPDX-License-Identifier: Apache-2.0
"""Random answers about impacts, and their parts."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.constants import ns_after
from contact_dynamics.impact import (
    ImpactOutcome,
    PathEvent,
    ResolvedImpact,
    RestitutionLaw,
    SequenceEnd,
    SequenceStrike,
    SeveralContactsLaw,
)
from contact_dynamics.questions import ImpactAnswer, NamedState, Problem
from message_values.shared import (
    NAMES,
    NO_OFFSET,
    arrays,
    contact_sets,
    fits,
    flags,
    indices,
    odd_numbers,
    planes,
    positive,
    some,
    states,
    tuples_of,
    warnings,
)


@st.composite
def strikes_in_time(draw: st.DrawFn, last_ns: int) -> tuple[SequenceStrike, ...]:
    """One to three strikes, the last of them at that stamp."""
    seconds = sorted(draw(st.lists(st.floats(0.0, 0.05), min_size=1, max_size=3)))
    strikes = []
    for each in seconds:
        stamp_ns = ns_after(last_ns, each - seconds[-1])
        before = dataclasses.replace(draw(states), stamp_ns=stamp_ns)
        after = dataclasses.replace(before, v_WB_W=draw(arrays(3)), w_WB_W=draw(arrays(3)))
        strikes.append(
            SequenceStrike(
                seconds=each,
                contact=draw(indices),
                outcome=draw(st.sampled_from(ImpactOutcome)),
                p_WC_W=draw(arrays(3)),
                impulse_W=draw(arrays(3)),
                state_before=before,
                state_after=after,
            )
        )
    return tuple(strikes)


@st.composite
def resolved_impacts(
    draw: st.DrawFn, count: int = 2, *, other: bool = False, in_time: bool | None = None
) -> ResolvedImpact:
    """At so many contacts, by all laws, with and without all that is asked for besides."""
    state = dataclasses.replace(draw(states), stamp_ns=draw(st.integers(10**9, 10**18)))
    strikes = draw(strikes_in_time(state.stamp_ns)) if (draw(flags) if in_time is None else in_time) else ()
    law = SeveralContactsLaw.SEQUENTIAL if strikes else draw(st.sampled_from(SeveralContactsLaw))
    orders: tuple[tuple[int, ...], ...] = draw(
        st.lists(st.lists(indices, max_size=3).map(tuple), max_size=2).map(tuple)
    )
    told, k = draw(flags), draw(st.integers(0, 3))
    staying = draw(st.lists(indices, max_size=2).map(tuple)) if strikes else ()
    probabilities = draw(some(arrays(len(ImpactOutcome), of=st.floats(0.0, 1.0))))
    return ResolvedImpact(
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        several_contacts_law=law,
        outcome=draw(some(st.sampled_from(ImpactOutcome))),
        jams=draw(flags),
        converged=draw(flags),
        states=(state, draw(states)) if other else (state,),
        impulses_W=draw(arrays(count, 3)),
        compression_impulses_W=draw(arrays(count if told else 0, 3)),
        velocities_before_W=draw(arrays(count, 3)),
        velocities_after_W=draw(arrays(count, 3)),
        path_W=draw(arrays(k, 3)),
        path_events=draw(tuples_of(st.sampled_from(PathEvent), k)),
        path_contacts=draw(tuples_of(indices, k)),
        kinetic_energy_before=draw(positive),
        kinetic_energy_after=draw(positive),
        creates_energy=draw(flags),
        orders=orders,
        order_velocities_W=draw(arrays(len(orders), 6)),
        orders_complete=draw(flags),
        orders_not_converged=draw(indices),
        covariance=draw(some(arrays(12, 12))),
        outcome_probabilities=probabilities,
        miss_probability=math.nan if probabilities is None else draw(st.floats(0.0, 1.0)),
        strikes=strikes,
        end=draw(st.sampled_from(SequenceEnd)) if strikes else None,
        staying=staying,
        limit_seconds=draw(positive) if staying else None,
    )


@st.composite
def impact_answers(draw: st.DrawFn, p_FB_F: np.ndarray = NO_OFFSET) -> ImpactAnswer:
    """With one body and with two, in a plane and in space."""
    contacts = draw(contact_sets())
    name = draw(st.sampled_from(NAMES)) if not p_FB_F.any() else "brick"
    struck = draw(some(st.builds(NamedState, name=st.just(name), p_FB_F=st.just(p_FB_F), state=states)))
    plane = draw(planes)
    return ImpactAnswer(
        warnings=draw(warnings),
        body_name=name,
        p_FB_F=p_FB_F,
        state=draw(states),
        fit=draw(some(fits)),
        other=struck,
        seconds_to_contact=draw(positive),
        contacts=contacts,
        impact=draw(resolved_impacts(len(contacts), other=struck is not None)),
        problem=Problem.SPATIAL if plane is None else Problem.PLANAR,
        plane=plane,
        out_of_plane=draw(odd_numbers),
        velocity_tolerance=draw(positive),
        distance_tolerance=draw(positive),
    )
