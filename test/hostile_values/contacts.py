"""Calls about contacts, worlds and contact problems, and which of their arguments become hostile."""

from contact_dynamics import (
    Contact,
    ContactSet,
    PlanarBody,
    PlanarContact,
    PlanarContactProblem,
    PlanarVelocity,
    PlanarWrench,
    SpatialContactProblem,
    Surface,
    World,
    find_contacts,
    next_landing,
)
from contact_dynamics.contact import ContactUncertainty
from hostile_values.shared import (
    BALL,
    BOX,
    CONTACTS,
    CORNERS,
    FLOOR,
    LEAN,
    RESTING,
    ROD,
    STATE,
    TIP,
    TOUCH,
    WORLD,
    Calls,
)

CALLS_WITH_CONTACTS: Calls = {
    "Contact": (Contact, TOUCH, set()),
    "ContactSet": (ContactSet, CORNERS, set()),
    "Surface": (Surface, FLOOR, {"p_WS_W", "normal_W", "friction", "restitution"}),
    "World": (
        World,
        {"bodies": (BOX,), "surfaces": (Surface(**FLOOR),), "gravity_W": [0, 0, -9.8]},
        {"gravity_W"},
    ),
    "PlanarBody": (PlanarBody, {"mass": 1.0, "inertia": 0.5}, set()),
    "PlanarVelocity": (PlanarVelocity, LEAN, set()),
    "PlanarWrench": (PlanarWrench, {"f": (0.0, -9.8), "moment": 0.1}, set()),
    "PlanarContact": (PlanarContact, TIP, set()),
    "next_landing": (
        next_landing,
        {
            "body": BOX,
            "state": STATE,
            "world": WORLD,
            "horizon": 0.5,
            "distance_tolerance": 1e-6,
            "velocity_tolerance": 1e-9,
        },
        {"horizon", "distance_tolerance", "velocity_tolerance"},
    ),
    "find_contacts": (
        find_contacts,
        {"body": BOX, "state": STATE, "surfaces": WORLD.surfaces, "distance_tolerance": 1.0},
        {"distance_tolerance"},
    ),
    "PlanarContactProblem": (
        PlanarContactProblem,
        {
            "body": ROD,
            "velocity": PlanarVelocity(v=(0.0, 0.0), w=0.0),
            "contacts": [PlanarContact(**TIP)],
            "wrench": PlanarWrench(f=(0.0, -9.8)),
            "velocity_tolerance": 1e-9,
            "acceleration_tolerance": 1e-9,
        },
        {"velocity_tolerance", "acceleration_tolerance"},
    ),
    "SpatialContactProblem": (
        SpatialContactProblem,
        {
            "body": BALL,
            "state": RESTING,
            "contacts": CONTACTS,
            "force_W": [0.0, 0.0, -9.8],
            "torque_W": [0.0, 0.0, 0.0],
            "friction_facets": 8,
            "velocity_tolerance": 1e-9,
        },
        {"force_W", "torque_W", "friction_facets", "velocity_tolerance"},
    ),
    "ContactUncertainty": (ContactUncertainty, {"points": 1e-3, "normals": 1e-3, "frictions": 0.1}, set()),
}
