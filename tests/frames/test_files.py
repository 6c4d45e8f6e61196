import json
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from pounding.frames import files
from pounding.frames.errors import FrameError
from pounding.frames.files import (
    PART,
    DamageWarning,
    clear_stale,
    part_of,
    read_entry,
    replacing,
    scratch,
    write_entry,
    write_whole,
)


def test_a_file_appears_whole_in_a_new_folder(tmp_path):
    write_whole(tmp_path / "new" / "a.bin", b"whole")
    assert (tmp_path / "new" / "a.bin").read_bytes() == b"whole"
    assert os.listdir(tmp_path / "new") == ["a.bin"]


def test_a_failure_keeps_the_old_file_and_leaves_nothing_else(tmp_path):
    target = tmp_path / "a.txt"
    target.write_text("old")

    def fail():
        with replacing(target) as part:
            part.write_text("half")
            raise RuntimeError("the renderer died")

    with pytest.raises(RuntimeError):
        fail()
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["a.txt"]


def test_a_full_disk_is_told_with_the_file_that_was_wanted(tmp_path, monkeypatch):
    def full(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FrameError, match=r"a\.bin: cannot be written \(No space left on device\)"):
        write_whole(tmp_path / "a.bin", b"much")
    assert os.listdir(tmp_path) == []


def test_a_failure_leaves_no_folder_that_was_made_for_the_file(tmp_path, monkeypatch):
    def full(_descriptor):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(FrameError):
        write_whole(tmp_path / "new" / "newer" / "a.bin", b"much")
    assert os.listdir(tmp_path) == []


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(FrameError, match="cannot be written"):
        write_whole(tmp_path / "taken" / "a.bin", b"")


def test_what_a_killed_process_had_begun_is_hidden_and_goes_with_the_next_file(
    tmp_path, killed_while_writing
):
    left = killed_while_writing(tmp_path / "film.mp4")
    assert left.name.startswith(".")
    assert ".part" in left.name
    files._clear_once.cache_clear()
    write_whole(tmp_path / "other.bin", b"whole")
    assert os.listdir(tmp_path) == ["other.bin"]


def test_two_threads_write_one_file_in_turn(tmp_path):
    def write(content: bytes) -> None:
        for _ in range(50):
            write_whole(tmp_path / "shared.bin", content)

    with ThreadPoolExecutor(2) as pool:
        list(pool.map(write, (b"one" * 1000, b"other" * 1000)))
    assert (tmp_path / "shared.bin").read_bytes() in (b"one" * 1000, b"other" * 1000)
    assert os.listdir(tmp_path) == ["shared.bin"]


def test_what_is_being_written_elsewhere_stays(tmp_path, killed_while_writing):
    left = killed_while_writing(tmp_path / "a.bin")
    mine = part_of(tmp_path / "b.bin")
    mine.write_text("being written by a process that lives: this one")
    found = PART.fullmatch(left.name)
    assert found is not None
    process = found["process"]
    others = left.with_name(f".c.another-computer.{process}.part.bin")
    others.write_text("its processes cannot be asked")
    like = tmp_path / ".notes.part"
    like.write_text("not ours")
    clear_stale(tmp_path)
    assert set(tmp_path.iterdir()) == {mine, others, like}


def test_a_scratch_folder_is_removed_also_after_its_process_was_killed(tmp_path):
    with scratch(tmp_path, "series") as folder:
        (folder / "one").write_text("half")
    assert os.listdir(tmp_path) == []
    process = subprocess.Popen([sys.executable, "-c", "pass"])
    process.wait()
    left = tmp_path / folder.name.replace(f".{os.getpid()}.", f".{process.pid}.")
    left.mkdir()
    (left / "one").write_text("half")
    clear_stale(tmp_path)
    assert os.listdir(tmp_path) == []


def test_a_file_that_cannot_be_written_is_told_by_the_name_that_the_folder_gets(tmp_path):
    with pytest.raises(FrameError) as told, scratch(tmp_path, "test") as outer, scratch(outer, "series"):
        raise FrameError(f"{next(outer.iterdir())}/a.vtu: cannot be written")
    assert str(told.value) == f"{tmp_path}/test/series/a.vtu: cannot be written"


def test_an_entry_comes_back_as_it_was(tmp_path):
    for content in (b"", b'{"a": [1.5, null]}', bytes(range(256))):
        write_entry(tmp_path / "a", content)
        assert read_entry(tmp_path / "a") == content
    assert read_entry(tmp_path / "none") is None


def test_every_change_of_an_entry_is_noticed(tmp_path):
    path = tmp_path / "a.json"
    write_entry(path, b'{"peak_mm": 12.5}')
    whole = path.read_bytes()
    assert json.loads(whole)["content"] == {"peak_mm": 12.5}
    changed = [whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1 :] for at in range(len(whole))]
    changed += [whole[:at] for at in range(len(whole))] + [whole + b" ", b"{}", b"[]"]
    for damaged in changed:
        path.write_bytes(damaged)
        with pytest.warns(DamageWarning, match="is damaged"):
            assert read_entry(path) is None


def test_an_interruption_in_the_middle_of_a_trial_leaves_no_folder(tmp_path, monkeypatch):
    made = Path.mkdir

    def interrupted(path, *words, **more):
        made(path, *words, **more)
        os.kill(os.getpid(), signal.SIGINT)

    monkeypatch.setattr(Path, "mkdir", interrupted)
    with pytest.raises(KeyboardInterrupt):
        files.tried_folder(tmp_path / "a" / "b")
    assert list(tmp_path.iterdir()) == []
