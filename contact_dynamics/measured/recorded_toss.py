# SPDX-License-Identifier: Apache-2.0
"""In a recorded toss a tracking system measured a body that flew, bounced and came to rest.

Velocities are estimates from past poses alone (`velocity_estimate`), by the same method for every source. So
a prediction from them was possible at that moment.

It is assumed that there is one body and one surface, that z is up in the world, and that the body is a box
whose tracked frame has its origin at the centre of mass.

The project's own file of one toss is CSV, with a header of comment lines that a person can read. A header
line is `# name [unit]: value`, with the value in JSON. Other comment lines are prose. After the header there
is one line of column names, then the samples. Numbers are rounded in decimal, far below the noise, so that
the same recording gives the same bytes everywhere.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.motion.velocity_estimate import frames_in_window, slope_noise
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.tolerances import UNIT_LENGTH_TOLERANCE
from contact_dynamics.validation import check_array, check_finite, check_positive
from contact_dynamics.world import Body, Surface, box_vertices

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Toss(Record):
    """A recorded toss of one box-shaped body onto one surface. Sample k is row k of each array.

    Raises:
        InvalidFieldError: arrays have unequal lengths, a number is not finite, times do not increase, a
            quaternion is not unit, or a rate or noise is not > 0.
    """

    source: str  # where the numbers come from, in words
    body: Body  # mass properties and corners. Its published frame is B itself.
    box_size: FloatArray  # (3,), m, full side lengths along the body's axes
    surface: Surface  # the surface on which it falls, with friction and restitution
    gravity_W: FloatArray  # (3,), m/s^2, world axes
    rate: float  # rate of the samples, Hz
    position_noise: float  # standard deviation of each coordinate of a measured position, m
    orientation_noise: (
        float  # rad, standard deviation of each component of a measured orientation's rotation error
    )
    times: FloatArray  # (n,), s, increasing
    p_WB_W: FloatArray  # (n, 3), m, centre of mass in the world
    q_WB: FloatArray  # (n, 4), unit quaternions x, y, z, w: body coordinates into world coordinates
    v_WB_W: FloatArray  # (n, 3), m/s, velocity of the centre of mass, world axes, estimated from the past
    w_WB_W: FloatArray  # (n, 3), rad/s, angular velocity, world axes, estimated from the past

    def __post_init__(self) -> None:
        """Check every field, and normalise the quaternions to rounding."""
        n = len(self.times)
        object.__setattr__(self, "box_size", check_array("box_size", self.box_size, (3,)))
        object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        for name in ("rate", "position_noise", "orientation_noise"):
            object.__setattr__(self, name, check_positive(name, getattr(self, name)))
        object.__setattr__(self, "times", check_array("times", self.times, (n,)))
        for name in ("p_WB_W", "v_WB_W", "w_WB_W"):
            object.__setattr__(self, name, check_array(name, getattr(self, name), (n, 3)))
        if n < 2 or float(np.diff(self.times).min()) <= 0.0:
            raise InvalidFieldError("times", self.times, "two or more times, each later than the one before")
        q_WB = check_array("q_WB", self.q_WB, (n, 4))
        norms = np.linalg.norm(q_WB, axis=1)
        for row in np.flatnonzero(abs(norms - 1.0) > UNIT_LENGTH_TOLERANCE)[:1]:
            raise InvalidFieldError(f"q_WB[{row}]", q_WB[row].tolist(), "a unit quaternion")
        q_WB = q_WB / norms[:, None]
        q_WB.flags.writeable = False
        object.__setattr__(self, "q_WB", q_WB)

    def __len__(self) -> int:
        """Return the number of samples."""
        return len(self.times)

    @property
    def surfaces(self) -> tuple[Surface]:
        """The surface, as the only one."""
        return (self.surface,)

    def state(self, sample: int, *, epoch_ns: int = 0) -> BodyState:
        """Return one sample as a state, stamped with its time after ``epoch_ns`` (ns)."""
        return BodyState(
            p_WB_W=self.p_WB_W[sample],
            q_WB=self.q_WB[sample],
            v_WB_W=self.v_WB_W[sample],
            w_WB_W=self.w_WB_W[sample],
            stamp_ns=ns_after(epoch_ns, float(self.times[sample])),
        )

    @property
    def velocity_noise(self) -> float:
        """Standard deviation of one component of the estimated linear velocity with a full window, m/s."""
        return slope_noise(frames=frames_in_window(self.rate), rate=self.rate, noise=self.position_noise)

    @property
    def angular_velocity_noise(self) -> float:
        """Standard deviation of one component of the estimated angular velocity with a full window, rad/s."""
        return slope_noise(frames=frames_in_window(self.rate), rate=self.rate, noise=self.orientation_noise)

    @property
    def contact_speed_noise(self) -> float:
        """Standard deviation of the farthest corner's estimated velocity, m/s, in its worst direction."""
        reach = float(np.linalg.norm(self.body.vertices_B, axis=1).max(initial=0.0))
        return math.hypot(self.velocity_noise, reach * self.angular_velocity_noise)


