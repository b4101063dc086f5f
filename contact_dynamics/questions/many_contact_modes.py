# SPDX-License-Identifier: Apache-2.0
"""One question about contact modes for many candidates at once: applied wrenches, or sets of contacts.

Body, state and contacts are looked up once. Each candidate then has the answer of a single question, to the
last bit: modes have no faster batch, since candidates differ in which modes there are to try.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError, TooLargeError
from contact_dynamics.questions import contact_modes
from contact_dynamics.questions.contact_modes import ContactModeQuestion
from contact_dynamics.questions.context import Context, or_default
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.subject import subject_of
from contact_dynamics.questions.touching import in_contact
from contact_dynamics.questions.uncertain_state import UncertainState
from contact_dynamics.validation import FloatArray, check_array
from contact_dynamics.validation_batches import check_rows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.rigid_body.body import BodyState

MAX_CANDIDATES: Final = 1000
"""Largest number of candidates in one question. In the plane, with four contacts, they take about 1 s."""

_PLAIN: Final = ContactModeQuestion(body="")

_ONLY_OF_ONE: Final = (
    "friction_facets",
    "include_wrenches",
    "include_statics",
    "include_impact",
    "uncertainty",
    "include_geometry_margins",
    "include_probabilities",
)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyContactModesQuestion(Question["ManyContactModesAnswer"]):
    """Which contact modes follow for each of many candidates?

    There are as many sets of contacts as wrenches, or one of either for all of the other.

    Attributes:
        asked: What is the same for all candidates. Its contacts are those of all sets, one after the other.
            It has no wrench of its own, and of its optional results only margins.
        forces_W: (n, 3), N, applied besides gravity and contact forces, world axes.
        torques_W: (n, 3), N m, applied about the centre of mass, world axes.
        contact_counts: How many contacts each set has. Without any, all contacts are one set.

    Raises:
        InvalidFieldError: the arrays have different lengths, a number is not finite, or ``asked`` has a
            wrench or an option that this question does not support.
        TooLargeError: more than `MAX_CANDIDATES` candidates.
    """

    asked: ContactModeQuestion
    forces_W: FloatArray
    torques_W: FloatArray
    contact_counts: tuple[int, ...] = ()

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            asked: ContactModeQuestion,
            forces_W: ArrayLike,
            torques_W: ArrayLike,
            contact_counts: Sequence[int] = (),
        ) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check the arrays, and repeat what holds for all."""
        _check_supported(self.asked)
        forces = check_rows("forces_W", self.forces_W, (3,))
        counts = _counts(self.contact_counts)
        most = max(len(forces), len(counts))
        if most > MAX_CANDIDATES:
            raise TooLargeError("forces_W", f"{most} candidates", f"at most {MAX_CANDIDATES}")
        torques = check_array("torques_W", self.torques_W, (len(forces), 3))
        if counts:
            given = 0 if self.asked.contacts is None else len(self.asked.contacts)
            if min(counts) < 1 or sum(counts) != given:
                allowed = f"numbers >= 1 whose sum is {given}, the number of explicit contacts"
                raise InvalidFieldError("contact_counts", counts, allowed)
        if len(counts) > 1:
            if len(forces) not in {1, len(counts)}:
                allowed = f"{len(counts)}, one for each set of contacts, or one for all"
                raise InvalidFieldError("forces_W", f"{len(forces)} rows", allowed)
            forces, torques = (np.broadcast_to(rows, (most, 3)).copy() for rows in (forces, torques))
        object.__setattr__(self, "forces_W", forces)
        object.__setattr__(self, "torques_W", torques)
        object.__setattr__(self, "contact_counts", counts)

    def __len__(self) -> int:
        """Return how many candidates there are."""
        return len(self.forces_W)

    @property
    def about(self) -> ContactModeQuestion:
        """What is the same for all candidates: the body, its state, gravity."""
        return self.asked


def _check_supported(asked: ContactModeQuestion) -> None:
    for name, of_many in (("force_W", "forces_W"), ("torque_W", "torques_W")):
        if (value := getattr(asked, name)).any():
            raise InvalidFieldError(f"asked.{name}", value, f"zero: {of_many} has the wrenches")
    for name in _ONLY_OF_ONE:
        value = getattr(asked, name)
        if value is not getattr(_PLAIN, name) and value:
            raise InvalidFieldError(f"asked.{name}", value, "its default: it is for single questions only")


