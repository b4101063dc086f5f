# SPDX-License-Identifier: Apache-2.0
"""What holds for every diagram: names, units, colours, and words that neither overlap nor are cut off."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

pytest.importorskip("matplotlib", reason="matplotlib of requirements/test.txt is not installed")

from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.text import Text

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.palette import LEAST_DIFFERENCE
from plots.drawn_figures import DIAGRAMS, drawn

TO_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
WHITE = TO_XYZ.sum(axis=1)
DEUTERANOPE = np.array(
    [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]]
)
"""Machado, Oliveira and Fernandes (2009), severity 1, on linear RGB."""


def linear(color: object) -> np.ndarray:
    """Linear RGB of a colour that Matplotlib knows."""
    rgb = np.array(to_rgb(color))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(rgb: np.ndarray) -> np.ndarray:
    """CIE 1976 L*a*b* of linear RGB."""
    xyz = TO_XYZ @ np.clip(rgb, 0.0, 1.0) / WHITE
    x, y, z = np.where(xyz > 216 / 24389, np.cbrt(xyz), (24389 / 27 * xyz + 16) / 116)
    return np.array([116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)])


def difference(one: object, other: object) -> float:
    """The smaller of the differences that usual eyes and deuteranopes see."""
    pair = linear(one), linear(other)
    return min(
        float(np.linalg.norm(lab(pair[0]) - lab(pair[1]))),
        float(np.linalg.norm(lab(DEUTERANOPE @ pair[0]) - lab(DEUTERANOPE @ pair[1]))),
    )


def color_of(handle: object) -> str:
    """The colour of an entry of a legend."""
    for name in ("get_facecolor", "get_color"):
        if hasattr(handle, name):
            return (
                tuple(np.ravel(getattr(handle, name)())[:3])
                if name == "get_facecolor"
                else getattr(handle, name)()
            )
    raise AssertionError(handle)


def test_the_measure_knows_colours_that_deuteranopes_confuse() -> None:
    assert difference("#009e73", "#999999") < LEAST_DIFFERENCE  # green and grey
    assert difference("black", "white") == pytest.approx(100.0, abs=0.1)


@pytest.mark.parametrize("name", DIAGRAMS)
def test_a_diagram_is_read_without_mistakes(name: str) -> None:
    """Deuteranopes tell apart what means different things, axes have units, and words have room."""
    figure, axes = drawn(name)
    colours_are_told_apart(name, axes)
    axes_have_names_with_units(name, axes)
    words_do_not_overlap_and_are_not_cut_off(figure, axes)


def colours_are_told_apart(name: str, axes: Axes) -> None:
    handles = axes.get_legend().legend_handles
    shown = {to_rgb(color_of(handle)) for handle in handles}
    assert len(shown) > 1
    for one, other in combinations(shown, 2):
        assert difference(one, other) >= LEAST_DIFFERENCE, (name, one, other)


def test_every_two_modes_of_a_map_have_colours_apart() -> None:
    every = (*colors.MODES, colors.SEVERAL, colors.NONE, colors.MARK)
    assert min(difference(one, other) for one, other in combinations(every, 2)) >= LEAST_DIFFERENCE
    for color in colors.MODES:  # words on it are read: WCAG's contrast for large words
        words = colors.SEVERAL if color in colors.DARK else colors.BLACK
        bright, dark = sorted((float(TO_XYZ[1] @ linear(each)) for each in (color, words)), reverse=True)
        assert (bright + 0.05) / (dark + 0.05) >= 3.0, color


def axes_have_names_with_units(name: str, axes: Axes) -> None:
    assert axes.get_xlabel()
    if name == "map of modes":
        return  # its places are directions, as the name of its axis says
    assert axes.get_xlabel().rpartition(", ")[2] in {"N s", "m", "N", "s", "rad/s"}
    assert axes.get_ylabel().rpartition(", ")[2] in {
        *("N s", "m", "N", "rad/s", "m/s", "J", "kg m/s", "kg m²/s", "unit quaternion")
    }


def words_do_not_overlap_and_are_not_cut_off(figure: Figure, axes: Axes) -> None:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    renderer = canvas.get_renderer()
    boxes = [
        (text, text.get_window_extent(renderer))
        for text in figure.findobj(Text)
        if text.get_visible() and text.get_text().strip() and is_drawn(text, axes)
    ]
    for text, box in boxes:
        assert box.x0 >= -1.0, text
        assert box.y0 >= -1.0, text
        assert box.x1 <= figure.bbox.x1 + 1.0, text
        assert box.y1 <= figure.bbox.y1 + 1.0, text
    upright = [(text.get_text(), box) for text, box in boxes if text.get_rotation() % 90.0 == 0.0]
    for (one, first), (other, second) in combinations(upright, 2):  # slanted words are smaller than their box
        assert not overlap(first, second), f"{one!r} covers {other!r}"


def is_drawn(text: Text, axes: object) -> bool:
    """Whether a text is in the picture: ticks beyond the limits of an axis are not."""
    for name in ("x", "y", "z"):
        axis = getattr(axes, f"{name}axis", None)
        for tick in axis.get_major_ticks() if axis is not None else ():
            if text in (tick.label1, tick.label2):
                low, high = sorted(getattr(axes, f"get_{name}lim")())
                return low <= tick.get_loc() <= high and text is tick.label1
    return True


def overlap(one: object, other: object) -> bool:
    """Whether two boxes share more than a point of the screen in both directions."""
    wide = min(one.x1, other.x1) - max(one.x0, other.x0)
    high = min(one.y1, other.y1) - max(one.y0, other.y0)
    return wide > 1.0 and high > 1.0
