"""Draws Poinsot's rolling ellipsoid. `contact_dynamics.diagrams.poinsot` says what it shows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.poinsot import poinsot_figure
from contact_dynamics.rotations.one import rotation_matrix

if TYPE_CHECKING:
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
    from contact_dynamics.validation import FloatArray

_ROOM: Final = 8.0  # points between the numbers of an axis and its name
_TICKS: Final = 4  # numbers on each axis, few enough not to cover each other


def draw_poinsot(axes: Any, picture: Poinsot, curves: RollingCurves, state: BodyState) -> None:
    """Draw ellipsoid, plane, polhode and herpolhode of a body that rotates, rad/s.

    Args:
        axes: Axes in 3D, as ``figure.add_subplot(projection="3d")`` makes them. They have no type.
        picture: The constants of the rotation.
        curves: Polhode and herpolhode.
        state: The state at which the ellipsoid is drawn.
    """
    figure = poinsot_figure(picture, curves)
    R_WB = rotation_matrix(state.q_WB)

    def seen(points_W: FloatArray) -> FloatArray:
        turned: FloatArray = points_W @ figure.axes_W.T
        return turned

    for i, line in enumerate(figure.grid_W):
        label = "invariable plane" if i == 0 else None
        axes.plot(*seen(line).T, color=colors.AXIS, linewidth=0.7, label=label)
    for i, strip in enumerate(figure.net_B):
        label = "energy ellipsoid" if i == 0 else None
        axes.plot(*seen(strip @ R_WB.T).T, color=colors.GREY, linewidth=0.6, label=label)
    for name, points_W, color in (
        ("polhode", curves.polhode_B @ R_WB.T, colors.ORANGE),
        ("herpolhode", curves.herpolhode_W, colors.BLUE),
    ):
        axes.plot(*seen(points_W).T, color=color, linewidth=1.8, label=name, gid=name)
    for name, tip_W, color in (
        ("direction of the angular momentum", figure.foot_W, colors.BLACK),
        ("angular velocity", state.w_WB_W, colors.RED),
    ):
        tip = seen(tip_W)
        axes.quiver(0.0, 0.0, 0.0, *tip, color=color, arrow_length_ratio=0.08, linewidth=1.8, label=name)
    axes.set_xlabel("in the plane, rad/s", labelpad=_ROOM)
    axes.set_ylabel("in the plane, rad/s", labelpad=_ROOM)
    axes.set_zlabel("against the momentum, rad/s", labelpad=_ROOM)
    axes.locator_params(nbins=_TICKS)
    axes.set_aspect("equal")
    axes.view_init(elev=18.0, azim=-60.0)
    axes.set_title(f"rotation: {picture.regime.name.lower().replace('_', ' ')}")
    axes.legend(loc="upper left", bbox_to_anchor=(1.12, 1.0), frameon=False, fontsize="small")
