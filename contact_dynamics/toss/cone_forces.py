# SPDX-License-Identifier: Apache-2.0
"""Pushes at several contacts that keep a body out of the world, with round friction cones.

The same problem appears twice. Contact forces change accelerations, and impulses without restitution change
velocities. With the motion b of the contacts without any push, and the response D, the pushes f obey

    m = b + D f,    0 <= f_n,  m_n >= 0, one of the two zero,    |f_t| <= mu f_n,

and f_t is against m_t with mu f_n where m_t is not zero. A contact that slides already has friction in a
known direction. The method is block Gauss-Seidel: the problem of one contact is solved exactly, in turn,
until no push changes (Moreau 1988). It does not find all solutions; `contact_modes` does. Where contacts jam,
pushes of contacts against each other take ten thousands of sweeps, and their limit is sought (Anderson 1965).

`cone_forces.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.numerics.lemke import solve_complementarity
from contact_dynamics.tolerances import CONE_SWEEPS_CONVERGED, FORCE_ROUNDING, SWEEPS_CHANGE_ALIKE
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.forces import Equations

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Flat, Pose

MAX_SWEEPS: Final = 400
"""Sweeps over all contacts after which the problem counts as not solved. Four corners need some fifty."""

PLAIN_SWEEPS: Final = 100
"""Sweeps after which their limit is sought. Where contacts jam, ten thousand sweeps would be needed."""

_MAX_FURTHER_SWEEPS: Final = 1000
"""Sweeps after which the problem counts as not solved where their limit is sought."""

FURTHER_SWEEPS: Final = 10
"""Sweeps from which their limit is sought, again and again."""

_MAX_TURNS: Final = 60
"""Steps towards the direction in which one contact slides."""

_DIRECTIONS: Final = 48
"""Directions that are tried where these steps do not find it."""


_WIDTH: Final = 10  # numbers of a contact in `ConeForces`


class ConeForces:
    """Contacts in one such problem, in contact axes: two tangents and the normal."""

    def __init__(self, most: int) -> None:
        self.count = 0
        self.equations = Equations(3 * most)
        # Each contact has ten numbers: its friction, the direction in which it slides already, by the two
        # tangents, whether it does, its motion without any push, and its push.
        self.numbers = array("d", bytes(8 * (_WIDTH + 3) * most))
        self.motions = self.numbers[_WIDTH * most :]

    def add(self, pose: Pose, arm: Vector3, flat: Flat, velocity: Vector3, rise: float) -> None:
        """Add a contact.

        Args:
            pose: The body's pose.
            arm: m, world axes, from the centre of mass.
            flat: What it touches.
            velocity: The contact's velocity or acceleration without any push, world axes.
            rise: What is added to its normal component.
        """
        t1, t2 = flat.tangents
        n, x, k = flat.normal, self.numbers, _WIDTH * self.count
        self.equations.add(pose, arm, t1, t1, 0.0)
        self.equations.add(pose, arm, t2, t2, 0.0)
        self.equations.add(pose, arm, n, n, 0.0)
        x[k], x[k + 1], x[k + 2], x[k + 3] = flat.friction, 0.0, 0.0, 0.0
        x[k + 4], x[k + 5], x[k + 6] = (
            vec.dot(velocity, t1),
            vec.dot(velocity, t2),
            vec.dot(velocity, n) + rise,
        )
        x[k + 7] = x[k + 8] = x[k + 9] = 0.0
        self.count += 1

    def slide(self, x: float, y: float) -> None:
        """Have the contact that was added last slide in a unit direction, by the two tangents."""
        k = _WIDTH * (self.count - 1)
        self.numbers[k + 1], self.numbers[k + 2], self.numbers[k + 3] = x, y, 1.0

    def push(self, i: int) -> Vector3:
        """Return the push of a contact, contact axes."""
        k = _WIDTH * i + 7
        return (self.numbers[k], self.numbers[k + 1], self.numbers[k + 2])

    def motion(self, i: int) -> Vector3:
        """Return the motion of a contact with all pushes, contact axes."""
        return (self.motions[3 * i], self.motions[3 * i + 1], self.motions[3 * i + 2])

    def alone(self, i: int) -> Vector3:
        """Return the motion of a contact without any push, contact axes."""
        k = _WIDTH * i + 4
        return (self.numbers[k], self.numbers[k + 1], self.numbers[k + 2])

    def solve(self, per_mass: float, enough: float) -> bool:
        """Find the pushes and the contacts' motions with them, and return whether they were found.

        Args:
            per_mass: 1/kg.
            enough: Relative to the largest motion. If it is not 0, the limit of many sweeps is sought, as
                where contacts jam. A sweep that changes less is the last then, where pushes of contacts
                against each other creep on. The limit need not be one that sweeps would come to by
                themselves.
        """
        self.equations.respond(per_mass)
        scale = 0.0
        for i in range(self.count):
            scale = max(scale, vec.norm(self.alone(i)))
        self._move()
        if scale == 0.0:
            return True
        seen: list[list[float]] = []
        for sweep in range(_MAX_FURTHER_SWEEPS if enough > 0.0 else MAX_SWEEPS):
            change = self._sweep()
            if change <= CONE_SWEEPS_CONVERGED * scale:
                return self._lowest() >= -FORCE_ROUNDING * scale
            if sweep < PLAIN_SWEEPS or enough == 0.0:
                continue
            seen.append([x for i in range(self.count) for x in self.push(i)])
            if len(seen) > FURTHER_SWEEPS:
                if max(change, -self._lowest()) <= enough * scale:
                    return True
                seen = [self._go_to_limit(seen)]
        return False

    def solve_without_friction(self) -> bool:
        """Find the pushes without friction, after `solve`, and return whether they were found.

        These exist if some motion keeps the body out of the world. Pivots find them also where sweeps creep.
        """
        n = 3 * self.count
        matrix = np.array(self.equations.matrix[: n * n]).reshape(n, n)
        alone = np.array([self.alone(i)[2] for i in range(self.count)])
        found = solve_complementarity(matrix[2::3, 2::3], alone)
        if found is None:
            return False
        for i, push in enumerate(found.tolist()):
            k = _WIDTH * i + 7
            self.numbers[k], self.numbers[k + 1], self.numbers[k + 2] = 0.0, 0.0, push
        self._move()
        return True

    def _sweep(self) -> float:
        """Solve the problem of each contact in turn, and return the largest change of its own motion."""
        change, n, m = 0.0, 3 * self.count, self.equations.matrix
        for i in range(self.count):
            old, now = self.push(i), self.motion(i)
            k = 3 * i * n + 3 * i
            x = m[k] * old[0] + m[k + 1] * old[1] + m[k + 2] * old[2]
            y = m[k + n] * old[0] + m[k + n + 1] * old[1] + m[k + n + 2] * old[2]
            z = m[k + 2 * n] * old[0] + m[k + 2 * n + 1] * old[1] + m[k + 2 * n + 2] * old[2]
            push = self._one(i, (now[0] - x, now[1] - y, now[2] - z))
            u, v, w = push[0] - old[0], push[1] - old[1], push[2] - old[2]
            if u == 0.0 and v == 0.0 and w == 0.0:
                continue
            k = _WIDTH * i + 7
            self.numbers[k], self.numbers[k + 1], self.numbers[k + 2] = push[0], push[1], push[2]
            for j in range(n):
                k = j * n + 3 * i
                moved = m[k] * u + m[k + 1] * v + m[k + 2] * w
                self.motions[j] += moved
                if 3 * i <= j < 3 * i + 3:
                    change = max(change, abs(moved))
        return change

    def _lowest(self) -> float:
        least = self.motions[2]
        for i in range(self.count):
            least = min(least, self.motions[3 * i + 2])
        return least

    def _go_to_limit(self, seen: list[list[float]]) -> list[float]:
        """Go to the limit of sweeps, from the pushes after each of them (Anderson 1965), and return it."""
        after = np.array(seen)
        changes = np.diff(after, axis=0)
        # Counted from the front: compiled for some Pythons, -1 is counted from the end twice.
        last, turns = changes[len(changes) - 1], np.diff(changes, axis=0)
        shares = np.linalg.lstsq(turns.T, last, rcond=SWEEPS_CHANGE_ALIKE)[0]
        found: list[float] = (after[len(after) - 1] - shares @ changes[1:]).tolist()
        for j in range(3 * self.count):
            self.numbers[_WIDTH * (j // 3) + 7 + j % 3] = found[j]
        self._move()
        return found

    def _move(self) -> None:
        """Find the motions of contacts with their pushes."""
        n, m = 3 * self.count, self.equations.matrix
        for j in range(n):
            motion = self.numbers[_WIDTH * (j // 3) + 4 + j % 3]
            for i in range(self.count):
                push, k = self.push(i), j * n + 3 * i
                motion += m[k] * push[0] + m[k + 1] * push[1] + m[k + 2] * push[2]
            self.motions[j] = motion

    def _block(self, i: int) -> tuple[float, float, float, float, float, float]:
        """Return the response of a contact to its own push: the entries from the diagonal on, by rows."""
        n, m = 3 * self.count, self.equations.matrix
        k = 3 * i * n + 3 * i
        return (m[k], m[k + 1], m[k + 2], m[k + n + 1], m[k + n + 2], m[k + 2 * n + 2])

    def _one(self, i: int, m: Vector3) -> Vector3:
        """Return the push of one contact that has the motion ``m`` without it."""
        if m[2] >= 0.0:
            return (0.0, 0.0, 0.0)
        k = _WIDTH * i
        mu = self.numbers[k]
        a, b, c, d, e, f = self._block(i)
        if self.numbers[k + 3] != 0.0:
            x, y = self.numbers[k + 1], self.numbers[k + 2]
            rate = f - mu * (c * x + e * y)
            p = -m[2] / rate if rate > 0.0 else 0.0
            return (-mu * p * x, -mu * p * y, p)
        # Does it stick?  The block is symmetric and positive definite.
        A, B, C = d * f - e * e, c * e - b * f, b * e - c * d
        D, E, F = a * f - c * c, b * c - a * e, a * d - b * b
        det = a * A + b * B + c * C
        x = -(A * m[0] + B * m[1] + C * m[2]) / det
        y = -(B * m[0] + D * m[1] + E * m[2]) / det
        z = -(C * m[0] + E * m[1] + F * m[2]) / det
        if z > 0.0 and math.sqrt(x * x + y * y) <= mu * z:
            return (x, y, z)
        if mu == 0.0:
            return (0.0, 0.0, -m[2] / f)
        return self._slide(i, m, x, y)

    def _against(self, i: int, m: Vector3, x: float, y: float) -> Vector3:
        """Return the normal push with friction against a direction, or 0, and the tangential motion."""
        a, b, c, d, e, f = self._block(i)
        mu = self.numbers[_WIDTH * i]
        rate = f - mu * (c * x + e * y)
        p = -m[2] / rate if rate > 0.0 else 0.0
        return (p, m[0] + p * (c - mu * (a * x + b * y)), m[1] + p * (e - mu * (b * x + d * y)))

    def _slide(self, i: int, m: Vector3, hold_x: float, hold_y: float) -> Vector3:
        """Return the push of one contact that friction does not hold: a direction that its motion keeps.

        The direction d solves: the tangential motion with the push p (n - mu d) is along d. Newton's steps on
        the angle start from the motion against the force that would hold it.
        """
        a, b, c, d, e, _ = self._block(i)
        mu = self.numbers[_WIDTH * i]
        angle = math.atan2(m[1], m[0])
        if hold_x != 0.0 or hold_y != 0.0:
            angle = math.atan2(-hold_y, -hold_x)
        for _ in range(_MAX_TURNS):
            x, y = math.cos(angle), math.sin(angle)
            p, u, v = self._against(i, m, x, y)
            if p == 0.0:
                break
            turn = math.atan2(x * v - y * u, x * u + y * v)
            if abs(turn) <= CONE_SWEEPS_CONVERGED:
                return (-mu * p * x, -mu * p * y, p)
            # The derivative of u, v and of p by the angle.
            rate = -m[2] / p
            p_turn = p * mu * (e * x - c * y) / rate
            u_turn = p_turn * (c - mu * (a * x + b * y)) + p * mu * (a * y - b * x)
            v_turn = p_turn * (e - mu * (b * x + d * y)) + p * mu * (b * y - d * x)
            size = u * u + v * v
            slope = (u * v_turn - v * u_turn) / size - 1.0 if size > 0.0 else -1.0
            step = -turn / slope if slope < 0.0 else turn
            angle += max(-1.0, min(1.0, step))
        return self._slide_by_halves(i, m)

    def _across(self, i: int, m: Vector3, angle: float) -> Vector3:
        """Return how far the motion is to the left of a direction, and along it, and the normal push."""
        x, y = math.cos(angle), math.sin(angle)
        p, u, v = self._against(i, m, x, y)
        return (x * v - y * u, x * u + y * v if p > 0.0 else -1.0, p)

    def _slide_by_halves(self, i: int, m: Vector3) -> Vector3:
        """Return the push with friction against a direction that the motion keeps, or without friction.

        Directions all around are tried.
        """
        turn = 2.0 * math.pi / _DIRECTIONS
        mu = self.numbers[_WIDTH * i]
        found = self._across(i, m, 0.0)
        for k in range(_DIRECTIONS):
            before, found = found, self._across(i, m, (k + 1) * turn)
            if before[0] * found[0] > 0.0 or before[1] < 0.0 or found[1] < 0.0:
                continue
            low, high, middle = k * turn, (k + 1) * turn, k * turn
            p = before[2]
            for _ in range(_MAX_TURNS):
                middle = 0.5 * (low + high)
                value, _, p = self._across(i, m, middle)
                if value * before[0] > 0.0:
                    low = middle
                else:
                    high = middle
            return (-mu * p * math.cos(middle), -mu * p * math.sin(middle), p)
        return (0.0, 0.0, -m[2] / self._block(i)[5])
