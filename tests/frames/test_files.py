import os

import pytest

from pounding.frames.errors import FrameError
from pounding.frames.files import replacing, write_whole


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


def test_a_folder_that_is_a_file_is_told(tmp_path):
    (tmp_path / "taken").write_text("")
    with pytest.raises(FrameError, match="cannot be written"):
        write_whole(tmp_path / "taken" / "a.bin", b"")
