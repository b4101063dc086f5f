# SPDX-License-Identifier: Apache-2.0
"""The sources of published states: topics, and the conversion of their messages to states, live or logged.

Each source has an adapter in `msg_adapters`. Installed packages can provide others by entry points of the
group `ENTRY_POINTS`. This file requires the classes of messages, and no other part of ROS.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.nodes.parameter_reader import ConfigurationError
from contact_dynamics.questions.extent import check_believable
from contact_dynamics.questions.uncertain_state import state_of, with_deviations
from msg_adapters.odometry import ODOMETRY
from msg_adapters.pose import POSE, POSE_WITH_COVARIANCE, RIGID_BODIES, TF
from msg_adapters.pose_twist import POSE_TWIST, POSE_TWIST_WITH_COVARIANCE
from msg_adapters.state_adapter import SourceSettings, StateAdapter
from msg_adapters.transforms import TransformTree

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from contact_dynamics.nodes.parameter_reader import ConfiguredTopic
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.nodes.world_parameters import BodySources, ConfiguredSource
    from contact_dynamics.questions.uncertain_state import KnownState
    from msg_adapters.state_adapter import Reader, StateRows
    from msg_adapters.transforms import TFMessage

ENTRY_POINTS: Final = "contact_dynamics.state_sources"
"""Group of the entry points for adapters of other packages."""

ADAPTERS: Final[Mapping[str, StateAdapter]] = {
    "odometry": ODOMETRY,
    "pose_twist": POSE_TWIST,
    "pose_twist_with_covariance": POSE_TWIST_WITH_COVARIANCE,
    "pose": POSE,
    "pose_with_covariance": POSE_WITH_COVARIANCE,
    "tf": TF,
    "rigid_bodies": RIGID_BODIES,
}
"""The adapters of this package, by their names in configurations."""

STATIC_TYPE: Final = "tf2_msgs/msg/TFMessage"


class BodyReader(NamedTuple):
    """The reader of the messages about one body."""

    body_name: str
    # Function from a message to a state, or to None if another message must complete it, or if it contains
    # no state of this body
    state_from: Reader

    def believable(self, msg: object) -> KnownState | None:
        """Return the result of `state_from`.

        Raise `ContactDynamicsError` if the message or its state (`check_believable`) is rejected.
        """
        state = self.state_from(msg)
        if state is not None:
            check_believable(state_of(state))
        return state


@dataclass(frozen=True, slots=True, kw_only=True)
class StateSource:
    """One topic with messages about bodies, or about the frames that their states are in."""

    topic: str  # the configured name
    full_name: str  # after ROS's remapping
    type_name: str  # "package/msg/Name"
    readers: tuple[BodyReader, ...]  # one for each body, which reads every message
    is_latched: bool = False  # whether later subscribers receive the last messages
    # Whether each message is a complete state, stamped by its leading header, so it can be decoded later or
    # never
    is_whole: bool = False
    is_of_one_body: bool = False  # whether each message is about one body, whatever its name
    # Makes the states of many messages about its one body, as `StateAdapter` says, or None
    rows: Callable[[Any], StateRows | None] | None = None


def no_message(data: bytes, type_name: str) -> InvalidFieldError:
    """Return the error for bytes that are no message of a type, for a topic or a log."""
    return InvalidFieldError("data", f"{len(data)} bytes", f"a serialised {type_name}")


def expected(body: BodySources, publishers: int | None = None) -> str:
    """Return the text of NO_STATE for a body: the topics of its states, and the alternatives.

    The number of their ``publishers`` is None in the replay of a log, where it is unknown and not compared.
    """
    topics = " and ".join(dict.fromkeys(topic.full_name for each in body.sources for topic in each.topics))
    instead = "or set state_source: 1 (STATE_EXPLICIT) and provide the field state"
    if not topics:
        return f"no topic is configured for its states; set body.{body.body_name}.odometry_topic, {instead}"
    count = "" if publishers is None else f" ({publishers} publisher{'s' * (publishers != 1)})"
    return f"none has been received on {topics}{count}; publish states there, {instead}"


def adapter_of(name: str, *, parameter: str) -> StateAdapter:
    """Return the adapter of a name, of this package or of an installed one.

    Raise `ConfigurationError`, about the ``parameter`` with the name, if there is none, or if the entry point
    is no adapter.
    """
    if name in ADAPTERS:
        return ADAPTERS[name]
    brought = {point.name: point for point in entry_points(group=ENTRY_POINTS)}
    if name not in brought:
        known = ", ".join([*ADAPTERS, *sorted(brought)])
        raise ConfigurationError(f"{parameter} must be one of {known}, got {name!r}")
    try:
        adapter = brought[name].load()
    except Exception as error:  # noqa: BLE001  whatever a foreign module raises when it is imported
        raise ConfigurationError(
            f"{parameter} must name an adapter, got {name!r}, which cannot be imported: "
            f"{type(error).__name__}: {error}"
        ) from None
    if not isinstance(adapter, StateAdapter):
        message = f"{parameter} must be a StateAdapter, got {name!r}, which is a {type(adapter).__name__}"
        raise ConfigurationError(message)
    return adapter


def state_sources(parameters: ServerParameters, *, static: TransformTree) -> tuple[StateSource, ...]:
    """Return the topics of states, each once. The static transforms on their topic are added to ``static``.

    Raises:
        ConfigurationError: an adapter does not exist or takes another number of topics, the sources of a
            topic differ in its type, or two bodies share their messages.
    """
    found: dict[str, StateSource] = {}
    by_frame: dict[tuple[str, str], str] = {}
    if parameters.static_topic is not None:
        _add(found, _static_source(parameters.static_topic, static), parameters.static_topic.parameter)
    for body in parameters.sources:
        settings = SourceSettings(
            body_name=body.body_name,
            body_frame=body.frame,
            world_frame=parameters.world_frame,
            p_FB_F=parameters.world.body(body.body_name).p_FB_F,
            velocity_window=body.velocity_window,
            static=static,
        )
        for configured in body.sources:
            made = _of_body(configured, settings, body.state_deviations)
            for source, topic in zip(made, configured.topics, strict=True):
                _add(found, source, topic.parameter)
                other = by_frame.setdefault((topic.full_name, body.frame), body.body_name)
                if other != body.body_name:
                    raise ConfigurationError(
                        f"body.{body.body_name}.frame must be another frame than that of body.{other}, which "
                        f"shares the topic {topic.name!r}, got {body.frame!r}"
                    )
    return tuple(found.values())


def _with_deviations(reader: Reader, deviations: tuple[float, ...]) -> Reader:
    """Return a reader whose states have a covariance."""

    def read(msg: object) -> KnownState | None:
        known = reader(msg)
        return None if known is None else with_deviations(known, deviations)

    return read if deviations else reader


def _of_body(
    configured: ConfiguredSource, settings: SourceSettings, deviations: tuple[float, ...]
) -> tuple[StateSource, ...]:
    parameter = f"body.{settings.body_name}.source"
    adapter = adapter_of(configured.adapter, parameter=parameter)
    if len(configured.topics) != len(adapter.type_names):
        found = [topic.name for topic in configured.topics]
        allowed = f"{len(adapter.type_names)}, of {' and '.join(adapter.type_names)}"
        raise ConfigurationError(f"{parameter}_topics must be {allowed}, got {found}")
    return tuple(
        StateSource(
            topic=topic.name,
            full_name=topic.full_name,
            type_name=type_name,
            readers=(BodyReader(settings.body_name, _with_deviations(reader, deviations)),),
            is_whole=adapter.is_whole,
            is_of_one_body=adapter.is_of_one_body,
            rows=None if adapter.rows is None or deviations else partial(adapter.rows, settings),
        )
        for topic, type_name, reader in zip(
            configured.topics, adapter.type_names, adapter.readers(settings), strict=True
        )
    )


def _static_source(topic: ConfiguredTopic, static: TransformTree) -> StateSource:
    def read(msg: TFMessage) -> None:
        static.add(msg, is_static=True)

    return StateSource(
        topic=topic.name,
        full_name=topic.full_name,
        type_name=STATIC_TYPE,
        readers=(BodyReader("", read),),
        is_latched=True,
    )


def _add(found: dict[str, StateSource], source: StateSource, parameter: str) -> None:
    """Add a source, to the one of the same topic if there is one already."""
    known = found.get(source.full_name)
    if known is None:
        found[source.full_name] = source
        return
    if (known.type_name, known.is_latched) != (source.type_name, source.is_latched):
        raise ConfigurationError(
            f"{parameter} must be another topic than that of {known.type_name}, got {source.topic!r} for "
            f"{source.type_name}"
        )
    if known.is_of_one_body or source.is_of_one_body:
        raise ConfigurationError(
            f"{parameter} must be another topic than that of the states of "
            f"body.{known.readers[0].body_name}, since each message there is about one body, "
            f"got {source.topic!r}"
        )
    found[source.full_name] = replace(known, readers=(*known.readers, *source.readers))
