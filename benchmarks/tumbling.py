# SPDX-License-Identifier: Apache-2.0
"""The cost and accuracy of tumbling, beside SciPy's integrator, MuJoCo and Drake in the same run.

Costs are processor time of this thread, so that a busy machine matters less. Errors are against the tests'
reference of 50 digits, which shares nothing with the package.
"""

from __future__ import annotations

import importlib.util
import itertools
import math
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, TypeAlias

import numpy as np
from scipy.integrate import solve_ivp

from benchmarks._quotes import quote
from contact_dynamics.landing.plane_arrival import first_contact
from contact_dynamics.motion.integrated import forced_motion
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tumbling import FreeMotion, Precision, free_motion, rotations_of_many, states_of_many
from contact_dynamics.tumbling.flips import next_flips
from contact_dynamics.tumbling.motion import constants_of
from contact_dynamics.tumbling.poinsot_construction import poinsot

if TYPE_CHECKING:
    from collections.abc import Callable

    from contact_dynamics.validation import FloatArray

MOMENTS: Final = (1.0, 1.4, 1.9)
UPRIGHT: Final = (0.0, 0.0, 0.0, 1.0)
MOTIONS: Final = {
    "about the major axis": (0.3, -0.5, 1.2),
    "near the middle axis": (1e-3, 1.2, 1e-4),
    "1 - m = 5e-16": (3e-9, 1.2, 3.6e-9),
}
SAMPLES: Final = (1, 100, 10_000, 1_000_000)
LONG: Final = 100.0
"""s, the later of the two times at which errors are compared."""

PATIENCE: Final = 30.0
"""s. If a peer would take longer for a trajectory, its time is extrapolated from a shorter one."""

REPEATS: Final = 5

FAR: Final = 1e9
"""Number of revolutions after which documents quote the error."""

COMPARED: Final = "about the major axis"
"""The motion that documents quote, and what they quote of it."""

AXES: Final = {"about the major axis": "major", "near the middle axis": "middle"}
"""The motions whose integration documents quote."""

QUOTED: Final = {
    "closed form": "ours",
    "SciPy DOP853, rtol 1e-12": "dop853",
    "MuJoCo RK4, 1 ms": "mujoco",
    "Drake RK3, accuracy 1e-09": "drake",
}


def run() -> None:
    """Print costs, then cost and error of 1 kHz trajectories beside the peers."""
    _costs()
    _errors_far_away()
    _errors_integrated()
    methods = _methods()
    _peers(methods)
    _peers_by_count(methods)


def _best(action: Callable[[], object], calls: int = 1) -> float:
    """Return the seconds that one call takes, at best."""
    best = math.inf
    for _ in range(REPEATS):
        start = time.thread_time()
        for _ in range(calls):
            action()
        best = min(best, (time.thread_time() - start) / calls)
    return best


def _motion(w: tuple[float, ...], precision: Precision = Precision.EXTENDED) -> FreeMotion:
    body = MassProperties(mass=1.0, I_B=np.diag(MOMENTS))
    state = BodyState(p_WB_W=(0.0, 0.0, 1.5), q_WB=UPRIGHT, v_WB_W=(1.0, 0.0, 2.0), w_WB_W=w)
    return free_motion(body, state, precision=precision)


def _costs() -> None:
    print("Set-up and single questions, us (targets: set-up 1000 and 100 in doubles, one time 10)")
    for name, w in MOTIONS.items():
        motion = _motion(w)
        costs = {
            "set-up": _best(lambda m=motion: _anew(m, Precision.EXTENDED), 50),
            "in doubles": _best(lambda m=motion: _anew(m, Precision.DOUBLE), 50),
            "of a state seen before": _best(lambda m=motion: free_motion(m.body, m.state), 50),
            "one time": _best(lambda m=motion: m.sample(3.3), 1000),
            "as BodyState": _best(lambda m=motion: m.state_at(3.3), 200),
            "Poinsot": _best(lambda m=motion: poinsot(m), 50),
            "3 flips": _best(lambda m=motion: next_flips(m, 3), 50),
            "cube to floor": _best(lambda m=motion: _landing(m), 20),
        }
        print(f"  {name:>22}  " + "  ".join(f"{text} {1e6 * cost:.1f}" for text, cost in costs.items()))
    print("\nTrajectories, us for n samples of position, quaternion and velocities (target: 0.2 s for 1e6)")
    for name, w in MOTIONS.items():
        motion = _motion(w)
        row = []
        for n in SAMPLES:
            times = np.linspace(0.0, 1000.0, n)
            row.append(f"n = {n} {1e6 * _best(lambda m=motion, t=times: m.at(t), max(1, 3000 // n)):.0f}")
        print(f"  {name:>22}  " + "  ".join(row))
    w = np.random.default_rng(0).normal(size=(100_000, 3))
    seconds = _best(lambda: rotations_of_many(MOMENTS, w, 10.0)) / len(w)
    print(f"\nMany rotations, one time each, set-up included: {1e6 * seconds:.2f} us each (target: 3)")
    seconds = _best(lambda: _states_of_many(w)) / len(w)
    print(f"The same with positions, attitudes in the world, axes to be found: {1e6 * seconds:.2f} us a body")
    quote("tumbling.states_of_many", 1e6 * seconds, "µs", digits=1)


