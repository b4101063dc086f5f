"""Random values of all that travels in messages, and whether two of them are the same."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

from contact_dynamics.constants import ns_after
from contact_dynamics.contact.contact import ContactSet
from contact_dynamics.contact.curvature import alike
from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.result import (
    BodyStatics,
    Certainty,
    GeometryMargin,
    ModeVerdict,
    Refusal,
    RefusedMode,
    VerdictsWithin,
)
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.result import SpatialMode
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.impact import (
    ImpactOutcome,
    PathEvent,
    RestitutionLaw,
    SequenceEnd,
    SeveralContactsLaw,
)
from contact_dynamics.motion.covariance import CarriedCovariance, PropagationMethod, orientation_deviations
from contact_dynamics.motion.forces import ConstantWrench, Drag, WrenchAxes
from contact_dynamics.motion.integrated import Method
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions import (
    AtRate,
    AtStamps,
    AtTimes,
    ContactModeAnswer,
    ContactModeQuestion,
    Event,
    EventKind,
    FitQuality,
    ImpactAnswer,
    ImpactQuestion,
    InTime,
    Problem,
    PublishedState,
    ResolvedImpact,
    SequenceStrike,
    SettledImpact,
    StruckBody,
    TossAnswer,
    TossPath,
    TossQuestion,
    TossSampling,
    TumblingAnswer,
    TumblingQuestion,
    UncertainState,
    UntilContact,
    UntilPlane,
)
from contact_dynamics.questions.many import (
    ManyImpactsAnswer,
    ManyImpactsQuestion,
    ManyStates,
    ManyTumblingsAnswer,
    ManyTumblingsQuestion,
)
from contact_dynamics.questions.many_contact_modes import ManyContactModesAnswer, ManyContactModesQuestion
from contact_dynamics.questions.subject import NEWEST, changed_body
from contact_dynamics.rigid_body.body import BodyState, MassProperties
from contact_dynamics.toss import (
    TossDistribution,
    TossEnd,
    TossEnergy,
    TossEvent,
    TossEventKind,
    TossUncertainty,
    Undecided,
    UndecidedReason,
)
from contact_dynamics.toss.distribution import Branch, BranchKind, EventRegions, Ghosts, Region, RestSpread
from contact_dynamics.tumbling import Flips, Poinsot, Regime, RollingCurves, Trajectory
from contact_dynamics.tumbling.poinsot_construction import semi_axes
from contact_dynamics.world import Body, World, box_vertices

T = TypeVar("T")

NO_OFFSET = np.zeros(3)
BRICK = Body(
    name="brick",
    mass_properties=MassProperties(mass=0.4, I_B=np.diag([3.5e-4, 8.3e-4, 1.02e-3])),
    vertices_B=box_vertices((0.15, 0.09, 0.05)),
)
BAT = Body(name="bat", mass_properties=MassProperties(mass=0.9, I_B=0.01 * np.eye(3)))
WORLD = World(bodies=(BRICK, BAT))
NAMES = ("", "brick")


def same(one: Any, other: Any, *, rounding: float = 0.0) -> bool:
    """Whether two values, domain types or messages, agree in every field; NaN is NaN.

    Numbers may differ by ``rounding``.
    """
    if isinstance(one, float) and isinstance(other, float):
        return bool(np.isclose(one, other, rtol=0.0, atol=rounding, equal_nan=True))
    if isinstance(one, np.ndarray):
        return one.shape == other.shape and bool(
            np.isclose(one, other, rtol=0.0, atol=rounding, equal_nan=True).all()
        )
    if hasattr(one, "get_fields_and_field_types"):
        names = list(one.get_fields_and_field_types())
    elif dataclasses.is_dataclass(one):
        names = [field.name for field in dataclasses.fields(one)]
    elif isinstance(one, str | bytes) or not hasattr(one, "__len__"):
        return type(one) is type(other) and bool(one == other)
    else:  # a list, a tuple or an array.array
        return len(one) == len(other) and all(
            same(a, b, rounding=rounding) for a, b in zip(one, other, strict=True)
        )
    return type(one) is type(other) and all(
        same(getattr(one, name), getattr(other, name), rounding=rounding) for name in names
    )


numbers = st.floats(-1e3, 1e3)
odd_numbers = st.one_of(numbers, st.sampled_from([math.nan, math.inf]))
positive = st.floats(1e-3, 1e3)
not_negative = st.one_of(st.just(0.0), positive)
flags = st.booleans()
texts = st.sampled_from(["", "floor", "wall 2", "ü"])
indices = st.integers(0, 9)


def arrays(*shape: int, of: st.SearchStrategy[float] = numbers) -> st.SearchStrategy[np.ndarray]:
    """Arrays of a shape; all but a few numbers of a large one are from a generator."""
    count = math.prod(shape)
    if count > 36:
        return st.integers(0, 2**31).map(lambda seed: np.random.default_rng(seed).normal(size=shape))
    return st.lists(of, min_size=count, max_size=count).map(
        lambda values: np.array(values, dtype=np.float64).reshape(shape)
    )


def tuples_of(values: st.SearchStrategy[T], count: int) -> st.SearchStrategy[tuple[T, ...]]:
    """So many values."""
    return st.lists(values, min_size=count, max_size=count).map(tuple)


def some(values: st.SearchStrategy[T]) -> st.SearchStrategy[T | None]:
    """A value or none."""
    return st.one_of(st.none(), values)


@st.composite
def unit_vectors(draw: st.DrawFn, length: int = 3) -> np.ndarray:
    """Unit vectors that stay as they are when they are scaled to length 1 once more."""
    vector = draw(arrays(length, of=st.floats(-1.0, 1.0)))
    for _ in range(3):
        size = math.sqrt(np.einsum("i,i->", vector, vector))
        assume(size > 0.1)
        vector = vector / size
    again = vector / np.sqrt(np.einsum("ij,ij->i", vector[None], vector[None]))
    assume(np.array_equal(again, vector))
    return vector


states = st.builds(
    BodyState,
    p_WB_W=arrays(3),
    q_WB=unit_vectors(4),
    v_WB_W=arrays(3),
    w_WB_W=arrays(3),
    stamp_ns=st.integers(0, 2**31 * 10**9 - 1),
)


@st.composite
def known_states(draw: st.DrawFn) -> BodyState | UncertainState:
    """States with a covariance and without."""
    state = draw(states)
    if draw(flags):
        return state
    root = draw(arrays(12, 12))
    return UncertainState(state=state, covariance=root @ root.T)


@st.composite
def contact_sets(draw: st.DrawFn, count: int | None = None) -> ContactSet:
    """Up to three contacts, with names and curvatures or without."""
    n = draw(st.integers(0, 3)) if count is None else count
    curved = n > 0 and draw(flags)
    normals = draw(tuples_of(unit_vectors(), n))
    return ContactSet(
        p_WC_W=draw(arrays(n, 3)),
        normals_W=np.array(normals).reshape(-1, 3),
        frictions=draw(arrays(n, of=st.floats(0.0, 5.0))),
        restitutions=draw(arrays(n, of=st.floats(0.0, 1.0))),
        surfaces=draw(tuples_of(texts, n)) if draw(flags) else (),
        body_curvatures=alike(n, draw(positive)) if curved else None,
        surface_curvatures=alike(n, draw(positive)) if curved else None,
    )


@st.composite
def trajectories(draw: st.DrawFn, count: int | None = None) -> Trajectory:
    """Up to three samples."""
    n = draw(st.integers(0, 3)) if count is None else count
    return Trajectory(
        seconds=draw(arrays(n)),
        p_WB_W=draw(arrays(n, 3)),
        q_WB=np.array(draw(tuples_of(unit_vectors(4), n))).reshape(-1, 4),
        v_WB_W=draw(arrays(n, 3)),
        w_WB_W=draw(arrays(n, 3)),
    )


@st.composite
def carried(draw: st.DrawFn, seconds: np.ndarray) -> CarriedCovariance:
    """The covariances of a trajectory's samples; NaN where no double holds them."""
    covariances = draw(arrays(len(seconds), 12, 12))
    if draw(flags):
        covariances[-1] = math.nan
    return CarriedCovariance(
        seconds=seconds,
        covariances=covariances,
        orientation_deviations=orientation_deviations(covariances),
        trusted=np.array(draw(tuples_of(flags, len(seconds)))),
        method=PropagationMethod.LINEARISED,
    )


