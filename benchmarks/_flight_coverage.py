# SPDX-License-Identifier: Apache-2.0
"""How often measured poses are in the regions that fits to the beginning of their flights predict.

Centre of mass, ratios of moments, gravity with its scatter, and the noise of poses are estimated from the
tosses ``fit`` of `cube_split.json`. What is printed is of the flights under ``test``, to which nothing was
fitted. Each is fitted over its first half, at least `FEWEST_POSES` poses, and predicted to its last pose but
one; the last one may show the beginning of a contact. Flights that the fit with measured noise rejects
(`FitResult.converged`) are none: the cube slides or tips.

A measured pose has noise of its own, which is correlated with that of the fitted poses. With J the derivative
of the pose with respect to the fitted state, and rho its correlation with the newest fitted pose E, the
difference of pose and prediction has the covariance (J - rho E) C (J - rho E)^T + (1 - rho^2) sigma^2.

The log score is the mean logarithm of the density at the measured pose: the larger, the better. Regions that
are merely wider lower it.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np
from scipy.stats import chi2

from benchmarks._quotes import quote
from benchmarks.calibration import observed_in
from contact_dynamics.calibration import Calibration, Free, calibrate_observed
from contact_dynamics.calibration.model import Model
from contact_dynamics.calibration.observed import Observed
from contact_dynamics.measured.cube_tosses import ORIENTATION_NOISE, POSITION_NOISE
from contact_dynamics.motion import StateNoise, fit_free_motion, measured_noise, propagate_covariance
from contact_dynamics.motion.free_derivative import state_derivatives
from contact_dynamics.motion.free_fit import FitResult
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.many import rotation_vectors
from contact_dynamics.tumbling import free_motion
from contact_dynamics.validation import FloatArray

FEWEST_FRAMES: Final = 9
FEWEST_POSES: Final = 6
MOST_FLIGHTS: Final = 2
"""Flights of a toss that are used. The third is seldom one: the cube still touches the board."""

PARTS: Final = {"position": slice(0, 3), "attitude": slice(3, 6), "pose": slice(0, 6)}


@dataclass(frozen=True, slots=True)
class Region:
    """The probability of the region in whose border a pose lies, and the logarithm of the density there."""

    probability: float
    log_density: float


def flight_coverage(path: Path) -> None:
    """Print coverage and log score for white noise, for unknown noise and for measured noise."""
    split = json.loads((Path(__file__).parent / "cube_split.json").read_text(encoding="utf-8"))
    seen = observed_in(path, split["fit"])
    free = (Free.CENTER_OF_MASS, Free.GRAVITY, Free.INERTIA_RATIOS)
    found = calibrate_observed(
        Model(seen[0].motion.body, seen[0].motion.surfaces), seen, free=free, with_paths=False
    )
    body = found.body.mass_properties
    noise = measured_noise(body, list(flown(seen, found)), gravity_W=found.gravity_W)
    print(
        f"\nnoise: {1e3 * noise.position:.3f} mm over {1e3 * noise.position_time:.0f} ms, "
        f"{math.degrees(noise.orientation):.3f} deg over {1e3 * noise.orientation_time:.0f} ms, "
        f"{noise.degrees_of_freedom or math.inf:.1f} degrees of freedom"
    )
    quote("flights.noise.position_time", 1e3 * noise.position_time, "ms")
    quote("flights.noise.orientation_time", 1e3 * noise.orientation_time, "ms")
    quote("flights.noise.degrees", noise.degrees_of_freedom or math.inf)
    regions: dict[tuple[str, str], list[Region]] = {}
    for states in flown(observed_in(path, split["test"]), found):
        half = max((len(states) + 1) // 2, FEWEST_POSES)
        fits = {
            name: fit_free_motion(body, states[:half], gravity_W=found.gravity_W, noise=given)
            for name, given in (("unknown", None), ("measured", noise))
        }
        if not fits["measured"].converged:
            continue
        white = _white(fits["unknown"])
        fits["white"] = fit_free_motion(body, states[:half], gravity_W=found.gravity_W, noise=white)
        nominal = StateNoise(position=POSITION_NOISE, orientation=ORIENTATION_NOISE)
        for name, fit in fits.items():
            own = nominal if name != "measured" else fit.noise or noise
            off, covariance = _off(found, fit, states[-1], own)
            for part, at in PARTS.items():
                regions.setdefault((name, part), []).append(_region(off[at], covariance[at, at]))
    _report(regions)


def flown(observed: list[Observed], found: Calibration) -> Iterator[list[BodyState]]:
    """Yield the states of the mass centre in each flight, but for its last frame."""
    for each in observed:
        motion = each.motion
        for flight in each.flights[:MOST_FLIGHTS]:
            states = []
            for k in range(flight.start, flight.stop - 1):
                state = BodyState(
                    p_WB_W=motion.p_WB_W[k],
                    q_WB=motion.q_WB[k],
                    w_WB_W=motion.w_WB_W[k],
                    stamp_ns=round(motion.times[k] * 1e9),
                )
                centre = motion.p_WB_W[k] + state.R_WB @ found.body.p_FB_F
                states.append(
                    BodyState(p_WB_W=centre, q_WB=state.q_WB, w_WB_W=state.w_WB_W, stamp_ns=state.stamp_ns)
                )
            if len(states) >= FEWEST_FRAMES - 1:
                yield states


def _white(fit: FitResult) -> StateNoise:
    """Return white noise of the size of a fit's residuals, which lose six unknowns each."""
    share = math.sqrt(fit.count / (3 * fit.count - 6))
    return StateNoise(position=share * fit.position_residual, orientation=share * fit.orientation_residual)


