# SPDX-License-Identifier: Apache-2.0
"""The verdicts that occur if contacts in space are known only to some uncertainty.

The true contacts are somewhere in the box of a `ContactUncertainty`. A verdict is certain if it is proven for
every contact set in the box:

- UNIQUE is certain if linear programs that allow for the whole box exclude every other mode. A body at rest
  always has a consistent mode, so this one is left.
- INDETERMINATE is certain if two modes hold everywhere (`holds_for_all`).

There are proofs only for bodies at rest with at most `MAX_PROVEN_CONTACTS`. Each contact's errors are
independent of the others', and the body's mass and the applied wrench are known. Four feet that slide
together have no proof, since they do so only if they lie exactly in a plane.

A motion and contact forces that bring about a mode satisfy linear inequalities, if each contact that slides
does so within a known arc of directions. Then its force lies in a narrow cone opposite to that arc. Each
inequality is relaxed by the bounds of the contacts' errors, so that the true motion and forces satisfy it for
every contact set in the box. The errors of rows are multiplied by the size of the motion, which is linear
where one coordinate of the motion is known to be the largest. If the relaxed inequalities have no solution
whichever coordinate that is, no contact set in the box has the mode.

Letters are chosen contact after contact, and arcs are halved until they are narrow. As soon as the letters of
the first contacts have no solution, no letters of the others can have one. Why they have none often excludes
letters of other contacts too. Such a reason is a direction of wrenches along which all forces of some letters
are positive, like the applied wrench, while no motion of these letters needs such a wrench. It uses the
motions of few contacts. So it also holds for other letters, of contacts whose motions it does not use and
whose forces are as positive. Each reason is checked for them as it was for the letters that it was found for.
A third to a half of all letters are excluded so, without a linear program.

Two facts hold for every body at rest. Contact forces do no positive work on its acceleration, because
friction pushes against the sliding and normal forces act only where contacts stay. So the applied wrench
does. And at least one mode is consistent. So the mode that is left holds everywhere in the box.

If the angle between a normal and the true one is at most theta, the smallest rotation that takes one to the
other moves every unit vector by at most 2 sin(theta / 2). This rotation also takes tangents to true tangents,
so that forces and accelerations have the same components in both frames. A point that is off by d changes the
moment of a unit force by at most d. What is proven for a box holds in each smaller one, so that errors too
small for linear programs are taken for larger ones.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.result import BodyStatics, ModeVerdict
from contact_dynamics.contact_modes.spatial.answer import spatial_contact_modes
from contact_dynamics.contact_modes.spatial.problem import SpatialCase, spatial_case
from contact_dynamics.contact_modes.spatial.statics import spatial_statics
from contact_dynamics.contact_modes.uncertain import BoundedBody, BoundedContact, Boxes, holds_for_all
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.infeasible import contradiction
from contact_dynamics.numerics.vectors import point_jacobians, tangents_towards
from contact_dynamics.tolerances import (
    LEAST_UNCERTAINTY,
    NO_MOTION,
    PROVEN,
    REASON_MARGIN,
    REASON_ROUNDING,
    SAME_ARCS,
)

if TYPE_CHECKING:
    from collections.abc import Iterator

    from contact_dynamics.contact.uncertainty import ContactUncertainty
    from contact_dynamics.contact_modes.result import SpatialModeAnswer
    from contact_dynamics.contact_modes.spatial.problem import SpatialContactProblem
    from contact_dynamics.validation import FloatArray

MAX_PROGRAMS: Final = 3000
"""Linear programs after which a proof is given up. A box on four feet takes up to two thirds of them, and
one on three a tenth."""

_ROOT_3: Final = math.sqrt(3.0)
"""A motion has at most this many times its largest coordinate in its three translations, or rotations."""

_AXES: Final = np.eye(6)

_LARGEST_EDGE: Final = 1e4
"""Largest wrench of a force whose normal part is 1. Linear programs cannot tell larger ones apart."""

_NARROW: Final = math.pi / 24.0
"""rad. An arc of this width is not halved."""


class _GivenUpError(Exception):
    """The proof takes too many linear programs."""


def no_other_mode(problem: SpatialContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that no mode of a body at rest but ``mode`` occurs anywhere in a box."""
    body = bounded_body(problem, box)
    if not np.any(body.wrench):
        return set(mode) == {STICKS}
    if any((1.0 + one.max_holding) * abs(one.rows).max() > _LARGEST_EDGE for one in body.contacts):
        return False
    proof = _Proof(body, mode)
    try:
        return all(proof.excludes(at, sign) for at in range(6) for sign in (1.0, -1.0))
    except _GivenUpError:
        return False


