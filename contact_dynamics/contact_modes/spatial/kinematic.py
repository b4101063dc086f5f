# SPDX-License-Identifier: Apache-2.0
"""What contacts of a body in space can do together, whatever the forces: contact, separate, stick and slide.

Lecture 26's strings have `c` where a contact stays, whether it sticks or slides.

The accelerations (a, alpha) that do not penetrate form a polyhedral cone in R^6, and each mode is one of its
faces: the contacts that stay are the rows that vanish on the face. Extreme rays span every face, so its
contacts that stay are the intersection of the sets of its rays. The modes are therefore all intersections of
the sets of rays, which are kept as the bits of integers. The rays are the facets of the convex hull of the
rows, seen from an inner point (Huang, Cheng and Mason, Efficient Contact Mode Enumeration in 3D, 2020). The
time grows in proportion to the number of modes.

A body that turns adds centripetal terms, and curved contacts add those of their kind (`contact.curvature`).
The polyhedron is then the section at height one of a cone in R^7.

Other strings say which ways contacts stick and slide. A few lines through each contact cut its tangent plane,
so that a contact slides in a sector between two lines, or along one. The lines define planes in the space of
accelerations of a body at rest. Together with the conditions that no contact penetrates, they cut this space
into the faces of a hyperplane arrangement, and each face is a mode (Huang, Cheng and Mason, Efficient Contact
Mode Enumeration in 3D, 2020). A face is found by its signs. They are composed from those of the arrangement's
rays, where the first ray that does not lie in a plane decides the sign for that plane (the covectors of an
oriented matroid).

`spatial.answer` says which of these are consistent with mechanics.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.velocities import check_speeds, relative_velocities, velocity_accelerations
from contact_dynamics.contact_modes.letters import SEPARATES, STAYS, STICKS
from contact_dynamics.contact_modes.spatial.cone import cone_of
from contact_dynamics.errors import TooLargeError
from contact_dynamics.numerics.linear_spaces import null_space
from contact_dynamics.numerics.vectors import tangents_towards
from contact_dynamics.tolerances import (
    ACCELERATION_TOLERANCE,
    NEARLY_PARALLEL,
    ROW_TOLERANCE,
    SMALLEST,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import check_at_rest, check_magnitude, check_not_negative, check_whole

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray

MAX_SPATIAL_CONTACTS: Final = 64
"""The longest list of contacts that is accepted. A cone in R^6 can have n^2 rays, and more faces than
that."""


def spatial_kinematic_modes(
    state: BodyState, contacts: ContactSet, *, velocity_tolerance: float = VELOCITY_TOLERANCE
) -> tuple[str, ...]:
    """Return all combinations of closed and separating contacts that are kinematically possible, sorted.

    A mode has one letter for each contact, in the order of the contacts: `c` if it stays closed, `s` if it
    separates. The list is empty if a contact approaches, or if every acceleration penetrates.

    Args:
        state: State of the body, with its origin at the centre of mass.
        contacts: At most `MAX_SPATIAL_CONTACTS` contacts.
        velocity_tolerance: m/s, >= 0. Normal velocities of contacts up to this size count as zero, and so
            does an angular velocity that moves no contact relative to the centre of mass by more.

    Raises:
        InvalidFieldError: the tolerance is negative.
        TooLargeError: there are more than `MAX_SPATIAL_CONTACTS` contacts.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    n = len(contacts)
    if n > MAX_SPATIAL_CONTACTS:
        raise TooLargeError("contacts", f"{n} contacts", f"at most {MAX_SPATIAL_CONTACTS}")
    check_speeds(state, contacts.p_WC_W)
    velocities = relative_velocities(state, contacts)
    v_n = np.sum(contacts.normals_W * velocities, axis=1)
    if np.any(v_n < -tolerance):
        return ()
    touching = np.flatnonzero(v_n <= tolerance)
    if touching.size == 0:
        return (SEPARATES * n,)
    r_W = contacts.p_WC_W - state.p_WB_W
    reach = float(np.linalg.norm(r_W[touching], axis=1).max())
    rows = _rows(contacts.normals_W[touching], r_W[touching] / (reach if reach > 0.0 else 1.0))
    w_W = state.w_WB_W
    if float(np.linalg.norm(w_W)) * float(np.linalg.norm(r_W, axis=1).max()) <= tolerance:
        w_W = np.zeros(3)
    turning, rolling = np.cross(w_W, np.cross(w_W, r_W)), velocity_accelerations(contacts, velocities, w_W)
    offsets = np.sum(contacts.normals_W * (turning + rolling), axis=1)[touching]
    scale = float(np.abs(offsets).max())
    below = 0
    # Where a body rolls, the two cancel, and what remains is rounding.
    if scale > ACCELERATION_TOLERANCE * float(np.abs(turning).max() + np.abs(rolling).max()):
        below = 1 << touching.size
        rows = np.vstack(
            [np.column_stack([rows, offsets / scale]), np.eye(1, rows.shape[1] + 1, rows.shape[1])]
        )
    faces = cone_faces(rows / np.linalg.norm(rows, axis=1)[:, None])
    return tuple(sorted(_string(n, touching, face) for face in faces if not face & below))


