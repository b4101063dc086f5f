# SPDX-License-Identifier: Apache-2.0
"""Converts requests about contact modes to questions, and answers to responses and back.

All vectors are in world axes.
"""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Final, TypeAlias

import numpy as np

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.result import (
    BodyStatics,
    Certainty,
    GeometryMargin,
    ModeProbability,
    ModeVerdict,
    Refusal,
    RefusedMode,
    SpatialMode,
    VerdictsWithin,
)
from contact_dynamics.contact_modes.spatial.margins import SpatialModeMargin
from contact_dynamics.contact_modes.spatial.wrench_sets import SpatialWrenchSet
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.questions.contact_modes import ContactModeAnswer, ContactModeQuestion
from contact_dynamics.questions.context import Problem
from contact_dynamics.questions.settled_impact import SettledImpact
from contact_dynamics_interfaces.msg import ContactMode, ModeWrenches
from contact_dynamics_interfaces.msg import GeometryMargin as GeometryMarginMsg
from contact_dynamics_interfaces.srv import PredictContactMode
from msg_adapters import fields
from msg_adapters.asked_fields import (
    asked_contacts,
    asked_gravity,
    asked_plane,
    asked_problem,
    asked_subject,
    optional,
)
from msg_adapters.field_names import WRENCH_FIELDS, renamed
from msg_adapters.geometry import vector_from_msg
from msg_adapters.impact import RESOLVED_IMPACT
from msg_adapters.rejected_fields import CONTACT_MODE, check_unread

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.uncertainty import Uncertain
    from contact_dynamics.world import World
    from contact_dynamics_interfaces.srv import PredictContactModeBatch
    from msg_adapters.rejected_fields import ReadIf

    Side: TypeAlias = PredictContactMode.Request | PredictContactMode.Response

_WEDGED: Final = {True: Certainty.POSSIBLE, False: Certainty.NO, None: Certainty.UNKNOWN}
"""Answers to whether a body is wedged, as they are in the message."""


def contact_mode_question_from_msg(
    request: PredictContactMode.Request, *, world: World, world_frame: str
) -> ContactModeQuestion:
    """Return the question of a `PredictContactMode` request; see `tumbling_question_from_msg`."""
    try:
        return asked_contact_modes(
            request,
            world,
            world_frame,
            read_if=CONTACT_MODE,
            force_W=vector_from_msg(request.applied_wrench.force),
            torque_W=vector_from_msg(request.applied_wrench.torque),
            friction_facets=optional(request.friction_facets),
            include_wrenches=request.include_wrenches,
            include_statics=request.include_statics,
            include_impact=request.include_impact,
            uncertainty=uncertainty_from_msg(request),
            include_geometry_margins=request.include_geometry_margins,
            include_probabilities=request.include_probabilities,
        )
    except InvalidFieldError as error:
        raise renamed(error, WRENCH_FIELDS) from None


def asked_contact_modes(
    request: PredictContactMode.Request | PredictContactModeBatch.Request,
    world: World,
    world_frame: str,
    *,
    read_if: tuple[ReadIf, ...],
    **own: object,
) -> ContactModeQuestion:
    """Return the question with the common fields of requests about one candidate and about many.

    ``read_if`` contains the fields that are not always read, and ``own`` further attributes of the question.
    An explicit state must be in the world frame. Raise `ContactDynamicsError` if a field is not allowed, or
    names an unknown body.
    """
    problem, contacts = asked_problem(request.problem), asked_contacts(request)
    gravity_W = asked_gravity(request)
    body, state = asked_subject(request, world, world_frame)
    check_unread(request, read_if)
    return ContactModeQuestion(
        body=body,
        state=state,
        contacts=contacts,
        gravity_W=gravity_W,
        problem=problem,
        plane=asked_plane(request.plane_normal),
        out_of_plane_tolerance=optional(request.out_of_plane_tolerance),
        velocity_tolerance=optional(request.velocity_tolerance),
        distance_tolerance=optional(request.distance_tolerance),
        margin_length=optional(request.margin_length),
        include_margins=request.include_margins,
        **own,  # type: ignore[arg-type]  # checked by the question
    )


def write_uncertainty(uncertainty: ContactUncertainty, msg: Side) -> None:
    """Write the uncertainty of contacts to a request or a response."""
    msg.uncertainty_points = _listed(uncertainty.points)
    msg.uncertainty_normals = _listed(uncertainty.normals)
    msg.uncertainty_frictions = _listed(uncertainty.frictions)


