# SPDX-License-Identifier: Apache-2.0
"""The monitor takes states in the order in which they came, and returns a record for each event that ended.

It is the program of `evaluation`, fed a few seconds at a time: events are found by `measured.events`, and
each is predicted from the states known some time before it. Live states and those of a log give the same
records: the states are searched whenever a stamp passes a multiple of `LOOK_EVERY`, and an event is final
`SETTLED` after it.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from dataclasses import dataclass, field, replace
from itertools import groupby
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np

from contact_dynamics.constants import to_ns
from contact_dynamics.contact_modes.result import ModeVerdict
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.evaluation.asking import asked_before, compare_event, first_answer
from contact_dynamics.evaluation.log_states import ONE_CLOCK_S
from contact_dynamics.evaluation.model_error import ModelError
from contact_dynamics.evaluation.settings import Law, Method, Settings
from contact_dynamics.measured.events import EventKind, find_events
from contact_dynamics.measured.flights import ORIENTATION_SLACK, POSITION_SLACK
from contact_dynamics.measured.motion import StateColumns, motions_of
from contact_dynamics.monitoring.changes import SurfaceChanges
from contact_dynamics.monitoring.evidence import REGIONS, evidence_of
from contact_dynamics.records import Record
from contact_dynamics.tolerances import SAME_EVENT
from contact_dynamics.validation import check_positive

if TYPE_CHECKING:
    from collections.abc import Iterable

    from contact_dynamics.evaluation.asking import Informed
    from contact_dynamics.evaluation.comparison import Comparison
    from contact_dynamics.measured.events import FoundEvent
    from contact_dynamics.monitoring.changes import SurfaceReport
    from contact_dynamics.monitoring.evidence import ImpactEvidence, Parameter
    from contact_dynamics.questions.context import Context
    from contact_dynamics.questions.uncertain_state import KnownState
    from contact_dynamics.validation import FloatArray

LOOK_EVERY: Final = 0.2  # s of stamps between two searches for events

SETTLED: Final = 0.25
"""s after an event, when later states no longer change it: a flight after an impact is fitted over 80 ms, and
found after 47 ms. A rest or a slide is also reported once it has lasted this long."""

SILENT: Final = 1.0
"""s without a state, after which all events before it are final. No state is out of order by more."""

KEPT: Final = 3.0  # s of states that are stored. Longer flights, rests and slides are followed nevertheless.


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class MonitorSettings(Record):
    """Settings of a monitor.

    Raises:
        InvalidFieldError: a number is not > 0.
    """

    horizon: float = 0.02  # s, > 0, how long before an event it is predicted
    error: ModelError = field(default_factory=ModelError)  # model errors in addition to measurement noise
    # Standard deviations of measured positions, m, and orientations, rad. If it is None, they are estimated
    # from the states.
    noise: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        """Check the horizon."""
        object.__setattr__(self, "horizon", check_positive("horizon", self.horizon))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class MonitoredEvent(Record):
    """One event, predicted and measured.

    Attributes:
        kind: Kind of the event.
        body: Name of the body.
        surface: Name of the surface; empty for a flight.
        stamp_ns: Time of the event, ns, on the clock of the stamps.
        predicted: (13,), predicted state of the centre of mass: position, quaternion x, y, z, w, linear and
            angular velocity, in m, m/s and rad/s, world axes; for an impact the one after it. It is None for
            rests and slides, and if there is no prediction.
        measured: (13,), the measured state, in the same form.
        time_error: s, predicted less measured time of a first contact, or None.
        predicted_mode: Predicted contact modes of a rest or a slide, or the verdict; empty otherwise.
        measured_mode: Measured contact mode of a rest or a slide; empty otherwise.
        as_predicted: Whether a rest or a slide agrees with a predicted mode, or None for other kinds.
        distance: Mahalanobis distance of the measurement from the prediction, or None without a covariance.
        probability: Probability of a distance at least as large if the prediction is correct, or None.
        regions: Whether the measurement is inside the 50, 90 and 99 % prediction regions; empty if unknown.
        impact_values: (2,), restitution and friction that would explain this impact alone, NaN if unknown.
        impact_stds: (2,), their standard deviations.
        explained_by: Coefficient whose change explains an impact outside the 99 % region, or None.
        surface_report: What all impacts on the surface show, or None if this event shows nothing about it.
        problem: Why there is no prediction or no region; empty if there is.
    """

    kind: EventKind
    body: str
    surface: str
    stamp_ns: int
    predicted: FloatArray | None = None
    measured: FloatArray
    time_error: float | None = None
    predicted_mode: str = ""
    measured_mode: str = ""
    as_predicted: bool | None = None
    distance: float | None = None
    probability: float | None = None
    regions: tuple[bool, ...] = ()
    impact_values: FloatArray = field(default_factory=lambda: np.full(2, math.nan))
    impact_stds: FloatArray = field(default_factory=lambda: np.full(2, math.nan))
    explained_by: Parameter | None = None
    surface_report: SurfaceReport | None = None
    problem: str = ""

    @property
    def smallest_region(self) -> float | None:
        """The probability of the smallest region that contains the measurement: 1 if none does, or None."""
        if self.probability is None:
            return None
        return next((each for each, is_in in zip(REGIONS, self.regions, strict=True) if is_in), 1.0)


class Monitor:
    """Watches the bodies of a world.

    Attributes:
        informed: What is configured. It may be replaced between two states.
    """

    def __init__(self, informed: Informed, settings: MonitorSettings | None = None) -> None:
        """Begin without states. Without ``settings``, there is no model error."""
        self.informed = informed
        self._settings = settings or MonitorSettings()
        self._asking = Settings(
            horizons=(self._settings.horizon,), laws=(Law.POISSON,), error=self._settings.error
        )
        self._tracks: defaultdict[str, _Track] = defaultdict(_Track)
        self._changes: defaultdict[str, SurfaceChanges] = defaultdict(SurfaceChanges)

    def add(self, body_name: str, state: KnownState, arrival_ns: int) -> list[MonitoredEvent]:
        """Add a state of a configured body, and return the events that are final now.

        ``arrival_ns`` is the time of its arrival, ns, on the clock of the stamps.
        """
        track, found = self._tracks[body_name], list[MonitoredEvent]()
        now_ns, every_ns = state.stamp_ns, to_ns(LOOK_EVERY)
        if track.states and abs(now_ns - track.newest_ns) > to_ns(SILENT):
            found = self.settle(body_name)
            if now_ns < track.newest_ns:  # a simulation or a log begins anew
                track = self._tracks[body_name] = _Track()
        elif track.states and now_ns // every_ns > track.newest_ns // every_ns:
            found = self._look(body_name, track, track.newest_ns - to_ns(SETTLED))
        track.add(state, arrival_ns)
        return found

    def settle(self, body_name: str) -> list[MonitoredEvent]:
        """Return the remaining events of a body, as `add` does for a state `SILENT` later."""
        track = self._tracks[body_name]
        return self._look(body_name, track, track.newest_ns + 1)

    def finish(self) -> list[MonitoredEvent]:
        """Return the remaining events, and discard the states, but not the estimates of the surfaces."""
        found = [event for body_name in list(self._tracks) for event in self.settle(body_name)]
        self._tracks.clear()
        return found

    def _look(self, body_name: str, track: _Track, until_ns: int) -> list[MonitoredEvent]:
        world, found = self.informed.world, list[MonitoredEvent]()
        for motion in motions_of(world.body(body_name), world, track.columns(), noise=self._settings.noise):
            new = track.new_events(find_events(motion), until_ns)
            for _, instant in groupby(new, key=lambda event: (event.first_sample, event.time_ns)):
                events = list(instant)
                known = asked_before(events[0], motion, self.informed, self._asking)
                found += [self._monitored(event, known) for event in events]
        track.close(until_ns)
        return found

    def _monitored(self, event: FoundEvent, known: dict[float, Context]) -> MonitoredEvent:
        state = event.state
        record = MonitoredEvent(
            kind=event.kind,
            body=event.body,
            surface=event.surface,
            stamp_ns=event.time_ns,
            measured=np.concatenate([state.p_WB_W, state.q_WB, state.v_WB_W, state.w_WB_W]),
            measured_mode=event.mode,
        )
        if event.kind is EventKind.FLIGHT:
            event = replace(
                event,
                position_std=math.hypot(event.position_std, POSITION_SLACK),
                orientation_std=np.hypot(event.orientation_std, ORIENTATION_SLACK),
            )
        rows = list(compare_event(0, event, known, self._asking))
        wanted = Method.NEWEST if event.mode else Method.FIT
        row = next((row for row in rows if row.method is wanted), None)
        if row is None:
            return replace(record, problem="too few states before the event")
        if row.refused:
            return replace(record, problem=row.refused)
        if row.predicted_mode == ModeVerdict.IMPACT.name:
            return replace(record, problem="an impact comes first")
        record = replace(
            record,
            predicted=row.predicted,
            time_error=row.time_error,
            predicted_mode=row.predicted_mode,
            as_predicted=row.mode_is_right,
        )
        if event.kind is EventKind.IMPACT:
            return self._impact(record, event, known[self._settings.horizon])
        return _with_region(record, row)

    def _impact(self, record: MonitoredEvent, event: FoundEvent, known: Context) -> MonitoredEvent:
        """Return an impact with its region, and with what it shows about the surface."""
        evidence: ImpactEvidence | None = None
        try:
            answer = first_answer(event, known, self._asking)
            evidence = evidence_of(event, answer, self.informed.world, self._settings.error)
        except ContactDynamicsError as error:
            return replace(record, problem=str(error))
        if evidence is None:
            return replace(record, problem="several contacts, whose prediction has no region")
        report = self._changes[event.surface].add(evidence)
        evidence = report.impact
        values, stds = evidence.estimates()
        probability = evidence.probability()
        regions = _regions(probability)
        return replace(
            record,
            distance=evidence.distance,
            probability=probability,
            regions=regions,
            impact_values=values,
            impact_stds=stds,
            explained_by=None if regions[-1] else evidence.explained_by(),
            surface_report=report,
        )


def _with_region(record: MonitoredEvent, row: Comparison) -> MonitoredEvent:
    if row.distance is None:
        return record
    from scipy.stats import chi2

    probability = float(chi2.sf(row.distance**2, row.degrees))
    return replace(record, distance=row.distance, probability=probability, regions=_regions(probability))


def _regions(probability: float) -> tuple[bool, ...]:
    return tuple(probability >= 1.0 - region for region in REGIONS)


class _Returned(NamedTuple):
    """An event that was returned, from its beginning to when it was compared."""

    kind: EventKind
    since_ns: int
    time_ns: int


class _Track:
    """The latest states of one body, and the events that were returned."""

    def __init__(self) -> None:
        self.states: deque[tuple[KnownState, int]] = deque()
        self.newest_ns = 0
        self._returned: list[_Returned] = []
        self._final_ns = 0  # no new event is before it

    def add(self, state: KnownState, arrival_ns: int) -> None:
        """Keep a state, and drop those that are too old."""
        self.states.append((state, arrival_ns))
        self.newest_ns = max(self.newest_ns, state.stamp_ns)
        while self.states[0][0].stamp_ns < self.newest_ns - to_ns(KEPT):
            self.states.popleft()

    def columns(self) -> StateColumns:
        """Return the states. If they are of another clock than their arrivals, arrivals do not count."""
        columns = StateColumns([state for state, _ in self.states], [at_ns for _, at_ns in self.states])
        delays_ns = columns.arrivals_ns - columns.stamps_ns.astype(np.float64)
        if abs(float(np.median(delays_ns))) > to_ns(ONE_CLOCK_S):
            columns.know_at_stamps()
        return columns

    def new_events(self, events: Iterable[FoundEvent], until_ns: int) -> list[FoundEvent]:
        """Return the events that are final, and were not returned before."""
        return [event for event in events if self._is_new(event, until_ns)]

    def close(self, until_ns: int) -> None:
        """Note that all events up to then were returned."""
        self._final_ns = until_ns
        self._returned = [
            each for each in self._returned if each.time_ns > self.newest_ns - to_ns(2.0 * KEPT)
        ]

    def _is_new(self, event: FoundEvent, until_ns: int) -> bool:
        within_ns = 0 if event.mode else to_ns(SAME_EVENT)
        lasted_ns = to_ns(event.time - event.since) if event.mode else 0
        now = _Returned(event.kind, event.time_ns - lasted_ns - within_ns, event.time_ns + within_ns)
        if event.time_ns > until_ns and lasted_ns < to_ns(SETTLED):
            return False
        for k, each in enumerate(self._returned):
            if each.kind is now.kind and each.since_ns <= now.time_ns and now.since_ns <= each.time_ns:
                self._returned[k] = _Returned(each.kind, each.since_ns, max(each.time_ns, now.time_ns))
                return False
        if now.time_ns < self._final_ns:
            return False
        self._returned.append(now)
        return True
