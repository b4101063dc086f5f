# SPDX-License-Identifier: Apache-2.0
"""Which ways contacts in space can stick and slide together, whatever the forces.

A few lines through each contact cut its tangent plane, so that a contact slides in a sector between two
lines, or along one. The lines define planes in the space of accelerations of a body at rest. Together with
the conditions that no contact penetrates, they cut this space into the faces of a hyperplane arrangement, and
each face is a mode (Huang, Cheng and Mason, Efficient Contact Mode Enumeration in 3D, 2020). A face is found
by its signs. They are composed from those of the arrangement's rays, where the first ray that does not lie in
a plane decides the sign for that plane (the covectors of an oriented matroid).

`spatial.answer` says which of these are consistent with mechanics. Bodies that move are not covered.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes.letters import SEPARATES, STICKS
from contact_dynamics.contact_modes.spatial.kinematic import cone_faces
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.linear_spaces import null_space
from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.tolerances import ROW_TOLERANCE, SMALLEST
from contact_dynamics.validation import check_magnitude, check_whole

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.validation import FloatArray

MAX_SLIDING_CONTACTS: Final = 8
"""The longest list of contacts that is accepted. Eight in general position have tens of thousands of
modes."""

MAX_PLANES: Final = 4
"""The largest number of lines through a contact."""

_WAYS: Final = "0123456789ABCDEF"


def spatial_sliding_modes(contacts: ContactSet, *, planes: int = 2) -> tuple[str, ...]:
    """Return every mode that some acceleration of a body at rest realises, in alphabetical order.

    A mode has one letter for each contact: `s` if it separates, `f` if it sticks, and otherwise an upper-case
    hexadecimal digit for the direction in which it slides. The angles are those of the frame of
    `numerics.vectors.tangents_towards`: the even digit 2 k is the direction of a line, at k pi / planes, and
    the odd digit 2 k + 1 is the sector between this line and the next.

    Args:
        contacts: At most `MAX_SLIDING_CONTACTS`.
        planes: The number of lines through each contact, from 2 to `MAX_PLANES`. They are the borders of the
            sectors of a friction pyramid with twice as many edges.

    Raises:
        InvalidFieldError: too few or too many planes.
        TooLargeError: more than `MAX_SLIDING_CONTACTS` contacts.
    """
    n = len(contacts)
    planes = check_whole("planes", planes, 2, MAX_PLANES)
    if n > MAX_SLIDING_CONTACTS:
        raise TooLargeError("contacts", f"{n} contacts", f"at most {MAX_SLIDING_CONTACTS}")
    if n == 0:
        return ("",)
    check_magnitude("p_WC_W", contacts.p_WC_W)
    arms = contacts.p_WC_W - contacts.p_WC_W.mean(axis=0)
    arms = arms / max(float(np.linalg.norm(arms, axis=1).max()), SMALLEST)
    normals = _rows(contacts.normals_W, arms)
    across = []  # normals of the planes, within the tangent plane: quarter a turn from each line
    for normal, arm in zip(contacts.normals_W, arms, strict=True):
        one, two = tangents_towards(normal)
        turns = [math.pi * k / planes + 0.5 * math.pi for k in range(planes)]
        ways = np.array([math.cos(turn) * one + math.sin(turn) * two for turn in turns])
        across.append(_rows(ways, np.tile(arm, (planes, 1))))
    found = []
    unit = normals / np.linalg.norm(normals, axis=1)[:, None]
    for face in cone_faces(unit):
        stay = [i for i in range(n) if face >> i & 1]
        leave = [i for i in range(n) if not face >> i & 1]
        free = null_space(unit[stay])
        cut = np.vstack([np.zeros((0, 6)), *(across[i] for i in stay)]) @ free
        for signs in open_faces(unit[leave] @ free, cut):
            letters = [SEPARATES] * n
            for position, i in enumerate(stay):
                letters[i] = _letter(signs[position * planes : (position + 1) * planes])
            found.append("".join(letters))
    return tuple(sorted(found))


def _rows(ways: FloatArray, arms: FloatArray) -> FloatArray:
    """Return accelerations along ``ways`` at ``arms`` as functions of (a, alpha), (k, 6)."""
    return np.hstack([ways, np.cross(arms, ways)])


def _letter(signs: list[int]) -> str:
    """Return how a contact slides, from the side of each of its lines that it slides to."""
    count = len(signs)
    if not any(signs):
        return STICKS
    # From line k on its side is +, or 0 along it, and the next ones' are -; half a turn on, lines come again.
    around = [signs[j % count] * (-1) ** (j // count) for j in range(3 * count)]
    k = next(k for k in range(2 * count) if around[k] >= 0 and max(around[k + 1 : k + count]) < 0)
    return _WAYS[2 * k + around[k]]


def open_faces(above: FloatArray, cut: FloatArray) -> list[list[int]]:
    """Return the signs of ``cut`` on every face of their arrangement where all of ``above`` are positive."""
    rows = np.vstack([above, cut])
    sizes = np.linalg.norm(rows, axis=1)
    rows = rows / np.where(sizes > ROW_TOLERANCE, sizes, 1.0)[:, None]
    rows[sizes <= ROW_TOLERANCE] = 0.0
    spread, basis = np.linalg.svd(rows)[1:] if rows.size else (np.zeros(0), rows)
    rows = rows @ basis[: int((spread > ROW_TOLERANCE).sum())].T
    wanted = (1 << len(above)) - 1
    rays = []
    for heights in _rays(rows) @ rows.T:
        plus = sum(1 << int(k) for k in np.flatnonzero(heights > 10.0 * ROW_TOLERANCE))
        minus = sum(1 << int(k) for k in np.flatnonzero(heights < -10.0 * ROW_TOLERANCE))
        if not minus & wanted:
            rays.append((plus, minus))
    rays = sorted(set(rays))
    faces = {(0, 0)}
    newest = [(0, 0)]
    while newest:
        composed = {(plus | (p & ~minus), minus | (m & ~plus)) for plus, minus in newest for p, m in rays}
        newest = list(composed - faces)
        faces |= composed
    return [
        [(plus >> k & 1) - (minus >> k & 1) for k in range(len(above), len(rows))]
        for plus, minus in faces
        if plus & wanted == wanted
    ]


def _rays(rows: FloatArray) -> FloatArray:
    """Return the rays, (k, d), on which some d - 1 independent rows vanish, both ways."""
    d = rows.shape[1]
    distinct: list[FloatArray] = []
    for row in rows:
        if np.any(row) and all(abs(abs(float(row @ other)) - 1.0) > ROW_TOLERANCE**1.5 for other in distinct):
            distinct.append(row)
    if d <= 1:
        return np.array([[1.0], [-1.0]])[:, :d] if d else np.zeros((0, 0))
    chosen = np.array(list(itertools.combinations(distinct, d - 1))).reshape(-1, d - 1, d)
    spread, basis = np.linalg.svd(chosen)[1:]
    rays = basis[spread[:, -1] > ROW_TOLERANCE, -1]
    return np.vstack([rays, -rays])
