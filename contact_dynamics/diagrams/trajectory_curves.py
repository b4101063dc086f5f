# SPDX-License-Identifier: Apache-2.0
"""Quantities over a trajectory: energies and momenta from the body's mass properties, and their diagrams."""

from __future__ import annotations

from dataclasses import dataclass
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
    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


DEVIATIONS: Final = 2.0
"""Half of the width of the bands of uncertainty, in standard deviations."""

_DASHES: Final = ("-", "--", "-.", ":")  # beside the colours, for print in grey
_MARGIN: Final = 0.05  # room about the curves, relative to their extent
_ROUNDING: Final = 1e-9  # relative: what differs by less is rounding


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Energies:
    """Energies at the n times of a trajectory, J.

    Attributes:
        translational: (n,), m v^2 / 2.
        rotational: (n,), w . L / 2.
        potential: (n,), -m g . p, which is zero at the origin of the world.
    """

    translational: FloatArray
    rotational: FloatArray
    potential: FloatArray

    @property
    def total(self) -> FloatArray:
        """Return their sum, (n,), J."""
        return self.translational + self.rotational + self.potential


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


def energies_of(body: MassProperties, trajectory: Trajectory, *, gravity_W: FloatArray) -> Energies:
    """Return the energies over a trajectory. ``gravity_W`` is (3,), m/s^2, world axes."""
    L_W = angular_momenta_of(body, trajectory)
    return Energies(
        translational=0.5 * body.mass * np.einsum("ni,ni->n", trajectory.v_WB_W, trajectory.v_WB_W),
        rotational=0.5 * np.einsum("ni,ni->n", trajectory.w_WB_W, L_W),
        potential=-body.mass * trajectory.p_WB_W @ gravity_W,
    )


def over_time(
    trajectory: Trajectory,
    rows: FloatArray,
    quantity: str,
    names: Sequence[str] = ("x", "y", "z"),
    *,
    deviations: FloatArray | None = None,
) -> Diagram:
    """Return the diagram of a quantity over a trajectory.

    Args:
        trajectory: The trajectory, which has a sample.
        rows: (n, k), the values.
        quantity: What they are, with the unit.
        names: (k,), what each column is.
        deviations: (n, k), standard deviations, for bands of `DEVIATIONS` to each side, or None.
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
