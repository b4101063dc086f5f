"""When and how a free body next strikes the world's surfaces: its flight, the first contact, and the contacts there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from contact_dynamics.contact_geometry import find_contacts
from contact_dynamics.first_contact import first_contact
from contact_dynamics.tolerances import DISTANCE_TOLERANCE, VELOCITY_TOLERANCE
from contact_dynamics.tumbling import free_motion

if TYPE_CHECKING:
    from contact_dynamics.contact import ContactSet
    from contact_dynamics.rigid_body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.world import Body, World


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Landing:
    """The first strike of a body."""

    seconds: float  # s after the state's stamp; 0 where the body touches and approaches already
    state: BodyState  # just before the strike
    contacts: ContactSet  # that strike; more than one where an edge or a face does
    velocities_W: FloatArray  # (n, 3), m/s, of the body's points at the contacts, world axes


def next_landing(
    body: Body,
    state: BodyState,
    world: World,
    *,
    horizon: float,
    distance_tolerance: float = DISTANCE_TOLERANCE,
    velocity_tolerance: float = VELOCITY_TOLERANCE,
) -> Landing | None:
    """Return the first strike within ``horizon`` (s), or None.

    A body that touches already strikes at once where a contact approaches faster than ``velocity_tolerance``
    (m/s). One that touches and rests or leaves does not: what counts then is where it comes down again.
    """
    at_once = _striking(body, state, world, distance_tolerance, velocity_tolerance)
    if at_once is not None:
        return Landing(seconds=0.0, state=state, contacts=at_once[0], velocities_W=at_once[1])
    motion = free_motion(body.mass_properties, state, gravity_W=world.gravity_W)
    strikes = [
        found.seconds
        for surface in world.surfaces
        if (
            found := first_contact(motion, body.vertices_B, surface.p_WS_W, surface.normal_W, horizon=horizon)
        )
    ]
    if not strikes:
        return None
    seconds = min(strikes)
    then = motion.state_at(seconds)
    struck = _striking(body, then, world, distance_tolerance, velocity_tolerance)
    if struck is None:  # a grazing touch, slower than the tolerance
        return None
    return Landing(seconds=seconds, state=then, contacts=struck[0], velocities_W=struck[1])


def _striking(
    body: Body, state: BodyState, world: World, distance_tolerance: float, velocity_tolerance: float
) -> tuple[ContactSet, FloatArray] | None:
    contacts = find_contacts(body, state, world.surfaces, distance_tolerance=distance_tolerance)
    if len(contacts) == 0:
        return None
    velocities = state.velocity_of_point(contacts.p_WC_W)
    approaching = np.einsum("ni,ni->n", velocities, contacts.normals_W) < -velocity_tolerance
    if not approaching.any():
        return None
    return contacts, velocities