def _off(
    found: Calibration, fit: FitResult, end: BodyState, noise: StateNoise
) -> tuple[FloatArray, FloatArray]:
    """Return what a measured pose is off its prediction, (6,), and the covariance of that."""
    assert found.gravity is not None and fit.by_gravity is not None  # noqa: PT018
    body, gravity = found.body.mass_properties, found.gravity_W
    ahead = (end.stamp_ns - fit.state.stamp_ns) * 1e-9
    motion = free_motion(body, fit.state, gravity_W=gravity)
    then = motion.state_at(ahead)
    turn = rotation_vectors(end.q_WB[None], then.q_WB[None])[0]
    by_gravity = propagate_covariance(
        body,
        fit.state,
        np.zeros((12, 12)),
        [ahead],
        gravity_W=gravity,
        gravity_covariance_W=found.gravity.covariance_W,
        by_gravity=fit.by_gravity,
    )
    times = np.repeat([noise.position_time, noise.orientation_time], 3)
    shared = np.exp(-np.divide(ahead, times, out=np.full(6, np.inf), where=times > 0.0))
    change = state_derivatives(motion, np.array([ahead]))[0, :6] - shared[:, None] * np.eye(6, 12)
    own = np.repeat([noise.position, noise.orientation], 3) ** 2 * (1.0 - shared**2)
    covariance = change @ fit.covariance @ change.T + np.diag(own) + by_gravity.covariances[0, :6, :6]
    return np.concatenate([end.p_WB_W - then.p_WB_W, turn]), covariance


def _region(off: FloatArray, covariance: FloatArray) -> Region:
    square = float(off @ np.linalg.solve(covariance, off))
    size = float(np.linalg.slogdet(2.0 * math.pi * covariance)[1])
    return Region(float(chi2.cdf(square, len(off))), -0.5 * (square + size))


def _report(regions: dict[tuple[str, str], list[Region]]) -> None:
    count = len(regions["measured", "pose"])
    print(f"{count} flights of other tosses: shares in the regions of 50 and 90 %, and log score")
    quote("flights.coverage.count", count, digits=3)
    for (name, part), found in regions.items():
        probabilities = np.array([region.probability for region in found])
        half, most = (100.0 * float(np.mean(probabilities < share)) for share in (0.5, 0.9))
        score = float(np.mean([region.log_density for region in found]))
        print(f"  {name + ' noise':16}{part:10}{half:6.0f} %{most:6.0f} %{score:8.1f}")
        quote(f"flights.coverage.{name}.{part}.half", half, "%")
        quote(f"flights.coverage.{name}.{part}.most", most, "%")
        quote(f"flights.coverage.{name}.{part}.score", score, digits=3)
