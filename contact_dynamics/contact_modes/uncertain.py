# SPDX-License-Identifier: Apache-2.0
"""Boxes of contact sets are searched for other answers, in the plane and in space.

One question is which verdicts occur in the box of a problem's uncertainty. If there is no proof, contact sets
in the box are sampled, and whether more verdicts occur than they have is not known. Another is how far
contacts would have to move, turn or change friction for another answer. For this, boxes of growing size are
searched for the largest one in which the answer is proven, and above it for the smallest one in which a
sample has another answer. The true margin lies between the two sizes.

`holds_for_all` proves that a mode of a body at rest is consistent for all contacts in a box. If the equations
of the mode are independent, their solution is enclosed: the inverse of the nominal matrix bounds how far the
solution of any matrix in the box is from the nominal one. All inequalities of the letters must hold for the
whole enclosure.

A body that is held by more forces than it has freedoms stays if the true cone of wrenches that contact forces
balance contains the applied wrench. Around it there is a ball of wrenches that the nominal cone contains,
with the least friction of the box. The corners of a cross-polytope around the ball are balanced by forces
that are known, and errors of the contacts move each corner by no more than these forces times the errors. A
convex set that comes as near as this to every point of a ball contains the ball without a shell of that
thickness.

There are no proofs about contacts in space that slide. They hold everywhere if all other modes are excluded
(`spatial.uncertain`).
"""

from __future__ import annotations

import math
from itertools import islice
from typing import TYPE_CHECKING, Final, Generic, NamedTuple, TypeVar

import numpy as np

from contact_dynamics.contact.uncertainty import ContactUncertainty
from contact_dynamics.contact_modes.letters import SEPARATES, SLIDES_LEFT, STAYS, STICKS
from contact_dynamics.contact_modes.result import (
    AnyModeAnswer,
    BodyStatics,
    Certainty,
    GeometryMargin,
    ModeVerdict,
    VerdictsWithin,
)
from contact_dynamics.errors import TooLargeError, UndecidedError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from contact_dynamics.validation import FloatArray

_FAILED: Final = 4
"""After this many failed proofs the smallest box is tried. If its proof fails, all others would fail too."""

_TRIED_FIRST: Final = 6
"""Proofs that are tried from the largest box on, before samples. Feet on a floor need no more."""

AnyAnswer = TypeVar("AnyAnswer", bound=AnyModeAnswer)


class Boxes(Generic[AnyAnswer]):
    """Boxes of contact sets around those of a question, and what is known of the answers in them."""

    __slots__ = ("_answer", "_is_certain", "_largest", "_sampled", "_samples", "_step", "_steps")

    def __init__(
        self,
        answer: AnyAnswer,
        *,
        is_certain: Callable[[ContactUncertainty], bool],
        sampled: Callable[[ContactUncertainty], Iterable[AnyAnswer]],
        radius_of_gyration: float,
        frictions: Iterable[float],
        step: float,
        steps: int,
        samples: int | None = None,
    ) -> None:
        """Take the answer to the question itself, how to prove a box, and how to sample one.

        For margins, points are tried as far off as the radius of gyration, m, and frictions as far as the
        largest, or 1. Each of the ``steps`` sizes below is smaller by the factor ``step``, and as many
        ``samples`` of each are tried, or all.
        """
        self._answer, self._is_certain, self._sampled = answer, is_certain, sampled
        self._largest = {
            "points": radius_of_gyration,
            "normals": 0.5 * math.pi,
            "frictions": max([1.0, *frictions]),
        }
        self._step, self._steps, self._samples = step, steps, samples

    def verdicts_within(self, box: ContactUncertainty) -> VerdictsWithin:
        """Return the verdicts that occur in a box. It is sampled if they are not proven."""
        certain = box.is_exact or self._is_certain(box)
        samples = [] if certain else list(self._sampled(box))
        verdicts = dict.fromkeys(one.verdict for one in (self._answer, *samples))
        modes = dict.fromkeys(mode.mode for one in (self._answer, *samples) for mode in one.modes)
        return VerdictsWithin(
            uncertainty=box,
            verdicts=tuple(verdicts),
            modes=tuple(modes),
            certain=certain,
            samples=len(samples),
        )

    def margins(self) -> tuple[GeometryMargin, ...]:
        """Return the margins of the answer in points, normals and frictions, in this order.

        In each of them only that one is off, for all contacts at once and for each in its own way. There are
        no margins if a contact approaches.
        """
        kinds = () if self._answer.verdict == ModeVerdict.IMPACT else self._largest.items()
        return tuple(
            self._margin(kind, [size / self._step**k for k in range(self._steps, -1, -1)])
            for kind, size in kinds
        )

    def _margin(self, kind: str, sizes: Sequence[float]) -> GeometryMargin:
        """Return the margin of an answer in one kind of error, of which sizes are tried in growing order."""
        found: dict[int, AnyAnswer] = {}

        def box(k: int) -> ContactUncertainty:
            return ContactUncertainty(**{kind: sizes[k]})

        def changes(k: int) -> bool:
            beyond = next(
                (
                    one
                    for one in islice(self._sampled(box(k)), self._samples)
                    if _says_otherwise(one, self._answer)
                ),
                None,
            )
            if beyond is not None:
                found[k] = beyond
            return beyond is not None

        # A proof that fails mostly does so early, and takes a hundredth of one that succeeds. So the first
        # that succeeds on the way down is the last. Boxes with a proof need no samples.
        tried = max(0, len(sizes) - _TRIED_FIRST)
        proven = next((k for k in range(len(sizes), tried, -1) if self._is_certain(box(k - 1))), 0)
        changed = _first(proven, len(sizes), changes)
        if proven == 0:
            proven = first = min(changed, tried)
            while proven > 0 and not self._is_certain(box(proven - 1)):
                proven -= 1
                if first - proven == _FAILED and proven > 0 and not self._is_certain(box(0)):
                    proven = 0
        beyond = found.get(changed, self._answer)
        return GeometryMargin(
            kind=kind,
            holds_within=sizes[proven - 1] if proven > 0 else 0.0,
            changes_at=sizes[changed] if found else math.inf,
            verdict_beyond=beyond.verdict,
            modes_beyond=tuple(mode.mode for mode in beyond.modes) if found else (),
        )