COLUMNS: Final = ("t", "px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")

DECIMALS: Final = (9, *(6,) * 3, *(6,) * 4, *(4,) * 3, *(4,) * 3)
"""Number of decimals of each column: 1 ns, 1 um, 1e-6 (2 urad), 0.1 mm/s, 0.1 mrad/s."""

UNITS: Final = {  # the header's names, all required, and their units
    "source": "",
    "body": "",
    "mass": "kg",
    "box_size": "m",
    "inertia": "kg m^2",
    "surface": "",
    "surface_height": "m",
    "friction": "",
    "restitution": "",
    "gravity": "m/s^2",
    "rate": "Hz",
    "position_noise": "m",
    "orientation_noise": "rad",
}

_HEADER_LINE: Final = re.compile(r"# (\w+)(?: \[([^\]]*)\])?: (.*)")


def write_toss_csv(path: Path, toss: Toss, *, prose: Sequence[str] = ()) -> None:
    """Write ``toss`` to ``path``. The lines of ``prose`` become comments at the top."""
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


def read_toss_csv(path: Path) -> Toss:
    """Return the toss in ``path``.

    Raises:
        InvalidFieldError: a header line is missing or has another unit, the columns are others, or a sample
            is not numbers.
    """
    header, rows = _split(path)
    names = rows[0].split(",") if rows else []
    if tuple(names) != COLUMNS:
        raise InvalidFieldError(f"{path.name}: columns", names, ",".join(COLUMNS))
    try:
        table = np.array([[float(x) for x in row.split(",")] for row in rows[1:]]).reshape(-1, len(COLUMNS))
    except ValueError:
        raise InvalidFieldError(
            f"{path.name}: samples", "other text", f"{len(COLUMNS)} numbers a line"
        ) from None
    inertia = check_array(f"{path.name}: inertia", header["inertia"], (3,))
    height = check_finite(f"{path.name}: surface_height", header["surface_height"])
    gravity = check_finite(f"{path.name}: gravity", header["gravity"])
    return Toss(
        source=str(header["source"]),
        body=Body(
            name=str(header["body"]),
            mass_properties=MassProperties(mass=header["mass"], I_B=np.diag(inertia)),
            vertices_B=box_vertices(header["box_size"]),
        ),
        box_size=header["box_size"],
        surface=Surface(
            name=str(header["surface"]),
            p_WS_W=np.array([0.0, 0.0, height]),
            normal_W=np.array([0.0, 0.0, 1.0]),
            friction=header["friction"],
            restitution=header["restitution"],
        ),
        gravity_W=np.array([0.0, 0.0, -gravity]),
        rate=header["rate"],
        position_noise=header["position_noise"],
        orientation_noise=header["orientation_noise"],
        times=table[:, 0],
        p_WB_W=table[:, 1:4],
        q_WB=table[:, 4:8],
        v_WB_W=table[:, 8:11],
        w_WB_W=table[:, 11:14],
    )


def _split(path: Path) -> tuple[dict[str, Any], list[str]]:
    """Return the header's values by name, and the lines that follow it."""
    header: dict[str, Any] = {}
    rows = []
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InvalidFieldError(path.name, error, "text in UTF-8") from None
    for line in text.splitlines():
        match = _HEADER_LINE.fullmatch(line)
        if match and match[1] in UNITS:
            name, unit, value = match.groups(default="")
            if unit != UNITS[name]:
                raise InvalidFieldError(f"{path.name}: {name}", f"unit {unit!r}", f"unit {UNITS[name]!r}")
            try:
                header[name] = json.loads(value)
            except json.JSONDecodeError:
                raise InvalidFieldError(f"{path.name}: {name}", value, "a value in JSON") from None
        elif line and not line.startswith("#"):
            rows.append(line)
    missing = [name for name in UNITS if name not in header]
    if missing:
        raise InvalidFieldError(
            f"{path.name}: header",
            f"nothing for {', '.join(missing)}",
            "a line for each of " + ", ".join(UNITS),
        )
    return header, rows