class _Proof:
    """A search for letters that the relaxed inequalities allow. Its unit is the applied wrench."""

    __slots__ = ("_allowed", "_body", "_inverse", "_left", "_reasons", "_rests", "_ways")

    def __init__(self, body: BoundedBody, allowed: str) -> None:
        self._body = body._replace(
            inertia=body.inertia / body.inertia[0, 0], wrench=body.wrench / np.linalg.norm(body.wrench)
        )
        self._inverse = np.linalg.inv(self._body.inertia)
        self._allowed = allowed
        self._rests = set(allowed) == {STICKS}
        self._left = MAX_PROGRAMS
        self._ways = UncertainWays(body.contacts)
        self._reasons = Reasons(self._body, self._ways, rests=self._rests)

    def excludes(self, at: int, sign: float) -> bool:
        """Return whether no mode but the allowed one has a motion whose coordinate ``at`` is the largest."""
        return self._excludes(at, sign, (ANY,) * len(self._body.contacts))

    def _excludes(self, at: int, sign: float, ways: tuple[UncertainWay, ...]) -> bool:
        letters = "".join(way.letter for way in ways)
        if letters == self._allowed or self._reasons.exclude(at, sign, ways):
            return True
        reason = self._reason_against(at, sign, ways)
        if reason is not None and self._reasons.add(reason, at, sign):
            return True
        if len(letters) < len(ways):
            i, parts = len(letters), WAYS
        else:
            i = max(range(len(ways)), key=lambda i: ways[i].width)
            if ways[i].width <= _NARROW:
                return False
            parts = ways[i].halves
        return all(self._excludes(at, sign, (*ways[:i], part, *ways[i + 1 :])) for part in parts)

    def _reason_against(self, at: int, sign: float, ways: tuple[UncertainWay, ...]) -> Reason | None:
        """Return why the relaxed inequalities have no solution, or None if they have one.

        A solution moves. If the allowed mode rests, it moves faster than `NO_MOTION`. The variables are edge
        forces, and the errors of their sum in each direction.
        """
        if self._left == 0:
            raise _GivenUpError
        self._left -= 1
        w, contacts = self._body.wrench, self._body.contacts
        lines = [self._ways.lines(i, way) for i, way in enumerate(ways)]
        forces = [self._ways.forces(i, way) for i, way in enumerate(ways)]
        U, E = np.vstack([edges for edges, _ in forces]), np.vstack([errors for _, errors in forces])
        largest = np.zeros(6)
        largest[at] = sign
        others = np.delete(_AXES, at, axis=0)
        nominal = np.vstack([-w[None], *lines])
        off = [0.0, *(_size(one) for one, some in zip(contacts, lines, strict=True) for _ in some)]
        motions = np.vstack(
            [
                nominal - _ROOT_3 * np.array(off)[:, None] * largest,
                others - largest,
                -others - largest,
                -largest[None],
            ]
        )
        responses = motions @ self._inverse
        limits = np.concatenate([-responses @ w, np.zeros(6)])
        if self._rests:
            limits[len(motions) - 1] -= NO_MOTION
        rows = np.vstack(
            [
                np.hstack([responses @ U.T, responses, -responses]),
                np.hstack([-(E + REASON_MARGIN).T, _AXES, _AXES]),
            ]
        )
        multipliers = contradiction(rows, limits)
        if multipliers is None:
            return None
        multipliers /= multipliers.max()
        multipliers[multipliers < REASON_ROUNDING] = 0.0
        z = self._inverse @ (motions.T @ multipliers[: len(motions)])
        uses = np.split(multipliers[1 : len(nominal)], np.cumsum([len(some) for some in lines])[:-1])
        return Reason(
            z=z if abs(z).max() > REASON_ROUNDING else np.zeros(6),
            row=nominal.T @ multipliers[: len(nominal)],
            weights=np.array([use.sum() for use in uses]),
            used=[int(np.max(np.flatnonzero(use), initial=-1)) + 1 for use in uses],
            ways=ways,
        )


