# SPDX-License-Identifier: Apache-2.0
"""How well each law predicts measured landings of a cube on several corners, some milliseconds apart.

The recordings are those of `_impact_tosses`. The benchmark takes pairs of flights with up to `MAX_BETWEEN`
frames between them, in which more than one corner can have struck. Each law takes the state at the end of the
first flight, and predicts the velocities at the beginning of the second:

* one strike: the corner that lands first strikes, and free flight follows;
* at once: all corners that are then within `ALONE` of the floor strike one after the other at that instant;
* in time: the strikes follow, each when it comes (`impact_sequence`). This ends when a corner stays on the
  floor, and the benchmark prints how many do. Free flight is then assumed, which is wrong;
* held: the strikes follow in the same way, and steps go on over corners that stay, with mu and e of the
  strikes of a single corner.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING, Final, NamedTuple, TypeAlias

import numpy as np

from benchmarks._measured_errors import STEP, engine, print_both, print_head, print_row
from benchmarks._quotes import quote
from contact_dynamics.constants import to_seconds
from contact_dynamics.contact.found import find_contacts
from contact_dynamics.errors import SeparatingContactError
from contact_dynamics.impact import impact_sequence, several_impact
from contact_dynamics.landing.earliest import next_landing
from contact_dynamics.measured.cube_tosses import BOARD, CUBE, GRAVITY, read_cube_toss
from contact_dynamics.measured.flight_fit import FEWEST_FRAMES, fit_flight
from contact_dynamics.measured.flights import corner_heights, find_flights, first_part, last_part
from contact_dynamics.rigid_body.body import BodyState
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tumbling import free_motion
from contact_dynamics.world import Body, Surface, World

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from contact_dynamics.measured.recorded_toss import Toss
    from contact_dynamics.rigid_body.body import MassProperties
    from contact_dynamics.validation import FloatArray

Prediction: TypeAlias = "Callable[[MeasuredLanding, float, float], FloatArray]"

MAX_BETWEEN: Final = 6
"""Number of frames, 40 ms. Longer stretches without flight are mostly sliding or rocking."""

ALONE: Final = 0.01
"""m. A corner strikes alone if the next one is at least this much higher."""

HOLD_STEP: Final = 1e-3
"""Step over corners that stay, s."""

FITTED: Final = 4
"""One of this many landings is used for fitting, since all would take too long."""

GRAVITY_W: Final = np.array([0.0, 0.0, -GRAVITY])


class MeasuredLanding(NamedTuple):
    """The state before several strikes, and the velocities after."""

    toss: int
    before: BodyState  # in flight, stamped 0
    seconds: float  # s, from there to the second flight
    after: FloatArray  # (6,), m/s and rad/s, at its beginning
    q_after: FloatArray  # (4,), x y z w, then
    velocity_std: float  # m/s, of the change
    spin_std: float  # rad/s


def measured_landings(path: Path, count: int) -> list[MeasuredLanding]:
    """Return the landings on several corners in the first ``count`` tosses."""
    landings = []
    for index in range(count):
        toss = read_cube_toss(path, index=index)
        for before, after in pairwise(find_flights(toss)):
            landing = _landing(toss, index, before, after)
            if landing is not None:
                landings.append(landing)
    return landings


def _landing(toss: Toss, index: int, before: slice, after: slice) -> MeasuredLanding | None:
    """Return the landing between two flights, or None if it was a single strike or took too long."""
    between = after.start - before.stop
    # The frames next to the strikes can hold a part of them.
    stop, start = before.stop - 1, after.start + 1
    if between > MAX_BETWEEN or min(stop - before.start, after.stop - start) < FEWEST_FRAMES:
        return None
    first = fit_flight(toss, last_part(toss, before, stop))
    second = fit_flight(toss, first_part(toss, slice(start, after.stop)), reference=start)
    begin, end = first.at(float(toss.times[stop - 1])), second.at(float(toss.times[start]))
    if between <= 1:
        middle = 0.5 * float(toss.times[before.stop - 1] + toss.times[after.start])
        lowest, next_one = np.sort(corner_heights(toss, first.at(middle).state)[0])[:2]
        if next_one - lowest >= ALONE:
            return None
    state = begin.state
    return MeasuredLanding(
        toss=index,
        before=BodyState(p_WB_W=state.p_WB_W, q_WB=state.q_WB, v_WB_W=state.v_WB_W, w_WB_W=state.w_WB_W),
        seconds=end.time - begin.time,
        after=_velocity(end.state),
        q_after=end.state.q_WB,
        velocity_std=float(np.hypot(begin.velocity_std, end.velocity_std)),
        spin_std=float(np.hypot(begin.angular_velocity_std, end.angular_velocity_std).max()),
    )


def compare(
    landings: Sequence[MeasuredLanding],
    balanced: MassProperties,
    centre: FloatArray,
    *,
    of_one_corner: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    """Print the errors of each law, with the published body and with the one that balances momenta.

    ``of_one_corner``: mu and e as fitted to strikes of a single corner, with the one body and the other.
    """
    training = [landing for landing in landings if landing.toss % 2 == 0][::FITTED]
    held_out = [landing for landing in landings if landing.toss % 2 == 1]
    seconds = np.median([landing.seconds for landing in landings])
    print(
        f"\nMeasured landings on several corners: {len(landings)}, {1e3 * seconds:.0f} ms long (median);"
        f" fitted on {len(training)}, errors on {len(held_out)}\n"
    )
    quote("impact.landings.count", len(held_out), digits=3)
    quote("impact.landings.length", 1e3 * float(seconds), "ms")
    print_head()
    _predictions(CUBE, np.zeros(3), training, held_out, of_one_corner[0], quoted="impact.landings.published")
    print("\nWith the inertia and the centre of mass that balance momenta:")
    _predictions(
        Body(name="cube", mass_properties=balanced, vertices_B=CUBE.vertices_B - centre),
        centre,
        [about_centre(landing, centre) for landing in training],
        [about_centre(landing, centre) for landing in held_out],
        of_one_corner[1],
        quoted="impact.landings.balanced",
    )


def _predictions(
    shape: Body,
    centre: FloatArray,
    training: Sequence[MeasuredLanding],
    held_out: Sequence[MeasuredLanding],
    of_one_corner: tuple[float, float],
    *,
    quoted: str,
) -> None:
    nominal = (BOARD.friction, BOARD.restitution)
    still = lambda landing: _flown(shape, landing, landing.before)  # noqa: E731
    print_row("no impact", "", "", held_out, still, quoted=f"{quoted}.no_impact")
    for name, predict in predictions(shape).items():
        print_both(name, training, held_out, nominal, predict, quoted=f"{quoted}.{name.replace(' ', '_')}")
    for text, constants in (("published", nominal), ("of one corner", of_one_corner)):
        print_row(
            f"held, {text}",
            *constants,
            held_out,
            lambda landing, constants=constants: _held(shape, landing, *constants),
            quoted=f"{quoted}.held.{text.replace(' ', '_')}",
        )
    by_engine = _by_engine(shape.mass_properties, centre)
    if by_engine is None:
        print(f"{'MuJoCo':>28}  is not installed")
    else:
        print_both("MuJoCo", training, held_out, nominal, by_engine, quoted=f"{quoted}.mujoco")
    flying = [landing for landing in held_out if not _stays(shape, landing, *nominal)]
    print(
        f"A corner stays before the second flight, by the published constants, in"
        f" {len(held_out) - len(flying)} of {len(held_out)}."
    )
    print("The other landings alone:")
    for name, predict in predictions(shape).items():
        print_row(
            f"{name}, published",
            *nominal,
            flying,
            lambda landing, predict=predict: predict(landing, *nominal),
        )


def _by_engine(body: MassProperties, centre: FloatArray) -> Prediction | None:
    """Return a prediction by MuJoCo, stepped to the second flight, or None if it is not installed."""
    cube = engine(body, centre)
    if cube is None:
        return None

    def predict(landing: MeasuredLanding, friction: float, restitution: float) -> FloatArray:
        cube.start(landing.before, friction, restitution)
        for _ in range(round(landing.seconds / STEP)):
            cube.step()
        return cube.velocity()

    return predict


def predictions(shape: Body) -> dict[str, Prediction]:
    """Return each law's prediction for a landing of a body, by its name."""

    def one_strike(landing: MeasuredLanding, friction: float, restitution: float) -> FloatArray:
        return _flown(shape, landing, _at_once(shape, landing, _world(shape, friction, restitution), 1e-6))

    def at_once(landing: MeasuredLanding, friction: float, restitution: float) -> FloatArray:
        return _flown(shape, landing, _at_once(shape, landing, _world(shape, friction, restitution), ALONE))

    def in_time(landing: MeasuredLanding, friction: float, restitution: float) -> FloatArray:
        return _in_time(shape, landing, _world(shape, friction, restitution), None)

    return {"one strike": one_strike, "at once": at_once, "in time": in_time}


