# SPDX-License-Identifier: Apache-2.0
"""Tumbling (Mason, lecture 25): the motion of a free rigid body at any time, in closed form.

`free_motion` returns the motion of one body, and `states_of_many` and `rotations_of_many` those of many
bodies. `Regime` is the kind of rotation, `next_flips` returns the flips of a body that spins near its middle
axis, and `poinsot` Poinsot's construction: an ellipsoid that rolls on a plane.

The modules of this package are internal. `motion` treats one body and `many` many at once. `flips` and
`poinsot_construction` contain the other functions. The constants of a rotation follow from the principal axes
(`rigid_body.inertia`) and from its initial point on the `polhode`, which also has its regime, with `elliptic`
integrals. The attitude consists of quotients of `theta` functions, which `attitude_form` sets up, with phases
that stay exact over many turns.
"""

from contact_dynamics.numerics.arithmetic import Precision
from contact_dynamics.tumbling.flips import Flips, next_flips
from contact_dynamics.tumbling.many import flips_of_many, rotations_of_many, states_of_many
from contact_dynamics.tumbling.motion import FreeMotion, Sample, Trajectory, free_motion
from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves, poinsot, rolling_curves
from contact_dynamics.tumbling.polhode import Regime
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
