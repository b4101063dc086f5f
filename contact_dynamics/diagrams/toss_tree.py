"""The fan of a toss as points and lines: nodes of the event tree in space and time, and poses of samples."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.diagrams.words import branch_in_words, face_in_words

if TYPE_CHECKING:
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.toss.distribution import EventRegions
    from contact_dynamics.validation import FloatArray


MAX_FACES: Final = 3
"""Faces of rest that a label names. A longer one hides the labels of strikes."""


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
    return f"rests on its face towards {faces[0]}" + (f"\n{more}" if more else "") if faces else ""


def fan_of(told: TossDistribution) -> list[FloatArray]:
    """Return for each sample that has ghosts its places, (k, 3), m, at its strikes and at rest."""
    ghosts = told.ghosts
    lines = []
    for sample in np.unique(ghosts.samples).tolist():
        mine = np.flatnonzero(ghosts.samples == sample)
        order = sorted(mine.tolist(), key=lambda i: (ghosts.strikes[i] == 0, ghosts.strikes[i]))
        lines.append(ghosts.p_WB_W[order])
    return lines
