# SPDX-License-Identifier: Apache-2.0
"""Values of parameters on the command line."""

from __future__ import annotations

from typing import Any

import pytest

from contact_dynamics.nodes.parameter_file import values_given


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("true", True),
        ("no", False),
        ("-3", -3),
        ("3.", 3.0),
        ("1e3", 1000.0),
        ("1.5E-3", 0.0015),
        ("/brick/odometry", "/brick/odometry"),
        ("'3'", "3"),
        ("3 m", "3 m"),
        ("", ""),
        ("2026-11-27", "2026-11-27"),
        ("[1.0, 2]", [1.0, 2]),
        ("[a, b]", ["a", "b"]),
        ("[ ]", "[ ]"),
        ("{a: 1}", "{a: 1}"),
    ],
)
def test_a_text_is_read_as_yaml_has_it(text: str, value: Any) -> None:
    (found,) = values_given(["--ros-args", "-p", f"a:={text}"], "/server").values()
    assert (type(found), found) == (type(value), value)


def test_the_last_value_for_the_node_counts() -> None:
    arguments = ["--ros-args", "-p", "a:=1", "--param", "a:=2", "-p", "other:a:=3", "-p", "server:b:=4"]
    assert values_given(arguments, "/server") == {"a": 2, "b": 4}
