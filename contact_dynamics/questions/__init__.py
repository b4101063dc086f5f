# SPDX-License-Identifier: Apache-2.0
"""Questions as Python objects: what is asked, what is known when it is asked, and what the answer says.

State a `TumblingQuestion`, an `ImpactQuestion`, a `ContactModeQuestion` or a `TossQuestion`, and `ask` it.
`services` has `ask`, and a record for each kind, from which all programs derive what they do with it. A
service's request becomes a question, and its answer becomes the response. A notebook, a test or a log asks
the same question without ROS.

Each kind has a file with its question, its answer and a function ``answer``. `tumbling` says where a free
body will be (lectures 24, 25). `impact` says which velocities follow (lecture 27), and `impact_question` has
its question and its answer. `contact_modes` says which contacts separate, slide or stay (lecture 26). `toss`
says where all that ends.

The kinds share these files: `context` (the world, defaults, and in a `state_store` what was published),
`subject` (which body, in which state, which may be an `uncertain_state`), `twist_axes` (whether published
velocities are in the right axes), `sample_times` (when), `touching` (which contacts), `extent` (how large
numbers may be) and `plane_of_motion` (in a plane or in space; modes of a plane in world axes, and back).
Answers describe every impact in the same way (`resolving`). `settled_impact` has the impact that follows an
inconsistency. `many` asks about many states at once, and `many_contact_modes` about many wrenches or sets of
contacts.

`effort` determines whether a question is quick, and `workers` are processes that answer those that are not.
"""

from contact_dynamics.questions.contact_modes import ContactModeAnswer, ContactModeQuestion
from contact_dynamics.questions.context import Context, Defaults
from contact_dynamics.questions.impact_question import (
    ImpactAnswer,
    ImpactQuestion,
    InTime,
    ResolvedImpact,
    SequenceStrike,
    StruckBody,
)
from contact_dynamics.questions.plane_of_motion import Problem
from contact_dynamics.questions.sample_times import (
    AtRate,
    AtStamps,
    AtTimes,
    Event,
    EventKind,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.services import ask
from contact_dynamics.questions.settled_impact import SettledImpact
from contact_dynamics.questions.state_store import StateStore
from contact_dynamics.questions.subject import FitQuality, PublishedState
from contact_dynamics.questions.toss import TossAnswer, TossPath, TossQuestion, TossSampling
from contact_dynamics.questions.tumbling import TumblingAnswer, TumblingQuestion
from contact_dynamics.questions.uncertain_state import UncertainState
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "AtRate",
    "AtStamps",
    "AtTimes",
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
    "Problem",
    "PublishedState",
    "ResolvedImpact",
    "SequenceStrike",
    "SettledImpact",
    "StateStore",
    "StruckBody",
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

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
