"""Questions as Python objects: what is asked, what is known when it is asked, and what the answer says.

A service's request becomes one of these questions, and its answer becomes the response; a notebook, a test or
a replayed log asks the same question without ROS. Each of the three files has a question, an answer and a
function ``answer(question, knowledge)``:

- `tumbling`: where will a free body be (lectures 24, 25)?
- `impact`: which velocities follow an impact (lecture 27)?
- `contact_modes`: which contacts separate, slide or stay (lecture 26)?

What they share: `knowledge` (the world, published states, defaults), `subject` (which body, in which state),
`sample_times` (when), `which_impact`, `problem` (in a plane or in space), `touching` (which contacts).
"""

from contact_dynamics.questions.contact_modes import ContactModeAnswer, ContactModeQuestion
from contact_dynamics.questions.impact import ImpactAnswer, StruckBody
from contact_dynamics.questions.knowledge import Defaults, Knowledge
from contact_dynamics.questions.problem import Problem
from contact_dynamics.questions.resolved_impact import ResolvedImpact, SequenceStrike
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
from contact_dynamics.questions.subject import FitQuality, PublishedState, UncertainState
from contact_dynamics.questions.tumbling import TumblingAnswer, TumblingQuestion
from contact_dynamics.questions.which_impact import ImpactQuestion, InTime

__all__ = [
    "AtRate",
    "AtStamps",
    "AtTimes",
    "ContactModeAnswer",
    "ContactModeQuestion",
    "Defaults",
    "Event",
    "EventKind",
    "FitQuality",
    "ImpactAnswer",
    "ImpactQuestion",
    "InTime",
    "Knowledge",
    "Problem",
    "PublishedState",
    "ResolvedImpact",
    "SequenceStrike",
    "SettledImpact",
    "StateStore",
    "StruckBody",
    "TumblingAnswer",
    "TumblingQuestion",
    "UncertainState",
    "UntilContact",
    "UntilPlane",
]
