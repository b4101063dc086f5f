# SPDX-License-Identifier: Apache-2.0
"""Figures of all diagrams of an answer, of what the physics returns (`toss`, `modes`), and single diagrams.

A function for a single diagram takes the axes and then what the function of the diagram takes. The axes of
diagrams in space are those of ``figure.add_subplot(projection="3d")``, which have no type.
"""

from __future__ import annotations

import inspect
from functools import wraps
from typing import TYPE_CHECKING, Any, Concatenate, Final, NamedTuple, ParamSpec

import numpy as np

from contact_dynamics.contact_modes import (
    PlanarContactProblem,
    PlanarModeAnswer,
    SpatialContactProblem,
    SpatialModeAnswer,
)
from contact_dynamics.contact_modes.result import motion_in_words
from contact_dynamics.diagrams import trajectory_curves
from contact_dynamics.diagrams.contact_scene import contact_forces
from contact_dynamics.diagrams.force_dual import force_dual
from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.diagrams.many_states import many_states_marks
from contact_dynamics.diagrams.mode_map import mode_map
from contact_dynamics.diagrams.planar_scene import (
    ModesSideBySide,
    dual_chart_of,
    map_of_answer,
    modes_side_by_side,
    silhouette,
)
from contact_dynamics.diagrams.poinsot import poinsot_diagram
from contact_dynamics.diagrams.shape import NO_FACES, drawn_shape
from contact_dynamics.diagrams.toss_scene import event_tree, toss_marks
from contact_dynamics.plots.drawing import draw_diagram, draw_seen
from contact_dynamics.questions.services import service_of
from contact_dynamics.shapes.convex import NO_SHAPE
from contact_dynamics.tumbling.polhode import Regime
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from contact_dynamics.diagrams.marks import Diagram
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.bodies_contact_modes import BodiesContactModeAnswer
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.services import Answer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.rigid_body.body import HasMassProperties
    from contact_dynamics.shapes.convex import ConvexShape
    from contact_dynamics.toss import Toss, TossDistribution
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body


MAX_MODES: Final = 6  # figures of this many consistent modes are made, the first ones
_LEAST: Final = 0.25  # width and height of a view, relative to the largest
_MARGIN: Final = 0.05  # around what is drawn, relative to its size
_RESOLUTION: Final = 600  # points on a side of the charts of wrenches


class NamedFigure(NamedTuple):
    """A figure and what it shows, in words that suit a file's name."""

    name: str
    figure: Figure


def figures_of(
    answer: Answer,
    *,
    gravity_W: FloatArray,
    body: HasMassProperties | None = None,
    other: HasMassProperties | None = None,
    shape: ConvexShape = NO_SHAPE,
) -> Iterator[NamedFigure]:
    """Yield the figures of an answer. There are none for an answer without a diagram.

    Args:
        answer: The answer.
        gravity_W: (3,), m/s^2, world axes, for the potential energy.
        body: The body, or its mass properties. Without it there are no lines in impulse space, no energies
            and no momenta.
        other: A second body that is struck, or its mass properties.
        shape: The body's shape, for its outline.
    """
    drawn = service_of(answer).figures
    if drawn is not None:
        for name, figure in drawn(answer, gravity_W=gravity_W, body=body, other=other, shape=shape):
            yield NamedFigure(name, figure)  # type: ignore[arg-type]  # it is one, as the record says


def figures_of_many(answer: ManyTumblingsAnswer | ManyImpactsAnswer, **_: object) -> Iterator[NamedFigure]:
    """Yield the states from the side and from above."""
    if len(answer.states) == 0:
        return
    drawn = from_side_and_above(lambda axes, up: draw_many_states(axes, answer, across="x", up=up))
    yield NamedFigure("states", drawn)


