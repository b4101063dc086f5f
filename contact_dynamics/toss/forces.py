# SPDX-License-Identifier: Apache-2.0
"""The held contacts of a body: its accelerations in their mode, and how it is kept where they are.

Each held contact sticks or slides. A contact that sticks has no acceleration, which is three equations for
the three parts of its force. A contact that slides has no normal acceleration, which is one equation for its
normal force. Its friction is mu times that, against the sliding (lecture 26). If the forces are not the only
ones with the mode, as under four corners, the least ones are taken. Where those pull, or friction does not
allow them, others with the same motion are sought, as where a body is wedged.

What rounding or a slow rebound has left of the motion of held contacts is taken away. Velocities and
positions are changed by the least amount that meets the contacts' equations, where the amount is measured by
kinetic energy. So velocities lose energy by it, if anything.

`forces.pxd` gives the C types with which this file compiles.
"""

from __future__ import annotations

import math
from array import array
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.spatial.round_cones import summed_by_round_cones
from contact_dynamics.tolerances import (
    DISTANCE_TOLERANCE,
    FORCE_ROUNDING,
    HELD_DRIFT,
    ROUND_CONE_HELD,
    SAME_FORCES,
    SLIDING_DIRECTION_SPEED,
    SLIDING_STOPPED,
    SUNK,
)
from contact_dynamics.toss import vectors as vec
from contact_dynamics.toss.solid import Pose

if TYPE_CHECKING:
    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.solid import Above, Held, Numbers, Solid, Touch

_DIRECTION_SURE: Final = 1e6 * SLIDING_DIRECTION_SPEED
"""m/s. A flush contact that slides faster has a direction of its own, to 1e-6."""

_MAX_SWEEPS: Final = 200
"""Sweeps over corners that are below a flat. Some ten are usual."""

_INFINITE: Final = math.inf

_ROW, _MOMENT, _FORCE, _TURNING, _WANTED, _SIZE, _WIDTH = 0, 3, 6, 9, 12, 13, 14  # columns of `Equations`


