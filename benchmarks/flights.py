# SPDX-License-Identifier: Apache-2.0
"""Recorded flights: the pose at their end, predicted from their first part, beside what was measured.

Each flight is fitted over its first half (`fit_free_motion`, poses alone) and predicted to its last frame.
The error is the distance to the measured pose there. The noise of that pose is printed beside it, and so is
the error that the fit's covariance predicts: its standard deviation, carried along the motion, together with
the noise of the pose at the end. "Newest velocity" predicts from the newest state of that half as a tracker
publishes it. "At rest" assumes that the body stays where it is.

For the cube, `_flight_coverage` prints how often poses of held-out flights are in the regions predicted for
them.

The brick's flights come with the package (MuJoCo with the noise of motion capture). The measured tosses of a
cube are read where CUBE_TOSSES names their `.npz`, or the folder that holds it, or from beside the checkout.
That cube falls at less than 9.81 m/s^2 in its recordings, whose lengths or times are off by as much; "as it
falls" takes one acceleration for all its flights, the median of their first halves.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from benchmarks._flight_coverage import flight_coverage
from benchmarks._quotes import quote
from contact_dynamics.constants import seconds_since
from contact_dynamics.measured.cube_tosses import read_cube_toss
from contact_dynamics.measured.flights import find_flights
from contact_dynamics.measured.read_toss import read_toss
from contact_dynamics.measured.recorded_toss import Toss
from contact_dynamics.motion.covariance import propagate_covariance
from contact_dynamics.motion.free_fit import FitResult, fit_free_motion
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.tumbling import free_motion

FILE = "tosses.npz"
BESIDE = Path(__file__).parents[2] / "shared" / "data" / "cube_tosses" / FILE
FEWEST_FRAMES = 16
COUNT = 360


@dataclass(frozen=True, slots=True)
class Half:
    """The first half of a flight, and its last frame."""

    toss: Toss
    states: list[BodyState]
    end: BodyState
    ahead: float  # s, from the last of the states to the end

    def error(self, predicted: BodyState) -> tuple[float, float]:
        """Return how far a predicted end is off, m and rad."""
        turn = rotation_vectors(predicted.q_WB[None], self.end.q_WB)[0]
        return float(np.linalg.norm(predicted.p_WB_W - self.end.p_WB_W)), float(np.linalg.norm(turn))

    def flown(self, state: BodyState, gravity_W: NDArray[np.float64]) -> BodyState:
        """Return a state's free flight to the end."""
        return free_motion(self.toss.body.mass_properties, state, gravity_W=gravity_W).state_at(self.ahead)

    def fitted(self, gravity_W: NDArray[np.float64]) -> FitResult:
        """Return the free motion that fits the half."""
        return fit_free_motion(self.toss.body.mass_properties, self.states, gravity_W=gravity_W)

    def fall(self) -> float:
        """Return the acceleration down, m/s^2, of a parabola fitted to the half."""
        times = seconds_since(self.states[0].stamp_ns, [state.stamp_ns for state in self.states])
        powers = np.column_stack([np.ones_like(times), times, -0.5 * times * times])
        heights = np.array([state.p_WB_W[2] for state in self.states])
        return float(np.linalg.lstsq(powers, heights, rcond=None)[0][2])


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors at the ends of flights by method, m and rad each, and what they are to be compared with."""

    noise: tuple[float, float]  # m and rad, of a measured pose
    ahead: list[float] = field(default_factory=list)  # s
    found: dict[str, list[tuple[float, float]]] = field(default_factory=dict)

    def medians(self, method: str) -> tuple[float, float]:
        """Return the median errors of a method, m and rad."""
        position, attitude = np.median(self.found[method], axis=0).tolist()
        return position, attitude


def run() -> None:
    """Print the errors of both recordings."""
    _report("brick", end_errors([read_toss()]))
    path = cube_tosses()
    if not path.is_file():
        print(f"no measured tosses: {path} is missing; CUBE_TOSSES=path names them")
        return
    tosses = (read_cube_toss(path, index=index) for index in range(COUNT))
    _report("measured cube", end_errors(tosses, as_it_falls=True))
    flight_coverage(path)


def cube_tosses() -> Path:
    """Return the path at which the measured tosses should be."""
    named = Path(os.environ.get("CUBE_TOSSES", BESIDE))
    return named / FILE if named.is_dir() else named


def end_errors(tosses: Iterable[Toss], *, as_it_falls: bool = False) -> Errors:
    """Predict the end of each flight of at least `FEWEST_FRAMES` from its first half."""
    halves = [half for toss in tosses for half in _halves(toss)]
    toss = halves[0].toss
    errors = Errors(noise=(math.sqrt(3.0) * toss.position_noise, math.sqrt(3.0) * toss.orientation_noise))
    falling = np.array([0.0, 0.0, -float(np.median([half.fall() for half in halves]))])
    for half in halves:
        errors.ahead.append(half.ahead)
        nominal = half.toss.gravity_W
        fit = half.fitted(nominal)
        row = {
            "fit": half.error(half.flown(fit.state, nominal)),
            "what it expects": _expected(half, fit, errors.noise),
            "newest velocity": half.error(half.flown(half.states[-1], nominal)),
            "at rest": half.error(half.states[-1]),
        }
        if as_it_falls:
            row["fit, as it falls"] = half.error(half.flown(half.fitted(falling).state, falling))
        for method, error in row.items():
            errors.found.setdefault(method, []).append(error)
    return errors


def _halves(toss: Toss) -> list[Half]:
    found = []
    for flight in find_flights(toss):
        if flight.stop - flight.start >= FEWEST_FRAMES:
            half, last = (flight.start + flight.stop) // 2, flight.stop - 1
            states = [toss.state(i) for i in range(flight.start, half)]
            ahead = float(toss.times[last] - toss.times[half - 1])
            found.append(Half(toss, states, toss.state(last), ahead))
    return found


def _expected(half: Half, fit: FitResult, noise: tuple[float, float]) -> tuple[float, float]:
    """Return the root mean square errors, m and rad, that the fit's covariance predicts."""
    body = half.toss.body.mass_properties
    carried = propagate_covariance(
        body, fit.state, fit.covariance, [half.ahead], gravity_W=half.toss.gravity_W
    )
    variances = carried.covariances[0].diagonal()
    position, attitude = float(variances[:3].sum()), float(variances[3:6].sum())
    return math.sqrt(position + noise[0] ** 2), math.sqrt(attitude + noise[1] ** 2)