def cone_faces(rows: FloatArray) -> set[int]:
    """Return the faces of {x : rows x >= 0} as the bit sets of the unit rows, (m, d), that vanish on them."""
    everything = (1 << len(rows)) - 1
    cone = cone_of(rows)
    implied = everything & ~_mask(cone.strict)
    if not cone.strict.any():
        return {everything}
    heights = np.abs(cone.rays @ cone.rows.T)
    positions = [1 << int(i) for i in np.flatnonzero(cone.strict)]
    faces = {everything}
    for vanishing in np.unique(heights <= 10.0 * ROW_TOLERANCE, axis=0):
        ray = implied | sum(bit for bit, zero in zip(positions, vanishing, strict=True) if zero)
        faces |= {face & ray for face in faces}
    return faces


def faces_in_space(rows: FloatArray) -> set[int] | None:
    """Return the same for rows, (m, 3), that span all directions, or None if some rows are nearly parallel.

    Extreme rays are across two rows each, so that neither an inner point nor a convex hull is needed.
    """
    unit = rows / np.sqrt((rows * rows).sum(axis=1))[:, None]
    rays = np.cross(unit[:, None], unit[None]).reshape(-1, 3)
    sizes = np.sqrt((rays * rays).sum(axis=1))
    apart = sizes > ROW_TOLERANCE
    if sizes[apart].min() < NEARLY_PARALLEL:
        return None
    heights = (rays[apart] / sizes[apart, None]) @ unit.T
    faces = {(1 << len(rows)) - 1}
    zero = np.abs(heights) <= ROW_TOLERANCE
    for vanishing in np.unique(zero[heights.min(axis=1) >= -ROW_TOLERANCE], axis=0):
        ray = _mask(vanishing)
        faces |= {face & ray for face in faces}
    return faces


def _mask(chosen: NDArray[np.bool_]) -> int:
    return sum(1 << int(i) for i in np.flatnonzero(chosen))


def _string(n: int, touching: NDArray[np.intp], face: int) -> str:
    letters = bytearray(SEPARATES.encode() * n)
    for position, contact in enumerate(touching.tolist()):
        if face >> position & 1:
            letters[contact] = ord(STAYS)
    return letters.decode()


MAX_SLIDING_CONTACTS: Final = 8
"""The longest list of contacts that is accepted. Eight in general position have tens of thousands of
modes."""

MAX_PLANES: Final = 4
"""The largest number of lines through a contact."""

_WAYS: Final = "0123456789ABCDEF"


