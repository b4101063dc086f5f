# SPDX-License-Identifier: Apache-2.0
"""Random answers about many states at once."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.impact import ImpactOutcome
from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer
from message_values.shared import (
    NAMES,
    NO_OFFSET,
    arrays,
    contact_sets,
    flags,
    many_states,
    some,
    states,
    texts,
    tuples_of,
    warnings,
)


@st.composite
def many_tumblings_answers(draw: st.DrawFn) -> ManyTumblingsAnswer:
    """Up to three states."""
    states = draw(many_states(draw(st.integers(0, 3))))
    return ManyTumblingsAnswer(body_name=draw(st.sampled_from(NAMES)), p_FB_F=NO_OFFSET, states=states)


@st.composite
def many_impacts_answers(draw: st.DrawFn) -> ManyImpactsAnswer:
    """Up to three impacts, of which some do not happen."""
    n = draw(st.integers(0, 3))
    separates = np.array(draw(tuples_of(flags, n)), dtype=bool)
    outcomes = np.array(
        [int(each) for each in draw(tuples_of(st.sampled_from(ImpactOutcome), n))], dtype=np.int64
    )
    return ManyImpactsAnswer(
        body_name=draw(st.sampled_from(NAMES)),
        p_FB_F=NO_OFFSET,
        outcomes=np.where(separates, 0, outcomes),
        separates=separates,
        states=draw(many_states(n)),
        impulses_W=draw(arrays(n, 3)),
        warnings=draw(warnings),
    )


@st.composite
def many_contact_modes_answers(draw: st.DrawFn) -> ManyContactModesAnswer:
    """Up to three candidates with up to two modes each, with their margins or without."""
    counts = draw(st.lists(st.integers(0, 2), max_size=3))
    n, m = len(counts), sum(counts)
    contacts = draw(contact_sets())
    return ManyContactModesAnswer(
        body_name=draw(st.sampled_from(NAMES)),
        p_FB_F=NO_OFFSET,
        state=draw(states),
        contacts=contacts,
        contact_counts=(len(contacts),),
        verdicts=np.array(draw(tuples_of(st.integers(0, 4), n)), dtype=np.int64),
        problems=np.array(draw(tuples_of(st.integers(1, 2), n)), dtype=np.int64),
        mode_counts=np.array(counts, dtype=np.int64),
        modes=draw(tuples_of(texts, m)),
        accelerations_W=draw(arrays(m, 3)),
        angular_accelerations_W=draw(arrays(m, 3)),
        margins=draw(some(arrays(m))) if m > 0 else None,
        warnings=draw(warnings),
    )
