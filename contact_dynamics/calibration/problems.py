# SPDX-License-Identifier: Apache-2.0
"""Describes faults of the data, and doubtful results, in plain sentences.

A cube whose markers were relabelled looks the same: its corners and its free flights are unchanged, and only
its mass centre is elsewhere in the new axes. The flights and strikes of each recording are therefore compared
with the predictions for the body as it is, and for the body rotated onto itself (`relabelled`).
"""

from __future__ import annotations

import math
from itertools import permutations, product
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.calibration.impacts import jumps
from contact_dynamics.calibration.result import CONTRADICTED, DISAGREE
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.clustered_fit import robust_costs
from contact_dynamics.tolerances import LEAST_STEP_OF_SURFACE, SAME_FACE, SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.calibration.estimation import Data, Estimation, Fitting, Spread
    from contact_dynamics.calibration.model import Described
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.calibration.result import Estimate, MeasuredGravity, Outlier
    from contact_dynamics.validation import FloatArray


OFF: Final = 0.3
"""Half sizes. If the median striking corner is farther from its surface, frames are mislabelled."""

SCATTERED: Final = 0.15
"""Half sizes. The same, if the heights of striking corners scatter more than this about their median."""

FEWEST_TOSSES: Final = 5
"""Tosses with strikes. Fewer say too little of how much strikes scatter: of calibrations of 360 published
tosses by three of them, a third of the 90 % intervals miss what all say."""

UNEVEN: Final = 0.05
"""Half sizes. Corners that touch at heights that scatter by more are not where the shape says."""

NOISIER: Final = 5.0  # factor on the stated noise. It is 1.7 for the published tosses.
APART: Final = 0.05  # share of the tosses with outliers above which these are systematic
MAX_NAMED: Final = 10  # maximum number of tosses named in a sentence
FEWEST_COMPARED: Final = 3  # minimum number of strikes for medians

UNEXPLAINED: Final = 0.3
"""Share of a strike's change of spin. If more of it is unexplained in the median, other corners struck."""

_MISLABELLED: Final = (
    "The body's published frame, its quaternion's order or the surface is probably mislabelled."
)

WRONG_TURN: Final = 0.17
"""rad, ten degrees. Gravity that is farther from the configured direction belongs to other axes."""

WRONG_SIZE: Final = 0.15
"""Share. Gravity that is farther from the configured size comes from wrong units or a wrong clock."""

PLACES: Final = 10  # minimum number of places at which heights are compared, to check flatness

BENT: Final = 15.0
"""F ratio of three bending terms. Of 15 normal heights on a plane, one set in several thousand exceeds it."""


def check_that_it_flies(observed: Sequence[Observed]) -> None:
    """Raise `InvalidFieldError` if the body never flies in any of the recordings."""
    if not any(each.flights for each in observed):
        seconds = sum(float(each.motion.times[-1] - each.motion.times[0]) for each in observed)
        raise InvalidFieldError(
            "recordings",
            f"{len(observed)} stretches of states, {seconds:.1f} s, without a flight",
            "tosses: flights of at least 0.05 s that end with an impact of a corner. If the body does fly in "
            "the recordings, check gravity, the world axes and the unit of the stamps in the configuration",
        )


def problems_of(
    observed: Sequence[Observed],
    data: Data,
    gravity: MeasuredGravity | None,
    left: FloatArray,
    half_size: float,
    *,
    by_strikes: bool,
) -> list[str]:
    """Return what prevents an answer.

    ``left`` is the predicted velocities after the strikes less the measured ones, (n, 6), m/s and rad/s.
    ``by_strikes`` means that some free parameter is determined by strikes alone.
    """
    found = []
    strikes, several = len(data.strikes), sum(each.several for each in observed)
    flights = sum(len(each.flights) for each in observed)
    tosses = len(np.unique(data.strikes.recordings))
    if not by_strikes:
        pass
    elif strikes == 0:
        found.append(
            f"The recordings contain no impact of a single corner in {len(observed)} tosses with "
            f"{flights} flights, "
            f"and {several} impacts of several corners. Friction, restitution and inertia are not determined."
        )
    elif strikes == 1:
        found.append(
            "The recordings contain only one impact of a single corner. Its six velocities do not determine "
            "friction, restitution, centre of mass and inertia. Record at least twenty tosses."
        )
    elif tosses < FEWEST_TOSSES:
        found.append(
            f"The {strikes} impacts of single corners are in {tosses} "
            f"toss{'' if tosses == 1 else 'es'}, too few "
            "to measure the scatter of impacts. The errors may be larger than stated. Record at least twenty "
            "tosses."
        )
    found += _axes(gravity, observed)
    if strikes >= FEWEST_COMPARED:
        found += _corners(data, observed, left, half_size)
    return found


