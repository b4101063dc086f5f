# SPDX-License-Identifier: Apache-2.0
"""How well each law predicts the velocity after measured impacts of a cube, beside "no impact" and MuJoCo.

The recordings are the published cube tosses (`measured.cube_tosses`); the environment variable CUBE_TOSSES
names their `tosses.npz`. Strikes of a single corner are cut out of them with the states just before and
after, each fitted over the flight next to it (`measured.events`). mu and e are fitted on the strikes of every
other toss. The errors are those on the rest.

The published body limits the error, and not the measurement, whose standard deviation is printed. Under any
law the impulse at the corner changes momentum and angular momentum together. With the published inertia and
centre these two changes disagree. So inertia and centre of mass are also fitted to that balance alone,
without any law, and the errors are given with them too.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from benchmarks import _impact_landings
from benchmarks._measured_errors import GYRATION, engine, print_both, print_head, print_row
from contact_dynamics.contact.contact import Contact
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import RestitutionLaw, spatial_impact
from contact_dynamics.measured.cube_tosses import BOARD, CUBE, read_cube_toss
from contact_dynamics.measured.flights import find_strikes
from contact_dynamics.rigid_body.body import BodyState, MassProperties

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.validation import FloatArray

Prediction: TypeAlias = "Callable[[Strike, float, float], FloatArray]"

TOSSES: Final = 360
ALONE: Final = 0.01
"""m. A strike is a single corner's if the next corner was at least this much higher."""

SHARPEST: Final = 0.15
"""m/s, and rad/s times the radius of gyration. Strikes with larger errors of velocities are left out."""


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
    print_head()
    print_row("no impact", "", "", held_out, lambda strike: _velocity(strike.before))
    as_published = _predictions(CUBE.mass_properties, np.zeros(3), training, held_out)
    body, centre = balanced_body(training)
    print(
        f"\nMomentum balance of the training strikes: inertia {body.I_B[0, 0]:.2e} kg m^2 (published"
        f" {CUBE.mass_properties.I_B[0, 0]:.2e}),\ncentre of mass at"
        f" ({', '.join(f'{1e3 * x:.1f}' for x in centre)}) mm in the cube. With these:"
    )
    as_balanced = _predictions(
        body,
        centre,
        [about_centre(strike, centre) for strike in training],
        [about_centre(strike, centre) for strike in held_out],
    )
    landings = [
        landing
        for landing in _impact_landings.measured_landings(path, TOSSES)
        if max(landing.velocity_std, GYRATION * landing.spin_std) <= SHARPEST
    ]
    _impact_landings.compare(landings, body, centre, of_one_corner=(as_published, as_balanced))


def _predictions(
    body: MassProperties, centre: FloatArray, training: Sequence[Strike], held_out: Sequence[Strike]
) -> tuple[float, float]:
    """Print the errors of each law, and return mu and e as fitted under the first."""
    nominal = (BOARD.friction, BOARD.restitution)
    fitted = [
        print_both(law.name.lower(), training, held_out, nominal, _rigid(body, law)) for law in RestitutionLaw
    ]
    by_engine = _by_engine(body, centre)
    if by_engine is None:
        print(f"{'MuJoCo':>28}  is not installed")
    else:
        print_both("MuJoCo", training, held_out, nominal, by_engine)
    return fitted[0]


def measured_strikes(path: Path) -> tuple[list[Strike], int]:
    """Return the strikes of a single corner that are measured well, and how many strikes there were."""
    strikes = []
    found = 0
    for index in range(TOSSES):
        for strike in find_strikes(read_cube_toss(path, index=index)):
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

    With d the centre and c the corner, both from the tracked origin, I dw = m (c - d) x dv, where dv is that
    of the centre. If dv is known, this is linear in 1/I and d/I, so a few rounds are enough.
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
                Contact(
                    p_WC_W=strike.corner, normal_W=[0.0, 0.0, 1.0], friction=friction, restitution=restitution
                ),
                restitution_law=law,
            )
        except SeparatingContactError:
            return _velocity(strike.before)
        return _velocity(answer.state)

    return predict


def _by_engine(body: MassProperties, centre: FloatArray) -> Prediction | None:
    """Return a prediction by MuJoCo, stepped until the cube has left the floor, or None without MuJoCo."""
    cube = engine(body, centre)
    if cube is None:
        return None
    longest = 300  # steps, 30 ms: by then a strike of a corner is over, or it is none

    def predict(strike: Strike, friction: float, restitution: float) -> FloatArray:
        cube.start(strike.before, friction, restitution, lower=float(strike.corner[2]) - 1e-5)
        touched = False
        for _ in range(longest):
            touches = cube.step()
            if touched and not touches:
                break
            touched = touched or touches
        return cube.velocity()

    return predict
