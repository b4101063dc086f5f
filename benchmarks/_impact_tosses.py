"""How well each law predicts the velocity after measured impacts of a cube, beside "no impact" and MuJoCo.

The recordings are the published cube tosses (`contact_dynamics.demo.cube_tosses`); the environment variable
CUBE_TOSSES names their `tosses.npz`. Strikes of a single corner are cut out of them with the states just
before and after, each fitted over the flight next to it (`measured_events`). mu and e are fitted on the
strikes of every other toss; the errors are those on the rest.

What limits the error: not the measurement, whose standard deviation is printed, but the published body.
Whatever the law, the impulse at the corner changes momentum and angular momentum together, and with the
published inertia and centre these two changes disagree. So inertia and centre of mass are also fitted to that
balance alone, without any law, and the errors are given with them too.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np
from scipy.optimize import minimize

from contact_dynamics.demo.cube_tosses import BOARD, CUBE, HALF_SIDE, read_cube_toss
from contact_dynamics.demo.measured_events import measure_events
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import RestitutionLaw, spatial_impact
from contact_dynamics.rigid_body import BodyState, MassProperties

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.validation import FloatArray

Prediction: TypeAlias = "Callable[[Strike, float, float], FloatArray]"

TOSSES: Final = 360
ALONE: Final = 0.01
"""m. A strike is a single corner's if the next corner was at least this much higher."""

SHARPEST: Final = 0.15
"""m/s, rad/s times the radius of gyration. Strikes whose velocities are known less well are left out."""

GYRATION: Final = math.sqrt(float(CUBE.mass_properties.I_B[0, 0]) / CUBE.mass_properties.mass)
"""m. Weighs rad/s against m/s in the fit."""


class Strike(NamedTuple):
    """One measured impact of one corner."""

    toss: int
    before: BodyState
    corner: FloatArray  # (3,), m, world
    after: FloatArray  # (6,), m/s and rad/s, measured
    noise: FloatArray  # (2,), m/s and rad/s, standard deviation of the change


def run() -> None:
    """Print the errors, or how to get the recordings."""
    path = Path(
        os.environ.get("CUBE_TOSSES", Path(__file__).parents[2] / "shared/data/cube_tosses/tosses.npz")
    )
    if not path.is_file():
        print("Measured impacts: set CUBE_TOSSES to the recordings' tosses.npz")
        return
    strikes, found = measured_strikes(path)
    training = [strike for strike in strikes if strike.toss % 2 == 0]
    held_out = [strike for strike in strikes if strike.toss % 2 == 1]
    noise = np.median([strike.noise for strike in strikes], axis=0)
    print(
        f"Measured impacts: {found} strikes, {len(strikes)} of a single corner and well measured; fitted on"
        f" {len(training)}, errors on {len(held_out)}"
    )
    print(
        f"Measurement: {noise[0]:.3f} m/s, {noise[1]:.2f} rad/s (median standard deviation of a component)\n"
    )
    print(f"{'':>28} {'mu':>6} {'e':>6} {'linear, m/s':>24} {'angular, rad/s':>24}")
    print(f"{'':>28} {'':>6} {'':>6} {'median':>8}{'mean':>8}{'90 %':>8} {'median':>8}{'mean':>8}{'90 %':>8}")
    _row("no impact", "", "", held_out, lambda strike: _velocity(strike.before))
    _predictions(CUBE.mass_properties, np.zeros(3), training, held_out)
    body, centre = balanced_body(training)
    print(
        f"\nMomentum balance of the training strikes: inertia {body.I_B[0, 0]:.2e} kg m^2 (published"
        f" {CUBE.mass_properties.I_B[0, 0]:.2e}),\ncentre of mass at"
        f" ({', '.join(f'{1e3 * x:.1f}' for x in centre)}) mm in the cube. With these:"
    )
    _predictions(
        body,
        centre,
        [about_centre(strike, centre) for strike in training],
        [about_centre(strike, centre) for strike in held_out],
    )


