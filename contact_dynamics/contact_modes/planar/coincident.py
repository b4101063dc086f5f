# SPDX-License-Identifier: Apache-2.0
"""Contacts that coincide are answered as one, such as those of a body's two sides in a plane of motion.

Contacts coincide if their places and normals agree within `SAME_ROWS`, and they have the same friction and
the same curvatures. They have the same letter in every mode. Mechanics determines only the sum of their
forces, and the answer gives each of them an equal share.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from contact_dynamics.contact_modes.result import PlanarMode, RefusedMode
from contact_dynamics.tolerances import SAME_ROWS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.plane.types import PlanarContact, Vector2


class Coincident(NamedTuple):
    """The groups of contacts that coincide."""

    firsts: list[int]  # the index of the first contact of each group
    group: list[int]  # the index of each contact's group
    counts: list[int]  # the number of contacts in each group

    def letters_of_all(self, mode: str) -> str:
        """Return the letters of all contacts for a mode with one letter for each group."""
        return "".join([mode[group] for group in self.group])

    def consistent(self, mode: PlanarMode, negligible: float) -> PlanarMode:
        """Return a mode of all contacts for one of the groups.

        Normal forces up to ``negligible``, N, count as none.
        """
        counts = self.counts
        shares: list[Vector2] = [
            (f_t / count, f_n / count) for (f_t, f_n), count in zip(mode.contact_forces, counts, strict=True)
        ]
        shared = any(
            count > 1 and f_n > negligible
            for (_, f_n), count in zip(mode.contact_forces, counts, strict=True)
        )
        return PlanarMode(
            mode=self.letters_of_all(mode.mode),
            acceleration=mode.acceleration,
            angular_acceleration=mode.angular_acceleration,
            contact_forces=tuple([shares[group] for group in self.group]),
            contact_accelerations=tuple([mode.contact_accelerations[group] for group in self.group]),
            forces_unique=mode.forces_unique and not shared,
            motion_unique=mode.motion_unique,
        )

    def refused(self, mode: RefusedMode) -> RefusedMode:
        """Return a refused mode of all contacts for a refused mode of the groups."""
        contact = mode.contact if mode.contact < 0 else self.firsts[mode.contact]
        letters = self.letters_of_all(mode.mode)
        return RefusedMode(mode=letters, refusal=mode.refusal, contact=contact, amount=mode.amount)


def coincident(
    contacts: Sequence[PlanarContact], velocities: Sequence[Vector2], rho: float
) -> Coincident | None:
    """Return the groups of contacts that coincide, or None if all contacts differ.

    Two contacts also belong together if a chain of contacts leads from one to the other in which neighbours
    coincide. So the order in which contacts are listed does not matter. Of the velocities (v_t, v_n), only
    the signs count.
    """
    pairs = _same_pairs(contacts, velocities, rho)
    if not pairs:
        return None
    leaders = list(range(len(contacts)))
    for one, other in pairs:
        low, high = sorted((_leader(leaders, one), _leader(leaders, other)))
        leaders[high] = low
    firsts: list[int] = []
    group: list[int] = []
    counts: list[int] = []
    for index in range(len(contacts)):
        leader = _leader(leaders, index)
        if leader == index:
            firsts.append(index)
            counts.append(0)
            group.append(len(firsts) - 1)
        else:
            group.append(group[leader])
        counts[group[-1]] += 1
    return Coincident(firsts, group, counts)


def _same_pairs(
    contacts: Sequence[PlanarContact], velocities: Sequence[Vector2], rho: float
) -> list[tuple[int, int]]:
    """Return pairs of contacts that coincide. They are enough to connect each group."""
    # Contacts that agree in every coordinate also agree in a weighted sum of them, and few others do.
    far = max(rho, *(abs(x) + abs(y) for x, y in (contact.r for contact in contacts)))
    sums = sorted(
        [
            (
                0.61 * contact.r[0]
                + 0.79 * contact.r[1]
                + far * (contact.normal[0] + 0.37 * contact.normal[1]),
                i,
            )
            for i, contact in enumerate(contacts)
        ]
    )
    window = 6.0 * SAME_ROWS * far
    pairs = []
    for k, (value, i) in enumerate(sums):
        for other, j in sums[k + 1 :]:
            if other - value > window:
                break
            if _same(contacts[i], contacts[j], rho) and _alike(velocities[i], velocities[j]):
                pairs.append((i, j))
                if contacts[i].r == contacts[j].r and contacts[i].normal == contacts[j].normal:
                    break  # whatever coincides with contact i coincides with contact j, and is found there
    return pairs


def _same(one: PlanarContact, other: PlanarContact, rho: float) -> bool:
    (x, y), (n_x, n_y) = one.r, one.normal
    (u, v), (m_x, m_y) = other.r, other.normal
    reach = SAME_ROWS * max(rho, abs(x), abs(y))
    return (
        abs(x - u) <= reach
        and abs(y - v) <= reach
        and abs(n_x - m_x) <= SAME_ROWS
        and abs(n_y - m_y) <= SAME_ROWS
        and one.friction == other.friction
        and one.body_curvature == other.body_curvature
        and one.surface_curvature == other.surface_curvature
    )


def _alike(one: Vector2, other: Vector2) -> bool:
    (v_t, v_n), (u_t, u_n) = one, other
    return (v_t > 0.0) == (u_t > 0.0) and (v_t < 0.0) == (u_t < 0.0) and (v_n > 0.0) == (u_n > 0.0)


def _leader(leaders: list[int], index: int) -> int:
    while leaders[index] != index:
        leaders[index] = index = leaders[leaders[index]]
    return index