@st.composite
def rotations(draw: st.DrawFn) -> tuple[Poinsot, Flips, RollingCurves | None]:
    """Poinsot's picture, with any number of flips, with curves and without."""
    energy, moments = draw(positive), draw(arrays(3, of=positive))
    flips, points = draw(st.integers(0, 3)), draw(st.integers(0, 3))
    picture = Poinsot(
        regime=draw(st.sampled_from([regime for regime in Regime if regime is not Regime.UNKNOWN])),
        rotational_energy=energy,
        L_W=draw(arrays(3)),
        invariable_plane_distance=draw(odd_numbers),
        polhode_period=draw(odd_numbers),
        precession_per_period=draw(odd_numbers),
        principal_moments=moments,
        principal_axes_B=draw(arrays(3, 3)),
        ellipsoid_semi_axes=semi_axes(energy, moments),
        sensitivity=draw(odd_numbers),
    )
    curves = RollingCurves(
        seconds=draw(arrays(points)),
        polhode_B=draw(arrays(points, 3)),
        herpolhode_W=draw(arrays(points, 3)),
    )
    told = Flips(seconds=draw(arrays(flips)), deviations=draw(arrays(flips, of=odd_numbers)))
    return picture, told, curves if points else None


fits = st.builds(
    FitQuality, count=st.integers(1, 1000), position_residual=positive, orientation_residual=positive
)
events = st.builds(
    Event,
    kind=st.sampled_from(EventKind),
    seconds=numbers,
    point_W=arrays(3),
    velocity_W=arrays(3),
    surface=texts,
)