def _predictions(
    body: MassProperties, centre: FloatArray, training: Sequence[Strike], held_out: Sequence[Strike]
) -> None:
    nominal = (BOARD.friction, BOARD.restitution)
    for law in RestitutionLaw:
        _both(law.name.lower(), training, held_out, nominal, _rigid(body, law))
    engine = _engine(body, centre)
    if engine is None:
        print(f"{'MuJoCo':>28}  is not installed")
    else:
        _both("MuJoCo", training, held_out, nominal, engine)


def measured_strikes(path: Path) -> tuple[list[Strike], int]:
    """Return the strikes of a single corner that are measured well, and how many strikes there were."""
    strikes = []
    found = 0
    for index in range(TOSSES):
        for strike in measure_events(read_cube_toss(path, index=index)).strikes:
            found += 1
            linear = math.hypot(strike.before.velocity_std, strike.after.velocity_std)
            angular = math.hypot(
                *(float(np.max(state.angular_velocity_std)) for state in (strike.before, strike.after))
            )
            if strike.margin < ALONE or max(linear, GYRATION * angular) > SHARPEST:
                continue
            before = strike.before.state
            corner = before.p_WB_W + before.R_WB @ CUBE.vertices_B[strike.corner]
            if before.velocity_of_point(corner)[2] < 0.0:
                after = _velocity(strike.after.state)
                strikes.append(Strike(index, before, corner, after, np.array([linear, angular])))
    return strikes, found


def balanced_body(strikes: Sequence[Strike]) -> tuple[MassProperties, FloatArray]:
    """Return the (isotropic) inertia and the centre of mass, (3,), m, body axes, that balance momenta best.

    With d the centre and c the corner, both from the tracked origin, I dw = m (c - d) x dv, where dv is the
    centre's: linear in 1/I and d/I where dv is known, so that a few rounds do.
    """
    mass, nominal = CUBE.mass_properties.mass, float(CUBE.mass_properties.I_B[0, 0])
    centre = np.zeros(3)
    share = 1.0
    for _ in range(5):
        rows, changes = [], []
        for strike in strikes:
            moved = about_centre(strike, centre)
            dv, dw = np.split(moved.after - _velocity(moved.before), 2)
            lever = strike.corner - strike.before.p_WB_W
            columns = [lever, *(-strike.before.R_WB.T)]
            rows.append(np.column_stack([np.cross(column, dv) for column in columns]) * mass / nominal)
            changes.append(dw)
        solution = np.linalg.lstsq(np.concatenate(rows), np.concatenate(changes), rcond=None)[0]
        share, centre = float(solution[0]), solution[1:] / solution[0]
    return MassProperties(mass=mass, I_B=CUBE.mass_properties.I_B / share), centre


def about_centre(strike: Strike, centre: FloatArray) -> Strike:
    """Return the strike with its states at ``centre``, (3,), m, body axes, in place of the tracked origin."""
    before = strike.before
    offset = before.R_WB @ centre
    moved = replace(
        before, p_WB_W=before.p_WB_W + offset, v_WB_W=before.v_WB_W + np.cross(before.w_WB_W, offset)
    )
    after = strike.after + np.concatenate([np.cross(strike.after[3:], offset), np.zeros(3)])
    return strike._replace(before=moved, after=after)


def _velocity(state: BodyState) -> FloatArray:
    return np.concatenate([state.v_WB_W, state.w_WB_W])


def _rigid(body: MassProperties, law: RestitutionLaw) -> Prediction:
    def predict(strike: Strike, friction: float, restitution: float) -> FloatArray:
        try:
            answer = spatial_impact(
                body,
                strike.before,
                p_WC_W=strike.corner,
                n_W=[0.0, 0.0, 1.0],
                friction=friction,
                restitution=restitution,
                law=law,
            )
        except SeparatingContactError:
            return _velocity(strike.before)
        return _velocity(answer.state)

    return predict


