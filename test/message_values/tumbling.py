# SPDX-License-Identifier: Apache-2.0
"""Random answers about tumbling, and their parts."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st

from contact_dynamics.motion.covariance import CarriedCovariance, PropagationMethod, orientation_deviations
from contact_dynamics.motion.integrated import Method
from contact_dynamics.questions import Event, EventKind, TumblingAnswer
from contact_dynamics.tumbling import Flips, Poinsot, Regime, RollingCurves
from contact_dynamics.tumbling.poinsot_construction import semi_axes
from message_values.shared import (
    NAMES,
    NO_OFFSET,
    arrays,
    fits,
    flags,
    numbers,
    odd_numbers,
    positive,
    some,
    states,
    texts,
    trajectories,
    tuples_of,
    warnings,
)


@st.composite
def carried(draw: st.DrawFn, seconds: np.ndarray) -> CarriedCovariance:
    """The covariances of a trajectory's samples; NaN where no double holds them."""
    covariances = draw(arrays(len(seconds), 12, 12))
    if draw(flags):
        covariances[-1] = math.nan
    return CarriedCovariance(
        seconds=seconds,
        covariances=covariances,
        orientation_deviations=orientation_deviations(covariances),
        trusted=np.array(draw(tuples_of(flags, len(seconds)))),
        method=PropagationMethod.LINEARISED,
    )


@st.composite
def rotations(draw: st.DrawFn) -> tuple[Poinsot, Flips, RollingCurves | None]:
    """Poinsot's picture, with any number of flips, with curves and without."""
    energy, moments = draw(positive), draw(arrays(3, of=positive))
    flips, points = draw(st.integers(0, 3)), draw(st.integers(0, 3))
    picture = Poinsot(
        regime=draw(st.sampled_from([regime for regime in Regime if regime is not Regime.UNKNOWN])),
        rotational_energy=energy,
        L_W=draw(arrays(3)),
        invariable_plane_distance=draw(odd_numbers),
        polhode_period=draw(odd_numbers),
        precession_per_period=draw(odd_numbers),
        principal_moments=moments,
        principal_axes_B=draw(arrays(3, 3)),
        ellipsoid_semi_axes=semi_axes(energy, moments),
        sensitivity=draw(odd_numbers),
    )
    curves = RollingCurves(
        seconds=draw(arrays(points)), polhode_B=draw(arrays(points, 3)), herpolhode_W=draw(arrays(points, 3))
    )
    told = Flips(seconds=draw(arrays(flips)), deviations=draw(arrays(flips, of=odd_numbers)))
    return picture, told, curves if points else None


events = st.builds(
    Event,
    kind=st.sampled_from(EventKind),
    seconds=numbers,
    point_W=arrays(3),
    velocity_W=arrays(3),
    surface=texts,
)


@st.composite
def tumbling_answers(draw: st.DrawFn, p_FB_F: np.ndarray = NO_OFFSET) -> TumblingAnswer:
    """With and without samples, covariance, event, fit and torque."""
    trajectory = draw(trajectories())
    picture, flips, curves = draw(rotations()) if draw(flags) else (None, None, None)
    has_covariance = len(trajectory) > 0 and draw(flags)
    return TumblingAnswer(
        body_name=draw(st.sampled_from(NAMES)) if not p_FB_F.any() else "brick",
        p_FB_F=p_FB_F,
        state=draw(states),
        fit=draw(some(fits)),
        trajectory=trajectory,
        covariance=draw(carried(trajectory.seconds)) if has_covariance else None,
        method=draw(st.sampled_from(Method)),
        event=draw(some(events)),
        poinsot=picture,
        flips=flips,
        curves=curves,
        warnings=draw(warnings),
    )
