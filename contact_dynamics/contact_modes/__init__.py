# SPDX-License-Identifier: Apache-2.0
"""Contact modes (Mason, lecture 26): whether the body separates, slides or sticks at each contact.

Make a `PlanarContactProblem` or a `SpatialContactProblem`, and pass it to one of these functions:

- `contact_modes` returns the verdict and all consistent modes, and `refused_modes` the reasons for which the
  other modes are not consistent. `contact_modes` also takes the problem of several bodies that touch each
  other, a `BodiesContactProblem`, or that of a mechanism, a `ResponseContactProblem`.
- `mode_margins` returns the smallest change of the wrench that ends each mode, `largest_load` the largest
  load of a body at rest in space, and `geometry_margins` the errors of the contacts that change the answer.
- `wrench_sets` returns the wrenches that can cause each mode.
- `statics` returns whether a body at rest stays at rest. `largest_acceleration`, `largest_tilt` and
  `largest_spin` return the largest motion of its support, `least_friction` the smallest friction that is
  sufficient, and `closure` whether contacts have form or force closure. All of these are in `largest_load`.

A mode is a string with one of the `letters` for each contact. `result` contains the types of answers, and
`plane_or_space` the functions above. Problems on surfaces that move are transformed to the frame of the
surfaces (`surface_frame`).

The modules of this package are internal. In `planar` and `spatial`, files for the same purpose have the same
name. `problem` contains the problem, and its case: the problem in the coordinates in which it is solved.
`answer` computes the verdict and all modes. `statics` and `wrench_sets` contain further results. If contacts
are uncertain, `uncertain` searches boxes of contacts for other verdicts, and proves that a mode is consistent
in a whole box. The files of the same name in `planar` and `spatial` determine the possible errors of each
contact, and prove that no other mode is consistent.

- In the plane, `answer` solves a single contact in closed form. For several contacts, those that coincide are
  first merged (`problem`). `enumeration` then lists the kinematically possible modes, which are faces of a
  `cone`, and `judgement` determines which of them are consistent with mechanics. If the equations of a mode
  are independent, it solves them; otherwise `wrench_cone` decides by the cone of wrenches that can
  cause the mode.
- In space, `kinematic` lists the strings of closed and separating contacts, and the sectors of sliding
  directions. With mechanics, the `likely_mode` is tried first; a single contact at rest has its own file
  (`one_contact`). `only_motion` may prove that no other mode exists. Otherwise `completeness` finds or
  refutes all others, with linear programs (`holding_programs`), exact solutions and ranges of directions
  without others (`exact_letters`), and modes in which contacts share loads (`shared_loads`). The remaining
  cases require a `search` of all combinations of `options`, in `regions` of common motions. The programs are
  solved by a `dual_simplex` (`simplex_steps`). The modes found are made exact (`exact_modes`), and
  `round_cones` decides whether forces hold contacts. `mode_with_forces` computes the accelerations. The
  wrenches of a mode (`wrenches`, on a `cone`) are divided by sliding directions. The same search serves
  several bodies, and a mechanism whose contact points respond to forces in a known way (`response`).
  `margins` are distances to sums of round cones, and so are the amounts of refused modes.
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
    BodiesMode,
    BodiesModeAnswer,
    BodyStatics,
    Certainty,
    GeometryMargin,
    ModeProbability,
    ModeVerdict,
    PlanarMode,
    PlanarModeAnswer,
    Refusal,
    RefusedMode,
    ResponseMode,
    ResponseModeAnswer,
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
from contact_dynamics.contact_modes.spatial.response import BodiesContactProblem, ResponseContactProblem
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "BodiesContactProblem",
    "BodiesMode",
    "BodiesModeAnswer",
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
    "ResponseContactProblem",
    "ResponseMode",
    "ResponseModeAnswer",
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