def _states_of_many(w: FloatArray) -> object:
    nowhere = np.zeros_like(w)
    return states_of_many(
        np.tile(np.diag(MOMENTS), (len(w), 1, 1)),
        p_WB_W=nowhere,
        q_WB=np.tile(UPRIGHT, (len(w), 1)),
        v_WB_W=nowhere,
        w_WB_W=w,
        seconds=10.0,
    )


def _anew(motion: FreeMotion, precision: Precision) -> object:
    """Set up a motion from a new state of a body that was seen before."""
    constants_of.cache_clear()
    return free_motion(motion.body, motion.state, precision=precision)


def _landing(motion: FreeMotion) -> object:
    cube = 0.05 * np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    return first_contact(motion, cube, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), horizon=1.0)


def _errors_far_away() -> None:
    print("\nErrors of attitude, rad, after so many revolutions (target: 5e-15)")
    far: list[float] = []
    for name, w in MOTIONS.items():
        motion = _motion(w)
        truth = _reference().ExactMotion(np.diag(MOMENTS).tolist(), UPRIGHT, w)
        row = []
        for revolutions in (1e0, 1e3, 1e6, 1e9, 1e12):
            t = 2.0 * math.pi / 1.2 * revolutions
            error = truth.errors(t, motion.sample(t).q_WB)[0]
            row.append(f"{revolutions:.0e}: {error:.1e}")
            if revolutions == FAR:
                far.append(float(error))
        print(f"  {name:>22}  " + "  ".join(row))
    quote("tumbling.far.error", max(far), "rad", digits=1)


def _errors_integrated() -> None:
    print("\nErrors of attitude, rad, of the integrator without torque, after so many revolutions")
    for name, w in MOTIONS.items():
        motion = forced_motion(_motion(w).body, _motion(w).state)
        truth = _reference().ExactMotion(np.diag(MOMENTS).tolist(), UPRIGHT, w)
        row = []
        for revolutions in (10, 100):
            t = 2.0 * math.pi / 1.2 * revolutions
            error = float(truth.errors(t, motion.sample(t).q_WB)[0])
            row.append(f"{revolutions}: {error:.1e}")
            if name in AXES:
                quote(f"tumbling.integrated.{AXES[name]}.{revolutions}", error, "rad", digits=1)
        print(f"  {name:>22}  " + "  ".join(row))


