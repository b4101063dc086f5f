"""Recorded flights: the pose at their end, predicted from their first part, beside what was measured.

Each flight is fitted over its first half (`fit_free_motion`, poses alone) and predicted to its last frame.
The error is that to the measured pose there, whose own noise is printed beside. "Newest velocity" predicts
from the newest state of that half as a tracker publishes it, "at rest" assumes that nothing moves on.

The brick's flights come with the package (MuJoCo with the noise of motion capture). The measured tosses of a
cube are read where CUBE_TOSSES names their `.npz`, or from beside the checkout.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from contact_dynamics.demo.cube_tosses import read_cube_toss
from contact_dynamics.demo.flights import find_flights
from contact_dynamics.demo.recorded_toss import Toss
from contact_dynamics.demo.rotation_vectors import rotation_vectors_from
from contact_dynamics.demo.toss import read_toss
from contact_dynamics.motion_fit import fit_free_motion
from contact_dynamics.rigid_body import BodyState
from contact_dynamics.tumbling import free_motion

BESIDE = Path(__file__).parents[2] / "shared" / "data" / "cube_tosses" / "tosses.npz"
FEWEST_FRAMES = 16
COUNT = 360


def run() -> None:
    """Print the errors of both recordings."""
    _report("brick", [read_toss()])
    path = Path(os.environ.get("CUBE_TOSSES", BESIDE))
    if not path.is_file():
        print(f"no measured tosses: {path} is missing; CUBE_TOSSES=path names them")
        return
    _report("measured cube", (read_cube_toss(path, index=index) for index in range(COUNT)))


def _report(name: str, tosses: Iterable[Toss]) -> None:
    errors: dict[str, list[tuple[float, float]]] = {"fit": [], "newest velocity": [], "at rest": []}
    ahead: list[float] = []
    noise = (math.nan, math.nan)
    for toss in tosses:
        noise = (math.sqrt(3.0) * toss.position_noise, math.sqrt(3.0) * toss.orientation_noise)
        for flight in find_flights(toss):
            if flight.stop - flight.start < FEWEST_FRAMES:
                continue
            half, last = (flight.start + flight.stop) // 2, flight.stop - 1
            states = [toss.state(i) for i in range(flight.start, half)]
            fit = fit_free_motion(toss.body.mass_properties, states, gravity_W=toss.gravity_W)
            end = toss.state(last)
            ahead.append(float(toss.times[last] - toss.times[half - 1]))
            errors["fit"].append(_error(_flown(toss, fit.state, ahead[-1]), end))
            errors["newest velocity"].append(_error(_flown(toss, states[-1], ahead[-1]), end))
            errors["at rest"].append(_error(states[-1], end))
    print(
        f"{name}: {len(ahead)} flights, predicted {1e3 * float(np.median(ahead)):.0f} ms ahead (median); "
        f"noise of a measured pose {1e3 * noise[0]:.2f} mm, {math.degrees(noise[1]):.2f} deg"
    )
    print(f"  {'':18}{'position, mm':>24}{'attitude, deg':>24}")
    print(f"  {'':18}{'median   90 %':>24}{'median   90 %':>24}")
    for method, found in errors.items():
        position = _quantiles([1e3 * distance for distance, _ in found])
        attitude = _quantiles([math.degrees(angle) for _, angle in found])
        print(f"  {method:18}{position:>24}{attitude:>24}")


def _flown(toss: Toss, state: BodyState, seconds: float) -> BodyState:
    return free_motion(toss.body.mass_properties, state, gravity_W=toss.gravity_W).state_at(seconds)


def _error(predicted: BodyState, measured: BodyState) -> tuple[float, float]:
    turn = rotation_vectors_from(measured.q_WB, predicted.q_WB[None])[0]
    return float(np.linalg.norm(predicted.p_WB_W - measured.p_WB_W)), float(np.linalg.norm(turn))


def _quantiles(values: Sequence[float]) -> str:
    return f"{np.median(values):8.2f} {np.quantile(values, 0.9):8.2f}"
