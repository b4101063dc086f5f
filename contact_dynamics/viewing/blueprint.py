# SPDX-License-Identifier: Apache-2.0
"""Lays out the views: the scene with its eye, impulse space, curves over time, and answers in words."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, NamedTuple

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
    TRAILS,
    WHOSE,
    entity,
)

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.validation import FloatArray

LOWEST_DISTANCE: Final = 0.3  # m, minimum distance of the eye from its target

NO_TRAVEL: Final = 1e-3
"""m. A path that is shorter than this, seen from above, has no sides to choose between."""

STRAIGHT: Final = 0.01
"""Largest bulge of a straight path, relative to its length. The eye looks at such a path from its right."""

WINDOW_S: Final = 10.0  # s. How long trails stay in view, and how far back the curves go.
WINDOW_STEPS: Final = 1000  # steps. The same on the timeline of events.

DIAGRAMS: Final = {
    IMPULSE_SPACE: "Impulse space",
    IMPULSE_SPACE_IN_3D: "Impulse space in 3-D",
    MODE_MAP: "Mode map",
    FORCE_DUAL: "Force dual",
    PLANAR_MODES: "Contact modes",
    POINSOT: "Poinsot",
}
"""The diagrams. Each has a tab beside the scene once there is something to see, and the first is open."""

_CURVES: Final = {
    HEIGHT: "Height, m (thin: predicted)",
    SPEED: "Speed, m/s (thin: predicted)",
    ERROR: "Error of the predicted position, m",
    ENERGY: "Energy, J (thin: predicted)",
    MOMENTUM: "Momentum, kg m/s (thin: predicted)",
    ANGULAR_MOMENTUM: "Angular momentum, kg m²/s (thin: predicted)",
    ANGULAR_VELOCITY: "Angular velocity, rad/s (thin: predicted)",
}
_WORDS: Final = {
    NEWEST_ANSWERS: "Newest answers",
    SUMMARY: "Newest answer",
    LEGEND: "Legend",
    WHOSE: "Whose curves",
}
_EYES: Final[dict[str, tuple[ArrayLike, ArrayLike]]] = {
    POINSOT: ((1.35, -1.65, 0.55), (0.0, 0.0, -0.25)),
    IMPULSE_SPACE_IN_3D: (EYE, TARGET),
}
_OF_ANSWERS: Final = (PREDICTED, IMPACTS, CONTACTS, TOSSES, MANY)  # the entities of answers in the scenes
BACKGROUND: Final = rrb.Background(color=palette.BACKGROUND, kind=rrb.BackgroundKind.SolidColor)


class _Page(NamedTuple):
    """The contents of a page beside its scene."""

    name: str
    diagrams: tuple[tuple[str, ...], ...] = ()  # tuples become tabs of one panel
    below: tuple[str, ...] = ()
    words: tuple[str, ...] = ()
    scene: str = ""  # its name, by default the page's
    drawn: tuple[str, ...] = ()  # the answers in the scene, by default the page's own
    below_scene: str = ""


_PAGES: Final = {  # the page of each kind of request, by its contents
    PREDICTED: _Page("Flight", ((POINSOT,),), (HEIGHT, SPEED, ERROR)),
    IMPACTS: _Page(
        "Impact",
        ((IMPULSE_SPACE,),),
        (SPEED, NEWEST_ANSWERS),
        drawn=(IMPACTS, PREDICTED),
        below_scene=IMPULSE_SPACE_IN_3D,
    ),
    CONTACTS: _Page(
        "Contact modes", ((PLANAR_MODES,), (MODE_MAP, FORCE_DUAL)), (NEWEST_ANSWERS,), scene="Contacts"
    ),
    TOSSES: _Page("Toss", below=(HEIGHT, SPEED, NEWEST_ANSWERS)),
    MANY: _Page("Many states", below=(NEWEST_ANSWERS,)),
    ENERGY: _Page(
        "Energy and momentum",
        below=(ENERGY, MOMENTUM, ANGULAR_MOMENTUM, ANGULAR_VELOCITY),
        words=(WHOSE,),
        scene="Motion",
        drawn=(PREDICTED,),
    ),
}

COLORS_IN_WORDS: Final = "solid: measured, orange: predicted, red: impact, violet: friction cone"
"""The short legend, in the title of each scene."""

_DISTANCE: Final = 1.0  # distance of the eye, relative to the diagonal of what it shows
_ELEVATION: Final = 0.33  # height of the eye above what it looks at, relative to its horizontal distance


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Eye:
    """The viewpoint of the scene."""

    position_W: FloatArray  # (3,), m, world
    target_W: FloatArray  # (3,), m, world
    up_W: FloatArray  # (3,), unit, world axes


def eye_on(path_W: FloatArray, *, about_W: FloatArray, up_W: FloatArray, margin: float) -> Eye:
    """Return an eye that sees points, (k, 3), m, world, with a ``margin``, m.

    It looks across a path, (n, 3), m, from its convex side.
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
    """Return the layout of the views: a page for each kind of request that was made, and an overview.

    Without an eye, the viewer frames the whole scene. There are panels only for those of `DIAGRAMS`, `ERROR`,
    `ENERGY`, and the entities `PREDICTED`, `IMPACTS`, `CONTACTS`, `TOSSES`, `MANY` and `ANSWERS` that are
    ``shown``.
    """
    pages = [_overview(_scene("Scene", body_names, eye), shown)]
    for kind, page in _PAGES.items():
        if kind in shown:
            scene = _scene(page.scene or page.name, body_names, eye, drawn=page.drawn or (kind,))
            pages.append(_page(page, scene, shown))
    answers = [rrb.Vertical(_view(NEWEST_ANSWERS), _view(ANSWER_LOG))] if ANSWERS in shown else []
    pages.append(rrb.Horizontal(*answers, _view(LEGEND), name="Answers and legend"))
    return rrb.Blueprint(
        rrb.Tabs(*pages, active_tab=0),
        rrb.BlueprintPanel(state=rrb.PanelState.Collapsed),
        rrb.SelectionPanel(state=rrb.PanelState.Collapsed),
        rrb.TimePanel(state=rrb.PanelState.Collapsed, timeline=TIMELINE, play_state="Following"),
    )