_ARCS: Final = 3
"""The arcs that the directions of a contact are divided into at first. With four, a box on four feet takes a
fifth more linear programs, and with eight three times as many."""

_EDGES: Final = 16
"""Edges of the pyramid that holds a round cone. It has 2 % more friction than the cone."""


class UncertainWay(NamedTuple):
    """What one contact does."""

    letter: str  # empty where any is allowed
    first: float = 0.0  # rad, where the arc of its sliding begins, in the contact's frame
    width: float = 0.0  # rad, the width of that arc

    @property
    def halves(self) -> tuple[UncertainWay, UncertainWay]:
        """Return the two halves of the arc."""
        half = 0.5 * self.width
        return self._replace(width=half), self._replace(first=self.first + half, width=half)

    def obeys(self, other: UncertainWay, lines: int) -> bool:
        """Return whether true motions of this way satisfy the first ``lines`` inequalities of another.

        The first says that the contact does not penetrate, which is so in every way. The second says that it
        does not separate. The others are about its sliding, and a contact that sticks satisfies those of
        every arc.
        """
        if lines <= 1:
            return True
        if lines == 2 or self.letter == STICKS:
            return self.letter in {STICKS, STAYS}
        inside = self.first - other.first
        return (
            self.letter == other.letter == STAYS
            and inside >= -SAME_ARCS
            and inside + self.width <= other.width + SAME_ARCS
        )


ANY: Final = UncertainWay("")
_WIDEST: Final = 2.0 * math.pi / _ARCS
WAYS: Final = (
    UncertainWay(SEPARATES),
    UncertainWay(STICKS),
    *(UncertainWay(STAYS, k * _WIDEST, _WIDEST) for k in range(_ARCS)),
)
"""All that a contact can do."""


class UncertainWays:
    """The motions and forces of all ways of some contacts. Each is computed once."""

    __slots__ = ("forces", "lines")

    def __init__(self, contacts: list[BoundedContact]) -> None:
        """Take the contacts. Both functions take the number of one of them, and its way."""
        self.lines = cache(lambda i, way: _lines(contacts[i], way))
        self.forces = cache(lambda i, way: _forces(contacts[i], way))


def _lines(contact: BoundedContact, way: UncertainWay) -> FloatArray:
    """Return rows, (k, 6), that are <= 0 on a way's motions: nominal rows with coefficients of length 1."""
    normal, one, two = contact.rows
    lines = [-normal]
    if way.letter == STICKS:
        lines += [normal, one, -one, two, -two]
    elif way.letter == STAYS:
        lines.append(normal)
        for angle, sense in ((way.first, 1.0), (way.first + way.width, -1.0)):
            lines.append(sense * (math.sin(angle) * one - math.cos(angle) * two))
    return np.array(lines)


def _forces(contact: BoundedContact, way: UncertainWay) -> tuple[FloatArray, FloatArray]:
    """Return wrenches, (k, 6), of size 1 of edge forces that hold all forces of a way, and their errors."""
    edges = _edges(contact, way)
    rows = edges @ contact.rows
    lengths = np.linalg.norm(rows, axis=1)[:, None]
    sizes = np.linalg.norm(edges, axis=1)[:, None]
    return rows / lengths, sizes * contact.errors[0] / lengths


