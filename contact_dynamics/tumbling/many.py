"""This file follows many free motions at once, each at its own time, such as samples of an uncertain state.

The formulas are those for one motion, over arrays and in doubles (`many_turns`). Errors of attitude grow by
about 1e-16 of the angle turned, times the motion's sensitivity. A motion that is on the separatrix to the
last bit is computed as if it were 1e-300 off it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.numerics.arithmetic import FloatArray
from contact_dynamics.rotations.many import matrices_of, products
from contact_dynamics.tolerances import (
    SYMMETRY_TOLERANCE,
    TRIANGLE_TOLERANCE,
    UNIT_LENGTH_TOLERANCE,
)
from contact_dynamics.tumbling.many_turns import tumbles_of_many, turns_of_many
from contact_dynamics.tumbling.motion import Trajectory
from contact_dynamics.validation import check_array, check_magnitude

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


CHUNK: Final = 4096
"""Number of rotations computed at a time. Their intermediate arrays stay in the processor's cache."""

_IN_STEADY_SPIN: Final[Any] = {"divide": "ignore", "invalid": "ignore", "over": "ignore"}
"""What NumPy need not tell: rows of steady spin divide by zero, and are computed apart."""


def states_of_many(
    I_B: ArrayLike,
    *,
    p_WB_W: ArrayLike,
    q_WB: ArrayLike,
    v_WB_W: ArrayLike,
    w_WB_W: ArrayLike,
    seconds: ArrayLike,
    gravity_W: ArrayLike = STANDARD_GRAVITY_W,
) -> Trajectory:
    """Return where n bodies are, each from its own state at its own time: row i is body i.

    Principal axes are found in doubles. If I_B is oblique, rounding its entries changes a needle's small
    moment by 1e-16 of the large one.

    Args:
        I_B: (3, 3) for all bodies, or (n, 3, 3), kg m^2, about the centre of mass, body axes.
        p_WB_W: (n, 3), m, centres of mass in the world.
        q_WB: (n, 4), unit quaternions x, y, z, w, body to world.
        v_WB_W: (n, 3), m/s, of the centres of mass, world axes.
        w_WB_W: (n, 3), rad/s, world axes.
        seconds: (n,), or one number for all, s, of either sign.
        gravity_W: (3,) for all bodies, or (n, 3), m/s^2, world axes.

    Raises:
        InvalidFieldError: an array of another shape, a number that is not finite, a quaternion that is not
            unit, an inertia that is not symmetric and positive definite.
    """
    start = _start(I_B, p_WB_W=p_WB_W, q_WB=q_WB, v_WB_W=v_WB_W, w_WB_W=w_WB_W, gravity_W=gravity_W)
    n = len(start.p)
    times = np.broadcast_to(_times(seconds, n), (n,))
    return start.after(times, *rotations_of_many(start.moments, start.w_P, times))


class _Start(NamedTuple):
    """States of n bodies at time 0, a row each.

    Attributes:
        p: (n, 3), m, world.
        q: (n, 4), unit quaternions.
        v: (n, 3), m/s, world axes.
        gravity: (n, 3), m/s^2, world axes.
        moments: (n, 3), principal moments, ascending.
        R_BP: (n, 3, 3), principal axes in the body.
        R_WP: (n, 3, 3), in the world.
        w_P: (n, 3), rad/s, principal axes.
    """

    p: FloatArray
    q: FloatArray
    v: FloatArray
    gravity: FloatArray
    moments: FloatArray
    R_BP: FloatArray
    R_WP: FloatArray
    w_P: FloatArray

    def after(self, times: FloatArray, turn: FloatArray, w_P: FloatArray) -> Trajectory:
        """Return the states at times (n,), s, from what `rotations_of_many` returns.

        The turn is in principal axes at time 0. As a rotation of the world it is R_WP turn R_WP^T.
        """
        onto_W = np.einsum("nij,nj->ni", self.R_WP, turn[:, :3])
        then = products(np.column_stack([onto_W, turn[:, 3]]), self.q)
        elapsed = times[:, None]
        return Trajectory(
            seconds=times.copy(),
            p_WB_W=self.p + elapsed * (self.v + (0.5 * elapsed) * self.gravity),
            q_WB=then,
            v_WB_W=self.v + elapsed * self.gravity,
            w_WB_W=np.einsum("nij,nj->ni", matrices_of(then) @ self.R_BP, w_P),
        )


def _start(
    I_B: ArrayLike,
    *,
    p_WB_W: ArrayLike,
    q_WB: ArrayLike,
    v_WB_W: ArrayLike,
    w_WB_W: ArrayLike,
    gravity_W: ArrayLike,
) -> _Start:
    w = check_magnitude("w_WB_W", check_array("w_WB_W", w_WB_W, (None, 3)))
    n = len(w)
    p, v = _rows("p_WB_W", p_WB_W, n, (3,)), _rows("v_WB_W", v_WB_W, n, (3,))
    q = _unit(_rows("q_WB", q_WB, n, (4,)))
    given = check_array("I_B", I_B, (3, 3)) if np.ndim(I_B) == 2 else _rows("I_B", I_B, n, (3, 3))
    moments, R_BP = _principal(given)
    R_WP = matrices_of(q) @ R_BP
    one = np.ndim(gravity_W) == 1
    gravity = check_array("gravity_W", gravity_W, (3,)) if one else _rows("gravity_W", gravity_W, n, (3,))
    return _Start(
        p=p,
        q=q,
        v=v,
        gravity=gravity,
        moments=moments,
        R_BP=R_BP,
        R_WP=R_WP,
        w_P=np.einsum("nij,ni->nj", R_WP, w),
    )


