# SPDX-License-Identifier: Apache-2.0
"""The contact forces of one mode in their friction cones, in the plane and in space alike.

A round friction cone looks the same from all sides. So each contact is one point, friction force to the right
and normal force up. A point on its cone's edge slides or is about to, and one inside sticks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Axis, Diagram, Lines, Points
from contact_dynamics.diagrams.palette import Paint

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import SpatialMode
    from contact_dynamics.diagrams.marks import Mark

_MARKERS: Final = "osD^v<>p*h"  # so that points at one place are seen
_MARGIN: Final = 1.15  # how far the axes reach, relative to the largest force
_DASHES: Final = ("-", "--", "-.", ":")


def contact_forces(contacts: ContactSet, mode: SpatialMode, *, title: str = "") -> Diagram:
    """Return the contact forces of a mode, N, with the friction cone of each different friction coefficient.

    Args:
        contacts: The contacts.
        mode: The mode, whose forces may be one choice of many.
        title: The title, which is the mode's letters by default.
    """
    normal = np.einsum("ni,ni->n", mode.contact_forces_W, contacts.normals_W)
    friction = np.linalg.norm(mode.contact_forces_W - normal[:, None] * contacts.normals_W, axis=1)
    top = _MARGIN * float(max(normal.max(initial=0.0), friction.max(initial=0.0))) or 1.0
    marks: list[Mark] = []
    for i, coefficient in enumerate(np.unique(contacts.frictions).tolist()):
        reach = min(top, coefficient * top)
        marks.append(
            Lines(
                f"cone_{i + 1}",
                Paint(palette.FRICTION_CONE, paper.PURPLE),
                [np.array([(0.0, 0.0), (reach, reach / coefficient if coefficient > 0.0 else top)])],
                width=1.9,
                dash=_DASHES[i % len(_DASHES)],
                legend=f"edge of the friction cone, μ = {coefficient:.3g}",
            )
        )
    count = len(mode.mode)
    for i, (x, y, letter) in enumerate(zip(friction.tolist(), normal.tolist(), mode.mode, strict=True)):
        marks.append(
            Points(
                f"contact_{i + 1}",
                Paint(palette.LETTER_COLORS[letter], paper.LETTERS[letter]),
                np.array([(x, y)]),
                marker=_MARKERS[i % len(_MARKERS)],
                size=6.0 + 3.0 * (count - 1 - i) / max(count - 1, 1),
                legend=f"contact {i + 1} {letter}: {x:.3g}, {y:.3g} N",
                is_noted=True,
            )
        )
    axes = tuple(Axis(f"{name} force, N", -0.05 * top, top) for name in ("friction", "normal"))
    return Diagram(marks=marks, axes=axes, title=title or mode.mode)
