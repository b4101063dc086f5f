# SPDX-License-Identifier: Apache-2.0
"""A contact says where a body meets the world, along which normal, with which friction and restitution.

A contact is a point of the body on a flat of the world, unless it has curvatures (`contact.curvature`). The
normal points into the body. One contact is a `Contact`. Several contacts are a `ContactSet`, which holds
arrays and whose items are `Contact`s.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Final

import numpy as np

from contact_dynamics.contact.curvature import Curvatures, alike, check_pairs, checked_curvatures
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.records import Record, made
from contact_dynamics.tolerances import UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import (
    FloatArray,
    check_array,
    check_motion,
    check_not_negative,
    check_static,
    check_unit,
    check_within,
)
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

_NEEDED: Final = "in [0, 1] at each contact of an impact"

MAX_CONTACTS: Final = 10_000
"""Longest list of contacts accepted. Real sets have far fewer, and a service can still answer for so many."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Contact(Record):
    """One contact of a body in a spatial (3-D) problem. Vectors may be given as lists.

    Attributes:
        p_WC_W: (3,), m, contact point, world.
        normal_W: (3,), unit normal into the body, world axes.
        friction: Coefficient of Coulomb friction, >= 0.
        restitution: Coefficient of restitution, in [0, 1], or None. Impacts require it; contact modes do not
            use it.
        surface: Name of the surface in contact, or an empty string if it is unknown.
        body_curvatures: Curvatures of the body at the contact, one row, or None if a point of the body
            touches.
        surface_curvatures: Curvatures of the world at the contact, one row, or None if the body touches a
            plane.
        surface_velocity_W: (3,), m/s, velocity of the surface's material point at the contact, world axes, or
            None at rest.
        surface_angular_velocity_W: (3,), rad/s, angular velocity of the surface, world axes, or None if it
            does not rotate.
        surface_acceleration_W: (3,), m/s^2, acceleration of the surface's material point at the contact,
            world axes, centripetal terms included, or None at rest.
        static_friction: Coefficient of static friction, >= ``friction``, which bounds the force of a contact
            that sticks. A contact that slides or begins to slide has ``friction``. None means the same.
            Impacts do not use it.

    Raises:
        InvalidFieldError: a number is not finite, the normal is not a unit vector, the friction is negative,
            the static friction is below it, the restitution is outside [0, 1], or the curvatures have more
            than one row or do not allow contact at a single point. Or a velocity or acceleration of the
            surface is beyond `LARGEST_NUMBER`.
    """

    p_WC_W: FloatArray
    normal_W: FloatArray
    friction: float
    restitution: float | None = None
    surface: str = ""
    body_curvatures: Curvatures | None = None
    surface_curvatures: Curvatures | None = None
    surface_velocity_W: FloatArray | None = None
    surface_angular_velocity_W: FloatArray | None = None
    surface_acceleration_W: FloatArray | None = None
    static_friction: float | None = None

    SURFACE_MOTION: ClassVar[tuple[str, ...]] = (
        "surface_velocity_W",
        "surface_angular_velocity_W",
        "surface_acceleration_W",
    )

    if TYPE_CHECKING:  # what the constructor takes, beside what the fields then hold

        def __init__(
            self,
            *,
            p_WC_W: ArrayLike,
            normal_W: ArrayLike,
            friction: float,
            restitution: float | None = None,
            surface: str = "",
            body_curvatures: Curvatures | None = None,
            surface_curvatures: Curvatures | None = None,
            surface_velocity_W: ArrayLike | None = None,
            surface_angular_velocity_W: ArrayLike | None = None,
            surface_acceleration_W: ArrayLike | None = None,
            static_friction: float | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Check every field and normalise the normal to rounding."""
        object.__setattr__(self, "p_WC_W", check_array("p_WC_W", self.p_WC_W, (3,)))
        object.__setattr__(self, "normal_W", check_unit("normal_W", self.normal_W, 3))
        object.__setattr__(self, "friction", check_not_negative("friction", self.friction))
        object.__setattr__(self, "static_friction", check_static(self.static_friction, self.friction))
        if self.restitution is not None:
            object.__setattr__(self, "restitution", check_within("restitution", self.restitution, 0.0, 1.0))
        _check_curvatures(self, self.normal_W[None])
        _check_motion(self)

    @property
    def surfaces_move(self) -> bool:
        """Whether the surface moves: one of its velocities or its acceleration is not zero."""
        return (
            self.surface_velocity_W is not None
            or self.surface_acceleration_W is not None
            or self.surface_angular_velocity_W is not None
        )

    @property
    def impact_restitution(self) -> float:
        """Return the coefficient of restitution, or raise `InvalidFieldError` if there is none."""
        return known_restitution(self.restitution)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ContactSet(Record):
    """Contacts of one body in a spatial (3-D) problem.

    Contact i is row i of each array, and `contacts[i]` is a `Contact`.

    Arrays may be given as lists. The normals, frictions and restitutions may be one value for all contacts.

    Attributes:
        p_WC_W: (n, 3), m, contact points, world.
        normals_W: (n, 3), unit normals into the body, world axes.
        frictions: (n,), coefficients of Coulomb friction, >= 0.
        restitutions: (n,), coefficients of restitution, in [0, 1], or None. Impacts require them; contact
            modes do not use them.
        surfaces: Name of the surface at each contact, or an empty tuple if they are unknown.
        body_curvatures: Curvatures of the body at each contact, or None if points of the body touch.
        surface_curvatures: Curvatures of the world at each contact, or None if the body touches planes.
        surface_velocities_W: (n, 3), m/s, velocities of the surfaces' material points at the contacts, world
            axes, or None if all surfaces are at rest. Here and below, one vector may be given for all
            contacts.
        surface_angular_velocities_W: (n, 3), rad/s, angular velocities of the surfaces, world axes, or None
            if none rotates.
        surface_accelerations_W: (n, 3), m/s^2, accelerations of the surfaces' material points at the
            contacts, world axes, centripetal terms included, or None if there are none.
        static_frictions: (n,), or one for all contacts: coefficients of static friction, as in `Contact`, or
            None if they are those of ``frictions``.

    Raises:
        InvalidFieldError: arrays have different lengths, a number is not finite, a normal is not a unit
            vector, a friction is negative, a static friction is below it, a restitution is outside [0, 1], or
            curvatures do not allow contact at a single point. Or a velocity or acceleration of a surface is
            beyond `LARGEST_NUMBER`.
        TooLargeError: there are more than `MAX_CONTACTS` contacts.
    """

    p_WC_W: FloatArray
    normals_W: FloatArray
    frictions: FloatArray
    restitutions: FloatArray | None = None
    surfaces: tuple[str, ...] = ()
    body_curvatures: Curvatures | None = None
    surface_curvatures: Curvatures | None = None
    surface_velocities_W: FloatArray | None = None
    surface_angular_velocities_W: FloatArray | None = None
    surface_accelerations_W: FloatArray | None = None
    static_frictions: FloatArray | None = None

    HINT_IF_WRONG: ClassVar[str] = ", which several_impact takes"

    SURFACE_MOTION: ClassVar[tuple[str, ...]] = (
        "surface_velocities_W",
        "surface_angular_velocities_W",
        "surface_accelerations_W",
    )

    if TYPE_CHECKING:  # what the constructor takes, beside what the fields then hold

        def __init__(
            self,
            *,
            p_WC_W: ArrayLike,
            normals_W: ArrayLike,
            frictions: ArrayLike,
            restitutions: ArrayLike | None = None,
            surfaces: Sequence[str] = (),
            body_curvatures: Curvatures | None = None,
            surface_curvatures: Curvatures | None = None,
            surface_velocities_W: ArrayLike | None = None,
            surface_angular_velocities_W: ArrayLike | None = None,
            surface_accelerations_W: ArrayLike | None = None,
            static_frictions: ArrayLike | None = None,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Check every array and normalise the normals to rounding."""
        n = len(self.p_WC_W) if np.ndim(self.frictions) == 0 else len(self.frictions)
        if n > MAX_CONTACTS:
            raise TooLargeError("contacts", f"{n} contacts", f"at most {MAX_CONTACTS}")
        points = check_array("p_WC_W", self.p_WC_W, (n, 3))
        normals = check_array("normals_W", _for_each(self.normals_W, n, 1), (n, 3))
        frictions = check_array("frictions", _for_each(self.frictions, n), (n,))
        restitutions = self.restitutions
        if restitutions is not None:
            restitutions = check_array("restitutions", _for_each(restitutions, n), (n,))
        lengths = np.sqrt(np.einsum("ij,ij->i", normals, normals))
        _check_each(normals, lengths, frictions, restitutions)
        if self.surfaces and len(self.surfaces) != n:
            raise InvalidFieldError("surfaces", f"{len(self.surfaces)} names", f"{n} names, or none")
        normals = normals / lengths[:, None]
        normals.flags.writeable = False
        object.__setattr__(self, "p_WC_W", points)
        object.__setattr__(self, "normals_W", normals)
        object.__setattr__(self, "frictions", frictions)
        object.__setattr__(self, "restitutions", restitutions)
        object.__setattr__(self, "surfaces", tuple(self.surfaces))
        if self.static_frictions is not None:
            static = check_array("static_frictions", _for_each(self.static_frictions, n), (n,))
            for i, pair in enumerate(zip(static.tolist(), frictions.tolist(), strict=True)):
                check_static(*pair, f"static_frictions[{i}]", f"frictions[{i}]")
            object.__setattr__(self, "static_frictions", static)
        _check_curvatures(self, normals)
        _check_motion(self, n)

    @classmethod
    @checks_types
    def of(cls, contacts: Sequence[Contact]) -> ContactSet:
        """Return the set of the given contacts, in their order."""
        n = len(contacts)
        return cls(
            p_WC_W=np.array([one.p_WC_W for one in contacts]).reshape(n, 3),
            normals_W=np.array([one.normal_W for one in contacts]).reshape(n, 3),
            frictions=np.array([one.friction for one in contacts]),
            restitutions=all_or_none([one.restitution for one in contacts]),
            surfaces=[one.surface for one in contacts] if any(one.surface for one in contacts) else (),
            body_curvatures=_together([one.body_curvatures for one in contacts], math.inf),
            surface_curvatures=_together([one.surface_curvatures for one in contacts], 0.0),
            surface_velocities_W=_in_rows([one.surface_velocity_W for one in contacts]),
            surface_angular_velocities_W=_in_rows([one.surface_angular_velocity_W for one in contacts]),
            surface_accelerations_W=_in_rows([one.surface_acceleration_W for one in contacts]),
            static_frictions=static_or_none(
                [one.static_friction for one in contacts], [one.friction for one in contacts]
            ),
        )

    @property
    def surfaces_move(self) -> bool:
        """Whether any surface moves: one of the velocities or accelerations is not zero."""
        return (
            self.surface_velocities_W is not None
            or self.surface_accelerations_W is not None
            or self.surface_angular_velocities_W is not None
        )

    @property
    def holding_frictions(self) -> FloatArray:
        """Coefficients of friction, (n,), that bound the forces of contacts that stick."""
        return self.frictions if self.static_frictions is None else self.static_frictions

    @property
    def impact_restitutions(self) -> FloatArray:
        """Return the coefficients of restitution, (n,), or raise `InvalidFieldError` if there are none."""
        if self.restitutions is None:
            raise InvalidFieldError("contacts.restitutions", "none", _NEEDED)
        return self.restitutions

    def __len__(self) -> int:
        """Return the number of contacts."""
        return len(self.frictions)

    def __getitem__(self, i: int) -> Contact:
        """Return one contact, counted from the end if ``i`` is negative."""
        i = range(len(self))[i]
        body, surface = self.body_curvatures, self.surface_curvatures
        contact = made(  # its numbers are checked
            Contact,
            self.p_WC_W[i],
            self.normals_W[i],
            float(self.frictions[i]),
            None if self.restitutions is None else float(self.restitutions[i]),
            self.surfaces[i] if self.surfaces else "",
            None if body is None else body.subset([i]),
            None if surface is None else surface.subset([i]),
            _rows(self.surface_velocities_W, i),
            _rows(self.surface_angular_velocities_W, i),
            _rows(self.surface_accelerations_W, i),
            None if self.static_frictions is None else float(self.static_frictions[i]),
        )
        _check_curvatures(contact, contact.normal_W[None])
        _check_motion(contact)  # that of a surface at rest becomes None
        return contact

    def __iter__(self) -> Iterator[Contact]:
        """Go through the contacts in their order."""
        return (self[i] for i in range(len(self)))

    def subset(self, indices: Sequence[int]) -> ContactSet:
        """Return the contacts with the given indices, in their order."""
        chosen = list(indices)
        contacts = ContactSet(
            p_WC_W=self.p_WC_W[chosen],
            normals_W=self.normals_W[chosen],
            frictions=self.frictions[chosen],
            restitutions=None if self.restitutions is None else self.restitutions[chosen],
            surfaces=tuple(self.surfaces[i] for i in chosen) if self.surfaces else (),
            body_curvatures=None if self.body_curvatures is None else self.body_curvatures.subset(chosen),
            surface_curvatures=(
                None if self.surface_curvatures is None else self.surface_curvatures.subset(chosen)
            ),
            static_frictions=_rows(self.static_frictions, chosen),
        )
        if not self.surfaces_move:
            return contacts
        return replace(
            contacts,
            surface_velocities_W=_rows(self.surface_velocities_W, chosen),
            surface_angular_velocities_W=_rows(self.surface_angular_velocities_W, chosen),
            surface_accelerations_W=_rows(self.surface_accelerations_W, chosen),
        )


def known_restitution(restitution: float | None) -> float:
    """Return a coefficient of restitution, or raise `InvalidFieldError` where it was left out."""
    if restitution is None:
        raise InvalidFieldError("contact.restitution", "none", _NEEDED)
    return restitution


def static_or_none(static: Sequence[float | None], frictions: Sequence[float]) -> list[float] | None:
    """Return coefficients of static friction, those of friction where it is None, or None if all are."""
    if all(one is None for one in static):
        return None
    return [other if one is None else one for one, other in zip(static, frictions, strict=True)]


def all_or_none(restitutions: list[float | None]) -> list[float] | None:
    """Return the restitutions of contacts, or raise `InvalidFieldError` where only some have one."""
    known = [one for one in restitutions if one is not None]
    if not known:
        return None
    if len(known) < len(restitutions):
        raise InvalidFieldError("restitution", "none at some contacts", "given at every contact or at none")
    return known


def _for_each(values: ArrayLike, n: int, ndim: int = 0) -> ArrayLike:
    """Return a value of that dimension, which is for all contacts, n times, and anything else unchanged."""
    return values if np.ndim(values) != ndim else np.broadcast_to(values, (n, *np.asarray(values).shape))


def _together(curvatures: list[Curvatures | None], otherwise: float) -> Curvatures | None:
    """Return the curvatures of contacts as those of a set. Contacts without any have ``otherwise``, 1/m."""
    if all(one is None for one in curvatures):
        return None
    each = [alike(1, otherwise) if one is None else one for one in curvatures]
    return Curvatures(
        along=np.concatenate([one.along for one in each]),
        across=np.concatenate([one.across for one in each]),
        directions_W=np.concatenate([one.directions_W for one in each]),
    )


def _in_rows(vectors: list[FloatArray | None]) -> FloatArray | None:
    """Return the vectors of contacts as rows, zero where one has none, or None where none has any."""
    if all(one is None for one in vectors):
        return None
    return np.array([np.zeros(3) if one is None else one for one in vectors])


def _rows(vectors: FloatArray | None, which: int | list[int]) -> FloatArray | None:
    """Return some of the contacts' vectors or numbers, or None where there are none."""
    return None if vectors is None else vectors[which]


def _check_motion(contacts: Contact | ContactSet, n: int | None = None) -> None:
    """Check the motion of the surfaces of one contact, or of n. What is all zero becomes None."""
    if contacts.surfaces_move:
        for name in contacts.SURFACE_MOTION:
            object.__setattr__(contacts, name, check_motion(name, getattr(contacts, name), n))


def _check_curvatures(contacts: Contact | ContactSet, normals_W: FloatArray) -> None:
    """Check the curvatures of both sides against the normals, (n, 3), and make their directions tangent."""
    if contacts.body_curvatures is None and contacts.surface_curvatures is None:
        return
    for name in ("body_curvatures", "surface_curvatures"):
        checked = checked_curvatures(name, getattr(contacts, name), normals_W)
        object.__setattr__(contacts, name, checked)
    check_pairs(normals_W, contacts.body_curvatures, contacts.surface_curvatures)


def _check_each(
    normals: FloatArray, lengths: FloatArray, frictions: FloatArray, restitutions: FloatArray | None
) -> None:
    """Refuse the first contact with a number that is not allowed. Floats are faster for small sets."""
    for i, length in enumerate(lengths.tolist()):
        if abs(length - 1.0) > UNIT_LENGTH_TOLERANCE:
            raise InvalidFieldError(f"normals_W[{i}]", normals[i].tolist(), "a unit vector")
    for i, friction in enumerate(frictions.tolist()):
        if friction < 0.0:
            raise InvalidFieldError(f"frictions[{i}]", friction, ">= 0")
    for i, restitution in enumerate(() if restitutions is None else restitutions.tolist()):
        if not 0.0 <= restitution <= 1.0:
            raise InvalidFieldError(f"restitutions[{i}]", restitution, "in [0, 1]")