def spatial_sliding_modes(contacts: ContactSet, *, planes: int = 2) -> tuple[str, ...]:
    """Return all kinematically possible modes of a body at rest, with sectors of sliding directions, sorted.

    A mode has one letter for each contact: `s` if it separates, `f` if it sticks, and otherwise an upper-case
    hexadecimal digit for its sliding direction. Angles are measured in the frame of
    `numerics.vectors.tangents_towards`: the even digit 2 k is the direction of a line, at k pi / planes, and
    the odd digit 2 k + 1 is the sector between this line and the next.

    Args:
        contacts: At most `MAX_SLIDING_CONTACTS` contacts.
        planes: Number of lines through each contact, from 2 to `MAX_PLANES`. They are the borders of the
            sectors of a friction pyramid with twice as many edges.

    Raises:
        InvalidFieldError: the number of planes is out of range.
        TooLargeError: there are more than `MAX_SLIDING_CONTACTS` contacts.
    """
    check_at_rest("contacts", contacts, "spatial_sliding_modes")
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
    for signs_of in sliding_faces(normals / np.linalg.norm(normals, axis=1)[:, None], across):
        letters = [SEPARATES] * n
        for i, signs in signs_of.items():
            letters[i] = _letter(signs)
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


def sliding_faces(
    rows: FloatArray, cuts: Sequence[FloatArray], most: float = math.inf
) -> Iterator[dict[int, list[int]]]:
    """Yield, for all that contacts can do together, the sides of its cuts on which each that stays slides.

    The rows, (m, d), unit, are the normal accelerations of n contacts, and what must be positive besides. The
    cuts, (k, d) of each contact, part the ways in which it slides. `TooLargeError` is raised first if more
    than ``most`` sets of planes meet in lines.
    """
    parts = []
    for face in cone_faces(rows):
        if face >> len(cuts):
            continue
        stay = [i for i in range(len(cuts)) if face >> i & 1]
        free = null_space(rows[stay])
        above = rows[[i for i in range(len(rows)) if not face >> i & 1]] @ free
        cut = np.vstack([np.zeros((0, rows.shape[1])), *(cuts[i] for i in stay)]) @ free
        if math.isfinite(most):
            _check_meetings(np.vstack([above, cut]), most)
        parts.append((stay, above, cut))
    for stay, above, cut in parts:
        ends = list(itertools.accumulate((len(cuts[i]) for i in stay), initial=0))
        for signs in _open_faces(above, cut):
            yield {i: signs[at:end] for i, (at, end) in zip(stay, itertools.pairwise(ends), strict=True)}


def _check_meetings(rows: FloatArray, most: float) -> None:
    rank = int((np.linalg.svd(rows, compute_uv=False) > ROW_TOLERANCE).sum())
    meetings = math.comb(len(rows), max(rank - 1, 0))
    if meetings > most:
        raise TooLargeError(
            "contacts",
            f"{meetings} sets of planes that part their ways of sliding",
            f"at most {most}: fewer contacts, or fewer friction_facets",
        )


def _open_faces(above: FloatArray, cut: FloatArray) -> Iterator[list[int]]:
    """Yield the signs of ``cut`` on every face of their arrangement where all of ``above`` are positive."""
    rows = np.vstack([above, cut])
    sizes = np.linalg.norm(rows, axis=1)
    rows = rows / np.where(sizes > ROW_TOLERANCE, sizes, 1.0)[:, None]
    rows[sizes <= ROW_TOLERANCE] = 0.0
    spread, basis = np.linalg.svd(rows)[1:] if rows.size else (np.zeros(0), rows)
    rows = rows @ basis[: int((spread > ROW_TOLERANCE).sum())].T
    wanted, everything = (1 << len(above)) - 1, (1 << len(rows)) - 1
    heights = _rays(rows) @ rows.T
    heights = heights[(heights[:, : len(above)] >= -10.0 * ROW_TOLERANCE).all(axis=1)]
    signs = np.sign(np.where(np.abs(heights) > 10.0 * ROW_TOLERANCE, heights, 0.0))
    rays = [(_mask(one > 0.0), _mask(one < 0.0)) for one in np.unique(signs, axis=0)]
    around: dict[int, set[tuple[int, int]]] = {}  # what faces add on some planes that contain a smaller face
    faces = [(0, 0)]
    seen = {*faces}
    while faces:
        plus, minus = faces.pop()
        if plus & wanted == wanted:
            yield [(plus >> k & 1) - (minus >> k & 1) for k in range(len(above), len(rows))]
        planes = everything & ~(plus | minus)
        if planes not in around:
            around[planes] = {(p & planes, m & planes) for p, m in rays}
        further = {(plus | p, minus | m) for p, m in around[planes]} - seen
        seen |= further
        faces += further


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
