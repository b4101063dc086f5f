"""The whole picture of a world and of what is asked about it, drawn into one recording as it happens."""

from __future__ import annotations

from collections import deque
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from contact_dynamics.constants import ns_after, to_ns
from contact_dynamics.diagrams.after_impact import AwaitedImpacts
from contact_dynamics.diagrams.planar_scene import silhouette
from contact_dynamics.diagrams.toss_words import toss_in_words
from contact_dynamics.diagrams.words import (
    AFTER_IMPACT,
    CONTACT_MODE,
    IMPACT,
    MANY_IMPACTS,
    MANY_TUMBLINGS,
    TOSS,
    TUMBLING,
    after_impact_in_words,
    contact_modes_in_words,
    impact_in_words,
    many_in_words,
    tumbling_in_words,
)
from contact_dynamics.questions.many import ManyImpactsAnswer
from contact_dynamics.tumbling.regime import Regime
from contact_dynamics.viewing.after_impact import draw_after_impact, style_after_impact
from contact_dynamics.viewing.answers_in_words import AnswersInWords, sentence
from contact_dynamics.viewing.blueprint import WINDOW_S, Eye, eye_on, make_blueprint
from contact_dynamics.viewing.bodies_in_world import BodiesInWorld
from contact_dynamics.viewing.contact_modes import draw_contact_modes
from contact_dynamics.viewing.diagrams_in_view import DiagramsInView
from contact_dynamics.viewing.entities import (
    ANSWERS,
    CONTACTS,
    ENERGY,
    ERROR,
    IMPACTS,
    LEGEND,
    MANY,
    POINSOT,
    PREDICTED,
    TOSSES,
    body_entity,
)
from contact_dynamics.viewing.impact import draw_impact
from contact_dynamics.viewing.in_view import ImpactsInView, LettersInView
from contact_dynamics.viewing.legend import LEGEND_TEXT
from contact_dynamics.viewing.many_states import draw_many_states
from contact_dynamics.viewing.measured import (
    set_time,
    style_series,
)
from contact_dynamics.viewing.poinsot import (
    clear_poinsot,
    count_of_flight,
    draw_poinsot,
    draw_rolling,
    hide_poinsot,
)
from contact_dynamics.viewing.predictions_in_view import PredictionsInView
from contact_dynamics.viewing.scene import (
    draw_axes,
    draw_trail_style,
    obstacle_parts,
    surface_parts,
    surface_path,
)
from contact_dynamics.viewing.scenery import Scenery
from contact_dynamics.viewing.toss import draw_toss
from contact_dynamics.viewing.trajectory import DEFAULT_PREDICTIONS, draw_earlier_path, draw_trajectory
from contact_dynamics.world import Surface

if TYPE_CHECKING:
    from collections.abc import Sequence

    from contact_dynamics.diagrams.after_impact import AfterImpact
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_answer import ImpactAnswer
    from contact_dynamics.questions.many import ManyTumblingsAnswer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.tumbling.poinsot_construction import Poinsot
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.scenery import Part
    from contact_dynamics.world import World


