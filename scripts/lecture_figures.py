# SPDX-License-Identifier: Apache-2.0
"""Draws the figures of docs/lectures.md with the library: `python scripts/lecture_figures.py [FOLDER]`.

They are those of Mason's lectures 25 to 27, for the numbers that the lectures give. A test compares the files
in docs/lectures/ with what this script draws.
"""

import math
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from contact_dynamics import (
    Body,
    BodyState,
    ContactSet,
    MassProperties,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarVelocity,
    PlanarWrench,
    free_motion,
)
from contact_dynamics.contact_modes import contact_modes, mode_margins, wrench_sets
from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.planar_scene import planar_scene_of
from contact_dynamics.diagrams.words import outcome_in_words
from contact_dynamics.diagrams.wrench_chart import DirectionChart, ForceDualChart
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.plots import (
    draw_force_dual,
    draw_impulse_space,
    draw_impulse_space_in_3d,
    draw_mode_map,
    draw_planar_scene,
    draw_poinsot,
    save_figure,
)
from contact_dynamics.questions import ImpactQuestion, Problem, ask
from contact_dynamics.tumbling import poinsot, rolling_curves

FOLDER = Path(__file__).parents[1] / "docs" / "lectures"
MOMENTS = (1.0e-4, 2.0e-4, 2.6e-4)  # kg m^2
PLATE = MassProperties(mass=0.2, I_B=np.diag(MOMENTS))


def spinning(w: list[float]) -> BodyState:
    """Return a body in free spin, rad/s."""
    return BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[0, 0, 0], w_WB_W=w)


def polhodes() -> Figure:
    """Lecture 25: the paths of the angular velocity on one energy ellipsoid."""
    figure = Figure(figsize=(7, 5.5), layout="constrained")
    axes = figure.add_subplot(projection="3d")
    names = {
        0: ("minor axis", colors.BLUE),
        1: ("middle axis", colors.BLACK),
        2: ("major axis", colors.ORANGE),
    }
    for axis, (name, color) in names.items():
        others = [i for i in range(3) if i != axis]
        labelled = False
        for sign in (1.0, -1.0):
            for off in (0.12, 0.35, 0.6) if axis != 1 else (0.002 * sign,):
                w = np.zeros(3)
                w[axis], w[others[0]] = sign * math.sqrt(1.0 - off**2), off
                w *= 0.1 / np.sqrt(MOMENTS)  # all have the same energy
                curves = rolling_curves(free_motion(PLATE, spinning(w.tolist())), 300)
                label = None if labelled else f"about or near the {name}"
                axes.plot(*curves.polhode_B.T, color=color, linewidth=1.4, label=label)
                labelled = True
    for setting, name in (
        (axes.set_xlabel, "minor"),
        (axes.set_ylabel, "middle"),
        (axes.set_zlabel, "major"),
    ):
        setting(f"{name} axis, rad/s", labelpad=8.0)
    axes.locator_params(nbins=4)
    axes.set_aspect("equal")
    axes.view_init(elev=22.0, azim=-52.0)  # the upright axis is on the right, where its name has room
    axes.legend(loc="upper left", bbox_to_anchor=(1.15, 1.0), frameon=False, fontsize="small")
    return figure


def rolling() -> Figure:
    """Lecture 25: the ellipsoid rolls on the invariable plane."""
    motion = free_motion(PLATE, spinning([2.0, 6.0, -6.0]))
    figure = Figure(figsize=(8, 6), layout="constrained")
    draw_poinsot(
        figure.add_subplot(projection="3d"), poinsot(motion), rolling_curves(motion, 400), motion.state
    )
    return figure


THETA = math.radians(75.0)
TIP = (-4.0 * math.cos(THETA), -4.0 * math.sin(THETA))
ROD = PlanarBody(mass=1.0, inertia=1.0)
TOUCH = PlanarContact(r=TIP, normal=(0.0, 1.0), friction=math.tan(math.radians(30.0)), restitution=0.5)
ROD_OUTLINE = np.array([TIP, (-TIP[0], -TIP[1]), TIP])
FLOOR = np.array([[-3.5, TIP[1]], [3.5, TIP[1]]])


def two_modes() -> Figure:
    """Lecture 26: the rod that is pulled along the wall has two consistent modes."""
    problem = PlanarContactProblem(body=ROD, contacts=[TOUCH], wrench=PlanarWrench(f=(-1.0, 0.0)))
    figure = Figure(figsize=(10, 5), layout="compressed")
    modes = sorted(contact_modes(problem).modes, key=lambda mode: mode.mode)
    for i, mode in enumerate(modes, start=1):
        scene = planar_scene_of(ROD_OUTLINE, [TOUCH], walls=[FLOOR], mode=mode)
        word = {"f": "f: it turns about its tip", "l": "l: it slides without force"}[mode.mode]
        draw_planar_scene(figure.add_subplot(1, 2, i), scene, title=word)
    return figure


