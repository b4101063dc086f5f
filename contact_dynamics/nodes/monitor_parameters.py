# SPDX-License-Identifier: Apache-2.0
"""What the monitor is configured with besides the server's parameters (`config/monitor.yaml`).

The server knows these parameters too, as one file may configure all nodes.
"""

from __future__ import annotations

from typing import Final

from contact_dynamics.nodes.parameter_reader import DeclaredParameter
from contact_dynamics.nodes.visualizer_parameters import VISUALIZER_PARAMETERS

MONITOR_NAME: Final = "contact_dynamics_monitor"  # the name of the monitor's node

CALIBRATION: Final = "calibration"

MONITOR_PARAMETERS: Final = {
    CALIBRATION: DeclaredParameter(
        CALIBRATION, "", "Output file of calibrate --json, whose model errors widen the prediction regions."
    )
}
"""The parameters that the monitor has besides the server's."""

PARAMETERS_OF_OTHERS: Final = {**VISUALIZER_PARAMETERS, **MONITOR_PARAMETERS}
"""The parameters that a file of the server may also have."""