def _report(name: str, errors: Errors) -> None:
    print(
        f"{name}: {len(errors.ahead)} flights, predicted {1e3 * float(np.median(errors.ahead)):.0f} ms ahead "
        f"(median); noise of a measured pose {1e3 * errors.noise[0]:.2f} mm, "
        f"{math.degrees(errors.noise[1]):.2f} deg"
    )
    what = f"flights.{name.rsplit(maxsplit=1)[-1]}"
    quote(f"{what}.ahead", 1e3 * float(np.median(errors.ahead)), "ms", digits=3)
    quote(f"{what}.noise.position", 1e3 * errors.noise[0], "mm")
    quote(f"{what}.noise.attitude", math.degrees(errors.noise[1]), "°")
    print(f"  {'':18}{'position, mm':>24}{'attitude, deg':>24}")
    print(f"  {'':18}{'median   90 %':>24}{'median   90 %':>24}")
    for method, found in errors.found.items():
        position = _quantiles([1e3 * distance for distance, _ in found])
        attitude = _quantiles([math.degrees(angle) for _, angle in found])
        quote(f"{what}.{method.replace(' ', '_')}.position", 1e3 * errors.medians(method)[0], "mm")
        quote(f"{what}.{method.replace(' ', '_')}.attitude", math.degrees(errors.medians(method)[1]), "°")
        print(f"  {method:18}{position:>24}{attitude:>24}")


def _quantiles(values: Sequence[float]) -> str:
    return f"{np.median(values):8.2f} {np.quantile(values, 0.9):8.2f}"