class Equations:
    """Forces of unknown sizes that give motions along rows the amounts that are wanted.

    A row is a direction at an arm from the centre of mass. Forces may be impulses, and accelerations changes
    of velocity.
    """

    def __init__(self, most: int) -> None:
        self.count = 0
        self.table = array("d", bytes(8 * (_WIDTH + most) * most))
        self.matrix = self.table[_WIDTH * most :]

    def add(self, pose: Pose, arm: Vector3, row: Vector3, force: Vector3, wanted: float) -> None:
        """Add a row and a force at an arm, m."""
        moment = vec.cross(arm, row)
        turning = vec.times(pose.inverse, vec.cross(arm, force))
        t, k = self.table, _WIDTH * self.count
        t[k], t[k + 1], t[k + 2] = row[0], row[1], row[2]
        t[k + 3], t[k + 4], t[k + 5] = moment[0], moment[1], moment[2]
        t[k + 6], t[k + 7], t[k + 8] = force[0], force[1], force[2]
        t[k + 9], t[k + 10], t[k + 11] = turning[0], turning[1], turning[2]
        t[k + 12] = wanted
        self.count += 1

    def part(self, k: int, first: int) -> Vector3:
        """Return a vector of row ``k``."""
        i = _WIDTH * k + first
        return (self.table[i], self.table[i + 1], self.table[i + 2])

    def respond(self, per_mass: float) -> None:
        """Find how much of each row's motion each force makes, for a mass of 1/``per_mass`` kg."""
        n = self.count
        for i in range(n):
            row, moment = self.part(i, _ROW), self.part(i, _MOMENT)
            for j in range(n):
                pushed = per_mass * vec.dot(row, self.part(j, _FORCE))
                self.matrix[i * n + j] = pushed + vec.dot(moment, self.part(j, _TURNING))

    def solve(self, per_mass: float) -> int:
        """Find the sizes, the least ones if there are many, and return in how many ways others differ."""
        self.respond(per_mass)
        t, m, n = self.table, self.matrix, self.count
        first, second, third = _SIZE, _WIDTH + _SIZE, 2 * _WIDTH + _SIZE
        if n == 0:
            return 0
        x = t[_WANTED]
        if n == 1:
            t[first] = x / m[0] if m[0] != 0.0 else _INFINITE
            return 0
        a, b = m[0], m[1]
        y = t[_WIDTH + _WANTED]
        if n == 2:
            c, d = m[2], m[3]
            det = a * d - b * c
            if abs(det) > SAME_FORCES * (abs(a) + abs(b)) * (abs(c) + abs(d)):
                t[first], t[second] = (d * x - b * y) / det, (a * y - c * x) / det
                return 0
        if n == 3:
            c, d, e, f, g, h, i = m[2], m[3], m[4], m[5], m[6], m[7], m[8]
            z = t[2 * _WIDTH + _WANTED]
            A, B, C = e * i - f * h, f * g - d * i, d * h - e * g
            det, size = a * A + b * B + c * C, abs(a) + abs(b) + abs(c)
            if abs(det) > SAME_FORCES * (size * size * size):
                D, E, F = c * h - b * i, a * i - c * g, b * g - a * h
                G, H, K = b * f - c * e, c * d - a * f, a * e - b * d
                t[first] = (A * x + D * y + G * z) / det
                t[second] = (B * x + E * y + H * z) / det
                t[third] = (C * x + F * y + K * z) / det
                return 0
        return self._solve_many()

    def _solve_many(self) -> int:
        """Solve by Gram and Schmidt's method on the rows of the matrix, the largest remaining one first.

        What is along no row remains zero, so that the sizes are the least ones. The rows are lost.
        """
        enough = 0.0
        for k in range(self.count):
            self.table[_WIDTH * k + _SIZE] = 0.0
        for found in range(self.count):
            row, largest = 0, 0.0
            for k in range(self.count):
                square = self._product(k, k)
                if square > largest:
                    row, largest = k, square
            if largest <= enough:
                return self.count - found
            if found == 0:
                enough = SAME_FORCES * SAME_FORCES * largest
            self._meet(row, math.sqrt(largest))
        return 0

    def _product(self, i: int, k: int) -> float:
        """Return the inner product of two rows of the matrix."""
        n, total = self.count, 0.0
        for j in range(n):
            total += self.matrix[i * n + j] * self.matrix[k * n + j]
        return total

    def _meet(self, row: int, length: float) -> None:
        """Change the sizes along a row of this length until it is met, and make other rows normal to it."""
        t, m, n = self.table, self.matrix, self.count
        wanted = t[_WIDTH * row + _WANTED] / length
        for j in range(n):
            m[row * n + j] /= length
            t[_WIDTH * j + _SIZE] += wanted * m[row * n + j]
        for i in range(n):
            along = self._product(i, row)
            if i != row:
                t[_WIDTH * i + _WANTED] -= along * wanted
                for j in range(n):
                    m[i * n + j] -= along * m[row * n + j]
        for j in range(n):
            m[row * n + j] = 0.0

    def size(self, k: int) -> float:
        """Return the size of a force."""
        return self.table[_WIDTH * k + _SIZE]

    def summed(self, start: Vector3, first: int, factor: float) -> Vector3:
        """Return a vector plus the factor times forces, or the angular accelerations that they cause."""
        x, y, z = start
        for k in range(self.count):
            u, v, w = self.part(k, first)
            share = factor * self.size(k)
            x, y, z = x + share * u, y + share * v, z + share * w
        return (x, y, z)


