# SPDX-License-Identifier: Apache-2.0
"""A whole toss: the motion from a state in flight to rest, its events, and what is undecided about it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.impact.law import ImpactOutcome, RestitutionLaw
from contact_dynamics.records import NamedInt, Record, made
from contact_dynamics.rigid_body.body import BodyState, states_of_rows
from contact_dynamics.rotations.many import make_continuous
from contact_dynamics.toss.distribution import axis_in_words
from contact_dynamics.toss.phase import PhaseStep
from contact_dynamics.toss.solid import points_of, properties_of, state_of
from contact_dynamics.tumbling import FreeMotion, Precision, Trajectory, free_motion
from contact_dynamics.validation import FloatArray, check_array
from contact_dynamics.world import SurfaceFrame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from contact_dynamics.numerics.vectors import Vector3
    from contact_dynamics.toss.mode_choice import Mode
    from contact_dynamics.toss.solid import Numbers, Solid, Touch


_TIMES = 3
"""Times of branch points that a toss shows in short."""


class TossEventKind(NamedInt):
    """Kind of an event of a toss."""

    STRIKES = 0
    """A contact strikes and rebounds, or stays closed without a rebound."""
    SETTLES = 1
    """The rebounds at a contact have become too low to be followed, and the contact stays closed from then
    on."""
    NEW_MODE = 2
    """The touching contacts continue in a contact mode: sticking, rolling or sliding. If they jam, the motion
    continues in short steps, and the mode is that of the first step."""
    LIFTS_OFF = 3
    """The last contact separates, and the body flies."""
    JAMS = 4
    """No contact mode was consistent, and an impact without approach resolved the case (lectures 26 and
    27)."""
    RESTS = 5
    """The body comes to rest."""


class TossEnd(NamedInt):
    """Reason for the end of a toss."""

    RESTS = 0
    """The body rests."""
    HORIZON = 1
    """The requested time has passed, and the body still moves."""
    MAX_EVENTS = 2
    """The limit on the number of events, or of steps in contact, was reached."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossEvent(Record):
    """One event of a toss.

    Attributes:
        seconds: Time of the event, s after the stamp of the initial state.
        kind: Kind of the event.
        surfaces: Names of the surfaces at the contacts of the event.
        corners: Indices of the corners of the body's shape at these contacts, one for each entry of
            ``surfaces``.
        p_WC_W: (n, 3), m, positions of these contacts, world.
        impulse_W: (3,), N s, impulse on the body, world axes. It is zero if no contact strikes. At SETTLES it
            can be the impulse that removes the last rebound, which may pull.
        outcome: Outcome of the impact at a striking contact, or None. Contacts that strike at one instant
            under SIMULTANEOUS have no outcome.
        mode: One letter for each contact: f sticks or rolls, c slides. It is empty if no mode follows.
        state: State after all events at that time.
    """

    seconds: float
    kind: TossEventKind
    surfaces: tuple[str, ...]
    corners: tuple[int, ...]
    p_WC_W: FloatArray
    impulse_W: FloatArray
    outcome: ImpactOutcome | None
    mode: str
    state: BodyState


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class TossEnergy(Record):
    """Energy balance of a toss, J. Energy is kinetic energy plus potential energy in uniform gravity.

    Attributes:
        first: Energy at the beginning, relative to the potential energy of the last state.
        lost_in_strikes: Energy dissipated in strikes. It is negative if the law of restitution creates
            energy.
        lost_in_contact: Energy dissipated between strikes by friction at sliding contacts.
        left: Energy of the last state, which is its kinetic energy.
    """

    first: float
    lost_in_strikes: float
    lost_in_contact: float
    left: float


