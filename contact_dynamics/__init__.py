"""Contact modes, impacts and free tumbling of rigid bodies (Mason's lectures 24 to 27).

The table of contents, chapters in reading order; everything here needs NumPy and SciPy, and knows no ROS.

- Lecture 24, 25, rigid bodies: `MassProperties`, `BodyState`, momenta and energies (`rigid_body`).
- Lecture 24, 25, mass properties from particles, shapes and meshes: `MassDistribution` (`inertia`).
- Lecture 25, tumbling: `free_motion` and its `FreeMotion` (`tumbling`); Poinsot's picture of it is in
  `contact_dynamics.tumbling.poinsot_construction`.
- Motion under wrenches and drag: `motion_of`. A state from several: `fit_free_motion`, and under
  forces `fit_motion`. Its covariance along the way: `propagate_covariance`.
- Where a flight ends: `first_contact`, `next_landing`, in a `World` of `Body`, `Surface` and `Obstacle`.
  Shapes of bodies, from spheres to polyhedra: `contact_dynamics.shapes.convex`.
- Contacts: `ContactSet` in space (`contact`), of all kinds (`contact.curvature`), from geometry
  (`find_contacts`); `PlanarContact` and its kin in the plane (`planar`), reached from space by a
  `PlaneOfMotion`.
- Lecture 26, contact modes: `PlanarContactProblem`, `SpatialContactProblem` (`contact_modes`).
- Lecture 27, impact: `planar_impact`, `spatial_impact`, several contacts at once `several_impact`, strikes in
  time `impact_sequence` (`impact`).
- What is refused, and how: `errors`. What counts as zero: `tolerances`.
"""

from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.contact.curvature import Curvatures
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.contact_modes import (
    ModeVerdict,
    PlanarContactProblem,
    PlanarMode,
    PlanarModeAnswer,
    Refusal,
    RefusedMode,
    SpatialContactProblem,
)
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.impact import (
    ImpactOutcome,
    PlanarImpact,
    RestitutionLaw,
    SpatialImpact,
    impact_sequence,
    planar_impact,
    several_impact,
    spatial_impact,
)
from contact_dynamics.landing.earliest import Landing, next_landing
from contact_dynamics.landing.plane_arrival import FirstContact, first_contact
from contact_dynamics.motion.covariance import propagate_covariance
from contact_dynamics.motion.free_fit import fit_free_motion
from contact_dynamics.motion.integrated import motion_of
from contact_dynamics.motion.integrated_fit import fit_motion
from contact_dynamics.plane.projection import PlanarProblem, PlaneOfMotion, best_plane, project_onto_plane
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.body import (
    BodyState,
    MassProperties,
    angular_momentum,
    kinetic_energy,
    momentum,
)
from contact_dynamics.rigid_body.inertia import MassDistribution
from contact_dynamics.shapes.convex import ConvexShape
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.tumbling import FreeMotion, Regime, Trajectory, free_motion, states_of_many
from contact_dynamics.world import Body, Surface, World, box_vertices


def __getattr__(name: str) -> str:
    """Return ``__version__``, which is looked up where it is asked for."""
    if name == "__version__":
        from contact_dynamics.version import version_of_this_package

        return version_of_this_package()
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "Body",
    "BodyState",
    "Contact",
    "ContactDynamicsError",
    "ContactSet",
    "ConvexShape",
    "Curvatures",
    "FirstContact",
    "FreeMotion",
    "ImpactOutcome",
    "Landing",
    "MassDistribution",
    "MassProperties",
    "ModeVerdict",
    "Obstacle",
    "PlanarBody",
    "PlanarContact",
    "PlanarContactProblem",
    "PlanarImpact",
    "PlanarMode",
    "PlanarModeAnswer",
    "PlanarProblem",
    "PlanarVelocity",
    "PlanarWrench",
    "PlaneOfMotion",
    "Refusal",
    "RefusedMode",
    "Regime",
    "RestitutionLaw",
    "SpatialContactProblem",
    "SpatialImpact",
    "Surface",
    "Trajectory",
    "World",
    "angular_momentum",
    "best_plane",
    "box_vertices",
    "find_contacts",
    "first_contact",
    "fit_free_motion",
    "fit_motion",
    "free_motion",
    "impact_sequence",
    "inertia",
    "kinetic_energy",
    "momentum",
    "motion_of",
    "next_landing",
    "planar_impact",
    "project_onto_plane",
    "propagate_covariance",
    "several_impact",
    "spatial_impact",
    "states_of_many",
]
