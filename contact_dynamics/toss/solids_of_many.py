"""Bodies and worlds of many samples as one, with arrays for its numbers.

The arithmetic of `solid` and `forces` goes by component, so it serves arrays as well. The contacts of samples
are one corner and one flat here, `CONTACT`, whose components have a row for each contact of a sample and a
column for each sample. All other numbers have an element for each sample.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.toss.solid import Flat, Solid

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.toss.solid import Numbers, Touch

CONTACT: Final = (0, 0)
"""The touch that all contacts are."""


def columns(rows: Sequence[Any]) -> Any:
    """Return arrays of the first entries of all rows, of the second ones, and so on."""
    array = np.array(rows, dtype=float)
    return tuple(np.ascontiguousarray(np.moveaxis(array, -1, 0)))


def states_together(states: list[Numbers]) -> Numbers:
    """Return 13 arrays, with an element for each state."""
    return list(columns(states))


def solids_together(solids: list[Solid], contacts: list[tuple[Touch, ...]]) -> Solid:
    """Return bodies with some of their corners, which touch flats, as many for each body.

    The restitution is that of each flat, and friction has both its values. Names and what no force depends on
    are those of the first body.
    """
    each = list(zip(*contacts, strict=True))
    flats = [
        [solid.flats[touch[0]] for solid, touch in zip(solids, touches, strict=True)] for touches in each
    ]
    flat = Flat(
        name="",
        normal=columns([[one.normal for one in row] for row in flats]),
        tangents=(
            columns([[one.tangents[0] for one in row] for row in flats]),
            columns([[one.tangents[1] for one in row] for row in flats]),
        ),
        level=_numbers([[one.level for one in row] for row in flats]),
        friction=_numbers([[one.friction for one in row] for row in flats]),
        restitution=_numbers([[one.restitution for one in row] for row in flats]),
        strike_friction=_numbers([[one.strike_friction for one in row] for row in flats]),
    )
    corners = [
        [solid.corners[touch[1]] for solid, touch in zip(solids, touches, strict=True)] for touches in each
    ]
    return solids[0]._replace(
        mass=_numbers([solid.mass for solid in solids]),
        inertia=_matrices([solid.inertia for solid in solids]),
        inverse=_matrices([solid.inverse for solid in solids]),
        corners=(columns(corners),),
        gravity=columns([solid.gravity for solid in solids]),
        flats=(flat,),
    )


def _numbers(rows: Sequence[Any]) -> Any:
    return np.array(rows)


def _matrices(matrices: list[Any]) -> Any:
    """Return the rows of one matrix, whose entries are arrays."""
    array = np.array(matrices)
    return tuple(tuple(np.ascontiguousarray(array[:, i, j]) for j in range(3)) for i in range(3))
