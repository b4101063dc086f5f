# SPDX-License-Identifier: Apache-2.0
"""Puts answers into words, beside the pictures of them: regimes, outcomes, verdicts, certainties."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.contact_modes import Certainty, ModeVerdict
from contact_dynamics.contact_modes.letters import LETTERS
from contact_dynamics.contact_modes.result import shared_forces
from contact_dynamics.impact import ImpactOutcome, SequenceEnd
from contact_dynamics.toss import TossEnd, TossEventKind, UndecidedReason
from contact_dynamics.toss.distribution import BranchKind, axis_in_words
from contact_dynamics.tumbling.polhode import Regime

if TYPE_CHECKING:
    from contact_dynamics.contact_modes import BodyStatics, GeometryMargin, SpatialModeMargin, VerdictsWithin
    from contact_dynamics.diagrams.after_impact import AfterImpact
    from contact_dynamics.impact import ResolvedImpact
    from contact_dynamics.questions.bodies_contact_modes import BodiesContactModeAnswer
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer
    from contact_dynamics.questions.settled_impact import SettledImpact
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.tumbling.flips import Flips
    from contact_dynamics.validation import FloatArray

AFTER_IMPACT: Final = "After the impact"  # the kind of words about what was measured after an answer
MAX_LISTED: Final = 8  # up to this number of refused modes are listed. The others are only counted.

REGIMES: Final = {  # the words for each kind of rotation
    Regime.UNKNOWN: "a torque acts",
    Regime.AT_REST: "it does not rotate",
    Regime.SPHERICAL: "its moments are equal: it spins steadily",
    Regime.PRINCIPAL_AXIS: "it spins steadily about a principal axis",
    Regime.AXISYMMETRIC: "it precesses steadily",
    Regime.ABOUT_MINOR_AXIS: "it tumbles about its minor axis",
    Regime.ABOUT_MAJOR_AXIS: "it tumbles about its major axis",
    Regime.SEPARATRIX: "it turns over once, on the separatrix",
}

OUTCOMES: Final = {outcome: outcome.name.replace("_", " ").lower() for outcome in ImpactOutcome}
"""The words for what a contact does in an impact."""

SEQUENCE_ENDS: Final = {  # the words for what follows the last of several strikes in time
    SequenceEnd.NOTHING_STRIKES: "it flies",
    SequenceEnd.STAYS: "a contact stays",
    SequenceEnd.CHATTERS: "it chatters to rest at a contact",
    SequenceEnd.MAX_STRIKES: "the maximum number of impacts was reached",
    SequenceEnd.WINDOW_ENDED: "the window ended",
}

VERDICTS: Final = {  # the words for each verdict on a contact set
    ModeVerdict.UNIQUE: "has one consistent mode",
    ModeVerdict.INDETERMINATE: "has several consistent modes, of which mechanics selects none",
    ModeVerdict.INCONSISTENT: "has no consistent mode: an impact without approach resolves it",
    ModeVerdict.IMPACT: "approaches: modes apply only after the impact",
    ModeVerdict.UNDECIDED: "has modes that may be incomplete",
}

CERTAINTIES: Final = {  # the words for answers to static questions
    Certainty.NO: "no",
    Certainty.POSSIBLE: "possible",
    Certainty.CERTAIN: "certain",
    Certainty.UNKNOWN: "unknown",
}


TOSS_ENDS: Final = {  # what the body does at the end of a toss
    TossEnd.RESTS: "rests",
    TossEnd.HORIZON: "still moves at the horizon",
    TossEnd.MAX_EVENTS: "exceeds the maximum number of events or steps",
}

UNDECIDED: Final = {  # the words for why mechanics does not decide
    UndecidedReason.STRIKE_TOGETHER: "simultaneous impacts",
    UndecidedReason.SEVERAL_MODES: "several modes are consistent",
}

BRANCHES: Final = {  # the words for what happens on a branch of the tree
    BranchKind.STRIKES: "strikes",
    BranchKind.STAYS: "stays in contact",
    BranchKind.FLIES: "meets nothing",
    BranchKind.ENDS: "no further strike",
}


def tumbling_in_words(answer: TumblingAnswer) -> list[str]:
    """Return words for the length of the motion, its end, and its kind of rotation."""
    event, seconds = answer.event, answer.trajectory.seconds
    if event is None:
        end = f"has {len(seconds)} samples"
        if len(seconds) > 0:
            end += f" from {seconds[0]:.4g} to {seconds[-1]:.4g} s"
    else:
        where, speed = event.surface or "the plane", np.linalg.norm(event.velocity_W)
        end = (
            f"reaches {where} in {event.seconds:.4g} s at ({_numbers(event.point_W)}) m with {speed:.3g} m/s"
        )
    regime = Regime.UNKNOWN if answer.poinsot is None else answer.poinsot.regime
    return [end, REGIMES[regime], *_flips_in_words(answer.flips)]


def impact_in_words(answer: ImpactAnswer) -> list[str]:
    """Return words for the velocities before and after the impact, its impulse, and the energy lost."""
    impact, other = answer.impact, answer.other
    words = [
        f"strikes in {answer.seconds_to_contact:.4g} s: {outcome_in_words(impact.outcome)}",
        f"velocity ({_numbers(answer.state.v_WB_W)}) becomes ({_numbers(impact.state.v_WB_W)}) m/s",
        f"impulse {np.linalg.norm(impact.impulses_W.sum(axis=0)):.3g} N s",
    ]
    if not impact.strikes:  # between strikes in time gravity works too
        words.append(f"{impact.kinetic_energy_before - impact.kinetic_energy_after:.3g} J lost")
    if other is not None and impact.other_state is not None:
        after = _numbers(impact.other_state.v_WB_W)
        words.append(f"that of {other.name or 'the other body'} becomes ({after}) m/s")
    words += _probabilities_in_words(impact)
    if impact.strikes and impact.end is not None:
        count, last = len(impact.strikes), 1e3 * impact.strikes[-1].seconds
        words.append(f"{count} impacts within {last:.3g} ms; then {SEQUENCE_ENDS[impact.end]}")
    if impact.creates_energy:
        words.append("the law creates energy: do not trust this answer")
    return words


def after_impact_in_words(found: AfterImpact) -> list[str]:
    """Return words for the velocities after an impact as measured and as predicted, and their difference."""
    after = found.answer.impact.state
    return [
        f"velocity measured ({_numbers(found.v_WB_W)}), predicted ({_numbers(after.v_WB_W)}) m/s",
        f"spin measured ({_numbers(found.w_WB_W)}), predicted ({_numbers(after.w_WB_W)}) rad/s",
        f"they differ by {found.linear_error:.2g} m/s and {found.angular_error:.2g} rad/s",
    ]


def contact_modes_in_words(answer: ContactModeAnswer) -> list[str]:
    """Return words for the verdict with every mode, for refused modes, and for what else was asked for."""
    margins = [""] * len(answer.modes)
    if answer.margins is not None:
        margins = [margin_in_words(margin) for margin in answer.margins]
    modes = [f"{mode.mode} {margin}".strip() for mode, margin in zip(answer.modes, margins, strict=True)]
    words = [_verdict_in_words(answer.verdict, modes)]
    words += _within_in_words(answer.within) + _geometry_in_words(answer.geometry_margins)
    words += shared_forces(answer.modes)
    speeds = np.linalg.norm(answer.contact_velocities_W, axis=1)
    words += [f"contact {i + 1} approaches with {speeds[i]:.3g} m/s" for i in answer.approaching]
    refused = [refused.mode for refused in answer.refused]
    if refused:
        more = f" and {len(refused) - MAX_LISTED} more" if len(refused) > MAX_LISTED else ""
        words.append(f"inconsistent: {', '.join(refused[:MAX_LISTED])}{more}")
    return [*words, *_statics_in_words(answer.statics), *_settled_in_words(answer.settled)]


def bodies_contact_modes_in_words(answer: BodiesContactModeAnswer) -> list[str]:
    """Return words for the verdict with every mode, and for the contacts that approach."""
    words = [_verdict_in_words(answer.verdict, [mode.mode for mode in answer.modes])]
    words += shared_forces(answer.modes)
    return [*words, *(f"contact {i + 1} approaches" for i in answer.approaching)]


def contacts_in_words(letters: str, count: int) -> str:
    """Return words such as "2 contacts slide left". The letters of several modes are joined by `|`."""
    if letters == "?":
        return "no mode"
    several = count > 1
    words = " or ".join(LETTERS[letter][several] for letter in letters.split("|"))
    return f"{count} contacts {words}" if several else words


def toss_in_words(answer: TossAnswer) -> list[str]:
    """Return words for the end of a toss, the way there, what is undecided, and what else can happen."""
    path = answer.toss
    where = ", ".join(f"{x:.3g}" for x in (path.trajectory.p_WB_W[-1] + 0.0).tolist())
    strikes = sum(event.kind == TossEventKind.STRIKES for event in path.events)
    corners = ""
    if path.resting_corners:
        corners = f" with {path.face_on_top} on top, on corners {' '.join(map(str, path.resting_corners))}"
    words = [f"{TOSS_ENDS[path.end]} after {path.seconds:.3g} s{corners} at ({where}) m, {strikes} strikes"]
    if path.undecided:
        reasons = dict.fromkeys(UNDECIDED[point.reason] for point in path.undecided)
        followed = "all followed" if answer.all_followed else "not followed"
        if answer.alternatives and not answer.all_followed:
            followed = f"followed to {len(answer.alternatives)} alternatives"
        count = f"{len(path.undecided)} branch point{'s' if len(path.undecided) > 1 else ''}"
        words.append(f"{count} ({', '.join(reasons)}), {followed}")
    if answer.distribution is not None:
        words += _distribution_in_words(answer.distribution)
    return words


def many_tumblings_in_words(answer: ManyTumblingsAnswer) -> list[str]:
    """Return words for how many states there are."""
    return [f"has {len(answer)} states"]


def many_impacts_in_words(answer: ManyImpactsAnswer) -> list[str]:
    """Return words for how many states there are, and what the impacts do."""
    words = [
        "separates" if separates else OUTCOMES[ImpactOutcome(int(outcome))]
        for outcome, separates in zip(answer.outcomes, answer.separates, strict=True)
    ]
    return [f"has {len(answer)} states", *(f"{n} {word}" for word, n in Counter(words).most_common())]


def many_contact_modes_in_words(answer: ManyContactModesAnswer) -> list[str]:
    """Return words for how many candidates there are, and the verdicts on them."""
    ends = np.cumsum(answer.mode_counts).tolist()
    words = [
        _verdict_in_words(ModeVerdict(verdict), list(answer.modes[end - count : end]))
        for verdict, count, end in zip(
            answer.verdicts.tolist(), answer.mode_counts.tolist(), ends, strict=True
        )
    ]
    return [f"has {len(answer)} candidates", *(f"{n} {word}" for word, n in Counter(words).most_common())]


def outcome_in_words(outcome: ImpactOutcome | None) -> str:
    """Return words for what a contact does in an impact. The outcome is None if the law does not say."""
    return "several at once" if outcome is None else OUTCOMES[outcome]


def branch_in_words(kind: BranchKind, corner: int) -> str:
    """Return words for what happens on a branch of the tree."""
    return f"corner {corner} {BRANCHES[kind]}" if kind == BranchKind.STRIKES else BRANCHES[kind]


def face_in_words(normal_B: FloatArray) -> str:
    """Return which face lies on a surface with a normal, (3,), body axes: "-z", or its outward normal."""
    return axis_in_words(0.0 - normal_B)


def margin_in_words(margin: SpatialModeMargin) -> str:
    """Return words for how far a mode's wrench is from another mode."""
    if math.isnan(margin.margin):
        return "(unknown margin)"
    if math.isinf(margin.margin):
        return "(infinite margin)"
    beyond = " or ".join(margin.modes_beyond) or "no mode"
    return f"(margin {margin.margin:.3g} N to {beyond})"