class Picture:
    """Draws states and answers into a recording. An unknown body is drawn without shape.

    Answers may come from a live server, from its log, or from a question asked in Python.
    """

    def __init__(
        self,
        recording: rr.RecordingStream,
        world: World,
        *,
        surface_side: float,
        predictions: int = DEFAULT_PREDICTIONS,
    ) -> None:
        """Draw the surfaces, as squares of ``surface_side``, m, and the bodies.

        The paths of this many newest ``predictions`` of a body are in view, at least one.
        """
        self._earlier = predictions - 1
        self._recording = recording
        self._world = world
        self._surface_side = surface_side
        self._bodies = BodiesInWorld(world)
        self._newest: dict[str, BodyState] = {}
        self._impacts = ImpactsInView(recording)
        self._letters = LettersInView(recording)
        self._answers = AnswersInWords(recording)
        self._awaited = AwaitedImpacts(gravity_W=world.gravity_W)
        self._told_ns: int | None = None  # stamp of the last answer
        self._diagrams = DiagramsInView(recording)
        self._rolling: tuple[str, Poinsot] | None = None  # the body in Poinsot's picture, while it flies
        self._framed = False
        self._eye: Eye | None = None
        self._shown: set[str] = set()  # what the arrangement has views of
        self._recent: deque[tuple[int, FloatArray]] = (
            deque()
        )  # stamp, ns, position, m, of the last `WINDOW_S`
        gravity = float(np.linalg.norm(world.gravity_W))
        self._up_W = -world.gravity_W / gravity if gravity > 0.0 else np.array([0.0, 0.0, 1.0])
        self._predictions = PredictionsInView(recording, self._bodies, up_W=self._up_W)
        self._scenery = Scenery(recording)
        self._first_ns: int | None = None  # stamp of the first state
        self._center_W: FloatArray | None = None  # the middle of what is looked at
        self._draw_scene()

    def change_world(self, world: World, *, stamp_ns: int) -> None:
        """Draw other surfaces and shapes of bodies from a time on, ns."""
        self._world = world
        self._bodies.change(world)
        wanted = self._surfaces()
        gone = self._scenery.paths - wanted.keys()
        wanted |= {body_entity(name): self._bodies.parts(name) for name in self._newest}
        wanted |= {path: {} for path in gone - wanted.keys()}
        for path, parts in wanted.items():
            if self._first_ns is None:
                self._scenery.draw(path, parts)
            else:
                first_ns = min(self._first_ns, stamp_ns)
                self._scenery.change(path, parts, first_ns=first_ns, stamp_ns=stamp_ns)

    def add_states(self, body_name: str, states: Sequence[BodyState]) -> None:
        """Draw measured states, in the order of their stamps."""
        if not states:
            return
        before = self._newest.get(body_name)
        if before is None:  # it was not in the picture before
            self._scenery.draw(body_entity(body_name), self._bodies.parts(body_name))
            draw_trail_style(self._recording, body_name, self._bodies.color(body_name))
        gravity_W = self._world.gravity_W
        if self._predictions.add_states(body_name, states, before=before, gravity_W=gravity_W):
            self._bring_up(ERROR)
        self._roll(body_name, states)
        for found in self._awaited.see(body_name, states):
            self._show_after_impact(found)
        self._impacts.pass_by(body_name, states[-1].stamp_ns)
        self._newest[body_name] = states[-1]
        if self._first_ns is None:
            self._first_ns = states[0].stamp_ns
        self._recent.extend((state.stamp_ns, state.p_WB_W) for state in states)
        while self._recent[-1][0] - self._recent[0][0] > to_ns(WINDOW_S):
            self._recent.popleft()

    def show_tumbling(
        self,
        answer: TumblingAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw where a body was predicted to be, with what certainty, and Poinsot's picture if it has curves.

        Args:
            answer: The answer.
            now_ns: ns, the time of the picture if the answer's state has no stamp.
            remark: A remark that is added to the answer's words.
            computation_time: s, how long the answer took, or None if that is not known.
        """
        stamp_ns = answer.state.stamp_ns or now_ns
        name, trajectory, rotation = answer.body_name, answer.trajectory, answer.poinsot
        set_time(self._recording, stamp_ns)
        draw_trajectory(
            self._recording, name, self._bodies.shape(name), trajectory, covariance=answer.covariance
        )
        earlier = self._predictions.newest(name)
        if earlier is not None and len(earlier.trajectory) > 0 and self._earlier > 0:
            place = earlier.number % self._earlier
            draw_earlier_path(self._recording, name, earlier.trajectory, place=place)
        curves = self._predict(name, trajectory, begin_ns=stamp_ns)
        if len(trajectory) > 0 and not self._framed:
            self._framed = True
            self._look_at(trajectory.p_WB_W)  # after that the view belongs to the user
        if rotation is not None and answer.curves is not None and rotation.regime is not Regime.AT_REST:
            if self._rolling is not None and self._rolling[0] != name:
                hide_poinsot(self._recording, self._rolling[0])
            draw_poinsot(self._recording, name, rotation, answer.curves)
            draw_rolling(self._recording, name, [replace(answer.state, stamp_ns=stamp_ns)])
            self._rolling = (name, rotation)
            self._bring_up(PREDICTED, POINSOT, ANSWERS, *curves)
        self._bring_up(PREDICTED, ANSWERS, *curves)
        words = tumbling_in_words(answer)
        self._tell_answer(TUMBLING, name, words, remark, computation_time, stamp_ns=stamp_ns)

    def show_impact(
        self,
        answer: ImpactAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw an impact in the scene and in impulse space, at the time of the state it was predicted from.

        Arguments are those of `show_tumbling`.
        """
        stamp_ns, name, other = answer.state.stamp_ns, answer.body_name, answer.other
        stamp_ns = ns_after(stamp_ns, -answer.seconds_to_contact) if stamp_ns else now_ns
        set_time(self._recording, stamp_ns)
        other_shape = self._bodies.shape(other.name) if other is not None and other.name else None
        strike_ns = ns_after(stamp_ns, answer.seconds_to_contact)
        self._impacts.come(name, stamp_ns=stamp_ns, strike_ns=strike_ns)
        draw_impact(self._recording, self._bodies.shape(name), answer, other_shape=other_shape)
        self._awaited.expect(answer, now_ns=stamp_ns)
        drawn = self._diagrams.draw_impact(
            answer,
            body=self._bodies.mass_properties(name),
            other=self._bodies.mass_properties(other.name) if other is not None else None,
        )
        self._bring_up(IMPACTS, ANSWERS, *drawn)
        words = impact_in_words(answer)
        self._tell_answer(IMPACT, name, words, remark, computation_time, stamp_ns=stamp_ns)

    def show_contact_modes(
        self,
        answer: ContactModeAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw an answer about contact modes in the scene, and in 2D if it has a plane of motion.

        Arguments are those of `show_tumbling`.
        """
        stamp_ns, name, plane = answer.state.stamp_ns or now_ns, answer.body_name, answer.plane
        set_time(self._recording, stamp_ns)
        shape = self._bodies.shape(name)
        self._letters.come(name, stamp_ns)
        draw_contact_modes(self._recording, shape, answer)
        if plane is not None:
            outline = silhouette(shape, plane.axes_W @ answer.state.R_WB)
            body = self._bodies.mass_properties(name)
            drawn = self._diagrams.draw_planar_modes(answer, plane, outline=outline, body=body)
            self._bring_up(CONTACTS, ANSWERS, *drawn)
        self._bring_up(CONTACTS, ANSWERS)
        words = contact_modes_in_words(answer)
        self._tell_answer(CONTACT_MODE, name, words, remark, computation_time, stamp_ns=stamp_ns)

    def show_toss(
        self,
        answer: TossAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw a whole toss with its other ways, and the fan of samples with the tree of their next strikes.

        Arguments are those of `show_tumbling`.
        """
        stamp_ns, name = answer.state.stamp_ns or now_ns, answer.body_name
        set_time(self._recording, stamp_ns)
        draw_toss(self._recording, self._bodies.shape(name), answer, up_W=self._up_W)
        curves = self._predict(name, answer.toss.trajectory, begin_ns=stamp_ns)
        if not self._framed:
            self._framed = True
            self._look_at(answer.toss.trajectory.p_WB_W)
        self._bring_up(TOSSES, ANSWERS, *curves)
        self._tell_answer(TOSS, name, toss_in_words(answer), remark, computation_time, stamp_ns=stamp_ns)

    def show_many(
        self,
        answer: ManyTumblingsAnswer | ManyImpactsAnswer,
        *,
        now_ns: int = 0,
        remark: str = "",
        computation_time: float | None = None,
    ) -> None:
        """Draw an answer about many states, at the present time, since such a question names no other.

        Arguments are those of `show_tumbling`.
        """
        name = answer.body_name
        set_time(self._recording, now_ns)
        draw_many_states(self._recording, self._bodies.shape(name), answer)
        self._bring_up(MANY, ANSWERS)
        kind = MANY_IMPACTS if isinstance(answer, ManyImpactsAnswer) else MANY_TUMBLINGS
        self._tell_answer(kind, name, many_in_words(answer), remark, computation_time, stamp_ns=now_ns)

    def tell(self, kind: str, text: str, *, stamp_ns: int, is_error: bool = False) -> None:
        """Write an answer in words, both into the list of all answers and as the newest of its kind."""
        set_time(self._recording, stamp_ns)
        self._told_ns = stamp_ns
        self._bring_up(ANSWERS)
        self._answers.tell(kind, text, is_error=is_error)

    def frame_all(self) -> None:
        """Make the view show all that is there at the end, for the user who opens the file."""
        if self._recent:
            self._look_at(np.array([p_WB_W for _, p_WB_W in self._recent]))

    @property
    def shown(self) -> frozenset[str]:
        """Return what there is to see so far, as `make_blueprint` takes it."""
        return frozenset(self._shown)

    def newest_stamp_ns(self) -> int | None:
        """Return the stamp of the newest measured state, or else of the last answer, if there is either."""
        return max((state.stamp_ns for state in self._newest.values()), default=self._told_ns)

    def _draw_scene(self) -> None:
        draw_axes(self._recording, self._up_W)
        for path, parts in self._surfaces().items():
            self._scenery.draw(path, parts)
        for name in self._bodies.names:
            style_series(self._recording, name, self._bodies.color(name))
            style_after_impact(self._recording, name, self._bodies.color(name))
        legend = rr.TextDocument(LEGEND_TEXT, media_type=rr.MediaType.MARKDOWN)
        self._recording.log(LEGEND, legend, static=True)
        self._arrange()

    def _surfaces(self) -> dict[str, dict[str, Part]]:
        """Return the parts of the surfaces by their paths."""
        return {
            surface_path(surface.name): surface_parts(
                surface,
                center_W=surface.p_WS_W if self._center_W is None else self._center_W,
                side=self._surface_side,
            )
            if isinstance(surface, Surface)
            else obstacle_parts(surface)
            for surface in self._world.surfaces
        }

    def _show_after_impact(self, found: AfterImpact) -> None:
        name, end_ns = found.answer.body_name, found.stamps_ns[-1]
        draw_after_impact(self._recording, self._bodies.shape(name), found, color=self._bodies.color(name))
        words = after_impact_in_words(found)
        self._tell_answer(AFTER_IMPACT, name, words, "", None, stamp_ns=end_ns)

    def _predict(self, body_name: str, trajectory: Trajectory, *, begin_ns: int) -> list[str]:
        """Note what curves are drawn from until the next prediction, and return what there is to see."""
        has_energy, is_compared = self._predictions.come(
            body_name, trajectory, begin_ns=begin_ns, gravity_W=self._world.gravity_W
        )
        if is_compared:
            self._bring_up(ERROR)
        return [ENERGY] if has_energy else []

    def _roll(self, body_name: str, states: Sequence[BodyState]) -> None:
        if self._rolling is None or self._rolling[0] != body_name:
            return
        count = count_of_flight(self._rolling[1], states)
        draw_rolling(self._recording, body_name, states[:count])
        if count < len(states):
            set_time(self._recording, states[count].stamp_ns)
            clear_poinsot(self._recording, body_name)
            self._rolling = None

    def _tell_answer(
        self,
        kind: str,
        body_name: str,
        words: list[str],
        remark: str,
        computation_time: float | None,
        *,
        stamp_ns: int,
    ) -> None:
        said = sentence(body_name, words, remark=remark, computation_time=computation_time)
        self.tell(kind, said, stamp_ns=stamp_ns)

    def _look_at(self, points_W: FloatArray) -> None:
        """Turn the view towards a path, and put the ground below it."""
        center = 0.5 * (points_W.min(axis=0) + points_W.max(axis=0))
        self._center_W = center
        for path, parts in self._surfaces().items():
            self._scenery.draw(path, parts)
        self._eye = eye_on(points_W, up_W=self._up_W, margin=self._bodies.largest_size)
        self._arrange()

    def _bring_up(self, *shown: str) -> None:
        """Add the views of what is drawn for the first time."""
        if not self._shown.issuperset(shown):
            self._shown.update(shown)
            self._arrange()

    def _arrange(self) -> None:
        blueprint = make_blueprint(self._bodies.names, eye=self._eye, shown=self._shown)
        self._recording.send_blueprint(blueprint)
