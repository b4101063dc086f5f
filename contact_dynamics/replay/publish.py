# SPDX-License-Identifier: Apache-2.0
"""Publishes the states of a log over ROS, and repeats its requests, each at its logged time.

Playback has a rate and can be paused. A server on the machine's clock would reject the stamps of a log as too
old, so stamps are shifted to the present, unless the log's time is published at `/clock` for nodes with
``use_sim_time``.
"""

from __future__ import annotations

import os
import select
import struct
import sys
import termios
import time
import tty
import warnings
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import rclpy
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import deserialize_message
from rosgraph_msgs.msg import Clock

from contact_dynamics.constants import NS_PER_S
from contact_dynamics.errors import InvalidFieldError
from contact_dynamics.nodes.running import ros_until_stopped
from contact_dynamics.recording.bag_metadata import FOREVER_NS, OfferedQos, offered_qos
from contact_dynamics.recording.bag_reader import BagReader
from contact_dynamics.recording.cdr import leading_stamp_ns
from contact_dynamics.recording.definitions import EVENT_SUFFIX
from contact_dynamics.recording.errors import DamagedLogWarning, NotALogError
from contact_dynamics.recording.message_types import Message, message_class
from contact_dynamics.recording.service_calls import EVENT_TOPIC_SUFFIX, ServiceCall
from contact_dynamics.replay.arguments import stamps_as_logged
from contact_dynamics.replay.of_log import server_of_log
from contact_dynamics.replay.progress import Progress
from contact_dynamics.replay.timeline import CLOCK, in_order, part_of
from contact_dynamics.replay.verify import ServiceTally, differences, note_difference, nothing_yet, report
from msg_adapters.stamps import stamp_ns_from_msg, stamp_to_msg

if TYPE_CHECKING:
    import argparse
    from collections.abc import Callable, Iterator

    from rclpy.client import Client
    from rclpy.publisher import Publisher
    from rclpy.task import Future

    from contact_dynamics.recording.bag_reader import LoggedMessage
    from contact_dynamics.recording.file_messages import Span, Topic
    from contact_dynamics.replay.verify import Difference

PAUSE: Final = " "
STEP: Final = "."

_STEP_NS: Final = NS_PER_S // 10
_AT_ONCE_S: Final = 1.0 / 200.0  # maximum waiting time of one call of ``meanwhile``


class Pacing:
    """The playback clock of a log."""

    def __init__(
        self,
        *,
        rate: float,
        is_paused: bool,
        meanwhile: Callable[[int, float], object],
        is_over: Callable[[], bool],
    ) -> None:
        """Set the clock to zero; `begin` sets another time. ``rate`` is relative to the machine's clock.

        `wait_until` calls ``meanwhile`` repeatedly with the time of the log, ns, and the time for which it
        may block, s.
        """
        self._rate = rate
        self._is_paused = is_paused
        self._meanwhile = meanwhile
        self._is_over = is_over
        self.begin(0)

    @property
    def now_ns(self) -> int:
        """The current time of the log, ns."""
        if self._is_paused:
            return self._log_ns
        return self._log_ns + round((time.monotonic() - self._since_s) * self._rate * NS_PER_S)

    def begin(self, log_ns: int) -> None:
        """Set the time of the log."""
        self._log_ns, self._since_s, self._since_ns = log_ns, time.monotonic(), time.time_ns()

    def present_of(self, log_ns: int) -> int:
        """Convert a time of the log to the machine's clock, ns since the epoch.

        Equal times in the log remain equal, such as those of a pose and its twist.
        """
        return self._since_ns + round((log_ns - self._log_ns) / self._rate)

    def wait_until(self, log_ns: int) -> bool:
        """Wait until this time of the log; return False if playback was stopped before."""
        while not self._is_over():
            self._read_keys()
            now_ns = self.now_ns
            left_s = (log_ns - now_ns) / (self._rate * NS_PER_S)
            if left_s <= 0.0:
                self._meanwhile(now_ns, 0.0)
                return True
            self._meanwhile(now_ns, min(_AT_ONCE_S, left_s))
        return False

    def _read_keys(self) -> None:
        while sys.stdin.isatty() and select.select([sys.stdin], [], [], 0.0)[0]:
            key = os.read(sys.stdin.fileno(), 1).decode(errors="replace")  # select reports the rest
            now_ns = self.now_ns
            if key == PAUSE:
                self._is_paused = not self._is_paused
                self.begin(now_ns)
            elif key == STEP and self._is_paused:
                self.begin(now_ns + _STEP_NS)
            elif not key:
                return