@st.composite
def tumbling_answers(draw: st.DrawFn, p_FB_F: np.ndarray = NO_OFFSET) -> TumblingAnswer:
    """With and without samples, covariance, event, fit and torque."""
    trajectory = draw(trajectories())
    picture, flips, curves = draw(rotations()) if draw(flags) else (None, None, None)
    has_covariance = len(trajectory) > 0 and draw(flags)
    return TumblingAnswer(
        body_name=draw(st.sampled_from(NAMES)) if not p_FB_F.any() else "brick",
        p_FB_F=p_FB_F,
        state=draw(states),
        fit=draw(some(fits)),
        trajectory=trajectory,
        covariance=draw(carried(trajectory.seconds)) if has_covariance else None,
        method=draw(st.sampled_from(Method)),
        event=draw(some(events)),
        poinsot=picture,
        flips=flips,
        curves=curves,
    )


@st.composite
def strikes_in_time(draw: st.DrawFn, last_ns: int) -> tuple[SequenceStrike, ...]:
    """One to three strikes, the last of them at that stamp."""
    seconds = sorted(draw(st.lists(st.floats(0.0, 0.05), min_size=1, max_size=3)))
    strikes = []
    for each in seconds:
        stamp_ns = ns_after(last_ns, each - seconds[-1])
        before = dataclasses.replace(draw(states), stamp_ns=stamp_ns)
        after = dataclasses.replace(before, v_WB_W=draw(arrays(3)), w_WB_W=draw(arrays(3)))
        strikes.append(
            SequenceStrike(
                seconds=each,
                contact=draw(indices),
                outcome=draw(st.sampled_from(ImpactOutcome)),
                p_WC_W=draw(arrays(3)),
                impulse_W=draw(arrays(3)),
                state_before=before,
                state_after=after,
            )
        )
    return tuple(strikes)


@st.composite
def resolved_impacts(
    draw: st.DrawFn, count: int = 2, *, other: bool = False, in_time: bool | None = None
) -> ResolvedImpact:
    """At so many contacts, by all laws, with and without all that is asked for besides."""
    state = dataclasses.replace(draw(states), stamp_ns=draw(st.integers(10**9, 10**18)))
    strikes = draw(strikes_in_time(state.stamp_ns)) if (draw(flags) if in_time is None else in_time) else ()
    law = SeveralContactsLaw.SEQUENTIAL if strikes else draw(st.sampled_from(SeveralContactsLaw))
    orders: tuple[tuple[int, ...], ...] = draw(
        st.lists(st.lists(indices, min_size=1, max_size=3).map(tuple), max_size=2).map(tuple)
    )
    told, k = draw(flags), draw(st.integers(0, 3))
    staying = draw(st.lists(indices, max_size=2).map(tuple)) if strikes else ()
    probabilities = draw(some(arrays(len(ImpactOutcome), of=st.floats(0.0, 1.0))))
    return ResolvedImpact(
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        several_contacts_law=law,
        outcome=draw(some(st.sampled_from(ImpactOutcome))),
        jams=draw(flags),
        converged=draw(flags),
        state=state,
        other_state=draw(states) if other else None,
        impulses_W=draw(arrays(count, 3)),
        compression_impulses_W=draw(arrays(count if told else 0, 3)),
        velocities_before_W=draw(arrays(count, 3)),
        velocities_after_W=draw(arrays(count, 3)),
        path_W=draw(arrays(k, 3)),
        path_events=draw(tuples_of(st.sampled_from(PathEvent), k)),
        path_contacts=draw(tuples_of(indices, k)),
        kinetic_energy_before=draw(positive),
        kinetic_energy_after=draw(positive),
        creates_energy=draw(flags),
        orders=orders,
        order_velocities_W=draw(arrays(len(orders), 6)),
        orders_complete=draw(flags),
        orders_not_converged=draw(indices),
        covariance=draw(some(arrays(12, 12))),
        outcome_probabilities=probabilities,
        miss_probability=0.0 if probabilities is None else draw(st.floats(0.0, 1.0)),
        strikes=strikes,
        end=draw(st.sampled_from(SequenceEnd)) if strikes else None,
        staying=staying,
        limit_seconds=draw(positive) if staying else None,
    )


