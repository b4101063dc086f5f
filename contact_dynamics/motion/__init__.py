# SPDX-License-Identifier: Apache-2.0
"""Motion under gravity, wrenches and drag is integrated, differentiated and fitted here, with covariances.

`forces` says what acts on a body besides gravity. `integrated` computes its motion, with the differential
`equations`. Its function `motion_of` takes the closed form where no torque and no drag acts.
`free_derivative` and `integrated_derivative` say how a motion changes with its first state, and `covariance`
carries the covariance of that state along. `free_fit` and `integrated_fit` find the motion that fits some
published states best, and `whole_turns` determines whether the states distinguish it from motions with more
turns. `flight_check` finds impacts among them. `between_states` interpolates, and `velocity_estimate` finds
velocities from poses.
"""

from contact_dynamics.motion.covariance import (
    CarriedCovariance,
    PropagationMethod,
    covariance_along,
    propagate_covariance,
)
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.free_derivative import rotation_derivatives, state_derivatives
from contact_dynamics.motion.free_fit import FitResult, StateNoise, fit_free_motion
from contact_dynamics.motion.integrated import ChosenMotion, ForcedMotion, Method, forced_motion, motion_of
from contact_dynamics.motion.integrated_derivative import forced_state_derivatives
from contact_dynamics.motion.integrated_fit import fit_motion
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "CarriedCovariance",
    "ChosenMotion",
    "ConstantWrench",
    "Drag",
    "FitResult",
    "ForcedMotion",
    "Method",
    "PropagationMethod",
    "StateNoise",
    "WrenchAxes",
    "covariance_along",
    "fit_free_motion",
    "fit_motion",
    "forced_motion",
    "forced_state_derivatives",
    "motion_of",
    "propagate_covariance",
    "rotation_derivatives",
    "state_derivatives",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
