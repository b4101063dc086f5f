# SPDX-License-Identifier: Apache-2.0
"""Draws the diagrams of `contact_dynamics.diagrams` with Matplotlib, each into the axes that are given."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from contact_dynamics.diagrams.contact_forces import contact_forces
from contact_dynamics.diagrams.force_dual import force_dual
from contact_dynamics.diagrams.impulse_space import impulse_space, impulse_space_in_3d
from contact_dynamics.diagrams.many_states import many_states_marks
from contact_dynamics.diagrams.mode_map import mode_map
from contact_dynamics.diagrams.poinsot import poinsot_diagram
from contact_dynamics.diagrams.shape import NO_FACES
from contact_dynamics.diagrams.toss_scene import toss_marks
from contact_dynamics.diagrams.toss_tree import event_tree
from contact_dynamics.diagrams.trajectory_curves import (
    angular_momenta_of,
    energies_of,
    momenta_of,
    over_time,
)
from contact_dynamics.plots.drawing import draw_diagram, draw_seen

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import PlanarWrenchSet, SpatialMode
    from contact_dynamics.diagrams.marks import Diagram
    from contact_dynamics.diagrams.shape import Shape
    from contact_dynamics.diagrams.wrench_chart import ForceDualChart, WrenchChart
    from contact_dynamics.motion.covariance import CarriedCovariance
    from contact_dynamics.plane.types import PlanarContact, PlanarWrench
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.rigid_body.body import BodyState, HasMassProperties
    from contact_dynamics.toss import Toss, TossDistribution
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.tumbling.poinsot_construction import Poinsot, RollingCurves
    from contact_dynamics.validation import FloatArray


def draw_impulse_space(
    axes: Axes,
    body: HasMassProperties | None,
    answer: ImpactAnswer,
    *,
    other: HasMassProperties | None = None,
) -> None:
    """Draw the impulse path of an impact's main contact, N s, with what bounds and bends it.

    In space, path and sticking line are projected onto the plane of the normal and the total impulse, and the
    legend says so.

    Args:
        axes: The axes to draw into.
        body: The body, or its mass properties. If it is None, there are no sticking and compression lines.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it there are no lines for two bodies.
    """
    draw_diagram(axes, impulse_space(body, answer, other=other))


def draw_impulse_space_in_3d(
    axes: Any,
    body: HasMassProperties | None,
    answer: ImpactAnswer,
    *,
    other: HasMassProperties | None = None,
) -> None:
    """Draw the impulse path of an impact's main contact in all three dimensions, N s.

    Args:
        axes: Axes in 3D, as ``figure.add_subplot(projection="3d")`` makes them. They have no type.
        body: The body, or its mass properties. If it is None, sticking line and compression plane are not
            drawn.
        answer: The impact.
        other: The body that is struck, or its mass properties. Without it both are missing for two bodies.
    """
    draw_diagram(axes, impulse_space_in_3d(body, answer, other=other))


def draw_planar_scene(axes: Axes, scene: Diagram, *, title: str | None = None) -> None:
    """Draw a planar body with its contacts, m from the centre of mass, and one mode's forces.

    The sizes of forces and accelerations stand in the legend. The longest arrow of each kind suits the body.

    Args:
        axes: The axes to draw into.
        scene: What `diagrams.planar_scene.planar_scene_of` made.
        title: The title, which is the scene's own by default.
    """
    draw_diagram(axes, scene, title=title)


def draw_contact_forces(axes: Axes, contacts: ContactSet, mode: SpatialMode, *, title: str = "") -> None:
    """Draw the contact forces of a mode, N, with the friction cone of each different friction coefficient.

    Args:
        axes: The axes to draw into.
        contacts: The contacts.
        mode: The mode, whose forces may be one choice of many.
        title: The title, which is the mode's letters by default.
    """
    draw_diagram(axes, contact_forces(contacts, mode, title=title))


def draw_mode_map(
    axes: Axes,
    sets: Sequence[PlanarWrenchSet],
    chart: WrenchChart,
    *,
    applied: PlanarWrench | None = None,
    change: PlanarWrench | None = None,
) -> None:
    """Draw the map of contact modes over applied wrenches.

    Args:
        axes: The axes to draw into.
        sets: The result of `contact_modes.wrench_sets`.
        chart: How wrenches are laid out.
        applied: A wrench to mark.
        change: The least change of the wrench that brings about another mode, drawn as a path from it.
    """
    draw_diagram(axes, mode_map(sets, chart, applied=applied, change=change))


def draw_force_dual(
    axes: Axes,
    one: PlanarWrenchSet,
    contacts: Sequence[PlanarContact],
    chart: ForceDualChart,
    *,
    outlines: Sequence[FloatArray] = (),
) -> None:
    """Draw lecture 26's construction for one mode of a body at rest: centres, force duals, what they span.

    Args:
        axes: The axes to draw into.
        one: The mode's applied wrenches, of `contact_modes.wrench_sets`.
        contacts: All contacts, in the order of the mode's letters.
        chart: How much of the plane to show.
        outlines: Strips, (k, 2) each, m from the centre of mass, drawn below: the body, walls.
    """
    draw_diagram(axes, force_dual(one, contacts, chart, outlines=outlines))


def draw_poinsot(axes: Any, picture: Poinsot, curves: RollingCurves, state: BodyState) -> None:
    """Draw ellipsoid, plane, polhode and herpolhode of a body that rotates, rad/s.

    Args:
        axes: Axes in 3D, as ``figure.add_subplot(projection="3d")`` makes them. They have no type.
        picture: The constants of the rotation.
        curves: Polhode and herpolhode.
        state: The state at which the ellipsoid is drawn.
    """
    draw_diagram(axes, poinsot_diagram(picture, curves, state))


def draw_toss(
    axes: Axes,
    toss: Toss | TossAnswer,
    shape: Shape,
    *,
    across: str = "x",
    up: str = "z",
    distribution: TossDistribution | None = None,
) -> None:
    """Draw a toss seen along one of the world's axes: path, strikes, pose at the end, other ways, samples.

    Args:
        axes: where to draw.
        toss: the toss, or the answer to a question about one.
        shape: the body's shape, for its outline.
        across: the world's axis, "x", "y" or "z", to the right.
        up: the one upwards.
        distribution: samples of a toss, or None. An answer has its own.
    """
    marks = toss_marks(shape, toss, up_W=np.array([0.0, 0.0, 1.0]), told=distribution)
    draw_seen(axes, marks, across=across, up=up)


def draw_event_tree(axes: Axes, told: TossDistribution) -> None:
    """Draw the tree of the next strikes over time: 50 and 90 % of the times of each, and its probability."""
    draw_diagram(axes, event_tree(told))


def draw_many_states(
    axes: Axes, answer: ManyTumblingsAnswer | ManyImpactsAnswer, *, across: str = "x", up: str = "z"
) -> None:
    """Draw the position of each centre of mass, m, with an arrow along its velocity.

    Impacts have a marker for each outcome.

    Args:
        axes: where to draw.
        answer: the answer.
        across: the world's axis, "x", "y" or "z", to the right.
        up: the one upwards.
    """
    draw_seen(axes, many_states_marks(NO_FACES, answer), across=across, up=up)


def draw_position(axes: Axes, trajectory: Trajectory, *, covariance: CarriedCovariance | None = None) -> None:
    """Draw the position of the centre of mass, m, with bands of two deviations if there is a covariance."""
    deviations = None
    if covariance is not None:
        variances = np.diagonal(covariance.covariances[:, :3, :3], axis1=1, axis2=2)
        deviations = np.sqrt(np.maximum(variances, 0.0))
    draw_diagram(axes, over_time(trajectory, trajectory.p_WB_W, "position, m", deviations=deviations))


def draw_attitude(axes: Axes, trajectory: Trajectory) -> None:
    """Draw the orientation as the components of its unit quaternion, body to world."""
    draw_diagram(axes, over_time(trajectory, trajectory.q_WB, "orientation, unit quaternion", "xyzw"))


def draw_velocity(axes: Axes, trajectory: Trajectory) -> None:
    """Draw the velocity of the centre of mass, m/s."""
    draw_diagram(axes, over_time(trajectory, trajectory.v_WB_W, "velocity, m/s"))


def draw_angular_velocity(axes: Axes, trajectory: Trajectory) -> None:
    """Draw the angular velocity, rad/s."""
    draw_diagram(axes, over_time(trajectory, trajectory.w_WB_W, "angular velocity, rad/s"))


def draw_momentum(axes: Axes, trajectory: Trajectory, body: HasMassProperties) -> None:
    """Draw the momentum, kg m/s."""
    momenta = momenta_of(body.mass_properties, trajectory)
    draw_diagram(axes, over_time(trajectory, momenta, "momentum, kg m/s"))


def draw_angular_momentum(axes: Axes, trajectory: Trajectory, body: HasMassProperties) -> None:
    """Draw the angular momentum about the centre of mass, kg m²/s."""
    momenta = angular_momenta_of(body.mass_properties, trajectory)
    draw_diagram(axes, over_time(trajectory, momenta, "angular momentum, kg m²/s"))


def draw_energy(
    axes: Axes, trajectory: Trajectory, body: HasMassProperties, *, gravity_W: FloatArray
) -> None:
    """Draw the kinetic energies, the potential energy and their sum, J.

    ``gravity_W`` is (3,), m/s^2. The potential energy is zero at the origin of the world.
    """
    energies = energies_of(body.mass_properties, trajectory, gravity_W=gravity_W)
    rows = np.column_stack([energies.translational, energies.rotational, energies.potential, energies.total])
    names = ("translation", "rotation", "potential", "sum")
    draw_diagram(axes, over_time(trajectory, rows, "energy, J", names))
