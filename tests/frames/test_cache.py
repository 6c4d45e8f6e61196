import errno
import io
import os
import time
import warnings

import numpy as np
import pytest

from pounding import frames
from pounding.frames import cache
from pounding.frames.cache import CacheWarning
from pounding.frames.files import DamageWarning

COARSE = frames.Density(0.1, 2, 2)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("POUNDING_CACHE", str(tmp_path / "cache"))
    cache._warn_once.cache_clear()
    return tmp_path / "cache"


def build(frame=None, **options):
    return frames.build(frame or frames.load("5A"), density=COARSE, **options)


def test_a_second_build_is_the_first_one_read_back(folder):
    first = build()
    files = list(folder.iterdir())
    second = build()
    assert list(folder.iterdir()) == files
    for name in ("mass", "stiffness", "damping", "shapes", "influence", "basis"):
        assert np.array_equal(getattr(first, name), getattr(second, name))


def test_every_input_counts(folder):
    frame = frames.load("5A")
    build(frame)
    others = [
        build(frame, joints="rigid"),
        build(frame, p_delta=False),
        build(frame, calibration="sweep"),
        build(frame, keep_hz=500.0),
        build(frame, modes=3),
        build(frame, planar=False),
        build(frame, rigid_floors=False),
        build(frames.changed(frame, added_mass_kg=[1.0] * 5)),
        build(frames.changed(frame, stiffness_factor=1.1)),
        build(frames.load("5B")),
    ]
    assert len(list(folder.glob("*.entry"))) == 1 + len(others)


def test_labels_and_damping_do_not_count(folder):
    frame = frames.load("5A")
    build(frame)
    renamed = build(frames.changed(frame, name="mine"), damping=0.05)
    assert len(list(folder.glob("*.entry"))) == 1
    assert renamed.name == "mine"
    assert renamed.damping_ratio == 0.05


def other_arrays():
    stream = io.BytesIO()
    np.savez(stream, mass=np.eye(2))
    return stream.getvalue()


@pytest.mark.parametrize(
    "damaged",
    [
        lambda whole: whole[:100],
        lambda whole: whole[:-200] + bytes([whole[-200] ^ 1]) + whole[-199:],
        lambda whole: b"",
        lambda whole: b'{"mass": [1.0]}',
        lambda whole: other_arrays(),
    ],
    ids=["cut off", "one bit", "empty", "JSON of another shape", "arrays of another shape"],
)
def test_a_damaged_file_is_told_and_computed_anew(folder, damaged):
    first = build()
    (path,) = folder.iterdir()
    whole = path.read_bytes()
    path.write_bytes(damaged(whole))
    with pytest.warns(DamageWarning, match=f"{path.name} is damaged: what it kept is made anew"):
        assert np.array_equal(build().stiffness, first.stiffness)
    assert len(path.read_bytes()) == len(whole)
    assert np.array_equal(build().stiffness, first.stiffness)


def test_what_a_killed_run_had_begun_is_removed(folder, killed_while_writing):
    begun = killed_while_writing(folder / "abc.entry")
    build()
    assert not begun.exists()
    assert len(list(folder.iterdir())) == 1


def test_a_full_folder_costs_one_warning(folder, monkeypatch):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.warns(CacheWarning, match=r"No space left on device; the run goes on") as seen:
        both = [build(joints=joints) for joints in ("calibrated", "rigid")]
    assert len(seen) == 1
    assert both[0].frequencies_hz[0] > 0
    assert not folder.exists() or list(folder.iterdir()) == []


def test_a_folder_that_cannot_be_made_costs_one_warning(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("POUNDING_CACHE", str(tmp_path / "file" / "cache"))
    cache._warn_once.cache_clear()
    with pytest.warns(CacheWarning, match="set POUNDING_CACHE to another folder"):
        assert build().storeys == 5


def test_old_files_make_room(folder, monkeypatch):
    build()
    (old,) = folder.iterdir()
    os.utime(old, (1.0, 1.0))
    monkeypatch.setattr(cache, "LARGEST_BYTES", 10)
    build(joints="rigid")
    assert not old.exists()
    assert len(list(folder.glob("*.entry"))) == 1


def test_no_cache_leaves_no_file(folder):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        build(use_cache=False)
    assert not folder.exists()


@pytest.mark.slow
def test_fifteen_storeys_cold_and_from_the_cache(folder):
    # Processor time, so that a busy machine does not count.
    start = time.process_time()
    frames.build(frames.load("15B"))
    cold, start = time.process_time() - start, time.process_time()
    frames.build(frames.load("15B"))
    warm = time.process_time() - start
    assert cold < 15.0
    assert warm < 0.5
