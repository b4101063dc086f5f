# SPDX-License-Identifier: Apache-2.0
"""Contact modes (Mason, lecture 26): does the body, at each contact, separate, slide or stay fixed?

You state a `PlanarContactProblem` or a `SpatialContactProblem`, and pass it to the functions of
`plane_or_space`. `contact_modes` finds every consistent mode. `mode_margins` says how far the wrench is from
leaving each of them, `largest_load` how large a push in space may become, `geometry_margins` how far contacts
are from another verdict, and `refused_modes` says why the other modes are not consistent. `wrench_sets`
returns the wrenches of each mode. `statics` says whether a body at rest stays at rest.

A mode is a string with one of the `letters` for each contact. The plane and space share the types in
`result`.

Files of `planar` and `spatial` that do the same have the same name. `problem` has the question, and its case:
the question in the coordinates in which it is answered. `answer` gives the verdict and all modes, and
`result` has the types that it returns. `margins`, `statics` and `wrench_sets` answer the other questions. If
contacts are uncertain (`uncertain`), `bounds` says how much, `everywhere` proves that a mode holds in the
whole box, `excluded` that no other does, and `geometry_search` finds the largest box with a proof.

- In the plane, `one_contact` solves a single contact in closed form. For several contacts, `coincident` first
  takes those together that coincide. `enumeration` then lists the modes that kinematics allows, which are
  faces of a `cone` (`extreme_rays`), and `judgement` decides which of them mechanics allows. If the equations
  of a mode are independent, `determined` solves them. If they are not, `wrench_cone` decides by the cone of
  wrenches that can bring the mode about, which the `friction_edges` of the contacts span.
- In space, `kinematic` gives the strings of contacting and separating, and `sliding` those with ways of
  sliding. With mechanics, all combinations of `options` are searched (`search`, `pyramid_programs`),
  and shown with exact friction (`exact_friction`) and shared forces (`least_forces`). `refusals` says why
  others are refused. The wrenches of a mode (`wrenches`, on a `cone`) come in ways of sliding
  (`ways_of_sliding`). Margins are distances to sums of round cones (`round_sums`), also of modes in which
  contacts begin to slide (`margins_of_sliding`).
"""

from contact_dynamics.contact_modes.letters import Letter
from contact_dynamics.contact_modes.planar.margins import PlanarModeMargin
from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
from contact_dynamics.contact_modes.planar.result import PlanarMode, PlanarModeAnswer
from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet, WrenchHalfSpace
from contact_dynamics.contact_modes.plane_or_space import (
    contact_modes,
    geometry_margins,
    mode_margins,
    refused_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.contact_modes.result import (
    BodyStatics,
    Certainty,
    GeometryMargin,
    ModeProbability,
    ModeVerdict,
    Refusal,
    RefusedMode,
    VerdictsWithin,
)
from contact_dynamics.contact_modes.spatial.kinematic import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.largest_load import LargestLoad, largest_load
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.contact_modes.spatial.result import SpatialMode, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial.sliding import spatial_sliding_modes
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "BodyStatics",
    "Certainty",
    "GeometryMargin",
    "LargestLoad",
    "Letter",
    "ModeProbability",
    "ModeVerdict",
    "PlanarContactProblem",
    "PlanarMode",
    "PlanarModeAnswer",
    "PlanarModeMargin",
    "PlanarWrenchSet",
    "Refusal",
    "RefusedMode",
    "SpatialContactProblem",
    "SpatialMode",
    "SpatialModeAnswer",
    "SpatialModeMargin",
    "SpatialWrenchSet",
    "VerdictsWithin",
    "WrenchHalfSpace",
    "contact_modes",
    "geometry_margins",
    "largest_load",
    "mode_margins",
    "refused_modes",
    "spatial_kinematic_modes",
    "spatial_sliding_modes",
    "statics",
    "wrench_sets",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
