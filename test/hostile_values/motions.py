# SPDX-License-Identifier: Apache-2.0
"""Calls about free and forced motion."""

from dataclasses import replace

import numpy as np

from contact_dynamics import free_motion, motion, tumbling
from contact_dynamics.motion import ConstantWrench, Drag, motion_of
from hostile_values.shared import BALL, STATE, STATES, WHERE, Calls

FREE = free_motion(BALL, STATE)
FORCED = motion.forced_motion(BALL, STATE, drag=Drag(linear=0.1), max_steps=500)
FLIPPING = free_motion(BALL, replace(STATE, w_WB_W=[0.01, 5.0, 0.01]))
SEEN = [FREE.state_at(seconds) for seconds in (0.0, 0.01, 0.02, 0.03)]
SHAKING = [replace(state, p_WB_W=state.p_WB_W + 1e-4 * (k % 2)) for k, state in enumerate(SEEN)]
MOMENTS = [0.1, 0.2, 0.25]
VARIANCES = 1e-6 * np.eye(12)
APPLIED = {
    "gravity_W": [0.0, 0.0, -9.8],
    "wrench": ConstantWrench(force=[1.0, 0.0, 0.0]),
    "drag": Drag(linear=0.1),
    "wrench_of": None,
    "max_steps": 100,
}

MOTIONS: Calls = {
    "free_motion": (free_motion, {**WHERE, "gravity_W": [0.0, 0.0, -9.8]}),
    "FreeMotion.state_at": (FREE.state_at, {"seconds": 0.5}),
    "FreeMotion.at": (FREE.at, {"seconds": [0.1, 0.5]}),
    "flips_of_many": (tumbling.flips_of_many, {"moments": MOMENTS, "w_P": [[1.0, 2.0, 0.5]]}),
    "next_flips": (tumbling.next_flips, {"motion": FREE, "count": 2, "covariance": VARIANCES}),
    "next_flips of a body that flips": (
        tumbling.next_flips,
        {"motion": FLIPPING, "count": 2, "covariance": VARIANCES},
    ),
    "poinsot": (tumbling.poinsot, {"motion": FREE}),
    "rolling_curves": (tumbling.rolling_curves, {"motion": FREE, "count": 10}),
    "rotations_of_many": (
        tumbling.rotations_of_many,
        {"moments": MOMENTS, "w_P": [[1.0, 2.0, 0.5]], "seconds": [0.5]},
    ),
    "states_of_many": (tumbling.states_of_many, {"I_B": np.diag(MOMENTS), **STATES, "seconds": 0.5}),
    "motion_of": (motion_of, {**WHERE, **APPLIED}),
    "forced_motion": (motion.forced_motion, {**WHERE, **APPLIED}),
    "ForcedMotion.from_state": (FORCED.from_state, {"state": STATE}),
    "ForcedMotion.state_at": (FORCED.state_at, {"seconds": 0.5}),
    "ForcedMotion.at": (FORCED.at, {"seconds": [0.1, 0.5]}),
    "Drag": (Drag, {"linear": 0.1, "quadratic": 0.1, "linear_angular": 0.01, "quadratic_angular": 0.01}),
    "ConstantWrench": (ConstantWrench, {"force": [1.0, 0.0, 0.0], "torque": [0.0, 0.1, 0.0]}),
    "StateNoise": (
        motion.StateNoise,
        {
            "position": 1e-3,
            "orientation": 1e-2,
            "linear_velocity": 0.1,
            "angular_velocity": 0.1,
            "position_time": 0.01,
            "orientation_time": 0.02,
            "degrees_of_freedom": 4.0,
        },
    ),
    "measured_noise": (
        motion.measured_noise,
        {"body": BALL, "flights": [SHAKING] * 10, "gravity_W": [0.0, 0.0, -9.8]},
    ),
    "covariance_along": (
        motion.covariance_along,
        {"motion": FREE, "covariance": VARIANCES, "times": [0.1], "samples": 50, "seed": 0},
    ),
    "propagate_covariance": (
        motion.propagate_covariance,
        {
            **WHERE,
            "covariance": VARIANCES,
            "times": [0.1],
            "gravity_W": [0.0, 0.0, -9.8],
            "gravity_covariance_W": np.eye(3),
            "by_gravity": [0.1, 0.1],
        },
    ),
    "fit_free_motion": (
        motion.fit_free_motion,
        {"body": BALL, "states": SEEN, "gravity_W": [0.0, 0.0, -9.8]},
    ),
    "fit_motion": (motion.fit_motion, {"body": BALL, "states": SEEN, **APPLIED}),
    "forced_state_derivatives": (motion.forced_state_derivatives, {"motion": FORCED, "seconds": [0.1]}),
    "state_derivatives": (motion.state_derivatives, {"motion": FREE, "seconds": [0.1]}),
}
