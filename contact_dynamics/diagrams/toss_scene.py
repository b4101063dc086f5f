# SPDX-License-Identifier: Apache-2.0
"""A whole toss in space, with its path, strikes, other ways and samples, and the tree of its next strikes.

The fan of samples has outlines of the body where they strike and rest, and the tree of the next strikes: a
node at the mean place of each, with a line up to its number, corner and probability, and an ellipsoid with
nine tenths of the places. On paper the tree is a diagram of its own, in words and over time.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Axis, Diagram, Ellipsoids, Labels, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.shape import outline, solid
from contact_dynamics.diagrams.words import branch_in_words, face_in_words
from contact_dynamics.toss import Toss, TossEnd, TossEventKind

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.toss.distribution import EventRegions
    from contact_dynamics.tumbling.motion import Trajectory
    from contact_dynamics.validation import FloatArray


MAX_FACES: Final = 3  # faces of rest that a label names. A longer one hides the labels of strikes.
_ABOVE: Final = 0.28  # height of a label above its interval, in rows
_HALF_OF_TIMES: Final = "half of the times"
_NINE_TENTHS: Final = "nine tenths"

_BRANCH: Final = Paint(palette.AFTER_IMPACT, paper.GREY)
_HALF: Final = Paint(palette.IMPACT, paper.BLUE)
_MOST: Final = Paint(palette.PREDICTED, paper.SKY)
_TEXT: Final = Paint(palette.NORMAL, paper.BLACK)


class TreeNode(NamedTuple):
    """A strike of the event tree that has regions."""

    parent: int  # the index of the node before it, or -1 for the state that the toss begins with
    text: str  # which strike it is, what happens, and with which probability
    probability: float  # share of all samples
    regions: EventRegions  # when and where it happens


def tree_of(told: TossDistribution) -> list[TreeNode]:
    """Return the nodes of the tree, those that others follow first."""
    nodes: list[TreeNode] = []
    places: dict[int, int] = {-1: -1}
    for k, branch in enumerate(told.branches):
        if branch.regions is None or branch.parent not in places:
            continue
        places[k] = len(nodes)
        text = f"{branch.strike}. {branch_in_words(branch.kind, branch.corner)}: {branch.probability:.0%}"
        nodes.append(TreeNode(places[branch.parent], text, branch.probability, branch.regions))
    return nodes


def rest_in_words(told: TossDistribution) -> str:
    """Return on which faces samples rest, the probable ones first, in at most two lines."""
    shares = told.face_probabilities.tolist()
    faces = [
        f"{face_in_words(normal)}: {share:.0%}"
        for normal, share in zip(told.face_normals_B, shares, strict=True)
    ]
    more = ", ".join(faces[1:MAX_FACES])
    if len(faces) > MAX_FACES:
        more += f", others: {sum(shares[MAX_FACES:]):.0%}"
    return f"rests on face {faces[0]}" + (f"\n{more}" if more else "") if faces else ""


def event_tree(told: TossDistribution) -> Diagram:
    """Return the tree of the next strikes over time: 50 and 90 % of the times of each, its probability."""
    nodes = tree_of(told)
    heights = {-1: 0.0, **{k: -float(row) for row, k in enumerate(_each_after_its_parent(nodes))}}
    marks: list[Mark] = []
    labels: list[tuple[float, float, str]] = []
    for k, node in enumerate(nodes):
        time = node.regions.seconds
        deviation, up = float(np.sqrt(time.covariance[0, 0])), heights[k]
        middle, (half, most) = float(time.mean[0]), (deviation * time.radii).tolist()
        before = 0.0 if node.parent < 0 else float(nodes[node.parent].regions.seconds.mean[0])
        branch = np.array([(before, heights[node.parent]), (middle, up)])
        width = 0.6 + 3.8 * node.probability
        marks.append(Lines(f"branch_{k}", _BRANCH, [branch], width=width))
        marks.append(
            _interval(f"time_90_{k}", _MOST, (middle - most, middle + most), up, "" if k else _NINE_TENTHS)
        )
        marks.append(
            _interval(f"time_50_{k}", _HALF, (middle - half, middle + half), up, "" if k else _HALF_OF_TIMES)
        )
        labels.append((middle, up, node.text))
    rows = len(nodes)
    if told.rest is not None:
        low, quarter, middle, three, high = told.rest.seconds.tolist()
        marks.append(_interval("rest_90", _MOST, (low, high), -rows, ""))
        marks.append(_interval("rest_50", _HALF, (quarter, three), -rows, ""))
        labels.append((middle, -float(rows), rest_in_words(told)))
        rows += 1
    places = np.reshape([(x, up + _ABOVE * (1 + 0.6 * text.count("\n"))) for x, up, text in labels], (-1, 2))
    marks.append(Labels("texts", _TEXT, places, [text for *_, text in labels]))
    begins = [mark.strips[0][:, 0] for mark in marks if isinstance(mark, Lines)]
    begin, end = float(np.min([0.0, *(x.min() for x in begins)])), float(np.max([*(x.max() for x in begins)]))
    room = 0.25 * (end - begin)
    return Diagram(
        marks=marks,
        axes=(Axis("time after the state, s", begin - room, end + room), Axis("", 0.3 - rows, 1.2, ())),
        title=f"next events of {told.samples} samples",
        is_equal=False,
    )


def _interval(name: str, paint: Paint, ends: tuple[float, float], height: float, legend: str) -> Lines:
    strip = np.array([(end, height) for end in ends])
    return Lines(name, paint, [strip], width=6.2, legend=legend)


def _each_after_its_parent(nodes: list[TreeNode], parent: int = -1) -> list[int]:
    """Return the indices of the nodes that follow one, each right before those that follow it."""
    return [
        index
        for k, node in enumerate(nodes)
        if node.parent == parent
        for index in (k, *_each_after_its_parent(nodes, k))
    ]


MAX_OUTLINES: Final = 4
"""Outlines of the body along the toss, at its first strikes. Many small rebounds follow at nearly one place.
"""

MAX_GHOSTS: Final = 12
"""Outlines of the body along its way on paper, where nothing moves. They are equally far apart."""

MAX_STRIKING: Final = 6  # samples whose strikes have outlines. More would hide the toss.
MAX_POINTS: Final = 2000  # points of the line that a toss without samples of time is drawn as
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