def _says_otherwise(one: AnyModeAnswer, other: AnyModeAnswer) -> bool:
    """Return whether answers have different verdicts, or different modes that are UNIQUE.

    An answer that could not be decided says nothing else.
    """
    if one.verdict != other.verdict:
        return one.verdict != ModeVerdict.UNDECIDED
    return one.verdict == ModeVerdict.UNIQUE and one.modes[0].mode != other.modes[0].mode


def _first(low: int, high: int, happens: Callable[[int], bool]) -> int:
    """Return the first step from ``low`` on from which something keeps happening, or ``high``."""
    while low < high:
        middle = (low + high) // 2
        if happens(middle):
            high = middle
        else:
            low = middle + 1
    return low


_INSIDE: Final = 0.99
"""Share of the largest ball whose wrenches are balanced, so that rounding does not put them outside."""

_BALL_OF_ALL: Final = 4.0
"""Radius of the ball, in sizes of the applied wrench, if contact forces balance every wrench."""


class BoundedContact(NamedTuple):
    """One contact of a body at rest that is known only to some uncertainty.

    Every bound holds for each coordinate alone, and for all contacts in the box at once.
    """

    rows: FloatArray  # (c, d), its accelerations along normal and tangents, and wrenches of unit forces
    errors: FloatArray  # (c, d), by how much each coordinate of a row may be off
    min_friction: float  # the smallest coefficient of friction in the box
    max_friction: float  # the largest coefficient of friction in the box
    min_holding: float  # the smallest coefficient of friction in the box of a contact that sticks
    max_holding: float  # the largest one

    @classmethod
    def of(
        cls, rows: FloatArray, errors: FloatArray, friction: float, holding: float, error: float
    ) -> BoundedContact:
        """Return a contact with two coefficients of friction that are off by at most an error."""
        least = max(0.0, friction - error), max(0.0, holding - error)
        return cls(rows, errors, least[0], friction + error, least[1], holding + error)


class BoundedBody(NamedTuple):
    """A body at rest with its contacts. Motions and wrenches have d coordinates, in one unit of length."""

    contacts: list[BoundedContact]
    inertia: FloatArray  # (d, d), the wrench that a unit motion needs
    wrench: FloatArray  # (d,), N, the applied wrench


