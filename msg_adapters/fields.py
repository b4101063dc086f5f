# SPDX-License-Identifier: Apache-2.0
"""Tables of fields, which write a record to a message and read it from one, row by row.

A row contains an attribute of the record, the field of the message, and the conversion in both directions.
They therefore cannot disagree, and a new field of an answer takes one line.
"""

from __future__ import annotations

import math
from functools import partial
from operator import attrgetter
from types import SimpleNamespace
from typing import TYPE_CHECKING, Final, Generic, NamedTuple, Protocol, TypeVar

import numpy as np

from contact_dynamics.plane.projection import PlaneOfMotion
from contact_dynamics.questions.subject import FitQuality, NamedState
from contact_dynamics.world import World
from contact_dynamics_interfaces.msg import BodyState as BodyStateMsg
from contact_dynamics_interfaces.srv import PredictImpact
from msg_adapters.body_state import body_state_from_msg, body_state_to_msg, center_of_mass
from msg_adapters.contacts import contacts_from_msg, contacts_to_msg, flat, rows
from msg_adapters.geometry import quaternion_from_msg, quaternion_to_msg, vector_from_msg, vector_to_msg
from msg_adapters.status import with_warnings, without_warnings

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from enum import IntEnum

    from contact_dynamics.rigid_body.body import BodyState
    from contact_dynamics.validation import FloatArray


class Frame(NamedTuple):
    """The frames of the poses in a message, and the context of their conversion."""

    p_FB_F: FloatArray = np.zeros(3)  # (3,), m, the body's centre of mass in its published frame
    world_frame: str = ""  # the name of the world frame, for writing
    body_name: str = ""
    stamp_ns: int = 0  # the time from which trajectories count, ns, for writing
    answer: object = None  # the answer that contains the record, for writing
    world: World | None = None  # the bodies whose centres of mass are known, for reading


class Kind(NamedTuple):
    """A conversion between an attribute and a field that depends on the frame or on other fields."""

    write: Callable[..., object]  # arguments: message, field, attribute, frame
    read: Callable[..., object]  # arguments: message, field, frame; returns the attribute


class Converted(NamedTuple):
    """A conversion between an attribute and a field, which are equal without functions."""

    to_field: Callable[..., object] | None = None
    from_field: Callable[..., object] | None = None


def _floats(numbers: Sequence[float]) -> FloatArray:
    return np.array(numbers, dtype=np.float64)


SAME: Final = Converted()  # a number, a text or a flag
TUPLE: Final = Converted(list, tuple)  # a tuple, which is a list in the message
NUMBERS: Final = Converted(flat, _floats)  # an array of numbers, (n,)
FIXED: Final = Converted(np.ravel, np.array)  # an array of numbers, whose count the message fixes

NUMBERS_OR_NONE: Final = Kind(
    write=lambda msg, field, value, _: None if value is None else setattr(msg, field, flat(value)),
    read=lambda msg, field, _: _floats(found) if len(found := getattr(msg, field)) > 0 else None,
)
"""An array of numbers, (n,), or None, which is an empty list."""

NUMBER_OR_NONE: Final = Converted(
    lambda value: math.nan if value is None else value, lambda value: None if math.isnan(value) else value
)
"""A number, or None, which is NaN."""

VECTOR: Final = Kind(
    write=lambda msg, field, value, _: vector_to_msg(value, into=getattr(msg, field)),
    read=lambda msg, field, _: vector_from_msg(getattr(msg, field)),
)
"""Three numbers, as a `Vector3` or a `Point`."""

QUATERNION: Final = Kind(
    write=lambda msg, field, value, _: quaternion_to_msg(value, into=getattr(msg, field)),
    read=lambda msg, field, _: quaternion_from_msg(getattr(msg, field)),
)
"""A quaternion x, y, z, w."""

PLANE: Final = Kind(
    write=lambda msg, field, value, _: (
        None if value is None else setattr(msg, field, vector_to_msg(value.normal_W))
    ),
    read=lambda msg, field, _: (
        PlaneOfMotion(normal_W=vector_from_msg(found))
        if any(((found := getattr(msg, field)).x, found.y, found.z))
        else None
    ),
)
"""The plane of motion, or None, which is a normal of zeros."""

WARNINGS: Final = Kind(
    write=lambda msg, field, value, _: setattr(msg, field, with_warnings(getattr(msg, field), value)),
    read=lambda msg, field, _: without_warnings(getattr(msg, field))[1],
)
"""Warnings, which follow the text that is in the field already."""

TEXT_BEFORE_WARNINGS: Final = Converted(None, lambda text: without_warnings(text)[0])  # the text before them

CONTACTS: Final = Kind(
    write=lambda msg, field, value, _: contacts_to_msg(value, into=getattr(msg, field)),
    read=lambda msg, field, _: contacts_from_msg(getattr(msg, field)),
)
"""A contact set."""


