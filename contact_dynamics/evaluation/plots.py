# SPDX-License-Identifier: Apache-2.0
"""Plots of an evaluation: errors over the horizon, and the coverage of covariances."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import NotSupportedError
from contact_dynamics.evaluation.report import COLUMNS, SEVERAL, TITLES, UNITS
from contact_dynamics.evaluation.settings import Law, Method
from contact_dynamics.evaluation.summary import is_inside
from contact_dynamics.measured.events import EventKind

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from contact_dynamics.evaluation.comparison import Comparison
    from contact_dynamics.evaluation.result import Evaluation

NOMINAL: Final = tuple(np.linspace(0.05, 0.99, 48).tolist())  # probabilities at which coverage is plotted

_DRAWN: Final = (EventKind.FLIGHT, EventKind.LANDING, EventKind.IMPACT)
_COLORS: Final = ("#e08a1e", "#3f7fb5", "#3f9b52", "#9059b0", "#8a8a8a", "#c0c0c0")
_UNUSUAL: Final = re.compile(r"[^A-Za-z0-9._-]+")
_BOX: Final = 0.8  # part of the space between horizons that the boxes of all methods fill


def write_plots(folder: Path, evaluation: Evaluation) -> list[Path]:
    """Plot an evaluation into PNG files in a folder, which is created if it does not exist.

    There is one plot of errors for each kind of event with numeric errors, each body and each surface, and
    one of coverage if predictions had covariances.

    Raises:
        NotSupportedError: Matplotlib is not installed.
        OSError: a file cannot be written.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise NotSupportedError("--plots needs matplotlib: pip install '.[evaluate]'") from None
    folder.mkdir(parents=True, exist_ok=True)
    rows = [row for _, row in evaluation.rows() if not row.refused]
    written = []
    groups = {(row.kind, row.body, row.surface, row.several) for row in rows if row.kind in _DRAWN}
    for kind, body, surface, several in sorted(
        groups, key=lambda group: (_DRAWN.index(group[0]), *group[1:])
    ):
        figure = Figure(figsize=(4.6 * len(COLUMNS[kind]), 4.8), layout="constrained")
        title = SEVERAL if several else TITLES[kind]
        figure.suptitle(f"{title}  ({f'{body} on {surface}' if surface else body})")
        which = (kind, body, surface, several)
        of_group = [row for row in rows if (row.kind, row.body, row.surface, row.several) == which]
        _draw_errors(figure, kind, of_group)
        name = _UNUSUAL.sub("_", "-".join(filter(None, (kind.value, body, surface, "several" * several))))
        written.append(_save(figure, folder / f"{name}.png"))
    covered = [row for row in rows if row.distance is not None]
    if covered:
        figure = Figure(figsize=(5.2, 5.0), layout="constrained")
        _draw_coverage(figure, covered)
        written.append(_save(figure, folder / "coverage.png"))
    return written


def _save(figure: Any, path: Path) -> Path:
    figure.savefig(path, dpi=130)
    return path


def _draw_errors(figure: Any, kind: EventKind, rows: Sequence[Comparison]) -> None:
    ways: list[tuple[Method, Law | None]] = sorted(
        {(row.method, row.law) for row in rows},
        key=lambda way: (list(Method).index(way[0]), [None, *Law].index(way[1])),
    )
    horizons = sorted({row.horizon for row in rows})
    for column, name in enumerate(COLUMNS[kind]):
        axes = figure.add_subplot(1, len(COLUMNS[kind]), column + 1)
        label, factor = UNITS[name]
        for i, (method, law) in enumerate(ways):
            found = [
                [
                    factor * abs(error)
                    for row in rows
                    if (row.method, row.law, row.horizon) == (method, law, horizon)
                    and (error := getattr(row, name)) is not None
                ]
                for horizon in horizons
            ]
            places = [place + _BOX * ((i + 0.5) / len(ways) - 0.5) for place in range(len(horizons))]
            filled = [k for k, errors in enumerate(found) if errors]
            boxes = axes.boxplot(
                [found[k] for k in filled],
                positions=[places[k] for k in filled],
                widths=0.85 * _BOX / len(ways),
                whis=(5.0, 95.0),
                showfliers=False,
                patch_artist=True,
                medianprops={"color": "black"},
                manage_ticks=False,
            )
            color = _COLORS[i % len(_COLORS)]
            for box in boxes["boxes"]:
                box.set_facecolor(color)
            axes.plot([], [], color=color, linewidth=6.0, label=_way(method, law))
        axes.set_xticks(range(len(horizons)), [f"{1e3 * horizon:.0f}" for horizon in horizons])
        axes.set_xlabel("horizon, ms")
        axes.set_ylabel(f"error of {label}")
        axes.set_yscale("log")
        axes.grid(visible=True, axis="y", alpha=0.3)
        if column == 0:
            figure.legend(
                loc="outside lower center",
                ncols=len(ways),
                fontsize="small",
                title="boxes: quartiles; lines: 5 to 95 %",
                title_fontsize="x-small",
            )


def _draw_coverage(figure: Any, rows: Sequence[Comparison]) -> None:
    axes = figure.add_subplot()
    axes.plot([0.0, 100.0], [0.0, 100.0], color="black", linewidth=0.8, label="as stated")
    for i, kind in enumerate(kind for kind in _DRAWN if any(row.kind is kind for row in rows)):
        of_kind = [row for row in rows if row.kind is kind]
        inside = [100.0 * float(np.mean([is_inside(row, level) for row in of_kind])) for level in NOMINAL]
        axes.plot(
            [100.0 * level for level in NOMINAL],
            inside,
            color=_COLORS[i],
            label=f"{kind.value} ({len(of_kind)})",
        )
    axes.set_xlabel("stated probability, %")
    axes.set_ylabel("measured values inside, %")
    axes.set_title("coverage of the prediction regions")
    axes.grid(visible=True, alpha=0.3)
    axes.legend()


def _way(method: Method, law: Law | None) -> str:
    if method is Method.FIT:
        return "fit" if law is None else f"fit, {law.value}"
    return f"baseline: {method.value}"