def figures_of_toss(answer: TossAnswer, *, shape: ConvexShape, **_: object) -> Iterator[NamedFigure]:
    """Yield the toss from the side and from above, and the tree of its next strikes if it is sampled."""
    outline = drawn_shape(shape)
    drawn = from_side_and_above(lambda axes, up: draw_toss(axes, answer, outline, across="x", up=up))
    yield NamedFigure("toss", drawn)
    if answer.distribution is not None and answer.distribution.branches:
        yield NamedFigure("toss-tree", _figure_of(event_tree(answer.distribution), 9.0, 5.0))


def figures_of_impact(
    answer: ImpactAnswer, *, body: HasMassProperties | None, other: HasMassProperties | None, **_: object
) -> Iterator[NamedFigure]:
    """Yield the main contact in impulse space, in 3D too for an impact in space."""
    if len(answer.impact.path_W) > 0:
        yield NamedFigure("impulse-space", _figure_of(impulse_space(body, answer, other=other)))
        if answer.plane is None:
            in_3d = impulse_space_in_3d(body, answer, other=other)
            yield NamedFigure("impulse-space-in-3d", _figure_of(in_3d, 9.0, 6.0))


def figures_of_tumbling(
    answer: TumblingAnswer, *, body: HasMassProperties | None, gravity_W: FloatArray, **_: object
) -> Iterator[NamedFigure]:
    """Yield the motion over time, and Poinsot's construction if the answer has its curves."""
    trajectory = answer.trajectory
    if len(trajectory) > 0:
        curves = [
            trajectory_curves.position(trajectory, covariance=answer.covariance),
            trajectory_curves.attitude(trajectory),
            trajectory_curves.velocity(trajectory),
            trajectory_curves.angular_velocity(trajectory),
        ]
        if body is not None:
            curves.append(trajectory_curves.momentum(trajectory, body))
            curves.append(trajectory_curves.angular_momentum(trajectory, body))
            curves.append(trajectory_curves.energy(trajectory, body, gravity_W=gravity_W))
        figure = blank_figure(13.0, 11.0)
        figure.suptitle(f"{answer.body_name or 'a body'}: predicted motion")
        for place, diagram in enumerate(curves, start=1):
            draw_diagram(figure.add_subplot(4, 2, place), diagram)
        yield NamedFigure("motion", figure)
    rotation, rolling = answer.poinsot, answer.curves
    if rotation is not None and rolling is not None and rotation.regime is not Regime.AT_REST:
        yield NamedFigure("poinsot", _figure_of(poinsot_diagram(rotation, rolling, answer.state), 8.0, 6.0))


def figures_of_bodies_modes(
    answer: BodiesContactModeAnswer | ContactModeAnswer, **_: object
) -> Iterator[NamedFigure]:
    """Yield the contact forces of each mode."""
    for i, mode in enumerate(answer.modes[:MAX_MODES], start=1):
        forces = contact_forces(answer.contacts, mode, title=f"contact forces in {mode.mode}")
        yield NamedFigure(f"contact-forces-{i}", _figure_of(forces, 7.0))


def figures_of_modes(
    answer: ContactModeAnswer, *, body: HasMassProperties | None, shape: ConvexShape, **_: object
) -> Iterator[NamedFigure]:
    """Yield the contact forces of each mode and, in the plane, the body, the map of modes and force duals."""
    yield from figures_of_bodies_modes(answer)
    plane = answer.plane
    if plane is None:
        return
    outline = silhouette(drawn_shape(shape), plane.axes_W @ answer.state.R_WB)
    view = modes_side_by_side(answer, plane, outline=outline)
    for i, scene in enumerate(view.scenes[:MAX_MODES], start=1):
        yield NamedFigure(f"planar-scene-{i}", _figure_of(scene))
    masses = None if body is None else body.mass_properties
    shown = map_of_answer(answer, plane, body=masses, resolution=_RESOLUTION)
    if shown is None:
        return
    map_of_modes = mode_map(shown.sets, shown.chart, applied=shown.applied, change=shown.change)
    yield NamedFigure("mode-map", _figure_of(map_of_modes, 11.0, 5.0))
    chart = dual_chart_of(view, shown, resolution=_RESOLUTION)
    if chart is None:
        return
    for i, seen in enumerate(view.modes[:MAX_MODES], start=1):
        one = next(one for one in shown.sets if one.mode == seen.mode)
        dual = force_dual(one, view.contacts, chart, outlines=[outline])
        yield NamedFigure(f"force-dual-{i}", _figure_of(dual, 11.0, 5.0))


