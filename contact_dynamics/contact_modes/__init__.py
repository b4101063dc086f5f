"""Contact modes (Mason, lecture 26): does the body, at each contact, separate, slide or stay fixed?

In reading order: verdicts and evidence (`result`); one contact in closed form (`single`); any planar set
(`planar`, `coincident`), stated as a cone (`problem`, `cone`), its modes enumerated (`enumeration`) and
judged (`dynamics`, `independent`, `edges`, `wrench_cone`, `least_force`); applied wrenches of each mode
(`wrench_sets`), their map and margins (`margins`); equilibrium, jamming and wedging (`statics`). In space:
contacting and separating modes (`spatial`, `spatial_cone`), and with ways of sliding (`spatial_sliding`);
sticking and sliding with mechanics (`spatial_dynamics`, `spatial_result`, `spatial_case`): every combination
of letters (`spatial_search`, `spatial_letters`, `spatial_regions`, `spatial_program`), shown with exact
friction (`spatial_sharpening`) and shared forces (`spatial_forces`); why other strings are refused
(`spatial_refusals`); applied wrenches of each mode (`spatial_wrench_sets`, `spatial_wrenches`) and way of
sliding (`spatial_ways`), margins (`spatial_margins`, `spatial_union_margins`); statics (`spatial_statics`).
What follows where no mode is consistent though no contact approaches: `jamming`, by `complementarity`, until
it is over (`settling`).
"""

from contact_dynamics.contact_modes.jamming import jamming_impact
from contact_dynamics.contact_modes.margins import ModeMargin, planar_mode_map, planar_mode_margins
from contact_dynamics.contact_modes.planar import planar_contact_modes
from contact_dynamics.contact_modes.result import (
    ConsistentMode,
    ContactModeAnswer,
    ModeVerdict,
    Refusal,
    RefusedMode,
)
from contact_dynamics.contact_modes.settling import settling_impact
from contact_dynamics.contact_modes.spatial import spatial_kinematic_modes
from contact_dynamics.contact_modes.spatial_dynamics import spatial_contact_modes
from contact_dynamics.contact_modes.spatial_margins import SpatialModeMargin, spatial_mode_margins
from contact_dynamics.contact_modes.spatial_refusals import spatial_refused_modes
from contact_dynamics.contact_modes.spatial_result import SpatialMode, SpatialModeAnswer
from contact_dynamics.contact_modes.spatial_sliding import spatial_sliding_modes
from contact_dynamics.contact_modes.spatial_statics import spatial_statics
from contact_dynamics.contact_modes.spatial_wrench_sets import SpatialWrenchSet, spatial_wrench_sets
from contact_dynamics.contact_modes.statics import BodyStatics, Certainty, planar_statics
from contact_dynamics.contact_modes.wrench_sets import ModeWrenchSet, WrenchHalfSpace

__all__ = [
    "BodyStatics",
    "Certainty",
    "ConsistentMode",
    "ContactModeAnswer",
    "ModeMargin",
    "ModeVerdict",
    "ModeWrenchSet",
    "Refusal",
    "RefusedMode",
    "SpatialMode",
    "SpatialModeAnswer",
    "SpatialModeMargin",
    "SpatialWrenchSet",
    "WrenchHalfSpace",
    "jamming_impact",
    "planar_contact_modes",
    "planar_mode_map",
    "planar_mode_margins",
    "planar_statics",
    "settling_impact",
    "spatial_contact_modes",
    "spatial_kinematic_modes",
    "spatial_mode_margins",
    "spatial_refused_modes",
    "spatial_sliding_modes",
    "spatial_statics",
    "spatial_wrench_sets",
]
