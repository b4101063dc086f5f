# SPDX-License-Identifier: Apache-2.0
"""The colours of the viewer, as those see them who see no green."""

from __future__ import annotations

from itertools import combinations

import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.palette import LEAST_DIFFERENCE, Color
from plots.test_every_diagram import difference

MEANINGS = {
    "measured": palette.MEASURED,
    "predicted": palette.PREDICTED,
    "impact": palette.IMPACT,
    "before the impact": palette.BEFORE_IMPACT,
    "after the impact": palette.AFTER_IMPACT,
    "friction cone": palette.FRICTION_CONE,
    "separates": palette.SEPARATE,
    "slides": palette.SLIDE,
    "stays fixed": palette.FIXED,
    "normal, undecided": palette.NORMAL,
    "background": palette.BACKGROUND,
}


def apart(one: Color, other: Color) -> float:
    """How much two colours differ, the smaller of what usual eyes and deuteranopes see."""
    return difference(*(tuple(part / 255.0 for part in color[:3]) for color in (one, other)))


@pytest.mark.parametrize(("one", "other"), list(combinations(MEANINGS, 2)))
def test_deuteranopes_tell_apart_what_means_different_things(one: str, other: str) -> None:
    assert apart(MEANINGS[one], MEANINGS[other]) >= LEAST_DIFFERENCE


def test_twenty_bodies_are_told_apart_and_from_what_is_predicted_of_them() -> None:
    assert len(palette.BODIES) == 20
    for one, other in combinations([*palette.BODIES, palette.PREDICTED, palette.IMPACT], 2):
        assert apart(one, other) >= LEAST_DIFFERENCE, (one, other)


@pytest.mark.parametrize("color", [*MEANINGS.values(), *palette.BODIES])
def test_words_can_be_read_on_the_background_and_are_otherwise_left_as_they_are(color: Color) -> None:
    word = palette.readable(color)
    assert palette.contrast(word, palette.BACKGROUND) >= palette.WORD_CONTRAST
    if palette.contrast(color, palette.BACKGROUND) >= palette.WORD_CONTRAST:
        assert word[:3] == color[:3]


def test_contrast_is_that_of_wcag() -> None:
    assert palette.contrast((255, 255, 255, 255), (0, 0, 0, 255)) == pytest.approx(21.0)
    grey = palette.contrast(
        (255, 255, 255, 255), (118, 118, 118, 255)
    )  # the darkest grey of level AA on white
    assert grey == pytest.approx(4.54, abs=0.005)
