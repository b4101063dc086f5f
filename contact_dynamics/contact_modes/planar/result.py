# SPDX-License-Identifier: Apache-2.0
"""The answer to a question about contact modes in the plane has a verdict, modes and refused modes.

A mode is a string with one letter for each contact, in the contacts' order (lecture 26): `s` separates, `l`
slides left, `r` slides right, `f` stays fixed. Contact axes are (tangent, normal), where the tangent is the
normal turned by -90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from contact_dynamics.contact_modes.letters import mode_in_words, words_of
from contact_dynamics.contact_modes.result import ModeVerdict, RefusedMode, VerdictsWithin, verdict_in_short
from contact_dynamics.plane.types import Vector2
from contact_dynamics.records import Record


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarMode(Record):
    """A mode that is consistent with mechanics, with accelerations and forces that realise it.

    Attributes:
        mode: The mode, with one letter for each contact.
        acceleration: m/s^2, the acceleration of the centre of mass.
        angular_acceleration: rad/s^2.
        contact_forces: N, the force (f_t, f_n) on the body at each contact.
        contact_accelerations: m/s^2, the acceleration (a_t, a_n) of the body's point at each contact.
        forces_unique: Whether the forces above are the only ones with this mode.
        motion_unique: Whether the accelerations above are the only ones with this mode.
    """

    mode: str
    acceleration: Vector2
    angular_acceleration: float
    contact_forces: tuple[Vector2, ...]
    contact_accelerations: tuple[Vector2, ...]
    forces_unique: bool
    motion_unique: bool

    @property
    def words(self) -> tuple[str, ...]:
        """What each contact does: "separates", "slides left", "slides right" or "stays fixed"."""
        return words_of(self.mode)

    def in_short(self) -> str:
        """Return the letters, and what the body does, or each kind of contact."""
        return f"PlanarMode {self.mode}: {mode_in_words(self.mode)}"


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class PlanarModeAnswer(Record):
    """The answer to one question about contact modes.

    Attributes:
        verdict: The verdict on the whole contact set.
        modes: All consistent modes.
        refused: The modes that are possible kinematically and not consistent, each with the reason.
        approaching: The indices of the contacts that approach. There are some exactly if the verdict is
            IMPACT.
        contact_velocities: m/s, the velocity (v_t, v_n) of the body's point at each contact. Values within
            tolerance are 0.
        velocity_tolerance: m/s. Velocities of contacts up to this size counted as zero.
        acceleration_tolerance: m/s^2. Accelerations of the centre of mass up to this size counted as zero.
        undecided: What could not be decided, and why. It is empty unless the verdict is UNDECIDED.
        undecided_modes: The modes that are possible kinematically and neither consistent nor refused.
        within: The verdicts that occur within the problem's uncertainty, or None if it has none.
        problem: The `PlanarContactProblem` that is answered.
    """

    verdict: ModeVerdict
    modes: tuple[PlanarMode, ...]
    refused: tuple[RefusedMode, ...]
    approaching: tuple[int, ...]
    contact_velocities: tuple[Vector2, ...]
    velocity_tolerance: float
    acceleration_tolerance: float
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    within: VerdictsWithin | None = None
    problem: Record = field(repr=False, compare=False)

    def in_short(self) -> str:
        """Return the verdict, and what the first modes are in words."""
        return verdict_in_short(type(self).__name__, self.verdict, [mode.mode for mode in self.modes])

    @property
    def kinematic_modes(self) -> tuple[str, ...]:
        """Return every mode that some acceleration realises without penetration, in alphabetical order."""
        consistent = [found.mode for found in self.modes]
        refused = [found.mode for found in self.refused]
        return tuple(sorted([*consistent, *refused, *self.undecided_modes]))
