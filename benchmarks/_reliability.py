# SPDX-License-Identifier: Apache-2.0
"""Draws how often measured tosses were where they were predicted, from the numbers of `tosses`."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from benchmarks._quotes import ROOT, read

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FILE: Final = ROOT / "docs" / "toss_reliability.svg"

_QUANTITIES: Final = {
    "time": "time",
    "place": "position",
    "attitude": "attitude",
    "velocity": "velocity",
    "spin": "spin",
}
"""Titles by the names of the measured numbers."""

_SETS: Final = (("first impact", "tosses.1"), ("second impact", "tosses.2"))
_NORMAL_AT_95: Final = 1.6449
"""Standard deviations within which nine tenths of a normal distribution lie."""


def reliability_figure() -> Figure:
    """Return the figure: a row a quantity, with the share of measured values in each region."""
    from matplotlib.figure import Figure

    rows = _rows(read()["tosses"]["numbers"])
    figure = Figure(figsize=(9.0, 4.6), layout="constrained")
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, nominal, which in ((left, 50.0, 0), (right, 90.0, 1)):
        axes.axvline(nominal, color="#e08a1e", linewidth=2.0)
        for height, (_, count, shares) in enumerate(rows):
            low, high = _interval(shares[which], count)
            axes.plot([low, high], [height, height], color="#9db8cf", linewidth=5.0, solid_capstyle="butt")
            axes.plot(shares[which], height, "o", color="#1f4e79")
            axes.text(shares[which], height - 0.22, f"{shares[which]:g} %", ha="center", fontsize="x-small")
        axes.set(xlim=(0.0, 103.0), xlabel=f"measured values inside the {nominal:g} % region, %")
    left.set_yticks(range(len(rows)), [f"{name} ({count})" for name, count, _ in rows])
    left.set_ylim(len(rows) - 0.5, -0.7)
    figure.suptitle(
        "Coverage of the prediction regions of recorded tosses (number of values)", fontsize="medium"
    )
    return figure


def redraw() -> Path | None:
    """Draw the figure anew. Return its file, or None where Matplotlib is not installed."""
    try:
        from contact_dynamics.plots import save_figure
    except ImportError:
        return None
    save_figure(reliability_figure(), FILE)
    return FILE


def _rows(numbers: dict[str, dict[str, Any]]) -> list[tuple[str, int, tuple[float, float]]]:
    """Return for each row its name, the count of values, and the shares in regions of 50 and 90 %, %."""
    rows = [
        (f"{title}, {label}", int(numbers[f"{key}.{name}.count"]["value"]), _shares(numbers, f"{key}.{name}"))
        for title, key in _SETS
        for name, label in _QUANTITIES.items()
    ]
    coordinates = 2 * int(numbers["tosses.rests"]["value"])
    return [*rows, ("rest, coordinates", coordinates, _shares(numbers, "tosses.rest.place"))]


def _shares(numbers: dict[str, dict[str, Any]], key: str) -> tuple[float, float]:
    return numbers[f"{key}.half"]["value"], numbers[f"{key}.most"]["value"]


def _interval(share: float, count: int) -> tuple[float, float]:
    """Return Wilson's interval of 90 % for a probability, %, from a share of so many draws."""
    z, p = _NORMAL_AT_95, share / 100.0
    middle = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(p * (1 - p) / count + z * z / (4 * count * count))
    return 100.0 * (middle - half), 100.0 * (middle + half)
