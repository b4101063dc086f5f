# SPDX-License-Identifier: Apache-2.0
"""Mass properties of particles, solids and meshes, and principal axes (Mason, lectures 24 and 25).

For a hammer: `from contact_dynamics import inertia`, then
``inertia.combined([inertia.cylinder(...), inertia.box(...).placed(p_GF_G=...)])``; `Body.of` makes a body of
the result for a `World`.

All functions return a `distribution` of mass, and `composition` makes one of particles or of several parts.
Mass properties are those of `solids`, `sheets_and_wires` (each with a `mass_or_density`), or a
`triangle_mesh`.
`axes_of_inertia` contains principal axes and the inertia ellipsoid, and `principal_frame` the same in
extended precision.
"""

from contact_dynamics.rigid_body.inertia.axes_of_inertia import (
    InertiaEllipsoid,
    PrincipalAxes,
    inertia_ellipsoid,
    principal_axes,
)
from contact_dynamics.rigid_body.inertia.composition import combined, particles, without
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution
from contact_dynamics.rigid_body.inertia.sheets_and_wires import (
    cylindrical_shell,
    disc,
    plate,
    ring,
    rod,
    spherical_shell,
)
from contact_dynamics.rigid_body.inertia.solids import (
    box,
    capsule,
    cone,
    cylinder,
    ellipsoid,
    hemisphere,
    hollow_sphere,
    sphere,
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