def from_side_and_above(draw: Callable[[Axes, str], None]) -> Figure:
    """Return a figure with the side view above the top view, which share the x axis and the scale.

    ``draw`` draws into axes; the world's axis upwards is "z" or "y".
    """
    figure = blank_figure(8.0, 8.0)
    views = figure.subplots(2, 1, sharex=True)
    for axes, up in zip(views, "zy", strict=True):
        draw(axes, up)
    limits = [views[0].dataLim.intervalx, *(axes.dataLim.intervaly for axes in views)]
    size = max(high - low for low, high in limits)
    rooms = [max(_MARGIN * (high - low), 0.5 * (_LEAST * size - (high - low))) for low, high in limits]
    if size > 0.0:  # there is a path or a shape
        setters = [views[0].set_xlim, *(axes.set_ylim for axes in views)]
        for set_limits, (low, high), room in zip(setters, limits, rooms, strict=True):
            set_limits(low - room, high + room)
    for axes in views:
        axes.set_aspect("equal", adjustable="box")
        axes.label_outer()
    views[0].get_gridspec().set_height_ratios([float(np.diff(axes.get_ylim())[0]) for axes in views])
    views[1].get_legend().remove()
    return figure


def _figure_of(diagram: Diagram, width: float = 8.0, height: float = 4.6) -> Figure:
    """Return a figure of one diagram, with a size in inches."""
    figure = blank_figure(width, height)
    projection = "3d" if len(diagram.axes) == 3 else None
    draw_diagram(figure.add_subplot(projection=projection), diagram)
    return figure


