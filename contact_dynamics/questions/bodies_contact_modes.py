# SPDX-License-Identifier: Apache-2.0
"""Contact modes of several bodies that touch each other and the world: stacks, a box between fingers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.noise import resting_bodies
from contact_dynamics.contact.pairs import check_pairs, seconds_apart
from contact_dynamics.contact_modes import BodiesContactProblem, BodiesMode, ModeVerdict, contact_modes
from contact_dynamics.contact_modes.planar.problem import MAX_PLANAR_CONTACTS
from contact_dynamics.contact_modes.spatial.response import for_each
from contact_dynamics.errors import InvalidFieldError, NoContactError, TooLargeError
from contact_dynamics.questions.contact_modes import TAKEN_AS_FLUSH
from contact_dynamics.questions.context import Context, check_optional, or_default
from contact_dynamics.questions.extent import check_contacts, check_extent, check_wrench
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.subject import NEWEST, NamedState, StateSource, at_one_time, subject_of
from contact_dynamics.questions.touching import outside_shape, without_contacts
from contact_dynamics.tolerances import FLUSH, STATES_APART
from contact_dynamics.validation import FloatArray, check_array
from contact_dynamics.world import Body

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.questions.subject import Subject

MAX_BODIES: Final = 32  # largest number of bodies in one question, as of contacts (`MAX_DYNAMIC_CONTACTS`)

_AS_MEASURED: Final = (
    "the velocities are those measured, since their noise does not explain them as rest of all contacts: a "
    "contact is at rest only if it is slower than velocity_tolerance"
)

_APART: Final = "the states differ in time by {:.3g} ms, which matters if the bodies move"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesContactModeQuestion(Question["BodiesContactModeAnswer"]):
    """Question about the contact modes of several bodies under applied wrenches.

    Attributes:
        bodies: Each a body, or the name of a body of the context's world.
        states: State of each body, or a reference to a published state. The default is the latest published
            state of each, at the time of the oldest of these. If states have covariances, a chi-square test
            at the 99.9 % confidence level determines whether all contacts may rest.
        contacts: Contacts of all bodies, as in `BodiesContactProblem`.
        pairs: For each contact, the body into which its normal points, and the other body, or None for the
            world. They are indices into ``bodies``.
        forces_W: (k, 3), N, applied force on each body in addition to gravity and contact forces, world axes.
        torques_W: (k, 3), N m, applied torque on each body about its centre of mass. The default of both is
            zero. One vector may be given for all bodies.
        gravity_W: (3,), m/s^2, world axes. None means the gravity of the context's world.
        velocity_tolerance: m/s, >= 0. Speed below which a contact counts as at rest. None means the default.

    Raises:
        InvalidFieldError: lists differ in length, an index is out of range, a number is out of range or not
            finite, or the surface of a body is given a motion.
        TooLargeError: more than `MAX_BODIES` bodies.
    """

    bodies: tuple[Body | str, ...] = field(metadata={"accepts": "Sequence[Body | str]"})
    states: tuple[StateSource, ...] = field(default=(), metadata={"accepts": "Sequence[StateSource]"})
    contacts: ContactSet
    pairs: tuple[tuple[int, int | None], ...] = field(
        metadata={"accepts": "Sequence[tuple[int, int | None]]"}
    )
    forces_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    torques_W: FloatArray = field(default_factory=lambda: np.zeros(3))
    gravity_W: FloatArray | None = None
    velocity_tolerance: float | None = None

    if TYPE_CHECKING:

        def __init__(
            self,
            *,
            bodies: Sequence[Body | str],
            states: Sequence[StateSource] = (),
            contacts: ContactSet,
            pairs: Sequence[tuple[int, int | None]],
            forces_W: ArrayLike = ...,
            torques_W: ArrayLike = ...,
            gravity_W: ArrayLike | None = ...,
            velocity_tolerance: float | None = ...,
        ) -> None:
            """Accept everything that NumPy converts to arrays."""

    def __post_init__(self) -> None:
        """Check the lists and the numbers, and repeat what holds for all bodies."""
        count = len(self.bodies)
        if count > MAX_BODIES:
            raise TooLargeError("bodies", f"{count} bodies", f"at most {MAX_BODIES}")
        states = tuple(self.states) or (NEWEST,) * count
        check_pairs(count, states, self.contacts, self.pairs)
        object.__setattr__(self, "bodies", tuple(self.bodies))
        object.__setattr__(self, "states", states)
        object.__setattr__(self, "pairs", tuple((first, second) for first, second in self.pairs))
        for name in ("forces_W", "torques_W"):
            object.__setattr__(self, name, for_each(name, getattr(self, name), count))
        if self.gravity_W is not None:
            object.__setattr__(self, "gravity_W", check_array("gravity_W", self.gravity_W, (3,)))
        tolerance = check_optional("velocity_tolerance", self.velocity_tolerance)
        object.__setattr__(self, "velocity_tolerance", tolerance)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BodiesContactModeAnswer(Answer):
    """Verdict on all contacts of several bodies, and all consistent modes, in world axes.

    Attributes:
        bodies: The bodies, with the states for which the question was answered.
        contacts: Contacts.
        pairs: For each contact, the indices of the body into which its normal points and of the other body,
            or None for the world.
        verdict: Verdict on all contacts together.
        modes: All consistent modes.
        approaching: Indices of the approaching contacts.
        undecided: The undecided cases and the reason. Empty unless the verdict is UNDECIDED.
        undecided_modes: Modes for which it is undecided whether they are consistent.
        velocity_tolerance: m/s, tolerance that was used.
        warnings: Texts about limited validity: a contact outside a body's shape, a surface of the world that
            a body touches without a contact, contacts treated as flush because the verdict would otherwise be
            undecided, states of different times, or measured velocities that noise does not explain as rest.
    """

    bodies: tuple[NamedState, ...]
    contacts: ContactSet
    pairs: tuple[tuple[int, int | None], ...]
    verdict: ModeVerdict
    modes: tuple[BodiesMode, ...]
    approaching: tuple[int, ...]
    undecided: str = ""
    undecided_modes: tuple[str, ...] = ()
    velocity_tolerance: float
    warnings: tuple[str, ...] = ()

    @property
    def body_name(self) -> str:  # type: ignore[override]  # other answers have one body
        """All names in one text."""
        return ", ".join(body.name for body in self.bodies)

    @property
    def stamp_ns(self) -> int:
        """The newest stamp of the states, ns, or 0 without one."""
        return max((body.state.stamp_ns for body in self.bodies), default=0)


def answer(question: BodiesContactModeQuestion, context: Context | None = None) -> BodiesContactModeAnswer:
    """Answer a question about the contact modes of several bodies.

    Raises:
        ContactDynamicsError: there is no contact, or something is not known or not allowed. The message names
            it.
    """
    known = Context() if context is None else context
    contacts = question.contacts
    if len(contacts) == 0:
        raise NoContactError("contacts must be at least one, got none")
    if len(contacts) > MAX_PLANAR_CONTACTS:
        raise TooLargeError("contacts", f"{len(contacts)} contacts", f"at most {MAX_PLANAR_CONTACTS}")
    check_contacts(contacts)
    gravity_W = known.world.gravity_W if question.gravity_W is None else question.gravity_W
    subjects, forces_W = [], []
    for i, source in enumerate(at_one_time(question.bodies, question.states, known)):
        try:
            subject = subject_of(question.bodies[i], source, known)
            check_extent(subject.body.mass_properties, subject.state)
            force_W = question.forces_W[i] + subject.body.mass_properties.mass * gravity_W
            check_wrench(force_W, question.torques_W[i])
        except InvalidFieldError as error:
            raise type(error)(f"body {i}: {error.field}", error.found, error.allowed, error.hint) from None
        subjects.append(subject)
        forces_W.append(force_W)
    states = [subject.state for subject in subjects]
    tolerance = or_default(question.velocity_tolerance, known.defaults.velocity_tolerance)
    resting = resting_bodies(
        states,
        [subject.covariance for subject in subjects],
        contacts,
        question.pairs,
        velocity_tolerance=tolerance,
    )
    is_measured = any(subject.covariance is not None for subject in subjects)
    subjects = [replace(one, state=state) for one, state in zip(subjects, resting or states, strict=True)]
    found = contact_modes(
        BodiesContactProblem(
            bodies=[subject.body.mass_properties for subject in subjects],
            states=[subject.state for subject in subjects],
            contacts=contacts,
            pairs=question.pairs,
            forces_W=forces_W,
            torques_W=question.torques_W,
            velocity_tolerance=tolerance,
        )
    )
    apart = seconds_apart([subject.state for subject in subjects])
    return BodiesContactModeAnswer(
        bodies=tuple(
            NamedState(name=subject.body.name, p_FB_F=subject.body.p_FB_F, state=subject.state)
            for subject in subjects
        ),
        contacts=contacts,
        pairs=question.pairs,
        verdict=found.verdict,
        modes=found.modes,
        approaching=found.approaching,
        undecided=found.undecided,
        undecided_modes=found.undecided_modes,
        velocity_tolerance=found.velocity_tolerance,
        warnings=(
            *([_APART.format(1e3 * apart)] if apart > STATES_APART else []),
            *([_AS_MEASURED] if is_measured and resting is None else []),
            *([TAKEN_AS_FLUSH] if found.flush_within > FLUSH else []),
            *(text for i, subject in enumerate(subjects) for text in _outside(question, i, subject, known)),
        ),
    )


def _outside(
    question: BodiesContactModeQuestion, index: int, subject: Subject, known: Context
) -> tuple[str, ...]:
    """Return warnings of contacts of one body outside of its shape, or inside it, and of those left out."""
    own = [i for i, pair in enumerate(question.pairs) if index in pair]
    with_world = [i for i, pair in enumerate(question.pairs) if tuple(pair) == (index, None)]
    state, tolerance = subject.state, known.defaults.distance_tolerance
    outside = outside_shape(
        subject.body,
        points_W=question.contacts.p_WC_W[own],
        p_WB_W=state.p_WB_W,
        R_WB=state.R_WB,
        distance_tolerance=tolerance,
        numbers=own,
    )
    normals_W = question.contacts.normals_W[with_world]
    return outside + without_contacts(
        subject.body, state, known.world, normals_W, distance_tolerance=tolerance
    )
