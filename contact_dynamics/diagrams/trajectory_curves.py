# SPDX-License-Identifier: Apache-2.0
"""Quantities over a trajectory: energies and momenta from the body's mass properties, and their diagrams."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import seconds_since
from contact_dynamics.diagrams import palette, paper
from contact_dynamics.diagrams.marks import Axis, Diagram, Faces, Lines, Points
from contact_dynamics.diagrams.palette import Paint
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tumbling import Trajectory

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.motion.covariance import CarriedCovariance
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties, MassProperties
    from contact_dynamics.validation import FloatArray


DEVIATIONS: Final = 2.0  # half of the width of the bands of uncertainty, in standard deviations
_DASHES: Final = ("-", "--", "-.", ":")  # beside the colours, for print in grey
_MARGIN: Final = 0.05  # room about the curves, relative to their extent
_ROUNDING: Final = 1e-9  # relative: what differs by less is rounding


def trajectory_of(states: Sequence[BodyState]) -> Trajectory:
    """Return states that were published one after another as a trajectory, s after the first."""
    stamps_ns = [state.stamp_ns for state in states]
    return Trajectory(
        seconds=seconds_since(stamps_ns[0], stamps_ns),
        p_WB_W=np.array([state.p_WB_W for state in states]),
        q_WB=np.array([state.q_WB for state in states]),
        v_WB_W=np.array([state.v_WB_W for state in states]),
        w_WB_W=np.array([state.w_WB_W for state in states]),
    )


def angular_momenta_of(body: MassProperties, trajectory: Trajectory) -> FloatArray:
    """Return the angular momenta about the centre of mass, (n, 3), kg m^2/s, world axes."""
    R_WB = matrices_of(trajectory.q_WB)
    w_B = np.einsum("nji,nj->ni", R_WB, trajectory.w_WB_W)
    momenta: FloatArray = np.einsum("nij,nj->ni", R_WB, w_B @ body.I_B)
    return momenta


def momenta_of(body: MassProperties, trajectory: Trajectory) -> FloatArray:
    """Return the momenta, (n, 3), kg m/s, world axes."""
    return body.mass * trajectory.v_WB_W


def energies_of(body: MassProperties, trajectory: Trajectory, *, gravity_W: FloatArray) -> FloatArray:
    """Return the energies of translation and rotation, the potential energy and their sum, (n, 4), J.

    ``gravity_W`` is (3,), m/s^2, world axes. The potential energy is zero at the origin of the world.
    """
    L_W = angular_momenta_of(body, trajectory)
    translation = 0.5 * body.mass * np.einsum("ni,ni->n", trajectory.v_WB_W, trajectory.v_WB_W)
    rotation = 0.5 * np.einsum("ni,ni->n", trajectory.w_WB_W, L_W)
    potential = -body.mass * trajectory.p_WB_W @ gravity_W
    return np.column_stack([translation, rotation, potential, translation + rotation + potential])


def position(trajectory: Trajectory, *, covariance: CarriedCovariance | None = None) -> Diagram:
    """Return the position of the centre of mass, m, with bands of two deviations for a covariance."""
    deviations = None
    if covariance is not None:
        variances = np.diagonal(covariance.covariances[:, :3, :3], axis1=1, axis2=2)
        deviations = np.sqrt(np.maximum(variances, 0.0))
    return over_time(trajectory, trajectory.p_WB_W, "position, m", deviations=deviations)


def attitude(trajectory: Trajectory) -> Diagram:
    """Return the orientation as the components of its unit quaternion, body to world."""
    return over_time(trajectory, trajectory.q_WB, "orientation, unit quaternion", "xyzw")


def velocity(trajectory: Trajectory) -> Diagram:
    """Return the velocity of the centre of mass, m/s."""
    return over_time(trajectory, trajectory.v_WB_W, "velocity, m/s")


def angular_velocity(trajectory: Trajectory) -> Diagram:
    """Return the angular velocity, rad/s."""
    return over_time(trajectory, trajectory.w_WB_W, "angular velocity, rad/s")


def momentum(trajectory: Trajectory, body: HasMassProperties) -> Diagram:
    """Return the momentum, kg m/s."""
    return over_time(trajectory, momenta_of(body.mass_properties, trajectory), "momentum, kg m/s")


def angular_momentum(trajectory: Trajectory, body: HasMassProperties) -> Diagram:
    """Return the angular momentum about the centre of mass, kg m²/s."""
    momenta = angular_momenta_of(body.mass_properties, trajectory)
    return over_time(trajectory, momenta, "angular momentum, kg m²/s")


def energy(trajectory: Trajectory, body: HasMassProperties, *, gravity_W: FloatArray) -> Diagram:
    """Return the energies of `energies_of`, J."""
    rows = energies_of(body.mass_properties, trajectory, gravity_W=gravity_W)
    return over_time(trajectory, rows, "energy, J", ("translation", "rotation", "potential", "sum"))


def over_time(
    trajectory: Trajectory,
    rows: FloatArray,
    quantity: str,
    names: Sequence[str] = ("x", "y", "z"),
    *,
    deviations: FloatArray | None = None,
) -> Diagram:
    """Return the diagram of a quantity, named with its unit, over a trajectory that has a sample.

    ``rows``, (n, k), are the values, and ``names``, (k,), what each column is. For standard deviations, (n,
    k), there are bands of `DEVIATIONS` to each side.
    """
    half = DEVIATIONS * (np.zeros_like(rows) if deviations is None else deviations)
    marks: list[Mark] = []
    for i, name in enumerate(names):
        paint = Paint(palette.BODIES[i], paper.SERIES[i])
        places = np.column_stack([trajectory.seconds, rows[:, i]])
        gid = f"{quantity.partition(',')[0].replace(' ', '_')}_{name}"
        if len(trajectory) == 1:  # a line through one point is not seen
            marks.append(Points(gid, paint, places, legend=name))
        else:
            marks.append(Lines(gid, paint, [places], width=1.9, dash=_DASHES[i], legend=name))
        if deviations is not None:
            low, high = places - [0.0, 1.0] * half[:, i, None], places + [0.0, 1.0] * half[:, i, None]
            legend = f"{name} ± {DEVIATIONS:g} deviations"
            band = np.vstack([low, high[::-1]])
            marks.append(Faces(f"{gid}_band", paint, band, opacity=0.25, legend=legend))
    everything = np.concatenate([rows, rows - half, rows + half])
    axes = (
        _axis("time after the state, s", trajectory.seconds),
        _axis(quantity, everything[np.isfinite(everything)]),
    )
    return Diagram(marks=marks, axes=axes, is_equal=False)


def _axis(name: str, values: FloatArray) -> Axis:
    """Return an axis that has room about values. It does not magnify rounding."""
    low, high = float(values.min()), float(values.max())
    margin = max(_MARGIN * (high - low), _ROUNDING * max(abs(low), abs(high))) or 1.0
    return Axis(name, low - margin, high + margin)