class HeldContacts:
    """The held contacts of a mode.

    Attributes:
        solid: The body and the flats.
        mode: The contacts.
        pose: The pose that was taken last.
        rates: The rates of the 13 numbers of the state, as contact forces make them.
        begins: Whether a contact has just begun to slide.
    """

    def __init__(self, solid: Solid, mode: tuple[Held, ...]) -> None:
        self.solid, self.mode, self.count = solid, mode, len(mode)
        self.pose = Pose(solid)
        self.rates = [0.0] * 13
        size, self.is_flush, self.begins = 0, self.count > 2, False
        for one in mode:
            self.begins = self.begins or one.begins
            size += 1 if one.slides else 3
            self.is_flush = self.is_flush and one.slides and one.flat == mode[0].flat
        self.equations = Equations(size)
        # The force at each contact, N, its target, and five numbers that a flush one needs.
        self.numbers = array("d", bytes(8 * 9 * self.count))
        self.others = 0  # the number of ways in which other forces with the same rates differ
        self.y = [0.0] * 13

    @property
    def forces(self) -> list[Vector3]:
        """The force on the body at each held contact, N, world axes."""
        return [self.force(i) for i in range(self.count)]

    def force(self, i: int) -> Vector3:
        """Return the force on the body at a contact, N, world axes."""
        return (self.numbers[3 * i], self.numbers[3 * i + 1], self.numbers[3 * i + 2])

    def set_force(self, i: int, x: float, y: float, z: float) -> None:
        """Note the force at a contact, N."""
        self.numbers[3 * i], self.numbers[3 * i + 1], self.numbers[3 * i + 2] = x, y, z

    def push(self, y: Numbers) -> None:
        """Find the rates of the state, and the forces at the contacts."""
        self.accelerate(y)
        self.choose_forces()

    def accelerate(self, y: Numbers) -> None:
        """Find the rates of the state, which all forces with the mode cause alike."""
        pose = self.pose
        self.others = 0
        pose.take(y)
        if self.is_flush and self._slide_flush(y):
            return
        solid, equations = self.solid, self.equations
        equations.count = 0
        for i in range(self.count):
            one = self.mode[i]
            flat = solid.flats[one.flat]
            n = flat.normal
            arm = pose.arm(one.flat, one.corner)
            moves = pose.acceleration(one.flat, arm, solid.gravity, pose.alpha)
            if one.slides:
                d = one.towards
                if not one.begins:
                    d = pose.sliding(arm, n, d)
                mu = flat.friction
                force = (n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2])
                equations.add(pose, arm, n, force, -vec.dot(n, moves))
            else:
                t1, t2 = flat.tangents
                equations.add(pose, arm, t1, t1, -vec.dot(t1, moves))
                equations.add(pose, arm, t2, t2, -vec.dot(t2, moves))
                equations.add(pose, arm, n, n, -vec.dot(n, moves))
        per_mass = 1.0 / solid.mass
        self.others = equations.solve(per_mass)
        k = 0
        for i in range(self.count):
            one = self.mode[i]
            f_x = f_y = f_z = 0.0
            for _ in range(1 if one.slides else 3):
                size, push = equations.size(k), equations.part(k, _FORCE)
                f_x, f_y, f_z = f_x + size * push[0], f_y + size * push[1], f_z + size * push[2]
                k += 1
            self.set_force(i, f_x, f_y, f_z)
        a = equations.summed(solid.gravity, _FORCE, per_mass)
        self._set_rates(y, a, equations.summed(pose.alpha, _TURNING, 1.0))

    def choose_forces(self) -> None:
        """Choose forces that press and that friction allows, if there are any with the rates of `accelerate`.

        That takes up to a hundred times as long as the rates, which are all that most stages of a step need.
        """
        if self.count == 2 and self._share_between_two() and self.others <= 1:
            return
        if self.others > 0 and self.least_left() < 0.0 and not self._tips():
            self._bring_within_cones()

    def _set_rates(self, y: Numbers, a: Vector3, alpha: Vector3) -> None:
        rates = self.rates
        q_x, q_y, q_z, q_w = y[3], y[4], y[5], y[6]
        w_x, w_y, w_z = y[10], y[11], y[12]
        rates[0], rates[1], rates[2] = y[7], y[8], y[9]
        rates[3] = 0.5 * (w_x * q_w + w_y * q_z - w_z * q_y)
        rates[4] = 0.5 * (w_y * q_w + w_z * q_x - w_x * q_z)
        rates[5] = 0.5 * (w_z * q_w + w_x * q_y - w_y * q_x)
        rates[6] = -0.5 * (w_x * q_x + w_y * q_y + w_z * q_z)
        rates[7], rates[8], rates[9] = a[0], a[1], a[2]
        rates[10], rates[11], rates[12] = alpha[0], alpha[1], alpha[2]

    def accelerated(self, flat: int, corner: int) -> Vector3:
        """Return the acceleration, m/s^2, of a corner's point at a flat under the forces of `push`."""
        pose, rates = self.pose, self.rates
        a, alpha = (rates[7], rates[8], rates[9]), (rates[10], rates[11], rates[12])
        return pose.acceleration(flat, pose.arm(flat, corner), a, alpha)

    def least_left(self) -> float:
        """Return the least force, N, that is left until a contact no longer presses, or no longer sticks.

        It is less than zero where one does not, and rounding has been given to it.
        """
        least = _INFINITE
        for i in range(self.count):
            one, force = self.mode[i], self.force(i)
            flat = self.solid.flats[one.flat]
            pressing = vec.dot(force, flat.normal)
            least = min(least, pressing)
            if not one.slides:
                across = math.sqrt(max(vec.dot(force, force) - pressing * pressing, 0.0))
                least = min(least, flat.holding() * pressing - across)
        return least + force_rounding(self.solid)

    def friction_left(self) -> float:
        """Return the friction, N, that the contacts have left beside what they bear, if all stick."""
        left = 0.0
        for i in range(self.count):
            force, flat = self.force(i), self.solid.flats[self.mode[i].flat]
            pressing = vec.dot(force, flat.normal)
            left += flat.friction * pressing - vec.norm(vec.without(force, flat.normal))
        return left

    def _slide_flush(self, y: Numbers) -> bool:
        """Find the accelerations of a body that slides with three or more corners flush on one flat.

        This is the case in which a toss spends most of its contact time, so it has formulas of its own. The
        body turns about the flat's normal alone. With the arms s in the plane, the height h of the centre of
        mass, the sliding directions d, and j = I n, the balance of force and moment is

            sum f = -m g_n,    sum f (s x n + mu h n x d)_t = alpha j_t + w^2 (n x j)_t,
            alpha j_n = -mu sum f (s x d) . n,

        for the normal forces f. Of all forces that balance, the least are taken, as elsewhere. If the corners
        are on one line, so that they do not keep the body flush, nothing is found, and the result is false.
        """
        solid, pose = self.solid, self.pose
        one = self.mode[0]
        flat = solid.flats[one.flat]
        t1, t2 = flat.tangents
        n, mu = flat.normal, flat.friction
        first, second = vec.transposed_times(pose.rows, t1), vec.transposed_times(pose.rows, t2)
        up = vec.transposed_times(pose.rows, n)
        j = vec.times(solid.inertia, up)
        j1, j2, jn = vec.dot(j, first), vec.dot(j, second), vec.dot(j, up)
        v1, v2, spin = vec.dot(t1, pose.v), vec.dot(t2, pose.v), vec.dot(pose.w, n)
        high = vec.dot(n, pose.position) - flat.level
        numbers, begin, e = self.numbers, 4 * self.count, SLIDING_DIRECTION_SPEED
        s12 = s13 = s22 = s23 = s33 = 0.0
        for i in range(self.count):
            one = self.mode[i]
            corner = solid.corner(one.corner)
            s, t = vec.dot(corner, first), vec.dot(corner, second)
            u, v = v1 - spin * t, v2 + spin * s
            if one.begins:
                u, v = vec.dot(one.towards, t1), vec.dot(one.towards, t2)
            elif abs(u) + abs(v) < _DIRECTION_SURE:
                u, v = u + e * vec.dot(one.towards, t1), v + e * vec.dot(one.towards, t2)
            speed = math.sqrt(u * u + v * v)
            if speed > 0.0:
                u, v = u / speed, v / speed
            twist = mu * (s * v - t * u)
            two = t - mu * high * v + j1 / jn * twist
            three = -s + mu * high * u + j2 / jn * twist
            k = begin + 5 * i
            numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3], numbers[k + 4] = (
                u,
                v,
                two,
                three,
                twist,
            )
            s12, s13, s22 = s12 + two, s13 + three, s22 + two * two
            s23, s33 = s23 + two * three, s33 + three * three
        # The multipliers of the three equations for the least normal forces.
        s11 = float(self.count)
        A, B, C = s22 * s33 - s23 * s23, s13 * s23 - s12 * s33, s12 * s23 - s13 * s22
        det = s11 * A + s12 * B + s13 * C
        if not det > SAME_FORCES * s11 * s22 * s33:
            return False
        D, E, F = s11 * s33 - s13 * s13, s12 * s13 - s11 * s23, s11 * s22 - s12 * s12
        x, y2, z = -solid.mass * vec.dot(n, solid.gravity), -spin * spin * j2, spin * spin * j1
        k1, k2, k3 = (
            (A * x + B * y2 + C * z) / det,
            (B * x + D * y2 + E * z) / det,
            (C * x + E * y2 + F * z) / det,
        )
        turn = f1 = f2 = 0.0
        for i in range(self.count):
            k = begin + 5 * i
            f = k1 + k2 * numbers[k + 2] + k3 * numbers[k + 3]
            turn -= f * numbers[k + 4]
            u, v = -mu * f * numbers[k], -mu * f * numbers[k + 1]
            f1, f2 = f1 + u, f2 + v
            self.set_force(
                i,
                f * n[0] + u * t1[0] + v * t2[0],
                f * n[1] + u * t1[1] + v * t2[1],
                f * n[2] + u * t1[2] + v * t2[2],
            )
        a1, a2 = vec.dot(t1, solid.gravity) + f1 / solid.mass, vec.dot(t2, solid.gravity) + f2 / solid.mass
        turn /= jn
        a = (a1 * t1[0] + a2 * t2[0], a1 * t1[1] + a2 * t2[1], a1 * t1[2] + a2 * t2[2])
        self._set_rates(y, a, (turn * n[0], turn * n[1], turn * n[2]))
        return True

    # Forces that are not the only ones with the mode

    def _tips(self) -> bool:
        """Return whether the body tips over two of three contacts, whichever forces have the motion's effect.

        A turn about the line through two contacts moves the third one alone. All such forces have the same
        power on it, and where the third contact rises, no force in its cone has a negative one.
        """
        if self.count != 3:
            return False
        arms = [self.pose.arm(one.flat, one.corner) for one in self.mode]
        for k in range(3):
            a, b, c = arms[k], arms[(k + 1) % 3], arms[(k + 2) % 3]
            turn, arm = (c[0] - b[0], c[1] - b[1], c[2] - b[2]), (a[0] - b[0], a[1] - b[1], a[2] - b[2])
            flat, moved = self.solid.flats[self.mode[k].flat], vec.cross(turn, arm)
            if vec.dot(moved, flat.normal) < 0.0:
                moved = vec.opposite(moved)
            rise, aside = vec.dot(moved, flat.normal), vec.norm(vec.without(moved, flat.normal))
            least = -force_rounding(self.solid) * vec.norm(moved)
            if rise > flat.holding() * aside and vec.dot(moved, self.force(k)) < least:
                return True
        return False

    def _bring_within_cones(self) -> None:
        """Take forces with the same motion that press, and that friction allows, if there are any."""
        pose, axes, frictions, effects = self.pose, [], [], []
        for one in self.mode:
            flat, arm = self.solid.flats[one.flat], pose.arm(one.flat, one.corner)
            n, mu = flat.normal, flat.friction
            d = one.towards if one.begins else pose.sliding(arm, n, one.towards)
            axes.append((n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2]) if one.slides else n)
            frictions.append(0.0 if one.slides else flat.holding())
            x, y, z = [each / self.solid.reach for each in arm]
            effects.append([[1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -z, y], [z, 0, -x], [-y, x, 0]])
        each, forces = np.array(effects, dtype=float).transpose(1, 0, 2).reshape(6, -1), np.array(self.forces)
        target = each @ forces.ravel()
        if all(frictions):
            # Where contacts that press more take more of the friction, it is mostly enough.
            presses = np.repeat(np.maximum((forces * axes).sum(axis=1), 0.0), 3)
            found = presses * np.linalg.lstsq(each * presses, target, rcond=SAME_FORCES)[0]
            if np.abs(each @ found - target).max() <= ROUND_CONE_HELD * np.abs(target).max():
                self._set_forces(found.reshape(-1, 3).tolist())
                if self.least_left() >= 0.0:
                    return
                self._set_forces(forces.tolist())
        held = summed_by_round_cones(each, target, np.array(axes), np.array(frictions)).forces
        if held is not None:
            self._set_forces(held.tolist())

    def _set_forces(self, forces: list[list[float]]) -> None:
        for i, (x, y, z) in enumerate(forces):
            self.set_force(i, x, y, z)

    def _share_between_two(self) -> bool:
        """Share forces between two contacts that stick, without a change of the motion.

        Return whether they do. Then no other forces do better, unless they differ by more than what acts
        along the line between the contacts.
        """
        one, other = self.mode[0], self.mode[1]
        if one.slides or other.slides:
            return False
        if one.flat == other.flat:
            self._share_along_edge()
        else:
            self._squeeze()
        return True

    def _share_along_edge(self) -> None:
        """Have two contacts that stick share what acts along their edge.

        How much of it each of the two takes is open. Each takes what its friction can still hold, so that the
        edge sticks as long as any sharing lets it.
        """
        one, other = self.mode[0], self.mode[1]
        flat = self.solid.flats[one.flat]
        first, second = self.pose.arm(one.flat, one.corner), self.pose.arm(other.flat, other.corner)
        edge = vec.normalised((second[0] - first[0], second[1] - first[1], second[2] - first[2]))
        f, g = self.force(0), self.force(1)
        along, along_other = vec.dot(f, edge), vec.dot(g, edge)
        room = _room_along(f, flat.normal, along, flat.holding())
        room_other = _room_along(g, flat.normal, along_other, flat.holding())
        total, left = along + along_other, room + room_other
        if left == 0.0:
            return
        more = total * room / left - along
        self.set_force(0, f[0] + more * edge[0], f[1] + more * edge[1], f[2] + more * edge[2])
        more = total * room_other / left - along_other
        self.set_force(1, g[0] + more * edge[0], g[1] + more * edge[1], g[2] + more * edge[2])

    def _squeeze(self) -> None:
        """Have two contacts that stick squeeze the body between flats.

        By how much they do so is open. It is the least by which friction holds both, or zero if none does. It
        is along the line between the two contacts. A corner in a groove, which touches both flats itself, is
        pressed against both by what is along the difference of their normals.
        """
        one, other = self.mode[0], self.mode[1]
        flat, flat_other = self.solid.flats[one.flat], self.solid.flats[other.flat]
        a, b = self.pose.arm(one.flat, one.corner), self.pose.arm(other.flat, other.corner)
        if a == b:
            a, b = flat.normal, flat_other.normal
        line = vec.normalised((a[0] - b[0], a[1] - b[1], a[2] - b[2]))
        if line == (0.0, 0.0, 0.0):  # the flats are the same
            return
        f, g = self.force(0), self.force(1)
        low, high = _within_cone(f, line, flat.normal, flat.holding())
        low_other, high_other = _within_cone(
            g, (-line[0], -line[1], -line[2]), flat_other.normal, flat_other.holding()
        )
        least, most = max(low, low_other), min(high, high_other)
        gap = least - most
        if gap == _INFINITE or gap > FORCE_ROUNDING * (abs(least) + abs(most)):
            return
        more = min(max(0.0, least), most)
        self.set_force(0, f[0] + more * line[0], f[1] + more * line[1], f[2] + more * line[2])
        self.set_force(1, g[0] - more * line[0], g[1] - more * line[1], g[2] - more * line[2])

    # Contacts stay where they are

    def aim(self, y: Numbers) -> None:
        """Hold contacts from now on at the heights at which they are, but not below the flats.

        What touches may be a micrometre high. To bring it down would press others into their flats.
        """
        self.pose.take(y)
        for i in range(self.count):
            one = self.mode[i]
            self.numbers[3 * self.count + i] = max(self.pose.height(one.flat, one.corner), 0.0)

    def aim_as(self, other: HeldContacts) -> None:
        """Hold contacts at the heights at which the same contacts of another mode are held."""
        for i in range(self.count):
            self.numbers[3 * self.count + i] = other.numbers[3 * self.count + i]

    def hold(self, y: Numbers) -> None:
        """Change a state such that its quaternion is unit, and contacts do not leave, and stick or slide."""
        solid, pose, equations = self.solid, self.pose, self.equations
        normalise(y)
        pose.take(y)
        per_mass, largest = 1.0 / solid.mass, 0.0
        equations.count = 0
        for i in range(self.count):
            one = self.mode[i]
            flat = solid.flats[one.flat]
            off = pose.height(one.flat, one.corner) - self.numbers[3 * self.count + i]
            largest = max(largest, abs(off))
            equations.add(pose, pose.arm(one.flat, one.corner), flat.normal, flat.normal, off)
        if largest > HELD_DRIFT:
            equations.solve(per_mass)
            move_back(y, equations, per_mass)
            pose.take(y)
        equations.count, largest = 0, 0.0
        for i in range(self.count):
            one = self.mode[i]
            flat, arm = solid.flats[one.flat], pose.arm(one.flat, one.corner)
            velocity = pose.velocity(arm)
            n = flat.normal
            t1, t2 = flat.tangents
            speed = vec.dot(velocity, n)
            largest = max(largest, abs(speed))
            equations.add(pose, arm, n, n, speed)
            if not one.slides:
                u, v = vec.dot(velocity, t1), vec.dot(velocity, t2)
                largest = max(largest, abs(u), abs(v))
                equations.add(pose, arm, t1, t1, u)
                equations.add(pose, arm, t2, t2, v)
        if largest > HELD_DRIFT:
            equations.solve(per_mass)
            slow_down(y, equations, per_mass)
            pose.take(y)