@contextmanager
def single_keys() -> Iterator[None]:
    """Read single keys without the return key, if the standard input is a terminal."""
    if not sys.stdin.isatty():
        yield
        return
    before = termios.tcgetattr(sys.stdin)
    tty.setcbreak(sys.stdin, termios.TCSADRAIN)  # keys pressed before are kept
    try:
        yield
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


NODE_NAME: Final = "contact_dynamics_replay"

DEPTH: Final = 1000  # the publishers' queues hold a second of states at 1 kHz

_TICK_NS: Final = NS_PER_S // 100
_ANSWERS_S: Final = 10.0  # time limit for the next response at the end
_STAMPED: Final = ("std_msgs/Header", "builtin_interfaces/Time")
_LITTLE_ENDIAN: Final = 1  # the second byte of a serialised message
_POLL_S: Final = 0.02
_OF_THE_STATE: Final = ("stamp.sec", "stamp.nanosec", "fit_count")  # fields that identify the states used


def publish(given: argparse.Namespace, of_ros: list[str], *, span: Span) -> int:
    """Publish a log as the arguments say; return the exit code.

    It is 1 if a request got no response or a different one, or if nothing was published. Raise `NotALogError`
    if the path is not a recording, or not one of the server although requests are to be repeated.
    """
    path = Path(given.log)
    start_ns, end_ns = BagReader(path).extent()
    progress = Progress(str(path), begin=start_ns, end=end_ns)
    with ros_until_stopped(of_ros) as stop, single_keys():
        try:
            publisher = _LogPublisher(path, given, span=span)
            pacing = Pacing(
                rate=given.rate, is_paused=given.paused, meanwhile=publisher.meanwhile, is_over=stop.is_set
            )
            publisher.wait_for_listeners(given.wait)
            if given.paused:
                keys = "press the space bar to resume, or '.' to advance by 0.1 s"
                print(f"{path}: paused: {keys}", file=sys.stderr, flush=True)
            while publisher.play(pacing, progress) and given.loop:
                pass
            complete = stop.is_set() or (publisher.wait_for_answers() and publisher.has_published)
        finally:
            progress.end()
    print(publisher.told, file=sys.stderr)
    if publisher.found is None:
        return 0 if complete else 1
    print(report(publisher.found), flush=True)
    return 0 if complete and publisher.found.agrees else 1


