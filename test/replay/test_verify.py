# SPDX-License-Identifier: Apache-2.0
"""Logs of a real server, asked again: all is as it was, and what was changed is found and named."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from rcl_interfaces.msg import ParameterEvent
from rclpy.serialization import deserialize_message, serialize_message

from contact_dynamics.questions.services import SERVICES
from contact_dynamics.recording import BagReader, BagWriter, LoggedMessage, NotALogError, service_calls
from contact_dynamics.recording.definitions import find_definition
from contact_dynamics.recording.errors import DamagedLogWarning
from contact_dynamics.recording.message_types import message_types
from contact_dynamics.replay.of_log import digest
from contact_dynamics.replay.run import main
from contact_dynamics.replay.verify import (
    ServiceTally,
    Verification,
    differences,
    in_words,
    note_difference,
    report,
    verify_log,
)
from contact_dynamics_interfaces.srv import PredictImpact, PredictTumbling
from message_words import says
from replay.asked_log import Asked, configured, without_ros
from replay.flights import CONFIGURATION, write_flight
from running_server import ROOT


def as_it_is(message: LoggedMessage) -> bytes:
    return message.data


def copied(
    asked: Asked,
    folder: Path,
    *,
    run: Callable[[dict[str, str]], dict[str, str]] = dict,
    data_of: Callable[[LoggedMessage], bytes] = as_it_is,
    until: int | None = None,
) -> Path:
    """A copy of a log, with another record of its run, other messages, or only the first of them."""
    reader = BagReader(asked.log)
    with BagWriter(folder / "copy", run=run(reader.run())) as writer:
        messages = list(reader.messages())
        for topic, type_name in sorted({(message.topic, message.type_name) for message in messages}):
            writer.add_topic(topic, type_name)
        for message in messages[:until]:
            writer.write(
                message.topic,
                data_of(message),
                log_time_ns=message.log_time_ns,
                publish_time_ns=message.publish_time_ns,
            )
    return folder / "copy"


def changed(parameter: str, value: object) -> Callable[[dict[str, str]], dict[str, str]]:
    """What changes one parameter in the record of a run."""

    def change(run: dict[str, str]) -> dict[str, str]:
        parameters = json.loads(run["parameters"])
        assert parameters[parameter] != value
        return {**run, "parameters": json.dumps({**parameters, parameter: value})}

    return change


def assert_all_equal(found: Verification, asked: Asked) -> None:
    """Every question was asked again and answered as in the log."""
    told = [(other.service, other.number, other.differences) for other in found.others]
    assert told == []
    assert found.agrees
    assert {name.rpartition("/")[2]: tally.equal for name, tally in found.services.items()} == {
        "predict_tumbling": asked.counts["PredictTumbling"],
        "predict_impact": asked.counts["PredictImpact"],
        "predict_contact_mode": asked.counts["PredictContactMode"],
        "predict_toss": asked.counts["PredictToss"],
        "predict_impact_batch": asked.counts["PredictImpactBatch"],
        "predict_tumbling_batch": asked.counts["PredictTumblingBatch"],
        "predict_contact_mode_batch": asked.counts["PredictContactModeBatch"],
        "predict_bodies_contact_mode": asked.counts["PredictBodiesContactMode"],
    }
    assert found.damage is None


def test_every_answer_is_equal_to_the_bit(asked: Asked) -> None:
    assert_all_equal(verify_log(asked.log), asked)


def test_it_needs_no_ros(asked: Asked) -> None:
    done = without_ros(asked.log)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [line.split() for line in done.stdout.splitlines() if "/predict_" in line]
    assert sum(int(row[1]) for row in rows) == sum(asked.counts.values())
    assert all(row[1] == row[2] and row[3] == "0" for row in rows)


@pytest.mark.slow
def test_in_an_environment_with_the_library_alone(asked: Asked, tmp_path: Path) -> None:
    environment = tmp_path / "environment"
    subprocess.run([sys.executable, "-m", "venv", environment], check=True)
    pip = [environment / "bin" / "pip", "install", "--quiet", "--disable-pip-version-check", ROOT]
    subprocess.run(pip, check=True, cwd=tmp_path)
    outside = {
        key: value for key, value in os.environ.items() if key not in {"PYTHONPATH", "AMENT_PREFIX_PATH"}
    }
    command = [environment / "bin" / "contact-dynamics", "replay", asked.log]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=outside, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert sum(int(line.split()[2]) for line in done.stdout.splitlines() if "/predict_" in line) == sum(
        asked.counts.values()
    )
    write_flight(tmp_path / "bag")
    (tmp_path / "flights.yaml").write_text(CONFIGURATION)
    command = [command[0], "replay", "table", tmp_path / "bag", "--ask", "landing"]
    command += ["--config", tmp_path / "flights.yaml", "--topics", "ball=/tracker/ball"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=outside, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(done.stdout.splitlines()) == 1 + 10


def test_a_changed_constant_is_found_with_question_and_field(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    log = copied(asked, tmp_path, run=changed("surface.floor.friction", 0.41))
    found = verify_log(log)
    assert not found.agrees
    assert found.services["/contact_dynamics/predict_tumbling"].different == 0
    other = next(other for other in found.others if other.service.endswith("predict_contact_mode"))
    request_times = {
        call.request_event.log_time_ns
        for call in service_calls(BagReader(log).messages())
        if call.request_event
    }
    assert other.asked_ns in request_times
    assert main([str(log)]) == 1
    printed = capsys.readouterr().out
    assert f"request {other.number}, received" in printed
    for each in other.differences:
        assert re.match(r"(number of )?((refused_)?modes|refusal\w+|contacts.frictions)|verdict", each.field)
        assert f"{each.field}: logged " in printed


def test_what_if_friction_had_been_another(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A value on the command line or in a file gives the answers that a log with this value in it gives."""
    inside = verify_log(copied(asked, tmp_path, run=changed("surface.floor.friction", 0.31)))
    given = verify_log(asked.log, instead={"surface.floor.friction": 0.31})
    assert [other.differences for other in given.others] == [other.differences for other in inside.others]
    assert given.services["/contact_dynamics/predict_contact_mode"].different > 0
    ranks = [other.differences[0].rank for other in given.others]
    assert ranks == sorted(ranks)
    for other in given.others:
        fields = [each.rank for each in other.differences]
        assert fields == sorted(fields)
    assert main(["verify", str(asked.log), "--set", "surface.floor.friction:=0.31"]) == 1
    on_the_line = capsys.readouterr().out
    assert "with other parameters than logged: surface.floor.friction 0.31" in on_the_line
    text = configured(tmp_path).read_text(encoding="utf-8")
    friction = json.loads(BagReader(asked.log).run()["parameters"])["surface.floor.friction"]
    (tmp_path / "same.yaml").write_text(text, encoding="utf-8")
    assert main(["verify", str(asked.log), "--config", str(tmp_path / "same.yaml")]) == 0
    arguments = ["--config", str(tmp_path / "same.yaml"), "--set", "surface.floor.friction:=0.31"]
    capsys.readouterr()
    assert main(["verify", str(asked.log), *arguments]) == 1
    assert on_the_line.splitlines()[2:] == capsys.readouterr().out.splitlines()[2:]
    assert main(["verify", str(asked.log), "--set", f"surface.floor.friction:={friction}"]) == 0


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("surface.flor.friction:=0.3", "surface.flor.friction"),
        ("surface.floor.friction:=-1", "surface.floor.friction"),
        ("surface.floor.friction:=much", "surface.floor.friction must be a number..., got 'much'"),
        ("surface.floor.friction=0.3", "--set must be NAME:=VALUE, got 'surface.floor.friction=0.3'"),
    ],
)
def test_another_configuration_that_is_none_is_refused(
    asked: Asked, capsys: pytest.CaptureFixture[str], given: str, told: str
) -> None:
    assert main(["verify", str(asked.log), "--set", given]) == 2
    printed = capsys.readouterr()
    assert says(printed.err, told)
    assert printed.out == ""


