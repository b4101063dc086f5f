# SPDX-License-Identifier: Apache-2.0
"""Whole tosses: the motion of a body from a state in flight to rest, in one call.

`one_toss` is the call, and follows other ways where mechanics does not decide. `simulation` goes from event
to event: each `flight` in closed form, strikes (`strike`), contact phases (`phase`), and rest. `history`
keeps what happens, and `result` has what is returned.

- `solid` has the body and the flats in plain floats, and the points that touch. Corners that are very near to
  each other are one (`distinct_corners`).
- `strike` has the strikes of one instant, of the `impacts` at one contact, at contacts that have no order,
  and without restitution, as where contacts jam.
- `mode_choice` chooses the next contact mode. It tries the present one first, corrects it, seeks pushes in
  friction cones (`cone_forces`), and asks `contact_modes` where there may be several modes.
- `forces` has the accelerations in a mode, and keeps contacts where they are, and the body out of the flats.
  `phase` integrates the accelerations until the mode ends.
- Where strikes and modes lead to one another at one instant, a `short_step` passes over that.

What is not known exactly (`uncertainty`) is sampled: `sampled` is the call, and `distribution` has what it
returns. `next_strikes` has the next strikes of samples, and `law_spread` what the law of impact
leaves open. `to_rest` has samples on their way to rest, each as a toss of its own, which several processes
can share. `laid_flat` ends their rattling on a face.

The modules with a `.pxd` are parts of the compiled core, which has `vectors` of its own.
"""

from contact_dynamics.numerics.compiled import import_core

import_core(
    "contact_dynamics.toss.vectors",
    "contact_dynamics.toss.solid",
    "contact_dynamics.toss.forces",
    "contact_dynamics.toss.cone_forces",
    "contact_dynamics.toss.mode_choice",
    "contact_dynamics.toss.phase",
    "contact_dynamics.toss.flight",
    "contact_dynamics.toss.impacts",
    "contact_dynamics.toss.strike",
    "contact_dynamics.toss.laid_flat",
    "contact_dynamics.toss.law_spread",
    "contact_dynamics.toss.history",
    "contact_dynamics.toss.simulation",
)

from contact_dynamics.toss.distribution import TossDistribution  # noqa: E402  after the core
from contact_dynamics.toss.one_toss import toss  # noqa: E402  after the core
from contact_dynamics.toss.result import (  # noqa: E402  after the core
    Toss,
    TossEnd,
    TossEnergy,
    TossEvent,
    TossEventKind,
    Undecided,
    UndecidedReason,
)
from contact_dynamics.toss.sampled import sampled_toss  # noqa: E402  after the core
from contact_dynamics.toss.uncertainty import TossUncertainty  # noqa: E402  after the core
from contact_dynamics.validation_types import check_types_of  # noqa: E402  after the core

__all__ = [
    "Toss",
    "TossDistribution",
    "TossEnd",
    "TossEnergy",
    "TossEvent",
    "TossEventKind",
    "TossUncertainty",
    "Undecided",
    "UndecidedReason",
    "sampled_toss",
    "toss",
]

check_types_of(globals())


def __dir__() -> list[str]:
    return __all__
