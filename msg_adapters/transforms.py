# SPDX-License-Identifier: Apache-2.0
"""Reads the tree of frames in `tf2_msgs/TFMessage`, and returns the pose of a frame in another one.

Each transform is the pose of a child frame in its parent. The pose of a frame in another one follows from the
paths of both to their common ancestor. There is no interpolation: a moving link is valid only at its own
stamp. `tf2` interpolates, but has no wheel for Python, and its buffer of all frames over time is not required
here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from contact_dynamics.errors import FrameMismatchError, InvalidFieldError
from contact_dynamics.rotations.one import conjugate, product, rotated, rotation_matrix
from contact_dynamics.validation import check_array, check_unit
from msg_adapters.geometry import quaternion_from_msg, vector_from_msg
from msg_adapters.stamps import stamp_ns_from_msg

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from geometry_msgs.msg import TransformStamped

    from contact_dynamics.rotations.one import Quaternion
    from contact_dynamics.validation import FloatArray


class TFMessage(Protocol):
    """The fields of `tf2_msgs/TFMessage`. The package is required only for such a source."""

    transforms: Sequence[TransformStamped]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class FramePose:
    """The pose of a frame in another one."""

    p: FloatArray  # (3,), m, its origin
    q: FloatArray  # (4,), its orientation, unit, x y z w

    @property
    def R(self) -> FloatArray:
        """The rotation matrix, (3, 3)."""
        return rotation_matrix(self.q)

    def of(self, inner: FramePose) -> FramePose:
        """Return the pose of a frame in the outer frame, from its pose ``inner`` in this one."""
        q = _quaternion(self.q)
        turned = np.array(rotated(q, inner.p.tolist()))
        return FramePose(p=self.p + turned, q=np.array(product(q, _quaternion(inner.q))))

    def inverse(self) -> FramePose:
        """Return the pose of the other frame in this one."""
        back = conjugate(_quaternion(self.q))
        return FramePose(p=-np.array(rotated(back, self.p.tolist())), q=np.array(back))


_SAME = FramePose(p=np.zeros(3), q=np.array([0.0, 0.0, 0.0, 1.0]))


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class _Link:
    parent: str
    pose: FramePose
    stamp_ns: int | None  # None if it is static


class TransformTree:
    """The newest transform of each frame."""

    def __init__(self, static: TransformTree | None = None) -> None:
        """Begin without links of its own. Present and later links of ``static`` are included."""
        self._links: dict[str, _Link] = {}
        self._static = static

    def add(self, msg: TFMessage, *, is_static: bool) -> None:
        """Add all transforms of a message.

        Raise `InvalidFieldError` if a frame has no name, a number is not finite, or a quaternion is not unit.
        Earlier transforms of the message are added.
        """
        for i, transform in enumerate(msg.transforms):
            link = _link_from_msg(transform, f"transforms[{i}]", is_static=is_static)
            self._links[transform.child_frame_id] = link

    def stamp_ns(self, frame: str) -> int | None:
        """Return the time of the latest transform of a moving frame, or None if there is none."""
        link = self._links.get(frame)
        return None if link is None else link.stamp_ns

    def pose(self, frame: str, *, in_frame: str, stamp_ns: int, field: str) -> FramePose:
        """Return the pose of a frame in another one at a time, ns.

        Raise `FrameMismatchError` if no transforms connect them, or a moving one has another stamp. The error
        is about ``field``, the message's field with the frame's name.
        """
        to_frame, to_other = dict(self._up(frame)), dict(self._up(in_frame))
        for shared, inner in to_frame.items():
            if shared not in to_other:
                continue
            for other in (*_before(to_frame, shared), *_before(to_other, shared)):
                link = self._link(other)
                if link is not None and link.stamp_ns not in {None, stamp_ns}:
                    raise FrameMismatchError(
                        f"{field} must be a frame with a static transform, or with one at {stamp_ns} ns, got "
                        f"{frame!r}, whose frame {other!r} was last published at {link.stamp_ns} ns"
                    )
            return to_other[shared].inverse().of(inner)
        message = f"{field} must be {in_frame!r}, or a frame with a known transform to it, got {frame!r}"
        raise FrameMismatchError(message)

    def _up(self, frame: str) -> Iterator[tuple[str, FramePose]]:
        """Yield each frame from this one up to the root, with this one's pose in it."""
        pose, seen = _SAME, {frame}
        yield frame, pose
        while (link := self._link(frame)) is not None and link.parent not in seen:
            pose, frame = link.pose.of(pose), link.parent
            seen.add(frame)
            yield frame, pose

    def _link(self, frame: str) -> _Link | None:
        link = self._links.get(frame)
        return self._static._link(frame) if link is None and self._static is not None else link  # noqa: SLF001  another tree


def _before(frames: dict[str, FramePose], last: str) -> list[str]:
    """Return the frames whose links lead up to ``last``."""
    names = list(frames)
    return names[: names.index(last)]


def _link_from_msg(msg: TransformStamped, field: str, *, is_static: bool) -> _Link:
    for name, frame in (("header.frame_id", msg.header.frame_id), ("child_frame_id", msg.child_frame_id)):
        if not frame:
            raise InvalidFieldError(f"{field}.{name}", "nothing", "the name of a frame")
    rotation = check_unit(f"{field}.transform.rotation", quaternion_from_msg(msg.transform.rotation), 4)
    p = check_array(f"{field}.transform.translation", vector_from_msg(msg.transform.translation), (3,))
    stamp_ns = None if is_static else stamp_ns_from_msg(msg.header.stamp)
    return _Link(parent=msg.header.frame_id, pose=FramePose(p=p, q=rotation), stamp_ns=stamp_ns)


def _quaternion(q: FloatArray) -> Quaternion:
    x, y, z, w = q.tolist()
    return x, y, z, w


def check_frame(field: str, found: str, expected: str) -> None:
    """Raise `FrameMismatchError` if a message's frame is not the expected one."""
    if found != expected:
        raise FrameMismatchError(f"{field} must be {expected!r}, got {found!r}")
