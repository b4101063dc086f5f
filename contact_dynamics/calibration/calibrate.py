# SPDX-License-Identifier: Apache-2.0
"""Estimates parameters from measured motions; `contact-dynamics calibrate` calls `calibrate` too."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.calibration.estimation import Data, Fitting, extra_spread
from contact_dynamics.calibration.first_flights import gravity_and_center, ratios_of_moments
from contact_dynamics.calibration.free import BY_STRIKES, Free
from contact_dynamics.calibration.impacts import jump_covariances, jumps
from contact_dynamics.calibration.model import RATIO_STEP, Model
from contact_dynamics.calibration.observed import observe
from contact_dynamics.calibration.paths import Paths
from contact_dynamics.calibration.problems import (
    bent_surfaces,
    check_that_it_flies,
    problems_of,
    recordings_apart,
    relabelled,
    unlikely,
    warnings_of,
)
from contact_dynamics.calibration.result import Calibration, Estimate, MeasuredGravity, Outlier
from contact_dynamics.calibration.slides import LASTING_SPEED, lasting_frictions
from contact_dynamics.calibration.strikes import at_rests, strikes_of
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.measured.motion import MeasuredMotion
from contact_dynamics.numerics.vectors import tangents
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.world import Body, Surface

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from contact_dynamics.calibration.estimation import Estimation
    from contact_dynamics.calibration.first_flights import Gravity
    from contact_dynamics.calibration.observed import Observed
    from contact_dynamics.calibration.slides import LastingFriction
    from contact_dynamics.numerics.clustered_fit import ClusteredFit
    from contact_dynamics.validation import FloatArray

MAX_RATIOS: Final = 4
"""Largest number of linearisations of the rotations of first flights, at the last ratios of moments."""

DIRECTION_SHARE: Final = 0.2
"""Least component, in standard units, with which a parameter takes part in an undetermined direction."""


def calibrate(
    motions: Sequence[MeasuredMotion],
    *,
    names: Sequence[str] = (),
    free: Sequence[Free] | None = None,
    with_paths: bool = True,
    tell: Callable[[str, int, int], None] | None = None,
) -> Calibration:
    """Return estimates of a body's and the surfaces' parameters from measured motions of the body.

    Args:
        motions: Measured states of one body in one world.
        names: How the motions are named in the result; the default is their numbers.
        free: The free parameters; the default is `Model.standard`. The others keep their configured values.
        with_paths: Whether to estimate by whole trajectories as well (the second way), which takes most of
            the time.
        tell: Progress callback: called with the current step, the amount done, and the total.

    Raises:
        InvalidFieldError: there is no motion, they are of several bodies, or the body never flies.
        NotSupportedError: the body's shape has no corners.
    """
    if not motions:
        raise InvalidFieldError("motions", "none", "at least one")
    bodies = sorted({motion.body.name for motion in motions})
    if len(bodies) > 1:
        raise InvalidFieldError("motions", f"states of {', '.join(bodies)}", "those of one body")
    model = Model(motions[0].body, motions[0].surfaces)
    observed: list[Observed] = []
    for number, motion in enumerate(motions):
        if tell is not None:
            tell("finding events", number, len(motions))
        observed += observe(names[number] if names else f"motion {number}", motion)
    return calibrate_observed(model, observed, free=free, with_paths=with_paths, tell=tell)


def calibrate_observed(
    model: Model,
    observed: Sequence[Observed],
    *,
    free: Sequence[Free] | None = None,
    with_paths: bool = True,
    tell: Callable[[str, int, int], None] | None = None,
) -> Calibration:
    """Return estimates from tosses whose events have been found. Arguments and errors as in `calibrate`."""
    check_that_it_flies(observed)
    free = model.standard if free is None else free
    data = _data(model, observed, free)
    covariances = jump_covariances(model, model.configured, data.strikes, data.gravity)
    if tell is not None:
        tell("fitting velocities at impacts", 0, 2)
    fitting, first = _first_way(model, data, free, observed, covariances)
    second = None
    if with_paths and len(data.strikes):
        if tell is not None:
            tell("fitting trajectories through impacts", 1, 2)
        paths = Paths(fitting, observed)
        second = fitting.estimate(paths.groups_at, spread=first.spread, start=first.fit.parameters, rounds=1)
    choice = fitting.choice(first, covariances)
    estimates, covariance, by_paths_covariance = _estimates(fitting, first, second, choice)
    outliers = _outliers(data, observed, first)
    described = model.describe(first.values)
    gravity = _gravity(data.gravity, first.values[:3], first.spread.flight) if Free.GRAVITY in free else None
    gravity_W = observed[0].motion.gravity_W if gravity is None else gravity.mean_W
    left = jumps(model, first.values[None], data.strikes, data.gravity)[0]
    lasting = lasting_frictions(observed, described, gravity_W, [surface.name for surface in model.surfaces])
    return Calibration(
        body=_body(model, first.values),
        surfaces=_surfaces(model, first.values, lasting),
        gravity_W=gravity_W,
        estimates=estimates,
        covariance=covariance,
        by_paths_covariance=by_paths_covariance,
        undetermined=_undetermined(fitting, first),
        gravity=gravity,
        spread=first.spread,
        lasting_frictions=lasting,
        residuals=left,
        residual_stds=np.sqrt(np.einsum("nii->ni", covariances)),
        strike_recordings=data.strikes.recordings,
        observed=tuple(observed),
        outliers=outliers,
        warnings=tuple(
            warnings_of(
                estimates, clusters=first.fit.clusters, by_cluster=first.fit.by_cluster, free=len(estimates)
            )
        ),
        problems=(
            *problems_of(
                observed, data, gravity, left, model.half_size, by_strikes=bool(set(free) & BY_STRIKES)
            ),
            *unlikely(estimates, first.spread, len(data.strikes), model.half_size),
            *recordings_apart(observed, outliers, relabelled(fitting, first, covariances)),
            *bent_surfaces(data, described, [s.name for s in model.surfaces], model.half_size),
        ),
        clusters=first.fit.clusters,
        by_cluster=first.fit.by_cluster,
    )


def _first_way(
    model: Model, data: Data, free: Sequence[Free], observed: Sequence[Observed], covariances: FloatArray
) -> tuple[Fitting, Estimation]:
    """Return the estimate from velocities, repeated if ratios of moments end far from their start."""
    ratios, start = model.configured[4:6], None
    for _ in range(MAX_RATIOS):
        fitting = Fitting(model, data, free)
        first = fitting.estimate(partial(fitting.whitened_jumps, covariances=covariances), start=start)
        start = first.fit.parameters
        if data.ratios is None or np.abs(first.values[4:6] - ratios).max() <= RATIO_STEP:
            break
        ratios = first.values[4:6]
        data = replace(data, ratios=ratios_of_moments(observed, model, first.values))
    return fitting, first


def _data(model: Model, observed: Sequence[Observed], free: Sequence[Free]) -> Data:
    gravity, center = gravity_and_center(observed, gravity_is_free=Free.GRAVITY in free)
    with_ratios = Free.INERTIA_RATIOS in free
    strikes = strikes_of(observed, ratios=model.near_ratios(model.configured) if with_ratios else None)
    ratios = ratios_of_moments(observed, model, model.configured) if with_ratios else None
    described = model.describe(model.configured)
    return Data(
        clusters=len(observed),
        strikes=strikes,
        gravity=gravity,
        center=center,
        ratios=ratios,
        resting=at_rests(observed, described, model.half_size),
    )


def _estimates(
    fitting: Fitting, first: Estimation, second: Estimation | None, choice: FloatArray
) -> tuple[tuple[Estimate, ...], FloatArray, FloatArray | None]:
    """Return the reported estimates, and the covariances of both ways.

    ``choice``, (f,), is the change of the estimates with another choice of free parameters, in standard
    units. It is added as one standard deviation.
    """
    model, fit = fitting.model, first.fit
    vague = np.abs(fit.undetermined).max(axis=0, initial=0.0) > DIRECTION_SHARE
    choice = np.where(vague, 0.0, choice)
    covariance = _covariance(fit) + np.outer(choice, choice)
    covariance_there = None if second is None else _covariance(second.fit)
    scale, estimates = [], []
    for k, number in enumerate(fitting.at):
        parameter = model.parameters[number]
        shift = (
            float(model.body.p_FB_F["xyz".index(parameter.name[-1])])
            if parameter.group is Free.CENTER_OF_MASS
            else 0.0
        )

        def shown(value: float, parameter: object = parameter, shift: float = shift) -> float:
            return math.exp(value) if getattr(parameter, "is_factor", False) else value + shift

        value = shown(float(first.values[number]))
        scale.append(float(fitting.steps[k]) * (value if parameter.is_factor else 1.0))
        value_there, spread_there, apart = math.nan, math.nan, math.nan
        if second is not None and covariance_there is not None:
            value_there = shown(float(second.values[number]))
            spread_there = scale[k] * math.sqrt(covariance_there[k, k])
            moved = fit.influences[:, k] - second.fit.influences[:, k]
            if len(moved) > 1:  # a single toss has no scatter to compare the ways' difference with
                apart = scale[k] * math.sqrt(float(moved @ moved))
        estimates.append(
            Estimate(
                name=parameter.name,
                unit=parameter.unit,
                configured=shown(parameter.configured),
                value=value,
                std=math.nan if vague[k] or fit.at_bound[k] else scale[k] * math.sqrt(covariance[k, k]),
                by_paths=value_there,
                by_paths_std=spread_there,
                difference_std=apart,
                determined=not vague[k],
                at_bound=bool(fit.at_bound[k]),
            )
        )
    scales = np.array(scale) * ~vague
    units = np.outer(scales, scales)
    there = None if covariance_there is None else covariance_there * units
    return tuple(estimates), covariance * units, there


def _covariance(fit: ClusteredFit) -> FloatArray:
    """Return the covariance, (f, f), of few tosses.

    Student's t replaces the normal distribution: each standard deviation is enlarged until its normal 90 %
    interval is that of Student's t with the parameter's degrees of freedom.
    """
    from scipy.stats import norm, t

    factors = t.isf(0.05, fit.degrees) / norm.isf(0.05)
    covariance: FloatArray = fit.covariance * np.outer(factors, factors)
    return covariance


def _undetermined(fitting: Fitting, found: Estimation) -> tuple[str, ...]:
    """Describe the undetermined directions, each by the parameters that may change together."""
    texts = []
    for direction in found.fit.undetermined:
        largest = float(np.abs(direction).max())
        parts = [
            f"{fitting.model.parameters[number].name} {share * step / largest:+.2g}"
            + (f" {unit}" if (unit := fitting.model.parameters[number].unit) else "")
            for number, share, step in zip(fitting.at, direction, fitting.steps, strict=True)
            if abs(share) > DIRECTION_SHARE * largest
        ]
        texts.append(" together with ".join(parts))
    return tuple(texts)


def _gravity(gravity: Gravity, center: FloatArray, factor: float) -> MeasuredGravity | None:
    """Return gravity over all tosses, for a mass centre and a factor on the noise of positions."""
    known = ~np.isnan(gravity.std)
    count = int(known.sum())
    if count == 0:
        return None
    each = gravity.of(center)[known]
    mean = np.median(each, axis=0)
    sizes = np.linalg.norm(each, axis=1)
    size = float(np.median(sizes))
    # the median's error is 1.25 times the mean's, and 1.4826 times the median deviation is the standard one
    errors = 1.25 * 1.4826 / math.sqrt(count) if count > 1 else math.nan
    down = mean / np.linalg.norm(mean)
    axes = np.array([*tangents((down[0], down[1], down[2])), down])
    off = (each - mean) @ axes.T
    noise = (factor * gravity.std[known])[:, None, None] ** 2
    cosines = each @ mean / (sizes * np.linalg.norm(mean))
    return MeasuredGravity(
        mean_W=mean,
        mean_std=errors * float(np.median(np.abs(each - mean))),
        size=size,
        size_std=errors * float(np.median(np.abs(sizes - size))),
        tilt=float(np.median(np.arccos(np.clip(cosines, -1.0, 1.0)))),
        expected_tilt=1.18 * float(np.median(gravity.std[known])) / size,
        count=count,
        turning=extra_spread(off[:, :2], noise * np.eye(2)),
        changing=extra_spread(off[:, 2:], noise),
    )


def _body(model: Model, values: FloatArray) -> Body:
    described, body = model.describe(values), model.body
    return Body(
        name=body.name,
        mass_properties=MassProperties(mass=body.mass_properties.mass, I_B=described.I_B),
        p_FB_F=body.p_FB_F + described.center,
        shape=ConvexShape(vertices=described.corners - described.center, rounding=described.rounding),
    )


def _surfaces(model: Model, values: FloatArray, lasting: Sequence[LastingFriction]) -> tuple[Surface, ...]:
    """Return the surfaces. Without observed slides, sustained contact keeps its factor and speed.

    With sharp corners it keeps the speed too: on recorded tosses, `LASTING_SPEED` then made errors larger.
    """
    described = model.describe(values)
    slid = {each.surface: each.friction for each in lasting}
    surfaces = []
    for k, surface in enumerate(model.surfaces):
        friction = float(described.frictions[k])
        factor, speed = surface.lasting_factor, surface.lasting_speed
        if surface.name in slid and friction > 0.0:
            factor = slid[surface.name] / friction
            speed = LASTING_SPEED if described.rounding > 0.0 else speed
        surfaces.append(
            Surface(
                name=surface.name,
                p_WS_W=described.points[k],
                normal_W=described.normals[k],
                friction=friction,
                restitution=float(described.restitutions[k]),
                lasting_factor=factor,
                lasting_speed=speed,
            )
        )
    return tuple(surfaces)


def _outliers(data: Data, observed: Sequence[Observed], found: Estimation) -> tuple[Outlier, ...]:
    """Return the outliers, the largest first."""
    from contact_dynamics.numerics.clustered_fit import REJECTED

    rows = {
        "velocities after impacts": (data.strikes.recordings, data.strikes.times),
        "heights at impacts": (data.strikes.recordings, data.strikes.times),
        "heights at rest": (data.resting.recordings, None),
        "first flights": (data.center.recordings, None),
        "turns of first flights": (data.center.recordings, None),
    }
    outliers = {}
    for kind, sizes in zip(found.kinds, found.fit.sizes, strict=True):
        recordings, times = rows[kind]
        for row in np.flatnonzero(sizes > REJECTED):
            name = observed[recordings[row]].name
            time = math.nan if times is None else float(times[row])
            outliers[kind, name, time if times is not None else 0.0] = Outlier(
                recording=name, kind=kind, time=time, size=float(sizes[row])
            )
    return tuple(sorted(outliers.values(), key=lambda each: -each.size))
