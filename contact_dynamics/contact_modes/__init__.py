"""Contact modes (Mason, lecture 26): does the body, at each contact, separate, slide or stay fixed?

State a `PlanarContactProblem` or a `SpatialContactProblem`, and ask it: `contact_modes` for every consistent
mode, `mode_margins` for how far the wrench is from leaving them, `refused_modes` for why the others are not,
`wrench_sets` for the wrenches of each mode, `statics` for whether a body at rest stays (`plane_or_space`).
A mode is a string with one of the `letters` for each contact; what plane and space share is in `result`.

The files of `planar` and `spatial` have the same names where they do the same. Each begins with `problem`:
the question, and its case in the coordinates that it is answered in. `answer` gives the verdict with all
modes, `margins`, `statics` and `wrench_sets` the rest, and `result` holds what they return.

- In the plane, one contact is a closed form (`one_contact`). Of several, those that coincide are taken
  together (`coincident`), the modes that kinematics allows are enumerated on a `cone` (`enumeration`), and
  judged (`judgement`): from their own equations where these are independent (`determined`), else by the cone
  of their wrenches (`wrench_cone`, `friction_edges`), with least forces as evidence (`least_force`).
- In space, `kinematic` gives the strings of contacting and separating, and `sliding` those with ways of
  sliding. With mechanics, all combinations of `options` are searched (`search`, `regions`, `dual_simplex`),
  and shown with exact friction (`exact_friction`) and shared forces (`least_forces`). `refusals` says why
  others are refused. The wrenches of a mode (`wrenches`, on a `cone`) come in ways of sliding
  (`ways_of_sliding`), and so do margins (`margins_of_sliding`).
"""

from contact_dynamics.contact_modes.letters import Letter
from contact_dynamics.contact_modes.planar.margins import PlanarModeMargin
from contact_dynamics.contact_modes.planar.problem import PlanarContactProblem
from contact_dynamics.contact_modes.planar.result import PlanarMode, PlanarModeAnswer
from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet, WrenchHalfSpace
from contact_dynamics.contact_modes.plane_or_space import (
    contact_modes,
    mode_margins,
    refused_modes,
    statics,
    wrench_sets,
)
from contact_dynamics.contact_modes.result import BodyStatics, Certainty, ModeVerdict, Refusal, RefusedMode
from contact_dynamics.contact_modes.spatial.kinematic import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
from contact_dynamics.contact_modes.spatial.result import SpatialMode, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial.sliding import spatial_sliding_modes
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet

__all__ = [
    "BodyStatics",
    "Certainty",
    "Letter",
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
    "WrenchHalfSpace",
    "contact_modes",
    "mode_margins",
    "refused_modes",
    "spatial_kinematic_modes",
    "spatial_sliding_modes",
    "statics",
    "wrench_sets",
]


def __dir__() -> list[str]:
    return __all__