class UndecidedReason(NamedInt):
    """Reason why mechanics does not determine the motion at a branch point."""

    STRIKE_TOGETHER = 0
    """Several contacts approach at one instant, and their order is not determined."""
    SEVERAL_MODES = 1
    """Several contact modes are consistent."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Undecided(Record):
    """Point of a toss at which mechanics does not determine the motion.

    Attributes:
        seconds: Time of the point, s after the initial state's stamp.
        reason: Reason for the indeterminacy.
        options: Number of possible continuations, >= 2.
        taken: Index of the continuation of this toss, from 0. Option 0 resolves the fastest approach
            first, together with those of equal approach speed, or follows the first mode.
    """

    seconds: float
    reason: UndecidedReason
    options: int
    taken: int


class Noted(NamedTuple):
    """The data of a `TossEvent`: the contacts, the mode, and the state after it as 13 numbers."""

    seconds: float
    kind: TossEventKind
    touching: list[Touch]
    impulse: Vector3
    outcome: ImpactOutcome | None
    mode: Mode
    y: Numbers


class FlightPiece(NamedTuple):
    """A free flight.

    Attributes:
        start: s, when it begins.
        solid: The body and its gravity.
        y: The 13 numbers of the state at that time.
    """

    start: float
    solid: Solid
    y: Numbers

    @property
    def motion(self) -> FreeMotion:
        """The motion, from the state at that time."""
        body, gravity = properties_of(self.solid), np.array(self.solid.gravity)
        return free_motion(body, state_of(self.y), gravity_W=gravity, precision=Precision.DOUBLE)


Piece: TypeAlias = "FlightPiece | PhaseStep"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class TossOutcome(Record):
    """End, events, energy balance and branch points of a toss.

    Attributes:
        end: Reason for the end of the toss.
        seconds: Time of rest, or time up to which the motion is predicted, s after the initial state's stamp.
        events: Events in the order of time. Strikes of one instant are in the order of resolution.
        resting_corners: Indices of the corners on which the body rests, rows of ``body.vertices_B``, sorted.
            It is empty if the body moves.
        resting_normal_B: (3,), unit normal of the surface on which the body rests, body axes, or zero. A box
            rests on the face whose outward normal is opposite. If it rests on several surfaces, it is that of
            one of them.
        energy: Energy balance. If the surfaces move, it is the energy relative to them.
        undecided: Branch points of this toss, at which mechanics does not determine the motion. All of them
            are listed, whether or not the other branches were followed.
    """

    end: TossEnd
    seconds: float
    events: tuple[TossEvent, ...]
    resting_corners: tuple[int, ...]
    resting_normal_B: FloatArray
    energy: TossEnergy
    undecided: tuple[Undecided, ...]

    @property
    def face_on_top(self) -> str:
        """Return the body axis along ``resting_normal_B``, such as "+z", or its components; "" if it moves.

        For a die, it is the face on top, as in ``faces_on_top`` of `TossDistribution`.
        """
        return axis_in_words(self.resting_normal_B) if self.resting_normal_B.any() else ""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Toss(TossOutcome):
    """Motion of a body from an initial state to rest.

    `TossOutcome` documents the other fields: ``end``, ``seconds``, ``events``, ``resting_corners``,
    ``resting_normal_B``, ``energy`` and ``undecided``.

    Attributes:
        restitution_law: Law of restitution of all strikes.
        state: State at the end. At rest its velocities are those of the surfaces.
        alternatives: Tosses that follow other branches, up to ``max_alternatives``, which is 0 by default.
        all_followed: Whether ``alternatives`` contains all other branches.
        pieces: Flights and steps of contact phases, in the order of time.
        starts: (n,), s, times at which the pieces begin.
        began_ns: ns, stamp of the initial state.
        frame: Frame of surfaces that move, to which the pieces refer, or None.
        noted: The body and the data from which ``events`` are created on first access, or None.
    """

    restitution_law: RestitutionLaw
    state: BodyState
    alternatives: tuple[Toss, ...] = ()
    all_followed: bool = True
    pieces: tuple[Piece, ...] = field(repr=False)
    starts: FloatArray = field(repr=False)
    began_ns: int = field(repr=False)
    frame: SurfaceFrame | None = field(repr=False, default=None)
    noted: tuple[Solid, tuple[Noted, ...]] | None = field(repr=False, default=None)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return the events, which are made here, or raise the error that there is no such attribute."""
            noted = self.noted if name == "events" else None
            if noted is None:
                return Record.__getattr__(self, name)
            object.__setattr__(self, "events", events_of(*noted, self.began_ns))
            object.__setattr__(self, "noted", None)
            return self.events

    def in_short(self) -> str:
        """Return the reason and the time of the end, and the times of the branch points."""
        words = [f"Toss: {self.end} at {self.seconds:.4g} s", f"{len(self.events)} events"]
        if face := self.face_on_top:
            words.insert(1, f"{face} on top")
        if self.undecided:
            times = [f"{point.seconds:.3g}" for point in self.undecided]
            count = f"{len(times)} branch point{'' if len(times) == 1 else 's'}"
            shown = [*times[:_TIMES], *["..."] * (len(times) > _TIMES)]
            followed = "all followed" if self.all_followed else "not followed"
            if self.alternatives and not self.all_followed:
                followed = f"{len(self.alternatives)} alternatives followed"
            words.append(f"{count} {followed} (at {', '.join(shown)} s)")
        return ", ".join(words)

    @property
    def strikes(self) -> tuple[TossEvent, ...]:
        """Return the events with an impulse."""
        kinds = (TossEventKind.STRIKES, TossEventKind.SETTLES, TossEventKind.JAMS)
        return tuple(event for event in self.events if event.kind in kinds)

    def at(self, seconds: ArrayLike) -> Trajectory:
        """Return the motion at times (n,), s after the initial state's stamp, in any order.

        At the time of a strike, the state is that after the strike. After the time of rest, it is the state
        of rest, in which the body moves with the surfaces.

        Raises:
            InvalidFieldError: a time is negative or not finite, or is after the end of a toss that does not
                rest.
        """
        times = check_array("seconds", seconds, (None,))
        last = float("inf") if self.end == TossEnd.RESTS else self.seconds
        for i, time in enumerate(times.tolist()):
            if not 0.0 <= time <= last:
                raise InvalidFieldError(f"seconds[{i}]", time, f"a time from 0 to {last:g} s")
        rows = np.empty((len(times), 13))
        rested = times >= self.seconds
        final = self.state
        rows[rested] = np.concatenate([final.p_WB_W, final.q_WB, final.v_WB_W, final.w_WB_W])
        if self.frame is not None:  # it rests on surfaces that move on
            beyond = times[rested]
            rows[rested, :3] += self.frame.displacement(beyond) - self.frame.displacement(self.seconds)
            rows[rested, 7:10] = self.frame.velocity(beyond)
        which = np.searchsorted(self.starts, times, side="right") - 1
        for k in np.unique(which[~rested]).tolist():
            mine = np.flatnonzero((which == k) & ~rested)
            piece = self.pieces[k]
            if isinstance(piece, FlightPiece):
                flown = piece.motion.at(times[mine] - piece.start)
                rows[mine] = np.column_stack([flown.p_WB_W, flown.q_WB, flown.v_WB_W, flown.w_WB_W])
            else:
                rows[mine] = [piece.at(time) for time in times[mine].tolist()]
        if self.frame is not None:
            rows[~rested, :3] += self.frame.displacement(times[~rested])
            rows[~rested, 7:10] += self.frame.velocity(times[~rested])
        q = rows[:, 3:7] / np.linalg.norm(rows[:, 3:7], axis=1, keepdims=True)
        if len(q):
            make_continuous(q, q[0])
        return Trajectory(
            seconds=times, p_WB_W=rows[:, :3], q_WB=q, v_WB_W=rows[:, 7:10], w_WB_W=rows[:, 10:]
        )

    def state_at(self, seconds: float) -> BodyState:
        """Return the state at one time, s after the initial state's stamp. It raises the errors of `at`."""
        row = self.at([seconds])
        return BodyState(
            p_WB_W=row.p_WB_W[0],
            q_WB=row.q_WB[0],
            v_WB_W=row.v_WB_W[0],
            w_WB_W=row.w_WB_W[0],
            stamp_ns=ns_after(self.began_ns, seconds),
        )