def _edges(contact: BoundedContact, way: UncertainWay) -> FloatArray:
    """Return edges, (k, 3), of a cone in the contact's frame that holds all forces of a way."""
    least, most = contact.min_friction, contact.max_friction
    if way.letter == SEPARATES:
        return np.zeros((0, 3))
    if way.letter == STAYS:  # its force is opposite to its sliding
        half = 0.5 * way.width
        angles = way.first + math.pi + half * np.array([0.0, 1.0, 2.0, 0.0, 2.0])
        radii = np.array([most, most / math.cos(half), most, least, least])
    else:
        angles = np.linspace(0.0, 2.0 * math.pi, _EDGES, endpoint=False)
        radii = np.full(_EDGES, contact.max_holding / math.cos(math.pi / _EDGES))
    edges: FloatArray = np.column_stack(
        [np.ones_like(angles), radii * np.cos(angles), radii * np.sin(angles)]
    )
    return edges


class Reason(NamedTuple):
    """Why some letters are excluded."""

    z: FloatArray  # (6,), the direction
    row: FloatArray  # (6,), the sum of nominal rows that are not positive on the motions
    weights: FloatArray  # by what the errors of each contact's rows are multiplied in that sum
    used: list[int]  # how many of the inequalities of each contact's way the sum needs, from the first one on
    ways: tuple[UncertainWay, ...]  # what each contact does


class Reasons:
    """All reasons that were found for one box of contacts. Sets of them are the bits of integers."""

    __slots__ = ("_allowing", "_found", "_holding", "_inertia", "_largest", "_rests", "_sizes", "_w", "_ways")

    def __init__(self, body: BoundedBody, ways: UncertainWays, *, rests: bool) -> None:
        """Take a body whose wrench has the size 1. If it ``rests``, `NO_MOTION` need not be excluded."""
        self._inertia = body.inertia
        self._w = body.wrench
        self._ways = ways
        self._sizes = math.sqrt(3.0) * np.array([_size(contact) for contact in body.contacts])
        self._rests = rests
        # The applied wrench does positive work on every motion, so that motions have no more than this size.
        self._largest = 1.0 / float(np.linalg.eigvalsh(body.inertia)[0])
        self._found: list[Reason] = []
        self._holding = [0] * 12
        self._allowing: dict[tuple[int, UncertainWay], tuple[int, int]] = {}

    def exclude(self, at: int, sign: float, ways: tuple[UncertainWay, ...]) -> bool:
        """Return whether a known reason excludes ways whose motions have this largest coordinate."""
        left = self._holding[_number(at, sign)]
        for i, way in enumerate(ways):
            if not left:
                return False
            left &= self._those_that_allow(i, way)
        return left != 0

    def add(self, reason: Reason, at: int, sign: float) -> bool:
        """Remember a reason, and return whether it excludes the ways that it was found for."""
        bit = 1 << len(self._found)
        self._found.append(reason)
        for number in self._holds(reason):
            self._holding[number] |= bit
        return self.exclude(at, sign, reason.ways)

    def _holds(self, reason: Reason) -> list[int]:
        """Return for which largest coordinates the direction and the motions contradict each other.

        On motions whose largest coordinate has the size t, the sum of rows is not positive but for the errors
        of the contacts. So the work of the wrench that a motion needs along the direction is at most -fall t.
        """
        rest = self._inertia @ reason.z - reason.row
        most = float(reason.weights @ self._sizes + abs(rest).sum())
        along = float(self._w @ reason.z)
        least, found = NO_MOTION if self._rests else 0.0, []
        for at in range(6):
            for sign in (1.0, -1.0):
                fall = float(abs(rest[at]) - sign * rest[at]) - most
                if along + fall * (least if fall > 0.0 else self._largest) > PROVEN:
                    found.append(_number(at, sign))
        return found

    def _those_that_allow(self, i: int, way: UncertainWay) -> int:
        """Return the reasons that allow a contact to do something: its motions and forces satisfy them."""
        seen, bits = self._allowing.get((i, way), (0, 0))
        if seen < len(self._found):
            new = self._found[seen:]
            directions = np.array([reason.z for reason in new])
            edges, errors = self._ways.forces(i, way)
            pushes = np.all(directions @ edges.T >= abs(directions) @ errors.T, axis=1)
            for k, reason in enumerate(new):
                if pushes[k] and way.obeys(reason.ways[i], reason.used[i]):
                    bits |= 1 << (seen + k)
            self._allowing[i, way] = len(self._found), bits
        return bits


