# SPDX-License-Identifier: Apache-2.0
"""Planar contact cases in rational numbers, many degenerate on purpose, and their rounding to floats."""

from __future__ import annotations

import math
import random
from dataclasses import replace
from fractions import Fraction

from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from oracles.contact_modes import ExactCase, ExactContact

STYLES = ("grid", "flush", "random", "turning", "sliding")

_AXIS_NORMALS = ((0, 1), (1, 0), (0, -1), (-1, 0))
_NORMALS = [(Fraction(x), Fraction(y)) for x, y in _AXIS_NORMALS] + [
    (Fraction(3, 5), Fraction(4, 5)),
    (Fraction(-3, 5), Fraction(4, 5)),
    (Fraction(4, 5), Fraction(-3, 5)),
    (Fraction(-5, 13), Fraction(12, 13)),
]
_FRICTIONS = [Fraction(0), Fraction(1, 3), Fraction(1, 2), Fraction(1), Fraction(2)]


def contact(x: float, y: float, normal: tuple[int, int] = (0, 1), friction: str = "1/2") -> ExactContact:
    """Return a contact with whole coordinates and an axis or 3-4-5 normal given as whole numbers."""
    length = math.isqrt(normal[0] ** 2 + normal[1] ** 2)
    return ExactContact(
        (Fraction(x), Fraction(y)),
        (Fraction(normal[0], length), Fraction(normal[1], length)),
        Fraction(friction),
    )


def with_static_friction(case: ExactCase, seed: int) -> ExactCase:
    """Return the case with static friction that is larger at most contacts, by a third to three."""
    chance = random.Random(seed)
    contacts = [
        replace(one, static=one.friction + Fraction(chance.choice((0, 1, 2, 4, 9)), 3))
        for one in case.contacts
    ]
    return replace(case, contacts=tuple(contacts))


def resting(*contacts: ExactContact, force: tuple[int, int] = (0, -1), moment: int = 0) -> ExactCase:
    """Return a body of unit mass and inertia at rest."""
    one, zero = Fraction(1), Fraction(0)
    return ExactCase(
        one, one, (zero, zero), zero, contacts, (Fraction(force[0]), Fraction(force[1])), Fraction(moment)
    )


def draw(seed: int, most_contacts: int) -> ExactCase:
    """Return a case in which no contact approaches; the seed decides style, numbers and degeneracy."""
    chance = random.Random(seed)
    while True:
        case = _draw(chance, chance.choice(STYLES), chance.randint(1, most_contacts))
        if all(case.contact_velocity(one)[1] >= 0 for one in case.contacts):
            return case


def _draw(chance: random.Random, style: str, count: int) -> ExactCase:
    def whole(size: int = 3) -> Fraction:
        return Fraction(chance.randint(-size, size))

    spin, v = Fraction(0), (Fraction(0), Fraction(0))
    places = []
    if style == "grid":  # coincident points, equal and opposite normals
        places = [((whole(2), whole(2)), chance.choice(_NORMALS)) for _ in range(count)]
    elif style == "flush":  # a row of feet, and something else
        height = whole(2)
        for _ in range(count):
            foot = (whole(4), height), _NORMALS[0]
            places.append(foot if chance.random() < 0.75 else ((whole(2), whole(2)), chance.choice(_NORMALS)))
    elif style == "random":
        for _ in range(count):
            point = (Fraction(chance.randint(-99, 99), 37), Fraction(chance.randint(-99, 99), 41))
            places.append((point, _unit(chance)))
    elif style == "turning":  # normals through the centre of rotation, or the contact at it
        c_x, c_y = whole(2), whole(2)
        spin = Fraction(chance.choice([-2, -1, 1, 2]), chance.choice([1, 3]))
        v = (spin * c_y, -spin * c_x)
        for _ in range(count):
            normal = chance.choice(_NORMALS) if chance.random() < 0.7 else _unit(chance)
            reach = whole(2)
            places.append(((c_x + reach * normal[0], c_y + reach * normal[1]), normal))
    else:  # sliding along parallel walls, at a speed that may be 0
        normal = chance.choice(_NORMALS) if chance.random() < 0.5 else _unit(chance)
        speed = whole(2)
        v = (speed * normal[1], -speed * normal[0])
        for _ in range(count):
            side = normal if chance.random() < 0.6 else (-normal[0], -normal[1])
            places.append(((whole(2), whole(2)), side))
    contacts = tuple(ExactContact(point, normal, chance.choice(_FRICTIONS)) for point, normal in places)
    mass = Fraction(chance.choice([1, 2, 3]))
    inertia = Fraction(chance.choice([1, 2, 5]), chance.choice([1, 3]))
    return ExactCase(mass, inertia, v, spin, contacts, (whole(), whole()), whole())


def _unit(chance: random.Random) -> tuple[Fraction, Fraction]:
    half = Fraction(chance.randint(-40, 40), chance.randint(1, 20))
    return (1 - half * half) / (1 + half * half), 2 * half / (1 + half * half)


FloatCase = tuple[PlanarBody, PlanarVelocity, list[PlanarContact], PlanarWrench]


def rounded(
    case: ExactCase, *, angle: float = 0.0, length: float = 1.0, mass: float = 1.0, time: float = 1.0
) -> FloatCase:
    """Return the case in floats, turned by ``angle`` and measured in other units."""
    c, s = math.cos(angle), math.sin(angle)

    def turned(vector: tuple[Fraction, Fraction], unit: float) -> tuple[float, float]:
        x, y = float(vector[0]), float(vector[1])
        return unit * (c * x - s * y), unit * (s * x + c * y)

    force = mass * length / time**2
    return (
        PlanarBody(mass=mass * float(case.mass), inertia=mass * length**2 * float(case.inertia)),
        PlanarVelocity(v=turned(case.v, length / time), w=float(case.w) / time),
        [
            PlanarContact(
                r=turned(one.r, length),
                normal=turned(one.normal, 1.0),
                friction=float(one.friction),
                static_friction=None if one.static is None else float(one.static),
            )
            for one in case.contacts
        ],
        PlanarWrench(f=turned(case.force, force), moment=force * length * float(case.moment)),
    )
