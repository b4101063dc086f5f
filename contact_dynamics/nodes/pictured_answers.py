"""The services' answers, as messages, to what the picture shows and says of them."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.constants import ns_after
from contact_dynamics.impact.law import ImpactOutcome
from contact_dynamics.rotations.one import rotation_matrix
from contact_dynamics.tumbling import Trajectory
from contact_dynamics.viewing.impact import DrawnStrike, ImpactPicture, OtherBody
from contact_dynamics.viewing.poinsot import PoinsotPicture
from contact_dynamics.viewing.trajectory import PositionUncertainty
from contact_dynamics_interfaces.msg import Impact, Poinsot
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from msg_adapters.body_state import body_state_from_msg
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.geometry import vector_from_msg
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.picture import Picture

TUMBLING: Final = "Tumbling"
IMPACT: Final = "Impact"

REGIMES: Final = {
    Poinsot.UNKNOWN: "a torque acts",
    Poinsot.AT_REST: "it does not rotate",
    Poinsot.SPHERICAL: "its moments are equal: it spins steadily",
    Poinsot.PRINCIPAL_AXIS: "it spins steadily about a principal axis",
    Poinsot.AXISYMMETRIC: "it precesses steadily",
    Poinsot.ABOUT_MINOR_AXIS: "it tumbles about its minor axis",
    Poinsot.ABOUT_MAJOR_AXIS: "it tumbles about its major axis",
    Poinsot.SEPARATRIX: "it turns over once, on the separatrix",
}
"""In words, by the constant of `Poinsot.msg`."""


SEQUENCE_ENDS: Final = {
    Impact.NOTHING_STRIKES: "it flies",
    Impact.STAYS: "a contact stays",
    Impact.CHATTERS: "it chatters to rest at a contact",
    Impact.MOST_STRIKES: "the bound on their number was reached",
}
"""What follows the last strike of a sequence, in words."""


def show_tumbling(picture: Picture, response: Any, *, p_FB_F: FloatArray, now_ns: int) -> None:
    """Show an answer of `~/predict_tumbling`; ``now_ns`` stands for a state without stamp."""
    stamp_ns = stamp_ns_from_msg(response.state.header.stamp) or now_ns
    name = response.state.body_name
    trajectory = trajectory_from_msg(response.trajectory, p_FB_F=p_FB_F)
    uncertainty = uncertainty_from_msg(response.trajectory)
    picture.show_trajectory(name, trajectory, stamp_ns=stamp_ns, uncertainty=uncertainty)
    if len(response.poinsot.polhode) > 0 and response.poinsot.regime not in (
        Poinsot.UNKNOWN,
        Poinsot.AT_REST,
    ):
        state = body_state_from_msg(response.state, world_frame=response.state.header.frame_id, p_FB_F=p_FB_F)
        shown = poinsot_picture(response.poinsot)
        picture.show_poinsot(shown, state=replace(state, stamp_ns=stamp_ns), body_name=name)
    if response.event == PredictTumbling.Response.NONE:
        event = f"has {len(trajectory)} samples"
        if len(trajectory) > 0:
            event += f" from {trajectory.seconds[0]:.4g} to {trajectory.seconds[-1]:.4g} s"
    else:
        point = numbers(vector_from_msg(response.event_point))
        speed = np.linalg.norm(vector_from_msg(response.event_velocity))
        where = response.event_surface or "the plane"
        event = f"reaches {where} in {response.event_time:.4g} s at ({point}) m with {speed:.3g} m/s"
    words = [event, REGIMES[response.poinsot.regime], *flips_in_words(response.poinsot)]
    tell(picture, TUMBLING, words, response, stamp_ns=stamp_ns)


def flips_in_words(msg: Any) -> list[str]:
    """Return when a body that spins near its middle axis turns over next, with its deviation if told."""
    flips = [
        f"{seconds:.3g} s" + ("" if math.isnan(deviation) else f" (±{deviation:.2g} s)")
        for seconds, deviation in zip(msg.flip_times, msg.flip_time_deviations, strict=True)
    ]
    return [f"its middle axis turns over after {', '.join(flips)}"] if flips else []


def poinsot_picture(msg: Any) -> PoinsotPicture:
    """Return Poinsot's picture of a rotation that is not rest."""
    return PoinsotPicture(
        semi_axes=np.sqrt(2.0 * msg.rotational_energy / np.array(msg.principal_moments)),
        principal_axes_B=np.array(msg.principal_axes).reshape(3, 3),
        L_W=np.array(msg.angular_momentum),
        distance=msg.invariable_plane_distance,
        polhode_B=rows(msg.polhode),
        herpolhode_W=rows(msg.herpolhode),
    )


