"""Calls about questions, and which of their arguments become hostile."""

from contact_dynamics.questions import (
    AtRate,
    AtTimes,
    ContactModeQuestion,
    ImpactQuestion,
    PublishedState,
    TumblingQuestion,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.many import ManyImpactsQuestion, ManyStates, ManyTumblingsQuestion
from contact_dynamics.questions.many_contact_modes import ManyContactModesQuestion
from hostile_values.shared import BOX, CONTACTS, STATES, Calls

QUESTIONS: Calls = {
    "ContactModeQuestion": (
        ContactModeQuestion,
        {
            "body": BOX,
            "force_W": [0.0, 0.0, 1.0],
            "torque_W": [0.0, 0.0, 0.1],
            "gravity_W": [0.0, 0.0, -9.8],
            "out_of_plane_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
            "distance_tolerance": 1e-6,
            "friction_facets": 8,
            "margin_length": 0.1,
        },
        {
            "force_W",
            "torque_W",
            "gravity_W",
            "out_of_plane_tolerance",
            "velocity_tolerance",
            "distance_tolerance",
            "friction_facets",
            "margin_length",
        },
    ),
    "ImpactQuestion": (
        ImpactQuestion,
        {"body": BOX, "horizon": 1.0, "velocity_tolerance": 1e-9, "distance_tolerance": 1e-6},
        {"horizon", "velocity_tolerance", "distance_tolerance"},
    ),
    "TumblingQuestion": (
        TumblingQuestion,
        {"body": BOX, "gravity_W": [0.0, 0.0, -9.8], "curve_points": 10},
        {"gravity_W", "curve_points"},
    ),
    "AtTimes": (AtTimes, {"times": [0.1, 0.2]}, set()),
    "AtRate": (AtRate, {"rate": 100.0, "duration": 0.5}, set()),
    "UntilContact": (UntilContact, {"rate": 100.0, "duration": 0.5}, set()),
    "UntilPlane": (
        UntilPlane,
        {
            "rate": 100.0,
            "duration": 0.5,
            "plane_point": [0.0, 0.0, 0.0],
            "plane_normal": [0.0, 0.0, 1.0],
            "body_point": [0.1, 0.0, 0.0],
        },
        set(),
    ),
    "PublishedState": (PublishedState, {"fit_window": 0.1}, set()),
    "ManyStates": (ManyStates, STATES, set()),
    "ManyTumblingsQuestion": (
        ManyTumblingsQuestion,
        {"body": BOX, "states": ManyStates(**STATES), "seconds": [0.5]},
        {"seconds"},
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
        {"p_WC_W", "normals_W", "frictions", "restitutions", "velocity_tolerance"},
    ),
    "ManyContactModesQuestion": (
        ManyContactModesQuestion,
        {
            "asked": ContactModeQuestion(body=BOX, contacts=CONTACTS),
            "forces_W": [[0.0, 0.0, 1.0]],
            "torques_W": [[0.0, 0.0, 0.1]],
            "contact_counts": (2,),
        },
        {"forces_W", "torques_W", "contact_counts"},
    ),
}
