# SPDX-License-Identifier: Apache-2.0
"""Contact modes in space against the number of contacts, beside a linear program for each string of letters.

There are two kinds of sets. A `drawn` set has contacts all over a ball whose normals point more or less
upwards. A `flush` set is a face with this many corners on a table. The linear programs are SciPy's HiGHS. For
contacting and separating modes there is one for each of 2^n strings. For modes with mechanics there is one
for each string of letters and sectors, (2 + 2 k)^n with k facets. They must find equally many modes. At the
end come whole answers for the flush face under loads of every sort, with friction turned exactly and all
sectors of the same letters as one mode.
"""

from __future__ import annotations

import itertools
import math
import time
from functools import partial
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import linprog

from benchmarks._quotes import quote
from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.friction import linearised_cone
from contact_dynamics.contact_modes import (
    SpatialContactProblem,
    contact_modes,
    mode_margins,
    spatial_kinematic_modes,
    wrench_sets,
)
from contact_dynamics.rigid_body.body import BodyState, MassProperties

if TYPE_CHECKING:
    from collections.abc import Callable

BODY: Final = MassProperties(mass=1.0, I_B=np.diag([0.1, 0.12, 0.15]))
WEIGHT: Final = 10.0
COUNTS: Final = (1, 2, 4, 8, 16, 32)
FEW_AND_MANY: Final = (4, 8)  # facets
MAX_BY_FACETS: Final = 4  # contacts for which both are shown
MAX_STRINGS: Final = 2**8  # more take minutes
REPEATS: Final = 5
PUSHES: Final = {"rests": 0.0, "is pushed": 0.3, "slides off": 0.6}  # share of the weight; friction holds 0.5
SLACK: Final = 1e-7
LOADS: Final = {  # parts of the weight: force along x and y, torque per metre about x, y, z
    "rests": (0.0, 0.0, 0.0, 0.0, 0.0),
    "is pushed": (0.45, 0.2, 0.0, 0.0, 0.0),
    "slides off": (0.6, 0.03, 0.0, 0.0, 0.0),
    "is twisted": (0.0, 0.0, 0.0, 0.0, 0.8),
    "is pushed and twisted": (0.45, 0.2, 0.0, 0.0, 0.3),
    "tips": (0.1, 0.05, 0.1, 1.2, 0.05),
}


def state(speed: float = 0.0) -> BodyState:
    """Return a body at the origin that translates along x."""
    return BodyState(
        p_WB_W=np.zeros(3),
        q_WB=np.array([0.0, 0.0, 0.0, 1.0]),
        v_WB_W=np.array([speed, 0.0, 0.0]),
        w_WB_W=np.zeros(3),
    )


def contact_set(points: np.ndarray, normals: np.ndarray) -> ContactSet:
    """Return contacts of friction 0.5."""
    n = len(points)
    return ContactSet(
        p_WC_W=points,
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=np.full(n, 0.5),
        restitutions=np.zeros(n),
    )


def drawn(n: int) -> ContactSet:
    """Return contacts all over a ball whose normals point upwards, more or less."""
    chance = np.random.default_rng(n)
    points = chance.normal(size=(n, 3))
    normals = np.array([0.0, 0.0, 1.0]) + 0.6 * chance.normal(size=(n, 3))
    return contact_set(points / np.linalg.norm(points, axis=1)[:, None], normals)


def flush(n: int) -> ContactSet:
    """Return the corners of a regular face on a table."""
    angles = 2.0 * math.pi * (np.arange(n) + 0.5) / n
    points = np.column_stack([np.cos(angles), np.sin(angles), np.full(n, -0.3)])
    return contact_set(points, np.tile([0.0, 0.0, 1.0], (n, 1)))


def best_of(task: Callable[[], object]) -> float:
    """Return the shortest of some runs, s."""
    best = math.inf
    for _ in range(REPEATS):
        start = time.thread_time()
        task()
        best = min(best, time.thread_time() - start)
    return best


def every_string(contacts: ContactSet) -> int:
    """Return how many contacting and separating strings are possible, by a linear program for each."""
    rows = np.hstack([contacts.normals_W, np.cross(contacts.p_WC_W, contacts.normals_W)])
    found = 0
    for stays in itertools.product([True, False], repeat=len(rows)):
        equal, above = rows[list(stays)], rows[[not one for one in stays]]
        outcome = linprog(
            [0.0] * 6 + [-1.0],
            A_eq=np.column_stack([equal, np.zeros(len(equal))]) if len(equal) else None,
            b_eq=np.zeros(len(equal)) if len(equal) else None,
            A_ub=np.column_stack([-above, np.ones(len(above))]) if len(above) else None,
            b_ub=np.zeros(len(above)) if len(above) else None,
            bounds=[(-1.0, 1.0)] * 6 + [(0.0, 1.0)],
        )
        found += outcome.status == 0 and -outcome.fun > SLACK
    return found


