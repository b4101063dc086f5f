# SPDX-License-Identifier: Apache-2.0
"""This file finds impulses at several contacts at once, which complement the velocities that they lead to.

In compression, or in the whole impact under Newton's law, every contact with the velocity v after and v0
before obeys

    0 <= p,   v_n + e v_n0 >= 0 (e = 0 in compression),   one of the two zero,
    |I_t| <= mu p, and I_t opposes v_t with mu p where v_t is not zero.

This is Moreau's impact law with e (Newton's hypothesis; Moreau 1988). Under Poisson's hypothesis, a second
problem of the same kind follows the compression. In it each contact gives back at least e times its normal
impulse of compression (Anitescu and Potra 1997). Friction acts on the velocity at the end of each problem, so
within one of them sliding does not reverse.

The method is block Gauss-Seidel over the contacts with the exact (round) friction cones. It projects the
impulse of one contact after the other onto its cone until no impulse changes. With friction, and where
contacts are redundant, there may be several solutions, and the order in which contacts are listed then
decides which one this method ends at. So all contacts are projected at once as well, which knows no order.
Where the two disagree, the second is the answer. It is the same for every listing, and it is symmetric if the
contacts are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact.law import RestitutionLaw
from contact_dynamics.impact.several.tied import Response, twist_after
from contact_dynamics.tolerances import SAME_IMPULSES, SWEEPS_CONVERGED
from contact_dynamics.validation import FloatArray

if TYPE_CHECKING:
    from contact_dynamics.contact.contact import ContactSet

MAX_SWEEPS: Final = 5000
"""Number of sweeps after which the problem counts as not converged."""

MAX_PROJECTIONS: Final = 100_000
"""Bound on the projections of single impulses in one problem, which take some 2 s. Up to 20 contacts,
`MAX_SWEEPS` ends the problem before."""

_MAX_STEPS: Final = 20_000
"""Bound on the steps of all contacts at once. They are smaller than those of one contact after the other,
and cheaper."""

_MAX_PRODUCTS: Final = 2_000_000_000
"""Bound on the products in all these steps, which take some 2 s. Up to 105 contacts, `_MAX_STEPS` ends the
problem before."""


def simultaneous_impulses(
    contacts: ContactSet, law: RestitutionLaw, response: Response, *, tolerance: float
) -> tuple[FloatArray, bool]:
    """Return the impulses, (n, 3), N s, world axes, and whether the iteration converged.

    Contacts that separate faster than ``tolerance``, m/s, take part too. They strike if the others turn the
    bodies into them. One that approaches less fast does not bounce.

    Raises:
        TooLargeError: the impulses have not converged after `MAX_PROJECTIONS` projections.
        InvalidFieldError: the law is neither Poisson's nor Newton's.
    """
    if law not in {RestitutionLaw.POISSON, RestitutionLaw.NEWTON}:
        raise InvalidFieldError("restitution_law", law.name, "POISSON or NEWTON for SIMULTANEOUS")
    normals = contacts.normals_W
    approach = np.minimum(np.einsum("ij,ij->i", response.jacobian @ response.twist, normals), 0.0)
    approach[approach >= -tolerance] = 0.0

    none = np.zeros(len(contacts))
    # `RestitutionRule` needs a path, and there is none here. Newton's law asks for velocities, in one
    # problem, and Poisson's for impulses, in a second one.
    if law == RestitutionLaw.NEWTON:
        bounce = -contacts.impact_restitutions * approach
        return _solve(_Problem(*response, normals, contacts.frictions, none, bounce))
    compression, converged = _solve(_Problem(*response, normals, contacts.frictions, none, none))
    compressed = response._replace(twist=twist_after(response, compression))
    least = contacts.impact_restitutions * np.einsum("ij,ij->i", compression, normals)
    if not least.any():
        return compression, converged
    restitution, also = _solve(_Problem(*compressed, normals, contacts.frictions, least, none))
    return compression + restitution, converged and also


class _Problem(NamedTuple):
    """One complementarity problem."""

    jacobian: FloatArray  # as `Response` has these three
    inverse_mass: FloatArray
    twist: FloatArray
    normals: FloatArray  # (n, 3)
    frictions: FloatArray  # (n,)
    least: FloatArray  # (n,), N s, lower bounds of the normal impulses
    bounce: FloatArray  # (n,), m/s, lower bounds of the normal velocities afterwards


def _solve(problem: _Problem) -> tuple[FloatArray, bool]:
    """Return impulses of at least ``least`` that leave velocities of at least ``bounce``, along normals."""
    listed = tuple(range(len(problem.normals)))
    impulses, converged = _in_turn(problem, listed)
    if len(listed) == 1:
        return impulses, converged
    together, also = _together(problem)
    if not also:
        # Then the contacts are taken in an order that depends on what they are, and not on the list.
        velocities = np.round(np.einsum("ijk,k->ij", problem.jacobian, problem.twist), 9)
        values = np.column_stack([velocities, problem.frictions, problem.normals])
        canonical = tuple(sorted(listed, key=lambda i: values[i].tolist()))
        together, also = _in_turn(problem, canonical)
    size = float(np.abs(together).max())
    if converged and (not also or float(np.abs(impulses - together).max()) <= SAME_IMPULSES * size):
        return impulses, converged
    return together, also


def _together(problem: _Problem) -> tuple[FloatArray, bool]:
    """Return impulses by projecting all contacts at once, and whether that converged."""
    jacobian, inverse_mass, twist, normals, frictions, least, bounce = problem
    n = len(normals)
    rows = jacobian.reshape(3 * n, -1)
    response = rows @ inverse_mass @ rows.T
    step_size = 1.0 / float(np.linalg.eigvalsh(response)[-1])
    free = rows @ twist
    impulses = least[:, None] * normals
    scale = float(abs(free + response @ impulses.ravel()).max())
    for _ in range(min(_MAX_STEPS, max(_MAX_PRODUCTS // (3 * n) ** 2, 1))):
        velocity = (free + response @ impulses.ravel()).reshape(n, 3)
        v_n = np.einsum("ij,ij->i", velocity, normals)
        p = np.maximum(np.einsum("ij,ij->i", impulses, normals) - step_size * (v_n - bounce), least)
        trial = impulses - step_size * velocity
        tangential = trial - np.einsum("ij,ij->i", trial, normals)[:, None] * normals
        sizes = np.sqrt(np.einsum("ij,ij->i", tangential, tangential))
        edge = frictions * p
        beyond = sizes > edge
        tangential[beyond] *= (edge[beyond] / sizes[beyond])[:, None]
        after = p[:, None] * normals + tangential
        change = float(abs(after - impulses).max())
        impulses = after
        if change <= SWEEPS_CONVERGED * scale * step_size:
            return impulses, True
    return impulses, False


def _in_turn(problem: _Problem, order: tuple[int, ...]) -> tuple[FloatArray, bool]:
    """Return impulses by projecting one contact after the other, and whether that converged."""
    jacobian, inverse_mass, twist, normals, frictions, least, bounce = problem
    response = inverse_mass @ jacobian.transpose(0, 2, 1)  # (n, 6 k, 3)
    blocks = jacobian @ response  # (n, 3, 3)
    impulses = least[:, None] * normals
    twist = twist + np.einsum("ijk,ik->j", response, impulses)
    scale = float(abs(jacobian @ twist).max())
    # One over the largest eigenvalue of a block is a step for which its projection converges.
    steps = 1.0 / np.linalg.eigvalsh(blocks)[:, -1]
    sweeps = min(MAX_SWEEPS, max(MAX_PROJECTIONS // len(normals), 1))
    for _ in range(sweeps):
        change = 0.0
        for i in order:
            n = normals[i]
            velocity = jacobian[i] @ twist
            v_n = velocity @ n
            trial = impulses[i] - steps[i] * velocity
            p = max(float(impulses[i] @ n - steps[i] * (v_n - bounce[i])), least[i])
            tangential = trial - (trial @ n) * n
            size = float(np.linalg.norm(tangential))
            if size > frictions[i] * p:
                tangential *= frictions[i] * p / size
            step = p * n + tangential - impulses[i]
            impulses[i] += step
            twist = twist + response[i] @ step
            change = max(change, float(abs(blocks[i] @ step).max()))
        if change <= SWEEPS_CONVERGED * scale:
            return impulses, True
    if sweeps < MAX_SWEEPS:
        found = f"{len(normals)} contacts at once, whose impulses do not settle in {sweeps} sweeps"
        allowed = f"{MAX_PROJECTIONS // MAX_SWEEPS} contacts or fewer, or SEQUENTIAL (0)"
        raise TooLargeError("contacts", found, allowed)
    return impulses, False