planes = some(st.builds(PlaneOfMotion, normal_W=unit_vectors()))


@st.composite
def impact_answers(draw: st.DrawFn, p_FB_F: np.ndarray = NO_OFFSET) -> ImpactAnswer:
    """With one body and with two, in a plane and in space."""
    contacts = draw(contact_sets())
    name = draw(st.sampled_from(NAMES)) if not p_FB_F.any() else "brick"
    struck = draw(some(st.builds(StruckBody, name=st.just(name), p_FB_F=st.just(p_FB_F), state=states)))
    plane = draw(planes)
    return ImpactAnswer(
        body_name=name,
        p_FB_F=p_FB_F,
        state=draw(states),
        fit=draw(some(fits)),
        other=struck,
        seconds_to_contact=draw(positive),
        contacts=contacts,
        impact=draw(resolved_impacts(len(contacts), other=struck is not None)),
        problem=Problem.SPATIAL if plane is None else Problem.PLANAR,
        plane=plane,
        out_of_plane=draw(odd_numbers),
        velocity_tolerance=draw(positive),
        distance_tolerance=draw(positive),
    )


@st.composite
def modes_of(draw: st.DrawFn, count: int) -> SpatialMode:
    """A mode of so many contacts, with sliding directions and without."""
    return SpatialMode(
        mode="".join(draw(tuples_of(st.sampled_from("slrfc"), count))),
        acceleration_W=draw(arrays(3)),
        angular_acceleration_W=draw(arrays(3)),
        contact_forces_W=draw(arrays(count, 3)),
        contact_accelerations_W=draw(arrays(count, 3)),
        tangential_directions_W=draw(arrays(count if draw(flags) else 0, 3)),
        misdirection=draw(positive),
        forces_unique=draw(flags),
        motion_unique=draw(flags),
    )


def margins_of(mode: str) -> st.SearchStrategy[SpatialModeMargin]:
    """Finite, infinite and unknown ones."""
    return st.builds(
        SpatialModeMargin,
        mode=st.just(mode),
        margin=odd_numbers,
        length=positive,
        change_W=arrays(6),
        verdict_beyond=st.sampled_from(ModeVerdict),
        modes_beyond=st.lists(texts, max_size=2).map(tuple),
    )


@st.composite
def modes_and_margins(draw: st.DrawFn) -> tuple[SpatialMode, SpatialModeMargin | None]:
    """A mode of up to three contacts."""
    mode = draw(modes_of(draw(st.integers(0, 3))))
    return mode, draw(some(margins_of(mode.mode)))


@st.composite
def wrench_sets(draw: st.DrawFn, mode: str = "sf") -> SpatialWrenchSet:
    """The sets have any number of vertices, generators and half-spaces, in space and in a plane."""
    v, g, h = (draw(st.integers(0, 3)) for _ in range(3))
    sliding = len(mode) if draw(flags) else 0
    return SpatialWrenchSet(
        mode=mode,
        sliding_from_W=draw(arrays(sliding, 3)),
        sliding_to_W=draw(arrays(sliding, 3)),
        vertices=draw(arrays(v, 6)),
        generators=draw(arrays(g, 6)),
        half_spaces=draw(arrays(h, 7)),
    )


static_answers = st.builds(
    BodyStatics,
    equilibrium=st.sampled_from(Certainty),
    jammed=st.sampled_from(Certainty),
    wedged=flags,
    stable_disturbance=odd_numbers,
    margin_length=st.just(math.nan),  # no message tells it
)
refused_modes = st.builds(
    RefusedMode,
    mode=texts,
    refusal=st.sampled_from(Refusal),
    contact=st.integers(-1, 9),
    amount=numbers,
)


