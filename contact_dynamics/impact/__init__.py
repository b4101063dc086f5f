"""Impact (Mason, lecture 27): what a body's velocity is after it strikes.

In reading order: the laws and outcomes (`law`), Routh's construction in the plane (`routh`, `planar`,
`result`).
"""

from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar import planar_impact
from contact_dynamics.impact.result import PlanarImpact
from contact_dynamics.impact.routh import ImpulsePath, InverseInertia

__all__ = [
    "ImpactOutcome",
    "ImpulsePath",
    "InverseInertia",
    "PathEvent",
    "PlanarImpact",
    "RestitutionLaw",
    "planar_impact",
]
