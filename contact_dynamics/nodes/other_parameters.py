# SPDX-License-Identifier: Apache-2.0
"""The parameters of the visualizer and of the monitor besides the server's.

They are in `config/visualizer.yaml` and `config/monitor.yaml`. One file may configure all nodes, so that the
server accepts these parameters too. This file therefore does not import rerun.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.constants import DEFAULT_PREDICTIONS
from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameter_reader import ConfigurationError, DeclaredParameter

if TYPE_CHECKING:
    from contact_dynamics.nodes.parameter_reader import ParameterSource
    from contact_dynamics.viewing.sinks import Sinks

MEGABYTE: Final = 10**6

MOST: Final = 10**6  # largest size of a file, MB, and largest number of files

_DECLARED: Final = (
    DeclaredParameter("server", "/contact_dynamics", "Full name of the server, whose responses are drawn."),
    DeclaredParameter(
        "monitor", "/contact_dynamics_monitor", "Full name of the monitor node whose events are listed."
    ),
    DeclaredParameter("rrd_path", "", "Output file. An existing file is replaced."),
    DeclaredParameter(
        "rrd_file_size",
        0,
        "Size limit of a file, MB, after which the next one begins. 0 means one file.",
        (0, MOST),
    ),
    DeclaredParameter("rrd_max_files", 0, "Number of latest files to keep. 0 keeps all.", (0, MOST)),
    DeclaredParameter(
        "spawn", value=False, description="Start rerun's viewer, unless one already listens at the port."
    ),
    DeclaredParameter(
        "serve", value=False, description="Serve the picture at the port, for viewers that connect."
    ),
    DeclaredParameter("connect", "", "URL of an open viewer, such as rerun+http://127.0.0.1:9876/proxy."),
    DeclaredParameter(
        "port",
        9876,  # rerun's own
        "Port of this machine for spawn and serve.",
        (1, 65535),
    ),
    DeclaredParameter(
        "web_port",
        9090,  # rerun's own
        "Port of this machine for the web viewer of the served picture. 0 disables it.",
        (0, 65535),
    ),
    DeclaredParameter(
        "viewer_memory", "1GiB", "Memory limit of the viewer or of the served picture, such as 500MB."
    ),
    DeclaredParameter(
        "predictions", DEFAULT_PREDICTIONS, "Number of latest predictions shown for a body.", (1, 100)
    ),
    DeclaredParameter("surface_side", 2.0, "Side of the square drawn for a surface, m.", (1e-3, 1e4)),
)

VISUALIZER_PARAMETERS: Final = {each.name: each for each in _DECLARED}
"""The parameters that the visualizer has besides the server's."""

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


class VisualizerParameters(NamedTuple):
    """The configuration of the visualizer besides the server's parameters."""

    server: str  # its full name
    monitor: str  # its full name
    surface_side: float  # m
    predictions: int  # number of latest predictions in view for a body
    sinks: Sinks


def read_visualizer_parameters(source: ParameterSource) -> VisualizerParameters:
    """Declare and read the parameters, none of which changes while the visualizer runs.

    Raise `ConfigurationError` if one is not allowed, or there is nowhere to draw to.
    """
    from contact_dynamics.viewing.sinks import Sinks, ViewerMode

    given = {name: source.value(*declared) for name, declared in VISUALIZER_PARAMETERS.items()}
    chosen = [name for name in ("spawn", "serve", "connect") if given[name]]
    if len(chosen) > 1:
        message = f"only one of spawn, serve and connect must be set, got {' and '.join(chosen)}"
        raise ConfigurationError(message)
    if not chosen and not given["rrd_path"]:
        raise ConfigurationError("one of rrd_path, spawn, serve and connect is required")
    try:
        sinks = Sinks(
            rrd_path=given["rrd_path"],
            rrd_size=given["rrd_file_size"] * MEGABYTE,
            rrd_files=given["rrd_max_files"],
            rrd_footer=False,  # the node may draw for weeks
            viewer=ViewerMode(chosen[0]) if chosen else ViewerMode.NONE,
            port=given["port"],
            url=given["connect"],
            memory=given["viewer_memory"],
            web_port=given["web_port"],
        )
    except ContactDynamicsError as error:
        raise ConfigurationError(str(error)) from None
    return VisualizerParameters(
        server=given["server"],
        monitor=given["monitor"],
        surface_side=given["surface_side"],
        predictions=given["predictions"],
        sinks=sinks,
    )
