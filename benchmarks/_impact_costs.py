# SPDX-License-Identifier: Apache-2.0
"""The cost of an impact, in the plane, in space, in batches and for several contacts, beside iterative peers.

Costs are processor time of this thread, so that a busy machine matters less.
"""

from __future__ import annotations

import importlib.util
import time
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from benchmarks._quotes import quote
from contact_dynamics.contact.contact import Contact, ContactSet
from contact_dynamics.impact import (
    ImpactOutcome,
    RestitutionLaw,
    SeveralContactsLaw,
    StrikingBodies,
    outcomes_over_orders,
    planar_impact,
    planar_impacts,
    several_impact,
    spatial_impact,
    spatial_impact_distribution,
    spatial_impacts,
    spatial_pair_impact,
)
from contact_dynamics.impact.planar.routh import impulse_path, inverse_inertia
from contact_dynamics.plane.types import PlanarBody, PlanarContact, PlanarVelocity
from contact_dynamics.rigid_body.body import BodyState, MassProperties

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.validation import FloatArray

BODY: Final = PlanarBody(mass=1.0, inertia=1.0)
VELOCITY: Final = PlanarVelocity(v=(-1.0, -1.0), w=0.0)
CONTACT: Final = PlanarContact(r=(-1.0, -4.0), normal=(0.0, 1.0), friction=0.25, restitution=0.5)
CASES: Final = 200_000
SPATIAL_CASES: Final = (100, 1_000, 20_000)
DRAWS: Final = 600
REPEATS: Final = 5


def run() -> None:
    """Print costs in the plane, in space, and of several contacts."""
    print("One planar impact, us (target: 2)")
    paths, answers = [_path(law) for law in RestitutionLaw], [_planar(law) for law in RestitutionLaw]
    for law, path, answer in zip(RestitutionLaw, paths, answers, strict=True):
        print(f"  {law.name:>10}  path {path:5.2f}   whole answer {answer:5.2f}")
    quote("impact.planar.path", min(paths), "µs")
    quote("impact.planar", min(answers), "µs")
    peer = _gauss_seidel()
    print(f"  {'beside it':>10}  projected Gauss-Seidel to 1e-9 {peer:5.1f}")
    quote("impact.planar.gauss_seidel", peer, "µs")
    if importlib.util.find_spec("mujoco"):
        step = _mujoco_step()
        print(f"  {'':>10}  one step of MuJoCo, of many in an impact {step:5.1f}")
        quote("impact.space.mujoco_step", step, "µs")
    print(f"\nBatches of {CASES} planar impacts, ns a case (target: 150), and cases a second")
    costs = []
    for text, normals in (("one normal", False), ("a normal a case", True)):
        for law in RestitutionLaw:
            seconds = _batch(law, normals=normals) / CASES
            costs.append(1e6 * seconds)
            print(f"  {law.name:>10}  {text:>16} {1e9 * seconds:6.0f} {1.0 / seconds:12.2e}")
    quote("impact.planar.batch", costs, "µs")
    print(f"\nOne impact in space, us, over {DRAWS} random bodies and contacts: median, 90 %, worst")
    _spatial()
    print("\nBatches in space, us a case, and cases a second for the largest; random bodies and contacts")
    _spatial_batches()
    print("\nAn uncertain state in space, ms, by the number of samples")
    _uncertain()
    print("\nA cube on its face with four contacts, ms")
    _several()


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
    return 1e6 * _best(lambda: planar_impact(BODY, VELOCITY, CONTACT, restitution_law=law), 5_000)


def _gauss_seidel() -> float:
    """Return the microseconds of the peer: Newton's law at the end of one step, by sweeps in plain Python.

    It iterates the normal and the tangential impulse in turn. Its result is not Routh's answer.
    """
    a, b, c, _ = inverse_inertia(1.0, 1.0, -1.0, -4.0)

    def solve() -> tuple[float, float]:
        i_t = p = 0.0
        for _ in range(1000):
            p_new = max(0.0, p - (-1.0 + b * i_t + c * p + 0.5 * -1.0) / c)
            limit = 0.25 * p_new
            t_new = min(max(i_t - (-1.0 + a * i_t + b * p_new) / a, -limit), limit)
            change = abs(p_new - p) + abs(t_new - i_t)
            i_t, p = t_new, p_new
            if change < 1e-9:
                break
        return i_t, p

    return 1e6 * _best(solve, 2_000)


