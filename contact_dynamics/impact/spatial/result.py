# SPDX-License-Identifier: Apache-2.0
"""The result of an impact at one contact in space has the state afterwards and the impulse path."""

from __future__ import annotations

from dataclasses import dataclass

from contact_dynamics.impact.energy import energy_change, law_created
from contact_dynamics.impact.law import ImpactOutcome, PathEvent, RestitutionLaw
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialImpact(Record):
    """The answer to one impact in space. Impulses act on the body, and all arrays are in world axes.

    Attributes:
        restitution_law: The restitution law that was asked for.
        outcome: What the contact did.
        jams: Whether sliding drove the contact into compression at first.
        state: The state of the body afterwards. It has the pose of before and new velocities.
        impulse_W: (3,), N s, the total impulse.
        compression_W: (3,), N s, the impulse up to the end of compression.
        path_W: (k, 3), N s, points of the impulse path. Those at a SAMPLE lie on a curve.
        path_events: (k,), the meaning of each point.
        velocity_before_W: (3,), m/s, the contact's velocity before, relative to what it touches. Normal and
            tangential parts within the tolerance are 0.
        velocity_after_W: (3,), m/s, the contact's velocity afterwards, relative to what it touches.
        inverse_inertia_W: (3, 3), 1/kg, the contact's change of velocity per impulse.
        other_state: The state of the second body afterwards, or None for the fixed world.
    """

    restitution_law: RestitutionLaw
    outcome: ImpactOutcome
    jams: bool
    state: BodyState
    impulse_W: FloatArray
    compression_W: FloatArray
    path_W: FloatArray
    path_events: tuple[PathEvent, ...]
    velocity_before_W: FloatArray
    velocity_after_W: FloatArray
    inverse_inertia_W: FloatArray
    other_state: BodyState | None = None

    @property
    def restitution_W(self) -> FloatArray:
        """Return the impulse of restitution, (3,), N s."""
        restitution: FloatArray = self.impulse_W - self.compression_W
        return restitution

    @property
    def energy_change(self) -> float:
        """Return the change of kinetic energy, J: the impulse times the contact's mean velocity."""
        return energy_change(*self._at_contact())

    @property
    def creates_energy(self) -> bool:
        """Return whether the law gave the body energy, beyond rounding."""
        return bool(law_created(*self._at_contact()))

    def _at_contact(self) -> tuple[list[float], list[float], list[float]]:
        return self.impulse_W.tolist(), self.velocity_before_W.tolist(), self.velocity_after_W.tolist()
