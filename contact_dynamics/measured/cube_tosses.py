# SPDX-License-Identifier: Apache-2.0
"""Reads the tosses of an acrylic cube onto a board that Pfrommer, Halm and Posa measured and published.

S. Pfrommer, M. Halm, M. Posa, "ContactNets: Learning discontinuous contact dynamics with smooth, implicit
representations", Conference on Robot Learning 2020 (arXiv 2009.11193); data from the repository
DAIRLab/contact-nets, BSD-3-Clause. The file is an `.npz` with `data`, (N, 14); `columns`; and `offsets`: toss
k consists of rows offsets[k] to offsets[k + 1].

Only the columns of time and pose are used. The velocities in the file are backward differences, which belong
to half a frame before their row, and a median filter over three frames distorts them next to an impact. They
are replaced by those of `velocity_estimate`, as in the package's own recording.

The constants of the cube are the nominal values of its authors, from which the recordings differ. At the
first strike, the lowest corner is 2.5 to 5.5 mm below the board (5 to 95 % of the tosses), which is the
combined error of tracked frame, half side and board. In flight the cube falls at 9.6 m/s^2 instead of 9.81,
so lengths or times of the recordings are off by 1 or 2 %.
"""

from __future__ import annotations

import zlib
from typing import TYPE_CHECKING, Final
from zipfile import BadZipFile

import numpy as np

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.measured.recorded_toss import Toss
from contact_dynamics.motion.velocity_estimate import FEWEST_FRAMES, causal_velocities, frames_in_window
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.validation import check_array
from contact_dynamics.world import Body, Surface, box_vertices

if TYPE_CHECKING:
    from pathlib import Path

    from contact_dynamics.validation import FloatArray

RATE: Final = 148.0  # rate of the frames, Hz
HALF_SIDE: Final = 0.0524  # half the side of the cube, m

CUBE: Final = Body(  # the cube, with its mass in kg and its inertia in kg m^2
    name="cube",
    mass_properties=MassProperties(mass=0.37, I_B=np.diag([8.1e-4] * 3)),
    vertices_B=box_vertices((2.0 * HALF_SIDE,) * 3),
)

BOARD: Final = Surface(
    name="board", p_WS_W=np.zeros(3), normal_W=np.array([0.0, 0.0, 1.0]), friction=0.18, restitution=0.125
)

GRAVITY: Final = 9.81  # acceleration of gravity, m/s^2, also nominal

POSITION_NOISE: Final = 2.5e-5
"""m. The residuals of parabolas fitted to flights of at least ten frames are 0.020 to 0.024 mm per coordinate
(median)."""

ORIENTATION_NOISE: Final = 3.5e-4  # rad. Residuals of rotation vectors are 0.017 to 0.024 degrees.


def read_cube_toss(path: Path, *, index: int = 0) -> Toss:
    """Return toss ``index`` of the file, from 0.

    The first `FEWEST_FRAMES` - 1 frames are left out, since no velocity is known there. Raise
    `InvalidFieldError` if an array is missing or has another shape, or the index is out of range.
    """
    data, offsets = _load(path)
    count = len(offsets) - 1
    if not 0 <= index < count:
        raise InvalidFieldError(f"{path.name}: index", index, f"0 to {count - 1}")
    rows = data[offsets[index] : offsets[index + 1]]
    times, p_WB_W, q_WB = rows[:, 0], rows[:, 1:4], rows[:, 4:8]
    v_WB_W, w_WB_W = causal_velocities(times, p_WB_W, q_WB, frames=frames_in_window(RATE))
    known = slice(FEWEST_FRAMES - 1, None)
    return Toss(
        source=f"measured toss {index} of a cube, Pfrommer, Halm and Posa 2020 (arXiv 2009.11193)",
        body=CUBE,
        box_size=np.full(3, 2.0 * HALF_SIDE),
        surface=BOARD,
        gravity_W=np.array([0.0, 0.0, -GRAVITY]),
        rate=RATE,
        position_noise=POSITION_NOISE,
        orientation_noise=ORIENTATION_NOISE,
        times=times[known],
        p_WB_W=p_WB_W[known],
        q_WB=q_WB[known],
        v_WB_W=v_WB_W[known],
        w_WB_W=w_WB_W[known],
    )


def count_cube_tosses(path: Path) -> int:
    """Return the number of tosses in a file, or raise `InvalidFieldError` if its arrays are invalid."""
    return len(_load(path)[1]) - 1


def _load(path: Path) -> tuple[FloatArray, list[int]]:
    """Return data, (N, 14), and offsets, (tosses + 1,)."""
    try:
        with path.open("rb") as stream:
            arrays = np.load(stream)
            if not isinstance(arrays, np.lib.npyio.NpzFile):
                raise InvalidFieldError(path.name, "a single array", "an .npz of plain arrays")
            content = {name: arrays[name] for name in ("data", "offsets") if name in arrays}
    except (OSError, ValueError, EOFError, BadZipFile, zlib.error) as error:  # damaged at any place
        raise InvalidFieldError(path.name, error, "an .npz of plain arrays") from error
    if len(content) < 2:
        raise InvalidFieldError(path.name, f"arrays {sorted(content)}", "arrays data and offsets")
    data = check_array(f"{path.name}: data", content["data"], (None, 14))
    offsets = check_array(f"{path.name}: offsets", content["offsets"], (None,)).astype(int).tolist()
    if len(offsets) < 2 or offsets[0] < 0 or offsets[-1] > len(data) or offsets != sorted(set(offsets)):
        raise InvalidFieldError(f"{path.name}: offsets", offsets, f"increasing rows from 0 to {len(data)}")
    return data, offsets