def _room_along(force: Vector3, n: Vector3, along: float, friction: float) -> float:
    """Return how much force, N, friction can hold along an edge, where a force has a part along it."""
    pressing = vec.dot(force, n)
    if pressing <= 0.0:
        return 0.0
    across = vec.dot(force, force) - pressing * pressing - along * along
    held = friction * pressing
    return math.sqrt(max(held * held - across, 0.0))


def _within_cone(force: Vector3, u: Vector3, n: Vector3, friction: float) -> tuple[float, float]:
    """Return between which multiples of a unit vector ``u`` a force, N, is in a friction cone with them."""
    p, q = vec.dot(force, n), vec.dot(u, n)
    across, sideways = vec.without(force, n), vec.without(u, n)
    mu2 = friction * friction
    a = mu2 * q * q - vec.dot(sideways, sideways)
    b = mu2 * p * q - vec.dot(across, sideways)
    c = mu2 * p * p - vec.dot(across, across)
    root = math.sqrt(max(b * b - a * c, 0.0))
    if a > 0.0:  # the line goes on into the cone for ever
        if q > 0.0:
            return ((root - b) / a, _INFINITE)
        return (-_INFINITE, (-root - b) / a)
    if a == 0.0 or b * b < a * c * (1.0 - FORCE_ROUNDING) or p - q * b / a < 0.0:
        return (_INFINITE, -_INFINITE)
    return ((root - b) / a, (-root - b) / a)