def holds_for_all(
    body: BoundedBody,
    mode: str,
    *,
    statics: Callable[[], BodyStatics],
    edges: Callable[[], tuple[FloatArray, FloatArray]],
) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box.

    All contacts touch the body. With the least friction of the box, ``statics`` says what holds it, and
    ``edges`` are the wrenches, (k, d), of edge forces, and by how much each may be off, (k,).
    """
    equations = sum(
        {SEPARATES: 0, STICKS: len(one.rows)}.get(letter, 1)
        for letter, one in zip(mode, body.contacts, strict=True)
    )
    if equations <= len(body.wrench):
        return STAYS not in mode and _solves_for_all(body, mode)
    return set(mode) == {STICKS} and _rests_for_all(body, statics, edges)


def _solves_for_all(body: BoundedBody, mode: str) -> bool:
    R, off_R, U, off_U = _equations(body, mode)
    inverse_mass = np.linalg.inv(body.inertia)
    size = abs(inverse_mass)
    free = inverse_mass @ body.wrench
    try:
        inverse = np.linalg.inv(R @ inverse_mass @ U.T)
    except np.linalg.LinAlgError:
        return False
    forces = -inverse @ (R @ free)
    off_matrix = off_R @ size @ (abs(U) + off_U).T + abs(R) @ size @ off_U.T
    spread = abs(inverse) @ off_matrix
    if spread.size and spread.sum(axis=1).max() >= 1.0:
        return False
    missed = abs(inverse) @ (off_matrix @ abs(forces) + off_R @ abs(free))
    off = np.linalg.solve(np.eye(len(forces)) - spread, missed)
    motion = free + inverse_mass @ (forces @ U)
    off_motion = size @ ((abs(forces) + off) @ off_U + off @ abs(U))

    def rises(row: FloatArray, error: FloatArray) -> bool:
        """Return whether the product of a row and the motion is positive whatever both are."""
        return bool(row @ motion - abs(row) @ off_motion - error @ (abs(motion) + off_motion) > 0.0)

    at = 0
    for letter, one in zip(mode, body.contacts, strict=True):
        if letter == SEPARATES:
            if not rises(one.rows[0], one.errors[0]):
                return False
            continue
        count = len(one.rows) if letter == STICKS else 1
        (pressing, *across), (off_pressing, *off_across) = forces[at : at + count], off[at : at + count]
        least = pressing - off_pressing
        if least < 0.0 or math.hypot(*across) + math.hypot(*off_across) > one.min_holding * least:
            return False
        if letter != STICKS and not rises(one.rows[1] * _sense(letter), one.errors[1]):
            return False
        at += count
    return True


def _equations(body: BoundedBody, mode: str) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return rows that vanish on the motion, wrenches of as many forces, and behind each its errors."""
    found: list[tuple[FloatArray, ...]] = []
    for letter, one in zip(mode, body.contacts, strict=True):
        if letter == STICKS:
            found += zip(one.rows, one.errors, one.rows, one.errors, strict=True)
        elif letter != SEPARATES:
            (N, T), (off_N, off_T) = one.rows, one.errors
            middle = 0.5 * (one.min_friction + one.max_friction)
            spread = 0.5 * (one.max_friction - one.min_friction)
            off_edge = off_N + middle * off_T + spread * (abs(T) + off_T)
            found.append((N, off_N, N - _sense(letter) * middle * T, off_edge))
    R, off_R, U, off_U = np.array(found).reshape(-1, 4, len(body.wrench)).transpose(1, 0, 2)
    return R, off_R, U, off_U


def _sense(letter: str) -> float:
    """Return the sign of a planar contact's sliding along its tangent."""
    return -1.0 if letter == SLIDES_LEFT else 1.0


def _rests_for_all(
    body: BoundedBody,
    statics: Callable[[], BodyStatics],
    edges: Callable[[], tuple[FloatArray, FloatArray]],
) -> bool:
    from scipy.optimize import linprog

    try:
        held = statics()
    except (UndecidedError, TooLargeError):
        return False
    if held.equilibrium == Certainty.NO or held.stable_disturbance == 0.0:
        return False
    radius = _INSIDE * held.stable_disturbance
    if math.isinf(radius):
        radius = _BALL_OF_ALL * (float(np.linalg.norm(body.wrench)) or 1.0)
    freedoms = len(body.wrench)
    corners: FloatArray = radius * np.vstack([np.eye(freedoms), -np.eye(freedoms)])
    wrenches, off = edges()
    for corner in corners:
        found = linprog(off, A_eq=wrenches.T, b_eq=-(body.wrench + corner), method="highs")
        if found.x is None or found.fun > radius / math.sqrt(freedoms):
            return False
    return True
