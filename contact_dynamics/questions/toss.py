# SPDX-License-Identifier: Apache-2.0
"""Where does a tossed body come to rest, and what happens on the way? All lectures in one motion (`toss`)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields

import numpy as np

from contact_dynamics.constants import HORIZON
from contact_dynamics.errors import InvalidFieldError, TooLargeError
from contact_dynamics.impact import RestitutionLaw, SeveralContactsLaw
from contact_dynamics.questions.context import Context, or_default
from contact_dynamics.questions.extent import check_extent
from contact_dynamics.questions.sample_times import MAX_SAMPLES as MAX_TIMES
from contact_dynamics.questions.services import Answer, Question
from contact_dynamics.questions.subject import NEWEST, FitQuality, StateSource, subject_of
from contact_dynamics.records import Record
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.toss import Toss, TossDistribution, TossUncertainty, sampled_toss, toss
from contact_dynamics.toss.result import TossOutcome
from contact_dynamics.toss.sampled import MAX_SAMPLES, MAX_STRIKES
from contact_dynamics.toss.uncertainty import EXACT, check_factors
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.validation import FloatArray, check_positive, check_whole
from contact_dynamics.world import Body

STRIKES = 2  # default number of next strikes in the tree


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class TossSampling(Record):
    """Samples of what is not known exactly.

    Attributes:
        count: How many, 1 to `toss.sampled.MAX_SAMPLES`.
        strikes: How many next strikes the tree has, 1 to `toss.sampled.MAX_STRIKES`. None means `STRIKES`.
        to_rest: Whether samples are followed to rest, which takes each of them a hundred
            times as long, or longer.
        seed: Samples are drawn from it, >= 0.
        uncertainty: How uncertain parameters and law of impact are. The state has a covariance of its own.

    Raises:
        TooLargeError: more samples are asked for.
        InvalidFieldError: another number is out of its range.
    """

    count: int
    strikes: int | None = None
    to_rest: bool = False
    seed: int = 0
    uncertainty: TossUncertainty = EXACT

    def __post_init__(self) -> None:
        """Check the numbers."""
        if check_whole("samples", self.count, 1) > MAX_SAMPLES:
            raise TooLargeError("samples", self.count, f"at most {MAX_SAMPLES}")
        if self.strikes is not None:
            check_whole("strikes", self.strikes, 1, MAX_STRIKES)
        check_whole("seed", self.seed, 0, 2**32 - 1)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossQuestion(Question["TossAnswer"]):
    """Question about a toss: the motion of a body to rest.

    Attributes:
        body: The body, or the name of a body of the context's world. Its shape has corners, which may be
            rounded.
        state: State of the body, with or without a covariance, or a reference to a published state.
        restitution_law: Law of restitution.
        several_contacts_law: Law for several contacts that strike at one instant.
        horizon: s, > 0. Duration of the longest motion that is followed. None means `constants.HORIZON`.
        rate: Sample rate of the trajectory, Hz, > 0. None means the default.
        max_alternatives: Largest number of other branches to follow where mechanics does not determine the
            motion. None means 0.
        sampling: Samples of an uncertain toss, or None for no distribution.
        lasting_factors: (s,), >= 0, friction of sustained contact with each surface, relative to that of
            strikes. If it is empty, the factors of the sampling's uncertainty are used, and without these the
            factors of the surfaces.

    Raises:
        InvalidFieldError: a number is out of range, a law is not a member of its enumeration, or the
            sampling's uncertainty has other factors.
    """

    body: Body | str
    state: StateSource = NEWEST
    restitution_law: RestitutionLaw = RestitutionLaw.POISSON
    several_contacts_law: SeveralContactsLaw = SeveralContactsLaw.SEQUENTIAL
    horizon: float | None = None
    rate: float | None = None
    max_alternatives: int | None = None
    sampling: TossSampling | None = None
    lasting_factors: FloatArray = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        """Check the numbers and the law."""
        for name in ("horizon", "rate"):
            value = getattr(self, name)
            object.__setattr__(self, name, None if value is None else check_positive(name, value))
        if self.max_alternatives is not None:
            check_whole("max_alternatives", self.max_alternatives, 0)
        factors = check_factors("lasting_factors", self.lasting_factors)
        if self.sampling is not None:
            sampled = self.sampling.uncertainty.lasting_factors
            if len(factors) and not np.array_equal(factors, sampled):
                allowed = "none, or those of the sampling's uncertainty"
                raise InvalidFieldError("lasting_factors", factors.tolist(), allowed)
            factors = sampled
        object.__setattr__(self, "lasting_factors", factors)

    @property
    def detects_contacts(self) -> bool:
        """All contacts of a toss are detected."""
        return True


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossPath(TossOutcome):
    """One way in which a toss can go; `TossOutcome` documents the other fields.

    Attributes:
        trajectory: The motion at the rate asked for. Its last sample is at ``seconds``.
    """

    trajectory: Trajectory


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossAnswer(Answer):
    """Motion of a tossed body to rest.

    Attributes:
        body_name: Name of the body, which may be empty.
        p_FB_F: (3,), m, centre of mass in the published frame F.
        state: State of the question. Times are relative to its stamp.
        fit: Quality of the fit to published states, or None without a fit.
        toss: The toss.
        alternatives: Tosses that follow other branches, where mechanics does not determine the motion.
        all_followed: Whether ``alternatives`` contains all other branches.
        distribution: Distribution of the outcomes under uncertain state, parameters and impacts, or None
            without samples.
        warnings: Uncertain motions of carried surfaces, and noise that the distribution leaves out.
    """

    body_name: str
    p_FB_F: FloatArray
    state: BodyState
    fit: FitQuality | None
    toss: TossPath
    alternatives: tuple[TossPath, ...]
    all_followed: bool
    distribution: TossDistribution | None
    warnings: tuple[str, ...] = ()

    @property
    def paths(self) -> tuple[TossPath, ...]:
        """Return the toss and its alternatives."""
        return (self.toss, *self.alternatives)

    @property
    def predicted_motion(self) -> Trajectory:
        """Return the motion up to rest."""
        return self.toss.trajectory


def answer(question: TossQuestion, context: Context | None = None) -> TossAnswer:
    """Answer a question about a toss. Without ``context`` no body is known by name, and no surface.

    Raises:
        ContactDynamicsError: something is asked for that is not known, not allowed or not supported. The
            message names it.
    """
    known = Context() if context is None else context
    subject = subject_of(question.body, question.state, known)
    body, state = subject.body, subject.state
    check_extent(body.mass_properties, state)
    horizon = or_default(question.horizon, HORIZON)
    rate = or_default(question.rate, known.defaults.rate)
    sampling, distribution = question.sampling, None
    if sampling is not None:
        distribution = sampled_toss(
            body,
            state,
            known.world,
            covariance=subject.covariance,
            by_gravity=subject.by_gravity,
            uncertainty=sampling.uncertainty,
            count=sampling.count,
            strikes=STRIKES if sampling.strikes is None else sampling.strikes,
            to_rest=sampling.to_rest,
            seed=sampling.seed,
            restitution_law=question.restitution_law,
            several_contacts_law=question.several_contacts_law,
            horizon=horizon,
            distance_tolerance=known.defaults.distance_tolerance,
        )
    went = toss(
        body,
        state,
        known.world,
        restitution_law=question.restitution_law,
        several_contacts_law=question.several_contacts_law,
        horizon=horizon,
        max_alternatives=question.max_alternatives or 0,
        lasting_factors=question.lasting_factors,
        distance_tolerance=known.defaults.distance_tolerance,
    )
    return TossAnswer(
        body_name=body.name,
        p_FB_F=body.p_FB_F,
        state=state,
        fit=subject.fit,
        toss=_path(went, rate),
        alternatives=tuple(_path(other, rate) for other in went.alternatives),
        all_followed=went.all_followed,
        distribution=distribution,
        warnings=(*(known.notes or ()), *(_without_noise(known) if distribution is not None else ())),
    )


def _without_noise(known: Context) -> tuple[str, ...]:
    carriers = dict.fromkeys(each.carrier for each in known.carrier_noise)
    return tuple(
        f"the distribution leaves out the noise of {name!r}, which carries a surface" for name in carriers
    )


def _path(went: Toss, rate: float) -> TossPath:
    """Return a toss for the answer, with the motion at a rate, Hz."""
    count = went.seconds * rate
    if count > MAX_TIMES - 1:
        raise TooLargeError("rate", f"{count:.9g} samples until {went.seconds:.3g} s", f"at most {MAX_TIMES}")
    times = np.append(np.arange(math.ceil(count - 1e-9)) / rate, went.seconds)  # without a last one twice
    shared = {each.name: getattr(went, each.name) for each in fields(TossOutcome)}
    return TossPath(trajectory=went.at(times), **shared)