def _counts(value: Sequence[int]) -> tuple[int, ...]:
    try:
        given = tuple(value)
    except TypeError:
        raise InvalidFieldError("contact_counts", value, "a list of whole numbers") from None
    if any(isinstance(count, bool) or not isinstance(count, (int, np.integer)) for count in given):
        raise InvalidFieldError("contact_counts", value, "a list of whole numbers")
    return tuple(int(count) for count in given)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ManyContactModesAnswer(Answer):
    """The consistent modes of each candidate. Those of all candidates follow one after the other.

    Attributes:
        body_name: The body's name, which may be empty.
        p_FB_F: (3,), m, its centre of mass in its published frame F.
        state: The state that all candidates share.
        contacts: The contacts of all sets, one after the other.
        contact_counts: How many contacts each set has.
        verdicts: (n,), values of `ModeVerdict`.
        problems: (n,), values of `Problem`: in the plane or in space.
        mode_counts: (n,), the number of consistent modes of each candidate.
        modes: The m modes, as strings with one letter for each contact.
        accelerations_W: (m, 3), m/s^2, of the centre of mass.
        angular_accelerations_W: (m, 3), rad/s^2.
        margins: (m,), N, how far each mode's wrench is from another mode, or None if not asked for.
        warnings: What makes an answer doubtful, in words, and for which candidates.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    contacts: ContactSet
    contact_counts: tuple[int, ...]
    verdicts: NDArray[np.int64]
    problems: NDArray[np.int64]
    mode_counts: NDArray[np.int64]
    modes: tuple[str, ...]
    accelerations_W: FloatArray
    angular_accelerations_W: FloatArray
    margins: FloatArray | None
    warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Return how many candidates there are."""
        return len(self.verdicts)


def answer(question: ManyContactModesQuestion, context: Context | None = None) -> ManyContactModesAnswer:
    """Answer a question about many candidates.

    Raises:
        ContactDynamicsError: a body or its state is not known, nothing touches, or a candidate is not
            allowed. The message names the candidate.
    """
    known = Context() if context is None else context
    asked = question.asked
    subject = subject_of(asked.body, asked.state, known)
    tolerance = or_default(asked.distance_tolerance, known.defaults.distance_tolerance)
    state: KnownState = subject.state
    if len(question.contact_counts) > 1 and asked.contacts is not None:  # they are alternatives
        contacts = asked.contacts
        if subject.covariance is not None:
            state = UncertainState(state=subject.state, covariance=subject.covariance)
    else:
        subject, contacts, _ = in_contact(
            asked.contacts,
            subject,
            known.world,
            distance_tolerance=tolerance,
            velocity_tolerance=or_default(asked.velocity_tolerance, known.defaults.velocity_tolerance),
            carriers=known.carrier_noise,
        )
        state = subject.state
        known = replace(known, carrier_noise=())  # the state is the likeliest one already
    counts = question.contact_counts or (len(contacts),)
    ends = np.cumsum(counts).tolist()
    sets = [
        contacts if len(counts) == 1 else contacts.subset(range(end - count, end))
        for count, end in zip(counts, ends, strict=True)
    ]
    shared = replace(asked, body=subject.body, state=state)
    found = [_candidate(i, question, shared, sets[i % len(sets)], known) for i in range(len(question))]
    modes = [mode for each in found for mode in each.modes]
    margins = [margin.margin for each in found for margin in each.margins or ()]
    return ManyContactModesAnswer(
        body_name=subject.body.name,
        p_FB_F=subject.body.p_FB_F,
        state=subject.state,
        contacts=contacts,
        contact_counts=counts,
        verdicts=np.array([each.verdict for each in found], dtype=np.int64),
        problems=np.array([each.problem for each in found], dtype=np.int64),
        mode_counts=np.array([len(each.modes) for each in found], dtype=np.int64),
        modes=tuple(mode.mode for mode in modes),
        accelerations_W=np.array([mode.acceleration_W for mode in modes]).reshape(-1, 3),
        angular_accelerations_W=np.array([mode.angular_acceleration_W for mode in modes]).reshape(-1, 3),
        margins=np.array(margins, dtype=np.float64) if asked.include_margins else None,
        warnings=_warnings([each.warnings for each in found]),
    )


def _warnings(by_candidate: Sequence[tuple[str, ...]]) -> tuple[str, ...]:
    """Return each different warning once, with the candidates that have it."""
    rows: dict[str, list[int]] = {}
    for i, warnings in enumerate(by_candidate):
        for warning in warnings:
            rows.setdefault(warning, []).append(i)
    return tuple(f"{_candidates(found, len(by_candidate))}: {warning}" for warning, found in rows.items())


def _candidates(rows: Sequence[int], count: int) -> str:
    if len(rows) == count:
        return "all candidates"
    if len(rows) == 1:
        return f"candidate {rows[0]}"
    return f"{len(rows)} of {count} candidates, of which candidate {rows[0]} is the first"


def _candidate(
    i: int,
    question: ManyContactModesQuestion,
    shared: ContactModeQuestion,
    contacts: ContactSet,
    known: Context,
) -> ContactModeAnswer:
    try:
        force, torque = question.forces_W[i], question.torques_W[i]
        return contact_modes.answer(replace(shared, contacts=contacts, force_W=force, torque_W=torque), known)
    except InvalidFieldError as error:
        raise type(error)(f"candidate {i}: {error.field}", error.found, error.allowed, error.hint) from None
    except ContactDynamicsError as error:
        raise type(error)(f"candidate {i}: {error}") from None
