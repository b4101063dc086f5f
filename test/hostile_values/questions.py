# SPDX-License-Identifier: Apache-2.0
"""Calls about questions."""

import numpy as np

from contact_dynamics.questions import (
    AtRate,
    AtStamps,
    AtTimes,
    BodiesContactModeQuestion,
    CarriedSurface,
    ContactModeQuestion,
    Context,
    Defaults,
    ImpactQuestion,
    InTime,
    PublishedState,
    TossQuestion,
    TossSampling,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    UntilPlane,
    ask,
)
from contact_dynamics.questions.many import ManyImpactsQuestion, ManyStates, ManyTumblingsQuestion
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from hostile_values.shared import BOX, CONTACTS, STATE, STATES, WORLD, Calls

QUESTIONS: Calls = {
    "ContactModeQuestion": (
        ContactModeQuestion,
        {
            "body": BOX,
            "force_W": [0.0, 0.0, 1.0],
            "torque_W": [0.0, 0.0, 0.1],
            "gravity_W": [0.0, 0.0, -9.8],
            "velocity_tolerance": 1e-9,
            "distance_tolerance": 1e-6,
            "margin_length": 0.1,
            "include_margins": True,
        },
    ),
    "ImpactQuestion": (
        ImpactQuestion,
        {"body": BOX, "horizon": 1.0, "velocity_tolerance": 1e-9, "distance_tolerance": 1e-6},
    ),
    "TumblingQuestion": (TumblingQuestion, {"body": BOX, "gravity_W": [0.0, 0.0, -9.8], "curve_points": 10}),
    "AtTimes": (AtTimes, {"times": [0.1, 0.2]}),
    "AtRate": (AtRate, {"rate": 100.0, "duration": 0.5}),
    "UntilContact": (UntilContact, {"rate": 100.0, "duration": 0.5}),
    "UntilPlane": (
        UntilPlane,
        {
            "rate": 100.0,
            "duration": 0.5,
            "plane_point": [0.0, 0.0, 0.0],
            "plane_normal": [0.0, 0.0, 1.0],
            "body_point": [0.1, 0.0, 0.0],
        },
    ),
    "PublishedState": (PublishedState, {"fit_window": 0.1}),
    "ManyStates": (ManyStates, STATES),
    "ManyTumblingsQuestion": (
        ManyTumblingsQuestion,
        {"body": BOX, "states": ManyStates(**STATES), "seconds": [0.5]},
    ),
    "ManyImpactsQuestion": (
        ManyImpactsQuestion,
        {
            "body": BOX,
            "states": ManyStates(**STATES),
            "p_WC_W": [[0.1, 0.2, 0.0]],
            "normals_W": [[0.0, 0.0, 1.0]],
            "frictions": [0.5],
            "restitutions": [0.5],
            "velocity_tolerance": 1e-9,
        },
    ),
    "ManyContactModesQuestion": (
        ManyContactModesQuestion,
        {
            "asked": ContactModeQuestion(body=BOX, contacts=CONTACTS),
            "forces_W": [[0.0, 0.0, 1.0]],
            "torques_W": [[0.0, 0.0, 0.1]],
            "contact_counts": (2,),
        },
    ),
    "BodiesContactModeQuestion": (
        BodiesContactModeQuestion,
        {
            "bodies": [BOX],
            "states": [STATE],
            "contacts": CONTACTS,
            "pairs": [(0, None), (0, None)],
            "forces_W": [[0.0, 0.0, 1.0]],
            "torques_W": [[0.0, 0.0, 0.1]],
            "gravity_W": [0.0, 0.0, -9.8],
            "velocity_tolerance": 1e-9,
        },
    ),
    "AtStamps": (AtStamps, {"stamps_ns": [0, 1]}),
    "Defaults": (Defaults, {"horizon": 1.0}),
    "InTime": (InTime, {"strike_window": 0.05, "max_strikes": 10, "hold_step": 1e-3}),
    "CarriedSurface": (CarriedSurface, {"body_name": "box", "surface": WORLD.surfaces[0]}),
    "Context": (Context, {"world": WORLD}),
    "TossQuestion": (TossQuestion, {"body": BOX, "horizon": 0.1, "rate": 100.0, "lasting_factors": [0.8]}),
    "TossSampling": (TossSampling, {"count": 10, "strikes": 1, "seed": 0}),
    "UncertainState": (UncertainState, {"state": STATE, "covariance": 1e-6 * np.eye(12)}),
    "ask": (ask, {"question": TumblingQuestion(body=BOX, state=STATE), "context": Context(world=WORLD)}),
}