def _overview(scene: rrb.Spatial3DView, shown: Collection[str]) -> rrb.Horizontal:
    """Return the page that opens first: a large scene, a diagram, a curve, the newest answer in a line."""
    views = [_view(origin) for origin in DIAGRAMS if origin in shown]
    diagrams = [rrb.Tabs(*views, active_tab=0)] if views else []
    curve = _view(ERROR if ERROR in shown else HEIGHT)
    aside = rrb.Vertical(*diagrams, curve, row_shares=[3] * len(diagrams) + [2])
    main: rrb.Spatial3DView | rrb.Vertical = scene
    if ANSWERS in shown:
        main = rrb.Vertical(scene, _view(SUMMARY), row_shares=[7, 1])
    return rrb.Horizontal(main, aside, column_shares=[3, 2], name="Overview")


def _page(page: _Page, scene: rrb.Spatial3DView, shown: Collection[str]) -> rrb.Horizontal:
    """Return a page: the scene on the left; on the right words, diagrams, and other panels below them.

    Two diagrams need the full height to keep their labels apart; the other panels are then below the scene.
    """
    left: rrb.Spatial3DView | rrb.Vertical = scene
    if page.below_scene in shown:
        left = rrb.Vertical(scene, _view(page.below_scene), row_shares=[3, 2])
    tabs = [[_view(origin) for origin in each if origin in shown] for each in page.diagrams]
    diagrams = [rrb.Tabs(*each, active_tab=0) if len(each) > 1 else each[0] for each in tabs if each]
    below = [_view(origin) for origin in page.below if origin != ERROR or ERROR in shown]
    if len(diagrams) > 1:
        left, below = rrb.Vertical(scene, *below, row_shares=[5] + [1] * len(below)), []
    words = [_view(origin) for origin in page.words]
    shares = [1] * len(words) + [4] * len(diagrams) + [2] * len(below)
    aside = rrb.Vertical(*words, *diagrams, *below, row_shares=shares)
    return rrb.Horizontal(left, aside, column_shares=[1 if diagrams else 2, 1], name=page.name)


def _scene(
    name: str, body_names: Sequence[str], eye: Eye | None, *, drawn: Sequence[str] = _OF_ANSWERS
) -> rrb.Spatial3DView:
    """Return a view of the scene with the drawings of some answers."""
    without = [part for part in _OF_ANSWERS if part not in drawn]
    return rrb.Spatial3DView(
        origin="/",
        contents=[f"+ {SCENE}/**", *(f"- {part}/**" for part in without)],
        name=f"{name} ({COLORS_IN_WORDS})",
        background=BACKGROUND,
        line_grid=False,
        eye_controls=None if eye is None else orbit(eye.position_W, eye.target_W, eye.up_W),
        overrides={
            **{entity(TRAILS, name): _window() for name in body_names},
            **{
                f"{entity(CONTACTS, name)}/{mode}": rrb.EntityBehavior(visible=False)
                for name in body_names
                for mode in mode_names()[1:]
                if CONTACTS in drawn  # each takes 3 kB, in every layout that is sent
            },
        },
    )