class _LogPublisher:
    """A node that publishes the contents of a log.

    Attributes:
        found: The comparison with the logged responses, or None if requests are not repeated.
    """

    def __init__(self, path: Path, given: argparse.Namespace, *, span: Span) -> None:
        self._path = path
        self._span = span
        self._asks = given.requests
        self.found = (
            nothing_yet(path, server_of_log(path)[0], tolerance=given.tolerance) if given.requests else None
        )
        topics = _topics(path, given=given)
        self._topics = frozenset(topic.name for topic in topics)
        self._is_shifted = not stamps_as_logged(given)
        self._node = Node(NODE_NAME)
        self._publishers: dict[str, tuple[Publisher, bool]] = {}  # and whether messages begin with a stamp
        self._clients: dict[str, Client] = {}
        self._skipped: dict[str, str] = {}
        self._published = self._asked = self._answered = 0
        self._next_tick_ns = 0
        for topic in topics:
            self._add(topic)
        ticks = given.clock and CLOCK not in self._publishers
        self._ticks = self._node.create_publisher(Clock, CLOCK, QoSProfile(depth=DEPTH)) if ticks else None

    @property
    def has_published(self) -> bool:
        """Whether any message was published or request made."""
        return self._published + self._asked > 0

    @property
    def told(self) -> str:
        """A description of the published messages and the requests."""
        lines = [f"{self._path}: {self._published} messages published"]
        if self._asks:
            lines[0] += f", {self._asked} requests sent, {self._answered} responses received"
        lines += [f"  {topic}: not published: {reason}" for topic, reason in self._skipped.items()]
        return "\n".join(lines)

    def wait_for_listeners(self, patience_s: float) -> None:
        """Wait until each topic has a subscriber and each service a server, or until the time limit."""
        deadline = time.monotonic() + patience_s
        while time.monotonic() < deadline and not self._is_heard():
            time.sleep(_POLL_S)

    def play(self, pacing: Pacing, progress: Progress) -> bool:
        """Publish the log once; return False if it was stopped before its end."""
        self._next_tick_ns = 0
        begun = False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DamagedLogWarning)  # the rest is published
            for each in self._events():
                log_ns = _time_of(each)
                if log_ns is None:
                    continue
                if not begun:
                    begun = True
                    pacing.begin(log_ns)
                if not pacing.wait_until(log_ns):
                    return False
                if isinstance(each, ServiceCall):
                    self._ask(each, pacing)
                else:
                    self._publish(each, pacing)
                progress.tell(log_ns, f"{self._published} messages")
        return begun

    def meanwhile(self, log_ns: int, seconds: float) -> None:
        """Publish the clock and process responses while no message is due."""
        if self._ticks is not None and log_ns >= self._next_tick_ns:
            self._ticks.publish(Clock(clock=stamp_to_msg(log_ns)))
            self._next_tick_ns = log_ns + _TICK_NS
        if self._clients:
            rclpy.spin_once(self._node, timeout_sec=seconds)
        else:
            time.sleep(seconds)

    def wait_for_answers(self) -> bool:
        """Wait for pending responses as long as some arrive; return whether all did."""
        came, deadline = self._answered, time.monotonic() + _ANSWERS_S
        while time.monotonic() < deadline and self._answered < self._asked:
            rclpy.spin_once(self._node, timeout_sec=_POLL_S)
            if self._answered > came:
                came, deadline = self._answered, time.monotonic() + _ANSWERS_S
        return self._answered == self._asked

    def _add(self, topic: Topic) -> None:
        try:
            kind = message_class(topic.type_name)
        except InvalidFieldError as error:
            self._skipped[topic.name] = str(error)
            return
        first = next(iter(kind.get_fields_and_field_types().values()), "")
        is_stamped = first in _STAMPED and topic.name != CLOCK
        publisher = self._node.create_publisher(kind, topic.name, _as_offered(topic.qos))
        self._publishers[topic.name] = (publisher, is_stamped)

    def _is_heard(self) -> bool:
        topics = all(publisher.get_subscription_count() > 0 for publisher, _ in self._publishers.values())
        return topics and all(client.service_is_ready() for client in self._clients.values())

    def _events(self) -> Iterator[LoggedMessage | ServiceCall]:
        if self._asks:
            log, again = BagReader(self._path), BagReader(self._path)
            return in_order(log, again, self._topics, span=self._span)
        return BagReader(self._path).messages(self._topics, **self._span._asdict())

    def _publish(self, message: LoggedMessage, pacing: Pacing) -> None:
        if message.topic not in self._publishers:
            return
        publisher, is_stamped = self._publishers[message.topic]
        data = message.data
        if self._is_shifted and is_stamped:
            data = _stamped(data, pacing.present_of(leading_stamp_ns(data)))
        publisher.publish(data)
        self._published += 1

    def _ask(self, call: ServiceCall, pacing: Pacing) -> None:
        if call.request_event is None:
            return
        event_type = message_class(f"{call.service_type}{EVENT_SUFFIX}")
        event = deserialize_message(call.request_event.data, event_type)
        if not event.request:
            return
        request = event.request[0]
        if self._is_shifted:
            _move(request, pacing)
        if call.service not in self._clients:
            self._clients[call.service] = self._node.create_client(
                message_class(call.service_type), call.service, qos_profile=QoSProfile(depth=DEPTH)
            )
            self._clients[call.service].wait_for_service(timeout_sec=_ANSWERS_S)
        logged = None if call.response_event is None else part_of(call.response_event, "response")
        if logged is not None and self._is_shifted:
            _move_all(logged, pacing)
        future = self._clients[call.service].call_async(request)
        future.add_done_callback(partial(self._take_answer, call, logged))
        self._asked += 1

    def _take_answer(self, call: ServiceCall, logged: Any, future: Future) -> None:
        self._answered += 1
        if self.found is None or call.request_event is None or logged is None:
            return
        tally = self.found.services.setdefault(call.service, ServiceTally())
        tally.questions += 1
        differing = list(differences(logged, response := future.result()))
        if logged.status == response.status != logged.OK:  # messages contain ages and stamps
            differing = [each for each in differing if each.field != "message"]
        if _used_other_states(logged, response, differing):
            tally.other_state += 1
        else:
            asked_ns = call.request_event.log_time_ns
            note_difference(self.found, call.service, differing, asked_ns=asked_ns)


