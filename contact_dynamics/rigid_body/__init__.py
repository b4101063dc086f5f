# SPDX-License-Identifier: Apache-2.0
"""Rigid bodies: mass properties, states, momenta and energies (Mason, lectures 24 and 25).

`body` contains a body's mass properties and its state, with the quantities that follow from them.
`published_frame` converts between the published frame of a body and the frame at its centre of mass.
`inertia` computes mass properties from particles, solids and meshes, and principal axes.
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
