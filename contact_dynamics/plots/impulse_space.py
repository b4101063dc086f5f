"""Draws an impact in impulse space. `contact_dynamics.diagrams.impulse_space` says what it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.diagrams.impulse_space import BELOW, EVENTS, impulse_space_of, line_in_box, main_contact
from contact_dynamics.diagrams.words import outcome_in_words
from contact_dynamics.impact.law import PathEvent
from contact_dynamics.plots import colors
from contact_dynamics.plots.style import legend_beside, lines_through_zero

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.rigid_body.body import HasMassProperties

MARKERS: Final = {
    PathEvent.SLIDING_STOPS: "s",
    PathEvent.COMPRESSION_ENDS: "o",
    PathEvent.RESTITUTION_ENDS: "^",
}
"""How the events of a path are marked."""


def draw_impulse_space(
    axes: Axes,
    body: HasMassProperties | None,
    answer: ImpactAnswer,
    *,
    other: HasMassProperties | None = None,
) -> None:
    """Draw the impulse path of an impact's main contact, N s, with what bounds and bends it.

    In space, path and sticking line are projected onto the plane of the normal and the total impulse, and the
    legend says so.

    Args:
        axes: The axes to draw into.
        body: The body, or its mass properties. If it is None, there are no sticking and compression lines.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it there are no lines for two bodies.
    """
    masses, other_masses = (one.mass_properties if one is not None else None for one in (body, other))
    space = impulse_space_of(masses, answer, other=other_masses)
    projected, cut = (", projected", ", cut") if space.in_space else ("", "")
    lines_through_zero(axes)
    friction = float(answer.contacts.frictions[main_contact(answer.impact)])
    axes.fill(*space.cone.T, color=colors.PURPLE, alpha=0.12, linewidth=0.0)
    axes.plot(
        *space.cone.T, color=colors.PURPLE, label=f"friction cone, μ = {friction:.3g}", gid="friction_cone"
    )
    for name, style, color, lines in (
        (f"sticking line{projected}", "--", colors.BLUE, space.sticking),
        (
            f"{'compression plane' if space.in_space else 'compression line'}{cut}",
            "-.",
            colors.ORANGE,
            space.compression,
        ),
    ):
        for i, part in enumerate(part for line in lines for part in line_in_box(line, space.extent)):
            axes.plot(
                *part.T,
                color=color,
                linestyle=style,
                label=name if i == 0 else None,
                gid=f"{name.partition(',')[0].replace(' ', '_')}_{i}",
            )
    axes.plot(
        *space.path.T, color=colors.BLACK, linewidth=2.2, label=f"impulse so far{projected}", gid="path"
    )
    for i, (event, (t, n)) in enumerate(zip(space.events, space.points.tolist(), strict=True)):
        axes.plot(
            [t],
            [n],
            linestyle="",
            marker=MARKERS[event],
            markersize=8.0,
            markerfacecolor="white",
            color=colors.BLACK,
            label=f"{EVENTS[event]}:\n({t:.3g}, {n:.3g}) N s",
            gid=f"event_{i}",
            zorder=3.0,
        )
    axes.set_aspect("equal")
    axes.set_xlim(-space.extent, space.extent)
    axes.set_ylim(-BELOW * space.extent, space.extent)
    axes.set_xlabel("tangential impulse, N s")
    axes.set_ylabel("normal impulse, N s")
    axes.set_title(f"{answer.body_name or 'a body'} {outcome_in_words(answer.impact.outcome)}")
    legend_beside(axes)
