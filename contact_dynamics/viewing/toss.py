"""Draws a whole toss: its path with strikes and the resting pose, other ways, and the fan of samples.

The fan has outlines of the body where samples strike and rest, and the tree of the next strikes: a node at
the mean place of each, with a line up to its number, corner and probability, and an ellipsoid with nine
tenths of the places.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np
import rerun as rr

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.toss_tree import fan_of, rest_in_words, tree_of
from contact_dynamics.toss import TossEnd, TossEventKind
from contact_dynamics.viewing.entities import toss_entity
from contact_dynamics.viewing.scene import solid
from contact_dynamics.viewing.strips import strips_3d
from contact_dynamics.viewing.trajectory import outline

if TYPE_CHECKING:
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.toss.distribution import Region
    from contact_dynamics.validation import FloatArray

MAX_OUTLINES: Final = 4
"""Outlines of the body along the toss, at its first strikes. Many small rebounds follow at nearly one place.
"""

MAX_STRIKING: Final = 6
"""Samples whose strikes have outlines. More would hide the toss."""

_PATH: Final = -2.0  # a negative size is in points of the screen
_OTHER: Final = -1.2
_THIN: Final = -0.6
_POINT: Final = -4.0
_LABELS_APART: Final = 0.55  # relative to the body's size, so that labels do not hide each other


def draw_toss(recording: rr.RecordingStream, shape: Shape, answer: TossAnswer, *, up_W: FloatArray) -> None:
    """Draw a toss at the recording's current time, in place of an earlier one of the body.

    Labels are above what they name: ``up_W``, (3,), is the unit vector up.
    """
    path = toss_entity(answer.body_name)
    _draw_toss(recording, path, shape, answer)
    _draw_other_ways(recording, f"{path}/other_ways", shape, answer)
    told = answer.distribution
    if told is None:
        for name in ("samples", "tree"):
            recording.log(f"{path}/{name}", rr.Clear(recursive=True))
        return
    _draw_fan(recording, f"{path}/samples", shape, told)
    _draw_tree(recording, f"{path}/tree", told, lift_W=_LABELS_APART * shape.size * up_W)


def _draw_toss(recording: rr.RecordingStream, path: str, shape: Shape, answer: TossAnswer) -> None:
    went = answer.toss
    trajectory = went.trajectory
    recording.log(
        f"{path}/path", rr.LineStrips3D(strips_3d([trajectory.p_WB_W]), colors=palette.PREDICTED, radii=_PATH)
    )
    strikes = [event for event in went.events if event.kind == TossEventKind.STRIKES]
    points = np.array([point for event in strikes for point in event.p_WC_W]).reshape(-1, 3)
    recording.log(f"{path}/strikes", rr.Points3D(points, colors=palette.IMPACT, radii=_POINT))
    edges = [
        edge
        for event in strikes[:MAX_OUTLINES]
        for edge in outline(shape, event.state.p_WB_W, event.state.q_WB)
    ]
    recording.log(f"{path}/outlines", rr.LineStrips3D(strips_3d(edges), colors=palette.IMPACT, radii=_OTHER))
    begin = list(outline(shape, trajectory.p_WB_W[0], trajectory.q_WB[0]))
    recording.log(f"{path}/begin", rr.LineStrips3D(strips_3d(begin), colors=palette.PREDICTED, radii=_OTHER))
    last_p, last_q = trajectory.p_WB_W[-1], trajectory.q_WB[-1]
    end = list(outline(shape, last_p, last_q))
    recording.log(f"{path}/end", rr.LineStrips3D(strips_3d(end), colors=palette.PREDICTED, radii=_PATH))
    recording.log(f"{path}/rest", rr.Transform3D(translation=last_p, quaternion=last_q))
    faces = solid(shape, palette.translucent(palette.PREDICTED, 0.25))
    rests = went.end == TossEnd.RESTS
    recording.log(f"{path}/rest/faces", faces if rests else rr.Clear(recursive=False))


def _draw_other_ways(recording: rr.RecordingStream, path: str, shape: Shape, answer: TossAnswer) -> None:
    """Draw where else the body may go, where mechanics does not decide, and how it ends there."""
    ways = [other.trajectory for other in answer.alternatives]
    lines = [way.p_WB_W for way in ways]
    lines += [edge for way in ways for edge in outline(shape, way.p_WB_W[-1], way.q_WB[-1])]
    recording.log(path, rr.LineStrips3D(strips_3d(lines), colors=palette.UNDECIDED, radii=_THIN))


def _draw_fan(recording: rr.RecordingStream, path: str, shape: Shape, told: TossDistribution) -> None:
    ghosts = told.ghosts
    color = palette.translucent(palette.PREDICTED, 0.3)
    recording.log(f"{path}/ways", rr.LineStrips3D(strips_3d(fan_of(told)), colors=color, radii=_THIN))
    for name, chosen, shown in (
        (
            "strikes",
            (ghosts.strikes > 0) & (ghosts.samples < MAX_STRIKING),
            palette.translucent(palette.IMPACT, 0.35),
        ),
        ("rests", ghosts.strikes == 0, color),
    ):
        edges = [
            edge for i in np.flatnonzero(chosen) for edge in outline(shape, ghosts.p_WB_W[i], ghosts.q_WB[i])
        ]
        recording.log(f"{path}/{name}", rr.LineStrips3D(strips_3d(edges), colors=shown, radii=_THIN))


def _draw_tree(
    recording: rr.RecordingStream, path: str, told: TossDistribution, *, lift_W: FloatArray
) -> None:
    nodes = tree_of(told)
    places = [node.regions.position.mean for node in nodes]
    followed = [(k, node) for k, node in enumerate(nodes) if node.parent >= 0]
    lines = [np.vstack([places[node.parent], places[k]]) for k, node in followed]
    widths = [-0.5 - 3.0 * node.probability for _, node in followed]
    recording.log(
        f"{path}/branches", rr.LineStrips3D(strips_3d(lines), colors=palette.AFTER_IMPACT, radii=widths)
    )
    texts, regions = [node.text for node in nodes], [node.regions.position for node in nodes]
    if told.rest is not None:
        places.append(told.rest.position.mean)
        texts.append(rest_in_words(told))
        regions.append(told.rest.position)
    recording.log(f"{path}/nodes", rr.Points3D(places, colors=palette.AFTER_IMPACT, radii=_POINT))
    # The first strikes have the highest labels, since what follows is nearly at one place.
    raised = [place + (len(places) + 1 - k) * lift_W for k, place in enumerate(places)]
    labels = rr.Points3D(
        raised, colors=palette.AFTER_IMPACT, radii=_THIN, labels=texts, show_labels=bool(texts)
    )
    recording.log(f"{path}/labels", labels)
    leaders = [np.vstack(ends) for ends in zip(places, raised, strict=True)]
    faint = palette.translucent(palette.AFTER_IMPACT, 0.5)
    recording.log(f"{path}/leaders", rr.LineStrips3D(strips_3d(leaders), colors=faint, radii=_THIN))
    recording.log(f"{path}/regions", _ellipsoids(regions) if regions else rr.Clear(recursive=False))


def _ellipsoids(regions: list[Region]) -> rr.Ellipsoids3D:
    """Return the ellipsoids in which nine tenths of the places of the centre of mass are."""
    from scipy.spatial.transform import Rotation

    variances, axes_W = np.linalg.eigh(np.array([region.covariance for region in regions]))
    right_handed = axes_W * np.linalg.det(axes_W)[:, None, None]
    radii = np.array([region.radii[1] for region in regions])
    return rr.Ellipsoids3D(
        centers=[region.mean for region in regions],
        half_sizes=radii[:, None] * np.sqrt(np.maximum(variances, 0.0)),
        quaternions=[rr.Quaternion(xyzw=turn) for turn in Rotation.from_matrix(right_handed).as_quat()],
        colors=palette.AFTER_IMPACT,
        line_radii=_THIN,
        fill_mode=rr.components.FillMode.MajorWireframe,
    )
