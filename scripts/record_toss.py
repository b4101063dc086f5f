#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
# ruff: noqa: T201
"""Make the recording of a tossed brick that the demo plays: contact_dynamics/measured/tosses/brick.csv.

The motion comes from MuJoCo, so that a prediction of ours is compared with an engine that is not ours. The
measurement comes from a model of optical motion capture. Run `pip install mujoco` first. Only this script and
its test need it.

    python scripts/record_toss.py [--output FILE] [--truth FILE]

The same version of MuJoCo on the same kind of machine gives the same bytes. After some bounces the motion
depends on the last bits of every step, so another version may give another end of the same toss.

**The motion.** A uniform brick of 15 x 9 x 5 cm and 0.4 kg leaves the hand about a metre above the floor and
tumbles. Its contact with the floor in MuJoCo is a stiff damped spring with a friction cone.

* A step is a hundred-thousandth of a second, so a strike of 0.6 ms takes about 60 steps. The cone is
  elliptic. The integrator is `implicit`, which has the gyroscopic terms.
* In the normal direction `solref` has the time constant 0.6 ms and the damping ratio zeta = 0.3. A point mass
  leaves such a spring at exp(-zeta / s (pi - atan2(2 zeta s, 1 - 2 zeta^2))) = 0.45 of its speed of approach,
  with s = sqrt(1 - zeta^2). This is the restitution in the header. When a corner strikes with friction, the
  same contact gives other ratios. At the first strike of this toss the corner leaves at 0.44 of its normal
  speed, and restitution has 0.39 of the impulse of compression. The spring gives way by 0.5 mm.
* Friction is 0.3, and `solreffriction` has its own time constant of 0.2 ms. MuJoCo's friction opposes slip
  like a damper, with the cone as its limit. By default it has the normal's time constant. A strike is then
  over before the damper has stopped the slip, and the force stays far below the cone, so that friction is
  viscous and not Coulomb's. With a far shorter time constant, the convex cone makes friction push the body
  off the floor, in strikes of a hundredth of a millisecond. At 0.2 ms the first strike's slip of 0.7 m/s ends
  at 4 mm/s, and strikes last as long as the spring says.

**The measurement.** Each coordinate of the position has white noise of 0.2 mm, and each component of the
orientation has 0.1 degrees. P. Merriaux et al., "A study of Vicon system positioning performance", Sensors 17
(2017) 1591, measured 0.15 mm mean error of markers at rest and up to 2 mm when fast. P. Skurowski and M.
Pawlyta, "On the noise complexity in an optical motion capture facility", Sensors 19 (2019) 4435, find several
kinds of noise. Only the white one is modelled here. Markers that are 0.1 m apart and each off by 0.2 mm give
an orientation that is off by 2 mrad, or 0.1 degrees. Calibration errors, lost markers and latency are not
modelled.

The velocities are `causal_velocities` of the rounded noisy poses. The tracker saw the brick for one window
before the first row.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

import mujoco
import numpy as np

from contact_dynamics.measured.read_toss import DEFAULT_RECORDING
from contact_dynamics.measured.recorded_toss import COLUMNS, UNITS, Toss
from contact_dynamics.motion.velocity_estimate import causal_velocities, frames_in_window
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.rotations.many import turned
from contact_dynamics.world import Body, Surface, box_vertices

DECIMALS: Final = (9, *(6,) * 3, *(6,) * 4, *(4,) * 3, *(4,) * 3)
"""Decimals of each column: resolutions of 1 ns, 1 um, 1e-6 (2 urad), 0.1 mm/s and 0.1 mrad/s."""

SIZE: Final = (0.15, 0.09, 0.05)  # m
MASS: Final = 0.4  # kg
FRICTION: Final = 0.3
RESTITUTION: Final = 0.45  # restitution of a point mass on the contact's spring, see above
DAMPING_RATIO: Final = 0.3
TIME_CONSTANT: Final = 6e-4  # s, normal to the floor
SLIP_TIME_CONSTANT: Final = 2e-4  # s, along it
GRAVITY: Final = 9.81  # m/s^2

RATE: Final = 240  # Hz, a usual rate of motion capture
STEPS_PER_FRAME: Final = 416
STEP: Final = 1.0 / (RATE * STEPS_PER_FRAME)  # s, 1.0016e-5

RELEASE_HEIGHT: Final = 0.96  # m
RELEASE_VELOCITY: Final = (0.62, 0.14, 0.55)  # m/s, world axes
RELEASE_SPIN: Final = (
    -2.9,
    6.3,
    0.0,
)  # rad/s, body axes: mostly about the middle axis, where tumbling is unstable
RELEASE_ORIENTATION: Final = (0.784, -0.388, 0.142, -0.463)  # x, y, z, w; normalised below
DURATION: Final = 2.0  # s of recording

POSITION_NOISE: Final = 2e-4  # m
ORIENTATION_NOISE: Final = np.radians(0.1).item()  # rad
SEED: Final = 2027

MODEL: Final = f"""
<mujoco>
  <option timestep="{STEP!r}" gravity="0 0 {-GRAVITY}" integrator="implicit" cone="elliptic" impratio="10"
          solver="Newton" tolerance="1e-14" iterations="200"/>
  <worldbody>
    <geom name="floor" type="plane" size="5 5 0.1"/>
    <body>
      <freejoint/>
      <geom name="brick" type="box" size="{SIZE[0] / 2} {SIZE[1] / 2} {SIZE[2] / 2}" mass="{MASS}"/>
    </body>
  </worldbody>
  <contact>
    <pair geom1="floor" geom2="brick" condim="3" friction="{FRICTION} {FRICTION}" solimp="0.99 0.99 0.001"
          solref="{TIME_CONSTANT} {DAMPING_RATIO}" solreffriction="{SLIP_TIME_CONSTANT} 1"/>
  </contact>
