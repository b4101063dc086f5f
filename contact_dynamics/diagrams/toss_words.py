"""Puts answers about whole tosses into words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.toss import TossEnd, TossEventKind, UndecidedReason
from contact_dynamics.toss.distribution import BranchKind, axis_in_words

if TYPE_CHECKING:
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.toss import TossDistribution
    from contact_dynamics.validation import FloatArray

TOSS_ENDS: Final = {
    TossEnd.RESTS: "rests",
    TossEnd.HORIZON: "still moves at the horizon",
    TossEnd.MAX_EVENTS: "has more events or takes more steps than are followed",
}
"""What the body does at the end of a toss."""

EVENTS: Final = {
    TossEventKind.STRIKES: "strikes",
    TossEventKind.SETTLES: "settles",
    TossEventKind.NEW_MODE: "goes on in a mode",
    TossEventKind.LIFTS_OFF: "lifts off",
    TossEventKind.JAMS: "jams",
    TossEventKind.RESTS: "rests",
}
"""The words for what happens at an event."""

UNDECIDED: Final = {
    UndecidedReason.STRIKE_TOGETHER: "contacts strike together",
    UndecidedReason.SEVERAL_MODES: "several modes are consistent",
}
"""The words for why mechanics does not decide."""

BRANCHES: Final = {
    BranchKind.STRIKES: "strikes",
    BranchKind.STAYS: "stays in contact",
    BranchKind.FLIES: "meets nothing",
    BranchKind.ENDS: "no further strike",
}
"""The words for what happens on a branch of the tree."""


def toss_in_words(answer: TossAnswer) -> list[str]:
    """Return words for the end of a toss, the way there, what is undecided, and what else can happen."""
    path = answer.toss
    where = ", ".join(f"{x:.3g}" for x in (path.trajectory.p_WB_W[-1] + 0.0).tolist())
    strikes = sum(event.kind == TossEventKind.STRIKES for event in path.events)
    corners = ""
    if path.resting_corners:
        corners = f" on corners {' '.join(map(str, path.resting_corners))}"
    words = [f"{TOSS_ENDS[path.end]} after {path.seconds:.3g} s{corners} at ({where}) m, {strikes} strikes"]
    if path.undecided:
        reasons = dict.fromkeys(UNDECIDED[point.reason] for point in path.undecided)
        followed = "all" if answer.all_followed else "not all"
        words.append(
            f"undecided {len(path.undecided)} times ({', '.join(reasons)}); "
            f"{len(answer.alternatives)} other ways are followed, which are {followed}"
        )
    if answer.distribution is not None:
        words += _distribution_in_words(answer.distribution)
    return words


def _distribution_in_words(told: TossDistribution) -> list[str]:
    words = []
    first = [branch for branch in told.branches if branch.strike == 1]
    if first:
        kinds = [f"{branch_in_words(each.kind, each.corner)} {each.probability:.0%}" for each in first]
        words.append(f"what {told.samples} samples do first: {', '.join(kinds)}")
    if len(told.face_probabilities):
        faces = [
            f"{face_in_words(normal)} {share:.0%}"
            for normal, share in zip(told.face_normals_B, told.face_probabilities.tolist(), strict=True)
        ]
        words.append(f"samples rest on the face towards {', '.join(faces)}")
    return words


def branch_in_words(kind: BranchKind, corner: int) -> str:
    """Return words for what happens on a branch of the tree."""
    return f"corner {corner} {BRANCHES[kind]}" if kind == BranchKind.STRIKES else BRANCHES[kind]


def face_in_words(normal_B: FloatArray) -> str:
    """Return which face lies on a surface with a normal, (3,), body axes: "-z", or its outward normal."""
    return axis_in_words(0.0 - normal_B)
