"""Mass properties (Mason, lectures 24, 25): of particles, shapes and meshes; composed; in principal axes.

`from contact_dynamics import inertia`, then for a hammer: ``inertia.combined([inertia.cylinder(...),
inertia.box(...).placed(p_GF_G=...)])``; `Body.of` makes a body of it for a `World`.

In reading order: what all shapes become (`distribution`), put together (`composition`);
`system_of_particles`; `solids`, `thin` sheets and wires (of an `amount` of mass); `triangle_mesh` (checked by
`surface` and `parts`, integrated by `polyhedron`); `principal` axes and the inertia ellipsoid.
"""

from contact_dynamics.rigid_body.inertia.composition import combined, without
from contact_dynamics.rigid_body.inertia.distribution import MassDistribution
from contact_dynamics.rigid_body.inertia.principal_axes import (
    InertiaEllipsoid,
    PrincipalAxes,
    inertia_ellipsoid,
    principal_axes,
)
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
from contact_dynamics.rigid_body.inertia.system_of_particles import particles
from contact_dynamics.rigid_body.inertia.triangle_mesh import convex_hull, mesh

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