def _number(at: int, sign: float) -> int:
    return 2 * at + (1 if math.copysign(1.0, sign) > 0.0 else 0)


def bounded_body(problem: SpatialContactProblem, box: ContactUncertainty) -> BoundedBody:
    """Return the body of a problem with contacts anywhere in a box, in world axes.

    Motions are (a, rho alpha), and wrenches (force, torque / rho), where rho is the mean radius of gyration.
    The errors are those of a row of any unit vector.
    """
    body, state, contacts = problem.body, problem.state, problem.contacts
    rho = body.mean_radius_of_gyration
    inertia = np.zeros((6, 6))
    inertia[:3, :3] = body.mass * np.eye(3)
    inertia[3:, 3:] = body.inertia_in_world(state.R_WB) / rho**2
    arms = contacts.p_WC_W - state.p_WB_W
    jacobians = point_jacobians(arms) / np.array([1.0, 1.0, 1.0, rho, rho, rho])
    far = np.linalg.norm(arms, axis=1)
    found = []
    for i, (points, normals, frictions) in enumerate(box.of_each(len(contacts))):
        frame = np.array([contacts.normals_W[i], *tangents_towards(contacts.normals_W[i])])
        turned = 2.0 * math.sin(0.5 * normals)
        moved = (points + (float(far[i]) + points) * turned) / rho
        turned, moved = max(turned, LEAST_UNCERTAINTY), max(moved, LEAST_UNCERTAINTY)
        found.append(
            BoundedContact.of(
                frame @ jacobians[i],
                np.array([[turned] * 3 + [moved] * 3] * 3),
                float(contacts.frictions[i]),
                float(contacts.holding_frictions[i]),
                frictions,
            )
        )
    return BoundedBody(found, inertia, np.concatenate([problem.force_W, problem.torque_W / rho]))


def _size(contact: BoundedContact) -> float:
    """Return the largest length of a row's error."""
    return float(contact.errors[0, 0] + contact.errors[0, -1])


SAMPLES: Final = 64
"""Contact sets that are tried if there is no proof. Half of them are at the border of the box, and in half of
these all contacts are off the same way."""

MAX_PROVEN_CONTACTS: Final = 4
"""The largest number of contacts that proofs are tried for. The programs grow exponentially with them."""

_STEP: Final = 2.0
"""Each size is at most this factor from the next. A finer step takes more proofs, of up to seconds each."""

_SAMPLES: Final = 16
"""Contact sets that are tried for each size. Each takes some 10 ms."""

_STEPS: Final = 26
"""Sizes below the largest, which so reach down to 1.5e-8 of it."""


def spatial_boxes(problem: SpatialContactProblem, answer: SpatialModeAnswer) -> Boxes[SpatialModeAnswer]:
    """Return what is known of the answers in boxes around the contacts of a problem."""
    return Boxes(
        answer,
        is_certain=partial(is_certain, problem, answer),
        sampled=partial(sampled, problem),
        radius_of_gyration=problem.body.mean_radius_of_gyration,
        frictions=problem.contacts.holding_frictions.tolist(),
        step=_STEP,
        steps=_STEPS,
        samples=_SAMPLES,
    )


