# SPDX-License-Identifier: Apache-2.0
"""The log: all received states, requests and responses, in MCAP files in the layout of Jazzy's rosbag2.

`BagWriter` writes a log from one thread, and `Recorder` writes it beside a server. `BagReader` and
`service_calls` read it. `decode` makes messages of the classes of ROS, and `decode_without_ros` makes them
from the definitions in the log.
"""

from contact_dynamics.recording.bag_metadata import OfferedQos
from contact_dynamics.recording.bag_reader import BagReader, LoggedMessage
from contact_dynamics.recording.bag_writer import BagWriter
from contact_dynamics.recording.cdr import decode_without_ros
from contact_dynamics.recording.errors import (
    DamagedLogWarning,
    LogExistsError,
    LogFailedError,
    NotALogError,
    UnfinishedLogWarning,
)
from contact_dynamics.recording.file_messages import Loss
from contact_dynamics.recording.limits import Compression, LogLimits
from contact_dynamics.recording.message_types import decode
from contact_dynamics.recording.recorder import Recorder, RecorderStatus
from contact_dynamics.recording.service_calls import EVENT_TOPIC_SUFFIX, ServiceCall, service_calls
from contact_dynamics.validation_types import check_types_of

__all__ = [
    "EVENT_TOPIC_SUFFIX",
    "BagReader",
    "BagWriter",
    "Compression",
    "DamagedLogWarning",
    "LogExistsError",
    "LogFailedError",
    "LogLimits",
    "LoggedMessage",
    "Loss",
    "NotALogError",
    "OfferedQos",
    "Recorder",
    "RecorderStatus",
    "ServiceCall",
    "UnfinishedLogWarning",
    "decode",
    "decode_without_ros",
    "service_calls",
]

check_types_of(globals())
