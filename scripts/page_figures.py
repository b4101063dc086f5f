# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of the tutorials, of notation and of contacts: `python scripts/page_figures.py [FOLDER]`.

A test compares the files in docs/figures/ with what this script draws.
"""

import math
import sys
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from contact_dynamics import (
    Body,
    BodyState,
    ContactSet,
    MassProperties,
    Obstacle,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarWrench,
    World,
    free_motion,
    inertia,
    next_landing,
)
from contact_dynamics.contact_modes import contact_modes
from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.planar_scene import planar_scene_of
from contact_dynamics.plots import draw_impulse_space, draw_planar_scene, save_figure
from contact_dynamics.questions import ImpactQuestion, ask
from contact_dynamics.shapes import cylinder

FOLDER = Path(__file__).parents[1] / "docs" / "figures"


def catch() -> Figure:
    """Draw where a thrown hammer is, and how fast its grip is there."""
    handle = inertia.cylinder(radius=0.015, length=0.25, density=700.0)
    head = inertia.box(size=(0.03, 0.1, 0.03), density=7800.0).placed(p_GF_G=(0.0, 0.0, 0.14))
    hammer = inertia.combined([handle, head])
    grip_B, butt_B, top_B = (np.array([0.0, 0.0, z]) - hammer.p_FB_F for z in (-0.10, -0.125, 0.155))
    thrown = BodyState(p_WB_W=[0, 0, 1.2], q_WB=[0, 0, 0, 1], v_WB_W=[2.0, 0, 3.0], w_WB_W=[0.2, 14.0, 0.1])
    motion = free_motion(hammer.mass_properties, thrown)
    times = np.linspace(0.0, 0.7, 351)
    states = [motion.state_at(t) for t in times]
    grips = np.array([state.p_WB_W + state.R_WB @ grip_B for state in states])
    speeds = np.array(
        [np.linalg.norm(state.velocity_of_point(grip)) for state, grip in zip(states, grips, strict=True)]
    )
    best = int(np.argmin(np.where(times < 0.3, np.inf, speeds)))
    figure = Figure(figsize=(10, 4), layout="constrained")
    side, curve = figure.subplots(1, 2, width_ratios=[3, 2])
    for k in [*range(0, 350, 35), best]:
        ends = np.array([states[k].p_WB_W + states[k].R_WB @ end for end in (butt_B, top_B)])
        color = colors.ORANGE if k == best else colors.GREY
        side.plot(ends[:, 0], ends[:, 2], color=color, linewidth=2.5 if k == best else 1.2)
        side.plot(ends[1:, 0], ends[1:, 2], "s", color=color, markersize=9 if k == best else 6)
    side.plot([], [], color=colors.GREY, label="hammer, every 70 ms; its head is the square")
    side.plot([], [], color=colors.ORANGE, label="hammer at the catch")
    centres = np.array([state.p_WB_W for state in states])
    side.plot(centres[:, 0], centres[:, 2], color=colors.BLACK, linewidth=1.0, label="centre of mass")
    side.plot(grips[:, 0], grips[:, 2], color=colors.BLUE, linewidth=1.0, linestyle="--", label="grip")
    side.set(xlabel="x, m", ylabel="height, m", aspect="equal")
    side.legend(fontsize="small", frameon=False, loc="lower left")
    curve.plot(times, speeds, color=colors.BLUE)
    curve.plot(times[best], speeds[best], "o", color=colors.ORANGE)
    words = f"close the hand here:\n{times[best]:.3f} s, {speeds[best]:.1f} m/s"
    curve.annotate(words, (times[best], speeds[best]), (0.16, 0.7), arrowprops={"arrowstyle": "->"})
    curve.set(xlabel="time after the throw, s", ylabel="speed of the grip, m/s", ylim=(0, None))
    return figure


MASS, WIDE, HIGH = 0.5, 0.06, 0.16


def _on_tray(degrees: float, friction: float) -> PlanarContactProblem:
    feet = [
        PlanarContact(r=(x, -HIGH / 2), normal=(0.0, 1.0), friction=friction) for x in (-WIDE / 2, WIDE / 2)
    ]
    tilt = math.radians(degrees)
    weight = PlanarWrench(f=(MASS * 9.81 * math.sin(tilt), -MASS * 9.81 * math.cos(tilt)))
    body = PlanarBody(mass=MASS, inertia=MASS * (WIDE**2 + HIGH**2) / 12.0)
    return PlanarContactProblem(body=body, contacts=feet, wrench=weight)


def stay_slip_or_tip() -> Figure:
    """Draw what a box on a tilted tray does, and how that depends on tilt and friction."""
    tilts, frictions = np.linspace(0.25, 34.75, 70), np.linspace(0.005, 0.995, 50)
    kinds = np.zeros((len(frictions), len(tilts)))
    for i, friction in enumerate(frictions.tolist()):
        for k, degrees in enumerate(tilts.tolist()):
            modes = {mode.mode for mode in contact_modes(_on_tray(degrees, friction)).modes}
            kinds[i, k] = next(n for n, letters in enumerate(("ff", "rr", "sf", "sr")) if letters in modes)
    figure = Figure(figsize=(11, 4.4), layout="constrained")
    chart, scene = figure.subplots(1, 2, width_ratios=[1, 1])
    patches = [colors.MODES[i] for i in (0, 5, 4, 8)]
    chart.pcolormesh(tilts, frictions, kinds, cmap=_map_of(patches), vmin=-0.5, vmax=3.5, rasterized=True)
    for place, words in (
        ((9.0, 0.6), "ff: both feet\nstay fixed"),
        ((25.0, 0.15), "rr: both feet\nslide right"),
        ((28.0, 0.75), "sf: it tips over\nits right foot"),
    ):
        chart.annotate(words, place, ha="center", va="center")
    arrow = {"arrowstyle": "->", "color": colors.BLACK, "linewidth": 1.0}
    chart.annotate("sr: it tips and slides", (33.0, 0.42), (22.0, 0.52), arrowprops=arrow)
    for friction in (0.36, 0.6):
        chart.axhline(friction, color=colors.BLACK, linewidth=0.8, linestyle=":")
        chart.annotate(f"μ = {friction:g}", (0.5, friction + 0.012), fontsize="small")
    chart.set(xlabel="tilt of the tray, degrees", ylabel="friction μ", xlim=(0, 35), ylim=(0, 1))
    x, y = WIDE / 2, HIGH / 2
    outline = np.array([[-x, -y], [x, -y], [x, y], [-x, y], [-x, -y]])
    tray = np.array([[-2.0 * x, -y], [2.0 * x, -y]])
    problem = _on_tray(21.0, 0.6)
    (mode,) = contact_modes(problem).modes
    drawn = planar_scene_of(outline, problem.contacts, walls=[tray], mode=mode)
    draw_planar_scene(scene, drawn, title="21°, μ = 0.6, in the frame of the tray")
    down = 0.05 * np.array(problem.wrench.f) / (MASS * 9.81)
    scene.annotate("", tuple(down), (0.0, 0.0), arrowprops=arrow)
    scene.annotate("gravity", tuple(down), (4, -4), textcoords="offset points", fontsize="small")
    return figure


def _map_of(patches: list[str]) -> object:
    from matplotlib.colors import ListedColormap

    return ListedColormap(patches)


def bounce() -> Figure:
    """Draw the impulse on a table-tennis ball with backspin: it slides from beginning to end."""
    ball = MassProperties(mass=2.7e-3, I_B=2.0 / 3.0 * 2.7e-3 * 0.02**2 * np.eye(3))
    before = BodyState(p_WB_W=[0, 0, 0.02], q_WB=[0, 0, 0, 1], v_WB_W=[3.0, 0, -2.5], w_WB_W=[0, -400.0, 0])
    table = ContactSet(p_WC_W=[[0, 0, 0]], normals_W=[0, 0, 1], frictions=0.25, restitutions=0.9)
    answer = ask(ImpactQuestion(body=Body(name="ball", mass_properties=ball), state=before, contacts=table))
    figure = Figure(figsize=(8, 4.4), layout="compressed")
    draw_impulse_space(figure.add_subplot(), ball, answer)
    return figure


def _frame(
    axes: Axes, origin: tuple[float, float], degrees: float, *, name: str, color: str, length: float
) -> None:
    for turn, word in ((0.0, "x"), (90.0, "z")):
        angle = math.radians(degrees + turn)
        tip = (origin[0] + length * math.cos(angle), origin[1] + length * math.sin(angle))
        axes.annotate("", tip, origin, arrowprops={"arrowstyle": "->", "color": color, "linewidth": 1.8})
        place = (origin[0] + 1.18 * length * math.cos(angle), origin[1] + 1.18 * length * math.sin(angle))
        axes.annotate(f"{word}$_{name}$", place, ha="center", va="center", color=color)
    axes.plot(*origin, "o", color=color, markersize=4)


def notation_frames() -> Figure:
    """Draw the frames W, F, B and C of a body on a floor, and the vectors between them."""
    figure = Figure(figsize=(8, 4.6), layout="constrained")
    axes = figure.add_subplot()
    turn = math.radians(25.0)
    along, up = np.array([math.cos(turn), math.sin(turn)]), np.array([-math.sin(turn), math.cos(turn)])
    corner = np.array([2.6, 0.0])
    outline = np.array([corner + a * along + b * up for a, b in ((0, 0), (2, 0), (2, 1.3), (0, 1.3), (0, 0))])
    axes.fill(*outline.T, color="#e6eef6")
    axes.plot(*outline.T, color=colors.GREY)
    axes.plot([-0.4, 6.2], [0.0, 0.0], color=colors.AXIS, linewidth=6.0, zorder=0.0)
    published, centre = corner + 0.25 * along + 1.05 * up, corner + 1.15 * along + 0.6 * up
    _frame(axes, (0.0, 0.0), 0.0, name="W", color=colors.BLACK, length=0.8)
    _frame(axes, (float(published[0]), float(published[1])), 25.0, name="F", color=colors.BLUE, length=0.55)
    _frame(axes, (float(centre[0]), float(centre[1])), 25.0, name="B", color=colors.ORANGE, length=0.55)
    _frame(axes, (float(corner[0]), float(corner[1])), 0.0, name="C", color=colors.RED, length=0.55)
    for begin, end, name, at in (
        (np.zeros(2), centre, "p_WB_W", 0.45),
        (published, centre, "p_FB_F", 0.5),
        (np.array([0.0, -0.3]), corner - [0.0, 0.3], "p_WC_W", 0.5),
    ):
        dashed = {"arrowstyle": "-|>", "color": colors.GREY, "linestyle": "--", "linewidth": 1.0}
        axes.annotate("", tuple(end), tuple(begin), arrowprops=dashed)
        place = begin + at * (end - begin)
        axes.annotate(
            name, tuple(place), (0, 6), textcoords="offset points", family="monospace", fontsize="small"
        )
    words = (
        "W  world\n"
        "F  published frame of the body\n"
        "B  physics: axes of F, origin at the centre of mass\n"
        "C  contact: its normal points into the body"
    )
    axes.annotate(words, (0.01, 1.0), xycoords="axes fraction", va="top")
    axes.set(xlim=(-0.5, 6.2), ylim=(-0.6, 2.6), aspect="equal")
    axes.set_axis_off()
    return figure


def notation_letters() -> Figure:
    """Draw what l, r, f and s mean at a contact in the plane."""
    figure = Figure(figsize=(10, 2.6), layout="constrained")
    for i, (letter, words, slip, friction) in enumerate(
        (
            ("l", "slides left", -1.0, 1.0),
            ("r", "slides right", 1.0, -1.0),
            ("f", "stays fixed", 0.0, 0.4),
            ("s", "separates", 0.0, None),
        )
    ):
        axes = figure.add_subplot(1, 4, i + 1)
        lift = 0.25 if letter == "s" else 0.0
        body = np.array(
            [[0.0, lift], [0.9, lift + 0.35], [0.6, lift + 1.0], [-0.3, lift + 0.65], [0.0, lift]]
        )
        axes.fill(*body.T, color="#e6eef6")
        axes.plot(*body.T, color=colors.GREY)
        axes.plot([-1.3, 1.3], [0.0, 0.0], color=colors.AXIS, linewidth=6.0, zorder=0.0)
        edge = math.atan(0.5)
        cone = 0.8 * np.array(
            [[-math.sin(edge), math.cos(edge)], [0.0, 0.0], [math.sin(edge), math.cos(edge)]]
        )
        axes.plot(*cone.T, color=colors.PURPLE, linewidth=1.0, label="friction cone")
        if friction is not None:
            angle = friction * edge
            tip = (0.8 * math.sin(angle), 0.8 * math.cos(angle))
            axes.annotate(
                "", tip, (0, 0), arrowprops={"arrowstyle": "->", "color": colors.RED, "linewidth": 2}
            )
        axes.plot([], [], color=colors.RED, label="contact force")
        if slip or lift:
            end = (1.1 * slip, -0.25) if slip else (-0.6, lift + 0.5)
            begin = (0.2 * slip, -0.25) if slip else (-0.6, 0.05)
            axes.annotate(
                "", end, begin, arrowprops={"arrowstyle": "->", "color": colors.BLACK, "linewidth": 1.5}
            )
        axes.plot([], [], color=colors.BLACK, label="velocity of the contact")
        axes.set_title(f"{letter}: {words}")
        axes.set(xlim=(-1.4, 1.4), ylim=(-0.5, 1.4), aspect="equal")
        axes.set_axis_off()
    handles, names = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, names, loc="outside lower center", ncols=3, frameon=False, fontsize="small")
    return figure


def contacts() -> Figure:
    """Draw the can of the page's first example, as it lands over the edge of a table."""
    radius, length = 0.03, 0.12
    can = inertia.cylinder(radius=radius, length=length, mass=0.35)
    body = Body(name="can", mass_properties=can.mass_properties, shape=cylinder(radius=radius, length=length))
    corners = np.array([[-0.5, -0.4, 0.0], [0.5, -0.4, 0.0], [0.5, 0.4, 0.0], [-0.5, 0.4, 0.0]])
    table = Obstacle(name="table", vertices_W=corners, friction=0.4, restitution=0.2)
    lying = np.array([0.0, 0.70710678, 0.0, 0.70710678])
    falls = BodyState(p_WB_W=[0.5, 0.0, 0.3], q_WB=lying, v_WB_W=np.zeros(3), w_WB_W=np.zeros(3))
    landing = next_landing(body, falls, World(bodies=(body,), surfaces=(table,)), horizon=1.0)
    if landing is None:
        message = "the can lands on the table"
        raise ValueError(message)
    figure = Figure(figsize=(8, 4.2), layout="constrained")
    axes = figure.add_subplot()
    axes.plot([0.38, 0.5], [0.0, 0.0], color=colors.GREY, linewidth=6.0, solid_capstyle="butt", label="table")
    for state, style, words in (
        (falls, ":", "can at first"),
        (landing.state, "-", "can at its first contact"),
    ):
        x, z = float(state.p_WB_W[0]), float(state.p_WB_W[2])
        sides = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * (length / 2, radius) + (x, z)
        axes.plot(*sides.T, color=colors.BLUE, linestyle=style, label=words)
    points = landing.contacts.p_WC_W
    axes.plot(
        points[:, 0], points[:, 2], "o", color=colors.RED, label="contacts: the ends of the line that touches"
    )
    for i, (x, _, z) in enumerate(points.tolist(), start=1):
        arrow = {"arrowstyle": "->", "color": colors.RED, "linewidth": 1.5}
        axes.annotate("", (x, z + 0.05), (x, z), arrowprops=arrow)
        axes.annotate(f"normal {i}", (x, z + 0.05), (3, 0), textcoords="offset points", fontsize="small")
    axes.annotate(f"after {landing.seconds:.4f} s", (0.5, 0.15), (6, 0), textcoords="offset points")
    axes.annotate("", (0.5, 0.1), (0.5, 0.22), arrowprops={"arrowstyle": "->", "linewidth": 1.2})
    axes.set(xlabel="x, m", ylabel="height, m", aspect="equal", xlim=(0.37, 0.62), ylim=(-0.02, 0.35))
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.0), frameon=False, fontsize="small")
    return figure


FIGURES = {
    "catch": catch,
    "stay_slip_or_tip": stay_slip_or_tip,
    "bounce": bounce,
    "notation_frames": notation_frames,
    "notation_letters": notation_letters,
    "contacts": contacts,
}


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in FIGURES.items():
        save_figure(draw(), folder / f"{name}.svg")
