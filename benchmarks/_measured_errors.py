# SPDX-License-Identifier: Apache-2.0
"""Errors of predicted velocities over measured ones: tables, fitted constants, and MuJoCo beside us."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final, Protocol, TypeVar

import numpy as np
from scipy.optimize import minimize

from benchmarks._quotes import quote
from contact_dynamics.measured.cube_tosses import CUBE, HALF_SIDE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.rigid_body.body import BodyState, MassProperties
    from contact_dynamics.validation import FloatArray

GYRATION: Final = math.sqrt(float(CUBE.mass_properties.I_B[0, 0]) / CUBE.mass_properties.mass)
"""Length that weighs rad/s against m/s in the fit, m."""

STEP: Final = 1e-4
"""Step of MuJoCo, s."""


class Measured(Protocol):
    """Something that happened, and the velocities after it."""

    @property
    def after(self) -> FloatArray:
        """The velocities, (6,), m/s and rad/s."""


Case = TypeVar("Case", bound=Measured)


def print_head() -> None:
    """Print what the columns are."""
    print(f"{'':>28} {'mu':>6} {'e':>6} {'linear, m/s':>24} {'angular, rad/s':>24}")
    print(f"{'':>28} {'':>6} {'':>6} {'median':>8}{'mean':>8}{'90 %':>8} {'median':>8}{'mean':>8}{'90 %':>8}")


def print_both(
    name: str,
    training: Sequence[Case],
    held_out: Sequence[Case],
    nominal: tuple[float, float],
    predict: Callable[[Case, float, float], FloatArray],
    *,
    quoted: str = "",
) -> tuple[float, float]:
    """Print the errors with the published constants, mu and e, and with fitted ones. Return the fitted ones.

    With ``quoted``, the fitted ones' errors are offered to the documents by that name.
    """
    print_row(f"{name}, published", *nominal, held_out, lambda case: predict(case, *nominal))

    def cost(parameters: FloatArray) -> float:
        friction, restitution = abs(parameters[0]), min(abs(parameters[1]), 1.0)
        errors = np.array([predict(case, friction, restitution) - case.after for case in training])
        errors[:, 3:] *= GYRATION
        # Absolute errors, so that a few of another kind do not decide.
        return float(np.linalg.norm(errors, axis=1).mean())

    best = minimize(
        cost, nominal, method="Nelder-Mead", options={"xatol": 2e-3, "fatol": 1e-5, "maxfev": 60}
    ).x
    fitted = (abs(float(best[0])), min(abs(float(best[1])), 1.0))
    print_row(f"{name}, fitted", *fitted, held_out, lambda case: predict(case, *fitted), quoted=quoted)
    return fitted


def print_row(
    name: str,
    friction: float | str,
    restitution: float | str,
    cases: Sequence[Case],
    predict: Callable[[Case], FloatArray],
    *,
    quoted: str = "",
) -> None:
    """Print the errors of one prediction. With ``quoted``, offer their means to documents by that name."""
    errors = np.array([predict(case) - case.after for case in cases])
    text = f"{name:>28} "
    text += " ".join(f"{x:6.3f}" if isinstance(x, float) else f"{x:>6}" for x in (friction, restitution))
    for part, kind, unit in ((errors[:, :3], "linear", "m/s"), (errors[:, 3:], "angular", "rad/s")):
        sizes = np.linalg.norm(part, axis=1)
        if quoted:
            quote(f"{quoted}.{kind}", float(sizes.mean()), unit)
            quote(f"{quoted}.{kind}_median", float(np.median(sizes)), unit)
        text += " " + "".join(
            f"{x:8.3f}" for x in (np.median(sizes), sizes.mean(), np.percentile(sizes, 90.0))
        )
    print(text, flush=True)


class Engine:
    """MuJoCo with the cube and a floor.

    Its restitution is not a parameter: e sets the damping of the contact's spring so that the spring alone,
    against a wall, would give e.
    """

    def __init__(self, mujoco: Any, body: MassProperties, centre: FloatArray) -> None:
        """Build the model with the inertia about ``centre``, (3,), m, in the cube's axes."""
        x, y, z = -centre
        inertia = " ".join(str(x) for x in np.diag(body.I_B))
        self._mujoco = mujoco
        self._model = mujoco.MjModel.from_xml_string(f"""
            <mujoco>
              <option timestep="{STEP}" integrator="implicitfast" cone="elliptic" impratio="10"/>
              <worldbody>
                <geom name="floor" type="plane" size="5 5 1"/>
                <body name="cube">
                  <freejoint/>
                  <inertial pos="0 0 0" mass="{body.mass}" diaginertia="{inertia}"/>
                  <geom name="cube" type="box" pos="{x} {y} {z}" size="{HALF_SIDE} {HALF_SIDE} {HALF_SIDE}"/>
                </body>
              </worldbody>
            </mujoco>""")
        self._data = mujoco.MjData(self._model)

    def start(self, state: BodyState, friction: float, restitution: float, *, lower: float = 0.0) -> None:
        """Begin with a state, ``lower`` m lower."""
        logarithm = math.log(max(restitution, 1e-3))
        damping_ratio = -logarithm / math.hypot(math.pi, logarithm)
        model, data = self._model, self._data
        model.geom_friction[:, 0] = friction
        model.geom_solref[:] = (0.002, max(damping_ratio, 0.01))
        self._mujoco.mj_resetData(model, data)
        data.qpos[:3] = state.p_WB_W
        data.qpos[2] -= lower
        data.qpos[3:] = np.roll(state.q_WB, 1)  # to w, x, y, z
        data.qvel[:3] = state.v_WB_W
        data.qvel[3:] = state.R_WB.T @ state.w_WB_W

    def step(self) -> bool:
        """Take one step, and return whether the cube touches."""
        self._mujoco.mj_step(self._model, self._data)
        return bool(self._data.ncon)

    def velocity(self) -> FloatArray:
        """Return the velocities, (6,), m/s and rad/s, world axes."""
        data = self._data
        return np.concatenate([data.qvel[:3], data.body("cube").xmat.reshape(3, 3) @ data.qvel[3:]])


def engine(body: MassProperties, centre: FloatArray) -> Engine | None:
    """Return MuJoCo, or None if it is not installed."""
    try:
        import mujoco  # a peer, which need not be there
    except ImportError:
        return None
    return Engine(mujoco, body, centre)
