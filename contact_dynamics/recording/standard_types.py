"""This file has the texts of the types of published states, for recordings that do not contain them.

Bags of rosbag2 in SQLite from before ROS 2 Iron name the types of their topics and nothing more. These types
have been the same since ROS 2 began.
"""

from __future__ import annotations

from typing import Final

_SEPARATOR: Final = "=" * 80

_TEXTS: Final = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec\n",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "geometry_msgs/Point": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z\n",
    "geometry_msgs/Pose": "Point position\nQuaternion orientation\n",
    "geometry_msgs/Twist": "Vector3 linear\nVector3 angular\n",
    "geometry_msgs/PoseWithCovariance": "Pose pose\nfloat64[36] covariance\n",
    "geometry_msgs/TwistWithCovariance": "Twist twist\nfloat64[36] covariance\n",
    "geometry_msgs/PoseStamped": "std_msgs/Header header\nPose pose\n",
    "geometry_msgs/TwistStamped": "std_msgs/Header header\nTwist twist\n",
    "nav_msgs/Odometry": (
        "std_msgs/Header header\nstring child_frame_id\n"
        "geometry_msgs/PoseWithCovariance pose\ngeometry_msgs/TwistWithCovariance twist\n"
    ),
    "rosgraph_msgs/Clock": "builtin_interfaces/Time clock\n",
}


def standard_definition(type_name: str) -> str:
    """Return the text of "package/msg/Name" in MCAP's ros2msg form, or an empty one for an unknown type."""
    name = type_name.replace("/msg/", "/")
    return _DEFINITIONS.get(name, "")


_DEFINITIONS: Final = {
    name: "".join(
        [text, *(f"{_SEPARATOR}\nMSG: {other}\n{part}" for other, part in _TEXTS.items() if other != name)]
    )
    for name, text in _TEXTS.items()
}
