"""Draws a planar body with its contacts. `contact_dynamics.diagrams.planar_scene` says what it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.plots.style import legend_beside

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from contact_dynamics.diagrams.planar_scene import Arrows, PlanarScene

_MEANINGS: Final = {
    colors.BLUE: "stays fixed (f)",
    colors.YELLOW: "slides (l, r)",
    colors.SKY: "separates (s)",
}
_AROUND: Final = 0.15  # room around body and contacts, relative to the body's size


def draw_planar_scene(axes: Axes, scene: PlanarScene, *, title: str = "") -> None:
    """Draw a planar body with its contacts, m from the centre of mass, and one mode's forces.

    The sizes of forces and accelerations stand in the legend. The longest arrow of each kind suits the body.

    Args:
        axes: The axes to draw into.
        scene: What `diagrams.planar_scene_of` made, or ``scene(i)`` of `diagrams.modes_side_by_side`.
        title: The title.
    """
    for i, wall in enumerate(scene.walls):
        axes.plot(*wall.T, color=colors.AXIS, linewidth=5.0, label="surface" if i == 0 else None, zorder=1.0)
    axes.plot(*scene.outline.T, color=colors.GREY, linewidth=2.0, label="body", gid="body")
    for i, cone in enumerate(scene.cones):
        axes.plot(*cone.T, color=colors.PURPLE, linewidth=1.2, label="friction cone" if i == 0 else None)
    axes.plot(
        [0.0], [0.0], color=colors.GREY, marker="+", markersize=9.0, linestyle="", label="centre of mass"
    )
    letter_colors = [colors.LETTERS.get(letter, colors.BLACK) for letter in scene.letters]
    for color in dict.fromkeys(letter_colors):
        chosen = [i for i, each in enumerate(letter_colors) if each == color]
        axes.plot(
            *scene.points[chosen].T,
            color=color,
            marker="o",
            markeredgecolor=colors.BLACK,
            markeredgewidth=0.6,
            linestyle="",
            label=f"contact that {_MEANINGS[color]}" if color in _MEANINGS else "contact",
            zorder=4.0,
        )
    for label in scene.labels:
        x, y = label.place.tolist()
        axes.text(x, y, label.text, ha="center", va="center", fontsize="small")
    _draw_arrows(axes, "force", scene.forces, colors.RED)
    _draw_arrows(axes, "acceleration", scene.accelerations, colors.ORANGE)
    tips = [arrows.origins + arrows.vectors for arrows in (scene.forces, scene.accelerations) if arrows]
    everything = np.vstack([scene.outline, scene.points, np.zeros((1, 2)), *tips])
    (left, bottom), (right, top) = everything.min(axis=0), everything.max(axis=0)
    room = _AROUND * scene.size
    axes.set_aspect("equal")
    axes.set_xlim(left - room, right + room)
    axes.set_ylim(bottom - room, top + room)
    axes.set_xlabel("right of the centre of mass, m")
    axes.set_ylabel("above the centre of mass, m")
    axes.set_title(title)
    legend_beside(axes)


def _draw_arrows(axes: Axes, name: str, arrows: Arrows | None, color: str) -> None:
    if arrows is None or not arrows.contacts:
        return
    sizes = "\n".join(
        f"  {contact + 1}: {size:.3g} {arrows.unit}"
        for contact, size in zip(arrows.contacts, arrows.sizes.tolist(), strict=True)
    )
    axes.quiver(
        *arrows.origins.T,
        *arrows.vectors.T,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.008,
        color=color,
        zorder=3.0,
        label=f"{name} at contact\n{sizes}",
        gid=f"{name}s",
    )