</mujoco>
"""


class Strike(NamedTuple):
    """One unbroken time of contact with the floor."""

    begin: float  # s
    end: float  # s
    most_contacts: int  # corners that touched at once, at most


class Motion(NamedTuple):
    """What the engine computed, one row a frame, from the release on."""

    times: np.ndarray  # (n,), s
    p_WB_W: np.ndarray  # (n, 3), m
    q_WB: np.ndarray  # (n, 4), x, y, z, w
    v_WB_W: np.ndarray  # (n, 3), m/s
    w_WB_W: np.ndarray  # (n, 3), rad/s, world axes
    strikes: list[Strike]


def simulate(frames: int) -> Motion:
    """Return the brick's motion over that many frames."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    x, y, z, w = np.array(RELEASE_ORIENTATION) / np.linalg.norm(RELEASE_ORIENTATION)
    data.qpos[:] = [0.0, 0.0, RELEASE_HEIGHT, w, x, y, z]
    data.qvel[:] = [*RELEASE_VELOCITY, *RELEASE_SPIN]
    rows, strikes = [], []
    begin, most = 0.0, 0
    for frame in range(frames):
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, data.qpos[3:])
        w_W = rotation.reshape(3, 3) @ data.qvel[3:]  # the engine's free joint has it in body axes
        w, x, y, z = data.qpos[3:]
        rows.append([frame / RATE, *data.qpos[:3], x, y, z, w, *data.qvel[:3], *w_W])
        for _ in range(STEPS_PER_FRAME):
            mujoco.mj_step(model, data)
            if data.ncon and not most:
                begin = data.time
            if most and not data.ncon:
                strikes.append(Strike(begin, data.time, most))
            most = max(most, data.ncon) if data.ncon else 0
    table = np.array(rows)
    return Motion(table[:, 0], table[:, 1:4], table[:, 4:8], table[:, 8:11], table[:, 11:14], strikes)


def measure(motion: Motion) -> tuple[np.ndarray, np.ndarray]:
    """Return positions and orientations as motion capture would give them, rounded as the file has them."""
    random = np.random.Generator(np.random.PCG64(SEED))
    n = len(motion.times)
    p_W = motion.p_WB_W + POSITION_NOISE * random.standard_normal((n, 3))
    q = turned(motion.q_WB, ORIENTATION_NOISE * random.standard_normal((n, 3)))
    # q and -q are the same orientation, and trackers publish a continuous sign
    flips = np.cumprod(np.where(np.einsum("ij,ij->i", q[1:], q[:-1]) < 0.0, -1.0, 1.0))
    q[1:] *= flips[:, None]
    return p_W.round(DECIMALS[1]), q.round(DECIMALS[4])


def record(motion: Motion) -> Toss:
    """Return the toss as recorded: the first window of frames only feeds the velocity estimate."""
    p_W, q = measure(motion)
    window = frames_in_window(RATE)
    v_W, w_W = causal_velocities(motion.times, p_W, q, frames=window)
    kept = slice(window - 1, None)
    return Toss(
        source=f"a toss by MuJoCo {mujoco.__version__} with the noise of motion capture, "
        "by scripts/record_toss.py",
        body=Body(
            name="brick",
            mass_properties=MassProperties(mass=MASS, I_B=box_inertia()),
            vertices_B=box_vertices(SIZE),
        ),
        box_size=np.array(SIZE),
        surface=Surface(
            name="floor",
            p_WS_W=np.zeros(3),
            normal_W=np.array([0.0, 0.0, 1.0]),
            friction=FRICTION,
            restitution=RESTITUTION,
        ),
        gravity_W=np.array([0.0, 0.0, -GRAVITY]),
        rate=float(RATE),
        position_noise=POSITION_NOISE,
        orientation_noise=ORIENTATION_NOISE,
        times=motion.times[kept] - motion.times[kept.start],
        p_WB_W=p_W[kept],
        q_WB=q[kept],
        v_WB_W=v_W[kept],
        w_WB_W=w_W[kept],
    )


