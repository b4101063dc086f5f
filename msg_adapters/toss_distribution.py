"""Converts what can happen in an uncertain toss to messages and back: regions, the tree, and rest."""

from __future__ import annotations

from typing import TYPE_CHECKING

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
from msg_adapters.batches import body_states_from_msg, body_states_to_msg
from msg_adapters.contacts import flat, rows
from msg_adapters.geometry import quaternion_from_msg

if TYPE_CHECKING:
    from contact_dynamics.validation import FloatArray


def distribution_to_msg(distribution: TossDistribution, *, p_FB_F: FloatArray) -> TossDistributionMsg:
    """Return a distribution as a message, for the centre of mass at ``p_FB_F``, (3,), m."""
    msg = TossDistributionMsg()
    msg.samples = distribution.samples
    msg.strikes = [event_regions_to_msg(each) for each in distribution.strikes]
    msg.branches = [branch_to_msg(each) for each in distribution.branches]
    msg.face_normals = flat(distribution.face_normals_B)
    msg.face_probabilities = flat(distribution.face_probabilities)
    rest = distribution.rest
    if rest is not None:
        msg.rest_time_quantiles = flat(rest.seconds)
        msg.rest_position_quantiles = flat(rest.positions)
        msg.rest_position = [region_to_msg(rest.position)]
    ghosts = distribution.ghosts
    states = ManyStates(p_WB_W=ghosts.p_WB_W, q_WB=ghosts.q_WB, v_WB_W=ghosts.v_WB_W, w_WB_W=ghosts.w_WB_W)
    body_states_to_msg(states, p_FB_F=p_FB_F, into=msg.ghosts)
    msg.ghost_samples, msg.ghost_strikes = ghosts.samples.tolist(), ghosts.strikes.tolist()
    return msg


def distribution_from_msg(msg: TossDistributionMsg, *, p_FB_F: FloatArray) -> TossDistribution:
    """Return the distribution of a message, of the body whose centre of mass is at ``p_FB_F``, (3,), m."""
    states = body_states_from_msg(msg.ghosts, p_FB_F=p_FB_F)
    rest = None
    if msg.rest_position:
        rest = RestSpread(
            seconds=np.array(msg.rest_time_quantiles),
            positions=rows(msg.rest_position_quantiles),
            position=region_from_msg(msg.rest_position[0]),
        )
    return TossDistribution(
        samples=msg.samples,
        strikes=tuple(event_regions_from_msg(each) for each in msg.strikes),
        branches=tuple(branch_from_msg(each) for each in msg.branches),
        face_normals_B=rows(msg.face_normals),
        face_probabilities=np.array(msg.face_probabilities, dtype=np.float64),
        rest=rest,
        ghosts=Ghosts(
            samples=np.array(msg.ghost_samples, dtype=np.int64),
            strikes=np.array(msg.ghost_strikes, dtype=np.int64),
            p_WB_W=states.p_WB_W,
            q_WB=states.q_WB,
            v_WB_W=states.v_WB_W,
            w_WB_W=states.w_WB_W,
        ),
    )


def branch_to_msg(branch: Branch) -> TossBranch:
    """Return a branch as a message."""
    msg = TossBranch()
    msg.parent, msg.strike, msg.kind = branch.parent, branch.strike, int(branch.kind)
    msg.surface, msg.corner, msg.probability = branch.surface, branch.corner, branch.probability
    if branch.regions is not None:
        msg.regions = [event_regions_to_msg(branch.regions)]
    return msg


def branch_from_msg(msg: TossBranch) -> Branch:
    """Return the branch of a message."""
    return Branch(
        parent=msg.parent,
        strike=msg.strike,
        kind=BranchKind(msg.kind),
        surface=msg.surface,
        corner=msg.corner,
        probability=msg.probability,
        regions=next((event_regions_from_msg(each) for each in msg.regions), None),
    )


def event_regions_to_msg(regions: EventRegions) -> TossEventRegions:
    """Return the regions of a strike as a message."""
    msg = TossEventRegions()
    msg.probability = regions.probability
    mean = msg.orientation
    mean.x, mean.y, mean.z, mean.w = regions.q_WB.tolist()
    region_to_msg(regions.seconds, into=msg.time)
    region_to_msg(regions.position, into=msg.position)
    region_to_msg(regions.turn, into=msg.turn)
    region_to_msg(regions.velocity, into=msg.linear_velocity)
    region_to_msg(regions.spin, into=msg.angular_velocity)
    return msg


def event_regions_from_msg(msg: TossEventRegions) -> EventRegions:
    """Return the regions of a strike."""
    return EventRegions(
        probability=msg.probability,
        seconds=region_from_msg(msg.time),
        position=region_from_msg(msg.position),
        q_WB=quaternion_from_msg(msg.orientation),
        turn=region_from_msg(msg.turn),
        velocity=region_from_msg(msg.linear_velocity),
        spin=region_from_msg(msg.angular_velocity),
    )


def region_to_msg(region: Region, *, into: TossRegion | None = None) -> TossRegion:
    """Return a region as a message, which is new unless an empty one to fill is given."""
    msg = TossRegion() if into is None else into
    msg.mean, msg.covariance = flat(region.mean), flat(region.covariance)
    msg.radii = region.radii
    return msg


def region_from_msg(msg: TossRegion) -> Region:
    """Return the region of a message."""
    k = len(msg.mean)
    return Region(
        mean=np.array(msg.mean, dtype=np.float64),
        covariance=np.array(msg.covariance, dtype=np.float64).reshape(k, k),
        radii=np.array(msg.radii),
    )