def _rows(field: str, value: ArrayLike, n: int, shape: tuple[int, ...]) -> FloatArray:
    """Return finite numbers, (n, *shape). An error names the row of a number that is not finite."""
    rows = check_array(field, value, (None, *shape))
    if len(rows) != n:
        raise InvalidFieldError(field, f"{len(rows)} rows", f"{n}, one for each body")
    return rows


def _times(seconds: ArrayLike, n: int) -> FloatArray:
    rows = check_array("seconds", seconds, ()) if np.ndim(seconds) == 0 else _rows("seconds", seconds, n, ())
    return check_magnitude("seconds", rows)


def _unit(q: FloatArray) -> FloatArray:
    """Return quaternions (n, 4) scaled to norm 1, or refuse those that do not have it within tolerance."""
    norms = np.sqrt(np.einsum("ni,ni->n", q, q))
    off = np.flatnonzero(np.abs(norms - 1.0) > UNIT_LENGTH_TOLERANCE)
    if len(off):
        raise InvalidFieldError(
            f"q_WB[{off[0]}]", f"norm {norms[off[0]]:g}", f"1 within {UNIT_LENGTH_TOLERANCE:g}"
        )
    unit: FloatArray = q / norms[:, None]
    return unit


def _principal(I_B: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return moments, (3,) or (n, 3), ascending, and right-handed axes, columns of (3, 3) or (n, 3, 3)."""
    apart = np.abs(I_B - np.swapaxes(I_B, -1, -2)).max(axis=(-1, -2))
    bent = np.flatnonzero(apart > SYMMETRY_TOLERANCE * np.abs(I_B).max(axis=(-1, -2)))
    if len(bent):
        raise InvalidFieldError("I_B", I_B.reshape(-1, 3, 3)[bent[0]].tolist(), "a symmetric matrix")
    moments, axes = np.linalg.eigh(I_B)
    if moments.size and not float(moments.min()) > 0.0:
        raise InvalidFieldError("I_B", f"a principal moment of {moments.min():g}", "numbers > 0")
    above = moments[..., 2] - moments[..., 0] - moments[..., 1] > TRIANGLE_TOLERANCE * moments[..., 2]
    if above.any():
        found = moments.reshape(-1, 3)[np.atleast_1d(above).argmax()].tolist()
        raise InvalidFieldError("I_B", f"principal moments {found}", "those of a body: I1 + I2 >= I3")
    axes[..., 2] *= np.linalg.det(axes)[..., None]
    return moments, axes


def rotations_of_many(
    moments: ArrayLike, w_P: ArrayLike, seconds: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return how bodies turn in given times: quaternions (n, 4), and angular velocities (n, 3) then, rad/s.

    All in each body's principal axes P: the quaternion, x y z w, takes P as it is then into P at time 0.

    Args:
        moments: (3,) for all bodies, or (n, 3), kg m^2, principal moments in any order.
        w_P: (n, 3), rad/s, angular velocities at time 0, in right-handed principal axes in that order.
        seconds: (n,), or one number for all, s.

    Raises:
        InvalidFieldError: an array of another shape, a number that is not finite, a moment that is not > 0.
    """
    w, given = _checked(moments, w_P)
    n = len(w)
    times = np.broadcast_to(_times(seconds, n), (n,))
    q, w_then = np.empty((n, 4)), np.empty((n, 3))
    with np.errstate(**_IN_STEADY_SPIN):  # set after
        for start in range(0, n, CHUNK):
            part = slice(start, start + CHUNK)
            q[part], w_then[part] = turns_of_many(given[part], w[part]).at(times[part])
    return q, w_then


def flips_of_many(moments: ArrayLike, w_P: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the times, s, (n,), of one flip of each body, and the times from flip to flip, (n,).

    Every zero of the component along the middle axis counts as a flip here, whatever the rotation. Steady
    spin has no flips, and its times are NaN. Arguments and errors are those of `rotations_of_many`.
    """
    w, given = _checked(moments, w_P)
    with np.errstate(**_IN_STEADY_SPIN):
        r = tumbles_of_many(given, w)
        rate = np.where(r.steady, np.nan, r.z_rate)
        return -r.z_offset / rate, np.divide(np.pi, np.abs(rate))


def _checked(moments: ArrayLike, w_P: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return the angular velocities and the moments, (n, 3) each."""
    w = check_magnitude("w_P", check_array("w_P", w_P, (None, 3)))
    given = check_array("moments", moments, (3,) if np.ndim(moments) == 1 else (len(w), 3))
    if not (given > 0.0).all():
        raise InvalidFieldError("moments", float(given.min()), "numbers > 0")
    return w, np.broadcast_to(given, w.shape)
