"""Contact modes (Mason, lecture 26): does the body, at each contact, separate, slide or stay fixed?

In reading order: verdicts and evidence (`result`); one contact in closed form (`single`); any planar set
(`planar`, `coincident`), stated as a cone (`problem`, `cone`), its modes enumerated (`enumeration`) and
judged (`dynamics`, `independent`, `edges`, `wrench_cone`, `least_force`); applied wrenches of each mode
(`wrench_sets`), their map and margins (`margins`); equilibrium, jamming and wedging (`statics`). In space:
contacting and separating modes (`spatial`, `spatial_cone`), and with ways of sliding (`spatial.sliding`);
sticking and sliding with mechanics (`spatial.answer`, `spatial_result`, `spatial.problem`): every combination
of letters (`search`, `options`, `regions`, `dual_simplex`), shown with exact
friction (`exact_friction`) and shared forces (`least_forces`); why other strings are refused
(`refusals`); applied wrenches of each mode (`spatial_wrench_sets`, `wrenches`) and way of
sliding (`ways_of_sliding`), margins (`spatial.margins`, `margins_of_sliding`); statics (`spatial_statics`).
What follows where no mode is consistent though no contact approaches: `jamming`, by `complementarity`, until
it is over (`settling`).
"""

from contact_dynamics.contact_modes.planar.answer import planar_contact_modes
from contact_dynamics.contact_modes.planar.margins import (
    PlanarModeMargin,
    planar_mode_map,
    planar_mode_margins,
)
from contact_dynamics.contact_modes.planar.result import (
    ModeVerdict,
    PlanarMode,
    PlanarModeAnswer,
    Refusal,
    RefusedMode,
)
from contact_dynamics.contact_modes.planar.statics import BodyStatics, Certainty, planar_statics
from contact_dynamics.contact_modes.planar.wrench_sets import PlanarWrenchSet, WrenchHalfSpace
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.kinematic import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin, spatial_mode_margins
from contact_dynamics.contact_modes.spatial.refusals import spatial_refused_modes
from contact_dynamics.contact_modes.spatial.result import SpatialMode, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial.sliding import spatial_sliding_modes
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet, spatial_wrench_sets

__all__ = [
    "BodyStatics",
    "Certainty",
    "ModeVerdict",
    "PlanarMode",
    "PlanarModeAnswer",
    "PlanarModeMargin",
    "PlanarWrenchSet",
    "Refusal",
    "RefusedMode",
    "SpatialMode",
    "SpatialModeAnswer",
    "SpatialModeMargin",
    "SpatialWrenchSet",
    "WrenchHalfSpace",
    "planar_contact_modes",
    "planar_mode_map",
    "planar_mode_margins",
    "planar_statics",
    "spatial_contact_modes",
    "spatial_kinematic_modes",
    "spatial_mode_margins",
    "spatial_refused_modes",
    "spatial_sliding_modes",
    "spatial_statics",
    "spatial_wrench_sets",
]
