# SPDX-License-Identifier: Apache-2.0
"""A recorded toss: the poses of a body that flies, bounces and comes to rest, and its CSV file.

Velocities are estimated from past poses alone (`velocity_estimate`), by the same method for every source, as
they would have been available at the time.

Assumptions: one body and one surface; z points up in the world; the body is a box whose tracked frame has its
origin at the centre of mass.

The CSV file of a toss begins with a header of comment lines. A header line is `# name [unit]: value`, with
the value in JSON; other comment lines are prose. A line of column names and the samples follow. Numbers are
rounded far below the noise, so that the same recording gives the same bytes on every platform.
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
    from pathlib import Path

    from contact_dynamics.validation import FloatArray


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Toss(Record):
    """A recorded toss of a box onto a surface. Sample k is row k of each array.

    Raises:
        InvalidFieldError: arrays have unequal lengths, a number is not finite, times do not increase, a
            quaternion is not unit, or a rate or noise is not > 0.
    """

    source: str  # description of the origin of the data
    body: Body  # mass properties and corners; its published frame is the body frame B
    box_size: FloatArray  # (3,), m, full side lengths along the body's axes
    surface: Surface  # the surface that it hits, with friction and restitution
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
        """Check all fields, and normalise the quaternions."""
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
        """The surface, as a tuple of one."""
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

UNITS: Final = {  # names in the header, all required, with their units
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


def read_toss_csv(path: Path) -> Toss:
    """Return the toss in a CSV file.

    Raise `InvalidFieldError` if a header line is missing or has another unit, the column names differ, or a
    sample does not consist of numbers.
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
    """Return the values of the header by name, and the lines after the header."""
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
