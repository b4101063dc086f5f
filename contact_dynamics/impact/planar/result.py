# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at one planar contact has the velocities afterwards and the impulse path."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.impact.energy import OneEnergy
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar.routh import ImpulsePath, InverseInertia
from contact_dynamics.plane.types import PlanarVelocity, Vector2


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarImpact(OneEnergy):
    """Outcome of one planar impact.

    The contact axes are the tangent, then the normal. Impulses act on the body.

    Attributes:
        restitution_law: Law of restitution.
        velocity: Velocity of the body after the impact, m/s and rad/s, axes of the plane.
        velocity_before_C: Velocity of the contact before the impact, relative to what the body touches, m/s,
            contact axes. Components within the tolerance are 0.
        inverse_inertia: Change of the contact's velocity per impulse, 1/kg.
        contact_path: Impulse path, and the contact's velocity after the impact, contact axes.
        impulse: Total impulse on the body, N s, axes of the plane.
    """

    restitution_law: RestitutionLaw
    velocity: PlanarVelocity
    velocity_before_C: Vector2
    inverse_inertia: InverseInertia
    contact_path: ImpulsePath
    impulse: Vector2

    @property
    def outcome(self) -> ImpactOutcome:
        """Return the motion of the contact during the impact."""
        return self.contact_path.outcome

    @property
    def jams(self) -> bool:
        """Return whether sliding drove the contact into compression (lecture 27; Painleve's paradox)."""
        return self.contact_path.jams

    @property
    def velocity_after_C(self) -> Vector2:
        """Return the contact's velocity after the impact, m/s, contact axes."""
        return (self.contact_path.v_t, self.contact_path.v_n)

    @property
    def impulse_C(self) -> Vector2:
        """Return the total impulse on the body, N s, contact axes."""
        return (self.contact_path.t_end, self.contact_path.p_end)

    @property
    def compression_C(self) -> Vector2:
        """Return the impulse of compression, N s, contact axes."""
        return (self.contact_path.t_compression, self.contact_path.p_compression)

    @property
    def restitution_C(self) -> Vector2:
        """Return the impulse of restitution, N s, contact axes."""
        path = self.contact_path
        return (path.t_end - path.t_compression, path.p_end - path.p_compression)

    @property
    def path(self) -> tuple[tuple[PathEvent, Vector2], ...]:
        """Return the vertices of the impulse path in order, each with its event, N s, contact axes.

        Without an impulse, the path consists of its start. Coinciding vertices are all listed.
        """
        path = self.contact_path
        vertices: list[tuple[PathEvent, Vector2]] = [(PathEvent.START, (0.0, 0.0))]
        if path.outcome == ImpactOutcome.NO_IMPULSE:
            return tuple(vertices)
        compression = (PathEvent.COMPRESSION_ENDS, (path.t_compression, path.p_compression))
        stop = (PathEvent.SLIDING_STOPS, (path.t_stop, path.p_stop))
        if path.outcome in {ImpactOutcome.STICKS_IN_COMPRESSION, ImpactOutcome.REVERSES_IN_COMPRESSION}:
            vertices += [stop, compression]
        elif path.outcome in {ImpactOutcome.STICKS_IN_RESTITUTION, ImpactOutcome.REVERSES_IN_RESTITUTION}:
            vertices += [compression, stop]
        else:
            vertices.append(compression)
        vertices.append((PathEvent.RESTITUTION_ENDS, (path.t_end, path.p_end)))
        return tuple(vertices)

    def _at_contact(self) -> tuple[Vector2, ...]:
        return self.impulse_C, self.velocity_before_C, self.velocity_after_C