def uncertainty_from_msg(msg: Side) -> ContactUncertainty:
    """Return the uncertainty of contacts, which are exact without numbers.

    Raise `InvalidFieldError` if a number is not allowed, or lists have different lengths.
    """
    if not (msg.uncertainty_points or msg.uncertainty_normals or msg.uncertainty_frictions):
        return EXACT_CONTACTS
    try:
        return ContactUncertainty(
            points=_unlisted(msg.uncertainty_points),
            normals=_unlisted(msg.uncertainty_normals),
            frictions=_unlisted(msg.uncertainty_frictions),
        )
    except InvalidFieldError as error:
        field = error.field.replace("uncertainty of ", "uncertainty_")
        raise InvalidFieldError(field, error.found, error.allowed) from None


def _listed(value: Uncertain) -> list[float]:
    """Return one number, or one for each contact, as a list. It is empty if nothing is uncertain."""
    numbers: list[float] = np.atleast_1d(value).tolist()
    return numbers if any(numbers) else []


def _unlisted(numbers: Sequence[float]) -> float | Sequence[float]:
    if len(numbers) == 0:
        return 0.0
    return numbers[0] if len(numbers) == 1 else numbers


OF_CONTACTS: Final = (
    fields.Row("mode", "mode"),
    fields.Row("contact_forces_W", "contact_forces", fields.rows_of(3)),
    fields.Row("contact_accelerations_W", "contact_accelerations", fields.rows_of(3)),
    fields.Row("tangential_directions_W", "tangential_directions", fields.rows_of(3)),
    fields.Row("misdirection", "misdirection"),
    fields.Row("forces_unique", "forces_unique"),
    fields.Row("motion_unique", "motion_unique"),
)
"""The part of a mode about its contacts, of one body or of several."""

MODE: Final = fields.Table(
    SpatialMode,
    partial(ContactMode, margin=math.nan),
    fields.Row("acceleration_W", "linear_acceleration", fields.FIXED),
    fields.Row("angular_acceleration_W", "angular_acceleration", fields.FIXED),
    *OF_CONTACTS,
)
"""A mode, without its margin."""

MARGIN: Final = fields.Table(
    SpatialModeMargin,
    ContactMode,
    fields.Row("mode", "mode"),
    fields.Row("margin", "margin"),
    fields.Row("length", "margin_length"),
    fields.Row("change_W", "margin_wrench", fields.FIXED),
    fields.Row("verdict_beyond", "margin_verdict", fields.one_of(ModeVerdict)),
    fields.Row("modes_beyond", "margin_modes", fields.TUPLE),
)
"""The margin of the mode in the same message."""

WRENCH_SET: Final = fields.Table(
    SpatialWrenchSet,
    ModeWrenches,
    fields.Row("mode", "mode"),
    fields.Row("sliding_from_W", "sliding_from", fields.rows_of(3)),
    fields.Row("sliding_to_W", "sliding_to", fields.rows_of(3)),
    fields.Row("vertices", "vertices", fields.rows_of(6)),
    fields.Row("generators", "generators", fields.rows_of(6)),
    fields.Row("half_spaces", "half_spaces", fields.rows_of(7)),
)
"""The applied wrenches of one mode, in space with one way of sliding."""

GEOMETRY_MARGIN: Final = fields.Table(
    GeometryMargin,
    GeometryMarginMsg,
    fields.Row("kind", "kind"),
    fields.Row("holds_within", "holds_within"),
    fields.Row("changes_at", "changes_at"),
    fields.Row("verdict_beyond", "verdict_beyond", fields.one_of(ModeVerdict)),
    fields.Row("modes_beyond", "modes_beyond", fields.TUPLE),
)
"""A margin in the geometry."""


def _write_margins(
    msg: PredictContactMode.Response,
    field: str,
    margins: Sequence[SpatialModeMargin] | None,
    frame: fields.Frame,
) -> None:
    """Write margins into the modes that they belong to. Modes beyond them have none."""
    for mode, margin in zip(getattr(msg, field), margins or (), strict=False):
        MARGIN.to_msg(margin, frame, into=mode)


def _read_margins(
    msg: PredictContactMode.Response, field: str, frame: fields.Frame
) -> tuple[SpatialModeMargin, ...] | None:
    """Return margins. If there is no mode, the response does not say whether they were asked for."""
    modes = [mode for mode in getattr(msg, field) if mode.margin_length != 0.0]
    return tuple(MARGIN.from_msg(mode, frame) for mode in modes) or None


