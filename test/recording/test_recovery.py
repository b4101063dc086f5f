# SPDX-License-Identifier: Apache-2.0
"""Damaged logs written anew: standard readers take them, and they hold what can be read of the old."""

from __future__ import annotations

import random
import warnings
from pathlib import Path
from typing import Any

import pytest
import yaml
from mcap.reader import SeekingReader
from rosbags.highlevel import AnyReader

from contact_dynamics.command_line import main
from contact_dynamics.recording import BagReader, DamagedLogWarning, LogExistsError
from contact_dynamics.replay.recover import recover
from message_words import says


def messages_in(path: Path) -> list[tuple[str, bytes, int, int]]:
    """All messages that our reader finds."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DamagedLogWarning)
        return [
            (message.topic, message.data, message.log_time_ns, message.publish_time_ns)
            for message in BagReader(path).messages()
        ]


def assert_whole(folder: Path, expected: list[tuple[str, bytes, int, int]]) -> None:
    """Each reader takes the folder without a complaint, and finds these messages."""
    reader = BagReader(folder)
    assert messages_in(folder) == expected
    list(reader.messages())
    assert reader.damage is None
    times = []
    for path in reader.paths:
        with path.open("rb") as stream:
            seeking = SeekingReader(stream, validate_crcs=True)
            times += [message.log_time for _, _, message in seeking.iter_messages(log_time_order=False)]
    assert times == [log_time_ns for _, _, log_time_ns, _ in expected]
    with AnyReader([folder]) as bag:
        found = sorted(data for _, _, data in bag.messages())
    assert found == sorted(data for _, data, _, _ in expected)
    metadata = yaml.safe_load((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert metadata["message_count"] == len(expected)


@pytest.mark.parametrize("share", [0.4, 0.6, 0.8, 0.999])
def test_a_log_that_was_cut_short(real_log: Any, tmp_path: Path, share: float) -> None:
    whole = real_log.path.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: int(share * len(whole))])
    expected = messages_in(cut)
    messages, losses = recover(cut, tmp_path / "new")
    assert messages == len(expected) > 0
    assert losses
    assert_whole(tmp_path / "new", expected)
    assert BagReader(tmp_path / "new").run() == BagReader(real_log.path).run()
    assert BagReader(tmp_path / "new").definitions() == BagReader(real_log.path).definitions()


def test_a_log_with_flipped_bits(real_log: Any, tmp_path: Path) -> None:
    whole = real_log.path.read_bytes()
    draw = random.Random(3)
    for number in range(8):
        data = bytearray(whole)
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
        damaged = tmp_path / f"damaged{number}.mcap"
        damaged.write_bytes(data)
        recover(damaged, tmp_path / f"new{number}")
        assert_whole(tmp_path / f"new{number}", messages_in(damaged))


def test_the_command_names_what_is_lost_and_overwrites_nothing(
    real_log: Any, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(real_log.path.read_bytes()[:-2000])
    assert main(["recover", str(cut)]) == 0
    printed = capsys.readouterr().out
    assert f"{tmp_path / 'cut_recovered'}: {len(messages_in(cut))} messages" in printed
    assert f"lost of {cut}: bytes" in printed
    assert main(["recover", str(cut)]) == 2
    assert "cut_recovered exists; a log is never overwritten" in capsys.readouterr().err
    with pytest.raises(LogExistsError):
        recover(cut, tmp_path / "cut_recovered")
    assert_whole(tmp_path / "cut_recovered", messages_in(cut))


def test_what_cannot_be_recovered_is_refused_by_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "text.mcap").write_text("hello")
    assert main(["recover", str(tmp_path / "text.mcap")]) == 2
    assert "text.mcap is not an MCAP file" in capsys.readouterr().err
    (tmp_path / "bag.db3").write_text("hello")
    assert main(["recover", str(tmp_path / "bag.db3")]) == 2
    assert says(capsys.readouterr().err, "must be MCAP..., got SQLite")
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")
    (tmp_path / "text.mcap").unlink()
    (tmp_path / "bag.db3").unlink()
    for here in (".", ".."):  # a log's folder that was not found there; neither has a name of its own
        assert main(["recover", here]) == 2
        assert f"{here}: no MCAP file here" in capsys.readouterr().err
