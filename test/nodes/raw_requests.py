# SPDX-License-Identifier: Apache-2.0
"""Sends bytes to the request topics of a server's services, as ``raw_requests.py COUNT SEED``.

A process of its own, since it calls the middleware (rmw) directly. rclpy cannot: it puts a slash before the
name of every topic, and the topics of requests have none. Half of what it sends is random, and half are
requests some of whose bytes are changed. It writes how many listeners it has found.
"""

from __future__ import annotations

import ctypes
import random
import re
import sys
import time
from pathlib import Path
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.serialization import serialize_message

from contact_dynamics_interfaces.msg import BodyState
from contact_dynamics_interfaces.srv import PredictBodiesContactMode
from running_server import PATIENCE_S, SERVICES

BETWEEN_S = 0.002
RELIABLE, VOLATILE, KEEP_LAST, AUTOMATIC = 1, 2, 1, 1  # of rmw/types.h
PACKAGE = "contact_dynamics_interfaces"


class Duration(ctypes.Structure):
    _fields_ = (("sec", ctypes.c_uint64), ("nsec", ctypes.c_uint64))


class Qos(ctypes.Structure):
    """rmw_qos_profile_t of Jazzy."""

    _fields_ = (
        ("history", ctypes.c_int),
        ("depth", ctypes.c_size_t),
        ("reliability", ctypes.c_int),
        ("durability", ctypes.c_int),
        ("deadline", Duration),
        ("lifespan", Duration),
        ("liveliness", ctypes.c_int),
        ("lease", Duration),
        ("avoid_ros_namespace_conventions", ctypes.c_bool),
    )


class Options(ctypes.Structure):
    """rmw_publisher_options_t of Jazzy."""

    _fields_ = (("payload", ctypes.c_void_p), ("unique_flow", ctypes.c_int))


class Serialized(ctypes.Structure):
    """rcutils_uint8_array_t, without the allocator's functions, which nobody calls."""

    _fields_ = (
        ("buffer", ctypes.c_char_p),
        ("length", ctypes.c_size_t),
        ("capacity", ctypes.c_size_t),
        ("allocator", ctypes.c_void_p * 5),
    )


def _library(name: str) -> ctypes.CDLL:
    """Return a library that this process has loaded already."""
    maps = Path("/proc/self/maps").read_text(encoding="utf-8")
    return ctypes.CDLL(re.findall(rf"/.*/lib{name}\.so", maps)[0])


class Writer:
    """Writes bytes into the topic of a service's requests."""

    def __init__(self, node: Node, service: Any, name: str) -> None:
        self._rmw = _library("rmw_fastrtps_cpp")
        rcl = _library("rcl")
        types = _library(f"{PACKAGE}__rosidl_typesupport_c")
        rcl.rcl_node_get_rmw_handle.restype = self._rmw.rmw_create_publisher.restype = ctypes.c_void_p
        type_name = f"{PACKAGE}__srv__{service.__name__}_Request"
        find_type = types[f"rosidl_typesupport_c__get_message_type_support_handle__{type_name}"]
        find_type.restype = ctypes.c_void_p
        none = Duration(0, 0)
        qos = Qos(
            KEEP_LAST,
            1000,
            RELIABLE,
            VOLATILE,
            none,
            none,
            AUTOMATIC,
            none,
            avoid_ros_namespace_conventions=True,
        )
        with node.handle:
            made = self._rmw.rmw_create_publisher(
                ctypes.c_void_p(rcl.rcl_node_get_rmw_handle(ctypes.c_void_p(node.handle.pointer))),
                ctypes.c_void_p(find_type()),
                f"rq{name}Request".encode(),
                ctypes.byref(qos),
                ctypes.byref(Options(None, 0)),
            )
        assert made, name
        self._publisher = ctypes.c_void_p(made)

    def listeners(self) -> int:
        count = ctypes.c_size_t(0)
        assert self._rmw.rmw_publisher_count_matched_subscriptions(self._publisher, ctypes.byref(count)) == 0
        return count.value

    def write(self, data: bytes) -> None:
        message = Serialized(data, len(data), len(data))
        assert self._rmw.rmw_publish_serialized_message(self._publisher, ctypes.byref(message), None) == 0


def drawn(draw: random.Random, request: bytes) -> bytes:
    """Random bytes, or a request some of whose bytes are others."""
    if draw.random() < 0.5:
        return b"\0\1\0\0" + draw.randbytes(draw.randrange(0, 2000))
    changed = bytearray(request)
    for _ in range(draw.randrange(1, 20)):
        changed[draw.randrange(4, len(changed))] = draw.randrange(256)
    return bytes(changed[: draw.choice((len(changed), draw.randrange(4, len(changed))))])


def about_the_brick(service: Any) -> Any:
    """A request that names the brick."""
    if service is PredictBodiesContactMode:
        return service.Request(states=[BodyState(body_name="brick")])
    return service.Request(body_name="brick")


def main(count: int, seed: int) -> None:
    """Send so many messages to each service."""
    rclpy.init()
    node = Node("raw_requests")
    draw = random.Random(seed)
    # It also loads the libraries that a writer looks for.
    requests = {service: bytes(serialize_message(about_the_brick(service))) for service in SERVICES}
    writers = {service: Writer(node, service, name) for service, name in SERVICES.items()}
    deadline = time.monotonic() + PATIENCE_S
    while not all(writer.listeners() for writer in writers.values()):
        assert time.monotonic() < deadline, "nobody listens"
        time.sleep(0.01)
    sys.stdout.write(f"{sum(writer.listeners() for writer in writers.values())}\n")
    sys.stdout.flush()
    for _ in range(count):
        for service, writer in writers.items():
            writer.write(drawn(draw, requests[service]))
            time.sleep(BETWEEN_S)
    rclpy.shutdown()


main(int(sys.argv[1]), int(sys.argv[2]))