_REFUSED: Final = fields.Table(
    RefusedMode,
    PredictContactMode.Response,
    fields.Row("mode", "refused_modes"),
    fields.Row("refusal", "refusals", fields.one_of(Refusal)),
    fields.Row("contact", "refused_contacts"),
    fields.Row("amount", "refusal_amounts"),
)

_PROBABILITIES: Final = fields.Table(
    ModeProbability,
    PredictContactMode.Response,
    fields.Row("mode", "probable_modes"),
    fields.Row("probability", "mode_probabilities"),
).columns()


def _write_no_statics(msg: PredictContactMode.Response) -> None:
    msg.stable_disturbance = math.nan


_STATICS: Final = fields.Table(
    partial(BodyStatics, margin_length=math.nan),  # which the message does not have
    PredictContactMode.Response,
    fields.Row("equilibrium", "equilibrium", fields.one_of(Certainty)),
    fields.Row("jammed", "jammed", fields.one_of(Certainty)),
    fields.Row(
        "wedged",
        "wedged",
        fields.Converted(
            lambda wedged: int(_WEDGED[wedged]),
            lambda number: next(wedged for wedged, certainty in _WEDGED.items() if certainty == number),
        ),
    ),
    fields.Row("stable_disturbance", "stable_disturbance"),
)

_WITHIN: Final = fields.Table(
    VerdictsWithin,
    PredictContactMode.Response,
    fields.Row(
        "uncertainty",
        "",
        fields.Kind(
            lambda msg, _, value, __: write_uncertainty(value, msg),
            lambda msg, _, __: uncertainty_from_msg(msg),
        ),
    ),
    fields.Row("verdicts", "verdicts_within", fields.some_of(ModeVerdict)),
    fields.Row("modes", "modes_within", fields.TUPLE),
    fields.Row("certain", "within_certain"),
    fields.Row("samples", "within_samples"),
)

_SETTLED: Final = fields.Table(
    SettledImpact,
    PredictContactMode.Response,
    fields.Row("impact", "impact", RESOLVED_IMPACT.at_most_one()),
    fields.Row("verdict", "verdict_after_impact", fields.one_of(ModeVerdict)),
    fields.Row("modes", "modes_after_impact", MODE.listed()),
)

_ANSWER: Final = fields.AnswerTable(
    ContactModeAnswer,
    PredictContactMode.Response,
    fields.Row("state", "state", fields.STATE),
    fields.Row("contacts", "contacts", fields.CONTACTS),
    fields.Row("verdict", "verdict", fields.one_of(ModeVerdict)),
    fields.Row("modes", "modes", MODE.listed()),
    fields.Row("margins", "modes", fields.Kind(_write_margins, _read_margins)),
    fields.Row("approaching", "approaching_contacts", fields.TUPLE),
    fields.Row("contact_velocities_W", "contact_velocities", fields.rows_of(3)),
    fields.Row("refused", "", _REFUSED.columns()),
    fields.Row("kinematic_modes", "kinematic_modes", fields.TUPLE),
    fields.Row("wrench_sets", "wrench_sets", fields.or_none(WRENCH_SET.listed())),
    fields.Row(
        "statics", "", _STATICS.nested(lambda msg: msg.equilibrium == msg.NOT_ASKED, _write_no_statics)
    ),
    fields.Row("settled", "", _SETTLED.nested(lambda msg: not msg.impact)),
    fields.Row("problem", "problem", fields.one_of(Problem)),
    fields.Row("plane", "plane_normal", fields.PLANE),
    fields.Row("out_of_plane", "out_of_plane"),
    fields.Row("out_of_plane_reason", "out_of_plane_reason"),
    fields.Row("velocity_tolerance", "velocity_tolerance"),
    fields.Row("acceleration_tolerance", "acceleration_tolerance"),
    fields.Row("distance_tolerance", "distance_tolerance"),
    fields.Row("friction_facets", "friction_facets"),
    fields.Row("wrench_facets", "wrench_facets"),
    fields.Row("undecided", "message", fields.TEXT_BEFORE_WARNINGS),
    fields.Row("warnings", "message", fields.WARNINGS),
    fields.Row("undecided_modes", "undecided_modes", fields.TUPLE),
    fields.Row("within", "", _WITHIN.nested(lambda msg: not msg.verdicts_within)),
    fields.Row("geometry_margins", "geometry_margins", fields.or_none(GEOMETRY_MARGIN.listed())),
    fields.Row("probabilities", "", fields.or_none(_PROBABILITIES)),
)
contact_mode_answer_to_msg: Final = _ANSWER.response_of
contact_mode_answer_from_msg: Final = _ANSWER.answer_of