def _mujoco_step() -> float:
    """Return the microseconds of one step of a cube that lies on a plane."""
    import mujoco  # a peer, which need not be there

    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><geom type="plane" size="1 1 1"/><body pos="0 0 0.0499"><freejoint/>'
        '<geom type="box" size="0.05 0.05 0.05" mass="0.37"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    return 1e6 * _best(lambda: mujoco.mj_step(model, data, nstep=100), 10) / 100


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
            restitution_law=law,
        ),
        1,
    )


def _random(count: int) -> tuple[StrikingBodies, dict[str, Any]]:
    """Draw bodies and approaching contacts."""
    rng = np.random.default_rng(1)
    moments = rng.uniform(0.05, 1.0, size=(count, 3))
    inertias = (moments.sum(axis=1)[:, None] - moments)[:, :, None] * np.eye(3)
    q, n = rng.normal(size=(count, 4)), rng.normal(size=(count, 3))
    v, w, r = rng.normal(size=(3, count, 3))
    n /= np.linalg.norm(n, axis=1)[:, None]
    n[np.einsum("ij,ij->i", n, v + np.cross(w, r)) > 0.0] *= -1.0
    bodies = StrikingBodies(
        masses=rng.uniform(0.5, 2.0, count),
        inertias_B=inertias,
        q_WB=q / np.linalg.norm(q, axis=1)[:, None],
        v_WB_W=v,
        w_WB_W=w,
        r_W=r,
    )
    contacts = {
        "normals_W": n,
        "frictions": 10.0 ** rng.uniform(-1.5, 0.3, count),
        "restitutions": rng.uniform(size=count),
    }
    return bodies, contacts


def _single(
    bodies: StrikingBodies, contacts: dict[str, FloatArray], i: int
) -> tuple[MassProperties, BodyState, Contact]:
    body = MassProperties(mass=float(bodies.masses[i]), I_B=bodies.inertias_B[i])
    state = BodyState(
        p_WB_W=np.zeros(3), q_WB=bodies.q_WB[i], v_WB_W=bodies.v_WB_W[i], w_WB_W=bodies.w_WB_W[i]
    )
    contact = Contact(
        p_WC_W=bodies.r_W[i],
        normal_W=contacts["normals_W"][i],
        friction=float(contacts["frictions"][i]),
        restitution=float(contacts["restitutions"][i]),
    )
    return body, state, contact


def _spatial() -> None:
    bodies, contacts = _random(DRAWS)
    problems = [_single(bodies, contacts, i) for i in range(DRAWS)]
    other = MassProperties(mass=1.0, I_B=np.diag([0.3, 0.4, 0.5]))
    still = BodyState(p_WB_W=np.zeros(3), q_WB=[0.0, 0.0, 0.0, 1.0], v_WB_W=np.zeros(3), w_WB_W=np.zeros(3))
    for law in RestitutionLaw:
        seconds: dict[ImpactOutcome | str, list[float]] = {}
        for body, state, contact in problems:
            answer = spatial_impact(body, state, contact, restitution_law=law)
            spent = _quickest(lambda: spatial_impact(body, state, contact, restitution_law=law))  # noqa: B023
            for kind in ("all", answer.outcome):
                seconds.setdefault(kind, []).append(spent)
            pair = lambda: spatial_pair_impact(body, state, other, still, contact, restitution_law=law)  # noqa: B023, E731
            seconds.setdefault("two bodies", []).append(_quickest(pair))
        for kind, spent_on in sorted(seconds.items(), key=lambda item: str(item[0])):
            name = kind.name if isinstance(kind, ImpactOutcome) else kind
            median, high, worst = 1e6 * np.percentile(spent_on, [50.0, 90.0, 100.0])
            if kind == "all" and law is RestitutionLaw.POISSON:
                quote("impact.space", median, "µs")
            print(f"  {law.name:>10} {name:>24} {len(spent_on):5d} x {median:7.0f} {high:7.0f} {worst:7.0f}")


