"""Draws a predicted trajectory over time: position, attitude, velocities, energy and momenta.

Components are in world axes. Times count from the stamp of the state that the prediction began with.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.diagrams import paper as colors
from contact_dynamics.diagrams.trajectory_curves import angular_momenta_of, energies_of, momenta_of
from contact_dynamics.plots.style import legend_beside

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from contact_dynamics.motion.covariance import CarriedCovariance
    from contact_dynamics.rigid_body.body import HasMassProperties
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray

DEVIATIONS: Final = 2.0
"""Half of the width of the bands of uncertainty, in standard deviations."""

_XYZ: Final = ("x", "y", "z")
_STYLES: Final = ("-", "--", "-.", ":")  # beside the colours, for print in grey


def draw_position(axes: Axes, trajectory: Trajectory, *, covariance: CarriedCovariance | None = None) -> None:
    """Draw the position of the centre of mass, m, with bands of two deviations if there is a covariance."""
    _draw_curves(axes, trajectory, trajectory.p_WB_W, _XYZ, "position, m")
    if covariance is None:
        return
    variances = np.diagonal(covariance.covariances[:, :3, :3], axis1=1, axis2=2)
    half = DEVIATIONS * np.sqrt(np.maximum(variances, 0.0))
    for i, name in enumerate(_XYZ):
        low, high = trajectory.p_WB_W[:, i] - half[:, i], trajectory.p_WB_W[:, i] + half[:, i]
        band = axes.fill_between(
            trajectory.seconds, low, high, color=colors.SERIES[i], alpha=0.25, linewidth=0.0
        )
        band.set_label(f"{name} ± {DEVIATIONS:g} deviations")
    legend_beside(axes)


def draw_attitude(axes: Axes, trajectory: Trajectory) -> None:
    """Draw the orientation as the components of its unit quaternion, body to world."""
    _draw_curves(axes, trajectory, trajectory.q_WB, (*_XYZ, "w"), "orientation, unit quaternion")


def draw_velocity(axes: Axes, trajectory: Trajectory) -> None:
    """Draw the velocity of the centre of mass, m/s."""
    _draw_curves(axes, trajectory, trajectory.v_WB_W, _XYZ, "velocity, m/s")


def draw_angular_velocity(axes: Axes, trajectory: Trajectory) -> None:
    """Draw the angular velocity, rad/s."""
    _draw_curves(axes, trajectory, trajectory.w_WB_W, _XYZ, "angular velocity, rad/s")


def draw_momentum(axes: Axes, trajectory: Trajectory, body: HasMassProperties) -> None:
    """Draw the momentum, kg m/s."""
    _draw_curves(axes, trajectory, momenta_of(body.mass_properties, trajectory), _XYZ, "momentum, kg m/s")


def draw_angular_momentum(axes: Axes, trajectory: Trajectory, body: HasMassProperties) -> None:
    """Draw the angular momentum about the centre of mass, kg m²/s."""
    rows = angular_momenta_of(body.mass_properties, trajectory)
    _draw_curves(axes, trajectory, rows, _XYZ, "angular momentum, kg m²/s")


def draw_energy(
    axes: Axes, trajectory: Trajectory, body: HasMassProperties, *, gravity_W: FloatArray
) -> None:
    """Draw the kinetic energies, the potential energy and their sum, J.

    ``gravity_W`` is (3,), m/s^2. The potential energy is zero at the origin of the world.
    """
    energies = energies_of(body.mass_properties, trajectory, gravity_W=gravity_W)
    rows = np.column_stack([energies.translational, energies.rotational, energies.potential, energies.total])
    _draw_curves(axes, trajectory, rows, ("translation", "rotation", "potential", "sum"), "energy, J")


def _draw_curves(
    axes: Axes, trajectory: Trajectory, rows: FloatArray, names: Sequence[str], quantity: str
) -> None:
    marker = "o" if len(trajectory) == 1 else None  # a line through one point is not seen
    for i, name in enumerate(names):
        axes.plot(
            trajectory.seconds,
            rows[:, i],
            color=colors.SERIES[i],
            linestyle=_STYLES[i],
            marker=marker,
            label=name,
            gid=f"{quantity.partition(',')[0].replace(' ', '_')}_{name}",
        )
    axes.set_xlabel("time after the state, s")
    axes.set_ylabel(quantity)
    axes.grid(visible=True, color=colors.AXIS, linewidth=0.6)
    legend_beside(axes)
