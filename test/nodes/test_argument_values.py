# SPDX-License-Identifier: Apache-2.0
"""Values of the command line are of the type that ROS itself makes of them."""

from __future__ import annotations

import pytest
import rclpy
from rclpy.context import Context
from rclpy.node import Node
from rclpy.parameter import Parameter

from contact_dynamics.nodes.parameter_mistakes import values_given, what_is_wrong

TYPES = {
    Parameter.Type.BOOL: bool,
    Parameter.Type.INTEGER: int,
    Parameter.Type.DOUBLE: float,
    Parameter.Type.STRING: str,
}
SCALARS = (
    *("true", "True", "no", "Y", "on", "OFF", "tRUE", "yess"),
    *("0", "-3", "+3", "0x1F", "1_000", "3.0", "3.", ".5", "-.5", "1e3", "1.5E-3", "1e", "--3"),
    *(".nan", ".inf", "-.inf", "nan", "inf", "abc", "/brick/odometry", "a b", "3 m", "'3'", '"true"'),
)
LISTS = ("[1.0]", "[1, 2]", "[a, b]", "['']", "[true]")


def test_each_text_has_the_type_that_ros_gives_it() -> None:
    arguments = ["--ros-args"]
    for i, text in enumerate((*SCALARS, *LISTS)):
        arguments += ["-p", f"p{i}:={text}"]
    context = Context()
    rclpy.init(context=context)
    node = Node(
        "typed",
        context=context,
        cli_args=arguments,
        use_global_arguments=False,
        automatically_declare_parameters_from_overrides=True,
    )
    given = values_given(arguments, "/typed")
    try:
        for i, text in enumerate((*SCALARS, *LISTS)):
            wanted = TYPES.get(node.get_parameter(f"p{i}").type_, list)
            assert what_is_wrong(given[f"p{i}"], wanted) == "", (text, wanted)
    finally:
        node.destroy_node()
        rclpy.shutdown(context=context)


@pytest.mark.parametrize(
    ("text", "wanted", "allowed"),
    [
        ("1", bool, "true or false"),
        ("1.5", int, "a whole number"),
        ("1", float, "a number with a point, such as 1.0"),
        ("5", str, "a text"),
        ("1.0", list, "a list with an entry, such as [1.0]"),
        ("[ ]", list, "a list with an entry, such as [1.0]"),
        ("", str, ""),
    ],
)
def test_another_type_is_told_with_what_is_allowed(text: str, wanted: type, allowed: str) -> None:
    assert what_is_wrong(text, wanted) == allowed


def test_the_last_value_for_the_node_counts() -> None:
    arguments = ["--ros-args", "-p", "a:=1", "--param", "a:=2", "-p", "other:a:=3", "-p", "server:b:=4"]
    assert values_given(arguments, "/server") == {"a": "2", "b": "4"}