@st.composite
def settled_impacts(draw: st.DrawFn, count: int) -> SettledImpact:
    """An impact at one instant, and modes after it."""
    return SettledImpact(
        impact=draw(resolved_impacts(count, in_time=False)),
        verdict=draw(st.sampled_from(ModeVerdict)),
        modes=draw(st.lists(modes_of(count), max_size=2).map(tuple)),
    )


@st.composite
def uncertainties(draw: st.DrawFn) -> ContactUncertainty:
    """One number for all contacts, or one for each of two or three."""
    count = draw(st.sampled_from([2, 3]))
    small = st.floats(1e-300, 1.5)
    each = st.one_of(st.just(0.0), small, st.lists(small, min_size=count, max_size=count).map(tuple))
    return ContactUncertainty(points=draw(each), normals=draw(each), frictions=draw(each))


@st.composite
def verdicts_within(draw: st.DrawFn) -> VerdictsWithin:
    """With one verdict at least, since the first is that on the problem itself."""
    return VerdictsWithin(
        uncertainty=draw(uncertainties()),
        verdicts=draw(st.lists(st.sampled_from(ModeVerdict), min_size=1, max_size=3).map(tuple)),
        modes=draw(st.lists(texts, max_size=3).map(tuple)),
        certain=draw(flags),
        samples=draw(indices),
    )


geometry_margins = st.builds(
    GeometryMargin,
    kind=st.sampled_from(["points", "normals", "frictions"]),
    holds_within=not_negative,
    changes_at=odd_numbers,
    verdict_beyond=st.sampled_from(ModeVerdict),
    modes_beyond=st.lists(texts, max_size=2).map(tuple),
)


@st.composite
def contact_mode_answers(draw: st.DrawFn, p_FB_F: np.ndarray = NO_OFFSET) -> ContactModeAnswer:
    """With no mode and several, and with all that can be asked for besides or not."""
    contacts = draw(contact_sets())
    n, plane = len(contacts), draw(planes)
    modes = draw(st.lists(modes_of(n), max_size=2).map(tuple))
    margins = tuple(draw(margins_of(mode.mode)) for mode in modes) if draw(flags) else ()
    sets = draw(st.lists(wrench_sets(), max_size=2).map(tuple))
    return ContactModeAnswer(
        body_name=draw(st.sampled_from(NAMES)) if not p_FB_F.any() else "brick",
        p_FB_F=p_FB_F,
        state=draw(states),
        contacts=contacts,
        verdict=draw(st.sampled_from(ModeVerdict)),
        modes=modes,
        margins=margins or None,
        approaching=draw(st.lists(indices, max_size=2).map(tuple)),
        contact_velocities_W=draw(arrays(n, 3)),
        refused=draw(st.lists(refused_modes, max_size=2).map(tuple)),
        kinematic_modes=draw(st.lists(texts, max_size=2).map(tuple)),
        wrench_sets=sets or None,
        statics=draw(some(static_answers)),
        settled=draw(some(settled_impacts(n))),
        problem=Problem.SPATIAL if plane is None else Problem.PLANAR,
        plane=plane,
        out_of_plane=draw(odd_numbers),
        out_of_plane_reason=draw(texts),
        velocity_tolerance=draw(positive),
        acceleration_tolerance=draw(odd_numbers),
        distance_tolerance=draw(positive),
        friction_facets=draw(indices),
        wrench_facets=draw(indices),
        undecided_modes=draw(st.lists(texts, max_size=2).map(tuple)),
        within=draw(some(verdicts_within())),
        geometry_margins=draw(st.lists(geometry_margins, max_size=3).map(tuple)) or None,
    )


@st.composite
def bodies(draw: st.DrawFn) -> Body:
    """Known ones, known ones of another mass, and unknown ones without name and shape."""
    known = draw(st.sampled_from([BRICK, BAT]))
    mass_properties = MassProperties(mass=draw(positive), I_B=draw(positive) * np.eye(3))
    described = Body(name="", mass_properties=mass_properties)
    return draw(st.sampled_from([known, changed_body(known, mass_properties, NO_OFFSET), described]))


published = st.builds(
    PublishedState, stamp_ns=some(st.integers(0, 10**18)), fit_window=st.one_of(st.just(0.0), positive)
)
sampled = st.one_of(
    st.builds(AtTimes, times=st.lists(st.floats(0.0, 9.0), max_size=3).map(sorted)),
    st.builds(AtStamps, stamps_ns=st.lists(st.integers(0, 10**18), max_size=3).map(sorted)),
    st.builds(AtRate, rate=some(positive), duration=some(not_negative)),
    st.builds(UntilContact, rate=some(positive), duration=some(not_negative)),
    st.builds(
        UntilPlane,
        rate=some(positive),
        duration=some(not_negative),
        plane_point=arrays(3),
        plane_normal=unit_vectors(),
        body_point=arrays(3),
    ),
)
gravities = st.sampled_from([None, np.zeros(3)])