def every_letter(contacts: ContactSet, force: np.ndarray, facets: int) -> int:
    """Return how many strings of letters and sectors forces bring about, by a linear program for each."""
    r, n = contacts.p_WC_W, len(contacts)
    inverse = np.linalg.inv(BODY.I_B)
    free = force / BODY.mass
    edges = [
        linearised_cone(normal, 0.5, facets, towards=-free) for normal in contacts.normals_W
    ]  # (K, 3) each
    points = np.zeros((n, 3, facets * n + 1))
    points[:, :, -1] = free
    for i in range(n):
        for j, edge in enumerate(edges[i]):
            turning = inverse @ np.cross(r[i], edge)
            points[:, :, facets * i + j] = edge / BODY.mass + np.cross(turning, r)

    def letters(i: int) -> list[tuple[set[int], list[np.ndarray], list[np.ndarray]]]:
        normal, along = contacts.normals_W[i] @ points[i], edges[i] @ points[i]
        found: list[tuple[set[int], list[np.ndarray], list[np.ndarray]]] = [
            (set(), [], [normal]),
            (set(range(facets)), list(points[i]), []),
        ]
        for j in range(facets):
            before, after, second = along[j - 1], along[(j + 1) % facets], along[(j + 2) % facets]
            found.append(({j}, [normal], [before - along[j], after - along[j]]))
            acting = {j, (j + 1) % facets}
            found.append((acting, [normal, along[j] - after], [before - along[j], second - after]))
        return found

    count = 0
    for chosen in itertools.product(*(letters(i) for i in range(n))):
        zero = np.array([row for _, rows, _ in chosen for row in rows]).reshape(-1, facets * n + 1)
        above = np.array([row for _, _, rows in chosen for row in rows]).reshape(-1, facets * n + 1)
        outcome = linprog(
            np.append(np.zeros(facets * n), -1.0),
            A_eq=np.column_stack([zero[:, :-1], np.zeros(len(zero))]) if len(zero) else None,
            b_eq=-zero[:, -1] if len(zero) else None,
            A_ub=np.column_stack([-above[:, :-1], np.ones(len(above))]) if len(above) else None,
            b_ub=above[:, -1] if len(above) else None,
            bounds=[(0.0, None if j in acting else 0.0) for acting, _, _ in chosen for j in range(facets)]
            + [(0.0, 1.0)],
        )
        count += outcome.status == 0 and -outcome.fun > SLACK
    return count


def run_kinematic() -> None:
    """Print times of contacting and separating modes."""
    print(f"{'contacting':>12} {'n':>4} {'modes':>6} {'all modes':>12} {'2^n programs':>14} {'ratio':>7}")
    for make in (drawn, flush):
        for n in COUNTS:
            contacts = make(n)
            modes = len(spatial_kinematic_modes(state(), contacts))
            seconds = best_of(partial(spatial_kinematic_modes, state(), contacts))
            peer = ""
            if 2**n <= MAX_STRINGS:
                start = time.thread_time()
                assert every_string(contacts) == modes
                brute = time.thread_time() - start
                peer = f"{1e3 * brute:11.0f} ms {brute / seconds:6.0f}x"
            print(f"{make.__name__:>12} {n:4d} {modes:6d} {1e3 * seconds:9.2f} ms {peer:>14}")


