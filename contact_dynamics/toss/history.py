# SPDX-License-Identifier: Apache-2.0
"""The state and events of a toss during its simulation, and the resulting `Toss`."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.tolerances import DISTANCE_TOLERANCE
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.forces import out_of_flats
from contact_dynamics.toss.result import (
    Noted,
    Piece,
    Toss,
    TossEnd,
    TossEnergy,
    TossEventKind,
    Undecided,
    UndecidedReason,
)
from contact_dynamics.toss.solid import (
    energy_of,
    kinetic_energy_of,
    low_corners,
    pose_of,
    state_of,
)

if TYPE_CHECKING:
    from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.mode_choice import Mode
    from contact_dynamics.toss.solid import Numbers, Solid, Touch


NEAR_CORNERS: Final = 0.1
"""Distance of two corners, relative to the reach, below which the tolerance of their heights is smaller."""


_MOST_LIFTS: Final = 20
"""Largest number of moves of a body out of planes that it penetrates initially. Each leaves an error of
second order, so two or three suffice."""


class History:
    """The present state of a simulated toss, and its motion and events so far.

    Attributes:
        solid: The body and the planes.
        now: Present time, s after the stamp of the initial state.
        y: Present state, 13 numbers.
        pieces: Flights and integration steps so far.
        events: Events so far; for a sample, only strikes.
        count: Number of all events so far.
        is_sample: True for a sample of an uncertain toss.
        lost_in_strikes: Energy dissipated in strikes, J.
        lost_in_contact: Energy dissipated by sliding, J.
        resting: Contacts on which the body rests; empty if it moves.
        undecided: Branch points so far, at which mechanics does not determine the motion.
    """

    def __init__(self, solid: Solid, y: Numbers, ways: tuple[int, ...], began_ns: int) -> None:
        self.solid = solid
        self.now, self.y = 0.0, _just_above(solid, y)
        self.pieces: list[Piece] = []
        self.events: list[Noted] = []
        self.count, self.is_sample = 0, False
        self.lost_in_strikes = self.lost_in_contact = 0.0
        self.resting: list[Touch] = []
        self.undecided: list[Undecided] = []
        self._ways = ways
        self._began_ns = began_ns
        self._first = energy_of(self.solid, self.y)

    def as_toss(
        self,
        end: TossEnd,
        law: RestitutionLaw,
        alternatives: tuple[Toss, ...] = (),
        all_followed: bool = True,  # noqa: FBT001, FBT002  C has no keywords
    ) -> Toss:
        """Return the result for a toss that has ended."""
        energy = TossEnergy(
            first=self._first - energy_of(self.solid, self.y) + kinetic_energy_of(self.solid, self.y),
            lost_in_strikes=self.lost_in_strikes,
            lost_in_contact=self.lost_in_contact,
            left=kinetic_energy_of(self.solid, self.y),
        )
        toss = Toss(
            restitution_law=law,
            end=end,
            seconds=self.now,
            state=state_of(self.y, ns_after(self._began_ns, self.now)),
            events=(),
            resting_corners=tuple(sorted({self.solid.indices[corner] for _, corner in self.resting})),
            resting_normal_B=np.array(self.resting_normal_B()),
            energy=energy,
            undecided=tuple(self.undecided),
            alternatives=alternatives,
            all_followed=all_followed,
            pieces=tuple(self.pieces),
            starts=np.array([piece.start for piece in self.pieces]),
            began_ns=self._began_ns,
            noted=(self.solid, tuple(self.events)),
        )
        object.__delattr__(toss, "events")  # created on first access
        return toss

    def resting_normal_B(self) -> Vector3:
        """Return the normal of the plane on which the body rests, body axes, or zero if it moves."""
        if not self.resting:
            return (0.0, 0.0, 0.0)
        rows = pose_of(self.solid, self.y).rows
        return vec.transposed_times(rows, self.solid.flats[self.resting[0][0]].normal)

    def touching_now(self, leaving: float) -> list[Touch]:
        """Return the touching contacts that do not separate faster than ``leaving``, m/s."""
        listed = low_corners(self.solid, self.y, DISTANCE_TOLERANCE, leaving)
        return [touch for _, touch in listed] if len(listed) < 2 else self._touching_together(listed)

    def _touching_together(self, listed: list[tuple[float, Touch]]) -> list[Touch]:
        """Return the contacts among those listed, with heights in m, that touch at the present attitude.

        Contacts that touch together are held together. For two nearby corners, the full tolerance of the
        height would be a large angle, so the tolerance is smaller for them.
        """
        solid = self.solid
        found: list[Touch] = []
        for height, (flat, corner) in sorted(listed):
            apart = solid.reach
            for s, k in found:
                if s == flat:
                    apart = min(apart, vec.norm(vec.plus(solid.corner(corner), -1.0, solid.corner(k))))
            if height <= DISTANCE_TOLERANCE * min(1.0, apart / (NEAR_CORNERS * solid.reach)):
                found.append((flat, corner))
        return [touch for _, touch in listed if touch in found]

    def way(self, reason: UndecidedReason, options: int) -> int:
        """Record a branch point, and return the index of the branch to follow."""
        k = len(self.undecided)
        taken = self._ways[k] if k < len(self._ways) else 0
        self.undecided.append(Undecided(seconds=self.now, reason=reason, options=options, taken=taken))
        return taken

    def note(
        self,
        kind: TossEventKind,
        touching: list[Touch],
        mode: Mode = (),
        impulse: Vector3 = (0.0, 0.0, 0.0),
        outcome: ImpactOutcome | None = None,
    ) -> None:
        """Record an event at contacts that touch now."""
        self.count += 1
        if not self.is_sample or kind == TossEventKind.STRIKES:
            self.events.append(Noted(self.now, kind, touching, impulse, outcome, mode, self.y))


def _just_above(solid: Solid, y: Numbers) -> Numbers:
    """Return the initial state, moved out of planes that it penetrates by more than `DISTANCE_TOLERANCE`.

    The move may turn the body, so that fewer corners touch afterwards than penetrated before.
    """
    for _ in range(_MOST_LIFTS):
        if not low_corners(solid, y, -DISTANCE_TOLERANCE, math.inf):
            break
        y = out_of_flats(solid, y)
    return y
