# SPDX-License-Identifier: Apache-2.0
"""What a server answers from, live or where its log is replayed, without ROS.

It has the configuration with its changes, the published states and what reads them, and the time of the
present question. The node (`server`), the replay of its log (`replay.again`) and the visualizer share it.
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
    """What a server answers from.

    Attributes:
        parameters: The configuration.
        states: The states that were published.
        sources: The topics that states come by, by their full names.
        context: What is known when a question is asked. Another one takes its place at a change.
        asked_ns: ns by the clock of the states, when the present question came. Zero means that this is not
            known, as before a simulation tells the time.
    """

    def __init__(self, parameters: ServerParameters, states: StateStore | None = None) -> None:
        """Begin without states, which ``states`` keeps if it is given.

        Raises:
            ConfigurationError: a source of states is not there, or is not allowed (`state_sources`).
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
        """The bodies and surfaces that are configured at present."""
        return self.parameters.world

    def change(self, parameters: ServerParameters) -> None:
        """Answer with another configuration from now on, which `check_change` allows."""
        before, self.parameters = self.parameters, parameters
        self._limit_states()
        changed = bodies_read_otherwise(before, parameters)
        for name in changed:
            self.states.forget(name, "the body was configured anew")
        if changed:
            self._find_sources()
        self.context = replace(
            self.context,
            world=parameters.world,
            defaults=parameters.defaults,
            carried=parameters.carried,
        )

    def expect(self, publishers: Mapping[str, int] | None = None) -> None:
        """Note, for whoever asks before the first state, where states are expected.

        Args:
            publishers: how many publish on each topic. None means that nobody can know, since a log is
                replayed.
        """
        for body in self.parameters.sources:
            names = {topic.full_name for source in body.sources for topic in source.topics}
            count = None if publishers is None else sum(publishers[name] for name in names)
            self.states.expect(body.body_name, expected(body, count))

    def question_of(self, service: Service, request: object) -> Question[Answer]:
        """Return the question that a request asks.

        Raises:
            ContactDynamicsError: the request is rejected.
        """
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