def _verdict_in_words(verdict: ModeVerdict, modes: list[str]) -> str:
    return f"{VERDICTS[verdict]}: {', '.join(modes)}" if modes else VERDICTS[verdict]


def _within_in_words(within: VerdictsWithin | None) -> list[str]:
    """Return words for the verdicts that occur if the contacts are known only to some uncertainty."""
    if within is None:
        return []
    if within.certain:
        return ["the verdict holds within the errors of the contacts"]
    verdicts = ", ".join(VERDICTS[verdict] for verdict in within.verdicts)
    listed = _verdicts_and_modes(verdicts, within.modes)
    return [f"within the errors of the contacts, {within.samples} samples show: {listed}"]


def _verdicts_and_modes(verdicts: str, modes: tuple[str, ...]) -> str:
    more = f" and {len(modes) - MAX_LISTED} more" if len(modes) > MAX_LISTED else ""
    return f"{verdicts} ({', '.join(modes[:MAX_LISTED])}{more})" if modes else verdicts


_GEOMETRY: Final = {
    "points": "points may be off by {:.2g} m",
    "normals": "normals may be off by {:.2g} rad",
    "frictions": "friction may be off by {:.2g}",
}


def _geometry_in_words(margins: tuple[GeometryMargin, ...] | None) -> list[str]:
    """Return words for how far the contacts are from another answer."""
    words = []
    for margin in margins or ():
        told = _GEOMETRY[margin.kind].format(margin.holds_within)
        if math.isfinite(margin.changes_at):
            beyond = _verdicts_and_modes(VERDICTS[margin.verdict_beyond], margin.modes_beyond)
            told += f", at {margin.changes_at:.2g} the answer is {beyond}"
        words.append(told)
    return words