def _held(shape: Body, landing: MeasuredLanding, friction: float, restitution: float) -> FloatArray:
    return _in_time(shape, landing, _world(shape, friction, restitution), HOLD_STEP)


def _in_time(shape: Body, landing: MeasuredLanding, world: World, hold_step: float | None) -> FloatArray:
    sequence = impact_sequence(
        shape, _outside(shape, landing.before), world, window=landing.seconds, hold_step=hold_step
    )
    states = [strike.state_after for strike in sequence.strikes if strike.seconds < landing.seconds]
    return _flown(shape, landing, states[-1] if states else landing.before)


def _stays(shape: Body, landing: MeasuredLanding, friction: float, restitution: float) -> bool:
    """Return whether the sequence in time ends before the second flight, since a corner stays."""
    world = _world(shape, friction, restitution)
    before = _outside(shape, landing.before)
    limit = impact_sequence(shape, before, world, window=landing.seconds).limit_seconds
    return limit is not None and limit < landing.seconds


def about_centre(landing: MeasuredLanding, centre: FloatArray) -> MeasuredLanding:
    """Return the landing with its states at ``centre``, (3,), m, body axes, not the tracked origin."""
    before = landing.before
    offset = before.R_WB @ centre
    moved = replace(
        before, p_WB_W=before.p_WB_W + offset, v_WB_W=before.v_WB_W + np.cross(before.w_WB_W, offset)
    )
    after = landing.after.copy()
    after[:3] += np.cross(after[3:], rotation_matrix(landing.q_after) @ centre)
    return landing._replace(before=moved, after=after)


