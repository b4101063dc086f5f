# SPDX-License-Identifier: Apache-2.0
"""A whole toss in space: its path with strikes and the resting pose, other ways, and the fan of samples.

The fan has outlines of the body where samples strike and rest, and the tree of the next strikes: a node at
the mean place of each, with a line up to its number, corner and probability, and an ellipsoid with nine
tenths of the places. The tree is for the viewer, since on paper it has a diagram of its own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Ellipsoids, Labels, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import outline, solid
from contact_dynamics.diagrams.toss_tree import rest_in_words, tree_of
from contact_dynamics.toss import Toss, TossEnd, TossEventKind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.tumbling.motion import Trajectory
    from contact_dynamics.validation import FloatArray

MAX_OUTLINES: Final = 4
"""Outlines of the body along the toss, at its first strikes. Many small rebounds follow at nearly one place.
"""

MAX_GHOSTS: Final = 12
"""Outlines of the body along its way on paper, where nothing moves. They are equally far apart."""

MAX_STRIKING: Final = 6
"""Samples whose strikes have outlines. More would hide the toss."""

MAX_POINTS: Final = 2000
"""Points of the line that a toss without samples of time is drawn as."""

_LABELS_APART: Final = 0.55  # relative to the body's size, so that labels do not hide each other
_THIN: Final = 0.7

_PATH: Final = Paint(palette.PREDICTED, paper.BLACK)
_STRIKES: Final = Paint(palette.IMPACT, paper.RED)
_GHOSTS: Final = Paint(palette.PREDICTED, paper.GREY)
_OTHER: Final = Paint(palette.UNDECIDED, paper.ORANGE)
_SAMPLES: Final = Paint(palette.PREDICTED, paper.SKY)
_TREE: Final = Paint(palette.AFTER_IMPACT, paper.GREY)


def toss_marks(
    shape: Shape, toss: Toss | TossAnswer, *, up_W: FloatArray, told: TossDistribution | None = None
) -> list[Mark]:
    """Return the marks of a toss or of the answer to a question about one.

    Labels are above what they name: ``up_W``, (3,), is the unit vector up. ``told`` has the samples of a
    toss; an answer has its own.
    """
    rests = (toss if isinstance(toss, Toss) else toss.toss).end == TossEnd.RESTS
    if isinstance(toss, Toss):
        events = toss.events
        first, *others = (
            each.at(np.linspace(0.0, each.seconds, MAX_POINTS)) for each in (toss, *toss.alternatives)
        )
    else:
        events, told = toss.toss.events, toss.distribution
        first, *others = (path.trajectory for path in toss.paths)
    strikes = [event for event in events if event.kind == TossEventKind.STRIKES]
    points = np.array([point for event in strikes for point in event.p_WC_W]).reshape(-1, 3)
    begin, end = ((first.p_WB_W[i], first.q_WB[i]) for i in (0, -1))
    ends = [edge for way in others for edge in outline(shape, way.p_WB_W[-1], way.q_WB[-1])]
    struck = _outlines(shape, ((each.state.p_WB_W, each.state.q_WB) for each in strikes[:MAX_OUTLINES]))
    return [
        *([] if told is None else _fan_marks(shape, told)),
        Lines("other_ways", _OTHER, [w.p_WB_W for w in others], width=1.1, legend="other ways"),
        Lines("other_ends", _OTHER, ends, width=_THIN),
        Lines("ghosts", _GHOSTS, _ghosts(shape, first), width=_THIN, legend="the body", in_viewer=False),
        Lines("path", _PATH, [first.p_WB_W], width=1.9, legend="the toss"),
        Lines("begin", _PATH, list(outline(shape, *begin)), on_paper=False),
        Lines(
            "end", _PATH, list(outline(shape, *end)), width=0.9, legend="at rest" if rests else "at the end"
        ),
        Lines("outlines", _STRIKES, struck, on_paper=False),
        Points("strikes", _STRIKES, points, size=5.0, legend="strikes"),
        *([solid(shape, "rest/faces", _PATH, *end, opacity=0.25, on_paper=False)] if rests else []),
        *([] if told is None else _tree_marks(told, lift_W=_LABELS_APART * shape.size * up_W)),
    ]


def _ghosts(shape: Shape, way: Trajectory) -> list[FloatArray]:
    steps = np.linalg.norm(np.diff(way.p_WB_W, axis=0), axis=1)
    lengths = np.concatenate([[0.0], np.cumsum(steps)])
    apart = max(shape.size, lengths[-1] / MAX_GHOSTS)
    count = int(lengths[-1] / apart) if apart > 0.0 else 0
    chosen = np.searchsorted(lengths, np.linspace(0.0, lengths[-1], count, endpoint=False))
    return _outlines(shape, zip(way.p_WB_W[chosen], way.q_WB[chosen], strict=True))


def _outlines(shape: Shape, poses: Iterable[tuple[FloatArray, FloatArray]]) -> list[FloatArray]:
    return [edge for pose in poses for edge in outline(shape, *pose)]


def _fan_marks(shape: Shape, told: TossDistribution) -> list[Mark]:
    ghosts = told.ghosts
    ways = []
    for sample in np.unique(ghosts.samples).tolist():
        mine = np.flatnonzero(ghosts.samples == sample)
        order = sorted(mine.tolist(), key=lambda i: (ghosts.strikes[i] == 0, ghosts.strikes[i]))
        ways.append(ghosts.p_WB_W[order])
    chosen = (ghosts.strikes > 0) & (ghosts.samples < MAX_STRIKING)
    striking, resting = (
        _outlines(shape, zip(ghosts.p_WB_W[some], ghosts.q_WB[some], strict=True))
        for some in (chosen, ghosts.strikes == 0)
    )
    faint: dict[str, Any] = {"paint": _SAMPLES, "opacity": 0.5, "width": _THIN}
    return [
        Lines(name="samples/ways", strips=ways, legend="samples", **faint),
        Lines(name="samples/rests", strips=resting, **faint),
        Lines("samples/strikes", _STRIKES, striking, opacity=0.35, width=_THIN, on_paper=False),
    ]


def _tree_marks(told: TossDistribution, *, lift_W: FloatArray) -> list[Mark]:
    nodes = tree_of(told)
    places = [node.regions.position.mean for node in nodes]
    texts, regions = [node.text for node in nodes], [node.regions.position for node in nodes]
    branches: list[Mark] = [
        Lines(
            f"tree/branches/{k}",
            _TREE,
            [np.vstack([places[node.parent], places[k]])],
            width=0.6 + 3.8 * node.probability,
            on_paper=False,
        )
        for k, node in enumerate(nodes)
        if node.parent >= 0
    ]
    if told.rest is not None:
        places.append(told.rest.position.mean)
        texts.append(rest_in_words(told))
        regions.append(told.rest.position)
    # The first strikes have the highest labels, since what follows is nearly at one place.
    raised = [place + (len(places) + 1 - k) * lift_W for k, place in enumerate(places)]
    leaders = [np.vstack(ends) for ends in zip(places, raised, strict=True)]
    tree: dict[str, Any] = {"paint": _TREE, "on_paper": False}
    return [
        *branches,
        Points(name="tree/nodes", places=np.reshape(places, (-1, 3)), size=6.5, **tree),
        Labels(name="tree/labels", places=np.reshape(raised, (-1, 3)), texts=texts, **tree),
        Lines(name="tree/leaders", opacity=0.5, strips=leaders, width=_THIN, **tree),
        Ellipsoids(
            name="tree/regions",
            centers=np.reshape([region.mean for region in regions], (-1, 3)),
            covariances=np.reshape([region.covariance for region in regions], (-1, 3, 3)),
            deviations=np.array([region.radii[1] for region in regions]),
            **tree,
        ),
    ]