def _reference() -> Any:
    path = Path(__file__).parents[1] / "test" / "oracles" / "tumbling_exact.py"
    spec = importlib.util.spec_from_file_location("tumbling_exact", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


Method: TypeAlias = "Callable[[tuple[float, ...], float], FloatArray]"
"""A function from angular velocity and time, s, to the attitude then, which computes all samples at 1 kHz."""


def _peers(methods: dict[str, Method]) -> None:
    print(f"\nAt 1 kHz, set-up included: ms a simulated second; errors, rad, after 10 s and {LONG:.0f} s")
    for name, w in MOTIONS.items():
        print(f"  {name}")
        truth = _reference().ExactMotion(np.diag(MOMENTS).tolist(), UPRIGHT, w)
        ours = 0.0
        for method, simulate in methods.items():
            attitudes = {}
            for seconds in (10.0, LONG):
                constants_of.cache_clear()
                start = time.thread_time()
                attitudes[seconds] = simulate(w, seconds)
                cost = (time.thread_time() - start) / seconds
            ours = ours or cost
            errors = [float(truth.errors(seconds, q)[0]) for seconds, q in attitudes.items()]
            if name == COMPARED and method in QUOTED:
                quote(f"tumbling.{QUOTED[method]}", 1e3 * cost, "ms")
                quote(f"tumbling.{QUOTED[method]}.error", errors[-1], "rad", digits=1)
            print(
                f"    {method:>28} {1e3 * cost:9.3f} ms  {cost / ours:6.0f} x"
                f"  {errors[0]:8.1e}  {errors[1]:8.1e}"
            )


def _peers_by_count(methods: dict[str, Method]) -> None:
    print("\nn samples at 1 kHz, set-up included, us a sample; peers take one step for n = 1 ('~': reckoned)")
    w = MOTIONS["about the major axis"]
    for method, simulate in methods.items():
        row, last = [], 0.0
        for n in SAMPLES:
            expected = last * n
            if expected < PATIENCE:
                repeats = 1 if expected > 1.0 else 3
                last = min(_once(simulate, w, 1e-3 * n) for _ in range(repeats)) / n
            row.append(f"n = {n} {'' if expected < PATIENCE else '~'}{1e6 * last:.2f}")
        print(f"    {method:>28}  " + "  ".join(row))


def _once(simulate: Method, w: tuple[float, ...], seconds: float) -> float:
    start = time.thread_time()
    constants_of.cache_clear()
    simulate(w, seconds)
    return time.thread_time() - start


def _methods() -> dict[str, Method]:
    """Return the methods that can be run here, ours first, and say which cannot."""
    methods: dict[str, Method] = {"closed form": _closed_form}
    for tolerance in (1e-6, 1e-9, 1e-12):
        methods[f"SciPy DOP853, rtol {tolerance:.0e}"] = lambda w, seconds, rtol=tolerance: _dop853(
            w, seconds, rtol
        )
    if importlib.util.find_spec("mujoco"):
        for integrator in ("RK4", "implicitfast"):
            methods[f"MuJoCo {integrator}, 1 ms"] = lambda w, seconds, name=integrator: _mujoco(
                w, seconds, name
            )
    else:
        print("\n  MuJoCo is not installed: not compared")
    if importlib.util.find_spec("pydrake"):
        for accuracy in (1e-6, 1e-9):
            methods[f"Drake RK3, accuracy {accuracy:.0e}"] = lambda w, seconds, to=accuracy: _drake(
                w, seconds, accuracy=to
            )
        methods["Drake discrete, 1 ms"] = lambda w, seconds: _drake(w, seconds, time_step=1e-3)
    else:
        print("\n  Drake is not installed: not compared")
    return methods


def _closed_form(w: tuple[float, ...], seconds: float) -> FloatArray:
    return _motion(w).at(np.linspace(0.0, seconds, round(1000 * seconds) + 1)).q_WB[-1]


def _dop853(w: tuple[float, ...], seconds: float, rtol: float) -> FloatArray:
    I1, I2, I3 = MOMENTS

    def slope(_: float, y: FloatArray) -> list[float]:
        qx, qy, qz, qw, w1, w2, w3 = y.tolist()
        return [
            0.5 * (qw * w1 + qy * w3 - qz * w2),
            0.5 * (qw * w2 + qz * w1 - qx * w3),
            0.5 * (qw * w3 + qx * w2 - qy * w1),
            -0.5 * (qx * w1 + qy * w2 + qz * w3),
            (I2 - I3) / I1 * w2 * w3,
            (I3 - I1) / I2 * w3 * w1,
            (I1 - I2) / I3 * w1 * w2,
        ]

    times = np.linspace(0.0, seconds, round(1000 * seconds) + 1)
    begin = [*UPRIGHT, *w]
    solution = solve_ivp(
        slope, (0.0, seconds), begin, t_eval=times, method="DOP853", rtol=rtol, atol=1e-2 * rtol
    )
    q: FloatArray = solution.y[:4, -1]
    return q


def _mujoco(w: tuple[float, ...], seconds: float, integrator: str) -> FloatArray:
    import mujoco

    moments = " ".join(map(str, MOMENTS))
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="0.001" integrator="{integrator}" gravity="0 0 0"/>'
        f'<worldbody><body><freejoint/><inertial pos="0 0 0" mass="1" diaginertia="{moments}"/>'
        "</body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[3:] = w
    mujoco.mj_step(model, data, nstep=round(1000 * seconds))
    q: FloatArray = np.roll(data.qpos[3:7], -1)  # w x y z there
    return q


def _drake(
    w: tuple[float, ...], seconds: float, *, accuracy: float | None = None, time_step: float = 0.0
) -> FloatArray:
    from pydrake.math import RigidTransform
    from pydrake.multibody.math import SpatialVelocity
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import SpatialInertia, UnitInertia
    from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig

    plant = MultibodyPlant(time_step)
    inertia = SpatialInertia(1.0, np.zeros(3), UnitInertia(*MOMENTS))
    body = plant.AddRigidBody("body", inertia)
    plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
    plant.Finalize()
    simulator = Simulator(plant)
    context = simulator.get_mutable_context()
    plant.SetFreeBodyPose(context, body, RigidTransform())
    plant.SetFreeBodySpatialVelocity(context, body, SpatialVelocity(w, np.zeros(3)))
    if accuracy is not None:
        config = SimulatorConfig(
            integration_scheme="runge_kutta3", accuracy=accuracy, use_error_control=True, max_step_size=0.1
        )
        ApplySimulatorConfig(config, simulator)
    simulator.Initialize()
    simulator.AdvanceTo(seconds)
    q: FloatArray = np.roll(plant.GetPositions(context)[:4], -1)  # w x y z there
    return q