@st.composite
def tumbling_questions(draw: st.DrawFn) -> TumblingQuestion:
    """From all sources of states, at all kinds of times, with and without forces."""
    return TumblingQuestion(
        body=draw(bodies()),
        state=draw(st.one_of(published, known_states())),
        sampling=draw(sampled),
        gravity_W=draw(gravities),
        wrench=ConstantWrench(
            force=draw(arrays(3, of=positive)),
            torque=draw(arrays(3)),
            axes=draw(st.sampled_from(WrenchAxes)),
        ),
        drag=draw(st.builds(Drag, linear=positive, quadratic_angular=positive)),
        want_covariance=draw(flags),
        curve_points=draw(indices),
    )


@st.composite
def impact_questions(draw: st.DrawFn) -> ImpactQuestion:
    """The questions are about one body and two, by all laws, without the fields that play no part."""
    problem, contacts = draw(st.sampled_from(Problem)), draw(some(contact_sets()))
    is_planar, state = problem is Problem.PLANAR, draw(st.one_of(published, known_states()))
    other = draw(some(bodies()))
    other_state = draw(known_states()) if other is not None else NEWEST
    in_time = st.builds(
        InTime, strike_window=positive, most_strikes=st.integers(1, 2**32 - 1), hold_step=some(positive)
    )
    return ImpactQuestion(
        body=draw(bodies()),
        state=state,
        other=other,
        other_state=other_state,
        contacts=contacts,
        horizon=draw(some(not_negative)) if contacts is None else None,
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        several_contacts_law=draw(st.one_of(st.sampled_from(SeveralContactsLaw), in_time)),
        want_orders=draw(flags),
        want_covariance=draw(flags),
        problem=problem,
        plane=draw(planes) if is_planar else None,
        out_of_plane_tolerance=draw(some(not_negative)) if is_planar else None,
        velocity_tolerance=draw(some(not_negative)),
        distance_tolerance=draw(some(not_negative)),
    )


@st.composite
def many_states(draw: st.DrawFn, count: int) -> ManyStates:
    """So many states."""
    return ManyStates(
        p_WB_W=draw(arrays(count, 3)),
        q_WB=np.array(draw(tuples_of(unit_vectors(4), count))).reshape(-1, 4),
        v_WB_W=draw(arrays(count, 3)),
        w_WB_W=draw(arrays(count, 3)),
    )


def region(values: np.ndarray) -> Region:
    """A region of one to three numbers, made of twelve or more."""
    k = 1 + len(values) % 3
    return Region(mean=values[:k], covariance=values[:9].reshape(3, 3)[:k, :k], radii=values[-2:])


regions = st.integers(37, 39).flatmap(arrays).map(region)
event_regions = arrays(75).map(
    lambda values: EventRegions(
        probability=float(values[0]),
        seconds=region(values[:12]),
        position=region(values[12:25]),
        q_WB=values[70:74],
        turn=region(values[25:39]),
        velocity=region(values[39:51]),
        spin=region(values[51:64]),
    )
)
branches = st.builds(
    Branch,
    parent=st.integers(-1, 9),
    strike=st.integers(1, 10),
    kind=st.sampled_from(BranchKind),
    surface=texts,
    corner=st.integers(-1, 9),
    probability=st.floats(0.0, 1.0),
    regions=some(event_regions),
)
rests = st.builds(RestSpread, seconds=arrays(5), positions=arrays(5, 3), position=regions)


@st.composite
def toss_distributions(draw: st.DrawFn) -> TossDistribution:
    """With up to one strike and branch and two faces and ghosts, at rest or not followed so far."""
    states, faces = draw(many_states(draw(st.integers(0, 2)))), draw(st.integers(0, 2))
    count = len(states)
    return TossDistribution(
        samples=draw(st.integers(1, 2000)),
        strikes=draw(tuples_of(event_regions, draw(st.integers(0, 1)))),
        branches=draw(tuples_of(branches, draw(st.integers(0, 1)))),
        face_normals_B=draw(arrays(faces, 3)),
        face_probabilities=draw(arrays(faces)),
        rest=draw(some(rests)),
        ghosts=Ghosts(
            samples=np.array(draw(tuples_of(indices, count)), dtype=np.int64),
            strikes=np.array(draw(tuples_of(indices, count)), dtype=np.int64),
            p_WB_W=states.p_WB_W,
            q_WB=states.q_WB,
            v_WB_W=states.v_WB_W,
            w_WB_W=states.w_WB_W,
        ),
    )


