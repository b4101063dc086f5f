"""The server's parameters. Each is declared once, with its description and range, and read into domain types.

Users edit the commented file `config/server.yaml`. A test checks that both have the same parameters.

This file imports no ROS. The values come from a `ParameterSource`: a node (`node_parameters`), or the log of
a run that is over (`run_record`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

from contact_dynamics.constants import STANDARD_GRAVITY_W
from contact_dynamics.errors import ContactDynamicsError, InvalidFieldError
from contact_dynamics.nodes.body_shapes import DESCRIPTIONS, ShapeParameters
from contact_dynamics.questions.knowledge import Defaults
from contact_dynamics.questions.state_store import FUTURE_TOLERANCE
from contact_dynamics.questions.workers import WorkerLimits
from contact_dynamics.recording.limits import Compression, LogLimits
from contact_dynamics.rigid_body.body import MassProperties
from contact_dynamics.shapes.obstacle import Obstacle
from contact_dynamics.validation import check_array, check_positive
from contact_dynamics.world import Body, Surface, World

if TYPE_CHECKING:
    from collections.abc import Callable

T = TypeVar("T")


class ConfigurationError(ContactDynamicsError):
    """A parameter is missing or not allowed. The message names it."""


class ParameterSource(Protocol):
    """A source of the values of parameters."""

    def value(
        self, name: str, default: Any, description: str, bounds: tuple[float, float] | None = None
    ) -> Any:
        """Return a parameter's value, which has the type of the default.

        Args:
            name: the name of the parameter.
            default: its value if none is given. A type, `float` or `list`, makes the parameter mandatory.
            description: what it means, for people.
            bounds: least and greatest value.

        Raises:
            ConfigurationError: there is no value, or it has another type or is out of bounds.
        """

    def resolved_topic(self, name: str, topic: str) -> str:
        """Return the full name of the topic that a parameter names.

        Raises:
            ConfigurationError: the name is not that of a topic.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfiguredTopic:
    """A topic as it is configured.

    Attributes:
        name: Its name in the configuration.
        full_name: Its name after ROS's remapping.
        parameter: The parameter that names it.
    """

    name: str
    full_name: str
    parameter: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ConfiguredSource:
    """A source of a body's states.

    Attributes:
        adapter: The name of the adapter that reads its messages.
        topics: Its topics, in the adapter's order.
    """

    adapter: str
    topics: tuple[ConfiguredTopic, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class BodySources:
    """The sources of a body's states.

    Attributes:
        body_name: The body.
        frame: The body's frame, whose pose is published.
        velocity_window: s, the time over which a velocity is found from poses.
        sources: The sources, of which there may be several or none.
    """

    body_name: str
    frame: str
    velocity_window: float
    sources: tuple[ConfiguredSource, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ServerParameters:
    """The whole configuration of the server.

    Attributes:
        sources: The sources of states, for each body.
        static_topic: The topic of the transforms between frames that stand still, or None.
        state_timeout: s.
        state_history: s.
        future_tolerance: s.
        defaults: What holds where a question says nothing.
        autostart: Whether the node configures and activates itself at its start.
        worker_limits: What the processes may take that answer what takes long.
        log_limits: How the log is cut into files, and which of them are kept.
    """

    world: World
    sources: tuple[BodySources, ...]
    static_topic: ConfiguredTopic | None
    world_frame: str
    state_timeout: float
    state_history: float
    future_tolerance: float
    defaults: Defaults
    worker_limits: WorkerLimits
    autostart: bool
    log: bool
    log_directory: str
    log_limits: LogLimits


def read_server_parameters(source: ParameterSource) -> ServerParameters:
    """Read every parameter.

    Raises:
        ConfigurationError: a parameter is missing, has another type, or a value that is not allowed. The
            message names it.
    """
    reader = _Reader(source)
    body_names = reader.names("bodies", "Names of the bodies that questions can name.")
    surface_names = reader.names("surfaces", "Names of the flats and obstacles of the world.")
    bodies = [_read_body(reader, name) for name in body_names]
    gravity = reader.read(
        "gravity", list(STANDARD_GRAVITY_W), "Acceleration of gravity, m/s^2, world axes: x, y, z."
    )
    return ServerParameters(
        world=reader.build(
            "",
            lambda: World(
                bodies=tuple(body for body, _ in bodies),
                surfaces=tuple(_read_surface(reader, name) for name in surface_names),
                gravity_W=gravity,
            ),
        ),
        sources=tuple(sources for _, sources in bodies),
        static_topic=reader.topic(
            "tf_static_topic",
            "Topic of tf2_msgs/TFMessage with the transforms between frames that stand still. Not used if "
            "empty.",
        ),
        world_frame=reader.read(
            "world_frame", "world", "Frame that states are published in and answers are given in."
        ),
        state_timeout=reader.read(
            "state_timeout",
            0.5,
            "How old the newest state may be, s, for a question about now.",
            (1e-3, 1e6),
        ),
        state_history=reader.read(
            "state_history", 5.0, "How long states are kept for questions about the past, s.", (0.0, 1e4)
        ),
        future_tolerance=reader.read(
            "future_tolerance",
            FUTURE_TOLERANCE,
            "How far a state's stamp may be ahead of the node's clock, s. A state farther ahead is refused.",
            (0.0, 1e6),
        ),
        defaults=_read_defaults(reader),
        worker_limits=_read_worker_limits(reader),
        autostart=reader.read(
            "autostart",
            default=True,
            description="Whether the node configures and activates itself at its start.",
        ),
        log=reader.read("log", default=True, description="Log every state, request and response to MCAP."),
        log_directory=reader.read(
            "log_directory", "", "Folder for the log's folder. If empty, this is where the server starts."
        ),
        log_limits=_read_log_limits(reader),
    )


def _read_log_limits(reader: _Reader) -> LogLimits:
    names = [each.value for each in Compression]
    allowed = ", ".join(names)
    compression = reader.read("log_compression", Compression.ZSTD.value, f"How the log is packed: {allowed}.")
    if compression not in names:
        message = f"log_compression: found {compression!r}, allowed is one of {allowed}"
        raise ConfigurationError(message)
    file_size = reader.read(
        "log_file_size", 1000.0, "Size at which a file of the log is finished, MB. 0: no limit.", (0.0, 1e8)
    )
    file_duration = reader.read(
        "log_file_duration",
        1800.0,
        "Time after which a file of the log is finished, s. 0: no limit.",
        (0.0, 1e8),
    )
    size_limit = reader.read(
        "log_size_limit",
        0.0,
        "Size of all files of the log above which the oldest are deleted, MB. 0: none is deleted.",
        (0.0, 1e8),
    )
    try:
        return LogLimits(
            compression=Compression(compression),
            file_bytes=_bytes(file_size),
            file_seconds=file_duration or None,
            kept_bytes=_bytes(size_limit),
        )
    except InvalidFieldError as error:
        message = f"log_file_size, log_file_duration, log_size_limit (as bytes and seconds): {error}"
        raise ConfigurationError(message) from None


def _bytes(megabytes: float) -> int | None:
    return round(1e6 * megabytes) or None


def _read_worker_limits(reader: _Reader) -> WorkerLimits:
    default = WorkerLimits()
    return WorkerLimits(
        count=reader.read(
            "workers",
            default.count,
            "Processes that answer questions that take long. With 0, the server answers them itself.",
            (0, 64),
        ),
        deadline=reader.read(
            "answer_deadline", default.deadline, "How long an answer of a worker may take, s.", (0.01, 3600.0)
        ),
        memory=reader.read(
            "worker_memory",
            default.memory,
            "Memory that a worker may take for an answer, MB.",
            (100, 1_000_000),
        ),
        most_waiting=reader.read(
            "most_waiting",
            default.most_waiting,
            "Questions that may wait while all workers are busy.",
            (0, 1000),
        ),
    )


def _read_defaults(reader: _Reader) -> Defaults:
    default = Defaults()
    return Defaults(
        velocity_tolerance=reader.read(
            "velocity_tolerance",
            default.velocity_tolerance,
            "Speed below which a contact counts as at rest, m/s.",
            (0.0, 1e3),
        ),
        distance_tolerance=reader.read(
            "distance_tolerance",
            default.distance_tolerance,
            "Gap below which a body counts as touching, m.",
            (0.0, 1e3),
        ),
        out_of_plane_tolerance=reader.read(
            "out_of_plane_tolerance",
            default.out_of_plane_tolerance,
            "Motion out of the plane that still counts as planar, m/s.",
            (0.0, 1e3),
        ),
        horizon=reader.read(
            "horizon", default.horizon, "How far ahead a first contact is looked for, s.", (0.0, 1e4)
        ),
        rate=reader.read("rate", default.rate, "Samples a second of trajectories, Hz.", (1e-6, 1e6)),
    )


def _read_body(reader: _Reader, name: str) -> tuple[Body, BodySources]:
    key = f"body.{name}"
    mass = reader.read(f"{key}.mass", float, "Mass, kg.")
    inertia = reader.read(
        f"{key}.inertia",
        list,
        "Angular inertia about the centre of mass, kg m^2, in the axes of the body's frame: "
        "ixx, iyy, izz, ixy, ixz, iyz. [0.0]: of a mass that fills the shape evenly.",
    )
    offset = reader.read(
        f"{key}.center_of_mass", [0.0, 0.0, 0.0], "Centre of mass in the body's frame, m: x, y, z."
    )
    shape = _read_shape(reader, key)
    body = reader.build(key, lambda: _body(name, mass, inertia, offset, shape))
    return body, BodySources(
        body_name=name,
        frame=reader.read(f"{key}.frame", name, "Frame of the body, which the pose is of."),
        velocity_window=reader.read(
            f"{key}.velocity_window",
            0.05,
            "Time over which a velocity is found where poses alone are published, s.",
            (1e-3, 10.0),
        ),
        sources=_read_sources(reader, key),
    )


def _read_sources(reader: _Reader, key: str) -> tuple[ConfiguredSource, ...]:
    """Return the sources of a body's states: the usual ones, each by its topics, and one by its name."""
    odometry = reader.topic(
        f"{key}.odometry_topic", "Topic of the body's states as nav_msgs/Odometry. Not used if empty."
    )
    pose = reader.topic(
        f"{key}.pose_topic", "Topic of the body's geometry_msgs/PoseStamped. Not used if empty."
    )
    twist = reader.topic(
        f"{key}.twist_topic",
        "Topic of the body's geometry_msgs/TwistStamped. If empty, velocities come from the poses.",
    )
    if twist is not None and pose is None:
        message = f"{key}.twist_topic: found {twist.name!r}, allowed is none without a pose_topic"
        raise ConfigurationError(message)
    name = reader.read(f"{key}.source", "", "Name of another source of states. Not used if empty.")
    topics = reader.topics(f"{key}.source_topics", "Topics of that source.")
    if bool(name) != bool(topics):
        found = f"{name!r} and {[topic.name for topic in topics]}"
        message = f"{key}.source and {key}.source_topics: found {found}, allowed are both or none"
        raise ConfigurationError(message)
    sources = []
    if odometry is not None:
        sources.append(ConfiguredSource(adapter="odometry", topics=(odometry,)))
    if pose is not None and twist is None:
        sources.append(ConfiguredSource(adapter="pose", topics=(pose,)))
    if pose is not None and twist is not None:
        sources.append(ConfiguredSource(adapter="pose_twist", topics=(pose, twist)))
    if name:
        sources.append(ConfiguredSource(adapter=name, topics=topics))
    return tuple(sources)


def _body(name: str, mass: float, inertia: list[float], offset: list[float], shape: ShapeParameters) -> Body:
    center_of_mass = check_array("center_of_mass", offset, (3,))
    shape_F = shape.shape_F()
    if inertia == [0.0]:
        uniform = shape.uniform(check_positive("mass", mass))
        if center_of_mass.any():
            raise InvalidFieldError("center_of_mass", offset, "the origin, where the inertia is the shape's")
        center_of_mass, mass_properties = uniform.p_FB_F, uniform.mass_properties
    elif len(inertia) == 6:
        ixx, iyy, izz, ixy, ixz, iyz = inertia
        mass_properties = MassProperties(mass=mass, I_B=[[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]])
    else:
        allowed = "6 (ixx, iyy, izz, ixy, ixz, iyz), or [0.0]: of the shape"
        raise InvalidFieldError("inertia", f"{len(inertia)} numbers", allowed)
    return Body(
        name=name,
        mass_properties=mass_properties,
        p_FB_F=center_of_mass,
        shape=shape_F.moved(-center_of_mass),
    )


def _read_shape(reader: _Reader, key: str) -> ShapeParameters:
    return ShapeParameters(
        numbers={name: reader.read(f"{key}.{name}", [0.0], text) for name, text in DESCRIPTIONS.items()},
        rounding=reader.read(
            f"{key}.rounding", 0.0, "Radius of a ball that rolls over the shape, m.", (0.0, 1e3)
        ),
        position=reader.read(
            f"{key}.shape_position", [0.0, 0.0, 0.0], "Where the shape is in the body's frame, m: x, y, z."
        ),
        orientation=reader.read(
            f"{key}.shape_orientation",
            [0.0, 0.0, 0.0, 1.0],
            "How the shape is turned in the body's frame: unit quaternion x, y, z, w.",
        ),
    )


def _read_surface(reader: _Reader, name: str) -> Surface | Obstacle:
    key = f"surface.{name}"
    point = reader.read(
        f"{key}.point", [0.0, 0.0, 0.0], "A point of the flat, or the centre of the box, m, world: x, y, z."
    )
    normal = reader.read(
        f"{key}.normal", [0.0, 0.0, 1.0], "Unit normal into the free side, world axes: x, y, z."
    )
    shape = ShapeParameters(
        numbers={
            "box": reader.read(f"{key}.box", [0.0], "Full side lengths of a box, m: x, y, z."),
            "vertices": reader.read(
                f"{key}.vertices", [0.0], "Corners of a convex solid or plate, from the point, m: x, y, z."
            ),
        },
        rounding=0.0,
        position=point,
        orientation=reader.read(
            f"{key}.orientation",
            [0.0, 0.0, 0.0, 1.0],
            "How box or corners are turned: unit quaternion x, y, z, w.",
        ),
        pose_names=("point", "orientation"),
    )
    friction = reader.read(f"{key}.friction", float, "Coulomb's friction coefficient with any body, >= 0.")
    restitution = reader.read(
        f"{key}.restitution", float, "Coefficient of restitution with any body, 0 to 1."
    )

    def build() -> Surface | Obstacle:
        solid = shape.shape_F()
        if not solid.is_empty:
            return Obstacle(name=name, vertices_W=solid.vertices, friction=friction, restitution=restitution)
        return Surface(
            name=name,
            p_WS_W=point,
            normal_W=normal,
            friction=friction,
            restitution=restitution,
        )

    return reader.build(key, build)


class _Reader:
    """Reads parameters from a source. Every mistake becomes a `ConfigurationError`."""

    def __init__(self, source: ParameterSource) -> None:
        self._source = source
        self.read = source.value
        self._topics: dict[str, str] = {}  # the parameter of each topic, by the topic's full name

    def names(self, name: str, description: str) -> list[str]:
        """Return the names in a list without empty ones, which stand for none."""
        found = [each for each in self.read(name, [""], description) if each]
        if len(set(found)) < len(found):
            message = f"{name}: found {found}, allowed are names that differ"
            raise ConfigurationError(message)
        return found

    def topic(self, name: str, description: str) -> ConfiguredTopic | None:
        """Return a topic that no other parameter names, or None if there is none."""
        topic: str = self.read(name, "", description)
        if not topic:
            return None
        found = self._configured(name, topic)
        if found.full_name in self._topics:
            message = (
                f"{name}: found {topic!r}, allowed is another topic than that of "
                f"{self._topics[found.full_name]}"
            )
            raise ConfigurationError(message)
        self._topics[found.full_name] = name
        return found

    def topics(self, name: str, description: str) -> tuple[ConfiguredTopic, ...]:
        """Return the topics of a list, which several bodies may share."""
        return tuple(
            self._configured(f"{name}[{i}]", topic) for i, topic in enumerate(self.names(name, description))
        )

    def _configured(self, parameter: str, topic: str) -> ConfiguredTopic:
        full_name = self._source.resolved_topic(parameter, topic)
        return ConfiguredTopic(name=topic, full_name=full_name, parameter=parameter)

    @staticmethod
    def build(prefix: str, make: Callable[[], T]) -> T:
        """Return what ``make`` builds. A field that it refuses is named as the parameter ``prefix.field``."""
        try:
            return make()
        except InvalidFieldError as error:
            message = f"{prefix}.{error}" if prefix else str(error)
            raise ConfigurationError(message) from None
