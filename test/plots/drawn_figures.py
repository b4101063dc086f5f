# SPDX-License-Identifier: Apache-2.0
"""The diagrams of this chapter, each drawn from a result, and what is read back from them."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from xml.etree import ElementTree as ET

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_dynamics.contact import ContactSet
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes, mode_margins, wrench_sets
from contact_dynamics.diagrams.planar_scene import planar_scene_of
from contact_dynamics.diagrams.shape import drawn_shape
from contact_dynamics.diagrams.wrench_chart import DirectionChart, ForceDualChart
from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarWrench, PlaneOfMotion
from contact_dynamics.plots import (
    draw_angular_momentum,
    draw_angular_velocity,
    draw_attitude,
    draw_contact_forces,
    draw_energy,
    draw_force_dual,
    draw_impulse_space,
    draw_impulse_space_in_3d,
    draw_many_states,
    draw_mode_map,
    draw_momentum,
    draw_planar_scene,
    draw_poinsot,
    draw_position,
    draw_toss,
    draw_velocity,
)
from contact_dynamics.questions import (
    AtTimes,
    ContactModeAnswer,
    ContactModeQuestion,
    Context,
    ImpactAnswer,
    ImpactQuestion,
    Problem,
    TossAnswer,
    TossQuestion,
    TossSampling,
    TumblingAnswer,
    TumblingQuestion,
    UncertainState,
    ask,
)
from contact_dynamics.questions.many import ManyImpactsAnswer, ManyImpactsQuestion, ManyStates, answer_impacts
from contact_dynamics.rigid_body import BodyState, MassProperties
from contact_dynamics.shapes.convex import box
from contact_dynamics.toss import TossUncertainty
from contact_dynamics.world import Body, Surface, World

GRAVITY_W = np.array([0.0, 0.0, -9.81])
BRICK = MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3]))
ROD = MassProperties(mass=1.0, I_B=np.diag([0.2, 0.5, 0.6]))

KEY = PlanarBody(mass=1.0, inertia=0.25)
TRAY = [
    *(PlanarContact(r=(x, -0.4), normal=(0.0, 1.0), friction=0.8) for x in (-0.9, 0.3)),
    *(PlanarContact(r=(0.6, y), normal=(-1.0, 0.0), friction=0.8) for y in (-0.1, 0.5)),
]
APPLIED = PlanarWrench(f=(3.0, 3.0), moment=3.0)
IN_TRAY = PlanarContactProblem(body=KEY, contacts=TRAY, wrench=APPLIED)
OUTLINE = np.array([[-0.9, -0.4], [0.6, -0.4], [0.6, 0.5], [0.4, 0.5], [-0.9, -0.2], [-0.9, -0.4]])
DIRECTIONS = DirectionChart(length=KEY.radius_of_gyration, resolution=200)
DUALS = ForceDualChart(length=KEY.radius_of_gyration, half_side=2.0, resolution=200)


@cache
def tumbling() -> TumblingAnswer:
    """A brick in the air, with covariances and the curves of Poinsot's picture."""
    state = BodyState(
        p_WB_W=[0.1, -0.2, 1.0], q_WB=[0.1, -0.5, 0.7, 0.5], v_WB_W=[0.5, 0.3, 1.0], w_WB_W=[3.0, -8.0, 1.0]
    )
    uncertain = UncertainState(state=state, covariance=1e-4 * np.eye(12))
    body = Body(name="brick", mass_properties=BRICK)
    sampling = AtTimes(times=np.linspace(0.0, 0.4, 41))
    question = TumblingQuestion(
        body=body,
        state=uncertain,
        sampling=sampling,
        gravity_W=GRAVITY_W,
        include_covariance=True,
        curve_points=100,
    )
    return ask(question)


