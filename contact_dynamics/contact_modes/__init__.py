# SPDX-License-Identifier: Apache-2.0
"""Contact modes (Mason, lecture 26): does the body, at each contact, separate, slide or stay fixed?

You state a `PlanarContactProblem` or a `SpatialContactProblem`, and pass it to the functions of
`plane_or_space`. `contact_modes` finds every consistent mode. `mode_margins` says how far the wrench is from
leaving each of them, `geometry_margins` how far contacts are from another verdict, and `refused_modes` says
why the other modes are not consistent. `wrench_sets` returns the wrenches of each mode. `statics` says
whether a body at rest stays at rest. In space, the functions of `largest_load` say how large a push may
become, how far a tray may accelerate, tilt or spin, how little friction is enough, and whether a grasp has
closure.

A mode is a string with one of the `letters` for each contact. `result` has the types of answers.

Files of `planar` and `spatial` that do the same have the same name. `problem` has the question, and its case:
the question in the coordinates in which it is answered. `answer` gives the verdict and all modes. `statics`
and `wrench_sets` answer other questions. If contacts are uncertain, `uncertain` searches boxes of contacts
for other verdicts; its namesakes say how much each contact may be off, and prove with `everywhere` that a
mode holds in the whole box, and that no other does (in space `excluded`).

- In the plane, `answer` solves a single contact in closed form. For several contacts, `coincident` first
  takes those together that coincide. `enumeration` then lists the modes that kinematics allows, which are
  faces of a `cone`, and `judgement` decides which of them mechanics allows. If the equations of a mode are
  independent, `determined` solves them. If they are not, `wrench_cone` decides by the cone of wrenches that
  can bring the mode about.
- In space, `kinematic` gives the strings of contacting, separating and ways of sliding. With mechanics, the
  `likely_mode` comes first, for which a single contact at rest has its own file (`one_contact`).
  `only_motion` may show that no other mode exists. Otherwise `completeness` finds or refutes all others, with
  linear programs (`holding_programs`), ranges of directions with one solution (`only_solution`) and modes in
  which contacts share loads (`shared_loads`). What this leaves undecided takes a `search` of all combinations
  of `options`, in `regions` of common motions (`pyramid_programs`). The programs are solved by a
  `dual_simplex` (`simplex_steps`), and as a `careful_program` if rounding may decide. Modes that were found
  are made exact (`realised`, `exact_modes`, `exact_letters`), those that hold `narrowly` are found near
  others, and `round_cones` decides whether forces hold contacts. `mode_with_forces` gives the accelerations.
  The wrenches of a mode (`wrenches`, on a `cone`) come in ways of sliding. `margins` are distances to sums of
  round cones, also of modes in which contacts begin to slide (`margins_of_sliding`), and so are the reasons
  of refused modes.
"""

from contact_dynamics.contact_modes.letters import Letter
from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
from contact_dynamics.contact_modes.planar.wrench_sets import (
    PlanarModeMargin,
    PlanarWrenchSet,
    WrenchHalfSpace,
)
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
    PlanarMode,
    PlanarModeAnswer,
    Refusal,
    RefusedMode,
    SpatialMode,
    SpatialModeAnswer,
    VerdictsWithin,
)
from contact_dynamics.contact_modes.spatial.kinematic import spatial_kinematic_modes, spatial_sliding_modes
from contact_dynamics.contact_modes.spatial.largest_load import (
    Closure,
    LargestLoad,
    LeastFriction,
    closure,
    largest_acceleration,
    largest_load,
    largest_spin,
    largest_tilt,
    least_friction,
)
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "BodyStatics",
    "Certainty",
    "Closure",
    "GeometryMargin",
    "LargestLoad",
    "LeastFriction",
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
    "closure",
    "contact_modes",
    "geometry_margins",
    "largest_acceleration",
    "largest_load",
    "largest_spin",
    "largest_tilt",
    "least_friction",
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