def box_inertia() -> np.ndarray:
    """Return the inertia of the uniform box, (3, 3), kg m^2, rounded to 1e-9."""
    squares = np.array(SIZE) ** 2
    return np.diag((MASS / 12.0 * (squares.sum() - squares)).round(9))


def write_truth(path: Path, motion: Motion) -> None:
    """Write the engine's own states at the recording's frames, and its strikes, for tests of estimates."""
    first = frames_in_window(RATE) - 1
    start = motion.times[first]
    lines = [
        f"# What MuJoCo {mujoco.__version__} computed, without noise; by scripts/record_toss.py --truth.",
        "# Columns as in the recording. Strikes: begin and end, s, and most corners that touched at once.",
    ]
    lines += [
        f"# strike: {s.begin - start:.6f} {s.end - start:.6f} {s.most_contacts}" for s in motion.strikes
    ]
    lines.append(",".join(COLUMNS))
    table = np.column_stack([motion.times - start, *motion[1:5]])[first:] + 0.0
    lines += [",".join(f"{x:.{d}f}" for x, d in zip(row, DECIMALS, strict=True)) for row in table.tolist()]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


PROSE: Final = """A simulated toss of a brick of 15 x 9 x 5 cm onto a floor: free flight, bounces, rest.

Written by scripts/record_toss.py, which says how the motion and the noise of the measurement are modelled. Do
not edit.

Columns: t in s; px py pz in m, the centre of mass, which is the tracked frame's origin, in the world, z up;
qx qy qz qw, unit quaternion from body to world coordinates; vx vy vz in m/s, the velocity of the centre of
mass, and wx wy wz in rad/s, the angular velocity, both in world axes, both estimated from the poses up to
their row and none after (contact_dynamics/motion/velocity_estimate.py).

Inertia: principal moments about the body's axes x, y, z through the centre of mass. Noise: standard deviation
of each coordinate. Restitution: of a point mass against the floor.
"""


def write_toss_csv(path: Path, toss: Toss, *, prose: Sequence[str] = ()) -> None:
    """Write a toss to a file, with the lines of ``prose`` as comments at the top."""
    header: dict[str, Any] = {
        "source": toss.source,
        "body": toss.body.name,
        "mass": toss.body.mass_properties.mass,
        "box_size": toss.box_size.tolist(),
        "inertia": toss.body.mass_properties.I_B.diagonal().tolist(),
        "surface": toss.surface.name,
        "surface_height": float(toss.surface.p_WS_W[2]),
        "friction": toss.surface.friction,
        "restitution": toss.surface.restitution,
        "gravity": -float(toss.gravity_W[2]),
        "rate": toss.rate,
        "position_noise": toss.position_noise,
        "orientation_noise": toss.orientation_noise,
    }
    lines = [f"# {line}".rstrip() for line in prose]
    lines += [
        f"# {name}{f' [{UNITS[name]}]' if UNITS[name] else ''}: {json.dumps(header[name])}" for name in UNITS
    ]
    lines.append(",".join(COLUMNS))
    table = np.column_stack([toss.times, toss.p_WB_W, toss.q_WB, toss.v_WB_W, toss.w_WB_W])
    for row in table.tolist():
        # adding 0.0 turns -0.0 into 0.0: the sign of a rounded zero is noise
        numbers = (round(x, d) + 0.0 for x, d in zip(row, DECIMALS, strict=True))
        lines.append(",".join(f"{x:.{d}f}" for x, d in zip(numbers, DECIMALS, strict=True)))
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments: list[str]) -> int:
    """Write the recording, and the truth if asked, and print what happens in it."""
    parser = argparse.ArgumentParser(description="Make the recording of a tossed brick with MuJoCo.")
    parser.add_argument(
        "--output", type=Path, default=DEFAULT_RECORDING, help="the recording (default: the package's own)"
    )
    parser.add_argument("--truth", type=Path, help="also write the states without noise here")
    options = parser.parse_args(arguments)
    motion = simulate(frames_in_window(RATE) - 1 + round(DURATION * RATE))
    toss = record(motion)
    write_toss_csv(options.output, toss, prose=PROSE.splitlines())
    if options.truth:
        write_truth(options.truth, motion)
    start = motion.times[frames_in_window(RATE) - 1]
    print(f"{options.output}: {len(toss)} samples, {toss.times[-1]:.3f} s, {len(motion.strikes)} strikes")
    for strike in motion.strikes[:5]:
        length = 1e3 * (strike.end - strike.begin)
        print(f"  {strike.begin - start:.4f} s: {length:.2f} ms, {strike.most_contacts} corner(s)")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