@cache
def impact(*, in_plane: bool) -> ImpactAnswer:
    """A rod that strikes the ground, and swerves in space."""
    return ask(
        ImpactQuestion(
            body=Body(name="rod", mass_properties=ROD),
            state=BodyState(
                p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=[-1.0, 0.0 if in_plane else 0.4, -1.0]
            ),
            contacts=ContactSet(
                p_WC_W=[[0.3, 0.0 if in_plane else 0.2, -0.9]],
                normals_W=[[0.0, 0.0, 1.0]],
                frictions=0.6,
                restitutions=0.5,
            ),
            problem=Problem.PLANAR if in_plane else Problem.SPATIAL,
            plane=PlaneOfMotion(normal_W=[0.0, -1.0, 0.0]) if in_plane else None,
        )
    )


@cache
def resting(*, in_plane: bool) -> ContactModeAnswer:
    """A brick on a table that is pushed."""
    corners = [[x, y, 0.0] for x in (-0.1, 0.1) for y in ((0.0,) if in_plane else (-0.05, 0.05))]
    return ask(
        ContactModeQuestion(
            body=Body(name="brick", mass_properties=BRICK, shape=box(size=(0.2, 0.1, 0.06))),
            state=BodyState(p_WB_W=[0.0, 0.0, 0.03], q_WB=[0.0, 0.0, 0.0, 1.0]),
            contacts=ContactSet(p_WC_W=corners, normals_W=[0.0, 0.0, 1.0], frictions=0.4, restitutions=0.0),
            force_W=[1.0, 0.0, 0.0],
            gravity_W=GRAVITY_W,
            problem=Problem.PLANAR if in_plane else Problem.SPATIAL,
            plane=PlaneOfMotion(normal_W=[0.0, -1.0, 0.0]) if in_plane else None,
            include_margins=in_plane,
            include_wrenches=in_plane,
        )
    )


def _scene(axes: Axes) -> None:
    (mode,) = contact_modes(IN_TRAY).modes
    walls = [np.array([[-1.2, -0.4], [0.6, -0.4], [0.6, 0.8]])]
    draw_planar_scene(axes, planar_scene_of(OUTLINE, TRAY, walls=walls, mode=mode), title=mode.mode)


def _map(axes: Axes) -> None:
    (margin,) = mode_margins(IN_TRAY, contact_modes(IN_TRAY))
    draw_mode_map(axes, wrench_sets(IN_TRAY), DIRECTIONS, applied=APPLIED, change=margin.change)


def _dual(axes: Axes) -> None:
    (mode,) = contact_modes(IN_TRAY).modes
    one = next(one for one in wrench_sets(IN_TRAY) if one.mode == mode.mode)
    draw_force_dual(axes, one, TRAY, DUALS, outlines=[OUTLINE])


def _poinsot(axes: Axes) -> None:
    answer = tumbling()
    assert answer.poinsot is not None
    assert answer.curves is not None
    draw_poinsot(axes, answer.poinsot, answer.curves, answer.state)


def _resting(axes: Axes) -> None:
    answer = resting(in_plane=False)
    draw_contact_forces(axes, answer.contacts, answer.modes[0])


@cache
def many_impacts() -> ManyImpactsAnswer:
    """Bricks side by side that strike ever more slantwise, and some that leave."""
    count = 24
    across = np.linspace(0.0, 2.0, count)
    positions = np.column_stack([across, np.zeros(count), 0.1 * np.sin(3.0 * across)])
    velocities = np.column_stack([2.0 * across, np.zeros(count), np.where(across > 1.7, 1.0, -1.0)])
    question = ManyImpactsQuestion(
        body=Body(name="brick", mass_properties=BRICK),
        states=ManyStates(
            p_WB_W=positions,
            q_WB=np.tile([0.0, 0.0, 0.0, 1.0], (count, 1)),
            v_WB_W=velocities,
            w_WB_W=np.zeros((count, 3)),
        ),
        p_WC_W=positions + np.array([0.02, 0.0, -0.03]),
        normals_W=np.array([[0.0, 0.0, 1.0]]),
        frictions=np.array([0.3]),
        restitutions=np.array([0.5]),
    )
    return answer_impacts(question)


