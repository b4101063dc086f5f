# SPDX-License-Identifier: Apache-2.0
"""Every combination of letters in space, each with one linear program: slow, and complete by construction.

A contact separates (s), sticks (f), or slides (c) in one of 2 K ways on a pyramid of K edges: opposite to
an edge alone, or on the border between two. Contacts that move already, and those without friction, have one
edge and the letters s and c.
"""

from __future__ import annotations

import itertools

import numpy as np
from scipy.optimize import linprog

SLACK = 1e-6  # of the largest acceleration, by which an inequality must hold strictly


def consistent_combinations(
    mass: float,
    inertia: np.ndarray,
    *,
    r: np.ndarray,
    w: np.ndarray,
    wrench: np.ndarray,
    normals: np.ndarray,
    edges: list[np.ndarray],
) -> list[tuple[str, np.ndarray, np.ndarray]]:
    """Return letters and accelerations, linear and angular, of every combination that forces bring about.

    Args:
        mass: kg.
        inertia: (3, 3), kg m^2, world axes.
        r: (n, 3), m, contacts from the centre of mass, none of which approaches or leaves.
        w: (3,), rad/s.
        wrench: (6,), applied force and torque.
        normals: (n, 3), unit, into the body.
        edges: For each contact its force edges, (K, 3), around the normal in order.
    """
    n = len(r)
    starts = np.cumsum([0, *(len(one) for one in edges)])

    def accelerations(forces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        total = wrench[:3] + forces.sum(axis=0)
        moment = wrench[3:] + np.cross(r, forces).sum(axis=0) - np.cross(w, inertia @ w)
        a, alpha = total / mass, np.linalg.solve(inertia, moment)
        return a, alpha, a + np.cross(alpha, r) + np.cross(w, np.cross(w, r))

    def forces_of(shares: np.ndarray) -> np.ndarray:
        return np.array([shares[starts[i] : starts[i + 1]] @ edges[i] for i in range(n)]).reshape(-1, 3)

    free = accelerations(np.zeros((n, 3)))[2]
    scale = max(1e-12, float(np.abs(free).max(initial=0.0)), float(np.abs(wrench[:3]).max()) / mass)
    columns = [accelerations(forces_of(unit))[2] - free for unit in np.eye(int(starts[-1]))]
    points = np.concatenate([np.array(columns), free[None]]).transpose(1, 2, 0)  # (n, 3, K + 1)

    def options(i: int) -> list[tuple[str, set[int], list[np.ndarray], list[np.ndarray]]]:
        """Return letter, edges that act, what is zero, and what is positive."""
        normal, count = normals[i] @ points[i], len(edges[i])
        found: list[tuple[str, set[int], list[np.ndarray], list[np.ndarray]]] = [("s", set(), [], [normal])]
        if count == 1:
            return [*found, ("c", {0}, [normal], [])]
        # The normal is zero as well, so that any combination with it may stand for the tangential part.
        along = [edge @ points[i] for edge in edges[i]]
        found.append(("f", set(range(count)), [*points[i]], []))
        for j in range(count):
            before, after, second = (j - 1) % count, (j + 1) % count, (j + 2) % count
            found.append(("c", {j}, [normal], [along[before] - along[j], along[after] - along[j]]))
            found.append(
                (
                    "c",
                    {j, after},
                    [normal, along[j] - along[after]],
                    [along[before] - along[j], along[second] - along[after]],
                )
            )
        return found

    answers = []
    for chosen in itertools.product(*(options(i) for i in range(n))):
        bounds: list[tuple[float, float | None]] = [
            (0.0, None if j in acting else 0.0)
            for (_, acting, _, _), one in zip(chosen, edges, strict=True)
            for j in range(len(one))
        ]
        zero = [row for _, _, rows, _ in chosen for row in rows]
        positive = [row for _, _, _, rows in chosen for row in rows]
        outcome = linprog(
            np.append(np.zeros(len(bounds)), -1.0),
            A_eq=[np.append(row[:-1], 0.0) for row in zero] or None,
            b_eq=[-row[-1] for row in zero] or None,
            A_ub=[np.append(-row[:-1], scale) for row in positive] or None,
            b_ub=[row[-1] for row in positive] or None,
            bounds=[*bounds, (0.0, 1.0)],
            options={"primal_feasibility_tolerance": 1e-9},
        )
        if outcome.status == 0 and -outcome.fun > SLACK:
            a, alpha, _ = accelerations(forces_of(outcome.x[:-1]))
            answers.append(("".join(letter for letter, _, _, _ in chosen), a, alpha))
    return answers