def test_a_difference_within_the_tolerance_is_counted_apart(asked: Asked, tmp_path: Path) -> None:
    friction = json.loads(BagReader(asked.log).run()["parameters"])["surface.floor.friction"]
    log = copied(asked, tmp_path, run=changed("surface.floor.friction", friction * (1.0 + 1e-13)))
    tally = verify_log(log, tolerance=1e-6).services["/contact_dynamics/predict_contact_mode"]
    assert tally.different == 0
    assert tally.within > 0
    assert verify_log(log).services["/contact_dynamics/predict_contact_mode"].different == tally.within


def test_quaternions_of_one_attitude_agree_within_a_tolerance(asked: Asked, tmp_path: Path) -> None:
    """Both q and -q, in messages and in lists. Without a tolerance every bit counts.

    Of one answer the attitude differs too, by 0.01 in a part of each quaternion.
    """
    events = {"predict_impact": PredictImpact.Event, "predict_tumbling": PredictTumbling.Event}
    changed = dict.fromkeys(events, 0)

    def turned(message: LoggedMessage) -> bytes:
        name = message.topic.split("/")[-2]
        if name not in events:
            return message.data
        event = deserialize_message(message.data, events[name])
        for response in event.response:
            if response.status != response.OK:
                continue
            off = 0.01 if changed[name] == 0 else 0.0
            changed[name] += 1
            if name == "predict_impact":
                q = response.impact.state_after.pose.orientation
                q.x, q.y, q.z, q.w = -q.x, -q.y, -q.z, -q.w + off
            else:
                response.trajectory.orientations = [-x + off for x in response.trajectory.orientations]
        return serialize_message(event)

    log = copied(asked, tmp_path, data_of=turned)
    for tolerance, differing in ((1e-12, dict.fromkeys(events, 1)), (0.0, changed)):
        tallies = verify_log(log, tolerance=tolerance).services
        found = {name: tallies[f"/contact_dynamics/{name}"] for name in events}
        assert {name: tally.different for name, tally in found.items()} == differing
        within = {name: tally.within for name, tally in found.items()}
        assert within == {name: changed[name] - count for name, count in differing.items()}


