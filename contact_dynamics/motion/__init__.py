# SPDX-License-Identifier: Apache-2.0
"""Motion under gravity, wrenches and drag: integration, derivatives, fits to states, and covariances.

- Motion: `motion_of` chooses between the closed form and integration (`forced_motion`), under a
  `ConstantWrench` and `Drag`.
- Fits to published states: `fit_free_motion`, `fit_motion`, with the noise of the states as `StateNoise`,
  which `measured_noise` estimates from recorded flights.
- Covariances: `covariance_along`, `propagate_covariance`. Derivatives: `state_derivatives`,
  `forced_state_derivatives`.

The modules of this package are internal. `forces` contains the loads on a body besides gravity, and its
differential equations, from which `integrated` computes its motion. `free_derivative` and
`integrated_derivative` compute the derivatives of a motion with respect to its initial state, with which
`covariance` propagates the covariance of that state. `free_fit` and `integrated_fit` find the motion that
fits published states best, with the noise of `state_noise`, and `whole_turns` determines whether the states
distinguish it from motions with more turns. `flight_check` detects impacts among the states. `between_states`
interpolates, and `velocity_estimate` estimates velocities from poses. `noise_measurement` estimates the noise
of poses from flights.
"""

from contact_dynamics.motion.covariance import (
    CarriedCovariance,
    PropagationMethod,
    covariance_along,
    propagate_covariance,
)
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.free_derivative import state_derivatives
from contact_dynamics.motion.free_fit import FitResult, fit_free_motion
from contact_dynamics.motion.integrated import ChosenMotion, ForcedMotion, Method, forced_motion, motion_of
from contact_dynamics.motion.integrated_derivative import forced_state_derivatives
from contact_dynamics.motion.integrated_fit import fit_motion
from contact_dynamics.motion.noise_measurement import measured_noise
from contact_dynamics.motion.state_noise import StateNoise
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
    "measured_noise",
    "motion_of",
    "propagate_covariance",
    "state_derivatives",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
