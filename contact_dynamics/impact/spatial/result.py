# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at one contact in space has the impulse path and the velocities afterwards."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.impact.energy import OneEnergy
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResponseImpact(OneEnergy):
    """Outcome of one spatial impact of a mechanism. All arrays are in world axes.

    Attributes:
        restitution_law: Law of restitution.
        outcome: Motion of the contact during the impact.
        jams: Whether sliding initially drove the contact into compression (dynamic jamming).
        impulse_W: (3,), N s, total impulse.
        compression_W: (3,), N s, impulse up to the end of compression.
        path_W: (k, 3), N s, points of the impulse path. Points with the event SAMPLE are on curved parts.
        path_events: (k,), event at each point.
        velocity_before_W: (3,), m/s, velocity of the contact before the impact, relative to what it touches.
            Normal and tangential components within the tolerance are 0.
        velocity_after_W: (3,), m/s, velocity of the contact after the impact, relative to what it touches.
        inverse_inertia_W: (3, 3), 1/kg, change of the contact's velocity per impulse.
    """

    restitution_law: RestitutionLaw
    outcome: ImpactOutcome
    jams: bool
    impulse_W: FloatArray
    compression_W: FloatArray
    path_W: FloatArray
    path_events: tuple[PathEvent, ...]
    velocity_before_W: FloatArray
    velocity_after_W: FloatArray
    inverse_inertia_W: FloatArray

    @property
    def restitution_W(self) -> FloatArray:
        """Return the impulse of restitution, (3,), N s."""
        restitution: FloatArray = self.impulse_W - self.compression_W
        return restitution

    def _at_contact(self) -> tuple[list[float], list[float], list[float]]:
        return self.impulse_W.tolist(), self.velocity_before_W.tolist(), self.velocity_after_W.tolist()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialImpact(ResponseImpact):
    """Outcome of one spatial impact of a body, on which the impulses act.

    `ResponseImpact` documents the other fields.

    Attributes:
        state: State of the body after the impact: the pose before it, with the new velocities.
        other_state: State of the second body after the impact, or None for the fixed world.
    """

    state: BodyState
    other_state: BodyState | None = None
