"""Contact modes against the number of contacts; in the plane beside a linear program for each of 4^n strings.

Sets: `ring`, whose contacts all bound the motion (the most modes there are), `drawn`, where few do, and
`flush`, a row of feet, where all planes share a line. The linear programs are SciPy's HiGHS, on the `drawn`
set; they must find the same strings.
"""

from __future__ import annotations

import itertools
import math
import time
from typing import TYPE_CHECKING, Final

import numpy as np
from scipy.optimize import linprog

from contact_dynamics.contact import ContactSet
from contact_dynamics.contact_modes import planar_contact_modes, spatial_kinematic_modes
from contact_dynamics.contact_modes.enumeration import kinematic_cells
from contact_dynamics.contact_modes.problem import planar_problem
from contact_dynamics.planar import PlanarBody, PlanarContact, PlanarVelocity, PlanarWrench
from contact_dynamics.rigid_body import BodyState

if TYPE_CHECKING:
    from collections.abc import Callable

BODY: Final = PlanarBody(mass=1.0, inertia=1.0)
AT_REST: Final = PlanarVelocity(v=(0.0, 0.0), w=0.0)
WRENCH: Final = PlanarWrench(f=(0.1, -1.0), moment=0.05)
COUNTS: Final = (1, 2, 4, 8, 16, 32, 64, 200, 800)
MOST_STRINGS: Final = 4**4  # more take minutes
REPEATS: Final = 5


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


def best_of(task: Callable[[], object]) -> float:
    """Return the shortest of some runs, s."""
    best = math.inf
    for _ in range(REPEATS):
        start = time.perf_counter()
        task()
        best = min(best, time.perf_counter() - start)
    return best


def enumerate_only(contacts: list[PlanarContact]) -> dict[str, object]:
    """Return the kinematically possible modes."""
    at_rest = [(0.0, 0.0)] * len(contacts)
    problem = planar_problem(BODY, AT_REST, contacts, at_rest, WRENCH, velocity_tolerance=0.0)
    return dict(kinematic_cells(problem))


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


def in_space(n: int) -> ContactSet:
    """Return contacts all over a ball whose normals point upwards, more or less."""
    chance = np.random.default_rng(n)
    points = chance.normal(size=(n, 3))
    normals = np.array([0.0, 0.0, 1.0]) + 0.6 * chance.normal(size=(n, 3))
    return ContactSet(
        p_WC_W=points / np.linalg.norm(points, axis=1)[:, None],
        normals_W=normals / np.linalg.norm(normals, axis=1)[:, None],
        frictions=np.ones(n),
        restitutions=np.zeros(n),
    )


def run_in_space() -> None:
    """Print times and counts of contacting/separating modes in space."""
    still = BodyState(
        p_WB_W=np.zeros(3), q_WB=np.array([0.0, 0.0, 0.0, 1.0]), v_WB_W=np.zeros(3), w_WB_W=np.zeros(3)
    )
    print(f"\n{'n':>11} {'modes':>6} {'in space':>12}")
    for n in (4, 8, 16, 32):
        contacts = in_space(n)
        modes = len(spatial_kinematic_modes(still, contacts))
        seconds = best_of(lambda contacts=contacts: spatial_kinematic_modes(still, contacts))
        print(f"{n:11d} {modes:6d} {1e3 * seconds:9.2f} ms")


def run() -> None:
    """Print times and counts."""
    print(
        f"{'set':>6} {'n':>4} {'modes':>6} {'enumerate':>12} {'answer':>12} {'a mode':>10}"
        f" {'4^n programs':>14}"
    )
    for make in (ring, drawn, flush):
        for n in COUNTS:
            contacts = make(n)
            modes = len(enumerate_only(contacts))
            enumeration = best_of(lambda contacts=contacts: enumerate_only(contacts))
            answer = best_of(lambda contacts=contacts: planar_contact_modes(BODY, AT_REST, contacts, WRENCH))
            peer = ""
            if make is drawn and 4**n <= MOST_STRINGS:
                start = time.perf_counter()
                assert all_strings(contacts) == set(enumerate_only(contacts))
                peer = f"{1e3 * (time.perf_counter() - start):11.0f} ms"
            # One contact is answered in closed form, without enumeration.
            dynamics = (answer if n == 1 else max(0.0, answer - enumeration)) / modes
            print(
                f"{make.__name__:>6} {n:4d} {modes:6d} {1e3 * enumeration:9.3f} ms {1e3 * answer:9.3f} ms"
                f" {1e6 * dynamics:7.1f} us {peer:>14}"
            )
    run_in_space()
