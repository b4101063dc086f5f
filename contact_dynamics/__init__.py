# SPDX-License-Identifier: Apache-2.0
"""Contact modes, impacts, free tumbling and whole tosses of rigid bodies (Mason's lectures 24 to 27).

This page has what most users need: bodies and their states, contacts, problems, and one call for each
question. Everything else is in the chapters, which are listed in reading order. Each chapter's docstring says
what is in it. All of it needs NumPy and SciPy, but no ROS.

- `rigid_body`: mass properties, states, momenta and energies (lectures 24 and 25), and in it `inertia`: mass
  properties from particles, shapes and meshes.
- `tumbling`: where a free body will be, in closed form (`free_motion`); flips, Poinsot's picture (lecture
  25).
- `motion`: motion under wrenches and drag (`motion_of`), fits to published states, covariances.
- `shapes`: spheres, cylinders, polyhedra; an `Obstacle`. A `World` has bodies, surfaces and gravity.
- `contact`: a `Contact` and sets of them, given or found from geometry (`find_contacts`).
- `plane`: a `PlanarBody` and its kin, and the way from space to a plane of motion and back.
- `landing`: where a flight ends (`next_landing`).
- `contact_modes`: does each contact separate, slide or stay (lecture 26)? State a `PlanarContactProblem` or
  a `SpatialContactProblem`, and ask it: ``contact_modes(problem)``, `mode_margins`, `statics`,
  `largest_load`.
- `impact`: velocities after an impact (lecture 27): `planar_impact`, `spatial_impact`, several contacts at
  once (`several_impact`) or one after the other in time (`impact_sequence`).
- `toss`: the whole motion of a body from a state in flight to rest: ``toss(body, state, world)``, and with
  uncertain inputs `sampled_toss`.
- `questions`: what the services answer, asked in Python: one question with all its options, one answer.

A chapter with a function of its name, `contact_modes` or `toss`, can be called as that function.

`errors` has what misuse raises, and `tolerances` says what counts as zero.
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
        ModeVerdict,
        PlanarContactProblem,
        SpatialContactProblem,
        contact_modes,
        largest_load,
        mode_margins,
        statics,
    )
    from contact_dynamics.errors import ContactDynamicsError
    from contact_dynamics.impact import (
        RestitutionLaw,
        impact_sequence,
        planar_impact,
        several_impact,
        spatial_impact,
    )
    from contact_dynamics.landing import next_landing
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
        "ModeVerdict",
        "PlanarContactProblem",
        "SpatialContactProblem",
        "largest_load",
        "mode_margins",
        "statics",
    ),
    "errors": ("ContactDynamicsError",),
    "impact": ("RestitutionLaw", "impact_sequence", "planar_impact", "several_impact", "spatial_impact"),
    "landing": ("next_landing",),
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
    """Import a chapter, or what this page has of it, where it is asked for."""
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
    "contact",
    "contact_modes",
    "find_contacts",
    "free_motion",
    "impact",
    "impact_sequence",
    "inertia",
    "landing",
    "largest_load",
    "mode_margins",
    "motion",
    "motion_of",
    "next_landing",
    "planar_impact",
    "plane",
    "questions",
    "rigid_body",
    "sampled_toss",
    "several_impact",
    "shapes",
    "spatial_impact",
    "state_covariance",
    "statics",
    "toss",
    "tumbling",
]


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
