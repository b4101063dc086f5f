# SPDX-License-Identifier: Apache-2.0
"""Questions and answers: the requests and responses of the services as Python objects.

Make a `TumblingQuestion`, an `ImpactQuestion`, a `ContactModeQuestion` or a `TossQuestion`, and pass it to
`ask` with a `Context`. The services convert each request to a question, and its answer to the response. A
notebook, a test or a log uses the same questions without ROS.

The modules of this package are internal. `services` contains `ask`, and a record for each kind of question,
from which all programs derive their behaviour. Each kind has a file with its question, its answer and a
function ``answer``: `tumbling` predicts the motion of a free body (lectures 24, 25), `impact` the velocities
after an impact (lecture 27; `impact_question` contains its question and its answer), `contact_modes` the
contacts that separate, slide or stick (lecture 26), `bodies_contact_modes` those of several bodies, and
`toss` the motion to rest.

The kinds share these files: `context` (the world, defaults, and the published states in a `state_store`),
`carried_surface` (planes that move with bodies),
`subject` (the body and its state, which may be an `uncertain_state`), `twist_axes` (the check of the axes of
published velocities), `sample_times` (times of samples), `touching` (contacts), `extent` (limits of numbers)
and `plane_of_motion` (modes and impacts of a plane in world axes). `settled_impact` computes the impact that
follows an inconsistency. `many` contains questions about many states at once, and `many_contact_modes` about
many wrenches or sets of contacts.

`effort` determines whether a question is inexpensive, and `workers` are processes that answer the expensive
ones.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Final

from contact_dynamics.questions import services
from contact_dynamics.validation_types import checks_types

if TYPE_CHECKING:  # the same as `_HOMES`
    from contact_dynamics.questions.bodies_contact_modes import (
        BodiesContactModeAnswer,
        BodiesContactModeQuestion,
    )
    from contact_dynamics.questions.carried_surface import CarriedSurface
    from contact_dynamics.questions.contact_modes import ContactModeAnswer, ContactModeQuestion
    from contact_dynamics.questions.context import Context, Defaults, Problem
    from contact_dynamics.questions.impact_question import ImpactAnswer, ImpactQuestion, InTime
    from contact_dynamics.questions.sample_times import (
        AtRate,
        AtStamps,
        AtTimes,
        Event,
        EventKind,
        UntilContact,
        UntilPlane,
    )
    from contact_dynamics.questions.settled_impact import SettledImpact
    from contact_dynamics.questions.state_store import StateStore
    from contact_dynamics.questions.subject import FitQuality, NamedState, PublishedState
    from contact_dynamics.questions.toss import TossAnswer, TossPath, TossQuestion, TossSampling
    from contact_dynamics.questions.tumbling import TumblingAnswer, TumblingQuestion
    from contact_dynamics.questions.uncertain_state import UncertainState

_HOMES: Final = {
    "bodies_contact_modes": ("BodiesContactModeAnswer", "BodiesContactModeQuestion"),
    "carried_surface": ("CarriedSurface",),
    "contact_modes": ("ContactModeAnswer", "ContactModeQuestion"),
    "context": ("Context", "Defaults", "Problem"),
    "impact_question": ("ImpactAnswer", "ImpactQuestion", "InTime"),
    "sample_times": ("AtRate", "AtStamps", "AtTimes", "Event", "EventKind", "UntilContact", "UntilPlane"),
    "settled_impact": ("SettledImpact",),
    "state_store": ("StateStore",),
    "subject": ("FitQuality", "NamedState", "PublishedState"),
    "toss": ("TossAnswer", "TossPath", "TossQuestion", "TossSampling"),
    "tumbling": ("TumblingAnswer", "TumblingQuestion"),
    "uncertain_state": ("UncertainState",),
}
"""The names of each module, which is imported on first use: a server answers before it has imported all."""

ask = checks_types(services.ask)
ask.__module__ = __name__  # where pickle finds it


def __getattr__(name: str) -> object:
    """Import a name on first use."""
    for module, names in _HOMES.items():
        if name in names:
            globals()[name] = found = getattr(import_module(f"{__name__}.{module}"), name)
            return found
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


__all__ = [
    "AtRate",
    "AtStamps",
    "AtTimes",
    "BodiesContactModeAnswer",
    "BodiesContactModeQuestion",
    "CarriedSurface",
    "ContactModeAnswer",
    "ContactModeQuestion",
    "Context",
    "Defaults",
    "Event",
    "EventKind",
    "FitQuality",
    "ImpactAnswer",
    "ImpactQuestion",
    "InTime",
    "NamedState",
    "Problem",
    "PublishedState",
    "SettledImpact",
    "StateStore",
    "TossAnswer",
    "TossPath",
    "TossQuestion",
    "TossSampling",
    "TumblingAnswer",
    "TumblingQuestion",
    "UncertainState",
    "UntilContact",
    "UntilPlane",
    "ask",
]


def __dir__() -> list[str]:
    return __all__