def _topics(path: Path, *, given: argparse.Namespace) -> list[Topic]:
    """Return the topics to publish: those of bodies' states, or all if the recording is not a server's."""
    wanted = None
    if given.requests or not given.all_topics:
        try:
            server = server_of_log(path)[1]
            wanted = server.topics - server.topics_of_changes  # those of the running nodes differ
        except NotALogError:
            if given.requests:
                raise
    found = BagReader(path).topics()
    if given.all_topics or wanted is None:
        wanted = frozenset(topic.name for topic in found if not topic.name.endswith(EVENT_TOPIC_SUFFIX))
    if not given.clock:
        wanted -= {CLOCK}  # a clock that is not that of the shifted stamps would mislead subscribers
    return [topic for topic in found if topic.name in wanted]


def _as_offered(text: str) -> QoSProfile:
    """Return a QoS that is compatible with all subscribers of a bag's publishers.

    Of different offers it takes the strongest. Settings that are missing in the bag have the defaults.
    """
    offers = offered_qos(text) or [OfferedQos()]
    best_effort = all(offer.reliability == "best_effort" for offer in offers)
    latched = any(offer.durability == "transient_local" for offer in offers)
    deadline = min(offer.deadline for offer in offers)
    lifespan = max(offer.lifespan for offer in offers)
    return QoSProfile(
        depth=DEPTH,
        reliability=ReliabilityPolicy.BEST_EFFORT if best_effort else ReliabilityPolicy.RELIABLE,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        deadline=_duration(deadline),
        lifespan=_duration(lifespan),
    )


def _duration(ns: int) -> Duration:
    return Duration(nanoseconds=0 if ns == FOREVER_NS else ns)  # zero means no limit


def _time_of(each: LoggedMessage | ServiceCall) -> int | None:
    if not isinstance(each, ServiceCall):
        return each.log_time_ns
    return None if each.request_event is None else each.request_event.log_time_ns


def _stamped(data: bytes, stamp_ns: int) -> bytes:
    """Return a serialised message that begins with a stamp, with the stamp replaced."""
    order = "<" if data[1] == _LITTLE_ENDIAN else ">"
    return data[:4] + struct.pack(f"{order}iI", *divmod(stamp_ns, NS_PER_S)) + data[12:]


def _used_other_states(logged: Any, response: Any, differing: list[Difference]) -> bool:
    """Return whether a response differs because the server had different states, or was too busy."""
    if logged.status != response.status:
        names = ("NO_STATE", "STALE_STATE", "BUSY", "TIMEOUT")
        return bool({logged.status, response.status} & {getattr(logged, name, None) for name in names})
    return any(each.field.endswith(_OF_THE_STATE) for each in differing)


def _move_all(message: Message, pacing: Pacing) -> None:
    """Shift all stamps of a logged message to the present."""
    for field in message.FIELDS:
        value: Any = getattr(message, field.name)
        if isinstance(value, Message) and hasattr(value, "nanosec"):
            stamp_ns = stamp_ns_from_msg(value)
            if stamp_ns > 0:
                stamp_to_msg(pacing.present_of(stamp_ns), into=value)
        elif isinstance(value, Message):
            _move_all(value, pacing)
        elif isinstance(value, (list, tuple)):
            for each in value:
                if isinstance(each, Message):
                    _move_all(each, pacing)


def _move(request: Any, pacing: Pacing) -> None:
    """Shift the times in a request to the present."""
    stamp_ns = stamp_ns_from_msg(request.stamp) if hasattr(request, "stamp") else 0  # batches have none
    if stamp_ns > 0:
        stamp_to_msg(pacing.present_of(stamp_ns), into=request.stamp)
    if len(getattr(request, "stamps_ns", ())) > 0:
        request.stamps_ns = [pacing.present_of(each) for each in request.stamps_ns]