def _world(shape: Body, friction: float, restitution: float) -> World:
    board = Surface(
        name=BOARD.name,
        p_WS_W=BOARD.p_WS_W,
        normal_W=BOARD.normal_W,
        friction=friction,
        restitution=restitution,
    )
    return World(bodies=(shape,), surfaces=(board,), gravity_W=GRAVITY_W)


def _outside(shape: Body, state: BodyState) -> BodyState:
    """Return a state whose corners are not below the board.

    Fitted states are up to some millimetres deep, by the errors of the published size and tracked frame.
    """
    depth = -float(BOARD.gaps(state.p_WB_W + shape.vertices_B @ state.R_WB.T).min())
    return state if depth <= 0.0 else replace(state, p_WB_W=state.p_WB_W + depth * BOARD.normal_W)


def _at_once(shape: Body, landing: MeasuredLanding, world: World, within: float) -> BodyState:
    """Return the state after the corners within ``within``, m, of the floor at the first strike."""
    found = next_landing(shape, _outside(shape, landing.before), world, horizon=landing.seconds)
    if found is None or not found.strikes:
        return landing.before
    contacts = find_contacts(shape, found.state, world, distance_tolerance=within)
    try:
        return several_impact(shape, found.state, contacts).state
    except SeparatingContactError:
        return found.state


def _flown(shape: Body, landing: MeasuredLanding, state: BodyState) -> FloatArray:
    """Return the velocities, (6,), after free flight from a state to the second flight."""
    rest = landing.seconds - to_seconds(state.stamp_ns)
    return _velocity(free_motion(shape.mass_properties, state, gravity_W=GRAVITY_W).state_at(rest))


def _velocity(state: BodyState) -> FloatArray:
    return np.concatenate([state.v_WB_W, state.w_WB_W])
