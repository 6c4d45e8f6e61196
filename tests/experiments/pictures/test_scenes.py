"""Pictures and films by their pixels; on a machine that cannot render, the one sentence that says so."""

import os
import subprocess
from itertools import pairwise

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from pounding import frames
from pounding.contact.laws import LinearSpring
from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures import films, scenes
from pounding.experiments.pictures.series import places
from pounding.experiments.rig.rig import Contact, Rig
from pounding.frames import FrameError
from pounding.frames.drawing.rendering import cannot_render


@pytest.fixture(scope="module")
def collision(noise):
    """Two unequal sticks that knock against each other."""
    kinds = {"left": 2.0, "right": 5.0}
    pair = [
        frames.build(
            frames.StickFrame(
                name=name,
                storeys=2,
                storey_height_m=0.3,
                floor_mass_kg=[6.0, 5.0],
                damping_ratio=0.01,
                frequency_hz=[hz],
            )
        )
        for name, hz in kinds.items()
    ]
    contact = Contact(LinearSpring(stiffness=1e6), gap_m=2e-3, floor=2)
    return Rig(pair, [contact]).run(noise(peak_g=0.5))


def draws(draw, folder):
    """Draw; a machine that cannot refuses with its reason and leaves nothing."""
    if cannot_render() is None:
        draw()
        return True
    with pytest.raises(FrameError, match="cannot render"):
        draw()
    assert os.listdir(folder) == []
    return False


def frames_of(path, size):
    """Every image of a film (images, height, width, 3)."""
    program = imageio_ffmpeg.get_ffmpeg_exe()
    command = [program, "-loglevel", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    raw = subprocess.run(command, capture_output=True, check=True).stdout
    return np.frombuffer(raw, np.uint8).astype(int).reshape(-1, size[1], size[0], 3)


def red(path):
    """How many pixels have the colour of the contact's arrows."""
    with Image.open(path) as image:
        pixels = np.asarray(image.convert("RGB"), int)
    return int((np.abs(pixels - [0xB3, 0x26, 0x2E]).max(axis=2) < 12).sum())


def test_the_moment_is_that_of_the_largest_force_or_else_of_the_largest_displacement(collision, shaken_stick):
    times, force = collision.contacts[0].sampled()
    assert force.max() > 0.0
    assert scenes.largest_moment(collision) == times[force.argmax()]
    frame = shaken_stick.motion.frames[0]
    roof = np.abs(frame.floor_displacement(2))
    assert scenes.largest_moment(shaken_stick.motion) == frame.time_s[roof.argmax()]


def test_frames_that_touch_in_the_picture_touch_in_the_run(collision):
    factor = scenes.enlargement(collision)
    left, right = places(collision, factor=factor)
    gap_drawn = right - left - 0.4
    assert gap_drawn == pytest.approx(factor * 2e-3)


def test_enlargement_is_round_and_keeps_the_roof_in_the_picture(shaken_plate):
    factor = scenes.enlargement(shaken_plate.motion)
    roof = np.abs(shaken_plate.motion.frames[0].floor_displacement(5)).max()
    assert f"{factor:e}"[0] in "125"
    assert 0.4 * 0.1 < factor * roof <= 0.4 * scenes.DRAWN_MOVEMENT


def test_a_contact_shows_its_force_only_while_it_is_fresh(collision, tmp_path):
    at = scenes.largest_moment(collision)
    touching, apart = tmp_path / "touching.png", tmp_path / "apart.png"
    size = (480, 400)
    if draws(lambda: scenes.picture(collision, touching, size=size), tmp_path):
        first = collision.contacts[0].touches[0].min()
        assert first > 0.1
        scenes.picture(collision, apart, time_s=first / 2.0, size=size)
        assert red(touching) > 200
        assert red(apart) == 0
        assert at >= first


def test_a_film_moves(shaken_stick, tmp_path):
    path = tmp_path / "film.mp4"
    size = (320, 400)
    if draws(lambda: films.film(shaken_stick.motion, path, start_s=0.4, end_s=0.8, size=size), tmp_path):
        images = frames_of(path, size)
        assert len(images) == 11
        changed = [(np.abs(a - b) > 60).sum() for a, b in pairwise(images)]
        assert min(changed) > 20
        assert os.listdir(tmp_path) == ["film.mp4"]


def test_a_gif_is_made_too(shaken_stick, tmp_path):
    path = tmp_path / "film.gif"
    if draws(
        lambda: films.film(shaken_stick.motion, path, start_s=0.4, end_s=0.6, size=(320, 400)), tmp_path
    ):
        with Image.open(path) as image:
            assert image.n_frames == 6


def test_a_film_that_cannot_be_is_told(shaken_stick, tmp_path):
    with pytest.raises(ExperimentError, match=r"\.mp4 or \.gif"):
        films.film(shaken_stick.motion, tmp_path / "film.avi")
    with pytest.raises(ExperimentError, match="not a span"):
        films.film(shaken_stick.motion, tmp_path / "film.mp4", start_s=5.0)


def test_a_renderer_that_dies_in_a_film_leaves_nothing(shaken_stick, tmp_path, monkeypatch):
    def dies(_stage, _time):
        raise RuntimeError("context lost")

    monkeypatch.setattr(scenes.Stage, "show", dies)
    error = RuntimeError if cannot_render() is None else FrameError
    with pytest.raises(error):
        films.film(shaken_stick.motion, tmp_path / "film.mp4", end_s=0.5)
    assert os.listdir(tmp_path) == []
