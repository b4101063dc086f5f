# SPDX-License-Identifier: Apache-2.0
"""What a change of the configuration may change while the server serves, and what it means for its states.

Bodies, surfaces, gravity, tolerances and most limits may change at any time. Topics, the log and the worker
processes stay as they are for as long as the node is configured. This file imports no ROS.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from contact_dynamics.nodes.parameter_reader import ConfigurationError

if TYPE_CHECKING:
    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.nodes.world_parameters import BodySources

_FIXED: Final = {
    "world_frame": "world_frame",
    "static_topic": "tf_static_topic",
    "self_check_period": "self_check_period",
    "log": "log",
    "log_before_answer": "log_before_answer",
    "log_directory": "log_directory",
    "log_limits": "log_compression, log_file_size, log_file_duration, log_size_limit",
}
"""The fields of the configuration that stay, with the parameters that they come from."""

CONFIGURED_ANEW: Final = "the body was configured anew"
"""Why the states of a body are forgotten, live and where a log is replayed."""


def check_change(before: ServerParameters, after: ServerParameters) -> None:
    """Refuse a change of what stays as long as the server is configured.

    Raises:
        ConfigurationError: something of it differs. The message names the parameters.
    """
    changed = [names for field, names in _FIXED.items() if getattr(before, field) != getattr(after, field)]
    if before.worker_limits.count != after.worker_limits.count:
        changed.append("workers")
    if before.worker_limits.memory != after.worker_limits.memory:
        changed.append("worker_memory")
    then, now = _topics(before), _topics(after)
    changed += [
        f"the topics of body.{name}" for name in sorted({*then, *now}) if then.get(name) != now.get(name)
    ]
    if changed:
        message = (
            f"{', '.join(changed)} must be changed after the lifecycle transition 'cleanup' and before "
            "'configure', got a change while the server is configured"
        )
        raise ConfigurationError(message)


def bodies_read_otherwise(before: ServerParameters, after: ServerParameters) -> tuple[str, ...]:
    """Return the bodies whose messages make other states than before, or none any more."""
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
