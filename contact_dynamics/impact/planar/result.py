# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at one planar contact has the velocities afterwards and the impulse path."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.impact.energy import energy_change, law_created
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.impact.planar.routh import ImpulsePath, InverseInertia
from contact_dynamics.plane.types import PlanarVelocity, Vector2
from contact_dynamics.records import Record


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarImpact(Record):
    """The answer to one planar impact. Contact axes are tangent, then normal. Impulses act on the body.

    Attributes:
        restitution_law: The restitution law that was asked for.
        velocity: m/s and rad/s, the velocity of the body afterwards, axes of the plane.
        velocity_before_C: m/s, the contact's velocity before, relative to what it touches, contact axes. A
            component within the tolerance is 0.
        inverse_inertia: 1/kg, the contact's response to impulse.
        contact_path: The impulse path and the contact's velocity afterwards, contact axes.
        impulse: N s, the total impulse on the body, axes of the plane.
        other_velocity: The velocity of the second body afterwards, or None for the fixed world.
    """

    restitution_law: RestitutionLaw
    velocity: PlanarVelocity
    velocity_before_C: Vector2
    inverse_inertia: InverseInertia
    contact_path: ImpulsePath
    impulse: Vector2
    other_velocity: PlanarVelocity | None = None

    @property
    def outcome(self) -> ImpactOutcome:
        """Return what the contact did."""
        return self.contact_path.outcome

    @property
    def jams(self) -> bool:
        """Return whether sliding drove the contact into compression (the lecture's sliding rod; Painleve)."""
        return self.contact_path.jams

    @property
    def velocity_after_C(self) -> Vector2:
        """Return the contact's velocity afterwards, m/s, contact axes."""
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
        """Return the vertices of the impulse path in order, each with its meaning, N s, contact axes.

        Without an impulse, the path is its start alone. Vertices that coincide are all listed.
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

    @property
    def energy_change(self) -> float:
        """Return the change of kinetic energy, J: the impulse times the contact's mean velocity."""
        return energy_change(self.impulse_C, self.velocity_before_C, self.velocity_after_C)

    @property
    def creates_energy(self) -> bool:
        """Return whether the law gave the body energy, beyond rounding. Only Newton's law can do that."""
        return bool(law_created(self.impulse_C, self.velocity_before_C, self.velocity_after_C))
