# SPDX-License-Identifier: Apache-2.0
"""The server's parameters. Each is declared once, with its description and range.

Users edit the commented file `config/server.yaml`. A test checks that both have the same parameters.
`world_parameters` reads the world, its bodies and the sources of their states.

Bodies, surfaces, gravity, tolerances and most limits may change while the server runs. Topics, the log and
the worker processes remain while the node is configured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Final

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.nodes.links import PARTS
from contact_dynamics.nodes.parameter_reader import ConfigurationError, ParameterSource
from contact_dynamics.nodes.situations import FaultLimits
from contact_dynamics.nodes.world_parameters import SHAPE_PARAMETERS, read_body, read_surface
from contact_dynamics.questions.carried_surface import CarriedSurface
from contact_dynamics.questions.context import Defaults
from contact_dynamics.questions.extent import check_vector
from contact_dynamics.questions.state_store import FUTURE_TOLERANCE, MAX_STATES
from contact_dynamics.questions.workers import WorkerLimits
from contact_dynamics.recording.limits import (
    FILES_KEPT,
    LEAST_FILE_BYTES,
    LEAST_FILE_SECONDS,
    Compression,
    LogLimits,
)
from contact_dynamics.world import World

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.nodes.parameter_reader import ConfiguredTopic, DeclaredParameter
    from contact_dynamics.nodes.world_parameters import BodySources

MEGABYTE: Final = 1_000_000  # bytes of a megabyte


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerParameters:
    """The configuration of the server."""

    world: World
    carried: tuple[CarriedSurface, ...]  # the surfaces that move with a body
    sources: tuple[BodySources, ...]  # the sources of states, for each body
    static_topic: ConfiguredTopic | None  # of static transforms
    world_frame: str
    state_timeout: float  # s, largest age of the latest state
    state_history: float  # s, length of the history of states
    future_tolerance: float  # s, largest lead of a stamp over the node's clock
    max_states: int  # largest number of stored states of a body
    fault_limits: FaultLimits  # limits for warnings about topics
    client_gone_for: float  # s, how long old requests of a lost client are dropped
    defaults: Defaults  # defaults of fields that a request leaves out
    worker_limits: WorkerLimits  # limits of the worker processes
    autostart: bool  # whether the node configures and activates itself at its start
    log: bool
    log_directory: str
    log_before_answer: bool  # whether a response is sent only once it is on the disk
    log_limits: LogLimits  # how the log is cut into files, and which of them are kept


@cache
def described_server_parameters() -> tuple[DeclaredParameter, ...]:
    """Return the parameters of a server with a body NAME and a surface NAME, without values if required."""
    source = ParameterSource(
        {
            "bodies": ["NAME"],
            "surfaces": ["NAME"],
            "body.NAME.mass": 1.0,
            "body.NAME.sphere": [1.0],
            "surface.NAME.friction": 0.0,
            "surface.NAME.restitution": 0.0,
        }
    )
    _read_parameters(source, *_read_names(source))
    defaults = {"body.NAME.sphere": [0.0]}
    return tuple(
        each._replace(value=defaults.get(name)) if name in source.values else each
        for name, each in source.read.items()
    )


def _known_names(body_names: Iterable[str], surface_names: Iterable[str], parts: Iterable[str]) -> set[str]:
    """Return the names of all parameters of a server with these bodies, surfaces and parts of bodies."""
    named = {"body.NAME.": [f"body.{name}." for name in body_names]}
    named["surface.NAME."] = [f"surface.{name}." for name in surface_names]
    known = {each.name for each in described_server_parameters()}
    for placeholder, prefixes in named.items():
        leaves = {name.removeprefix(placeholder) for name in known if name.startswith(placeholder)}
        known |= {prefix + leaf for prefix in prefixes for leaf in leaves}
    return known | {f"{part}.{leaf}" for part in parts for leaf in SHAPE_PARAMETERS}


def read_server_parameters(source: ParameterSource) -> ServerParameters:
    """Read all parameters.

    Raise `ConfigurationError`, which names the parameter, if one is missing, of another type, or not allowed.
    """
    body_names, surface_names = _read_names(source)
    listed = {name: source.values.get(f"body.{name}.{PARTS}") for name in body_names}
    parts = [
        f"body.{name}.{part}" for name, found in listed.items() if isinstance(found, list) for part in found
    ]
    source.refuse_unknown(_known_names(body_names, surface_names, parts))
    parameters = _read_parameters(source, body_names, surface_names)
    source.refuse_unknown_overrides()
    return parameters


def _read_names(source: ParameterSource) -> tuple[list[str], list[str]]:
    bodies = source.names("bodies", "Names of the configured bodies.")
    return bodies, source.names("surfaces", "Names of the surfaces: planes and obstacles.")


def _read_parameters(
    source: ParameterSource, body_names: Sequence[str], surface_names: Sequence[str]
) -> ServerParameters:
    bodies = [read_body(source, name) for name in body_names]
    gravity = source.value(
        "gravity", list(STANDARD_GRAVITY_W), "Acceleration of gravity, m/s^2, world axes: x, y, z."
    )
    is_logged = source.value(
        "log", default=True, description="Log every state, request and response to MCAP."
    )

    surfaces = [read_surface(source, name, among=body_names) for name in surface_names]

    def build_world() -> World:
        world = World(
            bodies=tuple(body for body, _ in bodies),
            surfaces=tuple(each for each in surfaces if not isinstance(each, CarriedSurface)),
            gravity_W=gravity,
        )
        check_vector("gravity", world.gravity_W)
        return world

    return ServerParameters(
        world=source.build("", build_world),
        carried=tuple(each for each in surfaces if isinstance(each, CarriedSurface)),
        sources=tuple(sources for _, sources in bodies),
        static_topic=source.topic(
            "tf_static_topic", "Topic of tf2_msgs/TFMessage with static transforms. Not used if empty."
        ),
        world_frame=source.name("world_frame", "world", "Frame of states and responses."),
        state_timeout=source.value("state_timeout", 0.5, "Largest age of the latest state, s.", (1e-3, 1e6)),
        state_history=source.value("state_history", 5.0, "Length of the history of states, s.", (0.0, 1e4)),
        future_tolerance=source.value(
            "future_tolerance",
            FUTURE_TOLERANCE,
            "Largest lead of a state's stamp over the node's clock, s. States further ahead are rejected.",
            (0.0, 1e6),
        ),
        max_states=source.value(
            "max_states", MAX_STATES, "Largest number of states kept for a body.", (1, 10_000_000)
        ),
        fault_limits=source.filled(
            FaultLimits(),
            warn_every=("Shortest time between two warnings of the same kind about a topic, s.", (0.0, 1e6)),
            silent_after=("Time without a message after which a topic counts as silent, s.", (0.1, 1e6)),
        ),
        client_gone_for=source.value(
            "client_gone_for", 1.0, "How long to drop old requests of a lost client, s.", (0.0, 3600.0)
        ),
        defaults=source.filled(
            Defaults(),
            velocity_tolerance=("Speed below which a contact counts as at rest, m/s.", (0.0, 1e3)),
            distance_tolerance=(
                "Gap below which a body counts as touching, and largest accepted penetration, m.",
                (0.0, 1e3),
            ),
            out_of_plane_tolerance=(
                "Largest motion out of the plane that counts as planar, m/s.",
                (0.0, 1e3),
            ),
            horizon=("Look-ahead time for a first contact, s.", (0.0, 1e4)),
            rate=("Sample rate of trajectories, Hz.", (1e-6, 1e6)),
            max_extrapolation=(
                "Longest time by which the motion of a carried surface is extrapolated, s.",
                (0.0, 1e3),
            ),
        ),
        worker_limits=source.filled(
            WorkerLimits(),
            {"count": "workers", "deadline": "answer_deadline", "memory": "worker_memory"},
            count=(
                "Number of processes for expensive requests. With 0, the server processes them itself.",
                (0, 64),
            ),
            deadline=("Time limit for a request that is sent to a worker, s.", (0.01, 3600.0)),
            memory=("Memory limit of a worker, MB.", (100, 1_000_000)),
            max_waiting=("Largest number of queued requests.", (0, 1000)),
        ),
        autostart=source.value(
            "autostart",
            default=True,
            description="Whether the node configures and activates itself when it starts.",
        ),
        log=is_logged,
        log_directory=source.value(
            "log_directory",
            "",
            "Parent folder of the log's folder. An empty text means the working directory.",
        ),
        log_before_answer=_read_log_before_answer(source, is_logged=is_logged),
        log_limits=_read_log_limits(source),
    )


def _read_log_before_answer(source: ParameterSource, *, is_logged: bool) -> bool:
    is_before: bool = source.value(
        "log_before_answer",
        default=False,
        description="Whether a response is sent only once it is on the disk, with its request and states.",
    )
    if is_before and not is_logged:
        raise ConfigurationError("log_before_answer must be false where log is false, got true")
    return is_before


def _read_log_limits(source: ParameterSource) -> LogLimits:
    names = [each.value for each in Compression]
    allowed = ", ".join(names)
    compression = source.value(
        "log_compression", Compression.ZSTD.value, f"Compression of the log: {allowed}."
    )
    if compression not in names:
        raise ConfigurationError(f"log_compression must be one of {allowed}, got {compression!r}")
    least = LEAST_FILE_BYTES / MEGABYTE
    file_size = source.zero_or(
        "log_file_size",
        1000.0,
        "Size limit of a file of the log, MB. 0 means no limit.",
        (least, 1e8),
        unit="MB",
    )
    file_duration = source.zero_or(
        "log_file_duration",
        1800.0,
        "Duration of a file of the log, s. 0 means no limit.",
        (LEAST_FILE_SECONDS, 1e8),
        unit="s",
    )
    size_limit = source.zero_or(
        "log_size_limit",
        0.0,
        "Size limit of the log, above which its oldest files are deleted, MB. 0 means no limit.",
        (FILES_KEPT * (file_size or least), 1e8),
        unit="MB",
    )
    if size_limit is not None and file_size is None:
        raise ConfigurationError(f"log_size_limit must be 0 where log_file_size is 0, got {size_limit:g} MB")
    return LogLimits(
        compression=Compression(compression),
        file_bytes=_bytes(file_size),
        file_seconds=file_duration,
        kept_bytes=_bytes(size_limit),
    )


def _bytes(megabytes: float | None) -> int | None:
    return None if megabytes is None else round(MEGABYTE * megabytes)


_FIXED: Final = {
    "world_frame": "world_frame",
    "static_topic": "tf_static_topic",
    "log": "log",
    "log_before_answer": "log_before_answer",
    "log_directory": "log_directory",
    "log_limits": "log_compression, log_file_size, log_file_duration, log_size_limit",
}
"""The fields that remain while a node is configured, with their parameters."""


def check_change(before: ServerParameters, after: ServerParameters, others: Iterable[str] = ()) -> None:
    """Raise `ConfigurationError` if parameters differ that remain while a node is configured.

    The message contains their names. Further such names are ``others``.
    """
    changed = [names for field, names in _FIXED.items() if getattr(before, field) != getattr(after, field)]
    changed += others
    if before.worker_limits.count != after.worker_limits.count:
        changed.append("workers")
    if before.worker_limits.memory != after.worker_limits.memory:
        changed.append("worker_memory")
    then, now = _topics(before), _topics(after)
    changed += [
        f"the topics of body.{name}" for name in sorted({*then, *now}) if then.get(name) != now.get(name)
    ]
    if changed:
        raise ConfigurationError(
            f"{', '.join(changed)} must be changed after the lifecycle transition 'cleanup' and before "
            "'configure', got a change while the node is configured"
        )


def bodies_read_otherwise(before: ServerParameters, after: ServerParameters) -> tuple[str, ...]:
    """Return the bodies whose messages now result in other states, or in none."""
    then, now = _readings(before), _readings(after)
    return tuple(name for name in then if then[name] != now.get(name))


def _topics(parameters: ServerParameters) -> dict[str, object]:
    return {body.body_name: body.sources for body in parameters.sources if body.sources}


def _readings(parameters: ServerParameters) -> dict[str, tuple[BodySources, tuple[float, ...]]]:
    world = parameters.world
    return {
        body.body_name: (body, tuple(world.body(body.body_name).p_FB_F.tolist()))
        for body in parameters.sources
    }
