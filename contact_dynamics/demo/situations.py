# SPDX-License-Identifier: Apache-2.0
"""What happens to the block in the examples: a finger pushes it, or the tray that it stands on tilts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

from geometry_msgs.msg import Vector3Stamped, WrenchStamped

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.demo.sprung_block import Load
from msg_adapters.geometry import vector_to_msg

if TYPE_CHECKING:
    from contact_dynamics.demo.sprung_block import SprungBlock

_GRAVITY: Final = -STANDARD_GRAVITY_W[2]

BEGINS_S: Final = 1.0
"""s for which nothing happens at first, so that one sees the block at rest."""

MAX_PUSHED: Final = 0.1
"""m after which the finger stops."""

MAX_TIPPED: Final = 0.3
"""rad after which the finger stops: the block falls over by itself."""


class Situation(Protocol):
    """Something that happens to the block.

    Attributes:
        topic: Where a robot would measure it.
        msg_type: What it measures.
    """

    topic: str
    msg_type: type

    def load(self, seconds: float, block: SprungBlock) -> Load:
        """Return what acts on the block after so many s, besides the flats that it touches."""

    def measured(self) -> Vector3Stamped | WrenchStamped:
        """Return what a sensor measures of it now. The stamp and the frame are still missing."""


@dataclass(slots=True, kw_only=True)
class PushedBlock:
    """A finger pushes a block towards x, harder and harder, until the block slides or falls over.

    The finger is smooth, and stays at its height. Its sensor measures the wrench on the block in world axes
    and about the world's origin.

    Attributes:
        height: m over the floor. Above half the block's depth over the friction, the block tips.
        rate: N/s.
    """

    height: float
    rate: float
    topic: str = "/finger/wrench"
    msg_type: type = WrenchStamped
    _force: float = 0.0
    _is_over: bool = False

    def load(self, seconds: float, block: SprungBlock) -> Load:
        """Return the weight and the push."""
        self._is_over = self._is_over or block.x > MAX_PUSHED or abs(block.angle) > MAX_TIPPED
        self._force = 0.0 if self._is_over else max(0.0, self.rate * (seconds - BEGINS_S))
        return Load(
            force_x=self._force,
            force_z=-block.mass * _GRAVITY,
            moment=(self.height - block.z) * self._force,
        )

    def measured(self) -> WrenchStamped:
        """Return the wrench of the finger."""
        msg = WrenchStamped()
        msg.wrench.force = vector_to_msg([self._force, 0.0, 0.0])
        msg.wrench.torque = vector_to_msg([0.0, self.height * self._force, 0.0])
        return msg


@dataclass(slots=True, kw_only=True)
class TiltingTray:
    """A tray tilts about its axis y, so slowly that it does not throw what stands on it.

    All is in the axes of the tray, in which gravity turns. What the tray's rotation adds is left out: at 0.05
    rad/s it is 0.05 m/s^2 on a block that slides with 0.5 m/s. The sensor is the tray's accelerometer.

    Attributes:
        max_tilt: rad, where the tray stops.
        rate: rad/s.
    """

    max_tilt: float
    rate: float
    topic: str = "/tray/gravity"
    msg_type: type = Vector3Stamped
    _tilt: float = 0.0

    def load(self, seconds: float, block: SprungBlock) -> Load:
        """Return the weight in the tray's axes."""
        self._tilt = min(self.max_tilt, max(0.0, self.rate * (seconds - BEGINS_S)))
        weight = block.mass * _GRAVITY
        return Load(force_x=weight * math.sin(self._tilt), force_z=-weight * math.cos(self._tilt))

    def measured(self) -> Vector3Stamped:
        """Return the acceleration of gravity."""
        g = _GRAVITY
        turned = vector_to_msg([g * math.sin(self._tilt), 0.0, -g * math.cos(self._tilt)])
        return Vector3Stamped(vector=turned)
