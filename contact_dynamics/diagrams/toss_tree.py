# SPDX-License-Identifier: Apache-2.0
"""The tree of the next strikes of a toss, in words and over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Axis, Diagram, Labels, Lines
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.diagrams.words import branch_in_words, face_in_words

if TYPE_CHECKING:
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.toss.distribution import EventRegions


MAX_FACES: Final = 3
"""Faces of rest that a label names. A longer one hides the labels of strikes."""


_ABOVE: Final = 0.28  # height of a label above its interval, in rows
_HALF_OF_TIMES: Final = "half of the times"
_NINE_TENTHS: Final = "nine tenths"

_BRANCH: Final = Paint(palette.AFTER_IMPACT, paper.GREY)
_HALF: Final = Paint(palette.IMPACT, paper.BLUE)
_MOST: Final = Paint(palette.PREDICTED, paper.SKY)
_TEXT: Final = Paint(palette.NORMAL, paper.BLACK)


class TreeNode(NamedTuple):
    """A strike of the event tree that has regions.

    Attributes:
        parent: The index of the node before it, or -1 for the state that the toss begins with.
        text: Which strike it is, what happens, and with which probability.
        probability: Share of all samples.
        regions: When and where it happens.
    """

    parent: int
    text: str
    probability: float
    regions: EventRegions


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
        axes=(
            Axis("time after the state, s", begin - room, end + room),
            Axis("", 0.3 - rows, 1.2, ()),
        ),
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
