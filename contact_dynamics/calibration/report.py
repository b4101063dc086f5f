# SPDX-License-Identifier: Apache-2.0
"""Formats a calibration for the terminal, as plain data for JSON, and as the server's parameters in YAML."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from contact_dynamics.calibration.result import Calibration, Estimate

CORRELATED: Final = 0.7  # correlations above this size are reported
MAX_OUTLIERS: Final = 10  # number of outliers listed on the terminal; the JSON contains all


def report(found: Calibration) -> str:
    """Return a calibration's results as lines for the terminal."""
    return "\n".join(
        [
            *_used(found),
            "",
            *_parameters(found),
            *_gravity(found),
            *_fit(found),
            *_slides(found),
            *_doubts(found),
        ]
    )


def _used(found: Calibration) -> Iterator[str]:
    strikes, tosses = sum(len(each.strikes) for each in found.observed), len(found.observed)
    yield f"Body {found.body.name!r} on {', '.join(surface.name for surface in found.surfaces) or 'nothing'}"
    yield (
        f"{tosses} toss{'es' * (tosses != 1)}: {sum(len(each.flights) for each in found.observed)} flights, "
        f"{sum(each.first is not None for each in found.observed)} first flights long enough, {strikes} "
        f"impacts of a single corner, "
        f"{sum(each.several for each in found.observed)} of several corners (not used), "
        f"{sum(each.rest is not None for each in found.observed)} rests"
    )


def _parameters(found: Calibration) -> Iterator[str]:
    yield f"{'':28} {'configured':>11} {'estimate':>11} {'std':>9}   {'from trajectories':>22}"
    for each in found.estimates:
        yield _row(each)
    correlations = found.correlations
    for i, first in enumerate(found.estimates):
        for j in range(i):
            if abs(correlations[i, j]) > CORRELATED:
                yield (
                    f"  {first.name} and {found.estimates[j].name} have a correlation of "
                    f"{correlations[i, j]:+.2f}"
                )


def _row(each: Estimate) -> str:
    text = f"{each.name:28} {each.configured:11.5g} "
    if not each.determined:
        return text + "not determined"
    text += f"{each.value:11.5g} {'at bound' if each.at_bound else format(each.std, '.2g'):>9}"
    if not math.isnan(each.by_paths):
        text += f"   {each.by_paths:11.5g} {each.by_paths_std:9.2g}"
        if each.difference_std > 0.0:
            text += f"   (difference {each.disagreement:.1f} sigma)"
    return f"{text} {each.unit}".rstrip()


def _gravity(found: Calibration) -> Iterator[str]:
    gravity = found.gravity
    if gravity is None:
        return
    yield ""
    components = ", ".join(f"{x:.3f}" for x in gravity.mean_W)
    if gravity.count == 1:
        yield (
            f"Gravity: ({components}) m/s^2, magnitude {gravity.size:.4g}, without a standard deviation "
            "(one toss)"
        )
        return
    yield (
        f"Gravity: ({components}) +- {gravity.mean_std:.2g} m/s^2, "
        f"magnitude {gravity.size:.4g} +- {gravity.size_std:.2g}"
    )
    yield (
        f"  The direction varies from toss to toss by {math.degrees(gravity.tilt):.2f} degrees "
        f"({math.degrees(gravity.expected_tilt):.2f} expected from noise). Standard deviations "
        "without noise: "
        f"{gravity.turning:.2g} m/s^2 in each horizontal component, {gravity.changing:.2g} m/s^2 in magnitude"
    )
    product = gravity.size / float(np.linalg.norm(STANDARD_GRAVITY_W))
    yield (
        f"  Assuming standard gravity, length scale x (clock rate)^2 is {product:.4f} +- "
        f"{gravity.size_std / gravity.size * product:.2g}; only this product can be identified"
    )


def _fit(found: Calibration) -> Iterator[str]:
    if len(found.residuals) == 0:
        return
    yield ""
    for part, kind, unit in ((slice(0, 3), "velocity", "m/s"), (slice(3, 6), "spin", "rad/s")):
        left = np.linalg.norm(found.residuals[:, part], axis=1)
        noise = float(np.median(np.linalg.norm(found.residual_stds[:, part], axis=1)))
        own = getattr(found.spread, kind)
        yield (
            f"Residual {kind} after impacts: median {np.median(left):.3g} {unit}, mean {left.mean():.3g}; "
            f"measurement noise {noise:.2g}, model error of the impact law {own:.2g} per component"
        )


