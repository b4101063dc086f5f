# SPDX-License-Identifier: Apache-2.0
"""Tosses: the motion of a body from a state in flight to rest, in one call.

`toss` follows a single motion, and `sampled_toss` the motions of many samples of an uncertain state and
uncertain parameters (`TossUncertainty`). `Toss` and `TossDistribution` are their results.

The modules of this package are internal. `one_toss` contains the call, and also follows the other branches
where mechanics does not determine the motion. `simulation` proceeds from event to event: each `flight` in
closed form, strikes (`strike`), contact phases (`phase`), and rest. `history` records the events, and
`result` contains the types of the result.

- `solid` contains the body and the planes in plain floats, and the points that touch. Corners that nearly
  coincide are merged (`distinct_corners`).
- `strike` resolves the strikes of one instant, with `impacts` at one contact, at contacts without an order,
  and without restitution if contacts jam.
- `mode_choice` chooses the next contact mode. It tries and corrects the present one first, searches for
  forces in friction cones (`cone_forces`), and calls `contact_modes` where several modes may be consistent.
- `forces` computes the accelerations in a mode, and keeps contacts closed and the body out of the planes.
  `phase` integrates the accelerations until the mode ends.
- If strikes and modes alternate at one instant, a `short_step` continues beyond it.

Uncertain inputs (`uncertainty`) are sampled: `sampled` contains the call, and `distribution` its result.
`next_strikes` computes the next strikes of the samples, and `law_spread` the scatter of the impact law.
`to_rest` follows samples to rest, each as a toss of its own, in one or several processes. `laid_flat` ends
their rattling on a face.

The modules with a `.pxd` file are parts of the compiled core, which has its own `vectors`.
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
    "contact_dynamics.toss.next_strikes",
    "contact_dynamics.toss.history",
    "contact_dynamics.toss.simulation",
)

from contact_dynamics.toss.distribution import (  # noqa: E402  after the core
    Branch,
    BranchKind,
    EventRegions,
    Ghosts,
    Region,
    RestSpread,
    TossDistribution,
)
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
    "Branch",
    "BranchKind",
    "EventRegions",
    "Ghosts",
    "Region",
    "RestSpread",
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