@st.composite
def toss_events(draw: st.DrawFn) -> TossEvent:
    """At up to two contacts."""
    n = draw(st.integers(0, 2))
    return TossEvent(
        seconds=draw(numbers),
        kind=draw(st.sampled_from(TossEventKind)),
        surfaces=draw(tuples_of(texts, n)),
        corners=draw(tuples_of(indices, n)),
        p_WC_W=draw(arrays(n, 3)),
        impulse_W=draw(arrays(3)),
        outcome=draw(some(st.sampled_from(ImpactOutcome))),
        mode=draw(st.sampled_from(["", "f", "cf"])),
        state=draw(states),
    )


@st.composite
def toss_paths(draw: st.DrawFn) -> TossPath:
    """With up to two events and undecided points."""
    undecided = st.builds(
        Undecided, seconds=numbers, reason=st.sampled_from(UndecidedReason), options=indices, taken=indices
    )
    energy = st.builds(
        TossEnergy, first=numbers, lost_in_strikes=numbers, lost_in_contact=numbers, left=numbers
    )
    return TossPath(
        end=draw(st.sampled_from(TossEnd)),
        seconds=draw(numbers),
        trajectory=draw(trajectories()),
        events=draw(tuples_of(toss_events(), draw(st.integers(0, 2)))),
        resting_corners=draw(tuples_of(indices, draw(st.integers(0, 4)))),
        resting_normal_B=draw(arrays(3)),
        energy=draw(energy),
        undecided=draw(tuples_of(undecided, draw(st.integers(0, 2)))),
    )


@st.composite
def toss_answers(draw: st.DrawFn) -> TossAnswer:
    """With and without alternatives, fit and distribution."""
    return TossAnswer(
        body_name=draw(st.sampled_from(NAMES)),
        p_FB_F=NO_OFFSET,
        state=draw(states),
        fit=draw(some(fits)),
        toss=draw(toss_paths()),
        alternatives=draw(tuples_of(toss_paths(), draw(st.integers(0, 1)))),
        all_followed=draw(flags),
        distribution=draw(some(toss_distributions())),
    )


@st.composite
def toss_questions(draw: st.DrawFn) -> TossQuestion:
    """From all sources of states, by all laws, with samples and without."""
    root = draw(arrays(6, 6))
    uncertainty = st.builds(
        TossUncertainty,
        covariance=st.sampled_from([np.zeros((0, 0)), root @ root.T]),
        velocity=not_negative,
        spin=not_negative,
        height=not_negative,
    )
    sampling = st.builds(
        TossSampling,
        count=st.integers(1, 2000),
        strikes=some(st.integers(1, 10)),
        to_rest=flags,
        seed=st.integers(0, 2**32 - 1),
        uncertainty=uncertainty,
    )
    return TossQuestion(
        body=draw(bodies()),
        state=draw(st.one_of(published, known_states())),
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        horizon=draw(some(positive)),
        rate=draw(some(positive)),
        most_alternatives=draw(some(indices)),
        sampling=draw(some(sampling)),
    )


@st.composite
def many_tumblings_questions(draw: st.DrawFn) -> ManyTumblingsQuestion:
    """Up to three states, in the known gravity and in none."""
    n = draw(st.integers(1, 3))
    return ManyTumblingsQuestion(
        body=draw(bodies()), states=draw(many_states(n)), seconds=draw(arrays(n)), gravity_W=draw(gravities)
    )


@st.composite
def many_impacts_questions(draw: st.DrawFn) -> ManyImpactsQuestion:
    """Up to three states, by all laws."""
    n = draw(st.integers(1, 3))
    return ManyImpactsQuestion(
        body=draw(bodies()),
        states=draw(many_states(n)),
        p_WC_W=draw(arrays(n, 3)),
        normals_W=np.array(draw(tuples_of(unit_vectors(), n))),
        frictions=draw(arrays(n, of=st.floats(0.0, 5.0))),
        restitutions=draw(arrays(n, of=st.floats(0.0, 1.0))),
        restitution_law=draw(st.sampled_from(RestitutionLaw)),
        velocity_tolerance=draw(some(not_negative)),
    )


