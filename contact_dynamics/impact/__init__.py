"""Impact (Mason, lecture 27): what a body's velocity is after it strikes.

In reading order: the laws and outcomes (`law`); the plane, with Routh's construction (`routh`, `planar`,
`result`), two bodies in it (`pair`) and many cases at once (`batch`); space, where a contact responds in all
directions (`response`) and sliding swerves (`sliding`, `series`, `stopping`, `progress`, `swerve`, `spatial`,
`spatial_result`), and many cases at once (`spatial_batch`, in `lockstep`, `many_progress`; what both batches
check is in `table`, the arithmetic that one case and many share in `elementwise`); several contacts at once
(`several`, `several_planar`, `bodies`, `simultaneous`, `several_result`); strikes in time with flight between
(`sequence`, `meetings`, `sequence_result`); uncertain states (`uncertain`).
"""

from contact_dynamics.impact.distribution import (
    ImpactDistribution,
    planar_impact_distribution,
    spatial_impact_distribution,
)
from contact_dynamics.impact.in_time.result import ImpactSequence, SequenceEnd, TimedStrike
from contact_dynamics.impact.in_time.sequence import impact_sequence, impact_sequence_of
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar.batch import PlanarImpacts, planar_impacts
from contact_dynamics.impact.planar.one_contact import planar_impact
from contact_dynamics.impact.planar.result import PlanarImpact
from contact_dynamics.impact.planar.routh import ImpulsePath, InverseInertia
from contact_dynamics.impact.planar.two_bodies import planar_pair_impact
from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.impact.several.orders import outcomes_at_once, outcomes_over_orders, several_impact
from contact_dynamics.impact.several.planar import planar_several_impact
from contact_dynamics.impact.several.result import (
    BodiesImpact,
    OrderedOutcomes,
    SeveralContactsLaw,
    SeveralImpact,
    SeveralVerdict,
)
from contact_dynamics.impact.several.sequential import bodies_impact
from contact_dynamics.impact.several.settling import settling_impact
from contact_dynamics.impact.spatial.batch import SpatialImpacts, StrikingBodies, spatial_impacts
from contact_dynamics.impact.spatial.one_contact import spatial_impact, spatial_pair_impact
from contact_dynamics.impact.spatial.result import SpatialImpact

__all__ = [
    "BodiesImpact",
    "ImpactDistribution",
    "ImpactOutcome",
    "ImpactSequence",
    "ImpulsePath",
    "InverseInertia",
    "OrderedOutcomes",
    "PathEvent",
    "PlanarImpact",
    "PlanarImpacts",
    "RestitutionLaw",
    "SequenceEnd",
    "SeveralContactsLaw",
    "SeveralImpact",
    "SeveralVerdict",
    "SpatialImpact",
    "SpatialImpacts",
    "StrikingBodies",
    "TimedStrike",
    "bodies_impact",
    "impact_sequence",
    "impact_sequence_of",
    "jamming_impact",
    "outcomes_at_once",
    "outcomes_over_orders",
    "planar_impact",
    "planar_impact_distribution",
    "planar_impacts",
    "planar_pair_impact",
    "planar_several_impact",
    "settling_impact",
    "several_impact",
    "spatial_impact",
    "spatial_impact_distribution",
    "spatial_impacts",
    "spatial_pair_impact",
]