CUBE = Body(
    name="cube", mass_properties=MassProperties(mass=0.4, I_B=7e-4 * np.eye(3)), shape=box(size=[0.1] * 3)
)


@cache
def tossed() -> TossAnswer:
    """A cube that lands on a corner, with samples; some of them are followed to rest."""
    floor = Surface(name="floor", p_WS_W=[0, 0, 0], normal_W=[0, 0, 1], friction=0.3, restitution=0.2)
    state = BodyState(
        p_WB_W=[0.0, 0.0, 0.2], q_WB=[0.4, 0.2, 0.4, 0.8], v_WB_W=[0.6, 0.2, 0.0], w_WB_W=[3.0, 1.0, 0.0]
    )
    covariance = np.diag([1e-3] * 3 + [0.02] * 3 + [0.02] * 3 + [0.5] * 3) ** 2
    question = TossQuestion(
        body=CUBE,
        state=UncertainState(state=state, covariance=covariance),
        rate=50.0,
        max_alternatives=1,
        sampling=TossSampling(count=30, to_rest=True, uncertainty=TossUncertainty(velocity=0.02, spin=0.3)),
    )
    return ask(question, Context(world=World(bodies=(CUBE,), surfaces=(floor,))))


DIAGRAMS: dict[str, Callable[[Axes], None]] = {
    "impulse space in the plane": lambda axes: draw_impulse_space(axes, ROD, impact(in_plane=True)),
    "impulse space": lambda axes: draw_impulse_space(axes, ROD, impact(in_plane=False)),
    "impulse space in 3D": lambda axes: draw_impulse_space_in_3d(axes, ROD, impact(in_plane=False)),
    "states of many": lambda axes: draw_many_states(axes, many_impacts()),
    "toss": lambda axes: draw_toss(axes, tossed(), drawn_shape(CUBE.shape)),
    "planar scene": _scene,
    "map of modes": _map,
    "force dual": _dual,
    "contact forces": _resting,
    "Poinsot": _poinsot,
    "position": lambda axes: draw_position(axes, tumbling().trajectory, covariance=tumbling().covariance),
    "attitude": lambda axes: draw_attitude(axes, tumbling().trajectory),
    "velocity": lambda axes: draw_velocity(axes, tumbling().trajectory),
    "angular velocity": lambda axes: draw_angular_velocity(axes, tumbling().trajectory),
    "momentum": lambda axes: draw_momentum(axes, tumbling().trajectory, BRICK),
    "angular momentum": lambda axes: draw_angular_momentum(axes, tumbling().trajectory, BRICK),
    "energy": lambda axes: draw_energy(axes, tumbling().trajectory, BRICK, gravity_W=GRAVITY_W),
}
"""Every diagram, by its name."""


SVG_DIGITS = 2e-5  # of the width of the axes; SVG has six digits of a place on the page

IN_3D = {"Poinsot", "impulse space in 3D"}


def drawn(name: str) -> tuple[Figure, Axes]:
    """A figure with one diagram."""
    figure = Figure(figsize=(11.0, 6.0), layout="constrained")
    axes = figure.add_subplot(projection="3d" if name in IN_3D else None)
    DIAGRAMS[name](axes)
    return figure, axes


def curve(axes: Axes, gid: str) -> np.ndarray:
    """The points of the line of that name, (k, 2)."""
    (line,) = (line for line in axes.lines if line.get_gid() == gid)
    return np.column_stack(line.get_data())


def points_in_svg(root: ET.Element, gid: str, axes: Axes) -> np.ndarray:
    """The points of a line of that name, (k, 2), in the units of the axes."""
    (group,) = (each for each in root.iter() if each.get("id") == gid)
    (path,) = (each.get("d") or "" for each in group)
    numbers = np.array(re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", path), dtype=float).reshape(-1, 2)
    height = float((root.get("height") or "").removesuffix("pt"))
    pixels = np.column_stack([numbers[:, 0], height - numbers[:, 1]]) * axes.get_figure(root=True).dpi / 72.0
    points: np.ndarray = axes.transData.inverted().transform(pixels)
    return points