def _quickest(action: Callable[[], object]) -> float:
    """Return the seconds of the quicker of two calls, so that what interrupts one is left out."""
    spent = []
    for _ in range(2):
        start = time.thread_time()
        action()
        spent.append(time.thread_time() - start)
    return min(spent)


def _spatial_batches() -> None:
    head = " ".join(f"{count:>8}" for count in SPATIAL_CASES)
    print(f"  {'':>10} {'':>12} {head}   cases a second")
    for law in RestitutionLaw:
        _print_batches(law, "any", {}, {})
    ball = {"inertias_B": 0.4 * np.eye(3)}
    _print_batches(RestitutionLaw.POISSON, "balls", ball, {})
    _print_batches(RestitutionLaw.POISSON, "no friction", {}, {"frictions": 0.0})


def _print_batches(
    law: RestitutionLaw, text: str, same_body: dict[str, Any], same_contact: dict[str, Any]
) -> None:
    costs = []
    for count in SPATIAL_CASES:
        drawn, contacts = _random(count)
        fields = {**drawn.fields, **same_body}
        if text == "balls":
            # The contact is where a ball of radius 1 has it; what separates there strikes on the other side.
            fields["r_W"] = -contacts["normals_W"]
            approach = np.einsum("ij,ij->i", contacts["normals_W"], fields["v_WB_W"])
            fields["v_WB_W"] = np.where(approach[:, None] > 0.0, -fields["v_WB_W"], fields["v_WB_W"])
        bodies, chosen = StrikingBodies(**fields), {**contacts, **same_contact}
        seconds = _best(lambda: spatial_impacts(bodies, restitution_laws=law, **chosen), 1)  # noqa: B023
        costs.append(seconds / count)
    numbers = " ".join(f"{1e6 * cost:8.1f}" for cost in costs)
    if law is RestitutionLaw.POISSON and text in {"any", "balls"}:
        quote(f"impact.space.batch.{text}", 1e6 * costs[-1], "µs")
    print(f"  {law.name:>10} {text:>12} {numbers} {1.0 / costs[-1]:12.2e}")


def _uncertain() -> None:
    cube = MassProperties(mass=0.37, I_B=8.1e-4 * np.eye(3))
    state = BodyState(
        p_WB_W=[0.0, 0.0, 0.08], q_WB=[0.1, 0.2, 0.3, 0.927], v_WB_W=[0.5, 0.2, -1.5], w_WB_W=[3.0, -2.0, 5.0]
    )
    covariance = np.diag(np.repeat([1e-3, 0.02, 0.02, 0.2], 3) ** 2)
    for samples in (400, 2000, 10_000):
        cost = _best(
            lambda samples=samples: spatial_impact_distribution(  # type: ignore[misc]
                cube,
                state,
                Contact(p_WC_W=[0.03, 0.04, 0.0], normal_W=[0.0, 0.0, 1.0], friction=0.2, restitution=0.3),
                covariance=covariance,
                samples=samples,
            ),
            1,
        )
        print(f"  {samples:6d} {1e3 * cost:7.1f}")


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
        answer = several_impact(cube, state, contacts, several_contacts_law=law)
        cost = _best(lambda law=law: several_impact(cube, state, contacts, several_contacts_law=law), 1)  # type: ignore[misc]
        print(
            f"  {law.name:>14} {1e3 * cost:8.2f}   {answer.verdict.name.lower()}, {len(answer.order)} strikes"
        )
    outcomes = outcomes_over_orders(cube, state, contacts)
    cost = _best(lambda: outcomes_over_orders(cube, state, contacts), 1)
    print(f"  {'all 24 orders':>14} {1e3 * cost:8.2f}   {len(outcomes.orders)} outcomes")