def test_other_versions_are_told(asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = copied(asked, tmp_path, run=lambda run: {**run, "numpy": "1.26.0"})
    assert main([str(log)]) == 0
    assert "numpy 1.26.0 (here " in capsys.readouterr().out


def test_a_truncated_log_is_asked_as_far_as_it_goes(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (whole,) = asked.log.glob("*.mcap")
    cut = tmp_path / "cut.mcap"
    with whole.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    middle = summary.chunk_indexes[len(summary.chunk_indexes) // 2]
    cut.write_bytes(whole.read_bytes()[: middle.chunk_start_offset + middle.chunk_length // 2])
    found = verify_log(cut)
    assert found.agrees
    assert found.damage is not None
    questions_left = sum(tally.equal for tally in found.services.values())
    assert 0 < questions_left < sum(asked.counts.values())
    assert main([str(cut)]) == 0
    assert "is damaged or was cut short" in capsys.readouterr().out


def test_a_log_that_is_still_being_written_is_not_called_damaged(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nor is that of a server that was killed. Both end after a whole record."""
    (whole,) = asked.log.glob("*.mcap")
    with whole.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    middle = summary.chunk_indexes[len(summary.chunk_indexes) // 2]
    size = middle.chunk_start_offset + middle.chunk_length + middle.message_index_length
    written = tmp_path / "written.mcap"
    written.write_bytes(whole.read_bytes()[:size])
    assert main([str(written)]) == 0
    said = capsys.readouterr().out
    assert f"{written} is still being written, or its writer was killed; all {size} bytes of it" in said
    assert "damaged" not in said
    assert "can differ" not in said


def with_a_flipped_bit_in_its_record(log: Path) -> Path:
    """The log, whose record of the run is damaged. What `metadata.yaml` says is whole."""
    (path,) = log.glob("*.mcap")
    data = bytearray(path.read_bytes())
    data[data.index(b"surface.floor.friction")] ^= 1
    path.write_bytes(data)
    return log


def test_a_flipped_bit_in_the_record_of_the_run_does_not_cost_the_log(asked: Asked, tmp_path: Path) -> None:
    log = with_a_flipped_bit_in_its_record(copied(asked, tmp_path))
    with pytest.warns(DamagedLogWarning, match="record of how the run was made fails its checksum"):
        assert BagReader(log).run() == BagReader(asked.log).run()
    found = verify_log(log)
    assert sum(tally.equal for tally in found.services.values()) == sum(asked.counts.values())
    assert found.agrees
    (path,) = log.glob("*.mcap")
    assert main([str(path)]) == 0  # one file of the folder
    (log / "metadata.yaml").unlink()
    with pytest.raises(NotALogError, match="does not contain the server's configuration"):
        verify_log(log)


def test_a_record_from_after_a_change_is_not_taken_for_that_of_the_beginning(tmp_path: Path) -> None:
    """`metadata.yaml` has the last configuration, and the changes in the log begin with the first."""
    before, after = ({"parameters": json.dumps({"surface.floor.friction": mu})} for mu in (0.3, 0.4))
    event = "contact_dynamics_interfaces/srv/PredictImpact_Event"
    with BagWriter(tmp_path / "log", run=before) as writer:
        writer.add_topic("/contact_dynamics/predict_impact/_service_event", event)
        writer.add_topic("/parameter_events", "rcl_interfaces/msg/ParameterEvent")
        data = bytes(serialize_message(ParameterEvent(node="/contact_dynamics")))
        writer.write("/parameter_events", data, log_time_ns=5, publish_time_ns=5)
        writer.change_run(after)
    log = with_a_flipped_bit_in_its_record(tmp_path / "log")
    with pytest.raises(NotALogError, match="what is left of it is from after a change"):
        verify_log(log)


def test_a_log_of_another_kind_is_refused_by_name(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with BagWriter(tmp_path / "other", run={"body": "cube"}) as writer:
        writer.add_topic("/pose", "geometry_msgs/msg/PoseStamped")
    with pytest.raises(NotALogError, match=r"other: not a log of the server.*geometry_msgs/msg/PoseStamped"):
        verify_log(tmp_path / "other")
    without_run = copied(asked, tmp_path, run=lambda _run: {})
    with pytest.raises(NotALogError, match="does not contain the server's configuration"):
        verify_log(without_run)
    (whole,) = asked.log.glob("*.mcap")
    (tmp_path / "begun.mcap").write_bytes(whole.read_bytes()[:3000])  # it has no types yet
    with pytest.raises(NotALogError, match=r"begun.mcap: not a log of the server.*was cut short"):
        verify_log(tmp_path / "begun.mcap")
    (tmp_path / "empty").mkdir()
    with pytest.raises(NotALogError, match="empty: no MCAP file here"):
        verify_log(tmp_path / "empty")
    assert main([str(tmp_path / "none"), "x" * 300, str(asked.log)]) == 2
    printed = capsys.readouterr()
    assert "none: no such file or folder" in printed.err
    # Python 3.14 says of a name that no file can have that there is no such file.
    assert "File name too long" in printed.err or printed.err.count("no such file or folder") == 2
    assert "predict_tumbling" in printed.out  # the others are asked all the same


def test_logs_are_found_in_folders_of_folders(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As the demo leaves them: a folder for each run, and the log's folder in it. A link may lead back."""
    run = tmp_path / "logs" / "run"
    run.mkdir(parents=True)
    (run / "back").symlink_to(tmp_path / "logs")
    log = copied(asked, run)
    assert main([str(tmp_path / "logs")]) == 0
    assert capsys.readouterr().out.splitlines()[0] == str(log)


def with_other_definitions(log: Path, to: Path, old: bytes, new: bytes) -> Path:
    """A copy of a log, as an older version would have written it: its types have another text."""
    (whole,) = log.glob("*.mcap")
    with whole.open("rb") as stream, to.open("wb") as copy:
        reader, writer = make_reader(stream), Writer(copy)
        writer.start(profile="ros2")
        schemas: dict[int, int] = {}
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            if schema.id not in schemas:
                text = schema.data.replace(old, new)
                schemas[schema.id] = writer.register_schema(schema.name, schema.encoding, text)
            if channel.id not in channels:
                channels[channel.id] = writer.register_channel(
                    channel.topic, channel.message_encoding, schemas[schema.id], channel.metadata
                )
            writer.add_message(
                channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence
            )
        for metadata in reader.iter_metadata():
            writer.add_metadata(metadata.name, metadata.metadata)
        writer.finish()
    return to


def test_a_log_of_other_definitions_is_refused_with_their_names(
    asked: Asked, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its questions would be read by this version's adapters, and its answers mean something else."""
    log = with_other_definitions(asked.log, tmp_path / "older.mcap", b"time_to_contact", b"time_of_contact")
    assert main([str(log)]) == 2
    told = capsys.readouterr().err
    assert "older.mcap: fields of PredictImpact must be those of this version, got others" in told
    assert "another version of contact_dynamics (" in told
    assert "or its interfaces were not built after their last change (make setup)" in told
    same = with_other_definitions(
        asked.log, tmp_path / "comment.mcap", b"# Where the body", b"# Where a body"
    )
    assert_all_equal(verify_log(same), asked)


def test_the_known_digests_are_those_of_the_interface_files() -> None:
    """After a change of an interface, put what this test finds into `questions/services.py`."""
    found = {
        service.type_name: digest(event, find_definition(event).text)
        for service in SERVICES
        for event in [f"contact_dynamics_interfaces/srv/{service.type_name}_Event"]
    }
    assert found == {service.type_name: service.digest for service in SERVICES}


def test_questions_without_an_answer_are_told(asked: Asked, tmp_path: Path) -> None:
    events = (m.topic.endswith("/_service_event") for m in BagReader(asked.log).messages())
    *_, last = (index for index, is_event in enumerate(events) if is_event)
    found = verify_log(copied(asked, tmp_path, until=last))
    assert found.agrees
    assert sum(tally.unanswered for tally in found.services.values()) == 1


@pytest.mark.parametrize("code", ["BUSY", "TIMEOUT"])
def test_responses_that_depend_on_the_load_are_not_compared(asked: Asked, tmp_path: Path, code: str) -> None:
    topic = "/contact_dynamics/predict_impact/_service_event"
    *_, last = BagReader(asked.log).messages([topic])
    event = deserialize_message(last.data, PredictImpact.Event)
    event.response[0].status = getattr(PredictImpact.Response, code)

    def busy(message: LoggedMessage) -> bytes:
        return serialize_message(event) if message == last else message.data

    found = verify_log(copied(asked, tmp_path, data_of=busy))
    assert found.agrees
    assert [tally.unanswered for tally in found.services.values() if tally.unanswered] == [1]


def test_differences_are_told_by_what_changes_most(tmp_path: Path) -> None:
    """Named values and single numbers first, then elements, what rounding hides, and lengths."""
    definition = (
        "uint8 SLIDES = 1\nuint8 STICKS = 2\nuint8 outcome\nfloat64 energy\nfloat64 time\nfloat64[] path"
    )
    made = message_types("some/msg/Answer", definition)["some/Answer"]
    logged = made(outcome=1, energy=1.0, time=0.1 + 0.2, path=[1.0, 2.0])
    recomputed = made(outcome=2, energy=1.23456789, time=0.3, path=[1.5, 2.0])
    longer = made(outcome=1, energy=1.0, time=0.3, path=[1.5])
    told = sorted(differences(logged, recomputed), key=lambda each: each.rank)
    assert [in_words(each) for each in told] == [
        "outcome: logged 'SLIDES', recomputed 'STICKS'",
        "energy: logged 1, recomputed 1.23457",
        "path[0]: logged 1, recomputed 1.5",
        "time: logged 0.30000000000000004, recomputed 0.3",
    ]
    told = sorted(differences(logged, longer), key=lambda each: each.rank)
    assert [each.field for each in told] == ["time", "number of path"]
    found = Verification(path=tmp_path, tolerance=0.0, versions={}, versions_now={})
    found.services["/predict"] = ServiceTally()
    for other in (recomputed, recomputed, longer, recomputed):
        note_difference(found, "/predict", differences(logged, other), asked_ns=1)
    assert [other.repeated for other in found.others] == [2, 0]
    assert "    the same in 2 further requests\n" in report(found)
    assert "more requests" not in report(found)