def events_of(solid: Solid, events: Sequence[Noted], began_ns: int) -> tuple[TossEvent, ...]:
    """Return the events for users. Their arrays are made together, as NumPy's calls cost most of it."""
    states = states_of_rows(
        [noted.y for noted in events], [ns_after(began_ns, noted.seconds) for noted in events]
    )
    points = _rows([point for noted in events for point in points_of(solid, noted.y, noted.touching)])
    impulses = _rows([noted.impulse for noted in events])
    begin, found = 0, []
    for noted, state, impulse in zip(events, states, impulses, strict=True):
        end = begin + len(noted.touching)
        event = made(
            TossEvent,
            noted.seconds,
            noted.kind,
            tuple([solid.flats[surface].name for surface, _ in noted.touching]),
            tuple([solid.indices[corner] for _, corner in noted.touching]),
            points[begin:end],
            impulse,
            noted.outcome,
            "".join(["c" if one.slides else "f" for one in noted.mode]),
            state,
        )
        found.append(event)
        begin = end
    return tuple(found)


def _rows(vectors: list[Vector3]) -> FloatArray:
    """Return vectors as rows, (n, 3), that nobody can change, since others may see the same array."""
    rows = np.array(vectors).reshape(-1, 3)
    rows.flags.writeable = False
    return rows


def carried_by(toss: Toss, frame: SurfaceFrame | None) -> Toss:
    """Return a toss that is described in the frame of moving surfaces as it is in the world."""
    if frame is None:
        return toss
    events = [
        replace(
            event,
            p_WC_W=event.p_WC_W + frame.displacement(event.seconds),
            state=frame.in_world(event.state, event.seconds),
        )
        for event in toss.events
    ]
    return replace(
        toss,
        state=frame.in_world(toss.state, toss.seconds),
        events=tuple(events),
        alternatives=tuple(carried_by(other, frame) for other in toss.alternatives),
        frame=frame,
    )
