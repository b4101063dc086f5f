# SPDX-License-Identifier: Apache-2.0
"""The core of a server without ROS: its configuration, its states and their sources, and the present time.

The node (`server`), the replay of its log (`replay.again`) and the visualizer share it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from contact_dynamics.nodes.parameters import bodies_read_otherwise
from contact_dynamics.nodes.state_sources import expected, state_sources
from contact_dynamics.questions.context import Context
from contact_dynamics.questions.state_store import StateStore
from msg_adapters.transforms import TransformTree

if TYPE_CHECKING:
    from collections.abc import Mapping

    from contact_dynamics.nodes.parameters import ServerParameters
    from contact_dynamics.nodes.state_sources import StateSource
    from contact_dynamics.questions.services import Answer, Question, Service
    from contact_dynamics.world import World


class ServerCore:
    """The configuration of a server, and the context of its answers.

    Attributes:
        parameters: The configuration.
        states: The published states.
        sources: The topics of states, by their full names.
        context: The context of questions, which a change replaces.
        asked_ns: Time of arrival of the present question, ns on the clock of the states, or zero if it is
            unknown, such as before the first time of a simulation.
    """

    def __init__(self, parameters: ServerParameters, states: StateStore | None = None) -> None:
        """Begin without states. They are stored in ``states`` if it is given.

        Raise `ConfigurationError` if a source of states is missing or invalid (`state_sources`).
        """
        self.parameters = parameters
        self.asked_ns = 0
        self.states = states or StateStore(history=0.0, timeout=0.0)
        self.context = Context(
            world=parameters.world,
            states=self.states,
            defaults=parameters.defaults,
            now_ns=lambda: self.asked_ns or None,
            carried=parameters.carried,
        )
        self._static = TransformTree()
        self.sources: dict[str, StateSource] = {}
        self._limit_states()
        self._find_sources()

    @property
    def world(self) -> World:
        """The current bodies and surfaces."""
        return self.parameters.world

    def change(self, parameters: ServerParameters) -> None:
        """Continue with another configuration, which `check_change` allows."""
        before, self.parameters = self.parameters, parameters
        self._limit_states()
        changed = bodies_read_otherwise(before, parameters)
        for name in changed:
            self.states.forget(name, "the body was configured anew")
        if changed:
            self._find_sources()
        self.context = replace(
            self.context, world=parameters.world, defaults=parameters.defaults, carried=parameters.carried
        )

    def expect(self, publishers: Mapping[str, int] | None = None) -> None:
        """Set the topics and the numbers of publishers for the error before the first state.

        The numbers are None in the replay of a log, where they are unknown.
        """
        for body in self.parameters.sources:
            names = {topic.full_name for source in body.sources for topic in source.topics}
            count = None if publishers is None else sum(publishers[name] for name in names)
            self.states.expect(body.body_name, expected(body, count))

    def question_of(self, service: Service, request: object) -> Question[Answer]:
        """Return the question of a request, or raise the `ContactDynamicsError` that rejects it."""
        return service.question_of(request, world=self.world, world_frame=self.parameters.world_frame)

    def fill(self, service: Service, answer: Answer, response: object) -> None:
        """Write an answer into an empty response."""
        service.answer_to_msg(answer, world_frame=self.parameters.world_frame, into=response)

    def _limit_states(self) -> None:
        self.states.change_limits(
            history=self.parameters.state_history,
            timeout=self.parameters.state_timeout,
            future_tolerance=self.parameters.future_tolerance,
            max_states=self.parameters.max_states,
        )

    def _find_sources(self) -> None:
        self.sources = {each.full_name: each for each in state_sources(self.parameters, static=self._static)}
