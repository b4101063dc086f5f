"""What the visualizer is configured with besides the server's parameters (`config/visualizer.yaml`)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, NamedTuple

from contact_dynamics.errors import ContactDynamicsError
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.viewing.ports import DEFAULT_PORT
from contact_dynamics.viewing.sinks import DEFAULT_MEMORY, DEFAULT_WEB_PORT, NO_WEB_PORT, Sinks, ViewerMode
from contact_dynamics.viewing.trajectory import DEFAULT_PREDICTIONS

if TYPE_CHECKING:
    from contact_dynamics.nodes.node_parameters import NodeParameters

MEGABYTE: Final = 10**6

MOST: Final = 10**6
"""Largest size of a file, MB, and largest number of files."""


class VisualizerParameters(NamedTuple):
    """What the visualizer is configured with besides the server's parameters."""

    server: str  # its full name
    surface_side: float  # m
    predictions: int  # the newest of a body that are in view
    sinks: Sinks


def read_visualizer_parameters(source: NodeParameters) -> VisualizerParameters:
    """Declare and read the parameters, none of which changes while the visualizer runs.

    Raises:
        ConfigurationError: one is not allowed, or there is nowhere to draw to.
    """
    read = source.value
    server = read("server", "/contact_dynamics", "Full name of the server node whose answers are drawn.")
    side = read(
        "surface_side",
        2.0,
        "Side of the square that a surface is drawn as, m.",
        (1e-3, 1e4),
    )
    predictions = read(
        "predictions", DEFAULT_PREDICTIONS, "Number of newest predictions of a body to show.", (1, 100)
    )
    rrd_path = read("rrd_path", "", "File to draw into, which is replaced. Empty: none.")
    rrd_file_size = read("rrd_file_size", 0, "MB, after which the next file begins. 0: one file.", (0, MOST))
    rrd_max_files = read(
        "rrd_max_files", 0, "Newest files that stay, where there are several. 0: all.", (0, MOST)
    )
    spawn = read("spawn", False, "Start rerun's viewer, unless one listens at the port already.")  # noqa: FBT003
    serve = read("serve", False, "Serve the picture at the port, for viewers that connect.")  # noqa: FBT003
    url = read(
        "connect", "", "URL of a viewer to draw in, as rerun+http://127.0.0.1:9876/proxy. Empty: none."
    )
    port = read(
        "port",
        DEFAULT_PORT,
        "Port of this machine that the viewer which is started listens at, or that the picture is served at.",
        (1, 65535),
    )
    web_port = read(
        "web_port",
        DEFAULT_WEB_PORT,
        "Port of this machine at which a browser finds what is served. 0: none.",
        (NO_WEB_PORT, 65535),
    )
    memory = read("viewer_memory", DEFAULT_MEMORY, "Memory limit of the viewer or of the served picture.")
    chosen = [name for name, on in (("spawn", spawn), ("serve", serve), ("connect", bool(url))) if on]
    if len(chosen) > 1:
        message = f"only one of spawn, serve and connect must be set, got {' and '.join(chosen)}"
        raise ConfigurationError(message)
    if not chosen and not rrd_path:
        message = "one of rrd_path, spawn, serve and connect is required: the picture needs a place to go"
        raise ConfigurationError(message)
    try:
        sinks = Sinks(
            rrd_path=rrd_path,
            rrd_size=rrd_file_size * MEGABYTE,
            rrd_files=rrd_max_files,
            viewer=ViewerMode(chosen[0]) if chosen else ViewerMode.NONE,
            port=port,
            url=url,
            memory=memory,
            web_port=web_port,
        )
    except ContactDynamicsError as error:
        raise ConfigurationError(str(error)) from None
    return VisualizerParameters(server=server, surface_side=side, predictions=predictions, sinks=sinks)