def unlikely(estimates: Sequence[Estimate], spread: Spread, strikes: int, half_size: float) -> list[str]:
    """Return which estimates ended at a bound, and which residuals no noise explains."""
    found = [
        f"{each.name} is at the end of its range, {each.value:.4g}, and is not an estimate. Possible "
        "causes are "
        "too few or poor data, another shape of the body, or inaccurate configured values."
        for each in estimates
        if each.at_bound and abs(each.value - each.configured) > SMALLEST
    ]
    height = max(spread.strike_height, spread.rest_height)
    if strikes >= FEWEST_COMPARED and height > UNEVEN * half_size:
        found.append(
            f"Touching corners are {1e3 * height:.1f} mm above or below their surface, which exceeds the "
            "measurement noise. Shape, rounding or surface height differ from the configuration: add them to "
            "--free."
        )
    if spread.flight > NOISIER:
        found.append(
            f"In first flights, the scatter of positions is {spread.flight:.0f} times the given "
            "noise. The body "
            "does not fly freely, or the given noise is wrong."
        )
    return found


def recordings_apart(
    observed: Sequence[Observed], outliers: Sequence[Outlier], renamed: Sequence[int]
) -> list[str]:
    """Return which recordings disagree with the others."""
    found = []
    names = sorted({each.recording for each in outliers})
    if len(names) > APART * len(observed):
        found.append(
            f"{len(names)} of {len(observed)} tosses contain outliers, which are excluded: {_listed(names)}. "
            "Possible causes are another body, other axes, or a hand that still touched the body."
        )
    if renamed:
        names = [observed[number].name for number in renamed]
        found.append(
            f"These tosses fit better with the axes of the body renamed: {_listed(names)}. The "
            "tracker probably "
            "exchanged the axes, possibly also in tosses that do not show it."
        )
    return found


def _listed(names: Sequence[str]) -> str:
    more = f" and {len(names) - MAX_NAMED} more" if len(names) > MAX_NAMED else ""
    return ", ".join(names[:MAX_NAMED]) + more


def _axes(gravity: MeasuredGravity | None, observed: Sequence[Observed]) -> list[str]:
    found = []
    if gravity is not None:
        configured = observed[0].motion.gravity_W
        size = float(np.linalg.norm(configured))
        cosine = float(gravity.mean_W @ configured) / (size * float(np.linalg.norm(gravity.mean_W)))
        turn = math.acos(min(1.0, max(-1.0, cosine)))
        if turn > WRONG_TURN:
            found.append(
                f"The acceleration in flight is {math.degrees(turn):.0f} degrees from the configured "
                "gravity. "
                "The world axes are probably mislabelled."
            )
        if abs(gravity.size / size - 1.0) > WRONG_SIZE:
            found.append(
                f"The acceleration in flight is {gravity.size:.2f} m/s^2, but gravity is configured as "
                f"{size:.2f} m/s^2. The unit of lengths or stamps is probably wrong."
            )
    return found


def _corners(data: Data, observed: Sequence[Observed], left: FloatArray, half_size: float) -> list[str]:
    heights = np.array([strike.height for each in observed for strike in each.strikes])
    middle = float(np.median(heights))
    scatter = float(np.median(np.abs(heights - middle)))
    if abs(middle) > OFF * half_size or scatter > SCATTERED * half_size:
        return [
            (
                f"At impacts, the lowest corner is {1e3 * middle:.0f} mm above its surface (median, "
                "with a median "
                f"deviation of {1e3 * scatter:.0f} mm). {_MISLABELLED}"
            )
        ]
    changes = data.strikes.after.spins_W - data.strikes.before.spins_W
    missed = float(np.median(np.linalg.norm(left[:, 3:], axis=1)))
    change = float(np.median(np.linalg.norm(changes, axis=1)))
    if missed > UNEXPLAINED * change:
        return [
            (
                f"Impacts change the angular velocity by {change:.1f} rad/s (median), of which "
                "impulses at the "
                f"touching corners do not explain {missed:.1f} rad/s. {_MISLABELLED} Otherwise, the "
                "frame rate "
                "is too low to separate impacts."
            )
        ]
    return []


def bent_surfaces(data: Data, described: Described, names: Sequence[str], half_size: float) -> list[str]:
    """Return which surfaces are not flat, by the heights of what touched them at different places."""
    found = []
    for surface, name in enumerate(names):
        rows = []
        for touch in (data.resting, data.strikes):
            mine = touch.surfaces == surface
            heights = touch.heights(described)
            moments = {tuple(place) for place in touch.p_W[mine].tolist()}
            rows.append(
                np.array(
                    [
                        (*place[:3], float(heights[mine & (touch.p_W == place).all(axis=1)].mean()))
                        for place in sorted(moments)
                    ]
                ).reshape(-1, 4)
            )
        for places, what in zip(rows, ("rests", "impacts"), strict=True):
            text = _bent(places, described.normals[surface], half_size)
            if text:
                found.append(f"Surface {name!r} is not flat: {text}, measured at {what}.")
                break
    return found


