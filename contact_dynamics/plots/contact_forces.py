"""Draws the contact forces of one mode in their friction cones, in the plane and in space alike.

A round friction cone looks the same from all sides. So each contact is one dot, friction force to the right
and normal force up. A dot on its cone's edge slides or is about to, and one inside sticks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.plots.style import legend_beside, lines_through_zero

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import SpatialMode

_MARKERS: Final = "osD^v<>p*h"  # so that dots at one place are seen
_MARGIN: Final = 1.15  # how far the axes reach, relative to the largest force
_STYLES: Final = ("-", "--", "-.", ":")


def draw_contact_forces(axes: Axes, contacts: ContactSet, mode: SpatialMode, *, title: str = "") -> None:
    """Draw the contact forces of a mode, N, with the friction cone of each different friction coefficient.

    Args:
        axes: The axes to draw into.
        contacts: The contacts.
        mode: The mode, whose forces may be one choice of many.
        title: The title, which is the mode's letters by default.
    """
    normal = np.einsum("ni,ni->n", mode.contact_forces_W, contacts.normals_W)
    friction = np.linalg.norm(mode.contact_forces_W - normal[:, None] * contacts.normals_W, axis=1)
    top = _MARGIN * float(max(normal.max(initial=0.0), friction.max(initial=0.0))) or 1.0
    lines_through_zero(axes)
    for i, coefficient in enumerate(np.unique(contacts.frictions).tolist()):
        reach = min(top, coefficient * top)
        axes.plot(
            [0.0, reach],
            [0.0, reach / coefficient if coefficient > 0.0 else top],
            color=colors.PURPLE,
            linestyle=_STYLES[i % len(_STYLES)],
            label=f"edge of the friction cone, μ = {coefficient:.3g}",
        )
    for i, (x, y, letter) in enumerate(zip(friction.tolist(), normal.tolist(), mode.mode, strict=True)):
        axes.plot(
            [x],
            [y],
            linestyle="",
            marker=_MARKERS[i % len(_MARKERS)],
            markersize=6.0 + 3.0 * (len(mode.mode) - 1 - i) / max(len(mode.mode) - 1, 1),
            color=colors.LETTERS.get(letter, colors.BLACK),
            markeredgecolor=colors.BLACK,
            markeredgewidth=0.6,
            label=f"contact {i + 1} {letter}: {x:.3g}, {y:.3g} N",
            gid=f"contact_{i + 1}",
            zorder=3.0,
        )
    axes.set_aspect("equal")
    axes.set_xlim(-0.05 * top, top)
    axes.set_ylim(-0.05 * top, top)
    axes.set_xlabel("friction force, N")
    axes.set_ylabel("normal force, N")
    axes.set_title(title or mode.mode)
    legend_beside(axes)