def _write_state(msg: object, field: str, state: BodyState, frame: Frame) -> None:
    body_state_to_msg(
        state,
        body_name=frame.body_name,
        world_frame=frame.world_frame,
        p_FB_F=frame.p_FB_F,
        into=getattr(msg, field),
    )


def _read_state(msg: object, field: str, frame: Frame) -> BodyState:
    found = getattr(msg, field)
    return body_state_from_msg(found, world_frame=found.header.frame_id, p_FB_F=frame.p_FB_F)


STATE: Final = Kind(_write_state, _read_state)  # a state of the body


def rows_of(width: int) -> Converted:
    """Return the kind of arrays, (n, width), which are flat in the message."""
    return Converted(flat, partial(rows, width=width))


def one_of(members: type[IntEnum], *, none: int | None = None) -> Converted:
    """Return the kind of a member of an enumeration. The number ``none``, if given, means None."""
    return Converted(
        lambda value: none if value is None else int(value),
        lambda number: None if number == none else members(number),
    )


def some_of(members: type[IntEnum]) -> Converted:
    """Return the kind of a tuple of members of an enumeration."""
    return Converted(
        lambda values: [int(value) for value in values],
        lambda numbers: tuple(members(number) for number in numbers),
    )


def array_of(dtype: type) -> Converted:
    """Return the kind of an array, (n,), of whole numbers or flags."""
    return Converted(np.ndarray.tolist, partial(np.array, dtype=dtype))


def or_none(kind: Kind) -> Kind:
    """Return the kind of a tuple, or None, which is an empty tuple in the message."""
    return Kind(
        write=lambda msg, field, values, frame: kind.write(msg, field, values or (), frame),
        read=lambda msg, field, frame: kind.read(msg, field, frame) or None,
    )


class Row(NamedTuple):
    """A row of a table."""

    name: str  # the attribute of the record
    field: str  # the field of the message, or empty if the kind contains several fields
    kind: Kind | Converted = SAME


Rec = TypeVar("Rec")
Msg = TypeVar("Msg")


class Table(Generic[Rec, Msg]):
    """The fields of a record and of its message."""

    def __init__(self, record: Callable[..., Rec], msg_type: Callable[[], Msg], *rows: Row) -> None:
        """Set the functions that make the record of its attributes and an empty message, and the rows.

        Rows that depend on one field only are processed first, and then the others in their order.
        """
        self.record, self.msg_type = record, msg_type
        self._converted = [(name, field, *kind) for name, field, kind in rows if isinstance(kind, Converted)]
        self._others = [(name, field, *kind) for name, field, kind in rows if isinstance(kind, Kind)]

    def to_msg(self, record: Rec, frame: Frame = Frame(), *, into: Msg | None = None) -> Msg:  # noqa: B008
        """Return a record as a message, which is new unless an empty one to fill is given."""
        msg = self.msg_type() if into is None else into
        for name, field, to_field, _ in self._converted:
            value = getattr(record, name)
            setattr(msg, field, value if to_field is None else to_field(value))
        for name, field, write, _ in self._others:
            write(msg, field, getattr(record, name), frame)
        return msg

    def from_msg(self, msg: Msg, frame: Frame = Frame()) -> Rec:  # noqa: B008
        """Return the record of a message.

        Raise `InvalidFieldError` if a number is not allowed, or arrays have unequal lengths.
        """
        return self._read(msg, frame)

    def _read(self, msg: object, frame: Frame = Frame()) -> Rec:  # noqa: B008
        values = {}
        for name, field, _, from_field in self._converted:
            value = getattr(msg, field)
            values[name] = value if from_field is None else from_field(value)
        for name, field, _, read in self._others:
            values[name] = read(msg, field, frame)
        return self.record(**values)

    def nested(
        self,
        absent: Callable[[Msg], bool] = lambda _: False,
        write_absent: Callable[[Msg], object] = lambda _: None,
    ) -> Kind:
        """Return the kind of a record that is in the message of the row's field.

        If that field is empty, the record shares the message of the other rows. ``absent`` returns whether a
        message has no record, which is then None, and ``write_absent`` writes such a message.
        """

        def write(msg: Msg, field: str, value: Rec | None, frame: Frame) -> None:
            into: Msg = getattr(msg, field) if field else msg
            if value is None:
                write_absent(into)
            else:
                self.to_msg(value, frame, into=into)

        def read(msg: Msg, field: str, frame: Frame) -> Rec | None:
            found: Msg = getattr(msg, field) if field else msg
            return None if absent(found) else self.from_msg(found, frame)

        return Kind(write, read)

    def listed(self) -> Kind:
        """Return the kind of a tuple of records, which is a list of messages."""
        return Kind(
            write=lambda msg, field, records, frame: setattr(
                msg, field, [self.to_msg(record, frame) for record in records]
            ),
            read=lambda msg, field, frame: tuple(self.from_msg(each, frame) for each in getattr(msg, field)),
        )

    def at_most_one(self) -> Kind:
        """Return the kind of a record, or None, which is a list of one message or none."""
        write, read = self.listed()
        return Kind(
            write=lambda msg, field, record, frame: write(
                msg, field, () if record is None else (record,), frame
            ),
            read=lambda msg, field, frame: (*read(msg, field, frame), None)[0],  # type: ignore[misc]
        )

    def columns(self) -> Kind:
        """Return the kind of a tuple of records, whose attributes are lists of the message itself."""

        def write(msg: object, _: str, records: Sequence[Rec], __: Frame) -> None:
            for name, field, to_field, _from in self._converted:
                values = [getattr(record, name) for record in records]
                setattr(msg, field, values if to_field is None else list(map(to_field, values)))

        def read(msg: object, _: str, __: Frame) -> tuple[Rec, ...]:
            names = [field for _, field, *_ in self._converted]
            lines = zip(*(getattr(msg, field) for field in names), strict=True)
            return tuple(self._read(SimpleNamespace(**dict(zip(names, line, strict=True)))) for line in lines)

        return Kind(write, read)


