"""Answers of `~/predict_contact_mode`, as messages, to what the picture shows and says of them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from contact_dynamics.contact_modes import ModeVerdict, PlanarMode, PlanarWrenchSet, WrenchHalfSpace
from contact_dynamics.nodes.pictured_answers import in_words, numbers, rows, tell
from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.plane.types import PlanarContact, PlanarWrench
from contact_dynamics.viewing.contact_modes import ContactModesPicture, DrawnMode
from contact_dynamics.viewing.planar_modes import PlanarModesPicture
from contact_dynamics_interfaces.srv import PredictContactMode
from msg_adapters.body_state import body_state_from_msg
from msg_adapters.contacts import contacts_from_msg
from msg_adapters.geometry import vector_from_msg
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.plane.types import Vector2
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.picture import Picture
    from contact_dynamics.world import Body

CONTACT_MODE: Final = "Contact mode"

MOST_LISTED: Final = 8
"""More refused modes than this are counted, not listed."""

VERDICTS: Final = {
    ModeVerdict.UNIQUE: "has one consistent mode",
    ModeVerdict.INDETERMINATE: "has several consistent modes, and mechanics does not choose",
    ModeVerdict.INCONSISTENT: "has no consistent mode: an impact without approach",
    ModeVerdict.IMPACT: "approaches: no mode before the impact is resolved",
}
"""In words."""

CERTAINTIES: Final = {
    PredictContactMode.Response.NO: "no",
    PredictContactMode.Response.POSSIBLE: "possible",
    PredictContactMode.Response.CERTAIN: "certain",
}
"""Static answers in words."""


def show_contact_modes(picture: Picture, response: Any, *, p_FB_F: FloatArray, now_ns: int) -> None:
    """Show an answer of `~/predict_contact_mode`; ``now_ns`` stands for a state without stamp."""
    stamp_ns = stamp_ns_from_msg(response.state.header.stamp) or now_ns
    name = response.state.body_name
    contacts = contacts_from_msg(response.contacts)
    state = body_state_from_msg(response.state, world_frame=response.state.header.frame_id, p_FB_F=p_FB_F)
    velocities = rows(response.contact_velocities)
    drawn = ContactModesPicture(
        p_WB_W=state.p_WB_W,
        q_WB=state.q_WB,
        contacts=contacts,
        modes=tuple(
            _drawn_mode(mode, contacts, velocities, response.acceleration_tolerance)
            for mode in response.modes
        ),
    )
    picture.show_contact_modes(name, drawn, stamp_ns=stamp_ns)
    if response.problem == PredictContactMode.Request.PLANAR:
        plane = PlaneOfMotion(normal_W=vector_from_msg(response.plane_normal))
        planar = planar_picture(response, contacts, state, plane=plane, body=picture.body(name))
        picture.show_planar_modes(name, planar, axes_B=plane.axes_W @ state.R_WB, stamp_ns=stamp_ns)
    tell(picture, CONTACT_MODE, _words(response), response, stamp_ns=stamp_ns)


def planar_picture(
    response: Any, contacts: ContactSet, state: BodyState, *, plane: PlaneOfMotion, body: Body | None
) -> PlanarModesPicture:
    """Return the 2D pictures of a planar answer; the applied wrench only for a body that is known."""
    planar = tuple(
        PlanarContact(r=_pair(r), normal=_pair(n / np.linalg.norm(n)), friction=mu)
        for r, n, mu in zip(
            (contacts.p_WC_W - state.p_WB_W) @ plane.axes_W.T,
            contacts.normals_W @ plane.axes_W.T,
            contacts.frictions.tolist(),
            strict=True,
        )
    )
    tolerance = response.acceleration_tolerance
    modes = tuple(_planar_mode(mode, planar, plane, tolerance) for mode in response.modes)
    first = response.modes[0] if modes else None
    applied = None
    if modes and body is not None:
        inertia = plane.normal_W @ body.mass_properties.inertia_in_world(state.R_WB) @ plane.normal_W
        applied = applied_wrench(modes[0], planar, mass=body.mass_properties.mass, inertia=float(inertia))
    sets = tuple(_wrench_set(msg, plane) for msg in response.wrench_sets)
    return PlanarModesPicture(
        contacts=planar,
        modes=modes,
        margins=tuple(margin_words(mode) for mode in response.modes),
        verdict="approaches" if response.approaching_contacts else "no consistent mode",
        sets=sets,
        length=_length_of(sets),
        applied=applied,
        change=_wrench(first.margin_wrench, plane) if first and math.isfinite(first.margin) else None,
    )


def applied_wrench(
    mode: PlanarMode, contacts: Sequence[PlanarContact], *, mass: float, inertia: float
) -> PlanarWrench:
    """Return the wrench under which a mode's forces give its accelerations, by Newton's law."""
    f_x, f_y = mass * mode.acceleration[0], mass * mode.acceleration[1]
    moment = inertia * mode.angular_acceleration
    for contact, (f_t, f_n) in zip(contacts, mode.contact_forces, strict=True):
        (n_x, n_y), (t_x, t_y), (x, y) = contact.normal, contact.tangent, contact.r
        c_x, c_y = f_t * t_x + f_n * n_x, f_t * t_y + f_n * n_y
        f_x, f_y, moment = f_x - c_x, f_y - c_y, moment - (x * c_y - y * c_x)
    return PlanarWrench(f=(f_x, f_y), moment=moment)


def margin_words(mode: Any) -> str:
    """Return how far a mode's wrench is from another mode, in words; nothing where that was not told."""
    if math.isnan(mode.margin):
        return ""
    if math.isinf(mode.margin):
        return "(under every wrench)"
    beyond = " or ".join(mode.margin_modes) or "no mode"
    return f"({mode.margin:.3g} N from {beyond})"


