# SPDX-License-Identifier: Apache-2.0
"""Tumbling (Mason, lecture 25): where a free rigid body will be, at any time, in closed form.

`motion` answers for one body and `many` for many at once. `regime` says what kind of rotation it is. `flips`
has the flips of a body that spins near its middle axis. `poinsot_construction` is Poinsot's picture: an
ellipsoid that rolls on a plane.

The method: `constants` computes the constants of a rotation from the principal axes (`rigid_body.inertia`)
and from where it starts on its `polhode`, with `elliptic` integrals. The attitude consists of quotients of
`theta` functions, which `attitude_form` sets up. `double_double` keeps their phases exact over many turns.
"""

from contact_dynamics.numerics.arithmetic import Precision
from contact_dynamics.tumbling.flips import Flips, next_flips
from contact_dynamics.tumbling.many import flips_of_many, rotations_of_many, states_of_many
from contact_dynamics.tumbling.motion import FreeMotion, Sample, Trajectory, free_motion
from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves, poinsot, rolling_curves
from contact_dynamics.tumbling.regime import Regime
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "Flips",
    "FreeMotion",
    "Poinsot",
    "Precision",
    "Regime",
    "RollingCurves",
    "Sample",
    "Trajectory",
    "flips_of_many",
    "free_motion",
    "next_flips",
    "poinsot",
    "rolling_curves",
    "rotations_of_many",
    "states_of_many",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