class _NamedStates(Table[NamedState, BodyStateMsg]):
    """A state with the name of its body, whose centre of mass its pose depends on."""

    def to_msg(
        self,
        record: NamedState,
        frame: Frame = Frame(),  # noqa: B008
        *,
        into: BodyStateMsg | None = None,
    ) -> BodyStateMsg:
        return body_state_to_msg(
            record.state,
            body_name=record.name,
            world_frame=frame.world_frame,
            p_FB_F=record.p_FB_F,
            into=into,
        )

    def from_msg(self, msg: BodyStateMsg, frame: Frame = Frame()) -> NamedState:  # noqa: B008
        p_FB_F = center_of_mass(msg.body_name, frame.world or World())
        state = body_state_from_msg(msg, world_frame=msg.header.frame_id, p_FB_F=p_FB_F)
        return NamedState(name=msg.body_name, p_FB_F=p_FB_F, state=state)


NAMED_STATE: Final = _NamedStates(NamedState, BodyStateMsg)
"""The state of one of the bodies in an answer about several."""


def _in_frame(name: str) -> Row:
    """Return the row of an attribute that is not in the message."""
    return Row(name, "", Kind(lambda *_: None, lambda _, __, frame: getattr(frame, name)))


_BODY_NAME: Final = _in_frame("body_name")
_CENTER: Final = _in_frame("p_FB_F")


class _OfBody(Protocol):
    """The attributes of all answers."""

    @property
    def body_name(self) -> str: ...
    @property
    def stamp_ns(self) -> int: ...


AnswerOfBody = TypeVar("AnswerOfBody", bound=_OfBody)


class AnswerTable(Table[AnswerOfBody, Msg]):
    """The fields of an answer to a service and of its response."""

    def __init__(
        self,
        answer: Callable[..., AnswerOfBody],
        response_type: Callable[[], Msg],
        *rows: Row,
        body_name: str | None = "state.body_name",
    ) -> None:
        """Set the functions that make the answer and an empty response, and the rows.

        The field with the body's name is ``body_name``. If it is None, the rows contain the bodies and their
        centres of mass.
        """
        of_body = () if body_name is None else (_BODY_NAME, _CENTER)
        super().__init__(answer, response_type, *of_body, *rows)
        self._body_name = (lambda _: "") if body_name is None else attrgetter(body_name)

    def response_of(self, answer: AnswerOfBody, *, world_frame: str, into: Msg | None = None) -> Msg:
        """Return an answer as a response, which is new unless an empty one to fill is given."""
        frame = Frame(
            p_FB_F=getattr(answer, "p_FB_F", Frame().p_FB_F),
            world_frame=world_frame,
            body_name=answer.body_name,
            stamp_ns=answer.stamp_ns,
            answer=answer,
        )
        return self.to_msg(answer, frame, into=into)

    def answer_of(self, msg: Msg, *, world: World) -> AnswerOfBody:
        """Return the answer in a response. ``world`` contains the bodies' centres of mass.

        Raise `InvalidFieldError` if a number is not allowed, or arrays have unequal lengths.
        """
        name: str = self._body_name(msg)
        return self.from_msg(msg, Frame(p_FB_F=center_of_mass(name, world), body_name=name, world=world))


def _write_no_fit(msg: PredictImpact.Response) -> None:
    msg.fit_position_residual = msg.fit_orientation_residual = math.nan


_FIT: Final = Table(
    FitQuality,
    PredictImpact.Response,
    Row("count", "fit_count"),
    Row("position_residual", "fit_position_residual"),
    Row("orientation_residual", "fit_orientation_residual"),
)
FIT: Final = _FIT.nested(lambda msg: msg.fit_count == 0, _write_no_fit)
"""The quality of the fit that estimated the state, or None without a fit."""