def _flips_in_words(flips: Flips | None) -> list[str]:
    """Return words for when a body that spins near its middle axis turns over next, with any deviations."""
    if flips is None or len(flips.seconds) == 0:
        return []
    words = [
        f"{seconds:.3g} s" + ("" if math.isnan(deviation) else f" (±{deviation:.2g} s)")
        for seconds, deviation in zip(flips.seconds.tolist(), flips.deviations.tolist(), strict=True)
    ]
    return [f"its middle axis turns over after {', '.join(words)}"]


def _probabilities_in_words(impact: ResolvedImpact) -> list[str]:
    """Return words for the probability of each outcome, the most probable first, if the answer has them."""
    if impact.outcome_probabilities is None:
        return []
    named = [
        (share, OUTCOMES[ImpactOutcome(i)])
        for i, share in enumerate(impact.outcome_probabilities.tolist())
        if share > 0.0
    ]
    if impact.miss_probability > 0.0:
        named.append((impact.miss_probability, "separates"))
    named.sort(reverse=True)
    return [f"outcomes: {', '.join(f'{words} {100.0 * share:.2g} %' for share, words in named)}"]


def _distribution_in_words(told: TossDistribution) -> list[str]:
    words = []
    first = [branch for branch in told.branches if branch.strike == 1]
    if first:
        kinds = [f"{branch_in_words(each.kind, each.corner)} {each.probability:.0%}" for each in first]
        words.append(f"first event of {told.samples} samples: {', '.join(kinds)}")
    if len(told.face_probabilities):
        faces = [
            f"{face_in_words(normal)} {share:.0%}"
            for normal, share in zip(told.face_normals_B, told.face_probabilities.tolist(), strict=True)
        ]
        words.append(f"lower face of the samples at rest: {', '.join(faces)}")
    return words


def _statics_in_words(statics: BodyStatics | None) -> list[str]:
    if statics is None:
        return []
    wedged = {True: "possible", False: "no", None: "unknown"}[statics.wedged]
    equilibrium, jammed = CERTAINTIES[statics.equilibrium], CERTAINTIES[statics.jammed]
    return [f"equilibrium {equilibrium}, jammed {jammed}, wedged {wedged}"]


def _settled_in_words(settled: SettledImpact | None) -> list[str]:
    if settled is None:
        return []
    outcome, after = outcome_in_words(settled.impact.outcome), _numbers(settled.impact.state.v_WB_W)
    return [
        f"an impact settles it: {outcome}; velocity becomes ({after}) m/s",
        f"then it {_verdict_in_words(settled.verdict, [mode.mode for mode in settled.modes])}",
    ]


def _numbers(vector: FloatArray) -> str:
    """Return numbers as text, with 0 for numbers below a millionth."""
    return ", ".join(f"{round(number, 6) + 0.0:.3g}" for number in vector.tolist())
