"""These adapters convert what a service says about uncertain contacts, in requests and responses."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from contact_dynamics.contact.uncertainty import EXACT_CONTACTS, ContactUncertainty
from contact_dynamics.contact_modes.result import GeometryMargin, ModeVerdict, VerdictsWithin
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics_interfaces import msg as messages

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.contact.uncertainty import Uncertain
    from contact_dynamics_interfaces.srv import PredictContactMode

    Side: TypeAlias = PredictContactMode.Request | PredictContactMode.Response


def write_uncertainty(uncertainty: ContactUncertainty, msg: Side) -> None:
    """Write how well contacts are known into a request or a response."""
    msg.uncertainty_points = _listed(uncertainty.points)
    msg.uncertainty_normals = _listed(uncertainty.normals)
    msg.uncertainty_frictions = _listed(uncertainty.frictions)


def uncertainty_from_msg(msg: Side) -> ContactUncertainty:
    """Return how well contacts are known. Without numbers they are known exactly.

    Raises:
        InvalidFieldError: a number is not allowed, or lists are of different counts of contacts.
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


def write_within(within: VerdictsWithin | None, msg: PredictContactMode.Response) -> None:
    """Write the verdicts that occur within an uncertainty."""
    if within is not None:
        write_uncertainty(within.uncertainty, msg)
        msg.verdicts_within = [int(verdict) for verdict in within.verdicts]
        msg.modes_within = list(within.modes)
        msg.within_certain = within.certain
        msg.within_samples = within.samples


def within_from_msg(msg: PredictContactMode.Response) -> VerdictsWithin | None:
    """Return the verdicts that occur within an uncertainty, or None if the contacts are known exactly."""
    if not msg.verdicts_within:
        return None
    return VerdictsWithin(
        uncertainty=uncertainty_from_msg(msg),
        verdicts=tuple(ModeVerdict(verdict) for verdict in msg.verdicts_within),
        modes=tuple(msg.modes_within),
        certain=msg.within_certain,
        samples=msg.within_samples,
    )


def geometry_margin_to_msg(margin: GeometryMargin) -> messages.GeometryMargin:
    """Return a margin in the geometry as a message."""
    return messages.GeometryMargin(
        kind=margin.kind,
        holds_within=margin.holds_within,
        changes_at=margin.changes_at,
        verdict_beyond=int(margin.verdict_beyond),
        modes_beyond=list(margin.modes_beyond),
    )


def geometry_margin_from_msg(msg: messages.GeometryMargin) -> GeometryMargin:
    """Return the margin in the geometry that a message holds."""
    return GeometryMargin(
        kind=msg.kind,
        holds_within=msg.holds_within,
        changes_at=msg.changes_at,
        verdict_beyond=ModeVerdict(msg.verdict_beyond),
        modes_beyond=tuple(msg.modes_beyond),
    )


def _listed(value: Uncertain) -> list[float]:
    """Return one number, or one for each contact, as a list. It is empty if nothing is uncertain."""
    numbers: list[float] = np.atleast_1d(value).tolist()
    return numbers if any(numbers) else []


def _unlisted(numbers: Sequence[float]) -> float | Sequence[float]:
    if len(numbers) == 0:
        return 0.0
    return numbers[0] if len(numbers) == 1 else numbers
