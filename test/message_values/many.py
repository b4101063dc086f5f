# SPDX-License-Identifier: Apache-2.0
"""Random questions and answers about many states at once."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS
from contact_dynamics.impact import ImpactOutcome, RestitutionLaw
from contact_dynamics.questions import ContactModeQuestion
from contact_dynamics.questions.many import (
    ManyImpactsAnswer,
    ManyImpactsQuestion,
    ManyTumblingsAnswer,
    ManyTumblingsQuestion,
)
from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer, ManyContactModesQuestion
from message_values.contact_modes import contact_mode_questions
from message_values.shared import (
    NAMES,
    NO_OFFSET,
    arrays,
    bodies,
    contact_sets,
    flags,
    gravities,
    many_states,
    not_negative,
    some,
    states,
    texts,
    tuples_of,
    unit_vectors,
    warnings,
)


@st.composite
def many_tumblings_questions(draw: st.DrawFn) -> ManyTumblingsQuestion:
    """Up to three states, in the known gravity and in none."""
    n = draw(st.integers(1, 3))
    return ManyTumblingsQuestion(
        body=draw(bodies()), states=draw(many_states(n)), seconds=draw(arrays(n)), gravity_W=draw(gravities)
    )


@st.composite
def many_impacts_questions(draw: st.DrawFn) -> ManyImpactsQuestion:
    """Up to three states, by all laws."""
    n = draw(st.integers(1, 3))
    return ManyImpactsQuestion(
        body=draw(bodies()),
        states=draw(many_states(n)),
        p_WC_W=draw(arrays(n, 3)),
        normals_W=np.array(draw(tuples_of(unit_vectors(), n))),
        frictions=draw(arrays(n, of=st.floats(0.0, 5.0))),
        restitutions=draw(arrays(n, of=st.floats(0.0, 1.0))),
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        velocity_tolerance=draw(some(not_negative)),
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


def asked_of_many(question: ContactModeQuestion) -> ContactModeQuestion:
    """Return a question without what is not asked for many candidates."""
    return replace(
        question,
        force_W=np.zeros(3),
        torque_W=np.zeros(3),
        friction_facets=None,
        margin_length=question.margin_length if question.include_margins else None,
        include_wrenches=False,
        include_statics=False,
        include_impact=False,
        uncertainty=EXACT_CONTACTS,
        include_geometry_margins=False,
        include_probabilities=False,
    )


@st.composite
def many_contact_modes_questions(draw: st.DrawFn) -> ManyContactModesQuestion:
    """Up to three candidates, with sets of contacts or without, and nothing that is not asked for many."""
    asked = asked_of_many(draw(contact_mode_questions()))
    given = 0 if asked.contacts is None else len(asked.contacts)
    counts = draw(st.sampled_from([(), (given,), (1,) * given] if given else [()]))
    n = len(counts) if len(counts) > 1 else draw(st.integers(1, 3))
    return ManyContactModesQuestion(
        asked=asked, forces_W=draw(arrays(n, 3)), torques_W=draw(arrays(n, 3)), contact_counts=counts
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
