"""MuJoCo beside us, where it is installed. Its answers are measured in simulations with its own defaults.

Where a case departs from the defaults (an elliptic friction cone, contacts without damping), its own file
says so. A measured number holds for the version that is installed and its time step.
"""

from __future__ import annotations

import math
from importlib import import_module
from importlib.util import find_spec
from typing import Any, Final

import numpy as np

CONTACT_S: Final = 0.02
"""How long a bounce on a spring and damper lasts, s."""


def mujoco_version() -> str:
    """Return the version of MuJoCo, or an empty text if it is not installed."""
    if find_spec("mujoco") is None:
        return ""
    return str(import_module("mujoco").__version__)


class Simulation:
    """A model with its state. Gravity is standard gravity unless the options say otherwise."""

    def __init__(
        self, world: str, *, options: str = "", gravity: str = "0 0 -9.80665", defaults: str = ""
    ) -> None:
        """Compile a model.

        Args:
            world: The elements of its `worldbody`.
            options: Attributes of its `option`.
            gravity: m/s^2, world axes.
            defaults: Attributes of every `geom`.
        """
        self._mujoco: Any = import_module("mujoco")
        text = (
            f'<mujoco><option gravity="{gravity}" {options}/><default><geom {defaults}/></default>'
            f"<worldbody>{world}</worldbody></mujoco>"
        )
        self.model: Any = self._mujoco.MjModel.from_xml_string(text)
        self.data: Any = self._mujoco.MjData(self.model)

    def run(self, seconds: float) -> None:
        """Go on by a time, s, to the nearest step."""
        steps = round(seconds / float(self.model.opt.timestep))
        self._mujoco.mj_step(self.model, self.data, nstep=steps)

    def loads(self) -> list[float]:
        """Return the normal force at each contact, N."""
        found = []
        for i in range(int(self.data.ncon)):
            force = np.zeros(6)
            self._mujoco.mj_contactForce(self.model, self.data, i, force)
            found.append(float(force[0]))
        return found


def softness(restitution: float) -> str:
    """Return the `solref` of a spring and damper that gives back this share of the speed, in (0, 1].

    A linear oscillator with damping ratio z loses the factor exp(-pi z / sqrt(1 - z^2)) in half a swing. Half
    a swing lasts `CONTACT_S`, which is ten default time steps, so that MuJoCo can resolve it.
    """
    loss = -math.log(restitution)
    ratio = loss / math.hypot(math.pi, loss)
    frequency = math.hypot(math.pi, loss) / CONTACT_S
    return f"{-frequency * frequency} {-2.0 * ratio * frequency}"
