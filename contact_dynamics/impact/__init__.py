# SPDX-License-Identifier: Apache-2.0
"""An impact (Mason, lecture 27) changes a body's velocity. These chapters say what it is afterwards.

`law` has the laws of restitution and the outcomes. `energy` judges what these laws do to energy. `planar` and
`spatial` treat one contact (`one_contact`) and many cases at once (`batch`), and each has a file for what its
functions return (`result`). `several` treats several contacts at once. `in_time` treats strikes one after the
other, with flight between them. `distribution` is for uncertain states.

- In the plane, the impulse path is Routh's construction (`routh`). In `two_bodies`, both bodies may move.
- In space, a contact responds in all directions (`response`), and its sliding direction swerves, so that the
  impulse `path` bends.
- Several contacts strike in turn (`sequential`, in all `orders`) or at once (`simultaneous`), also in the
  plane (`planar`). Their impulses may also interleave in any way (`interleavings`). Contacts that do not
  approach can jam (`jamming`) until that is over (`settling`).
- In time, `meetings` finds which contact strikes next, and `sequence` goes on from strike to strike
  (`strike_by_strike`).
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
from contact_dynamics.impact.several.interleavings import outcomes_over_interleavings
from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.impact.several.orders import outcomes_at_once, outcomes_over_orders, several_impact
from contact_dynamics.impact.several.planar import planar_several_impact
from contact_dynamics.impact.several.result import (
    BodiesImpact,
    InterleavedOutcomes,
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
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "BodiesImpact",
    "ImpactDistribution",
    "ImpactOutcome",
    "ImpactSequence",
    "ImpulsePath",
    "InterleavedOutcomes",
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
    "outcomes_over_interleavings",
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

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
