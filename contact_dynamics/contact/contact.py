"""Contacts of a body with the world: where, along which normal, with which friction and restitution.

A contact is a point of the body on a flat of the world, unless curvatures say otherwise
(`contact.curvature`). The normal points into the body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.curvature import Curvatures, check_pairs, checked_curvatures
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.tolerances import UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import FloatArray, check_array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MOST_CONTACTS: Final = 10_000
"""Longest list of contacts accepted: far above any real contact set, far below what would stall a service."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ContactSet:
    """Contacts of one body in space; contact i is row i of each array.

    Raises:
        InvalidFieldError: arrays of unequal length, a number that is not finite, a normal that is not unit,
        mu < 0, e outside
            [0, 1], or curvatures with which the sides do not touch in one point.
        TooLargeError: more than `MOST_CONTACTS` contacts.
    """

    p_WC_W: FloatArray  # (n, 3), m, contact points, world
    normals_W: FloatArray  # (n, 3), unit, into the body, world axes
    frictions: FloatArray  # (n,), Coulomb's mu, >= 0
    restitutions: FloatArray  # (n,), e, in [0, 1]
    surfaces: tuple[str, ...] = ()  # the surface that each contact touches; empty: not known
    body_curvatures: Curvatures | None = None  # of the body at each contact; None: its points touch
    surface_curvatures: Curvatures | None = None  # of the world at each contact; None: its flats are touched

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            p_WC_W: ArrayLike,
            normals_W: ArrayLike,
            frictions: ArrayLike,
            restitutions: ArrayLike,
            surfaces: tuple[str, ...] = ...,
            body_curvatures: Curvatures | None = ...,
            surface_curvatures: Curvatures | None = ...,
        ) -> None:
            """Take whatever NumPy makes arrays of."""

    def __post_init__(self) -> None:
        """Check every array and normalise the normals to rounding."""
        n = len(self.frictions)
        if n > MOST_CONTACTS:
            raise TooLargeError("contacts", f"{n} contacts", f"at most {MOST_CONTACTS}")
        points = check_array("contacts.positions", self.p_WC_W, (n, 3))
        normals = check_array("contacts.normals", self.normals_W, (n, 3))
        frictions = check_array("contacts.frictions", self.frictions, (n,))
        restitutions = check_array("contacts.restitutions", self.restitutions, (n,))
        lengths = np.sqrt(np.einsum("ij,ij->i", normals, normals))
        _check_each(normals, lengths, frictions, restitutions)
        if self.surfaces and len(self.surfaces) != n:
            raise InvalidFieldError(
                "contacts.surface_names", f"{len(self.surfaces)} names", f"{n} names, or none"
            )
        normals = normals / lengths[:, None]
        normals.flags.writeable = False
        object.__setattr__(self, "p_WC_W", points)
        object.__setattr__(self, "normals_W", normals)
        object.__setattr__(self, "frictions", frictions)
        object.__setattr__(self, "restitutions", restitutions)
        object.__setattr__(self, "surfaces", tuple(self.surfaces))
        if self.body_curvatures is None and self.surface_curvatures is None:
            return
        for name in ("body_curvatures", "surface_curvatures"):
            checked = checked_curvatures(f"contacts.{name}", getattr(self, name), normals)
            object.__setattr__(self, name, checked)
        check_pairs(normals, self.body_curvatures, self.surface_curvatures)

    def __len__(self) -> int:
        """Return the number of contacts."""
        return len(self.frictions)

    def subset(self, indices: Sequence[int]) -> ContactSet:
        """Return the contacts of those indices, in their order."""
        chosen = list(indices)
        return ContactSet(
            p_WC_W=self.p_WC_W[chosen],
            normals_W=self.normals_W[chosen],
            frictions=self.frictions[chosen],
            restitutions=self.restitutions[chosen],
            surfaces=tuple(self.surfaces[i] for i in chosen) if self.surfaces else (),
            body_curvatures=None if self.body_curvatures is None else self.body_curvatures.subset(chosen),
            surface_curvatures=(
                None if self.surface_curvatures is None else self.surface_curvatures.subset(chosen)
            ),
        )


def _check_each(
    normals: FloatArray, lengths: FloatArray, frictions: FloatArray, restitutions: FloatArray
) -> None:
    """Refuse the first contact with a number that is not allowed; in floats, since most sets are small."""
    for i, length in enumerate(lengths.tolist()):
        if abs(length - 1.0) > UNIT_LENGTH_TOLERANCE:
            raise InvalidFieldError(f"contacts.normals[{i}]", normals[i].tolist(), "a unit vector")
    for i, friction in enumerate(frictions.tolist()):
        if friction < 0.0:
            raise InvalidFieldError(f"contacts.frictions[{i}]", friction, "a number >= 0")
    for i, restitution in enumerate(restitutions.tolist()):
        if not 0.0 <= restitution <= 1.0:
            raise InvalidFieldError(f"contacts.restitutions[{i}]", restitution, "a number in [0, 1]")