def _slides(found: Calibration) -> Iterator[str]:
    for each in found.lasting_frictions:
        yield (
            f"Friction of {each.surface} in sustained contact: {each.friction:.3g} +- {each.std:.2g}, "
            f"from {each.slides} slides before rest with a scatter of {each.scatter:.2g}"
        )


def _doubts(found: Calibration) -> Iterator[str]:
    groups = (
        ("Not determined by the data", found.undetermined),
        ("Warning", found.warnings),
        ("Problem", found.problems),
    )
    for title, texts in groups:
        for text in texts:
            yield f"{title}: {text}"
    for each in found.outliers[:MAX_OUTLIERS]:
        when = "" if math.isnan(each.time) else f" at {each.time:.3f} s"
        yield f"Excluded: {each.recording}{when}, {each.kind}, {each.size:.1f} standard deviations off"
    if len(found.outliers) > MAX_OUTLIERS:
        yield f"Excluded: {len(found.outliers) - MAX_OUTLIERS} more"


def content_of(found: Calibration) -> dict[str, Any]:
    """Return everything but the motions as plain data for JSON. Unknown values are ``nan``."""
    return {
        "body": found.body.to_dict(),
        "surfaces": [surface.to_dict() for surface in found.surfaces],
        "gravity_W": found.gravity_W.tolist(),
        "estimates": [
            {**each.to_dict(), "contradiction": each.contradiction, "disagreement": each.disagreement}
            for each in found.estimates
        ],
        "covariance": found.covariance.tolist(),
        "by_paths_covariance": None
        if found.by_paths_covariance is None
        else found.by_paths_covariance.tolist(),
        "undetermined": list(found.undetermined),
        "gravity": None if found.gravity is None else found.gravity.to_dict(),
        "gravity_covariance_W": None
        if found.gravity is None or found.gravity.count < 2
        else found.gravity.covariance_W.tolist(),
        "spread": found.spread.to_dict(),
        "lasting_frictions": [each.to_dict() for each in found.lasting_frictions],
        "strikes": [
            {"toss": found.observed[number].name, "residual": left.tolist(), "std": std.tolist()}
            for number, left, std in zip(
                found.strike_recordings, found.residuals, found.residual_stds, strict=True
            )
        ],
        "outliers": [each.to_dict() for each in found.outliers],
        "warnings": list(found.warnings),
        "problems": list(found.problems),
        "clusters": found.clusters,
        "by_cluster": found.by_cluster,
    }


def server_parameters(found: Calibration) -> str:
    """Return a parameter file for the server, to which the user adds the topics."""
    body = found.body
    name = body.name
    I_B = body.mass_properties.I_B
    shape = body.shape
    corners = (shape.vertices + body.p_FB_F).ravel()
    lines = [
        f"# Calibrated from tosses: {found.clusters}. Add the topics of the body's states.",
        "/**:",
        "  ros__parameters:",
        f"    gravity: {_list(found.gravity_W)}",
        f"    bodies: [{name}]",
        "    # Motion does not determine the mass: it is the configured one, which the inertia refers to.",
        f"    body.{name}.mass: {float(body.mass_properties.mass)!r}",
        f"    body.{name}.center_of_mass: {_list(body.p_FB_F)}",
        f"    body.{name}.inertia: {_list([*I_B.diagonal(), I_B[0, 1], I_B[0, 2], I_B[1, 2]])}",
        f"    body.{name}.vertices: {_list(corners)}",
        f"    body.{name}.rounding: {float(shape.rounding)!r}",
        f"    surfaces: [{', '.join(surface.name for surface in found.surfaces)}]",
    ]
    for surface in found.surfaces:
        key = f"    surface.{surface.name}"
        lines += [
            f"{key}.point: {_list(surface.p_WS_W)}",
            f"{key}.normal: {_list(surface.normal_W)}",
            f"{key}.friction: {float(surface.friction)!r}",
            f"{key}.restitution: {float(surface.restitution)!r}",
            f"{key}.lasting_factor: {float(surface.lasting_factor)!r}",
            f"{key}.lasting_speed: {float(surface.lasting_speed)!r}",
        ]
    return "\n".join(lines) + "\n"


def _list(values: Iterable[float]) -> str:
    return f"[{', '.join(repr(float(value)) for value in values)}]"