def force_rounding(solid: Solid) -> float:
    """Return the force, N, by which a contact may pull and still stay."""
    return FORCE_ROUNDING * solid.mass * (1.0 + vec.norm(solid.gravity))


def normalise(y: Numbers) -> None:
    """Make the quaternion of a state unit."""
    scale = 1.0 / math.sqrt(y[3] * y[3] + y[4] * y[4] + y[5] * y[5] + y[6] * y[6])
    y[3], y[4], y[5], y[6] = scale * y[3], scale * y[4], scale * y[5], scale * y[6]


def slow_down(y: Numbers, equations: Equations, per_mass: float) -> None:
    """Take the solution of equations from the velocities of a state."""
    v = equations.summed((0.0, 0.0, 0.0), _FORCE, per_mass)
    w = equations.summed((0.0, 0.0, 0.0), _TURNING, 1.0)
    y[7], y[8], y[9] = y[7] - v[0], y[8] - v[1], y[9] - v[2]
    y[10], y[11], y[12] = y[10] - w[0], y[11] - w[1], y[12] - w[2]


def move_back(y: Numbers, equations: Equations, per_mass: float) -> None:
    """Move a state back by the small shift and turn that solve equations."""
    shift = equations.summed((0.0, 0.0, 0.0), _FORCE, per_mass)
    turn = equations.summed((0.0, 0.0, 0.0), _TURNING, 1.0)
    x, yy, z = -0.5 * turn[0], -0.5 * turn[1], -0.5 * turn[2]
    scale = 1.0 / math.sqrt(x * x + yy * yy + z * z + 1.0)
    p_x, p_y, p_z = scale * x, scale * yy, scale * z
    q_x, q_y, q_z, q_w = y[3], y[4], y[5], y[6]
    y[0], y[1], y[2] = y[0] - shift[0], y[1] - shift[1], y[2] - shift[2]
    y[3] = scale * q_x + p_x * q_w + p_y * q_z - p_z * q_y
    y[4] = scale * q_y - p_x * q_z + p_y * q_w + p_z * q_x
    y[5] = scale * q_z + p_x * q_y - p_y * q_x + p_z * q_w
    y[6] = scale * q_w - p_x * q_x - p_y * q_y - p_z * q_z


