"""This file finds energies and momenta over a trajectory, from its states and the body's mass properties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.constants import seconds_since
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tumbling import Trajectory

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray


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