def _both(
    name: str,
    training: Sequence[Strike],
    held_out: Sequence[Strike],
    nominal: tuple[float, float],
    predict: Prediction,
) -> None:
    """Print the errors with the published constants and with fitted ones."""
    _row(f"{name}, published", *nominal, held_out, lambda strike: predict(strike, *nominal))

    def cost(parameters: FloatArray) -> float:
        friction, restitution = abs(parameters[0]), min(abs(parameters[1]), 1.0)
        errors = np.array([predict(strike, friction, restitution) - strike.after for strike in training])
        errors[:, 3:] *= GYRATION
        # Absolute errors, so that a few strikes of another kind do not decide.
        return float(np.linalg.norm(errors, axis=1).mean())

    best = minimize(
        cost, nominal, method="Nelder-Mead", options={"xatol": 2e-3, "fatol": 1e-5, "maxfev": 60}
    ).x
    fitted = (abs(float(best[0])), min(abs(float(best[1])), 1.0))
    _row(f"{name}, fitted", *fitted, held_out, lambda strike: predict(strike, *fitted))


def _row(
    name: str,
    friction: float | str,
    restitution: float | str,
    strikes: Sequence[Strike],
    predict: Callable[[Strike], FloatArray],
) -> None:
    errors = np.array([predict(strike) - strike.after for strike in strikes])
    text = f"{name:>28} "
    text += " ".join(f"{x:6.3f}" if isinstance(x, float) else f"{x:>6}" for x in (friction, restitution))
    for part in (errors[:, :3], errors[:, 3:]):
        sizes = np.linalg.norm(part, axis=1)
        text += " " + "".join(
            f"{x:8.3f}" for x in (np.median(sizes), sizes.mean(), np.percentile(sizes, 90.0))
        )
    print(text, flush=True)


def _engine(body: MassProperties, centre: FloatArray) -> Prediction | None:
    """Return a prediction by MuJoCo, stepped until the cube has left the floor; None: not installed.

    Its restitution is not a parameter: e sets the damping of the contact's spring so that the spring alone,
    against a wall, would give e.
    """
    try:
        import mujoco
    except ImportError:
        return None
    x, y, z = -centre
    inertia = " ".join(str(x) for x in np.diag(body.I_B))
    model = mujoco.MjModel.from_xml_string(f"""
        <mujoco>
          <option timestep="0.0001" integrator="implicitfast" cone="elliptic" impratio="10"/>
          <worldbody>
            <geom name="floor" type="plane" size="5 5 1"/>
            <body name="cube">
              <freejoint/>
              <inertial pos="0 0 0" mass="{body.mass}" diaginertia="{inertia}"/>
              <geom name="cube" type="box" pos="{x} {y} {z}" size="{HALF_SIDE} {HALF_SIDE} {HALF_SIDE}"/>
            </body>
          </worldbody>
        </mujoco>""")
    data = mujoco.MjData(model)
    longest = 300  # steps, 30 ms: by then a strike of a corner is over, or it is none

    def predict(strike: Strike, friction: float, restitution: float) -> FloatArray:
        logarithm = math.log(max(restitution, 1e-3))
        damping_ratio = -logarithm / math.hypot(math.pi, logarithm)
        model.geom_friction[:, 0] = friction
        model.geom_solref[:] = (0.002, max(damping_ratio, 0.01))
        mujoco.mj_resetData(model, data)
        data.qpos[:3] = strike.before.p_WB_W
        data.qpos[2] -= strike.corner[2] - 1e-5
        data.qpos[3:] = np.roll(strike.before.q_WB, 1)  # to w, x, y, z
        data.qvel[:3] = strike.before.v_WB_W
        data.qvel[3:] = strike.before.R_WB.T @ strike.before.w_WB_W
        touched = False
        for _ in range(longest):
            mujoco.mj_step(model, data)
            if data.ncon:
                touched = True
            elif touched:
                break
        turned = data.body("cube").xmat.reshape(3, 3)
        return np.concatenate([data.qvel[:3], turned @ data.qvel[3:]])

    return predict