def show_impact(picture: Picture, response: Any, *, p_FB_F: FloatArray, now_ns: int) -> None:
    """Show an answer of `~/predict_impact`, at the time of the state that it was computed from."""
    msg, impact = response.state_before, response.impact
    name = msg.body_name
    state = body_state_from_msg(msg, world_frame=msg.header.frame_id, p_FB_F=p_FB_F)
    stamp_ns = ns_after(state.stamp_ns, -response.time_to_contact) if state.stamp_ns else now_ns
    after = vector_from_msg(impact.state_after.linear_velocity)
    is_planar = response.problem == PredictImpact.Request.PLANAR
    impulses = rows(impact.impulses)
    shown = ImpactPicture(
        state=state,
        v_after_W=after,
        contacts=contacts_from_msg(response.contacts),
        impulses_W=impulses,
        path_W=rows(impact.path),
        path_events=tuple(impact.path_events),
        path_contacts=tuple(impact.path_contacts),
        plane_normal_W=vector_from_msg(response.plane_normal) if is_planar else None,
        other=_other_of(picture, response),
        strikes=strikes_from_msg(impact, p_FB_F=p_FB_F),
    )
    picture.show_impact(name, shown, stamp_ns=stamp_ns)
    words = [
        f"strikes in {response.time_to_contact:.4g} s: {in_words(impact.outcome)}",
        f"velocity ({numbers(state.v_WB_W)}) becomes ({numbers(after)}) m/s",
        f"impulse {np.linalg.norm(impulses.sum(axis=0)):.3g} N s",
    ]
    if not shown.strikes:  # between strikes in time gravity works too
        words.append(f"{impact.kinetic_energy_before - impact.kinetic_energy_after:.3g} J lost")
    for other, other_after in zip(response.other_state_before, impact.other_state_after, strict=True):
        velocity = numbers(vector_from_msg(other_after.linear_velocity))
        words.append(f"that of {other.body_name or 'the other body'} becomes ({velocity}) m/s")
    words += probabilities_in_words(impact)
    if shown.strikes:
        count, last = len(shown.strikes), 1e3 * shown.strikes[-1].seconds
        words.append(f"{count} strikes within {last:.3g} ms; then {SEQUENCE_ENDS[impact.sequence_end]}")
    if impact.creates_energy:
        words.append("the law creates energy: do not trust this answer")
    tell(picture, IMPACT, words, response, stamp_ns=stamp_ns)


def probabilities_in_words(msg: Any) -> list[str]:
    """Return how probable each outcome is, the most probable first, where that was told."""
    if len(msg.outcome_probabilities) == 0:
        return []
    named = [(share, in_words(i)) for i, share in enumerate(msg.outcome_probabilities) if share > 0.0]
    if msg.miss_probability > 0.0:
        named.append((msg.miss_probability, "separates"))
    named.sort(reverse=True)
    return [f"outcomes: {', '.join(f'{words} {100.0 * share:.2g} %' for share, words in named)}"]


def in_words(outcome: int) -> str:
    """Return what a contact does in an impact, in words."""
    if outcome == Impact.NOT_TOLD:
        return "several at once"
    return ImpactOutcome(outcome).name.replace("_", " ").lower()


