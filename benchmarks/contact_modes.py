# SPDX-License-Identifier: Apache-2.0
"""Contact modes in the plane against the number of contacts, beside linear programs.

There are four kinds of sets. In a `ring` all contacts bound the motion, which gives the most modes. In a
`drawn` set few do. A `flush` set is a row of feet, whose planes all share a line. A `slot` is a row of feet
with another one against it. The linear programs are SciPy's HiGHS, one for each of the 4^n strings, and one
for the forces of each mode that is left. They must find the same strings and the same modes.

The targets for enumeration are 0.3, 2, 6 and 25 ms at 4, 16, 64 and 200 contacts, growing by no more than
n^2. The targets for judging are 30 us a mode in bulk, and 100 us for any one.
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
from contact_dynamics.contact_modes import PlanarContactProblem, contact_modes
from contact_dynamics.contact_modes.planar.enumeration import kinematic_cells
from contact_dynamics.contact_modes.planar.judgement import judge_all
from contact_dynamics.contact_modes.planar.problem import planar_case
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.tolerances import ACCELERATION_TOLERANCE

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.contact_modes.planar.enumeration import Cell
    from contact_dynamics.contact_modes.planar.problem import PlanarCase

BODY: Final = PlanarBody(mass=1.0, inertia=1.0)
AT_REST: Final = PlanarVelocity(v=(0.0, 0.0), w=0.0)
WRENCH: Final = PlanarWrench(f=(0.1, -1.0), moment=0.05)
COUNTS: Final = (1, 2, 4, 8, 16, 32, 64, 200, 800)
MAX_STRINGS: Final = 4**4  # more take minutes
MAX_PROGRAMS: Final = 16  # contacts, up to which the modes are compared with linear programs
MAX_TIMED: Final = 40  # modes of a set that are timed one by one
REPEATS: Final = 5  # at least
AT_LEAST_S: Final = 0.02


def ring(n: int) -> list[PlanarContact]:
    """Return contacts whose planes all touch one round cone of accelerations."""
    found = []
    for i in range(n):
        angle = 2.0 * math.pi * (i + 0.3) / n
        length = math.hypot(0.5 * math.cos(angle), 1.0)
        n_x, n_y, arm = 0.5 * math.cos(angle) / length, 1.0 / length, 0.5 * math.sin(angle) / length
        found.append(
            PlanarContact(r=(arm * n_y + 0.1 * n_x, -arm * n_x + 0.1 * n_y), normal=(n_x, n_y), friction=0.5)
        )
    return found


def drawn(n: int) -> list[PlanarContact]:
    """Return contacts around a disc whose normals point upwards, more or less."""
    chance = np.random.default_rng(n)
    found = []
    for _ in range(n):
        at, lean = float(chance.uniform(0.0, 2.0 * math.pi)), float(chance.uniform(0.15, math.pi - 0.15))
        found.append(
            PlanarContact(
                r=(math.cos(at), math.sin(at)), normal=(math.cos(lean), math.sin(lean)), friction=0.5
            )
        )
    return found


def flush(n: int) -> list[PlanarContact]:
    """Return a row of feet on a floor."""
    return [PlanarContact(r=((i + 0.5) / n - 0.5, -0.5), normal=(0.0, 1.0), friction=0.5) for i in range(n)]


def slot(n: int) -> list[PlanarContact]:
    """Return feet on a floor and, every other one, under a ceiling."""
    return [
        PlanarContact(
            r=((i // 2 + 0.5) / n - 0.5, 0.5 if i % 2 else -0.5),
            normal=(0.0, -1.0 if i % 2 else 1.0),
            friction=0.5,
        )
        for i in range(n)
    ]


def best_of(task: Callable[[], object]) -> float:
    """Return the shortest of some runs, s."""
    best = math.inf
    repeats, until = 0, time.thread_time() + AT_LEAST_S
    while repeats < REPEATS or time.thread_time() < until:
        start = time.thread_time()
        task()
        best = min(best, time.thread_time() - start)
        repeats += 1
    return best


def case_of(contacts: list[PlanarContact]) -> PlanarCase:
    """Return the case of a body at rest."""
    at_rest = [(0.0, 0.0)] * len(contacts)
    problem = PlanarContactProblem(body=BODY, contacts=contacts, wrench=WRENCH, velocity_tolerance=0.0)
    return planar_case(problem, contacts, at_rest)


def enumerate_only(contacts: list[PlanarContact]) -> dict[str, Cell]:
    """Return the kinematically possible modes."""
    return kinematic_cells(case_of(contacts))


def slowest_mode(contacts: list[PlanarContact]) -> float:
    """Return the time of the mode that takes longest to judge, s, of some over all the set."""
    problem = case_of(contacts)
    cells = kinematic_cells(problem)
    chosen = sorted(cells)[:: 1 + len(cells) // MAX_TIMED]

    def judged(some: Mapping[str, Cell]) -> float:
        return best_of(lambda: judge_all(problem, some, ACCELERATION_TOLERANCE))

    return max(judged({mode: cells[mode]}) for mode in chosen)


def all_strings(contacts: list[PlanarContact]) -> set[str]:
    """Return the same by a linear program for each string: the largest slack of its strict inequalities."""
    normals = np.array([(*c.normal, c.r[0] * c.normal[1] - c.r[1] * c.normal[0]) for c in contacts])
    tangents = np.array([(*c.tangent, c.r[0] * c.tangent[1] - c.r[1] * c.tangent[0]) for c in contacts])
    found = set()
    for letters in itertools.product("slrf", repeat=len(contacts)):
        equal = [normals[i] for i, letter in enumerate(letters) if letter != "s"]
        equal += [tangents[i] for i, letter in enumerate(letters) if letter == "f"]
        positive = [normals[i] for i, letter in enumerate(letters) if letter == "s"]
        positive += [tangents[i] for i, letter in enumerate(letters) if letter == "r"]
        positive += [-tangents[i] for i, letter in enumerate(letters) if letter == "l"]
        outcome = linprog(
            [0.0, 0.0, 0.0, -1.0],
            A_eq=[[*row, 0.0] for row in equal] or None,
            b_eq=[0.0] * len(equal) or None,
            A_ub=[[*-row, 1.0] for row in positive] or None,
            b_ub=[0.0] * len(positive) or None,
            bounds=[(-1.0, 1.0)] * 3 + [(0.0, 1.0)],
        )
        if outcome.status == 0 and -outcome.fun > 1e-7:
            found.add("".join(letters))
    return found


def program_of_mode(contacts: list[PlanarContact], letters: str) -> bool:
    """Return whether forces bring a mode about, by a linear program: forces along edges, and their motion."""
    rows = {
        axis: np.array([(*d, c.r[0] * d[1] - c.r[1] * d[0]) for c in contacts for d in (getattr(c, axis),)])
        for axis in ("normal", "tangent")
    }
    N, T = rows["normal"], rows["tangent"]
    edges = [(i, -1.0) for i, letter in enumerate(letters) if letter in "rf"]
    edges += [(i, 1.0) for i, letter in enumerate(letters) if letter in "lf"]
    forces = [N[i] + sign * contacts[i].friction * T[i] for i, sign in edges]
    # Unknowns: acceleration, forces, slack. For unit mass and inertia acceleration less forces is the wrench.
    free = [0.0] * len(edges)
    equal = [[*row, *free, 0.0] for i, row in enumerate(N) if letters[i] != "s"]
    equal += [[*row, *free, 0.0] for i, row in enumerate(T) if letters[i] == "f"]
    newton = [[*np.eye(3)[k], *(-force[k] for force in forces), 0.0] for k in range(3)]
    positive = [[*-row, *free, 1.0] for i, row in enumerate(N) if letters[i] == "s"]
    positive += [[*(t if x == "l" else -t), *free, 1.0] for t, x in zip(T, letters, strict=True) if x in "lr"]
    outcome = linprog(
        [*[0.0] * (3 + len(edges)), -1.0],
        A_eq=[*equal, *newton],
        b_eq=[0.0] * len(equal) + [*WRENCH.f, WRENCH.moment],
        A_ub=positive or None,
        b_ub=[0.0] * len(positive) or None,
        bounds=[(None, None)] * 3 + [(0.0, None)] * len(edges) + [(0.0, 1.0)],
    )
    return bool(outcome.status == 0 and -outcome.fun > 1e-9)


def run() -> None:
    """Print times and counts."""
    print(
        f"{'set':>6} {'n':>4} {'modes':>6} {'enumerate':>12} {'answer':>12} {'a mode':>10} {'slowest':>10}"
        f" {'program of one':>15} {'4^n programs':>14}"
    )
    for make in (ring, drawn, flush, slot):
        times = {}
        for n in COUNTS:
            contacts = make(n)
            problem = PlanarContactProblem(body=BODY, velocity=AT_REST, contacts=contacts, wrench=WRENCH)
            modes = len(enumerate_only(contacts))
            times[n] = best_of(partial(enumerate_only, contacts))
            answer = best_of(partial(contact_modes, problem))
            quote(f"contact_modes.{make.__name__}.{n}", 1e3 * answer, "ms")
            # One contact is answered in closed form, without enumeration.
            dynamics = (answer if n == 1 else max(0.0, answer - times[n])) / modes
            print(
                f"{make.__name__:>6} {n:4d} {modes:6d} {1e3 * times[n]:9.3f} ms {1e3 * answer:9.3f} ms"
                f" {1e6 * dynamics:7.1f} us {1e6 * slowest_mode(contacts):7.1f} us {peers(make, contacts)}",
                flush=True,
            )
        few, many = COUNTS[-3], COUNTS[-1]
        growth = math.log(times[many] / times[few]) / math.log(many / few)
        print(f"{make.__name__:>6} from {few} to {many} contacts the enumeration grows as n^{growth:.1f}")


def peers(make: Callable[[int], list[PlanarContact]], contacts: list[PlanarContact]) -> str:
    """Return the times of the linear programs, if there are not too many. Their answers must agree."""
    n = len(contacts)
    if n > MAX_PROGRAMS:
        return ""
    answer = contact_modes(
        PlanarContactProblem(body=BODY, velocity=AT_REST, contacts=contacts, wrench=WRENCH)
    )
    start = time.thread_time()
    found = [mode for mode in answer.kinematic_modes if program_of_mode(contacts, mode)]
    one = (time.thread_time() - start) / len(answer.kinematic_modes)
    assert found == [mode.mode for mode in answer.modes]
    text = f"{1e6 * one:12.0f} us"
    if make is drawn and 4**n <= MAX_STRINGS:
        start = time.thread_time()
        assert all_strings(contacts) == set(answer.kinematic_modes)
        spent = time.thread_time() - start
        quote(f"contact_modes.drawn.{n}.programs", 1e3 * spent, "ms")
        text += f" {1e3 * spent:11.0f} ms"
    return text
