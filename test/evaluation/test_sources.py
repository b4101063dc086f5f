# SPDX-License-Identifier: Apache-2.0
"""What paths of a command line name, and what identifies it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np

from contact_dynamics.evaluation.sources import Source, find_sources
from contact_dynamics.measured.read_toss import DEFAULT_RECORDING
from evaluation.made_logs import write_log


def tosses(path: Path, count: int) -> Path:
    """A file of tosses, each of which is at rest."""
    rows = np.zeros((30 * count, 14))
    rows[:, 0] = np.arange(len(rows)) / 148.0
    rows[:, 7] = 1.0
    np.savez(path, data=rows, offsets=30 * np.arange(count + 1))
    return path


def test_a_folder_holds_its_recordings_at_any_depth(tmp_path: Path) -> None:
    log = write_log(tmp_path / "deep" / "log")
    (bare,) = log.glob("*.mcap")
    alone = tmp_path / "alone.mcap"
    shutil.copy(bare, alone)
    toss = tmp_path / "brick.csv"
    shutil.copy(DEFAULT_RECORDING, toss)
    npz = tosses(tmp_path / "many.npz", 3)
    (tmp_path / "notes.txt").write_text("nothing", encoding="utf-8")
    (tmp_path / "old.mcap.bak").write_text("nothing", encoding="utf-8")
    found, refused = find_sources([str(tmp_path)])
    assert refused == []
    # a bag's folder counts once, however many files it has
    assert {source.name for source in found} == {
        *(str(log), str(alone), str(toss)),
        *(f"{npz}#{index}" for index in range(3)),
    }


def test_a_recording_that_is_named_twice_counts_once(tmp_path: Path) -> None:
    npz = tosses(tmp_path / "many.npz", 3)
    found, _ = find_sources([f"{npz}#1", str(npz), str(npz)])
    assert [source.index for source in found] == [1, 0, 2]


def test_what_names_nothing_is_refused_with_the_reason_and_the_rest_is_found(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "bad.npz").write_bytes(b"no numbers")
    paths = [str(tmp_path / name) for name in ("empty", "nowhere", "bad.npz")]
    found, refused = find_sources([*paths, str(DEFAULT_RECORDING)])
    assert [source.path for source in found] == [DEFAULT_RECORDING]
    assert [name for name, _ in refused] == paths
    for (_, reason), told in zip(
        refused, ("no recording in it", "no such file", "an .npz of plain arrays"), strict=True
    ):
        assert told in reason


def test_the_digest_follows_the_content(tmp_path: Path) -> None:
    first, second = (write_log(tmp_path / name, seed=seed) for name, seed in (("a", 1), ("b", 2)))
    moved = tmp_path / "moved"
    shutil.copytree(first, moved)
    digests = [Source(path=path).digest() for path in (first, second, moved)]
    assert digests[0] == digests[2] != digests[1]
    (file,) = moved.glob("*.mcap")
    file.write_bytes(file.read_bytes() + b"\0")
    assert Source(path=moved).digest() != digests[0]
    npz = tosses(tmp_path / "many.npz", 2)
    assert Source(path=npz, index=0).digest() != Source(path=npz, index=1).digest()