def blank_figure(width: float, height: float) -> Figure:
    """Return a figure of a size in inches."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="compressed")  # it knows of equal scales


@checks_types
def toss(toss: Toss, body: Body | None = None, *, distribution: TossDistribution | None = None) -> Figure:
    """Return a figure of a toss, from the side and from above, with other ways that it has followed.

    Args:
        toss: What `contact_dynamics.toss.toss` returns.
        body: The body, whose outline is drawn on its way and where it ends, or None for the path alone.
        distribution: What `sampled_toss` returns, whose samples are drawn too, or None.
    """
    outline = drawn_shape(NO_SHAPE if body is None else body.shape)
    figure = from_side_and_above(
        lambda axes, up: draw_toss(axes, toss, outline, across="x", up=up, distribution=distribution)
    )
    figure.suptitle(f"Toss: {toss.end} at {toss.seconds:.4g} s")
    return figure


@checks_types
def modes(answer: PlanarModeAnswer | SpatialModeAnswer) -> Figure:
    """Return a figure of the first `MAX_MODES` consistent modes, one below the other, with their forces.

    In the plane it has contacts, friction cones, forces and accelerations. In space it has the force at each
    contact beside the edge of its friction cone.

    Args:
        answer: What `contact_dynamics.contact_modes.contact_modes` returns.
    """
    found = answer.modes[:MAX_MODES]
    titles = [f"{mode.mode}: {motion_in_words(mode)}" for mode in found]
    rows = max(len(found), 1)
    figure = blank_figure(8.0, 4.6 * rows)
    each = figure.subplots(rows, 1, squeeze=False)[:, 0]
    problem = answer.problem
    if isinstance(answer, PlanarModeAnswer) and isinstance(problem, PlanarContactProblem):
        view = ModesSideBySide(
            contacts=tuple(problem.contacts),
            modes=answer.modes[:MAX_MODES],
            titles=titles or [str(answer.verdict)],
            outline=np.zeros((0, 2)),
        )
        for axes, scene in zip(each, view.scenes, strict=True):
            draw_diagram(axes, scene)
    elif isinstance(answer, SpatialModeAnswer) and isinstance(problem, SpatialContactProblem):
        for axes, mode, title in zip(each, answer.modes, titles, strict=False):
            draw_diagram(axes, contact_forces(problem.contacts, mode, title=title))
    figure.suptitle(answer.in_short())
    return figure


_P = ParamSpec("_P")
_AXES: Final = inspect.Parameter("axes", inspect.Parameter.POSITIONAL_ONLY)


def _drawn(diagram: Callable[_P, Diagram]) -> Callable[Concatenate[Any, _P], None]:
    """Return a function that draws the diagram which another returns."""

    @wraps(diagram)
    def draw(axes: Any, /, *args: _P.args, **kwargs: _P.kwargs) -> None:
        draw_diagram(axes, diagram(*args, **kwargs))

    signature = inspect.signature(diagram)
    parameters = [_AXES, *signature.parameters.values()]
    draw.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=parameters, return_annotation=None
    )
    draw.__doc__ = f"Draw into axes what this returns:\n\n{inspect.getdoc(diagram)}"
    return draw


draw_impulse_space = _drawn(impulse_space)
draw_impulse_space_in_3d = _drawn(impulse_space_in_3d)
draw_contact_forces = _drawn(contact_forces)
draw_mode_map = _drawn(mode_map)
draw_force_dual = _drawn(force_dual)
draw_poinsot = _drawn(poinsot_diagram)
draw_event_tree = _drawn(event_tree)
draw_position = _drawn(trajectory_curves.position)
draw_attitude = _drawn(trajectory_curves.attitude)
draw_velocity = _drawn(trajectory_curves.velocity)
draw_angular_velocity = _drawn(trajectory_curves.angular_velocity)
draw_momentum = _drawn(trajectory_curves.momentum)
draw_angular_momentum = _drawn(trajectory_curves.angular_momentum)
draw_energy = _drawn(trajectory_curves.energy)


def draw_planar_scene(axes: Axes, scene: Diagram, *, title: str | None = None) -> None:
    """Draw a planar body with its contacts, m from the centre of mass, and one mode's forces.

    The sizes of forces and accelerations stand in the legend. The longest arrow of each kind suits the body.

    Args:
        axes: The axes to draw into.
        scene: What `diagrams.planar_scene.planar_scene_of` made.
        title: The title, which is the scene's own by default.
    """
    draw_diagram(axes, scene, title=title)


def draw_toss(
    axes: Axes,
    toss: Toss | TossAnswer,
    shape: Shape,
    *,
    across: str = "x",
    up: str = "z",
    distribution: TossDistribution | None = None,
) -> None:
    """Draw a toss seen along one of the world's axes: path, strikes, pose at the end, other ways, samples.

    Args:
        axes: where to draw.
        toss: the toss, or the answer to a question about one.
        shape: the body's shape, for its outline.
        across: the world's axis, "x", "y" or "z", to the right.
        up: the one upwards.
        distribution: samples of a toss, or None. An answer has its own.
    """
    marks = toss_marks(shape, toss, up_W=np.array([0.0, 0.0, 1.0]), told=distribution)
    draw_seen(axes, marks, across=across, up=up)


def draw_many_states(
    axes: Axes, answer: ManyTumblingsAnswer | ManyImpactsAnswer, *, across: str = "x", up: str = "z"
) -> None:
    """Draw the position of each centre of mass, m, with an arrow along its velocity.

    Impacts have a marker for each outcome, and ``across`` and ``up`` are as for a toss.
    """
    draw_seen(axes, many_states_marks(NO_FACES, answer), across=across, up=up)
