"""Every public constructor and function of the physics, with arguments that it takes, by chapter."""

from hostile_values.contacts import CALLS_WITH_CONTACTS
from hostile_values.impacts import IMPACTS
from hostile_values.questions import QUESTIONS
from hostile_values.rigid_bodies import RIGID_BODIES

CALLS = {**RIGID_BODIES, **CALLS_WITH_CONTACTS, **IMPACTS, **QUESTIONS}