def run_mechanics() -> None:
    """Print times of modes with mechanics: sticking and sliding, accelerations and forces."""
    print(
        f"\n{'mechanics':>12} {'n':>4} {'facets':>6} {'what':>11} {'modes':>6} {'tried':>6} {'answer':>12}"
        f" {'(2+2k)^n programs':>18} {'ratio':>7}"
    )
    for make, n, facets, (what, share) in itertools.product(
        (flush, drawn), COUNTS, FEW_AND_MANY, PUSHES.items()
    ):
        if n > MAX_BY_FACETS and facets < FEW_AND_MANY[-1]:
            continue
        contacts = make(n)
        force = WEIGHT * np.array([share, 0.05 * (share > 0.0), -1.0])

        problem = SpatialContactProblem(
            body=BODY,
            state=state(),
            contacts=contacts,
            force_W=force,
            friction_facets=facets,
            sharpen=False,
        )
        ask = partial(contact_modes, problem)
        answer = ask()
        seconds = best_of(ask)
        peer = ""
        if (2 + 2 * facets) ** n <= MAX_STRINGS:
            start = time.thread_time()
            assert every_letter(contacts, force, facets) == len(answer.modes)
            brute = time.thread_time() - start
            peer = f"{1e3 * brute:15.0f} ms {brute / seconds:6.0f}x"
        print(
            f"{make.__name__:>12} {n:4d} {facets:6d} {what:>11} {len(answer.modes):6d} {answer.examined:6d}"
            f" {1e3 * seconds:9.2f} ms {peer:>18}"
        )
    contacts = flush(4)
    print("\na box that slides on a table already, friction exact: ", end="")
    down = (0.0, 0.0, -WEIGHT)
    problem = SpatialContactProblem(body=BODY, state=state(1.0), contacts=contacts, force_W=down)
    seconds = best_of(partial(contact_modes, problem))
    print(f"{1e3 * seconds:.2f} ms")
    leaning, force = drawn(4), np.array([6.0, 0.5, -WEIGHT])
    for sharpen in (False, True):
        problem = SpatialContactProblem(
            body=BODY, state=state(), contacts=leaning, force_W=force, sharpen=sharpen
        )
        seconds = best_of(partial(contact_modes, problem))
        how = "turned exactly" if sharpen else "on facets"
        print(f"four drawn contacts, friction {how}: {1e3 * seconds:.2f} ms")


def run_answers() -> None:
    """Print times of whole answers under loads of every sort."""
    print(
        f"\n{'answers':>12} {'n':>4} {'what':>22} {'modes':>6} {'one motion':>10} {'tried':>6} {'answer':>12}"
    )
    costs: dict[int, list[float]] = {}
    for n, (what, (x, y, *torque)) in itertools.product(COUNTS[2:], LOADS.items()):
        problem = SpatialContactProblem(
            body=BODY,
            state=state(),
            contacts=flush(n),
            force_W=WEIGHT * np.array([x, y, -1.0]),
            torque_W=WEIGHT * np.array(torque),
        )
        ask = partial(contact_modes, problem)
        answer = ask()
        alone = all(mode.motion_unique for mode in answer.modes)
        costs.setdefault(n, []).append(1e3 * best_of(ask))
        print(
            f"{'flush':>12} {n:4d} {what:>22} {len(answer.modes):6d} {'yes' if alone else 'no':>10}"
            f" {answer.examined:6d} {costs[n][-1]:9.2f} ms"
        )
    for n, spent in costs.items():
        quote(f"spatial_modes.flush.{n}", spent, "ms")


def run_evidence() -> None:
    """Print times of margins, wrench sets and the like for a box on four feet."""
    feet, costs = flush(4), []
    print(f"\n{'margins of':>12} {'what':>22} {'answer':>12}")
    for what, (x, y, *torque) in LOADS.items():
        problem = SpatialContactProblem(
            body=BODY,
            state=state(),
            contacts=feet,
            force_W=WEIGHT * np.array([x, y, -1.0]),
            torque_W=WEIGHT * np.array(torque),
        )
        ask = partial(mode_margins, problem)
        start = time.thread_time()  # once, because some take seconds
        ask()
        costs.append(time.thread_time() - start)
        print(f"{'flush':>12} {what:>22} {1e3 * costs[-1]:9.0f} ms")
    quote("spatial_modes.margins", [1e3 * spent for spent in costs], "ms", digits=1)
    for facets in FEW_AND_MANY:
        problem = SpatialContactProblem(
            body=BODY, state=state(), contacts=feet, force_W=np.zeros(3), friction_facets=facets
        )
        ask_sets = partial(wrench_sets, problem)
        sets, seconds = len(ask_sets()), best_of(ask_sets)
        print(f"{sets} sets of wrenches with {facets} facets: {1e3 * seconds / sets:.2f} ms each")
        quote(f"spatial_modes.wrench_sets.{facets}", 1e3 * seconds / sets, "ms", digits=1)


def run() -> None:
    """Print times and counts."""
    run_kinematic()
    run_mechanics()
    run_answers()
    run_evidence()
