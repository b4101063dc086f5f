# SPDX-License-Identifier: Apache-2.0
"""Arranges the views: the scene with its eye, impulse space, curves over time, and answers in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
import rerun.blueprint as rrb

from contact_dynamics.diagrams import palette
from contact_dynamics.diagrams.contact_scene import mode_names
from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.viewing.drawing import EYE, TARGET
from contact_dynamics.viewing.entities import (
    ANGULAR_MOMENTUM,
    ANGULAR_VELOCITY,
    ANSWER_LOG,
    ANSWERS,
    CONTACTS,
    ENERGY,
    ERROR,
    FORCE_DUAL,
    HEIGHT,
    IMPACTS,
    IMPULSE_SPACE,
    IMPULSE_SPACE_IN_3D,
    LEGEND,
    MANY,
    MODE_MAP,
    MOMENTUM,
    NEWEST_ANSWERS,
    ORDER,
    PLANAR_MODES,
    POINSOT,
    PREDICTED,
    SCENE,
    SINCE_START,
    SPEED,
    SUMMARY,
    TIMELINE,
    TOSSES,
    WHOSE,
    contacts_entity,
    trail_entity,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from contact_dynamics.validation import FloatArray

LOWEST_DISTANCE: Final = 0.3
"""m. The eye stays at least this far from what it looks at."""

NO_TRAVEL: Final = 1e-3
"""m. A path that is shorter than this, seen from above, has no sides to choose between."""

STRAIGHT: Final = 0.01
"""Relative to the length of a path. A path that bulges by less counts as straight, and the eye looks at it
from its right."""

WINDOW_S: Final = 10.0
"""s. How long trails stay in view, and how far back the curves go."""

WINDOW_STEPS: Final = 1000
"""Steps. The same on the timeline of events."""

DIAGRAMS: Final = {
    IMPULSE_SPACE: "Impulse space",
    IMPULSE_SPACE_IN_3D: "Impulse space in 3-D",
    MODE_MAP: "Mode map",
    FORCE_DUAL: "Force dual",
    PLANAR_MODES: "Contact modes",
    POINSOT: "Poinsot",
}
"""The diagrams. Each has a tab beside the scene once there is something to see, and the first is open."""

COLORS_IN_WORDS: Final = "solid: measured, orange: predicted, red: impact, violet: friction cone"
"""The short legend, in the title of each scene."""

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


def eye_on(path_W: FloatArray, *, about_W: FloatArray, up_W: FloatArray, margin: float) -> Eye:
    """Return an eye that sees points, (k, 3), m, world, and ``margin``, m, about them.

    It looks across a path, (n, 3), m, from the side that the path bulges to.
    """
    low, high = about_W.min(axis=0), about_W.max(axis=0)
    target = 0.5 * (low + high)
    level = path_W - np.outer(path_W @ up_W, up_W)
    travel = level[-1] - level[0]
    side = np.cross(travel, up_W) if float(np.linalg.norm(travel)) > NO_TRAVEL else -tangents_near_x(up_W)[1]
    side = side / np.linalg.norm(side)
    bulge = float((level.mean(axis=0) - 0.5 * (level[0] + level[-1])) @ side)
    if bulge < -STRAIGHT * float(np.linalg.norm(travel)):
        side = -side
    distance = max(LOWEST_DISTANCE, _DISTANCE * float(np.linalg.norm(high - low + margin)))
    return Eye(position_W=target + distance * (side + _ELEVATION * up_W), target_W=target, up_W=up_W)


def make_blueprint(
    body_names: Sequence[str], *, eye: Eye | None, shown: Collection[str] = ()
) -> rrb.Blueprint:
    """Return the arrangement of the views: a page for each question that was asked, and an overview.

    Args:
        body_names: names of the bodies whose trails stay in view.
        eye: the eye of the scenes. If it is None, the viewer looks at all that there is.
        shown: what there is to see, of `DIAGRAMS`, `ERROR`, `ENERGY`, and the entities `PREDICTED`,
            `IMPACTS`, `CONTACTS`, `TOSSES`, `MANY` and `ANSWERS`. What is not among it has no panel.
    """
    pages = [_overview(_scene("Scene", body_names, eye), shown)]
    if PREDICTED in shown:
        scene = _scene("Flight", body_names, eye, without=_all_but(PREDICTED))
        curves = [_height(), _speed(), *([_error()] if ERROR in shown else [])]
        pages.append(_page("Flight", scene, [_diagram(POINSOT)] if POINSOT in shown else [], curves))
    if IMPACTS in shown:
        left: rrb.Spatial3DView | rrb.Vertical = _scene(
            "Impact", body_names, eye, without=_all_but(IMPACTS, PREDICTED)
        )
        spaces = [_diagram(IMPULSE_SPACE)] if IMPULSE_SPACE in shown else []
        if IMPULSE_SPACE_IN_3D in shown:
            left = rrb.Vertical(left, _diagram(IMPULSE_SPACE_IN_3D), row_shares=[3, 2])
        pages.append(_page("Impact", left, spaces, [_speed(), _told()]))
    if CONTACTS in shown:
        scene = _scene("Contacts", body_names, eye, without=_all_but(CONTACTS))
        diagrams = [_diagram(PLANAR_MODES)] if PLANAR_MODES in shown else []
        wrenches = [_diagram(origin) for origin in (MODE_MAP, FORCE_DUAL) if origin in shown]
        charts = [*diagrams, *([rrb.Tabs(*wrenches, active_tab=0)] if wrenches else [])]
        pages.append(_page("Contact modes", scene, charts, [_told()]))
    if TOSSES in shown:
        scene = _scene("Toss", body_names, eye, without=_all_but(TOSSES))
        pages.append(_page("Toss", scene, [], [_height(), _speed(), _told()]))
    if MANY in shown:
        scene = _scene("Many states", body_names, eye, without=_all_but(MANY))
        pages.append(_page("Many states", scene, [], [_told()]))
    if ENERGY in shown:
        scene = _scene("Motion", body_names, eye, without=_all_but(PREDICTED))
        whose = rrb.TextDocumentView(origin=WHOSE, name="Whose curves")
        pages.append(_page("Energy and momentum", scene, [], _of_one_body(), words=[whose]))
    pages.append(_words(shown))
    return rrb.Blueprint(
        rrb.Tabs(*pages, active_tab=0),
        rrb.BlueprintPanel(state=rrb.PanelState.Collapsed),
        rrb.SelectionPanel(state=rrb.PanelState.Collapsed),
        rrb.TimePanel(state=rrb.PanelState.Collapsed, timeline=TIMELINE, play_state="Following"),
    )


def _all_but(*drawn: str) -> list[str]:
    """Return what is drawn of answers in the scene and belongs to other pages."""
    return [each for each in (PREDICTED, IMPACTS, CONTACTS, TOSSES, MANY) if each not in drawn]


def _overview(scene: rrb.Spatial3DView, shown: Collection[str]) -> rrb.Horizontal:
    """Return the page that opens first: a large scene, a diagram, a curve, the newest answer in a line."""
    views = [_diagram(origin) for origin in DIAGRAMS if origin in shown]
    diagrams = [rrb.Tabs(*views, active_tab=0)] if views else []
    curve = _error() if ERROR in shown else _height()
    aside = rrb.Vertical(*diagrams, curve, row_shares=[3] * len(diagrams) + [2])
    main: rrb.Spatial3DView | rrb.Vertical = scene
    if ANSWERS in shown:
        summary = rrb.TextDocumentView(origin=SUMMARY, name="Newest answer")
        main = rrb.Vertical(scene, summary, row_shares=[7, 1])
    return rrb.Horizontal(main, aside, column_shares=[3, 2], name="Overview")


def _words(shown: Collection[str]) -> rrb.Horizontal:
    words: list[rrb.View] = []
    if ANSWERS in shown:
        words = [_told(), rrb.TextLogView(origin=ANSWER_LOG, name="All answers")]
    legend = rrb.TextDocumentView(origin=LEGEND, name="Legend")
    return rrb.Horizontal(*([rrb.Vertical(*words)] if words else []), legend, name="Answers and legend")


def _page(
    name: str,
    scene: rrb.Spatial3DView | rrb.Vertical,
    diagrams: Sequence[rrb.View | rrb.Tabs],
    below: Sequence[rrb.View],
    *,
    words: Sequence[rrb.View] = (),
) -> rrb.Horizontal:
    """Return a page: the scene on the left, on the right a few words, diagrams and what stands below them.

    Two diagrams need all of the height, so that their words are apart. Then the rest is below the scene.
    """
    if len(diagrams) > 1:
        scene, below = rrb.Vertical(scene, *below, row_shares=[5] + [1] * len(below)), ()
    shares = [1] * len(words) + [4] * len(diagrams) + [2] * len(below)
    aside = rrb.Vertical(*words, *diagrams, *below, row_shares=shares)
    return rrb.Horizontal(scene, aside, column_shares=[1 if diagrams else 2, 1], name=name)


def _scene(
    name: str, body_names: Sequence[str], eye: Eye | None, *, without: Sequence[str] = ()
) -> rrb.Spatial3DView:
    controls = None
    if eye is not None:
        controls = rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital, position=eye.position_W, look_target=eye.target_W, eye_up=eye.up_W
        )
    return rrb.Spatial3DView(
        origin="/",
        contents=[f"+ {SCENE}/**", *(f"- {part}/**" for part in without)],
        name=f"{name} ({COLORS_IN_WORDS})",
        background=rrb.Background(color=palette.BACKGROUND, kind=rrb.BackgroundKind.SolidColor),
        line_grid=False,
        eye_controls=controls,
        overrides={
            **{trail_entity(name): _window() for name in body_names},
            **{
                f"{contacts_entity(name)}/{mode}": rrb.EntityBehavior(visible=False)
                for name in body_names
                for mode in mode_names()[1:]
                if CONTACTS not in without  # each costs 3 kB, in every arrangement that is sent
            },
        },
    )


def _height() -> rrb.TimeSeriesView:
    return _curves(HEIGHT, "Height, m (thin: predicted)")


def _speed() -> rrb.TimeSeriesView:
    return _curves(SPEED, "Speed, m/s (thin: predicted)")


def _of_one_body() -> list[rrb.View]:
    return [
        _curves(ENERGY, "Energy, J (thin: predicted)"),
        _curves(MOMENTUM, "Momentum, kg m/s (thin: predicted)"),
        _curves(ANGULAR_MOMENTUM, "Angular momentum, kg m²/s (thin: predicted)"),
        _curves(ANGULAR_VELOCITY, "Angular velocity, rad/s (thin: predicted)"),
    ]


def _error() -> rrb.TimeSeriesView:
    return _curves(ERROR, "Error of the predicted position, m")


def _told() -> rrb.TextDocumentView:
    return rrb.TextDocumentView(origin=NEWEST_ANSWERS, name="Newest answers")


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


def impulse_space_in_3d_view() -> rrb.Spatial3DView:
    """Return the view of impulse space in three dimensions, with the normal impulse upwards."""
    return rrb.Spatial3DView(
        origin=IMPULSE_SPACE_IN_3D,
        name=DIAGRAMS[IMPULSE_SPACE_IN_3D],
        background=rrb.Background(color=palette.BACKGROUND, kind=rrb.BackgroundKind.SolidColor),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            kind=rrb.Eye3DKind.Orbital,
            position=EYE,
            look_target=TARGET,
            eye_up=(0, 0, 1),
        ),
    )


def _diagram(origin: str) -> rrb.Spatial2DView | rrb.Spatial3DView:
    if origin == POINSOT:
        return poinsot_view()
    if origin == IMPULSE_SPACE_IN_3D:
        return impulse_space_in_3d_view()
    return rrb.Spatial2DView(origin=origin, name=DIAGRAMS[origin], background=palette.BACKGROUND)


def _curves(origin: str, name: str) -> rrb.TimeSeriesView:
    # A legend would hide curves. The name says what is thin, and bodies have their colours in the scene.
    legend = rrb.PlotLegend(visible=False)
    return rrb.TimeSeriesView(origin=origin, name=name, plot_legend=legend, time_ranges=_window())


def _window() -> rrb.VisibleTimeRanges:
    now = rrb.TimeRangeBoundary.cursor_relative()
    ago = rrb.TimeRangeBoundary.cursor_relative(seconds=-WINDOW_S)
    steps_ago = rrb.TimeRangeBoundary.cursor_relative(seq=-WINDOW_STEPS)
    begins = ((TIMELINE, ago), (SINCE_START, ago), (ORDER, steps_ago))
    return rrb.VisibleTimeRanges(
        [rrb.VisibleTimeRange(timeline, start=begin, end=now) for timeline, begin in begins]
    )


FAR: Final = 20.0
"""Relative to the extent of what is looked at, or to `LOWEST_DISTANCE` if that is more. A body that is
farther from it is not looked at, because nothing else could be made out any more."""


def near_most(points_W: FloatArray) -> FloatArray:
    """Return those of some points, (n, 3), m, that are not far from most of them."""
    with np.errstate(over="ignore"):  # a distance that overflows is far
        distances = np.linalg.norm(points_W - np.median(points_W, axis=0), axis=1)
    reach = FAR * max(LOWEST_DISTANCE, float(np.median(distances)))
    return np.asarray(points_W[distances <= reach])


class Framing:
    """Turns the eye to the first predicted path and the bodies that are not far from it.

    It turns again only when a neighbour comes that is out of sight.
    """

    def __init__(self, up_W: FloatArray) -> None:
        """Look at nothing yet. ``up_W`` is (3,), unit, world axes."""
        self._up_W = up_W
        self._first_W: dict[str, FloatArray] = {}  # where each body was first seen, (3,), m
        self._path_W: FloatArray | None = None
        self._margin = 0.0
        self._low_W, self._high_W = np.zeros(3), np.zeros(3)  # what is in sight

    @property
    def center_W(self) -> FloatArray:
        """The middle of what is in sight, (3,), m."""
        return 0.5 * (self._low_W + self._high_W)

    @property
    def extent(self) -> float:
        """The extent of what is in sight with its margin, m."""
        return float(np.linalg.norm(self._high_W - self._low_W)) + self._margin

    def turn_to(self, path_W: FloatArray, *, margin: float) -> Eye:
        """Return the eye that looks at a path, (n, 3), m, and the bodies about it, and has a margin, m."""
        self._path_W, self._margin = path_W, margin
        low, high = path_W.min(axis=0), path_W.max(axis=0)
        reach = FAR * max(LOWEST_DISTANCE, float(np.linalg.norm(high - low + margin)))
        near = [p_W for p_W in self._first_W.values() if np.linalg.norm(p_W - 0.5 * (low + high)) <= reach]
        in_sight_W = np.vstack([path_W, *near])
        self._low_W, self._high_W = in_sight_W.min(axis=0), in_sight_W.max(axis=0)
        return eye_on(path_W, about_W=in_sight_W, up_W=self._up_W, margin=margin)

    def add_body(self, name: str, p_WB_W: FloatArray) -> Eye | None:
        """Note where a new body is first seen, (3,), m.

        Return the eye that sees it too, if it is out of sight and not far.
        """
        self._first_W[name] = p_WB_W
        if self._path_W is None:
            return None
        outside = np.maximum(self._low_W - p_WB_W, p_WB_W - self._high_W)
        if np.all(outside <= self._margin):
            return None
        before = self._low_W, self._high_W
        eye = self.turn_to(self._path_W, margin=self._margin)
        return None if np.array_equal(before, (self._low_W, self._high_W)) else eye
