# SPDX-License-Identifier: Apache-2.0
"""Mass properties of particles, solids and meshes, and principal axes (Mason, lectures 24 and 25).

For a hammer: `from contact_dynamics import inertia`, then
``inertia.combined([inertia.cylinder(...), inertia.box(...).placed(p_GF_G=...)])``; `Body.of` makes a body of
the result for a `World`.

All functions return a `distribution` of mass, that of particles, of several parts, of `solids`, sheets and
wires, or of a `triangle_mesh`. `axes_of_inertia` contains principal axes and the inertia ellipsoid.
"""

from contact_dynamics.rigid_body.inertia.axes_of_inertia import (
    InertiaEllipsoid,
    PrincipalAxes,
    inertia_ellipsoid,
    principal_axes,
)
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution, combined, particles, without
from contact_dynamics.rigid_body.inertia.solids import (
    box,
    capsule,
    cone,
    cylinder,
    cylindrical_shell,
    disc,
    ellipsoid,
    hemisphere,
    hollow_sphere,
    plate,
    ring,
    rod,
    sphere,
    spherical_shell,
    torus,
    tube,
)
from contact_dynamics.rigid_body.inertia.triangle_mesh import convex_hull, mesh
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "InertiaEllipsoid",
    "MassDistribution",
    "PrincipalAxes",
    "box",
    "capsule",
    "combined",
    "cone",
    "convex_hull",
    "cylinder",
    "cylindrical_shell",
    "disc",
    "ellipsoid",
    "hemisphere",
    "hollow_sphere",
    "inertia_ellipsoid",
    "mesh",
    "particles",
    "plate",
    "principal_axes",
    "ring",
    "rod",
    "sphere",
    "spherical_shell",
    "torus",
    "tube",
    "without",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