def _lift(solid: Solid, above: Above, y: Numbers) -> None:
    per_mass = 1.0 / solid.mass
    normalise(y)
    pose = Pose(solid)
    pose.take(y)
    near = [k for k in range(above.count) if above.heights[k] <= DISTANCE_TOLERANCE]
    equations = Equations(len(near))
    for k in near:
        flat, corner = k // solid.count, k % solid.count
        normal = solid.flats[flat].normal
        equations.add(pose, pose.arm(flat, corner), normal, normal, above.heights[k])
    equations.respond(per_mass)
    n = equations.count
    lift = [0.0] * n
    for _ in range(_MAX_SWEEPS):
        least = 0.0
        for i in range(n):
            now = equations.table[_WIDTH * i + _WANTED]
            for j in range(n):
                now += equations.matrix[n * i + j] * lift[j]
            least = min(least, now if lift[i] == 0.0 else -abs(now))
            lift[i] = max(lift[i] - now / equations.matrix[n * i + i], 0.0)
        if least >= -HELD_DRIFT:
            break
    for i in range(n):
        equations.table[_WIDTH * i + _SIZE] = -lift[i]
    move_back(y, equations, per_mass)


# With states as lists, for callers that are not compiled


def pushed_by_contacts(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> HeldContacts:
    """Return held contacts with the rates of a state and the forces in it."""
    held = HeldContacts(solid, mode)
    for k in range(13):
        held.y[k] = y[k]
    held.push(held.y)
    return held


def held_in_place(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> Numbers:
    """Return a state with a unit quaternion whose held contacts touch, and stick or slide."""
    held = HeldContacts(solid, mode)
    for k in range(13):
        held.y[k] = y[k]
    held.hold(held.y)
    return [held.y[k] for k in range(13)]


def held_as_they_are(solid: Solid, y: Numbers, mode: tuple[Held, ...]) -> Numbers:
    """Return a state with a unit quaternion whose held contacts stay where they are, and stick or slide."""
    held = HeldContacts(solid, mode)
    for k in range(13):
        held.y[k] = y[k]
    held.aim(held.y)
    held.hold(held.y)
    return [held.y[k] for k in range(13)]


def out_of_flats(solid: Solid, y: Numbers, above: Above | None = None) -> Numbers:
    """Return a state with the least change of place and attitude after which no corner is below a flat.

    Heights are computed ``above``, or where the solid has them.
    """
    if above is None:
        above = solid.above
    for k in range(13):
        above.y[k] = y[k]
    above.take(solid, above.y)
    if above.least < -SUNK:
        _lift(solid, above, above.y)
    return [above.y[k] for k in range(13)]


def without_rebounds(solid: Solid, y: Numbers, touching: list[Touch]) -> Numbers:
    """Return a state whose contacts lose what is left of their rebounds, and the friction that came with it.

    The impulses are those of the strikes, the other way round: along the normal less friction where a contact
    slides, and such that it goes on to stick where it sticks. So the contact has had the impulse of a strike
    without restitution, and friction from then on is that of a contact that stays.
    """
    pose, equations = Pose(solid), Equations(3 * len(touching))
    for k in range(13):
        pose.y[k] = y[k]
    pose.take(pose.y)
    for s, corner in touching:
        flat, arm = solid.flats[s], pose.arm(s, corner)
        n, velocity = flat.normal, pose.velocity(arm)
        sliding = vec.without(velocity, n)
        if vec.norm(sliding) > SLIDING_STOPPED:
            d, mu = vec.normalised(sliding), flat.friction
            force = (n[0] - mu * d[0], n[1] - mu * d[1], n[2] - mu * d[2])
            equations.add(pose, arm, n, force, vec.dot(velocity, n))
        else:
            t1, t2 = flat.tangents
            equations.add(pose, arm, n, n, vec.dot(velocity, n))
            equations.add(pose, arm, t1, t1, vec.dot(velocity, t1))
            equations.add(pose, arm, t2, t2, vec.dot(velocity, t2))
    per_mass = 1.0 / solid.mass
    equations.solve(per_mass)
    slow_down(pose.y, equations, per_mass)
    return [pose.y[k] for k in range(13)]