def _words(response: Any) -> list[str]:
    verdict = VERDICTS[ModeVerdict(response.verdict)]
    modes = ", ".join(f"{mode.mode} {margin_words(mode)}".strip() for mode in response.modes)
    words = [f"{verdict}: {modes}" if modes else verdict]
    shared = [mode.mode for mode in response.modes if not mode.forces_unique]
    if shared:
        words.append(f"the contact forces of {', '.join(shared)} are one choice of many")
    speeds = np.linalg.norm(rows(response.contact_velocities), axis=1)
    words += [f"contact {i + 1} approaches with {speeds[i]:.3g} m/s" for i in response.approaching_contacts]
    refused = response.refused_modes
    if refused:
        more = f" and {len(refused) - MOST_LISTED} more" if len(refused) > MOST_LISTED else ""
        words.append(f"refused: {', '.join(refused[:MOST_LISTED])}{more}")
    if response.equilibrium != response.NOT_ASKED:
        answers = [
            f"{question} {CERTAINTIES[answer]}"
            for question, answer in (
                ("equilibrium", response.equilibrium),
                ("jammed", response.jammed),
                ("wedged", response.wedged),
            )
        ]
        words.append(", ".join(answers))
    for impact in response.impact:
        after = numbers(vector_from_msg(impact.state_after.linear_velocity))
        words.append(f"an impact settles it: {in_words(impact.outcome)}; velocity becomes ({after}) m/s")
        modes = ", ".join(mode.mode for mode in response.modes_after_impact)
        verdict = VERDICTS[ModeVerdict(response.verdict_after_impact)]
        words.append(f"then it {verdict}: {modes}" if modes else f"then it {verdict}")
    return words


def _drawn_mode(msg: Any, contacts: ContactSet, velocities_W: FloatArray, tolerance: float) -> DrawnMode:
    """Return a mode; where its contacts slide is told, or follows from their velocities and accelerations."""
    sliding = rows(msg.tangential_directions)
    if len(sliding) == 0:
        normals = contacts.normals_W
        moves, speeds_up = (
            vectors - np.sum(vectors * normals, axis=1, keepdims=True) * normals
            for vectors in (velocities_W, rows(msg.contact_accelerations))
        )
        sliding = np.where(moves.any(axis=1, keepdims=True), moves, speeds_up)
        sliding[[letter not in "lrc" for letter in msg.mode]] = 0.0
        lengths = np.linalg.norm(sliding, axis=1, keepdims=True)
        sliding = np.divide(sliding, lengths, out=np.zeros_like(sliding), where=lengths > 0.0)
    return DrawnMode(
        mode=msg.mode,
        forces_W=rows(msg.contact_forces),
        sliding_W=sliding,
        acceleration_W=_beyond(np.array([msg.linear_acceleration]), tolerance)[0],
    )


def _planar_mode(
    msg: Any, contacts: Sequence[PlanarContact], plane: PlaneOfMotion, tolerance: float
) -> PlanarMode:
    bases = np.array([(contact.tangent, contact.normal) for contact in contacts])
    in_contact_axes = [
        tuple(_pair(pair) for pair in np.einsum("nij,nj->ni", bases, vectors_W @ plane.axes_W.T))
        for vectors_W in (rows(msg.contact_forces), _beyond(rows(msg.contact_accelerations), tolerance))
    ]
    return PlanarMode(
        mode=msg.mode,
        acceleration=_pair(plane.axes_W @ np.array(msg.linear_acceleration)),
        angular_acceleration=float(plane.normal_W @ np.array(msg.angular_acceleration)),
        contact_forces=in_contact_axes[0],
        contact_accelerations=in_contact_axes[1],
        forces_unique=msg.forces_unique,
        motion_unique=msg.motion_unique,
    )


def _beyond(vectors: FloatArray, tolerance: float) -> FloatArray:
    """Return vectors, (n, 3), with those that count as zero as zero."""
    return np.where(np.linalg.norm(vectors, axis=1, keepdims=True) > tolerance, vectors, 0.0)


def _wrench_set(msg: Any, plane: PlaneOfMotion) -> PlanarWrenchSet:
    return PlanarWrenchSet(
        mode=msg.mode,
        vertices=tuple(_wrench(row, plane) for row in np.reshape(msg.vertices, (-1, 6))),
        generators=tuple(_wrench(row, plane) for row in np.reshape(msg.generators, (-1, 6))),
        half_spaces=tuple(
            WrenchHalfSpace(
                a=(*_pair(plane.axes_W @ row[:3]), float(plane.normal_W @ row[3:6])), b=float(row[6])
            )
            for row in np.reshape(msg.half_spaces, (-1, 7))
        ),
    )


def _length_of(sets: Sequence[PlanarWrenchSet]) -> float:
    """Return the radius of gyration, m, by which half-spaces have unit length; 1 without torques."""
    normals = [side.a for one in sets for side in one.half_spaces]
    a = max(normals, key=lambda row: abs(row[2]), default=(0.0, 0.0, 0.0))
    left = 1.0 - a[0] * a[0] - a[1] * a[1]
    return math.sqrt(left) / abs(a[2]) if a[2] != 0.0 and left > 0.0 else 1.0


def _wrench(row: Sequence[float], plane: PlaneOfMotion) -> PlanarWrench:
    return PlanarWrench(
        f=_pair(plane.axes_W @ np.array(row[:3])), moment=float(plane.normal_W @ np.array(row[3:6]))
    )


def _pair(vector: FloatArray) -> Vector2:
    x, y = vector.tolist()
    return (x, y)