@st.composite
def many_tumblings_answers(draw: st.DrawFn) -> ManyTumblingsAnswer:
    """Up to three states."""
    states = draw(many_states(draw(st.integers(0, 3))))
    return ManyTumblingsAnswer(body_name=draw(st.sampled_from(NAMES)), p_FB_F=NO_OFFSET, states=states)


@st.composite
def many_impacts_answers(draw: st.DrawFn) -> ManyImpactsAnswer:
    """Up to three impacts, of which some do not happen."""
    n = draw(st.integers(0, 3))
    separates = np.array(draw(tuples_of(flags, n)), dtype=bool)
    outcomes = np.array(
        [int(each) for each in draw(tuples_of(st.sampled_from(ImpactOutcome), n))], dtype=np.int64
    )
    return ManyImpactsAnswer(
        body_name=draw(st.sampled_from(NAMES)),
        p_FB_F=NO_OFFSET,
        outcomes=np.where(separates, 0, outcomes),
        separates=separates,
        states=draw(many_states(n)),
        impulses_W=draw(arrays(n, 3)),
    )


@st.composite
def many_contact_modes_questions(draw: st.DrawFn) -> ManyContactModesQuestion:
    """Up to three candidates, with sets of contacts or without, and nothing that is not asked for many."""
    asked = replace(
        draw(contact_mode_questions()),
        force_W=np.zeros(3),
        torque_W=np.zeros(3),
        want_wrenches=False,
        want_statics=False,
        want_impact=False,
        uncertainty=EXACT_CONTACTS,
        want_geometry_margins=False,
    )
    if not asked.want_margins:
        asked = replace(asked, margin_length=None)
    given = 0 if asked.contacts is None else len(asked.contacts)
    counts = draw(st.sampled_from([(), (given,), (1,) * given] if given else [()]))
    n = len(counts) if len(counts) > 1 else draw(st.integers(1, 3))
    return ManyContactModesQuestion(
        asked=asked, forces_W=draw(arrays(n, 3)), torques_W=draw(arrays(n, 3)), contact_counts=counts
    )


@st.composite
def many_contact_modes_answers(draw: st.DrawFn) -> ManyContactModesAnswer:
    """Up to three candidates with up to two modes each, with their margins or without."""
    counts = draw(st.lists(st.integers(0, 2), max_size=3))
    n, m = len(counts), sum(counts)
    contacts = draw(contact_sets())
    return ManyContactModesAnswer(
        body_name=draw(st.sampled_from(NAMES)),
        p_FB_F=NO_OFFSET,
        state=draw(states),
        contacts=contacts,
        contact_counts=(len(contacts),),
        verdicts=np.array(draw(tuples_of(st.integers(0, 4), n)), dtype=np.int64),
        problems=np.array(draw(tuples_of(st.integers(1, 2), n)), dtype=np.int64),
        mode_counts=np.array(counts, dtype=np.int64),
        modes=draw(tuples_of(texts, m)),
        accelerations_W=draw(arrays(m, 3)),
        angular_accelerations_W=draw(arrays(m, 3)),
        margins=draw(some(arrays(m))) if m > 0 else None,
    )


@st.composite
def contact_mode_questions(draw: st.DrawFn) -> ContactModeQuestion:
    """The questions ask for each option or not, without the fields that play no part."""
    problem = draw(st.sampled_from(Problem))
    may_be_planar = problem is not Problem.SPATIAL
    margins, statics = draw(flags), draw(flags)
    newest = st.builds(PublishedState, stamp_ns=some(st.integers(0, 10**18)))
    return ContactModeQuestion(
        body=draw(bodies()),
        state=draw(st.one_of(newest, known_states())),
        contacts=draw(some(contact_sets())),
        force_W=draw(arrays(3)),
        torque_W=draw(arrays(3)),
        gravity_W=draw(gravities),
        problem=problem,
        plane=draw(planes) if may_be_planar else None,
        out_of_plane_tolerance=draw(some(not_negative)) if may_be_planar else None,
        velocity_tolerance=draw(some(not_negative)),
        distance_tolerance=draw(some(not_negative)),
        friction_facets=draw(st.sampled_from([None, 3, 8, 32])),
        margin_length=draw(some(positive)) if margins or statics else None,
        want_margins=margins,
        want_wrenches=draw(flags),
        want_statics=statics,
        want_impact=draw(flags),
        uncertainty=draw(uncertainties()),
        want_geometry_margins=draw(flags),
    )