def painleve() -> Figure:
    """Lecture 26: for which lean and friction the sliding rod has no consistent mode."""
    leans, frictions = np.linspace(1.0, 89.0, 177), np.linspace(0.0, 1.5, 151)
    verdicts = np.zeros((len(frictions), len(leans)))
    sliding, gravity = PlanarVelocity(v=(-1.0, 0.0), w=0.0), PlanarWrench(f=(0.0, -9.81))
    for k, lean in enumerate(np.radians(leans).tolist()):
        r = (-4.0 * math.cos(lean), -4.0 * math.sin(lean))
        for i, friction in enumerate(frictions.tolist()):
            tip = PlanarContact(r=r, normal=(0.0, 1.0), friction=friction)
            problem = PlanarContactProblem(body=ROD, velocity=sliding, contacts=[tip], wrench=gravity)
            verdicts[i, k] = float(contact_modes(problem).verdict.name == "INCONSISTENT")
    figure = Figure(figsize=(7.5, 4.6), layout="constrained")
    axes = figure.add_subplot()
    axes.contourf(leans, frictions, verdicts, levels=[0.5, 1.5], colors=[colors.GREY])
    needed = [(1.0 + 16.0 * math.cos(x) ** 2) / (16.0 * math.sin(x) * math.cos(x)) for x in np.radians(leans)]
    axes.plot(leans, needed, color=colors.BLUE, label="1/m + l² cos θ (cos θ − μ sin θ) / I = 0")
    axes.plot(
        [75.0],
        [math.tan(math.radians(30.0))],
        "o",
        color=colors.BLACK,
        label="the lecture's rod: 75°, μ = tan 30°",
    )
    axes.annotate("no mode is consistent", (62.0, 1.05))
    axes.set(xlim=(0, 90), ylim=(0, 1.5), xlabel="lean θ, degrees", ylabel="friction μ")
    axes.legend(loc="upper left", frameon=False, fontsize="small")
    return figure


KEY = PlanarBody(mass=1.0, inertia=0.25)
TRAY = [
    *(PlanarContact(r=(x, -0.4), normal=(0.0, 1.0), friction=0.5) for x in (-0.9, 0.3)),
    *(PlanarContact(r=(0.6, y), normal=(-1.0, 0.0), friction=0.5) for y in (-0.1, 0.5)),
]
APPLIED = PlanarWrench(f=(3.0, 3.0), moment=3.0)
IN_TRAY = PlanarContactProblem(body=KEY, contacts=TRAY, wrench=APPLIED)


def tray_map() -> Figure:
    """Lecture 26: which wrench brings about which mode of a body in the corner of a tray."""
    (margin,) = mode_margins(IN_TRAY)
    figure = Figure(figsize=(11, 5), layout="constrained")
    chart = DirectionChart(length=KEY.radius_of_gyration, resolution=600)
    draw_mode_map(figure.add_subplot(), wrench_sets(IN_TRAY), chart, applied=APPLIED, change=margin.change)
    return figure


def tray_dual() -> Figure:
    """Lecture 26: acceleration centres and force duals of one mode."""
    (mode,) = contact_modes(IN_TRAY).modes
    one = next(one for one in wrench_sets(IN_TRAY) if one.mode == mode.mode)
    outline = np.array([[-0.9, -0.4], [0.6, -0.4], [0.6, 0.5], [0.4, 0.5], [-0.9, -0.2], [-0.9, -0.4]])
    figure = Figure(figsize=(11, 5), layout="constrained")
    chart = ForceDualChart(length=KEY.radius_of_gyration, half_side=2.0, resolution=600)
    draw_force_dual(figure.add_subplot(), one, TRAY, chart, outlines=[outline])
    return figure


# The lecture's rigid body: rho = 1, m = 1, v = (-1, -1), mu = 0.25, e = 0.5, with its contact at six places.
ARMS = ((0.0, -1.0), (0.1, -1.5), (0.3, -3.0), (1.0, -1.2), (1.0, -2.0), (-1.0, -9.0))


def six_paths() -> Figure:
    """Lecture 27: six impacts in impulse space."""
    figure = Figure(figsize=(9, 9), layout="constrained")
    body = MassProperties(mass=1.0, I_B=np.eye(3))
    moving = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0, -1], w_WB_W=[0, 0, 0])
    for i, (x, z) in enumerate(ARMS, start=1):
        answer = ask(
            ImpactQuestion(
                body=Body(name="body", mass_properties=body),
                state=moving,
                contacts=ContactSet(
                    p_WC_W=[[x, 0, z]], normals_W=[0, 0, 1], frictions=0.25, restitutions=0.5
                ),
                problem=Problem.PLANAR,
                plane=PlaneOfMotion(normal_W=[0.0, -1.0, 0.0]),
            )
        )
        axes = figure.add_subplot(3, 2, i)
        draw_impulse_space(axes, body, answer)
        jams = "jams, " if answer.impact.jams else ""
        axes.set_title(
            f"r = ({x:g}, {z:g}): {jams}{outcome_in_words(answer.impact.outcome)}", fontsize="medium"
        )
    return figure


def swerving() -> Figure:
    """Lecture 27 in space: the path swerves in the cone until it meets the sticking line."""
    rod = MassProperties(mass=1.0, I_B=np.diag([0.2, 0.5, 0.6]))
    falling = BodyState(p_WB_W=[0, 0, 0], q_WB=[0, 0, 0, 1], v_WB_W=[-1, 0.4, -1], w_WB_W=[0, 0, 0])
    ground = ContactSet(p_WC_W=[[0.3, 0.2, -0.9]], normals_W=[0, 0, 1], frictions=0.6, restitutions=0.5)
    answer = ask(ImpactQuestion(body=Body(name="rod", mass_properties=rod), state=falling, contacts=ground))
    figure = Figure(figsize=(9.6, 6), layout="constrained")
    draw_impulse_space_in_3d(figure.add_subplot(projection="3d"), rod, answer)
    return figure


FIGURES = {
    "25_polhodes": polhodes,
    "25_poinsot": rolling,
    "26_two_modes": two_modes,
    "26_painleve": painleve,
    "26_tray_map": tray_map,
    "26_force_dual": tray_dual,
    "27_six_paths": six_paths,
    "27_in_space": swerving,
}


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name, draw in FIGURES.items():
        save_figure(draw(), folder / f"{name}.svg")
