# SPDX-License-Identifier: Apache-2.0
"""Calls about whole tosses."""

import numpy as np

from contact_dynamics import RestitutionLaw, toss
from hostile_values.shared import BOX, STATE, WORLD, Calls

TOSSED = {"body": BOX, "state": STATE, "world": WORLD}
FOLLOWED = toss.toss(**TOSSED, horizon=0.1)
SAMPLED = toss.sampled_toss(**TOSSED, count=2, horizon=0.1)
REGION = toss.Region(mean=np.zeros(3), covariance=1e-4 * np.eye(3), radii=np.array([1.5, 2.5]))

TOSSES: Calls = {
    "toss": (
        toss.toss,
        {
            **TOSSED,
            "horizon": 0.1,
            "max_events": 3,
            "max_alternatives": 0,
            "error": 1e-6,
            "lasting_factors": [0.8],
        },
    ),
    "Toss.at": (FOLLOWED.at, {"seconds": [0.01, 0.05]}),
    "Toss.state_at": (FOLLOWED.state_at, {"seconds": 0.05}),
    "TossDistribution.standard_error": (SAMPLED.standard_error, {"probability": 0.5}),
    "Region.distances": (REGION.distances, {"values": [0.1, 0.0, 0.2], "noise": 0.001}),
    "Region.holds": (REGION.holds, {"values": [0.1, 0.0, 0.2], "noise": 0.001}),
    "TossUncertainty": (
        toss.TossUncertainty,
        {
            "covariance": 1e-4 * np.eye(6),
            "velocity": 0.01,
            "spin": 0.1,
            "height": 1e-3,
            "lasting_factors": [0.8],
            "lasting_factor_stds": [0.1],
        },
    ),
    "sampled_toss": (
        toss.sampled_toss,
        {
            **TOSSED,
            "covariance": 1e-6 * np.eye(12),
            "by_gravity": (0.0, 0.0),
            "count": 4,
            "strikes": 1,
            "to_rest": False,
            "seed": 0,
            "restitution_law": RestitutionLaw.POISSON,
            "horizon": 0.2,
        },
    ),
}
