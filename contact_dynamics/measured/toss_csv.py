# SPDX-License-Identifier: Apache-2.0
"""The project's own file of one toss is CSV, with a header of comment lines that a person can read.

A header line is `# name [unit]: value`, with the value in JSON. Other comment lines are prose. After the
header there is one line of column names, then the samples. Numbers are rounded in decimal, far below the
noise, so that the same recording gives the same bytes everywhere.
"""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.measured.recorded_toss import Toss
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.validation import check_array, check_finite
from contact_dynamics.world import Body, Surface, box_vertices

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

COLUMNS: Final = ("t", "px", "py", "pz", "qx", "qy", "qz", "qw", "vx", "vy", "vz", "wx", "wy", "wz")

DECIMALS: Final = (9, *(6,) * 3, *(6,) * 4, *(4,) * 3, *(4,) * 3)
"""Number of decimals of each column: 1 ns, 1 um, 1e-6 (2 urad), 0.1 mm/s, 0.1 mrad/s."""

UNITS: Final = {
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
"""The header's names, all required, and their units."""

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