def _bent(places: FloatArray, normal: FloatArray, half_size: float) -> str:
    """Describe how heights bend over places, (n, 4) with the height last; empty if a plane suffices."""
    if len(places) < PLACES:
        return ""
    across = np.linalg.svd(normal[None])[2][1:]
    u, v = across @ (places[:, :3] - places[:, :3].mean(axis=0)).T
    plane = np.column_stack([np.ones_like(u), u, v])
    bent = np.column_stack([plane, u * u, u * v, v * v])
    left = [
        places[:, 3] - design @ np.linalg.lstsq(design, places[:, 3], rcond=None)[0]
        for design in (plane, bent)
    ]
    squares = [float(each @ each) for each in left]
    ratio = (squares[0] - squares[1]) / 3.0 / max(squares[1] / (len(places) - 6), SMALLEST)
    swing = float(np.ptp(left[0] - left[1]))
    if ratio > BENT and swing > LEAST_STEP_OF_SURFACE * half_size:
        return f"heights deviate by {1e3 * swing:.1f} mm over {1e3 * max(np.ptp(u), np.ptp(v)):.0f} mm"
    return ""


def disagreement_limit(count: int, clusters: int) -> float:
    """Return the standard deviations beyond which the ways disagree in one of ``count`` parameters.

    In a quarter of all faultless calibrations, one parameter of six is off by two standard deviations. The
    limit therefore grows with their number (Sidak), and with the uncertainty of deviations from few tosses.
    """
    from scipy.stats import t

    each = 1.0 - (1.0 - DISAGREE) ** (1.0 / max(count, 1))
    return float(t.isf(0.5 * each, max(clusters - 1, 1)))


def warnings_of(estimates: Sequence[Estimate], *, clusters: int, by_cluster: bool, free: int) -> list[str]:
    """Describe doubtful estimates."""
    found = []
    for each in estimates:
        if each.contradiction > CONTRADICTED:
            unit = f" {each.unit}" if each.unit else ""
            found.append(
                f"{each.name}: configured as {each.configured:.5g}{unit}, estimated as {each.value:.5g} +- "
                f"{each.std:.2g}{unit}, a difference of {each.contradiction:.0f} standard deviations."
            )
    limit = disagreement_limit(sum(each.difference_std > 0.0 for each in estimates), clusters)
    apart = [each for each in estimates if each.disagreement > limit]
    if apart:
        listed = ", ".join(
            f"{each.name} ({each.value:.4g} and {each.by_paths:.4g}, {each.disagreement:.1f} sigma)"
            for each in apart
        )
        found.append(
            f"The two estimates disagree: {listed}. With an adequate model, a difference beyond {limit:.1f} "
            "sigma occurs in 1 of 22 calibrations. Add parameters to --free, such as rounding or "
            "inertia_ratios, or check the outliers."
        )
    if clusters and not by_cluster:
        found.append(
            f"{'One toss is' if clusters == 1 else f'{clusters} tosses are'} too few to measure the scatter "
            f"between tosses with {free} free parameters. The standard deviations are those of independent "
            "impacts, enlarged for the small number of tosses."
        )
    return found


RENAMED: Final = 20.0
"""Robust sum of squares by which a recording fits better with other names. None of 360 published tosses gains
more than 16."""


def relabelled(fitting: Fitting, found: Estimation, covariances: FloatArray) -> list[int]:
    """Return the numbers of the recordings that fit better with the body's axes renamed.

    ``covariances``, (n, 6, 6), are those of the velocities after the strikes by the noise of measurement.
    """
    model, data, spread = fitting.model, fitting.data, found.spread
    turns = _symmetries(model.vertices, model.body.mass_properties.I_B, SAME_FACE * model.half_size)
    values = np.tile(found.values, (len(turns), 1))
    values[:, :3] = turns @ found.values[:3]
    costs = np.zeros((len(turns), data.clusters))
    whole = covariances + np.diag(np.repeat([spread.velocity**2, spread.spin**2], 3))
    off = np.linalg.solve(
        np.linalg.cholesky(whole), jumps(model, values, data.strikes, data.gravity)[..., None]
    )
    for cost, row, left in zip(costs, values, off[..., 0], strict=True):
        straight = (data.center.at_zero + data.center.slopes @ row[:3]) / spread.flight
        np.add.at(cost, data.strikes.recordings, robust_costs(left))
        np.add.at(cost, data.center.recordings, robust_costs(straight))
    return np.flatnonzero(costs[0] - costs.min(axis=0) > RENAMED).tolist()


def _symmetries(vertices: FloatArray, I_B: FloatArray, near: float) -> FloatArray:
    """Return the rotations among the axes, (k, 3, 3), that turn shape and inertia onto themselves.

    The first one is the identity.
    """
    found = []
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            turn = np.zeros((3, 3))
            turn[range(3), order] = signs
            apart = np.linalg.norm(vertices[:, None] @ turn.T - vertices, axis=2).min(axis=1)
            same_inertia = np.abs(turn @ I_B @ turn.T - I_B).max() < SAME_FACE * np.abs(I_B).max()
            if np.linalg.det(turn) > 0.0 and apart.max() < near and same_inertia:
                found.append(turn)
    return np.array(found)
