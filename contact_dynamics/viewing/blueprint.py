"""Arranges the views: the scene, impulse space, curves over time, and answers in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun.blueprint as rrb

from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.viewing import contact_modes, impact, palette, trajectory
from contact_dynamics.viewing.entities import (
    ANSWER_LOG,
    HEIGHT,
    IMPULSE_SPACE,
    LEGEND,
    MODE_MAP,
    NEWEST_ANSWERS,
    PLANAR_MODES,
    POINSOT,
    SCENE,
    SPEED,
    TIMELINE,
    contacts_entity,
    impact_entity,
    predicted_entity,
    trail_entity,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray

LOWEST_DISTANCE: Final = 0.5
"""m. The eye stays at least this far from what it looks at."""

NO_TRAVEL: Final = 1e-3
"""m. A path that is shorter than this, seen from above, has no sides to choose between."""

STRAIGHT: Final = 0.01
"""Relative to the length of a path. A path that bulges by less counts as straight, and the eye looks at it
from its right."""

WINDOW_S: Final = 10.0
"""s. How long trails and earlier predictions stay in view, and how far back the curves go."""

DIAGRAMS: Final = {
    IMPULSE_SPACE: "Impulse space",
    MODE_MAP: "Mode map",
    PLANAR_MODES: "Contact modes",
    POINSOT: "Poinsot",
}
"""The diagrams. Each has a tab beside the scene once there is something to see, and the first is open."""

_DISTANCE: Final = 1.0  # distance of the eye, relative to the diagonal of what it shows
_ELEVATION: Final = 0.33  # height of the eye above what it looks at, relative to its horizontal distance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Eye:
    """The place from which the viewer looks at the scene.

    Attributes:
        position_W: (3,), m, world.
        target_W: (3,), m, world.
        up_W: (3,), unit, world axes.
    """

    position_W: FloatArray
    target_W: FloatArray
    up_W: FloatArray


def eye_on(points_W: FloatArray, *, up_W: FloatArray, margin: float) -> Eye:
    """Return an eye that sees a path, (n, 3), m, world, and ``margin``, m, about it.

    It looks across the path, from the side that the path bulges to.
    """
    low, high = points_W.min(axis=0), points_W.max(axis=0)
    target = 0.5 * (low + high)
    level = points_W - np.outer(points_W @ up_W, up_W)
    travel = level[-1] - level[0]
    side = np.cross(travel, up_W) if float(np.linalg.norm(travel)) > NO_TRAVEL else -tangents_near_x(up_W)[1]
    side = side / np.linalg.norm(side)
    bulge = float((level.mean(axis=0) - 0.5 * (level[0] + level[-1])) @ side)
    if bulge < -STRAIGHT * float(np.linalg.norm(travel)):
        side = -side
    distance = max(LOWEST_DISTANCE, _DISTANCE * float(np.linalg.norm(high - low + margin)))
    return Eye(position_W=target + distance * (side + _ELEVATION * up_W), target_W=target, up_W=up_W)


def make_blueprint(
    body_names: Sequence[str], *, eye: Eye | None, diagrams: Sequence[str] = ()
) -> rrb.Blueprint:
    """Return the arrangement of the views.

    Args:
        body_names: names of the bodies whose trails and predictions stay in view.
        eye: the eye of the scene. If it is None, the viewer looks at all that there is.
        diagrams: the `DIAGRAMS` in which there is something to see.
    """
    controls = None
    if eye is not None:
        controls = rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=eye.position_W, look_target=eye.target_W, eye_up=eye.up_W
        )
    scene = rrb.Spatial3DView(
        origin="/",
        contents=f"{SCENE}/**",
        name="Scene",
        background=rrb.Background(color=palette.BACKGROUND, kind=rrb.BackgroundKind.SolidColor),
        line_grid=False,
        eye_controls=controls,
        overrides={
            **{path: _window() for name in body_names for path in _recent(name)},
            **{
                f"{contacts_entity(name)}/{mode}": rrb.EntityBehavior(visible=False)
                for name in body_names
                for mode in contact_modes.mode_names()[1:]
            },
        },
    )
    tabs = []
    if diagrams:
        views = [_diagram(origin) for origin in DIAGRAMS if origin in diagrams]
        tabs = [rrb.Tabs(*views, active_tab=0)]
    curves = [
        _curves(HEIGHT, "Height of the centre of mass, m"),
        _curves(SPEED, "Speed of the centre of mass, m/s"),
    ]
    answers = rrb.Tabs(
        rrb.TextDocumentView(origin=NEWEST_ANSWERS, name="Newest answers"),
        rrb.TextLogView(origin=ANSWER_LOG, name="All answers"),
        rrb.TextDocumentView(origin=LEGEND, name="Legend"),
    )
    return rrb.Blueprint(
        rrb.Horizontal(
            scene,
            rrb.Vertical(*tabs, *curves, answers, row_shares=[5] * len(tabs) + [2, 2, 3]),
            column_shares=[3, 2],
        ),
        rrb.BlueprintPanel(state=rrb.PanelState.Collapsed),
        rrb.SelectionPanel(state=rrb.PanelState.Collapsed),
        rrb.TimePanel(state=rrb.PanelState.Collapsed, timeline=TIMELINE, play_state="Following"),
    )


def poinsot_view() -> rrb.Spatial3DView:
    """Return the view of Poinsot's picture, with the invariable plane below."""
    return rrb.Spatial3DView(
        origin=POINSOT,
        name="Poinsot",
        background=rrb.Background(color=palette.BACKGROUND, kind=rrb.BackgroundKind.SolidColor),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=(1.35, -1.65, 0.55),
            look_target=(0.0, 0.0, -0.25),
            eye_up=(0, 0, 1),
        ),
    )


def _diagram(origin: str) -> rrb.Spatial2DView | rrb.Spatial3DView:
    if origin == POINSOT:
        return poinsot_view()
    return rrb.Spatial2DView(origin=origin, name=DIAGRAMS[origin], background=palette.BACKGROUND)


def _curves(origin: str, name: str) -> rrb.TimeSeriesView:
    legend = rrb.PlotLegend(corner=rrb.Corner2D.RightTop)
    return rrb.TimeSeriesView(origin=origin, name=name, plot_legend=legend, time_ranges=_window())


def _recent(body_name: str) -> list[str]:
    """Return what stays in view beside what comes after it."""
    return [
        trail_entity(body_name),
        *(f"{predicted_entity(body_name)}/{name}" for name in trajectory.RECENT),
        *(f"{impact_entity(body_name)}/{name}" for name in impact.RECENT),
    ]


def _window() -> rrb.VisibleTimeRanges:
    return rrb.VisibleTimeRanges(
        timeline=TIMELINE,
        start=rrb.TimeRangeBoundary.cursor_relative(seconds=-WINDOW_S),
        end=rrb.TimeRangeBoundary.cursor_relative(),
    )
