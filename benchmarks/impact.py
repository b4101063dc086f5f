"""What an impact costs, in the plane, in space, in batches, for several contacts; and how well it predicts.

Costs are processor time of this thread, so that a busy machine matters less. Predictions are compared with
measured impacts in `_impact_tosses`.
"""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Final

import numpy as np

from benchmarks import _impact_tosses
from contact_dynamics.contact import ContactSet
from contact_dynamics.impact import (
    ImpactOutcome,
    RestitutionLaw,
    SeveralContactsLaw,
    outcomes_over_orders,
    planar_impact,
    planar_impacts,
    several_impact,
    spatial_impact,
    spatial_pair_impact,
)
from contact_dynamics.impact.routh import impulse_path, inverse_inertia
from contact_dynamics.planar import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body import BodyState, MassProperties

if TYPE_CHECKING:
    from collections.abc import Callable

BODY: Final = PlanarBody(mass=1.0, inertia=1.0)
CASES: Final = 200_000
DRAWS: Final = 600
REPEATS: Final = 5


def run() -> None:
    """Print costs, then errors over measured tosses where the recordings are at hand."""
    print("One planar impact, us (target: 2)")
    for law in RestitutionLaw:
        print(f"  {law.name:>10}  path {_path(law):5.2f}   whole answer {_planar(law):5.2f}")
    print(f"\nBatches of {CASES} planar impacts, ns a case (target: 150), and cases a second")
    for text, normals in (("one normal", False), ("a normal a case", True)):
        for law in RestitutionLaw:
            seconds = _batch(law, normals=normals) / CASES
            print(f"  {law.name:>10}  {text:>16} {1e9 * seconds:6.0f} {1.0 / seconds:12.2e}")
    print(f"\nOne impact in space, us, over {DRAWS} random bodies and contacts: median, 90 %, worst")
    _spatial()
    print("\nA cube on its face with four contacts, ms")
    _several()
    print()
    _impact_tosses.run()


def _best(action: Callable[[], object], calls: int) -> float:
    """Return the seconds that one call takes, at best."""
    best = np.inf
    for _ in range(REPEATS):
        start = time.thread_time()
        for _ in range(calls):
            action()
        best = min(best, (time.thread_time() - start) / calls)
    return float(best)


def _path(law: RestitutionLaw) -> float:
    response = inverse_inertia(1.0, 1.0, -1.0, -4.0)
    return 1e6 * _best(lambda: impulse_path(-1.0, -1.0, response, 0.25, 0.5, law), 20_000)


def _planar(law: RestitutionLaw) -> float:
    velocity = PlanarVelocity(v=(-1.0, -1.0), w=0.0)
    contact = PlanarContact(r=(-1.0, -4.0), normal=(0.0, 1.0), friction=0.25, restitution=0.5)
    return 1e6 * _best(lambda: planar_impact(BODY, velocity, contact, law=law), 5_000)


def _batch(law: RestitutionLaw, *, normals: bool) -> float:
    rng = np.random.default_rng(0)
    angle = 0.5 * rng.normal(size=CASES) if normals else np.zeros(CASES)
    directions = np.column_stack((np.sin(angle), np.cos(angle)))
    along = np.column_stack((directions[:, 1], -directions[:, 0]))
    velocities = -directions + rng.normal(size=(CASES, 1)) * along
    arms, frictions = rng.normal(size=(CASES, 2)), rng.uniform(0.0, 1.0, CASES)
    return _best(
        lambda: planar_impacts(
            masses=1.0,
            inertias=1.0,
            v=velocities,
            w=0.0,
            r=arms,
            normals=directions if normals else (0.0, 1.0),
            frictions=frictions,
            restitutions=0.5,
            law=law,
        ),
        1,
    )


def _spatial() -> None:
    rng = np.random.default_rng(1)
    problems = [_spatial_problem(rng) for _ in range(DRAWS)]
    other = MassProperties(mass=1.0, I_B=np.diag([0.3, 0.4, 0.5]))
    for law in RestitutionLaw:
        seconds: dict[ImpactOutcome | str, list[float]] = {}
        for body, state, contact in problems:
            start = time.thread_time()
            answer = spatial_impact(body, state, law=law, **contact)  # type: ignore[arg-type]
            spent = time.thread_time() - start
            for kind in ("all", answer.outcome):
                seconds.setdefault(kind, []).append(spent)
            still = BodyState(p_WB_W=-state.p_WB_W, q_WB=state.q_WB, v_WB_W=np.zeros(3), w_WB_W=np.zeros(3))
            start = time.thread_time()
            spatial_pair_impact(body, state, other, still, law=law, **contact)  # type: ignore[arg-type]
            seconds.setdefault("two bodies", []).append(time.thread_time() - start)
        for kind, spent_on in sorted(seconds.items(), key=lambda item: str(item[0])):
            name = kind.name if isinstance(kind, ImpactOutcome) else kind
            median, high, worst = 1e6 * np.percentile(spent_on, [50.0, 90.0, 100.0])
            print(f"  {law.name:>10} {name:>24} {len(spent_on):5d} x {median:7.0f} {high:7.0f} {worst:7.0f}")


def _spatial_problem(rng: np.random.Generator) -> tuple[MassProperties, BodyState, dict[str, object]]:
    moments = rng.uniform(0.05, 1.0, size=3)
    body = MassProperties(mass=float(rng.uniform(0.5, 2.0)), I_B=np.diag(moments.sum() - moments))
    quaternion, normal = rng.normal(size=4), rng.normal(size=3)
    state = BodyState(
        p_WB_W=np.zeros(3),
        q_WB=quaternion / np.linalg.norm(quaternion),
        v_WB_W=rng.normal(size=3),
        w_WB_W=rng.normal(size=3),
    )
    point = rng.normal(size=3)
    normal /= np.linalg.norm(normal)
    if normal @ state.velocity_of_point(point) > 0.0:
        normal = -normal
    contact = {
        "p_WC_W": point,
        "n_W": normal,
        "friction": float(10.0 ** rng.uniform(-1.5, 0.3)),
        "restitution": float(rng.uniform()),
    }
    return body, state, contact


def _several() -> None:
    cube = MassProperties(mass=0.37, I_B=8.1e-4 * np.eye(3))
    state = BodyState(
        p_WB_W=[0.0, 0.0, 0.05], q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=[0.5, 0.0, -1.0], w_WB_W=np.zeros(3)
    )
    contacts = ContactSet(
        p_WC_W=np.array([[x, y, 0.0] for x in (-0.05, 0.05) for y in (-0.05, 0.05)]),
        normals_W=np.tile([0.0, 0.0, 1.0], (4, 1)),
        frictions=np.full(4, 0.2),
        restitutions=np.full(4, 0.1),
    )
    for law in SeveralContactsLaw:
        answer = several_impact(cube, state, contacts, law=law)
        cost = _best(lambda law=law: several_impact(cube, state, contacts, law=law), 1)
        print(
            f"  {law.name:>14} {1e3 * cost:8.2f}   {answer.verdict.name.lower()}, {len(answer.order)} strikes"
        )
    outcomes = outcomes_over_orders(cube, state, contacts)
    cost = _best(lambda: outcomes_over_orders(cube, state, contacts), 1)
    print(f"  {'all 24 orders':>14} {1e3 * cost:8.2f}   {len(outcomes.orders)} outcomes")
