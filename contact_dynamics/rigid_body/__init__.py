# SPDX-License-Identifier: Apache-2.0
"""Rigid bodies have mass properties, states, momenta and energies (Mason, lectures 24 and 25).

`body` has a body's mass properties, its state, and what follows from the two. `published_frame` converts
between the frame that is published for a body and the one at its centre of mass. `inertia` makes mass
properties from particles, shapes and meshes, and has principal axes.
"""

from contact_dynamics.rigid_body import inertia
from contact_dynamics.rigid_body.body import (
    BodyState,
    HasMassProperties,
    MassProperties,
    angular_momentum,
    kinetic_energy,
    momentum,
    rotational_energy,
    state_covariance,
)
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "BodyState",
    "HasMassProperties",
    "MassProperties",
    "angular_momentum",
    "inertia",
    "kinetic_energy",
    "momentum",
    "rotational_energy",
    "state_covariance",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
