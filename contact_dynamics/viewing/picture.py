# SPDX-License-Identifier: Apache-2.0
"""The whole picture of a world, its states and answers, drawn into one recording as they arrive."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

import numpy as np
import rerun as rr

from contact_dynamics.constants import DEFAULT_PREDICTIONS, ns_after, to_ns
from contact_dynamics.diagrams.after_impact import AwaitedImpacts
from contact_dynamics.diagrams.contact_scene import LETTERS, bodies_contact_marks, contact_marks
from contact_dynamics.diagrams.flight import EARLIER, flight_marks, outside, path_mark
from contact_dynamics.diagrams.impact_scene import impact_marks
from contact_dynamics.diagrams.many_states import many_states_marks
from contact_dynamics.diagrams.planar_scene import silhouette
from contact_dynamics.diagrams.toss_scene import toss_marks
from contact_dynamics.diagrams.words import AFTER_IMPACT, after_impact_in_words
from contact_dynamics.numerics.vectors import tangents_near_x
from contact_dynamics.questions.services import service_of
from contact_dynamics.tumbling.polhode import Regime
from contact_dynamics.viewing.blueprint import NO_TRAVEL, WINDOW_S, Framing, make_blueprint, near_most
from contact_dynamics.viewing.diagrams_in_view import DiagramsInView
from contact_dynamics.viewing.drawing import draw_marks
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
    entity,
)
from contact_dynamics.viewing.in_view import ImpactsInView, PoinsotInView, PredictionsInView
from contact_dynamics.viewing.measured import SET_BACK_S, draw_after_impact, set_time
from contact_dynamics.viewing.scenery import WorldInView
from contact_dynamics.viewing.words import LEGEND_TEXT, AnswersInWords, sentence

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from contact_dynamics.contact.contact import ContactSet
    from contact_dynamics.contact_modes import BodiesModeAnswer
    from contact_dynamics.contact_modes.result import ResponseMode
    from contact_dynamics.diagrams.after_impact import AfterImpact
    from contact_dynamics.diagrams.marks import Mark
    from contact_dynamics.questions.bodies_contact_modes import BodiesContactModeAnswer
    from contact_dynamics.questions.carried_surface import CarriedSurface
    from contact_dynamics.questions.contact_modes import ContactModeAnswer
    from contact_dynamics.questions.impact_question import ImpactAnswer
    from contact_dynamics.questions.many import ManyImpactsAnswer, ManyTumblingsAnswer
    from contact_dynamics.questions.services import Answer
    from contact_dynamics.questions.toss import TossAnswer
    from contact_dynamics.questions.tumbling import TumblingAnswer
    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.tumbling import Trajectory
    from contact_dynamics.validation import FloatArray
    from contact_dynamics.viewing.blueprint import Eye
    from contact_dynamics.world import World


class Picture:
    """Draws states and answers into a recording. An unknown body is drawn without shape.

    Answers may come from a live server, from its log, or from a call in Python.

    Attributes:
        recording: The recording that it is drawn into.
    """

    def __init__(
        self,
        recording: rr.RecordingStream,
        world: World,
        *,
        surface_side: float,
        predictions: int = DEFAULT_PREDICTIONS,
        carried: Sequence[CarriedSurface] = (),
    ) -> None:
        """Draw the surfaces, as squares of ``surface_side``, m, those carried by bodies, and the bodies.

        ``predictions`` is the number of newest predicted paths of a body in view, at least one.
        """
        self._earlier = predictions - 1
        self.recording = recording
        self._world = WorldInView(recording, world, surface_side=surface_side, carried=carried)
        self._bodies = self._world.bodies
        self._newest: dict[str, BodyState] = {}
        self._stamps_ns: dict[str, int] = {}  # the newest since a clock was last set back
        self._impacts = ImpactsInView(recording)
        self._lettered = ""  # the body whose contacts have letters
        self._answers = AnswersInWords(recording)
        self._awaited = AwaitedImpacts(gravity_W=world.gravity_W)
        self._told_ns: int | None = None  # stamp of the last answer
        self._diagrams = DiagramsInView(recording)
        self._poinsot = PoinsotInView(recording)
        self._predictions = PredictionsInView(recording, self._bodies, up_W=self._world.up_W)
        self._framing = Framing(self._world.up_W)
        self._eye: Eye | None = None
        self._sees_path = False  # from then on, only the user moves the view
        self._shown: set[str] = set()  # contents of the layout's views
        # Stamps, ns, and positions, m, of the last `WINDOW_S`.
        self._recent: deque[tuple[int, FloatArray]] = deque()
        legend = rr.TextDocument(LEGEND_TEXT, media_type=rr.MediaType.MARKDOWN)
        recording.log(LEGEND, legend, static=True)
        self._arrange()

    def change_world(self, world: World, *, stamp_ns: int, carried: Sequence[CarriedSurface] = ()) -> None:
        """Replace the surfaces and shapes of bodies from a time on, ns."""
        self._world.change(world, stamp_ns=stamp_ns, carried=carried)

    def add_states(self, body_name: str, states: Sequence[BodyState]) -> None:
        """Draw measured states, in the order of their stamps."""
        if not states:
            return
        before = self._newest.get(body_name)
        if before is None:  # a new body
            self._world.add_body(body_name, stamp_ns=states[0].stamp_ns)
            self._look(self._framing.add_body(body_name, states[0].p_WB_W))
        gravity_W = self._world.world.gravity_W
        if self._predictions.add_states(body_name, states, before=before, gravity_W=gravity_W):
            self._bring_up(ERROR)
        self._poinsot.add_states(body_name, states)
        for found in self._awaited.see(body_name, states):
            self._show_after_impact(found)
        self._impacts.pass_by(body_name, states[-1].stamp_ns)
        self._newest[body_name] = states[-1]
        if states[-1].stamp_ns < self._stamps_ns.get(body_name, 0) - to_ns(SET_BACK_S):
            self._stamps_ns.clear()
        self._stamps_ns[body_name] = states[-1].stamp_ns
        self._recent.extend((state.stamp_ns, state.p_WB_W) for state in states)
        while abs(self._recent[-1][0] - self._recent[0][0]) > to_ns(WINDOW_S):
            self._recent.popleft()

    def show(
        self, answer: Answer, *, now_ns: int = 0, remark: str = "", computation_time: float | None = None
    ) -> None:
        """Draw an answer at the stamp of the state that it was predicted from, and describe it in words.

        If its state has no stamp, the time of the picture is ``now_ns``, ns. The words end with the remark,
        and with the computation time, s, if known.
        """
        service, stamp_ns = service_of(answer), answer.stamp_ns or now_ns
        set_time(self.recording, stamp_ns)
        remarks: list[str] = []
        if service.draw is not None:
            shown, remarks = service.draw(self, answer, stamp_ns)
            self._bring_up(ANSWERS, *shown)
        words = [*service.in_words(answer), *remarks]
        said = sentence(answer.body_name, words, remark=remark, computation_time=computation_time)
        self.tell(service.kind, said, stamp_ns=stamp_ns)
        for found in self._awaited.see(answer.body_name, ()):  # an impact may have been measured already
            self._show_after_impact(found)

    def show_bodies(self, answer: BodiesModeAnswer, contacts: ContactSet, *, now_ns: int) -> None:
        """Draw contact modes of several bodies at a time, ns, and describe them in words."""
        set_time(self.recording, now_ns)
        self._draw_bodies_contacts(self._bodies.names, contacts, answer.modes)
        self._bring_up(CONTACTS)
        self.tell("contact modes", answer.in_short().partition(": ")[2], stamp_ns=now_ns)

    def draw_tumbling(self, answer: TumblingAnswer, stamp_ns: int) -> tuple[list[str], list[str]]:
        """Draw a predicted motion with its uncertainty, and the Poinsot construction if there are curves.

        Return the drawn views, and remarks for the words, as all methods that draw an answer do.
        """
        name, rotation = answer.body_name, answer.poinsot
        shape = self._bodies.shape(name)
        trajectory, in_the_way = outside(answer.trajectory, shape, self._world.world.surfaces)
        if len(trajectory) == 0:
            self.recording.log(entity(PREDICTED, name), rr.Clear(recursive=True))
        else:
            flight = flight_marks(shape, trajectory, covariance=answer.covariance)
            draw_marks(self.recording, flight, entity(PREDICTED, name))
        earlier = self._predictions.newest(name)
        if earlier is not None and len(earlier.trajectory) > 0 and self._earlier > 0:
            path = path_mark(f"earlier/{earlier.number % self._earlier}", earlier.trajectory, **EARLIER)
            draw_marks(self.recording, [path], entity(PREDICTED, name))
        shown = [PREDICTED, *self._predict(name, trajectory, begin_ns=stamp_ns)]
        self._look_along(trajectory)
        if rotation is not None and answer.curves is not None and rotation.regime is not Regime.AT_REST:
            self._poinsot.come(name, rotation, answer.curves, answer.state, stamp_ns=stamp_ns)
            shown.append(POINSOT)
        return shown, [f"drawn until {in_the_way} is in its way"] if in_the_way else []

    def draw_impact(self, answer: ImpactAnswer, stamp_ns: int) -> tuple[list[str], list[str]]:
        """Draw an impact in the scene and in impulse space."""
        name, other = answer.body_name, answer.other
        other_shape = self._bodies.shape(other.name) if other is not None and other.name else None
        strike_ns = ns_after(stamp_ns, answer.seconds_to_contact)
        self._impacts.come(name, stamp_ns=stamp_ns, strike_ns=strike_ns)
        impact = impact_marks(self._bodies.shape(name), answer, other_shape=other_shape)
        draw_marks(self.recording, impact, entity(IMPACTS, name))
        self._awaited.expect(answer, now_ns=stamp_ns)
        drawn = self._diagrams.draw_impact(
            answer,
            body=self._bodies.mass_properties(name),
            other=self._bodies.mass_properties(other.name) if other is not None else None,
        )
        return [IMPACTS, *drawn], []

    def draw_contact_modes(
        self,
        answer: ContactModeAnswer,
        stamp_ns: int,  # noqa: ARG002  as all
    ) -> tuple[list[str], list[str]]:
        """Draw contact modes in the scene, and in 2D if they have a plane of motion."""
        name, plane = answer.body_name, answer.plane
        shape, body = self._bodies.shape(name), self._bodies.mass_properties(name)
        self._draw_contacts(name, contact_marks(shape, answer, body=body))
        if self._eye is None:
            self._look_at(self._across_from(answer))
        if plane is None:
            return [CONTACTS], []
        outline = silhouette(shape, plane.axes_W @ answer.state.R_WB)
        return [CONTACTS, *self._diagrams.draw_planar_modes(answer, plane, outline=outline, body=body)], []

    def draw_bodies_contact_modes(
        self,
        answer: BodiesContactModeAnswer,
        stamp_ns: int,  # noqa: ARG002  as all
    ) -> tuple[list[str], list[str]]:
        """Draw contact modes of several bodies in the scene."""
        self._draw_bodies_contacts((body.name for body in answer.bodies), answer.contacts, answer.modes)
        return [CONTACTS], []

    def draw_toss(self, answer: TossAnswer, stamp_ns: int) -> tuple[list[str], list[str]]:
        """Draw a whole toss with its alternatives, and the fan of samples with the tree of their strikes."""
        shape = self._bodies.shape(answer.body_name)
        self._draw_anew(TOSSES, answer.body_name, toss_marks(shape, answer, up_W=self._world.up_W))
        curves = self._predict(answer.body_name, answer.toss.trajectory, begin_ns=stamp_ns)
        self._look_along(answer.toss.trajectory)
        return [TOSSES, *curves], []

    def draw_many(
        self,
        answer: ManyTumblingsAnswer | ManyImpactsAnswer,
        stamp_ns: int,  # noqa: ARG002  as all
    ) -> tuple[list[str], list[str]]:
        """Draw many states."""
        name = answer.body_name
        self._draw_anew(MANY, name, many_states_marks(self._bodies.shape(name), answer))
        return [MANY], []

    def _draw_bodies_contacts(
        self, body_names: Iterable[str], contacts: ContactSet, modes: Sequence[ResponseMode]
    ) -> None:
        """Draw contacts of several bodies. The first of them in view switches modes on and off."""
        name = next((name for name in body_names if name in self._bodies.names), "")
        self._draw_contacts(name, bodies_contact_marks(contacts, modes, size=self._bodies.largest_size))

    def _draw_contacts(self, body_name: str, marks: list[Mark]) -> None:
        """Draw contacts of a body, and clear the letters of another body's earlier answer."""
        if self._lettered not in {"", body_name}:
            self.recording.log(f"{entity(CONTACTS, self._lettered)}/{LETTERS}", rr.Clear(recursive=False))
        self._lettered = body_name
        self._draw_anew(CONTACTS, body_name, marks)

    def _draw_anew(self, kind: str, body_name: str, marks: list[Mark]) -> None:
        """Draw an answer in the scene in place of the previous one about its body."""
        path = entity(kind, body_name)
        self.recording.log(path, rr.Clear(recursive=True))
        draw_marks(self.recording, marks, path)

    def tell(self, kind: str, text: str, *, stamp_ns: int, is_error: bool = False) -> None:
        """Write an answer as text, into the list of all answers and as the latest of its kind."""
        set_time(self.recording, stamp_ns)
        self._told_ns = stamp_ns
        self._bring_up(ANSWERS)
        self._answers.tell(kind, text, is_error=is_error)

    def frame_all(self) -> None:
        """Frame everything at the end, for the user who opens the file."""
        if self._recent:
            self._framing = Framing(self._world.up_W)  # the first positions of the bodies are outdated
            self._look_at(near_most(np.array([p_WB_W for _, p_WB_W in self._recent])))

    @property
    def shown(self) -> frozenset[str]:
        """Return the contents so far, as `make_blueprint` takes them."""
        return frozenset(self._shown)

    @property
    def bodies_with_curves(self) -> set[str]:
        """The body whose energy and momenta are drawn, and the one whose ellipsoid rolls, if any."""
        return {name for name in (self._predictions.conserved, self._poinsot.rolling) if name is not None}

    def newest_stamp_ns(self, waiting_ns: dict[str, int] | None = None) -> int | None:
        """Return the stamp of the newest measured state, or else of the last answer, if there is either.

        ``waiting_ns`` are the newest stamps of bodies with states that are not drawn yet.
        """
        stamps_ns = self._stamps_ns | (waiting_ns or {})
        return max(stamps_ns.values(), default=self._told_ns)

    def _show_after_impact(self, found: AfterImpact) -> None:
        name, end_ns = found.answer.body_name, found.stamps_ns[-1]
        draw_after_impact(self.recording, self._bodies.shape(name), found, color=self._bodies.color(name))
        self.tell(AFTER_IMPACT, sentence(name, after_impact_in_words(found)), stamp_ns=end_ns)

    def _predict(self, body_name: str, trajectory: Trajectory, *, begin_ns: int) -> list[str]:
        """Register a prediction, from which curves are drawn until the next one; return what is in view."""
        has_energy, is_compared = self._predictions.come(
            body_name, trajectory, begin_ns=begin_ns, gravity_W=self._world.world.gravity_W
        )
        if is_compared:
            self._bring_up(ERROR)
        return [ENERGY] if has_energy else []

    def _look_along(self, trajectory: Trajectory) -> None:
        """Turn the view towards the first predicted trajectory."""
        if len(trajectory) > 0 and not self._sees_path:
            self._sees_path = True
            self._look_at(trajectory.p_WB_W)

    def _across_from(self, answer: ContactModeAnswer) -> FloatArray:
        """Return a short path, (2, 3), m, world; the view across it shows a body and the walls behind it."""
        up_W = self._world.up_W
        side_W = answer.contacts.normals_W.mean(axis=0) - tangents_near_x(up_W)[1]
        along_W = np.cross(up_W, side_W)
        ends = np.array([[-1.0], [1.0]]) * NO_TRAVEL
        path_W: FloatArray = answer.state.p_WB_W + ends * along_W / np.linalg.norm(along_W)
        return path_W

    def _look_at(self, points_W: FloatArray) -> None:
        """Turn the view towards a path and the bodies near it."""
        self._look(self._framing.turn_to(points_W, margin=self._bodies.largest_size))

    def _look(self, eye: Eye | None) -> None:
        """Move the eye, if one is given, and centre the ground below the points in sight."""
        if eye is None:
            return
        self._eye = eye
        self._world.center_at(self._framing.center_W, extent=self._framing.extent)
        self._arrange()

    def _bring_up(self, *shown: str) -> None:
        """Add the views of contents that are drawn for the first time."""
        if not self._shown.issuperset(shown):
            self._shown.update(shown)
            self._arrange()

    def _arrange(self) -> None:
        blueprint = make_blueprint(self._bodies.names, eye=self._eye, shown=self._shown)
        self.recording.send_blueprint(blueprint)
