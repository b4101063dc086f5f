"""Tumbling (Mason, lecture 25): where a free rigid body will be, at any time, in closed form.

In reading order: principal axes (`principal_frame`), the constants of a rotation (`polhode`) with the
elliptic integrals they need (`elliptic`, in the numbers of `arithmetic`), attitude as quotients of theta
functions (`theta`, set up by `attitude_form`), phases over many turns (`double_double`), the motion of one
body (`motion`), what to call it (`regime`), and many bodies at once (`many`).
"""

from contact_dynamics.numerics.arithmetic import Precision
from contact_dynamics.tumbling.many import rotations_of_many, states_of_many
from contact_dynamics.tumbling.motion import FreeMotion, Sample, Trajectory, free_motion
from contact_dynamics.tumbling.regime import Regime

__all__ = [
    "FreeMotion",
    "Precision",
    "Regime",
    "Sample",
    "Trajectory",
    "free_motion",
    "rotations_of_many",
    "states_of_many",
]
