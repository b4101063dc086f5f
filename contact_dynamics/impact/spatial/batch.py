# SPDX-License-Identifier: Apache-2.0
"""This file resolves many impacts in space at once, with the numbers of `one_contact` to the last bit.

They are struck one after the other by the code of one (`response`). Vertices of the impulse paths are not
kept.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.energy import ManyEnergies
from contact_dynamics.impact.law import RestitutionLaw, check_law_rows
from contact_dynamics.impact.spatial.response import Strike, refuse
from contact_dynamics.records import Record
from contact_dynamics.tolerances import (
    LARGEST_ARM,
    LARGEST_NUMBER,
    SYMMETRY_TOLERANCE,
    TRIANGLE_TOLERANCE,
    VELOCITY_TOLERANCE,
)
from contact_dynamics.validation import FloatArray, check_magnitude, check_not_negative
from contact_dynamics.validation_batches import (
    check_not_negative_rows,
    check_positive_rows,
    check_rows,
    check_share_rows,
    check_sizes,
    check_unit_rows,
    common_length,
)
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from contact_dynamics.rigid_body.body import HasMassProperties

_CHUNK: Final = 8192
"""Cases that are struck without a pause. Ctrl-C acts between two chunks."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class StrikingBodies(Record):
    """Bodies at their contacts, just before impacts.

    Each field has one row per case, or one row for all cases.

    Attributes:
        masses: (N,) or (), kg, > 0.
        inertias_B: (N, 3, 3) or (3, 3), kg m^2, about the centres of mass, body axes.
        q_WB: (N, 4) or (4,), unit quaternions x, y, z, w, which transform body into world coordinates.
        v_WB_W: (N, 3) or (3,), m/s, velocities of the centres of mass, world axes.
        w_WB_W: (N, 3) or (3,), rad/s, angular velocities, world axes.
        r_W: (N, 3) or (3,), m, from the centres of mass to the contacts, world axes.

    Raises:
        InvalidFieldError: a number is out of range; the message names the field and the first row.
    """

    masses: FloatArray
    inertias_B: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray
    r_W: FloatArray

    @classmethod
    @checks_types
    def of(
        cls,
        body: HasMassProperties,
        *,
        p_WB_W: ArrayLike,
        q_WB: ArrayLike,
        v_WB_W: ArrayLike,
        w_WB_W: ArrayLike,
        p_WC_W: ArrayLike,
    ) -> StrikingBodies:
        """Return one body in many states, with one contact per state or one contact for all states.

        Args:
            body: A `Body`, or its `MassProperties`.
            p_WB_W: (N, 3) or (3,), m, positions of the centre of mass, world.
            q_WB: (N, 4) or (4,), unit quaternions x, y, z, w.
            v_WB_W: (N, 3) or (3,), m/s, world axes.
            w_WB_W: (N, 3) or (3,), rad/s, world axes.
            p_WC_W: (N, 3) or (3,), m, contact points, world.
        """
        points = check_magnitude("p_WC_W", check_rows("p_WC_W", p_WC_W, (3,)))
        places = check_magnitude("p_WB_W", check_rows("p_WB_W", p_WB_W, (3,)))
        common_length({"p_WC_W": points, "p_WB_W": places})
        own = body.mass_properties
        return cls(
            masses=own.mass,
            inertias_B=own.I_B,
            q_WB=q_WB,
            v_WB_W=v_WB_W,
            w_WB_W=w_WB_W,
            r_W=points - places,
        )

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            masses: ArrayLike,
            inertias_B: ArrayLike,
            q_WB: ArrayLike,
            v_WB_W: ArrayLike,
            w_WB_W: ArrayLike,
            r_W: ArrayLike,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check all fields and make arrays with a leading axis of them."""
        checked = {
            "masses": check_sizes("masses", check_positive_rows("masses", self.masses)),
            "inertias_B": check_rows(
                "inertias_B",
                check_magnitude("inertias_B", check_rows("inertias_B", self.inertias_B, (3, 3))),
                (3, 3),
                f"a symmetric positive definite matrix with I1 + I2 >= I3 >= {1.0 / LARGEST_NUMBER:g}",
                _possible_inertias,
            ),
            "q_WB": check_unit_rows("q_WB", self.q_WB, 4),
            "v_WB_W": check_magnitude("v_WB_W", check_rows("v_WB_W", self.v_WB_W, (3,))),
            "w_WB_W": check_magnitude("w_WB_W", check_rows("w_WB_W", self.w_WB_W, (3,))),
            "r_W": check_magnitude("r_W", check_rows("r_W", self.r_W, (3,))),
        }
        common_length(checked)
        arms = np.sqrt(np.einsum("ij,ij->i", checked["r_W"], checked["r_W"]))
        largest = checked["inertias_B"].diagonal(axis1=1, axis2=2).max(axis=1)
        for i in np.flatnonzero(arms > LARGEST_ARM * np.sqrt(largest / checked["masses"]))[:1]:
            allowed = f"{LARGEST_ARM:g} radii of gyration at most"
            raise InvalidFieldError(f"r_W[{i}]", f"an arm of {arms[i % len(arms)]:g} m", allowed)
        for field, rows in checked.items():
            object.__setattr__(self, field, rows)

    @property
    def fields(self) -> dict[str, FloatArray]:
        """Return the fields by their names."""
        return {field: getattr(self, field) for field in self.__slots__}


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ResponseImpacts(ManyEnergies):
    """Outcomes of N impacts of mechanisms. Row i belongs to case i; `ResponseImpact` explains the fields.

    Attributes:
        restitution_laws: (N,), values of RestitutionLaw.
        outcomes: (N,), values of ImpactOutcome.
        impulses_W: (N, 3), N s, total impulses.
        compressions_W: (N, 3), N s, impulses up to the end of compression.
        velocities_before_W: (N, 3), m/s, velocities of the contacts before, relative to what they touch.
        velocities_after_W: (N, 3), m/s, velocities of the contacts after, relative to what they touch.
    """

    restitution_laws: NDArray[np.int64]
    outcomes: NDArray[np.int64]
    impulses_W: FloatArray
    compressions_W: FloatArray
    velocities_before_W: FloatArray
    velocities_after_W: FloatArray

    def _at_contacts(self) -> tuple[list[FloatArray], ...]:
        return list(self.impulses_W.T), list(self.velocities_before_W.T), list(self.velocities_after_W.T)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class SpatialImpacts(ResponseImpacts):
    """Outcomes of N spatial impacts. Row i belongs to case i; `SpatialImpact` explains the fields.

    Attributes:
        v_WB_W: (N, 3), m/s, velocities of the centres of mass after the impacts, world axes.
        w_WB_W: (N, 3), rad/s, angular velocities after the impacts, world axes.
        other_v_WB_W: (N, 3), m/s, velocities of the second bodies' centres of mass, or None if the bodies
            hit the fixed world.
        other_w_WB_W: (N, 3), rad/s, angular velocities of the second bodies, or None if the world is struck.
    """

    v_WB_W: FloatArray
    w_WB_W: FloatArray
    other_v_WB_W: FloatArray | None = None
    other_w_WB_W: FloatArray | None = None


def spatial_impacts(
    bodies: StrikingBodies,
    *,
    normals_W: ArrayLike,
    frictions: ArrayLike,
    restitutions: ArrayLike,
    others: StrikingBodies | None = None,
    surface_velocities_W: ArrayLike | None = None,
    restitution_laws: ArrayLike = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    skip_separating: bool = False,
) -> SpatialImpacts:
    """Return the outcomes of N impacts in space. Each is that of `spatial_impact` or `spatial_pair_impact`.

    Args:
        bodies: Bodies into which the normals point, just before the impacts.
        normals_W: (N, 3) or (3,), unit, world axes.
        frictions: (N,) or one number, >= 0.
        restitutions: (N,) or one number, in [0, 1].
        others: Bodies that they strike, or None if they hit the fixed world.
        surface_velocities_W: (N, 3) or (3,), m/s, velocities of the world's surfaces at the contacts, world
            axes, or None if all are at rest.
        restitution_laws: (N,) or one value of RestitutionLaw.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of a contact's velocity up to it count
            as zero.
        skip_separating: Whether to accept contacts that separate. Their outcome is NO_IMPULSE, and their
            velocities are unchanged.

    Raises:
        SeparatingContactError: a contact's normal velocity is above the tolerance, and ``skip_separating`` is
            false; the message names the first such contact.
        InvalidFieldError: a number is out of range; the message names the field and the first row.
    """
    fields = _checked(normals_W, frictions, restitutions, restitution_laws)
    fields |= {f"bodies.{name}": rows for name, rows in bodies.fields.items()}
    if others is not None:
        fields |= {f"others.{name}": rows for name, rows in others.fields.items()}
    if surface_velocities_W is not None:
        if others is not None:
            raise InvalidFieldError("surface_velocities_W", "some", "None where bodies strike others")
        name = "surface_velocities_W"
        fields[name] = check_magnitude(name, check_rows(name, surface_velocities_W, (3,)))
    count = common_length(fields)
    surfaces = fields.get("surface_velocities_W", np.zeros((1, 3)))
    tables = [_table(bodies, count, surfaces), np.empty((0, 23)) if others is None else _table(others, count)]
    found, vectors = _struck(
        Strike.strike_rows,
        tables,
        fields,
        count=count,
        width=24,
        velocity_tolerance=velocity_tolerance,
        skip_separating=skip_separating,
    )
    after = vectors[0]
    if surfaces.any():
        moved = bodies.v_WB_W + (after - (bodies.v_WB_W - surfaces))
        after = np.where(np.abs(surfaces).max(axis=1, keepdims=True) > 0.0, moved, after)
    return SpatialImpacts(
        v_WB_W=after,
        w_WB_W=vectors[1],
        other_v_WB_W=None if others is None else vectors[6],
        other_w_WB_W=None if others is None else vectors[7],
        **_at_contacts(found, vectors[2:6]),
    )


def response_impacts(
    inverse_inertias_W: ArrayLike,
    velocities_W: ArrayLike,
    *,
    normals_W: ArrayLike,
    frictions: ArrayLike,
    restitutions: ArrayLike,
    restitution_laws: ArrayLike = RestitutionLaw.POISSON,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
    skip_separating: bool = False,
) -> ResponseImpacts:
    """Return the outcomes of N impacts of mechanisms. Each is that of `response_impact`.

    Args:
        inverse_inertias_W: (N, 3, 3) or (3, 3), 1/kg, J M^-1 J^T, world axes.
        velocities_W: (N, 3) or (3,), m/s, velocities of the contact points just before the impacts, world
            axes.
        normals_W: (N, 3) or (3,), unit normals into the mechanisms, world axes.
        frictions: (N,) or one number, >= 0.
        restitutions: (N,) or one number, in [0, 1].
        restitution_laws: (N,) or one value of RestitutionLaw.
        velocity_tolerance: m/s, >= 0. Normal and tangential components of a contact's velocity up to it count
            as zero.
        skip_separating: Whether to accept contacts that separate, with the outcome NO_IMPULSE.

    Raises:
        SeparatingContactError: a contact's normal velocity is above the tolerance, and ``skip_separating`` is
            false; the message names the first such contact.
        InvalidFieldError: a number is out of range, or a mechanism wedges; the message names the field and
            the first row.
    """
    fields = _checked(normals_W, frictions, restitutions, restitution_laws)
    for name, value, shape in (
        ("inverse_inertias_W", inverse_inertias_W, (3, 3)),
        ("velocities_W", velocities_W, (3,)),
    ):
        fields[name] = check_magnitude(name, check_rows(name, value, shape))
    count = common_length(fields)
    tables = [_columns((fields["inverse_inertias_W"].reshape(-1, 9), fields["velocities_W"]), count)]
    found, vectors = _struck(
        Strike.strike_mechanism_rows,
        tables,
        fields,
        count=count,
        width=12,
        velocity_tolerance=velocity_tolerance,
        skip_separating=skip_separating,
    )
    return ResponseImpacts(**_at_contacts(found, vectors))


def _checked(
    normals_W: ArrayLike, frictions: ArrayLike, restitutions: ArrayLike, restitution_laws: ArrayLike
) -> dict[str, FloatArray]:
    """Return the fields of contacts as rows."""
    return {
        "normals_W": check_unit_rows("normals_W", normals_W, 3),
        "frictions": check_not_negative_rows("frictions", frictions),
        "restitutions": check_share_rows("restitutions", restitutions),
        "restitution_laws": check_law_rows("restitution_laws", restitution_laws),
    }


def _struck(
    strike_rows: Callable[..., int],
    tables: Sequence[FloatArray],
    fields: Mapping[str, FloatArray],
    *,
    count: int,
    width: int,
    velocity_tolerance: float,
    skip_separating: bool,
) -> tuple[tuple[FloatArray, NDArray[np.int64]], list[FloatArray]]:
    """Return laws and outcomes, (N,), and the vectors, (N, 3), in the ``width`` columns of the results.

    ``strike_rows`` is a method of `Strike`, and ``tables`` are what it takes before contacts.
    """
    tolerance = check_not_negative("velocity_tolerance", velocity_tolerance)
    every_law = np.broadcast_to(fields["restitution_laws"], count)
    outcomes, results = np.empty(count, dtype=np.int64), np.empty((count, width))
    materials = fields["frictions"][:, None], fields["restitutions"][:, None]
    tables = [*tables, _columns((fields["normals_W"], *materials), count)]
    for law in RestitutionLaw:
        cases = np.flatnonzero(every_law == law)
        strike = Strike(law)
        for first in range(0, len(cases), _CHUNK):
            chunk = cases[first : first + _CHUNK]
            own, found = np.empty(len(chunk), dtype=np.int64), np.empty((len(chunk), width))
            # Python reads a plain number from a memory view, and a NumPy scalar from an array.
            rows = [table[chunk].data if len(table) > 0 else table.data for table in tables]
            done = strike_rows(strike, *rows, tolerance, skip_separating, own.data, found.data)
            if done < len(chunk):
                case = chunk[done]
                refuse(strike, int(own[done]), tolerance, f" of case {case}", f"inverse_inertias_W[{case}]")
            outcomes[chunk], results[chunk] = own, found
    vectors = [np.ascontiguousarray(results[:, i : i + 3]) for i in range(0, width, 3)]
    return (every_law, outcomes), vectors


def _at_contacts(
    found: tuple[FloatArray, NDArray[np.int64]], vectors: Sequence[FloatArray]
) -> dict[str, Any]:
    """Return what happened at the contacts, by the fields of `ResponseImpacts`."""
    names = "impulses_W", "compressions_W", "velocities_before_W", "velocities_after_W"
    laws, outcomes = found
    return {
        "restitution_laws": laws.astype(np.int64),
        "outcomes": outcomes,
        **dict(zip(names, vectors, strict=True)),
    }


def _table(bodies: StrikingBodies, count: int, surfaces: FloatArray | float = 0.0) -> FloatArray:
    """Return the rows that `Strike.strike_rows` takes, with velocities relative to those of surfaces, m/s."""
    inertias, v = bodies.inertias_B.reshape(len(bodies.inertias_B), 9), bodies.v_WB_W - surfaces
    return _columns((bodies.masses[:, None], inertias, bodies.q_WB, bodies.r_W, v, bodies.w_WB_W), count)


def _columns(parts: Sequence[FloatArray], count: int) -> FloatArray:
    """Return a table of ``count`` rows, whose columns are those of the parts. One row stands for all."""
    return np.hstack([np.broadcast_to(part, (count, part.shape[1])) for part in parts])


def _possible_inertias(inertias: FloatArray) -> NDArray[np.bool_]:
    """Return which inertias a body can have, (N,), as `MassProperties` judges each."""
    scale = abs(inertias).max(axis=(1, 2))
    symmetric = abs(inertias - inertias.transpose(0, 2, 1)).max(axis=(1, 2)) <= SYMMETRY_TOLERANCE * scale
    moments = np.linalg.eigvalsh(inertias)
    triangle = moments[:, 0] + moments[:, 1] >= moments[:, 2] * (1.0 - TRIANGLE_TOLERANCE)
    large_enough = moments[:, 2] >= 1.0 / LARGEST_NUMBER
    possible: NDArray[np.bool_] = symmetric & (moments[:, 0] > 0.0) & triangle & large_enough
    return possible
