# SPDX-License-Identifier: Apache-2.0
"""These questions are about many states of one body, such as the candidates among which a planner chooses.

They go through the batches of the physics, which take a small part of the time of as many single questions:
`tumbling.states_of_many` and `impact.spatial_impacts`. `many_contact_modes` is for contact modes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from contact_dynamics.contact.contact import MAX_CONTACTS
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact import ImpactOutcome, RestitutionLaw, StrikingBodies, spatial_impacts
from contact_dynamics.questions.context import Context, check_optional, or_default
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.touching import outside_shape
from contact_dynamics.records import Rows
from contact_dynamics.rotations.many import matrices_of
from contact_dynamics.tumbling import states_of_many
from contact_dynamics.validation import FloatArray, check_array
from contact_dynamics.validation_batches import (
    check_not_negative_rows,
    check_rows,
    check_share_rows,
    check_unit_rows,
)
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

MAX_STATES = MAX_CONTACTS  # largest number of states in a question; such a batch of impacts takes about 1 s


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyStates(Rows):
    """Many states of one body. Row i is state i.

    Attributes:
        p_WB_W: (n, 3), m, positions of the centre of mass.
        q_WB: (n, 4), unit quaternions x, y, z, w.
        v_WB_W: (n, 3), m/s, velocities of the centre of mass.
        w_WB_W: (n, 3), rad/s, angular velocities.

    Raises:
        InvalidFieldError: the arrays have different lengths, a number is not finite, or a quaternion is not
            unit. The message names the row.
        TooLargeError: more than `MAX_STATES` states.
    """

    p_WB_W: FloatArray
    q_WB: FloatArray
    v_WB_W: FloatArray
    w_WB_W: FloatArray

    if TYPE_CHECKING:

        def __init__(
            self, *, p_WB_W: ArrayLike, q_WB: ArrayLike, v_WB_W: ArrayLike, w_WB_W: ArrayLike
        ) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check the arrays."""
        count = len(check_array("p_WB_W", self.p_WB_W, (None, 3)))
        if count > MAX_STATES:
            raise TooLargeError("states", f"{count} states", f"at most {MAX_STATES}")
        for name, width in (("p_WB_W", 3), ("q_WB", 4), ("v_WB_W", 3), ("w_WB_W", 3)):
            object.__setattr__(self, name, check_array(name, getattr(self, name), (count, width)))
        object.__setattr__(self, "q_WB", check_unit_rows("q_WB", self.q_WB, 4))

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.p_WB_W)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyTumblingsQuestion(Question["ManyTumblingsAnswer"]):
    """Where will a body be that nothing touches, from each of many states?

    Attributes:
        body: The body, or the name of one of the known world.
        states: The states.
        seconds: (n,), or (1,) for all: s after each state, of either sign.
        gravity_W: (3,), m/s^2, world axes. If it is None, the known world's gravity acts.
    """

    body: Body | str
    states: ManyStates
    seconds: FloatArray
    gravity_W: FloatArray | None = None

    def __post_init__(self) -> None:
        """Check what has no type of its own."""
        object.__setattr__(self, "seconds", _rows("seconds", self.seconds, len(self.states)))
        if self.gravity_W is not None:
            object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyTumblingsAnswer(Answer):
    """Where the body is then.

    Attributes:
        body_name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        states: From state i in row i.
    """

    body_name: str
    p_FB_F: FloatArray
    states: ManyStates

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.states)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyImpactsQuestion(Question["ManyImpactsAnswer"]):
    """Which velocities does a body have after an impact in each of many states, with one contact each?

    Attributes:
        body: The body, or the name of one of the known world.
        states: The states just before.
        p_WC_W: (n, 3), m, the contact points.
        normals_W: (n, 3), or (1, 3) for all: unit, into the body.
        frictions: (n,), or (1,) for all: Coulomb's coefficients, >= 0.
        restitutions: (n,), or (1,) for all: in [0, 1].
        restitution_law: What the coefficients of restitution mean.
        velocity_tolerance: m/s, >= 0. A slower approach counts as none. None means the default.
    """

    body: Body | str
    states: ManyStates
    p_WC_W: FloatArray
    normals_W: FloatArray
    frictions: FloatArray
    restitutions: FloatArray
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON
    velocity_tolerance: float | None = None

    def __post_init__(self) -> None:
        """Check the lengths, the numbers and the law."""
        n = len(self.states)
        points = check_array("p_WC_W", self.p_WC_W, (n, 3))
        object.__setattr__(self, "p_WC_W", points)
        normals = check_unit_rows("normals_W", self.normals_W, 3)
        object.__setattr__(self, "normals_W", _rows("normals_W", normals, n, (3,)))
        frictions = check_not_negative_rows("frictions", self.frictions)
        object.__setattr__(self, "frictions", _rows("frictions", frictions, n))
        restitutions = check_share_rows("restitutions", self.restitutions)
        object.__setattr__(self, "restitutions", _rows("restitutions", restitutions, n))
        tolerance = check_optional("velocity_tolerance", self.velocity_tolerance)
        object.__setattr__(self, "velocity_tolerance", tolerance)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyImpactsAnswer(Answer):
    """What the impacts do. Row i belongs to state i.

    Attributes:
        body_name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        outcomes: (n,), values of `ImpactOutcome`. Where a contact separates, there is no impulse.
        separates: (n,), whether the contact leaves, so that nothing strikes.
        states: The states just after, with the poses from before.
        impulses_W: (n, 3), N s, on the body.
        warnings: What makes the answer doubtful, in words: a contact outside of the body's shape.
    """

    body_name: str
    p_FB_F: FloatArray
    outcomes: NDArray[np.int64]
    separates: NDArray[np.bool_]
    states: ManyStates
    impulses_W: FloatArray
    warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.states)


