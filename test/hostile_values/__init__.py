# SPDX-License-Identifier: Apache-2.0
"""Every public constructor, function and method of the physics, with arguments that it takes, by chapter."""

from hostile_values.contacts import CALLS_WITH_CONTACTS
from hostile_values.impacts import IMPACTS
from hostile_values.modes import MODES
from hostile_values.motions import MOTIONS
from hostile_values.questions import QUESTIONS
from hostile_values.rigid_bodies import RIGID_BODIES
from hostile_values.tosses import TOSSES

CALLS = {**RIGID_BODIES, **MOTIONS, **CALLS_WITH_CONTACTS, **MODES, **IMPACTS, **TOSSES, **QUESTIONS}

UNCHECKED = {
    "BodyState.velocity_of_point",
    "ContactSet.subset",
    "ContactUncertainty.check_count",
    "ContactUncertainty.of_each",
    "Curvatures.in_direction",
    "Curvatures.subset",
    "ForcedMotion.sample",
    "ForcedMotion.step_at",
    "ForcedMotion.steps_to",
    "FreeMotion.sample",
    "MassProperties.inertia_in_world",
    "PlanarContact.gap_acceleration",
    "PlanarContact.reach",
    "PlanarWrenchSet.depth",
    "PlaneOfMotion.lift",
    "SpatialWrenchSet.depth",
}
"""Arithmetic of values, which the chapters do in their loops too. It takes arrays and numbers as they are."""
