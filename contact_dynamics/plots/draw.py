# SPDX-License-Identifier: Apache-2.0
"""Draws the diagrams of `contact_dynamics.diagrams` with Matplotlib, each into the axes that are given.

Each function takes the axes and then what the function of the diagram takes. The axes of diagrams in space
are those of ``figure.add_subplot(projection="3d")``, which have no type.
"""

from __future__ import annotations

import inspect
from functools import wraps
from typing import TYPE_CHECKING, Any, Concatenate, Final, ParamSpec

import numpy as np

from contact_dynamics.diagrams import trajectory_curves
from contact_dynamics.diagrams.contact_scene import contact_forces
from contact_dynamics.diagrams.force_dual import force_dual
from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.diagrams.many_states import many_states_marks
from contact_dynamics.diagrams.mode_map import mode_map
from contact_dynamics.diagrams.poinsot import poinsot_diagram
from contact_dynamics.diagrams.shape import NO_FACES
from contact_dynamics.diagrams.toss_scene import event_tree, toss_marks
from contact_dynamics.plots.drawing import draw_diagram, draw_seen

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes

    from contact_dynamics.diagrams.marks import Diagram
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.toss import Toss, TossDistribution

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
