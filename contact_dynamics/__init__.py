# SPDX-License-Identifier: Apache-2.0
"""Contact modes, impacts, free tumbling and whole tosses of rigid bodies (Mason's lectures 24 to 27).

This package contains the names that most users need: bodies and their states, contacts, contact problems, and
the functions that answer the questions listed in docs/api.md. All other names are in the chapters below, in
reading order; the docstring of each chapter describes its contents. The library requires NumPy and SciPy, but
not ROS.

- `rigid_body`: mass properties, states, momenta and energies (lectures 24 and 25); in it `inertia`, mass
  properties from particles, solids and meshes.
- `tumbling`: free motion in closed form (`free_motion`), flips and Poinsot's construction (lecture 25).
- `motion`: motion under wrenches and drag (`motion_of`), fits to published states, covariances.
- `shapes`: spheres, cylinders, polyhedra, and `Obstacle`. A `World` contains bodies, surfaces and gravity.
- `contact`: `Contact` and `ContactSet`, explicit or detected from shapes (`find_contacts`).
- `plane`: `PlanarBody` and the other planar types, and the projection of spatial states onto a plane of
  motion.
- `landing`: the end of a flight (`next_landing`). A landing on an edge or a face has several contacts, all of
  which `several_impact` takes.
- `contact_modes`: whether each contact separates, slides or sticks (lecture 26). Make a
  `PlanarContactProblem`, a `SpatialContactProblem` or a `BodiesContactProblem`, and pass it to
  ``contact_modes(problem)``; `mode_margins`, `statics`, `largest_load` and others take some of them.
- `impact`: velocities after an impact (lecture 27): at one contact (`planar_impact`, `spatial_impact`), of a
  mechanism such as a robot arm (`response_impact`), at several contacts at one instant (`several_impact`) or
  one after the other in time (`impact_sequence`).
- `toss`: the motion of a body from an initial state to rest: ``toss(body, state, world)``, and `sampled_toss`
  for uncertain inputs.
- `questions`: the requests and responses of the ROS services as Python objects: one question with all its
  options, one answer.

The chapters `contact_modes` and `toss` can be called as the functions of the same name.

`errors` contains the exceptions, and `tolerances` the thresholds below which values count as zero.
"""

import difflib
from importlib import import_module
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:  # the same as `_HOMES`
    from contact_dynamics import (
        contact,
        impact,
        landing,
        motion,
        plane,
        questions,
        rigid_body,
        shapes,
        tumbling,
    )
    from contact_dynamics.contact import Contact, ContactSet, find_contacts
    from contact_dynamics.contact_modes import (
        BodiesContactProblem,
        ModeVerdict,
        PlanarContactProblem,
        SpatialContactProblem,
        closure,
        contact_modes,
        largest_acceleration,
        largest_load,
        largest_spin,
        largest_tilt,
        least_friction,
        mode_margins,
        statics,
    )
    from contact_dynamics.errors import ContactDynamicsError
    from contact_dynamics.impact import (
        RestitutionLaw,
        bodies_impact,
        impact_sequence,
        planar_impact,
        response_impact,
        several_impact,
        spatial_impact,
        spatial_pair_impact,
    )
    from contact_dynamics.landing import next_landing, next_meeting
    from contact_dynamics.motion import motion_of
    from contact_dynamics.plane import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
    from contact_dynamics.rigid_body import BodyState, MassProperties, inertia, state_covariance
    from contact_dynamics.shapes import Obstacle
    from contact_dynamics.toss import sampled_toss, toss
    from contact_dynamics.tumbling import free_motion
    from contact_dynamics.world import Body, Surface, World

_HOMES: Final = {
    "contact": ("Contact", "ContactSet", "find_contacts"),
    "contact_modes": (
        "BodiesContactProblem",
        "ModeVerdict",
        "PlanarContactProblem",
        "SpatialContactProblem",
        "closure",
        "largest_acceleration",
        "largest_load",
        "largest_spin",
        "largest_tilt",
        "least_friction",
        "mode_margins",
        "statics",
    ),
    "errors": ("ContactDynamicsError",),
    "impact": (
        "RestitutionLaw",
        "bodies_impact",
        "impact_sequence",
        "planar_impact",
        "response_impact",
        "several_impact",
        "spatial_impact",
        "spatial_pair_impact",
    ),
    "landing": ("next_landing", "next_meeting"),
    "motion": ("motion_of",),
    "plane": ("PlanarBody", "PlanarContact", "PlanarVelocity", "PlanarWrench"),
    "rigid_body": ("BodyState", "MassProperties", "inertia", "state_covariance"),
    "shapes": ("Obstacle",),
    "toss": ("sampled_toss",),
    "tumbling": ("free_motion",),
    "world": ("Body", "Surface", "World"),
}
"""What this page has of each chapter. It is imported when it is asked for, since to import all chapters takes
several times as long as to import NumPy."""

_CHAPTERS: Final = (*_HOMES, "questions", "tolerances")


def __getattr__(name: str) -> Any:
    """Import a chapter, or a name of a chapter that this package exports, on first use."""
    if name in _CHAPTERS:
        return import_module(f"{__name__}.{name}")
    if name == "__version__":
        return import_module(f"{__name__}.version").version_of_this_package()
    for chapter, names in _HOMES.items():
        if name in names:
            globals()[name] = found = getattr(import_module(f"{__name__}.{chapter}"), name)
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}{_meant(name)}")


def _meant(name: str) -> str:
    """Return where a name is that this page does not have, or which similar name it has."""
    if name.startswith("_"):
        return ""
    for chapter in _CHAPTERS:
        if name in getattr(import_module(f"{__name__}.{chapter}"), "__all__", ()):
            return f": it is {__name__}.{chapter}.{name}"
    near = difflib.get_close_matches(name, __all__, n=1)
    return f", did you mean {near[0]}?" if near else ""


__all__ = [
    "BodiesContactProblem",
    "Body",
    "BodyState",
    "Contact",
    "ContactDynamicsError",
    "ContactSet",
    "MassProperties",
    "ModeVerdict",
    "Obstacle",
    "PlanarBody",
    "PlanarContact",
    "PlanarContactProblem",
    "PlanarVelocity",
    "PlanarWrench",
    "RestitutionLaw",
    "SpatialContactProblem",
    "Surface",
    "World",
    "bodies_impact",
    "closure",
    "contact",
    "contact_modes",
    "find_contacts",
    "free_motion",
    "impact",
    "impact_sequence",
    "inertia",
    "landing",
    "largest_acceleration",
    "largest_load",
    "largest_spin",
    "largest_tilt",
    "least_friction",
    "mode_margins",
    "motion",
    "motion_of",
    "next_landing",
    "next_meeting",
    "planar_impact",
    "plane",
    "questions",
    "response_impact",
    "rigid_body",
    "sampled_toss",
    "several_impact",
    "shapes",
    "spatial_impact",
    "spatial_pair_impact",
    "state_covariance",
    "statics",
    "toss",
    "tumbling",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
