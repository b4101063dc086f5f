"""Tumbling (Mason, lecture 25): where a free rigid body will be, at any time, in closed form.

In reading order: principal axes (`principal_frame`), the constants of a rotation (`polhode`) with the
elliptic integrals they need (`elliptic`), attitude as quotients of theta functions (`theta`, set up by
`attitude_form`), phases over many turns (`double_double`), and the motion itself (`motion`).
"""

from contact_dynamics.tumbling.arithmetic import Precision
from contact_dynamics.tumbling.motion import FreeMotion, Sample, Trajectory, free_motion
from contact_dynamics.tumbling.regime import Regime

__all__ = ["FreeMotion", "Precision", "Regime", "Sample", "Trajectory", "free_motion"]
