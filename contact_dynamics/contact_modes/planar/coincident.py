"""Contacts that coincide are answered as one, such as those of a body's two sides in a plane of motion.

Contacts of one place, normal, friction and kind have the same letter in every mode. Only the sum of their
forces is known. Each gets an equal share.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.contact_modes.planar.result import PlanarMode
from contact_dynamics.contact_modes.result import RefusedMode

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.plane.types import PlanarContact, Vector2

_STEPS: Final = 1e12
"""Places, in radii of gyration, and normals that agree to so many steps are one: some thousand roundings, and
a thousandth of what the enumeration tells apart (`ROW_TOLERANCE`)."""


class Coincident(NamedTuple):
    """Which contacts are the same.

    Attributes:
        firsts: The first contact of each group.
        group: The group of each contact.
        counts: Contacts of each group.
    """

    firsts: list[int]
    group: list[int]
    counts: list[int]

    def letters_of_all(self, mode: str) -> str:
        """Return the letters of all contacts from those of the groups."""
        return "".join([mode[group] for group in self.group])

    def consistent(self, mode: PlanarMode, negligible: float) -> PlanarMode:
        """Return a mode of the groups as one of all contacts; a force of up to ``negligible``, N, is none."""
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
        """Return a refused mode of the groups as one of all contacts."""
        contact = mode.contact if mode.contact < 0 else self.firsts[mode.contact]
        letters = self.letters_of_all(mode.mode)
        return RefusedMode(mode=letters, refusal=mode.refusal, contact=contact, amount=mode.amount)


def coincident(
    contacts: Sequence[PlanarContact], velocities: Sequence[Vector2], rho: float
) -> Coincident | None:
    """Return which contacts of a body of radius of gyration ``rho``, m, are the same; None: all differ.

    ``velocities``, (v_t, v_n), count by their signs.
    """
    scale = _STEPS / rho
    groups: dict[tuple[float, ...], int] = {}
    firsts: list[int] = []
    group: list[int] = []
    for index, (contact, (v_t, v_n)) in enumerate(zip(contacts, velocities, strict=True)):
        (x, y), (n_x, n_y) = contact.r, contact.normal
        key = (
            (x * scale + 0.5) // 1.0,
            (y * scale + 0.5) // 1.0,
            (n_x * _STEPS + 0.5) // 1.0,
            (n_y * _STEPS + 0.5) // 1.0,
            contact.friction,
            contact.body_curvature,
            contact.surface_curvature,
            (v_t > 0.0) - (v_t < 0.0),
            v_n > 0.0,
        )
        found = groups.setdefault(key, len(firsts))
        if found == len(firsts):
            firsts.append(index)
        group.append(found)
    if len(firsts) == len(contacts):
        return None
    counts = [0] * len(firsts)
    for found in group:
        counts[found] += 1
    return Coincident(firsts, group, counts)
