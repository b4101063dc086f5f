# SPDX-License-Identifier: Apache-2.0
"""Whatever an answer can say has words."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
import pytest

from contact_dynamics import Body, BodyState, ContactSet, MassProperties, ModeVerdict
from contact_dynamics.contact import ContactUncertainty
from contact_dynamics.contact_modes import Certainty, SpatialModeMargin
from contact_dynamics.contact_modes.letters import mode_in_words
from contact_dynamics.diagrams.words import (
    CERTAINTIES,
    OUTCOMES,
    REGIMES,
    SEQUENCE_ENDS,
    VERDICTS,
    contact_modes_in_words,
    margin_in_words,
)
from contact_dynamics.impact import ImpactOutcome, SequenceEnd
from contact_dynamics.questions import ContactModeQuestion, ask
from contact_dynamics.tumbling import Regime


@pytest.mark.parametrize(
    ("values", "words"),
    [
        (Regime, REGIMES),
        (ImpactOutcome, OUTCOMES),
        (SequenceEnd, SEQUENCE_ENDS),
        (ModeVerdict, VERDICTS),
        (Certainty, CERTAINTIES),
    ],
)
def test_each_value_has_words_of_its_own(values: type[IntEnum], words: dict[IntEnum, str]) -> None:
    assert set(words) == set(values)
    assert len(set(words.values())) == len(words)


@pytest.mark.parametrize(
    ("margin", "words"),
    [(0.25, "(margin 0.25 N to ff or s)"), (math.inf, "(infinite margin)"), (math.nan, "(unknown margin)")],
)
def test_a_margin_says_how_far_it_is_to_what(margin: float, words: str) -> None:
    told = SpatialModeMargin(
        mode="fl",
        margin=margin,
        length=0.1,
        change_W=np.zeros(6),
        verdict_beyond=ModeVerdict.INDETERMINATE,
        modes_beyond=("ff", "s"),
    )
    assert margin_in_words(told) == words


@pytest.mark.parametrize(
    ("mode", "words"),
    [
        ("ffff", "every contact stays fixed"),
        ("rr", "it slides right"),
        ("l", "it slides left"),
        ("ccc", "it slides"),
        ("ss", "it leaves"),
        ("", "nothing touches it"),
        ("ssff", "it tips (2 contacts separate, 2 stay fixed)"),
        ("sf", "it tips (1 contact separates, 1 stays fixed)"),
        ("ssr", "2 contacts separate, 1 slides right"),
    ],
)
def test_a_mode_says_what_the_body_does(mode: str, words: str) -> None:
    assert mode_in_words(mode) == words


def test_what_holds_within_the_errors_of_contacts_has_words() -> None:
    """A ball rests on one point, or slips if its friction may be too little for the push."""
    properties = MassProperties(mass=1.0, I_B=0.004 * np.eye(3))
    state = BodyState(p_WB_W=(0, 0, 0.1), q_WB=(0, 0, 0, 1))
    contacts = ContactSet(p_WC_W=[(0.0, 0.0, 0.0)], normals_W=(0.0, 0.0, 1.0), frictions=0.3)

    def words(frictions: float, *, margins: bool = False) -> str:
        question = ContactModeQuestion(
            body=Body(name="ball", mass_properties=properties),
            state=state,
            contacts=contacts,
            force_W=(5.0, 0.0, 0.0),
            uncertainty=ContactUncertainty(frictions=frictions),
            include_geometry_margins=margins,
        )
        return "; ".join(contact_modes_in_words(ask(question)))

    assert "the verdict holds within the errors of the contacts" in words(1e-3)
    assert "64 samples show" in words(0.3)
    assert "friction may be off by" in words(0.0, margins=True)