def _view(origin: str) -> rrb.View:
    """Return the view of curves, words or a diagram."""
    if origin in _CURVES:
        # A legend would hide curves. The name explains thin curves, and bodies have their colours from the
        # scene.
        legend = rrb.PlotLegend(visible=False)
        name = _CURVES[origin]
        return rrb.TimeSeriesView(origin=origin, name=name, plot_legend=legend, time_ranges=_window())
    if origin in _WORDS:
        return rrb.TextDocumentView(origin=origin, name=_WORDS[origin])
    if origin == ANSWER_LOG:
        return rrb.TextLogView(origin=origin, name="All answers")
    return diagram_view(origin)


def diagram_view(origin: str) -> rrb.Spatial2DView | rrb.Spatial3DView:
    """Return the view of one of `DIAGRAMS`. In space, the third coordinate is upwards."""
    name = DIAGRAMS[origin]
    if origin not in _EYES:
        return rrb.Spatial2DView(origin=origin, name=name, background=palette.BACKGROUND)
    eye = orbit(*_EYES[origin], (0, 0, 1))
    return rrb.Spatial3DView(
        origin=origin, name=name, background=BACKGROUND, line_grid=False, eye_controls=eye
    )


def up_of(gravity_W: FloatArray) -> FloatArray:
    """Return the unit vector against gravity, (3,), or z without gravity."""
    size = float(np.linalg.norm(gravity_W))
    return -gravity_W / size if size > 0.0 else np.array([0.0, 0.0, 1.0])


def orbit(position: ArrayLike, target: ArrayLike, up: ArrayLike) -> rrb.EyeControls3D:
    """Return an eye at a place that looks at a target, with an upward direction, in world axes."""
    return rrb.EyeControls3D(kind=rrb.Eye3DKind.Orbital, position=position, look_target=target, eye_up=up)


def _window() -> rrb.VisibleTimeRanges:
    now = rrb.TimeRangeBoundary.cursor_relative()
    ago = rrb.TimeRangeBoundary.cursor_relative(seconds=-WINDOW_S)
    steps_ago = rrb.TimeRangeBoundary.cursor_relative(seq=-WINDOW_STEPS)
    begins = ((TIMELINE, ago), (SINCE_START, ago), (ORDER, steps_ago))
    return rrb.VisibleTimeRanges(
        [rrb.VisibleTimeRange(timeline, start=begin, end=now) for timeline, begin in begins]
    )


FAR: Final = 20.0
"""Largest distance of a framed body, relative to the extent of the others, or to `LOWEST_DISTANCE` if that is
more. Beyond it, the others would be too small to see."""


def near_most(points_W: FloatArray) -> FloatArray:
    """Return the points, (n, 3), m, without those far from most others."""
    with np.errstate(over="ignore"):  # a distance that overflows is far
        distances = np.linalg.norm(points_W - np.median(points_W, axis=0), axis=1)
    reach = FAR * max(LOWEST_DISTANCE, float(np.median(distances)))
    return np.asarray(points_W[distances <= reach])


class Framing:
    """Turns the eye to the first predicted path and the bodies that are not far from it.

    It turns again only when a body nearby appears out of sight.
    """

    def __init__(self, up_W: FloatArray) -> None:
        """Begin without a target. ``up_W`` is (3,), unit, world axes."""
        self._up_W = up_W
        self._first_W: dict[str, FloatArray] = {}  # first position of each body, (3,), m
        self._path_W: FloatArray | None = None
        self._margin = 0.0
        self._low_W, self._high_W = np.zeros(3), np.zeros(3)  # corners of the box around the points in sight

    @property
    def center_W(self) -> FloatArray:
        """The centre of the points in sight, (3,), m."""
        return 0.5 * (self._low_W + self._high_W)

    @property
    def extent(self) -> float:
        """The extent of the points in sight with the margin, m."""
        return float(np.linalg.norm(self._high_W - self._low_W)) + self._margin

    def turn_to(self, path_W: FloatArray, *, margin: float) -> Eye:
        """Return the eye for a path, (n, 3), m, and the bodies near it, with a margin, m."""
        self._path_W, self._margin = path_W, margin
        low, high = path_W.min(axis=0), path_W.max(axis=0)
        reach = FAR * max(LOWEST_DISTANCE, float(np.linalg.norm(high - low + margin)))
        near = [p_W for p_W in self._first_W.values() if np.linalg.norm(p_W - 0.5 * (low + high)) <= reach]
        in_sight_W = np.vstack([path_W, *near])
        self._low_W, self._high_W = in_sight_W.min(axis=0), in_sight_W.max(axis=0)
        return eye_on(path_W, about_W=in_sight_W, up_W=self._up_W, margin=margin)

    def add_body(self, name: str, p_WB_W: FloatArray) -> Eye | None:
        """Store the first position of a new body, (3,), m.

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