def strikes_from_msg(msg: Any, *, p_FB_F: FloatArray) -> tuple[DrawnStrike, ...]:
    """Return the strikes of a sequence in time, with the centre of mass where the message has the frame."""
    orientations = np.reshape(msg.strike_body_orientations, (-1, 4))
    return tuple(
        DrawnStrike(
            seconds=seconds,
            contact=contact,
            p_WC_W=p_WC_W,
            impulse_W=impulse_W,
            p_WB_W=p_WF_W + rotation_matrix(q) @ p_FB_F,
            q_WB=q,
        )
        for seconds, contact, p_WC_W, impulse_W, p_WF_W, q in zip(
            msg.strike_times,
            msg.strike_contacts,
            rows(msg.strike_positions),
            rows(msg.strike_impulses),
            rows(msg.strike_body_positions),
            orientations,
            strict=True,
        )
    )


def _other_of(picture: Picture, response: Any) -> OtherBody | None:
    if not response.other_state_before:
        return None
    (msg,), (after,) = response.other_state_before, response.impact.other_state_after
    body = picture.body(msg.body_name)
    p_FB_F = body.p_FB_F if body else np.zeros(3)
    return OtherBody(
        name=msg.body_name,
        state=body_state_from_msg(msg, world_frame=msg.header.frame_id, p_FB_F=p_FB_F),
        v_after_W=vector_from_msg(after.linear_velocity),
    )


def show_error(picture: Picture, kind: str, response: Any, *, now_ns: int) -> None:
    """Show that a question was refused."""
    picture.tell(kind, f"refused ({response.status}): {response.message}", stamp_ns=now_ns, is_error=True)


def trajectory_from_msg(msg: Any, *, p_FB_F: FloatArray) -> Trajectory:
    """Return a trajectory of the centre of mass from one of the published frame."""
    orientations = np.array(msg.orientations).reshape(-1, 4)
    offsets = [rotation_matrix(q) @ p_FB_F for q in orientations] if np.any(p_FB_F) else np.zeros(3)
    return Trajectory(
        seconds=np.array(msg.times),
        p_WB_W=rows(msg.positions) + np.reshape(offsets, (-1, 3)),
        q_WB=orientations,
        v_WB_W=rows(msg.linear_velocities),
        w_WB_W=rows(msg.angular_velocities),
    )


def uncertainty_from_msg(msg: Any) -> PositionUncertainty | None:
    """Return how uncertain the centre of mass is along a trajectory; None: not told."""
    if len(msg.covariances) == 0:
        return None
    return PositionUncertainty(
        covariances_W=np.reshape(msg.covariances, (-1, 12, 12))[:, :3, :3],
        trusted=tuple(msg.covariances_trusted),
    )


def rows(numbers: Sequence[float]) -> FloatArray:
    """Return flat numbers as vectors, (n, 3)."""
    return np.array(numbers, dtype=np.float64).reshape(-1, 3)


def numbers(vector: FloatArray) -> str:
    """Return numbers in words, what is below a millionth as 0."""
    return ", ".join(f"{round(number, 6) + 0.0:.3g}" for number in vector.tolist())


def body_name_of(response: Any) -> str:
    """Return the name of the body that an answer is about; empty where the request named none."""
    state = response.state_before if hasattr(response, "state_before") else response.state
    name: str = state.body_name
    return name


def tell(picture: Picture, kind: str, words: Sequence[str], response: Any, *, stamp_ns: int) -> None:
    """Tell an answer in words, with what the server adds to it and the time it took."""
    said = [*words, response.message] if response.message else words
    took = f"({response.computation_time * 1e3:.2g} ms)"
    text = f"{body_name_of(response) or 'a body'} {'; '.join(said)} {took}"
    picture.tell(kind, text, stamp_ns=stamp_ns)