def is_certain(problem: SpatialContactProblem, answer: SpatialModeAnswer, box: ContactUncertainty) -> bool:
    """Return whether it is proven that the verdict of ``answer`` holds everywhere in a box."""
    n = len(problem.contacts)
    if n == 0:
        return True
    case = spatial_case(problem)
    if not isinstance(case, SpatialCase) or n > MAX_PROVEN_CONTACTS:
        return False
    if not case.motion.at_rest or len(case.touching) < n or case.sliding.any():
        return False
    modes = dict.fromkeys(mode.mode for mode in answer.modes)
    if answer.verdict == ModeVerdict.INDETERMINATE:
        holding = (mode for mode in modes if holds_everywhere(problem, mode, box))
        return next(holding, None) is not None and next(holding, None) is not None
    return answer.verdict == ModeVerdict.UNIQUE and no_other_mode(problem, answer.modes[0].mode, box)


def sampled(problem: SpatialContactProblem, box: ContactUncertainty) -> Iterator[SpatialModeAnswer]:
    """Yield the answers for some contact sets in a box. The same box always gives the same sets."""
    chance = np.random.default_rng(0)
    for index in range(SAMPLES):
        moved = _moved(problem, box, chance, corner=index % 2 == 0, together=index % 4 == 0)
        with suppress(TooLargeError):
            yield spatial_contact_modes(moved)


def _moved(
    problem: SpatialContactProblem,
    box: ContactUncertainty,
    chance: np.random.Generator,
    *,
    corner: bool,
    together: bool,
) -> SpatialContactProblem:
    """Return a problem in the box, at its border or inside, with all contacts off the same way or not."""
    contacts = problem.contacts
    points, normals = contacts.p_WC_W.copy(), contacts.normals_W.copy()
    frictions, holding = contacts.frictions.copy(), contacts.holding_frictions.copy()
    way, lean, sign = chance.normal(size=3), chance.normal(size=3), chance.choice([-1.0, 1.0])
    for i, sizes in enumerate(box.of_each(len(contacts))):
        step, turn, less = sizes * (np.ones(3) if corner else chance.uniform(0.0, 1.0, 3))
        if not together:
            way, lean, sign = chance.normal(size=3), chance.normal(size=3), chance.choice([-1.0, 1.0])
        points[i] += step * way / np.linalg.norm(way)
        tangent, _ = tangents_towards(normals[i], lean)
        normals[i] = math.cos(turn) * normals[i] + math.sin(turn) * tangent
        frictions[i] = max(0.0, frictions[i] + sign * less)
        holding[i] = max(0.0, holding[i] + sign * less)
    static = None if contacts.static_frictions is None else holding
    moved = replace(contacts, p_WC_W=points, normals_W=normals, frictions=frictions, static_frictions=static)
    return replace(problem, contacts=moved, uncertainty=EXACT_CONTACTS)


def holds_everywhere(problem: SpatialContactProblem, mode: str, box: ContactUncertainty) -> bool:
    """Return whether it is proven that a consistent mode is consistent everywhere in a box.

    The body is at rest, and all contacts touch it. Nothing is proven of contacts that slide.
    """
    body = bounded_body(problem, box)
    least = np.array([one.min_holding for one in body.contacts])

    def statics() -> BodyStatics:
        contacts = replace(problem.contacts, frictions=least, static_frictions=None)
        return spatial_statics(replace(problem, contacts=contacts))

    def edges() -> tuple[FloatArray, FloatArray]:
        wrenches, costs = [], []
        for one in body.contacts:
            forces = linearised_cone(np.array([1.0, 0.0, 0.0]), one.min_holding, problem.friction_facets)
            wrenches.append(forces @ one.rows)
            costs.append(math.hypot(one.errors[0, 0], one.errors[0, -1]) * np.linalg.norm(forces, axis=1))
        return np.vstack(wrenches), np.concatenate(costs)

    return holds_for_all(body, mode, statics=statics, edges=edges)