def answer_tumblings(question: ManyTumblingsQuestion, context: Context | None = None) -> ManyTumblingsAnswer:
    """Answer a question about many free bodies.

    Raises:
        ContactDynamicsError: a body is not known, or a number is not allowed; the message names its row.
    """
    known = Context() if context is None else context
    body = known.world.body(question.body) if isinstance(question.body, str) else question.body
    then = states_of_many(
        body.mass_properties.I_B,
        p_WB_W=question.states.p_WB_W,
        q_WB=question.states.q_WB,
        v_WB_W=question.states.v_WB_W,
        w_WB_W=question.states.w_WB_W,
        seconds=question.seconds,
        gravity_W=known.world.gravity_W if question.gravity_W is None else question.gravity_W,
    )
    states = ManyStates(p_WB_W=then.p_WB_W, q_WB=then.q_WB, v_WB_W=then.v_WB_W, w_WB_W=then.w_WB_W)
    return ManyTumblingsAnswer(body_name=body.name, p_FB_F=body.p_FB_F, states=states)


def answer_impacts(question: ManyImpactsQuestion, context: Context | None = None) -> ManyImpactsAnswer:
    """Answer a question about many impacts.

    Raises:
        ContactDynamicsError: a body is not known, or a number is not allowed; the message names its row.
    """
    known = Context() if context is None else context
    body = known.world.body(question.body) if isinstance(question.body, str) else question.body
    before, tolerance = (
        question.states,
        or_default(question.velocity_tolerance, known.defaults.velocity_tolerance),
    )
    r_W = question.p_WC_W - before.p_WB_W
    speeds = np.einsum("ij,ij->i", question.normals_W, before.v_WB_W + np.cross(before.w_WB_W, r_W))
    strikes = speeds <= tolerance
    after_v, after_w = before.v_WB_W.copy(), before.w_WB_W.copy()
    impulses, outcomes = np.zeros((len(before), 3)), np.zeros(len(before), dtype=np.int64)
    if strikes.any():
        found = spatial_impacts(
            StrikingBodies(
                masses=body.mass_properties.mass,
                inertias_B=body.mass_properties.I_B,
                q_WB=before.q_WB[strikes],
                v_WB_W=before.v_WB_W[strikes],
                w_WB_W=before.w_WB_W[strikes],
                r_W=r_W[strikes],
            ),
            normals_W=question.normals_W[strikes],
            frictions=question.frictions[strikes],
            restitutions=question.restitutions[strikes],
            restitution_laws=question.restitution_law,
            # The speeds above are rounded otherwise than those of the batch.
            velocity_tolerance=tolerance + 1e-12 * float(np.abs(speeds).max()),
        )
        after_v[strikes], after_w[strikes] = found.v_WB_W, found.w_WB_W
        impulses[strikes], outcomes[strikes] = found.impulses_W, found.outcomes
    outcomes[~strikes] = ImpactOutcome.NO_IMPULSE
    states = ManyStates(p_WB_W=before.p_WB_W, q_WB=before.q_WB, v_WB_W=after_v, w_WB_W=after_w)
    return ManyImpactsAnswer(
        body_name=body.name,
        p_FB_F=body.p_FB_F,
        outcomes=outcomes,
        separates=~strikes,
        states=states,
        impulses_W=impulses,
        warnings=outside_shape(
            body, points_W=question.p_WC_W, p_WB_W=before.p_WB_W, R_WB=matrices_of(before.q_WB)
        ),
    )


def _rows(field: str, value: ArrayLike, count: int, shape: tuple[int, ...] = ()) -> FloatArray:
    """Return a row for each of ``count`` states; a single row applies to all."""
    rows = check_rows(field, value, shape)
    if len(rows) not in {1, count}:
        raise InvalidFieldError(field, f"{len(rows)} rows", f"{count}, or one for all")
    return np.broadcast_to(rows, (count, *shape)).copy()
