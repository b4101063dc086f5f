# SPDX-License-Identifier: Apache-2.0
"""This file decides whether mechanics allows a mode, and gives accelerations and forces or a reason against.

Each letter of a mode brings as many equations as unknown forces (lecture 26). For `l` and `r` this is one
equation, of the normal acceleration, and one force, along an edge of the friction cone. For `f` there are two
of each. If the equations are independent, they are solved, and the inequalities of the letters decide
(`IndependentModes`). They are not independent if more contacts stay than a body has freedoms, or if friction
cancels the response, as for Painleve's rod. Then a mode is consistent if the applied wrench lies in the cone
of the wrenches that can bring it about (`wrench_cone`), and its forces are some of many.

Forces and accelerations of independent equations are linear in w+ = (w, m scale). Here w is the applied
wrench, m is the mass, and the scale stands for the centripetal terms (`problem`). A letter demands the sign
of such a linear function g . w+. A value within ``accuracy`` |g| |w+| counts as zero, because a change of the
applied wrench by that share can turn the sign. `wrench_cone` uses the same tolerance.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

from contact_dynamics.contact_modes.planar.enumeration import FIXED, LEFT, RIGHT, Cell, Letters
from contact_dynamics.contact_modes.planar.problem import contact_accelerations
from contact_dynamics.contact_modes.planar.wrench_cone import ModeWrenches
from contact_dynamics.contact_modes.result import ModeVerdict, PlanarMode, Refusal, RefusedMode, verdict_on
from contact_dynamics.numerics.vectors import Vector3, combined, dot, norm, scaled
from contact_dynamics.tolerances import FORCES_ROUNDING, INDEPENDENT_EQUATIONS, SUM_ROUNDING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.contact_modes.planar.problem import ContactRow, PlanarCase
    from contact_dynamics.plane.types import Vector2

EVIDENCE: Final = 3.0
"""Forces are evidence if they miss what the letters say by no more than this number of tolerances."""


class Judged(NamedTuple):
    """What mechanics says about some modes, in alphabetical order."""

    consistent: list[PlanarMode]  # the modes that it allows
    refused: list[RefusedMode]  # the modes that it does not allow
    undecided: list[str]  # modes that it may allow: rounding decides whether their forces bring them about

    @property
    def verdict(self) -> ModeVerdict:
        """Return the verdict if these are all modes."""
        return ModeVerdict.UNDECIDED if self.undecided else verdict_on(self.consistent)


def judge_all(case: PlanarCase, cells: Mapping[str, Cell], accuracy: float) -> Judged:
    """Return what mechanics says about the modes ``cells``."""
    consistent: list[PlanarMode] = []
    refused: list[RefusedMode] = []
    undecided: list[str] = []
    independent = IndependentModes(case, accuracy)
    for mode, cell in sorted(cells.items()):
        forces = independent.forces(mode, cell.letters)
        outcome: PlanarMode | RefusedMode | None
        if forces is None:
            outcome = _judged(case, mode, cell, accuracy, exact=False)
            if outcome is None:  # its forces do not bring about what the letters say: they are no evidence
                outcome = _judged(case, mode, cell, accuracy, exact=True)
        elif isinstance(forces, RefusedMode):
            outcome = forces
        else:
            outcome = _shown(case, mode, cell, forces, accuracy)
        if isinstance(outcome, PlanarMode):
            consistent.append(outcome)
        elif outcome is None:
            undecided.append(mode)
        else:
            refused.append(outcome)
    return Judged(consistent, refused, undecided)


def _shown(
    case: PlanarCase, mode: str, cell: Cell, forces: list[Vector2], accuracy: float
) -> PlanarMode | RefusedMode | None:
    """Return the mode that the solution of its own equations gives.

    Forces within the tolerance of a friction cone are put into it. If they then do not bring about what the
    letters say, they are no evidence, and the mode is decided again with more digits.
    """
    inside = _in_cones(case, cell, forces)
    q = _acceleration(case, cell, inside)
    if _misses(case, cell, q) > _allowed(case, accuracy, inside) or (
        inside != forces and _contradiction(case, cell, q)
    ):
        return _judged(case, mode, cell, accuracy, exact=True)
    return _consistent(case, mode, cell, inside, q, unique=(True, True))


def _judged(
    case: PlanarCase, mode: str, cell: Cell, accuracy: float, *, exact: bool
) -> PlanarMode | RefusedMode | None:
    """Decide a mode by the cone of its wrenches. Return None if its forces do not bring it about."""
    wrenches = ModeWrenches(case, cell, exact=exact)
    shortfall = wrenches.shortfall(accuracy)
    if shortfall is not None:
        return RefusedMode(mode=mode, refusal=Refusal.NO_SOLUTION, contact=-1, amount=shortfall)
    found = wrenches.solution(accuracy)
    forces = _in_cones(case, cell, [found.forces[position] for position, _ in cell.letters])
    q = _acceleration(case, cell, forces)
    missed = 0.0
    if found.motion is not None:
        newton, q = q, _with_motion(case, q, found.motion)
        missed = case.mass * norm(combined(1.0, newton, -1.0, q))
    missed += _misses(case, cell, q)
    # Close to the boundary, the rounding of the forces may be larger than the strict inequalities.
    if _contradiction(case, cell, q) or missed > _allowed(case, accuracy, forces):
        return None
    return _consistent(case, mode, cell, forces, q, unique=(found.forces_unique, found.motion_unique))


def _allowed(case: PlanarCase, accuracy: float, forces: list[Vector2]) -> float:
    """Return by how much, N, the forces of a mode may miss what its letters say."""
    return EVIDENCE * (accuracy + FORCES_ROUNDING) * (case.load + sum(f_n for _, f_n in forces))


def _consistent(
    case: PlanarCase,
    mode: str,
    cell: Cell,
    forces: list[Vector2],
    q: Vector3,
    *,
    unique: tuple[bool, bool],
) -> PlanarMode:
    alpha = q[2] / case.rho
    accelerations = contact_accelerations(case.contacts, q[:2], alpha, case.omega)
    all_forces: list[Vector2] = [(0.0, 0.0)] * len(case.contacts)
    for (position, letter), force in zip(cell.letters, forces, strict=True):
        index = case.rows[position].contact
        all_forces[index] = force
        # The accelerations that the mode says are zero are given as zero, without rounding.
        accelerations[index] = (0.0 if letter == FIXED else accelerations[index][0], 0.0)
    forces_unique, motion_unique = unique
    return PlanarMode(
        mode=mode,
        acceleration=q[:2],
        angular_acceleration=alpha,
        contact_forces=tuple(all_forces),
        contact_accelerations=tuple(accelerations),
        forces_unique=forces_unique,
        motion_unique=motion_unique,
    )


def _in_cones(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> list[Vector2]:
    """Return the forces, with those that leave their friction cones by a little moved into them."""
    inside = []
    for (position, letter), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = case.rows[position]
        friction = row.holding if letter == FIXED else row.friction
        edge = friction * f_n
        if f_n > 0.0:
            inside.append((max(-edge, min(edge, f_t)), f_n))
        else:
            inside.append((f_t, 0.0) if friction == math.inf else (0.0, 0.0))
    return inside


def _misses(case: PlanarCase, cell: Cell, q: Vector3) -> float:
    """Return the largest acceleration, times mass, N, that the letters say is zero and ``q`` says is not."""
    x, y, z = q
    most = 0.0
    for position, letter in cell.letters:
        row = case.rows[position]
        N = row.unit_n
        most = max(most, abs(N[0] * x + N[1] * y + N[2] * z + row.b_n / row.size_n))
        if letter == FIXED:
            T = row.unit_t
            most = max(most, abs(T[0] * x + T[1] * y + T[2] * z + row.b_t / row.size_t))
    return case.mass * most


def _contradiction(case: PlanarCase, cell: Cell, q: Vector3) -> bool:
    """Return whether a contact that should separate or start to slide does not."""
    size = norm(q)
    staying = dict(cell.letters)
    if len(staying) == len(case.rows) and set(staying.values()) == {FIXED}:
        return False
    for position, row in enumerate(case.rows):
        letter = staying.get(position)
        if letter is None:
            value, length = dot(row.N, q) + row.b_n, row.size_n
        elif letter != FIXED and row.slides == 0.0:
            value, length = dot(row.T, q) + row.b_t, row.size_t
            value = value if letter == RIGHT else -value
        else:
            continue
        if value <= FORCES_ROUNDING * length * size:
            return True
    return False


def _acceleration(case: PlanarCase, cell: Cell, forces: list[Vector2]) -> Vector3:
    x, y, z = case.w
    for (position, _), (f_t, f_n) in zip(cell.letters, forces, strict=True):
        row = case.rows[position]
        x += f_n * row.N[0] + f_t * row.T[0]
        y += f_n * row.N[1] + f_t * row.T[1]
        z += f_n * row.N[2] + f_t * row.T[2]
    return (x / case.mass, y / case.mass, z / case.mass)


def _with_motion(case: PlanarCase, newton: Vector3, motion: Vector3) -> Vector3:
    """Return the acceleration that ``motion``, N, gives, and ``newton`` along a line of symmetry."""
    x, y, _ = scaled(motion, 1.0 / case.mass)
    if case.lift is None:
        return scaled(motion, 1.0 / case.mass)
    one, two = case.lift.across
    return combined(1.0, combined(x, one, y, two), dot(newton, case.lift.line), case.lift.line)


_MAX_EQUATIONS: Final = 3
"""A planar body has three freedoms, so no more equations can be independent."""

_DIRECTION: Final = {LEFT: -1.0, RIGHT: 1.0}

Vector4: TypeAlias = tuple[float, float, float, float]


class _Equation(NamedTuple):
    """An acceleration that must be zero, and the force that keeps it at zero."""

    row: Vector4  # the acceleration as a function of w+; its first three numbers are a unit vector
    wrench: Vector3  # the wrench of the force, as a unit vector
    length: float  # the size of the wrench of a unit force, with moments divided by the radius of gyration


class _Unknown(NamedTuple):
    """One unknown force."""

    wrench: Vector3  # the wrench of the force, as a unit vector
    length: float  # the size of the wrench of a unit force, as for `_Equation`
    response: Vector4  # the wrench that solves the equations is -response . w+ times the unit vector


class _Refused(NamedTuple):
    """A motion is not that of a mode."""

    by_more_than_rounding: RefusedMode | None  # the reason; None if only rounding is against the motion


class IndependentModes:
    """The modes of one problem whose equations are independent. It solves and judges them."""

    __slots__ = ("_accuracy", "_case", "_equations", "_load", "_never_slips", "_scale", "_wrench")

    def __init__(self, case: PlanarCase, accuracy: float) -> None:
        """Prepare to judge modes. Numbers within the relative ``accuracy`` count as zero."""
        self._case = case
        self._scale = case.lift.scale if case.lift else 0.0
        self._wrench: Vector4 = (*case.w, case.mass * self._scale)
        self._load = _size(self._wrench)
        self._accuracy = accuracy
        # Without a finite friction there is no equation for sliding.
        self._never_slips = any(row.holding == math.inf for row in case.rows)
        # The equations of each contact's letter are computed when a mode first has that letter.
        self._equations: dict[tuple[int, int], tuple[_Equation, ...]] = {}

    def forces(self, mode: str, letters: Letters) -> list[Vector2] | RefusedMode | None:
        """Return (f_t, f_n) of each contact that stays, or the first reason against the mode.

        Returns None if the equations of the mode are not independent, or if only rounding is against it.
        """
        unknowns = self._unknowns(letters)
        if unknowns is None:
            return None
        sizes = [-_dot4(unknown.response, self._wrench) for unknown in unknowns]
        forces = self._judged_forces(mode, letters, unknowns, sizes)
        if isinstance(forces, RefusedMode):
            return forces
        refused = self._motion_refusal(mode, letters, unknowns, sizes)
        return forces if refused is None else refused.by_more_than_rounding

    def _unknowns(self, letters: Letters) -> list[_Unknown] | None:
        if len(letters) > _MAX_EQUATIONS or self._never_slips:
            return None
        equations: list[_Equation] = []
        for letter in letters:
            known = self._equations.get(letter)
            if known is None:
                known = self._equations[letter] = self._equations_of(*letter)
            equations += known
        if len(equations) > _MAX_EQUATIONS:
            return None
        responses = _solved(equations)
        if responses is None:
            return None
        return [
            _Unknown(one.wrench, one.length, response)
            for one, response in zip(equations, responses, strict=True)
        ]

    def _equations_of(self, position: int, letter: int) -> tuple[_Equation, ...]:
        row = self._case.rows[position]
        normal: Vector4 = (*row.unit_n, self._offset(row.b_n, row.size_n))
        if letter == FIXED:
            tangential: Vector4 = (*row.unit_t, self._offset(row.b_t, row.size_t))
            return (
                _Equation(normal, row.unit_n, row.size_n),
                _Equation(tangential, row.unit_t, row.size_t),
            )
        edge = _edge(row, letter)
        length = norm(edge)
        return (_Equation(normal, (edge[0] / length, edge[1] / length, edge[2] / length), length),)

    def _judged_forces(
        self, mode: str, letters: Letters, unknowns: list[_Unknown], sizes: list[float]
    ) -> list[Vector2] | RefusedMode:
        tolerance = self._accuracy * self._load
        forces: list[Vector2] = []
        at = 0
        for position, letter in letters:
            row = self._case.rows[position]
            normal, f_n = unknowns[at], sizes[at] / unknowns[at].length
            if sizes[at] < 0.0 and sizes[at] < -tolerance * _size(normal.response):
                return RefusedMode(mode=mode, refusal=Refusal.PULLS, contact=row.contact, amount=f_n)
            if letter != FIXED:
                forces.append((_slope(row, letter) * f_n, f_n))
                at += 1
                continue
            tangential, f_t = unknowns[at + 1], sizes[at + 1] / unknowns[at + 1].length
            excess = abs(f_t) - row.holding * f_n
            if excess > 0.0:
                one, other = math.copysign(1.0 / tangential.length, f_t), row.holding / normal.length
                gradient = _combined(one, tangential.response, -other, normal.response)
                if excess > tolerance * _size(gradient):
                    return RefusedMode(
                        mode=mode, refusal=Refusal.OUTSIDE_CONE, contact=row.contact, amount=excess
                    )
            forces.append((f_t, f_n))
            at += 2
        return forces

    def _motion_refusal(
        self, mode: str, letters: Letters, unknowns: list[_Unknown], sizes: list[float]
    ) -> _Refused | None:
        """Return the first contact that does not accelerate as its letter says, unless all do."""
        case = self._case
        x, y, z = case.w
        for unknown, size in zip(unknowns, sizes, strict=True):
            x += size * unknown.wrench[0]
            y += size * unknown.wrench[1]
            z += size * unknown.wrench[2]
        terms = 1.5
        for unknown in unknowns:
            terms += _size(unknown.response)
        clear = (self._accuracy + SUM_ROUNDING) * self._load * terms
        staying = dict(letters)
        for position, row in enumerate(case.rows):
            letter = staying.get(position)
            if letter is None:
                sign, unit, length, offset = 1.0, row.unit_n, row.size_n, row.b_n
            elif letter != FIXED and row.slides == 0.0:
                sign, unit, length, offset = _DIRECTION[letter], row.unit_t, row.size_t, row.b_t
            else:
                continue
            value = sign * (unit[0] * x + unit[1] * y + unit[2] * z + case.mass * offset / length)
            if value > clear:
                continue
            row4 = (*unit, self._offset(offset, length))
            tolerance, rounding = (0.0, 0.0) if value < -clear else self._tolerance(row4, unknowns)
            if value <= tolerance + rounding:
                if abs(value - tolerance) <= rounding:
                    return _Refused(None)
                reason = Refusal.PENETRATES if value < -tolerance and letter is None else Refusal.WRONG_MOTION
                amount = sign * value * length / case.mass
                return _Refused(RefusedMode(mode=mode, refusal=reason, contact=row.contact, amount=amount))
        return None

    def _tolerance(self, row: Vector4, unknowns: list[_Unknown]) -> tuple[float, float]:
        """Return the force, N, up to which mass times an acceleration counts as zero, and its rounding."""
        gradient = row
        terms = 1.0
        for unknown in unknowns:
            part = dot(row[:3], unknown.wrench)
            gradient = _combined(1.0, gradient, -part, unknown.response)
            terms += abs(part) * _size(unknown.response)
        return self._load * self._accuracy * _size(gradient), self._load * SUM_ROUNDING * terms

    def _offset(self, offset: float, length: float) -> float:
        """Return the fourth number of a unit row: how the acceleration depends on the scale."""
        return offset / (length * self._scale) if self._scale else 0.0


def _solved(equations: list[_Equation]) -> list[Vector4] | None:
    """Return the rows of B = (A U)^-1 A+, where A+ are the equations' rows and U their unit wrenches.

    A is A+ without its last column. Returns None if A U has no inverse.
    """
    count = len(equations)
    if count == 1:  # most modes
        row, wrench, _ = equations[0]
        gain = row[0] * wrench[0] + row[1] * wrench[1] + row[2] * wrench[2]
        if abs(gain) <= INDEPENDENT_EQUATIONS:
            return None
        return [(row[0] / gain, row[1] / gain, row[2] / gain, row[3] / gain)]
    if count == 2:  # most of the others, at half the time of the table
        return _solved_pair(*equations)
    wrenches = [wrench for _, wrench, _ in equations]
    table = [
        [*(row[0] * x + row[1] * y + row[2] * z for x, y, z in wrenches), *row] for row, _, _ in equations
    ]
    for k in range(count):
        pivot = max(range(k, count), key=lambda i: abs(table[i][k]))
        if abs(table[pivot][k]) <= INDEPENDENT_EQUATIONS:
            return None
        table[k], table[pivot] = table[pivot], table[k]
        chosen = table[k]
        for i in range(count):
            if i != k:
                factor = table[i][k] / chosen[k]
                table[i] = [a - factor * b for a, b in zip(table[i], chosen, strict=True)]
    responses: list[Vector4] = []
    for k, line in enumerate(table):
        x, y, z, height = line[count:]
        responses.append((x / line[k], y / line[k], z / line[k], height / line[k]))
    return responses


def _solved_pair(one: _Equation, two: _Equation) -> list[Vector4] | None:
    """Return what `_solved` does for two equations, by the same steps."""
    first, second = one.row, two.row
    u, v = one.wrench, two.wrench
    a, b, c, d = dot(first[:3], u), dot(first[:3], v), dot(second[:3], u), dot(second[:3], v)
    if abs(c) > abs(a):
        first, second, a, b, c, d = second, first, c, d, a, b
    if abs(a) <= INDEPENDENT_EQUATIONS:
        return None
    factor = c / a
    d -= factor * b
    if abs(d) <= INDEPENDENT_EQUATIONS:
        return None
    second = _combined(1.0, second, -factor, first)
    first = _combined(1.0, first, -b / d, second)
    return [
        (first[0] / a, first[1] / a, first[2] / a, first[3] / a),
        (second[0] / d, second[1] / d, second[2] / d, second[3] / d),
    ]


def _slope(row: ContactRow, letter: int) -> float:
    """Return f_t / f_n of a sliding contact. Friction pushes to the right if the contact slides left."""
    return row.friction if letter == LEFT else -row.friction


def _edge(row: ContactRow, letter: int) -> Vector3:
    """Return the wrench of a sliding contact's force whose normal part is 1."""
    slope = _slope(row, letter)
    N, T = row.N, row.T
    return (N[0] + slope * T[0], N[1] + slope * T[1], N[2] + slope * T[2])


def _combined(p: float, a: Vector4, q: float, b: Vector4) -> Vector4:
    return (p * a[0] + q * b[0], p * a[1] + q * b[1], p * a[2] + q * b[2], p * a[3] + q * b[3])


def _dot4(a: Vector4, b: Vector4) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3]


def _size(a: Vector4) -> float:
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2] + a[3] * a[3])
