"""What can be rendered is rendered and looked at by its pixels; what cannot is told in one sentence."""

import subprocess

import numpy as np
import pytest
from PIL import Image

from pounding import frames
from pounding.frames.drawing import pictures, rendering
from pounding.frames.errors import FrameError


@pytest.fixture(scope="module")
def reduced():
    return frames.build(frames.load("5A"))


@pytest.fixture
def fresh():
    """Forget what was found about this machine, before and after."""
    rendering.cannot_render.cache_clear()
    yield
    rendering.cannot_render.cache_clear()


def drawn(path):
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB"), float)


def draws(draw, path):
    """Draw; a machine that cannot refuses with its reason, which is what is promised there."""
    reason = rendering.cannot_render()
    if reason is None:
        draw()
        return True
    with pytest.raises(FrameError, match="cannot render"):
        draw()
    assert not path.exists()
    return False


def test_mesh_and_modes_fill_their_pictures(reduced, tmp_path):
    path = tmp_path / "picture.png"
    for draw in (
        lambda: pictures.mesh_picture(reduced, path, size=(480, 600)),
        lambda: pictures.modes_picture(reduced, path, size=(720, 480)),
    ):
        if draws(draw, path):
            pixels = drawn(path)
            coloured = (pixels < 250.0).any(axis=2)
            assert 0.1 < coloured.mean() < 0.9
            # A margin on each side stays free, so nothing is cut off.
            assert not coloured[:2].any()
            assert not coloured[-2:].any()
            assert not coloured[:, :2].any()
            assert not coloured[:, -2:].any()
            path.unlink()


def test_a_picture_does_not_move_the_frame(reduced, tmp_path):
    before = reduced.mesh.nodes.copy()
    surface = pictures.grid(pictures.shape_of(reduced))
    surface.points[:] += 1.0
    np.testing.assert_array_equal(reduced.mesh.nodes, before)


def test_a_machine_without_opengl_says_so_in_one_sentence(reduced, tmp_path, monkeypatch, fresh):
    def fails(*_args, **_options):
        message = "Traceback\nImportError: libGL.so.1: cannot open shared object file"
        return subprocess.CompletedProcess([], 1, "", message)

    monkeypatch.setattr(rendering.subprocess, "run", fails)
    reason = rendering.cannot_render()
    assert "libGL.so.1" in reason
    assert "libegl1" in reason
    assert "\n" not in reason
    with pytest.raises(FrameError, match="cannot render"):
        pictures.mesh_picture(reduced, tmp_path / "mesh.png")
    assert list(tmp_path.iterdir()) == []


def test_a_renderer_that_crashes_or_hangs_is_survived(monkeypatch, fresh):
    def hangs(*_args, **_options):
        raise subprocess.TimeoutExpired("python", 120)

    monkeypatch.setattr(rendering.subprocess, "run", hangs)
    assert "timed out" in rendering.cannot_render()
