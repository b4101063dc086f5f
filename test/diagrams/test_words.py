"""Whatever an answer can say has words."""

from __future__ import annotations

import math
from enum import IntEnum

import numpy as np
import pytest

from contact_dynamics.contact_modes import Certainty, ModeVerdict, SpatialModeMargin
from contact_dynamics.diagrams.words import (
    CERTAINTIES,
    OUTCOMES,
    REGIMES,
    SEQUENCE_ENDS,
    VERDICTS,
    margin_in_words,
)
from contact_dynamics.impact import ImpactOutcome, SequenceEnd
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
    [(0.25, "(0.25 N from ff or s)"), (math.inf, "(under every wrench)"), (math.nan, "")],
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
