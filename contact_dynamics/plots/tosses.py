"""Draws a whole toss: where the body goes, what samples do, and the tree of the next strikes over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.toss_tree import fan_of, rest_in_words, tree_of
from contact_dynamics.plots.style import legend_beside
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.toss import Toss, TossEventKind

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.diagrams.toss_tree import TreeNode
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.validation import FloatArray

_XYZ: Final = "xyz"


MAX_POINTS: Final = 2000
"""Points of the line that a toss is drawn as."""


def draw_toss(axes: Axes, toss: Toss | TossAnswer, shape: Shape, *, across: str = "x", up: str = "z") -> None:
    """Draw a toss seen along one of the world's axes: path, strikes, pose at the end, other ways, samples.

    Args:
        axes: where to draw.
        toss: the toss, or the answer to a question about one.
        shape: the body's shape, for its outline.
        across: the world's axis, "x", "y" or "z", to the right.
        up: the one upwards.
    """
    columns = [_XYZ.index(across), _XYZ.index(up)]
    if isinstance(toss, Toss):
        events, told = toss.events, None
        paths = [each.at(np.linspace(0.0, each.seconds, MAX_POINTS)) for each in (toss, *toss.alternatives)]
    else:
        events, told = toss.toss.events, toss.distribution
        paths = [path.trajectory for path in toss.paths]
    if told is not None:
        for k, line in enumerate(fan_of(told)):
            axes.plot(
                *line[:, columns].T,
                color=colors.SKY,
                linewidth=0.5,
                marker=".",
                markersize=2.0,
                label="samples" if k == 0 else None,
                gid=f"sample_{k}",
            )
        ghosts = told.ghosts
        for i in np.flatnonzero(ghosts.strikes == 0).tolist():
            _draw_outline(axes, shape, (ghosts.p_WB_W[i], ghosts.q_WB[i]), columns, color=colors.SKY)
    for k, trajectory in enumerate(paths):
        color, width = (colors.BLACK, 1.4) if k == 0 else (colors.ORANGE, 0.9)
        axes.plot(
            *trajectory.p_WB_W[:, columns].T,
            color=color,
            linewidth=width,
            zorder=3.0 if k == 0 else 2.5,
            label={0: "the toss", 1: "other ways"}.get(k),
            gid=f"path_{k}",
        )
        _draw_outline(axes, shape, (trajectory.p_WB_W[-1], trajectory.q_WB[-1]), columns, color=color)
    strikes = [event for event in events if event.kind == TossEventKind.STRIKES]
    points = np.array([point for event in strikes for point in event.p_WC_W]).reshape(-1, 3)
    right, above = points[:, columns].T
    axes.scatter(right, above, s=14.0, color=colors.RED, zorder=3, label="strikes", gid="strikes")
    axes.set_xlabel(f"{across}, m")
    axes.set_ylabel(f"{up}, m")
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(visible=True, color=colors.AXIS, linewidth=0.6)
    legend_beside(axes)


def draw_event_tree(axes: Axes, told: TossDistribution) -> None:
    """Draw the tree of the next strikes over time: 50 and 90 % of the times of each, and its probability."""
    from matplotlib.lines import Line2D

    nodes = tree_of(told)
    heights = {-1: 0.0, **{k: -float(row) for row, k in enumerate(_each_after_its_parent(nodes))}}
    for k, node in enumerate(nodes):
        time = node.regions.seconds
        deviation = float(np.sqrt(time.covariance[0, 0]))
        middle, (half, most) = float(time.mean[0]), (deviation * time.radii).tolist()
        before = 0.0 if node.parent < 0 else float(nodes[node.parent].regions.seconds.mean[0])
        width = 0.5 + 3.0 * node.probability
        axes.plot(
            [before, middle],
            [heights[node.parent], heights[k]],
            color=colors.GREY,
            linewidth=width,
            zorder=1,
            gid=f"branch_{k}",
        )
        _draw_interval(axes, middle, most, heights[k], color=colors.SKY, name=f"90_{k}")
        _draw_interval(axes, middle, half, heights[k], color=colors.BLUE, name=f"50_{k}")
        axes.annotate(node.text, (middle, heights[k]), xytext=(0, 7), textcoords="offset points", ha="center")
    rows = len(nodes)
    if told.rest is not None:
        low, quarter, middle, three, high = told.rest.seconds.tolist()
        axes.plot([low, high], [-rows, -rows], color=colors.SKY, linewidth=5.0, gid="rest_90")
        axes.plot([quarter, three], [-rows, -rows], color=colors.BLUE, linewidth=5.0, gid="rest_50")
        text = rest_in_words(told)
        axes.annotate(text, (middle, -rows), xytext=(0, 7), textcoords="offset points", ha="center")
        rows += 1
    axes.axvline(0.0, color=colors.BLACK, linewidth=0.8, zorder=0, gid="state")
    axes.set_ylim(-rows + 0.3, 1.2)
    axes.margins(x=0.25)
    axes.set_yticks([])
    axes.set_xlabel("time after the state, s")
    axes.set_title(f"what {told.samples} samples do next")
    shares = [Line2D([], [], color=color, linewidth=5.0) for color in (colors.BLUE, colors.SKY)]
    legend_beside(axes, handles=shares, labels=["half of the times", "nine tenths"])
    axes.grid(visible=True, axis="x", color=colors.AXIS, linewidth=0.6)


def _each_after_its_parent(nodes: list[TreeNode], parent: int = -1) -> list[int]:
    """Return the indices of the nodes that follow one, each right before those that follow it."""
    return [
        index
        for k, node in enumerate(nodes)
        if node.parent == parent
        for index in (k, *_each_after_its_parent(nodes, k))
    ]


def _draw_interval(axes: Axes, middle: float, half: float, height: float, *, color: str, name: str) -> None:
    ends = [middle - half, middle + half]
    axes.plot(ends, [height, height], color=color, linewidth=5.0, gid=f"time_{name}")


def _draw_outline(
    axes: Axes, shape: Shape, pose: tuple[FloatArray, FloatArray], columns: list[int], *, color: str
) -> None:
    p_WB_W, q_WB = pose
    edges = p_WB_W + shape.edges_B @ rotation_matrix(q_WB).T
    for edge in edges[:, :, columns]:
        axes.plot(*edge.T, color=color, linewidth=0.5, zorder=1)
