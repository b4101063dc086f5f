# SPDX-License-Identifier: Apache-2.0
"""Impacts: the velocities of rigid bodies just after they collide, with friction (Mason, lecture 27).

- One contact with the fixed world: `planar_impact`, `spatial_impact`; many cases at once: `planar_impacts`,
  `spatial_impacts`.
- One contact of a mechanism, such as a robot arm, given by J M^-1 J^T: `response_impact`, `response_impacts`.
- One contact between two moving bodies: `spatial_pair_impact`.
- Several contacts at one instant, as in a landing on an edge or a face: `several_impact`, `bodies_impact`.
  The result depends on the law, and its spread is returned by `outcomes_over_orders` and
  `outcomes_over_interleavings`.
- Strikes at separate times, with flight between them: `impact_sequence`.
- Contacts that jam without approaching: `jamming_impact`.
- Uncertain states: `spatial_impact_distribution`.

The modules of this package are internal. `law` contains the laws of restitution and the outcomes, and
`energy` checks the energy balance of each law. `planar` and `spatial` treat one contact (`one_contact`) and
many cases (`batch`); `result` contains the types of their results. `several` treats several contacts at one
instant, `in_time` strikes one after the other; both return a `several.result`. `distribution` treats
uncertain states.

- In the plane, the impulse path is Routh's construction (`routh`).
- In space, a contact responds in all directions (`response`), and its sliding direction changes continuously,
  so the impulse `path` is curved. A mechanism, such as a robot arm, is described by its response alone.
- Several contacts strike one after the other (`sequential`, over all `orders`) or all at once
  (`simultaneous`). Their impulses may also interleave in any way
  (`interleavings`). Contacts that do not approach can jam (`jamming`).
- In time, `meetings` finds the contact that strikes next, and `sequence` proceeds from strike to strike.
"""

from contact_dynamics.impact.distribution import ImpactDistribution, spatial_impact_distribution
from contact_dynamics.impact.in_time.sequence import impact_sequence
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar.batch import PlanarImpacts, planar_impacts
from contact_dynamics.impact.planar.one_contact import planar_impact
from contact_dynamics.impact.planar.result import PlanarImpact
from contact_dynamics.impact.planar.routh import ImpulsePath, InverseInertia
from contact_dynamics.impact.several.interleavings import InterleavedOutcomes, outcomes_over_interleavings
from contact_dynamics.impact.several.jamming import jamming_impact
from contact_dynamics.impact.several.orders import OrderedOutcomes, outcomes_over_orders, several_impact
from contact_dynamics.impact.several.result import (
    ImpactSequence,
    ResolvedImpact,
    SequenceEnd,
    SequenceStrike,
    SeveralContactsLaw,
)
from contact_dynamics.impact.several.sequential import bodies_impact
from contact_dynamics.impact.spatial.batch import (
    ResponseImpacts,
    SpatialImpacts,
    StrikingBodies,
    response_impacts,
    spatial_impacts,
)
from contact_dynamics.impact.spatial.one_contact import response_impact, spatial_impact, spatial_pair_impact
from contact_dynamics.impact.spatial.result import ResponseImpact, SpatialImpact
from contact_dynamics.validation_types import check_types_of

__all__ = [
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
    "ResolvedImpact",
    "ResponseImpact",
    "ResponseImpacts",
    "RestitutionLaw",
    "SequenceEnd",
    "SequenceStrike",
    "SeveralContactsLaw",
    "SpatialImpact",
    "SpatialImpacts",
    "StrikingBodies",
    "bodies_impact",
    "impact_sequence",
    "jamming_impact",
    "outcomes_over_interleavings",
    "outcomes_over_orders",
    "planar_impact",
    "planar_impacts",
    "response_impact",
    "response_impacts",
    "several_impact",
    "spatial_impact",
    "spatial_impact_distribution",
    "spatial_impacts",
    "spatial_pair_impact",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
