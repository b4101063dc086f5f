"""Converts what can happen in an uncertain toss to messages and back: regions, the tree, and rest."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import numpy as np

from contact_dynamics.questions.many import ManyStates
from contact_dynamics.toss.distribution import (
    Branch,
    BranchKind,
    EventRegions,
    Ghosts,
    Region,
    RestSpread,
    TossDistribution,
)
from contact_dynamics_interfaces.msg import TossBranch, TossEventRegions, TossRegion
from contact_dynamics_interfaces.msg import TossDistribution as TossDistributionMsg
from msg_adapters import fields
from msg_adapters.batches import body_states_from_msg, body_states_to_msg

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def _region(mean: FloatArray, covariance: FloatArray, radii: FloatArray) -> Region:
    """Return a region, whose covariance is flat in the message."""
    return Region(mean=mean, covariance=covariance.reshape(len(mean), len(mean)), radii=radii)


REGION: Final = fields.Table(
    _region,
    TossRegion,
    fields.Row("mean", "mean", fields.NUMBERS),
    fields.Row("covariance", "covariance", fields.NUMBERS),
    fields.Row("radii", "radii", fields.FIXED),
)
"""A region that holds a mean and a covariance."""

EVENT_REGIONS: Final = fields.Table(
    EventRegions,
    TossEventRegions,
    fields.Row("probability", "probability"),
    fields.Row("seconds", "time", REGION.nested()),
    fields.Row("position", "position", REGION.nested()),
    fields.Row("q_WB", "orientation", fields.QUATERNION),
    fields.Row("turn", "turn", REGION.nested()),
    fields.Row("velocity", "linear_velocity", REGION.nested()),
    fields.Row("spin", "angular_velocity", REGION.nested()),
)
"""The regions of a strike."""

BRANCH: Final = fields.Table(
    Branch,
    TossBranch,
    fields.Row("parent", "parent"),
    fields.Row("strike", "strike"),
    fields.Row("kind", "kind", fields.one_of(BranchKind)),
    fields.Row("surface", "surface"),
    fields.Row("corner", "corner"),
    fields.Row("probability", "probability"),
    fields.Row("regions", "regions", EVENT_REGIONS.at_most_one()),
)
"""A branch of the tree of events."""

_REST: Final = fields.Table(
    RestSpread,
    TossDistributionMsg,
    fields.Row("seconds", "rest_time_quantiles", fields.NUMBERS),
    fields.Row("positions", "rest_position_quantiles", fields.rows_of(3)),
    fields.Row("position", "rest_position", REGION.at_most_one()),
)


def _write_ghosts(msg: TossDistributionMsg, field: str, ghosts: Ghosts, frame: fields.Frame) -> None:
    states = ManyStates(p_WB_W=ghosts.p_WB_W, q_WB=ghosts.q_WB, v_WB_W=ghosts.v_WB_W, w_WB_W=ghosts.w_WB_W)
    body_states_to_msg(states, p_FB_F=frame.p_FB_F, into=getattr(msg, field))
    msg.ghost_samples, msg.ghost_strikes = ghosts.samples.tolist(), ghosts.strikes.tolist()


def _read_ghosts(msg: TossDistributionMsg, field: str, frame: fields.Frame) -> Ghosts:
    states = body_states_from_msg(getattr(msg, field), p_FB_F=frame.p_FB_F)
    return Ghosts(
        samples=np.array(msg.ghost_samples, dtype=np.int64),
        strikes=np.array(msg.ghost_strikes, dtype=np.int64),
        p_WB_W=states.p_WB_W,
        q_WB=states.q_WB,
        v_WB_W=states.v_WB_W,
        w_WB_W=states.w_WB_W,
    )


DISTRIBUTION: Final = fields.Table(
    TossDistribution,
    TossDistributionMsg,
    fields.Row("samples", "samples"),
    fields.Row("strikes", "strikes", EVENT_REGIONS.listed()),
    fields.Row("branches", "branches", BRANCH.listed()),
    fields.Row("face_normals_B", "face_normals", fields.rows_of(3)),
    fields.Row("face_probabilities", "face_probabilities", fields.NUMBERS),
    fields.Row("rest", "", _REST.nested(lambda msg: not msg.rest_position)),
    fields.Row("ghosts", "ghosts", fields.Kind(_write_ghosts, _read_ghosts)),
)
"""What can happen in an uncertain toss."""
