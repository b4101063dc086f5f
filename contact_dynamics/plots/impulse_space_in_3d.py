"""Draws an impact in space. `contact_dynamics.diagrams.impulse_space_in_3d` says what it shows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.diagrams.impulse_space import EVENTS, main_contact
from contact_dynamics.diagrams.impulse_space_in_3d import impulse_space_in_3d_of
from contact_dynamics.diagrams.words import outcome_in_words
from contact_dynamics.plots import colors
from contact_dynamics.plots.impulse_space import MARKERS

if TYPE_CHECKING:
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import HasMassProperties

_ROOM: Final = 8.0  # points between the numbers of an axis and its name
_DECIMALS: Final = 12  # of the picture's extent
_TICKS: Final = 4  # numbers on each axis, few enough not to cover each other


def draw_impulse_space_in_3d(
    axes: Any,
    body: HasMassProperties | None,
    answer: ImpactAnswer,
    *,
    other: HasMassProperties | None = None,
) -> None:
    """Draw the impulse path of an impact's main contact in all three dimensions, N s.

    Args:
        axes: Axes in 3D, as ``figure.add_subplot(projection="3d")`` makes them. They have no type.
        body: The body, or its mass properties. If it is None, sticking line and compression plane are not
            drawn.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it both are missing for two bodies.
    """
    masses, other_masses = (one.mass_properties if one is not None else None for one in (body, other))
    space = impulse_space_in_3d_of(masses, answer, other=other_masses)
    friction = float(answer.contacts.frictions[main_contact(answer.impact)])
    for i, strip in enumerate(space.cone):
        label = f"friction cone, μ = {friction:.3g}" if i == 0 else None
        axes.plot(*strip.T, color=colors.PURPLE, linewidth=0.7, label=label, gid=f"friction_cone_{i}")
    if len(space.sticking) > 0:
        axes.plot(
            *space.sticking.T, color=colors.BLUE, linestyle="--", label="sticking line", gid="sticking_line"
        )
    if len(space.compression) > 0:
        around = space.compression[[0, 1, 2, 3, 0]]
        axes.plot(
            *around.T, color=colors.ORANGE, linestyle="-.", label="compression plane", gid="compression"
        )
        x, y, z = (column.reshape(2, 2) for column in space.compression[[0, 1, 3, 2]].T)
        axes.plot_surface(x, y, z, color=colors.ORANGE, alpha=0.12, linewidth=0.0)
    axes.plot(*space.path.T, color=colors.BLACK, linewidth=2.2, label="impulse so far", gid="path")
    decimals = _DECIMALS - math.floor(math.log10(space.extent))  # what is below is rounding
    for i, (event, point) in enumerate(zip(space.events, space.points.tolist(), strict=True)):
        axes.plot(
            *([number] for number in point),
            linestyle="",
            marker=MARKERS[event],
            markersize=8.0,
            markerfacecolor="white",
            color=colors.BLACK,
            label=f"{EVENTS[event]}:\n({', '.join(f'{round(x, decimals) + 0.0:.3g}' for x in point)}) N s",
            gid=f"event_{i}",
        )
    axes.set_xlim(-space.extent, space.extent)
    axes.set_ylim(-space.extent, space.extent)
    axes.set_zlim(0.0, space.extent)
    axes.set_xlabel("along the tangential impulse, N s", labelpad=_ROOM)
    axes.set_ylabel("across, N s", labelpad=_ROOM)
    axes.set_zlabel("normal impulse, N s", labelpad=_ROOM)
    axes.locator_params(nbins=_TICKS)
    axes.set_aspect("equal")
    axes.view_init(elev=20.0, azim=-60.0)
    axes.set_title(f"{answer.body_name or 'a body'} {outcome_in_words(answer.impact.outcome)}")
    axes.legend(loc="upper left", bbox_to_anchor=(1.12, 1.0), frameon=False, fontsize="small")
