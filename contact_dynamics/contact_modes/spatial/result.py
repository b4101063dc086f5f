# SPDX-License-Identifier: Apache-2.0
"""The answer to a question about contact modes in space."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from contact_dynamics.contact_modes.letters import mode_in_words, words_of
from contact_dynamics.contact_modes.result import verdict_in_short
from contact_dynamics.records import Record

if TYPE_CHECKING:
    from contact_dynamics.contact_modes.result import ModeVerdict, VerdictsWithin
    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialMode(Record):
    """A mode that is consistent with mechanics, with accelerations and forces that realise it, in world axes.

    Attributes:
        mode: One letter for each contact: s, f or c.
        acceleration_W: (3,), m/s^2, the acceleration of the centre of mass.
        angular_acceleration_W: (3,), rad/s^2.
        contact_forces_W: (n, 3), N, the forces on the body.
        contact_accelerations_W: (n, 3), m/s^2, the accelerations of the body's points in contact.
        tangential_directions_W: (n, 3), unit, the direction in which a contact slides; zero where it does
            not slide.
        misdirection: rad, the largest angle between friction and the direction against the sliding. It is
            rounding, unless the problem's ``sharpen`` is false.
        forces_unique: Whether the forces are the only ones with this mode.
        motion_unique: Whether the accelerations are the only ones with this mode.
    """

    mode: str
    acceleration_W: FloatArray
    angular_acceleration_W: FloatArray
    contact_forces_W: FloatArray
    contact_accelerations_W: FloatArray
    tangential_directions_W: FloatArray
    misdirection: float
    forces_unique: bool
    motion_unique: bool

    @property
    def words(self) -> tuple[str, ...]:
        """What each contact does: "separates", "slides" or "stays fixed"."""
        return words_of(self.mode)

    def in_short(self) -> str:
        """Return the letters, and what the body does, or each kind of contact."""
        return f"SpatialMode {self.mode}: {mode_in_words(self.mode)}"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialModeAnswer(Record):
    """The answer to one question about contact modes in space.

    Refused letters are not listed: there are as many as cells in the arrangement of all sectors, and groups
    of them are refused at once. Strings of contacting and separating have their reasons (`refusals`).

    Attributes:
        verdict: On the whole contact set.
        modes: All consistent modes. Separating comes before sticking, and sticking before sliding.
        approaching: The contacts that approach. It is not empty exactly where the verdict is IMPACT.
        velocity_tolerance: m/s. A contact's velocity up to it counted as zero.
        friction_facets: The number of edges of each friction pyramid.
        examined: The number of cases, of one letter or of a group of letters, that were tried.
        undecided: What could not be decided, and why. It is empty unless the verdict is UNDECIDED.
        undecided_modes: The letters of modes that could be neither found nor refuted.
        flush_within: rad, or a share of the reach. The modes are those of contacts whose normals and places
            differ by no more than this from the given ones, in which flush ones are exactly flush
            (`spatial.flush`). It is 0 where the modes are those of the given contacts.
        within: The verdicts that occur within the problem's uncertainty, or None if it has none.
        problem: The `SpatialContactProblem` that is answered.
    """

    verdict: ModeVerdict
    modes: tuple[SpatialMode, ...]
    approaching: tuple[int, ...]
    velocity_tolerance: float
    friction_facets: int
    examined: int
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    flush_within: float = 0.0
    within: VerdictsWithin | None = None
    problem: Record = field(repr=False)

    def in_short(self) -> str:
        """Return the verdict, and what the first modes are in words."""
        return verdict_in_short(type(self).__name__, self.verdict, [mode.mode for mode in self.modes])
