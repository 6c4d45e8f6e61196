"""Pictures and films by their pixels; on a machine that cannot render, the one sentence that says so."""

import os
import pickle
import signal
import subprocess
import sys
from contextlib import suppress
from itertools import pairwise
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import pytest
from PIL import Image

from pounding import frames
from pounding.contact.laws import LinearSpring
from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures import film_images, films, scenes
from pounding.experiments.pictures.series import places
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.rig import Rig
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


def test_a_picture_without_a_file_is_a_plotter_that_stays_open(collision, tmp_path):
    size = (240, 200)
    if draws(lambda: scenes.picture(collision, tmp_path / "one.png", size=size), tmp_path):
        made = scenes.picture(collision, size=size)
        assert made.screenshot(return_img=True).std() > 1.0
        assert scenes.picture(collision, tmp_path / "two.png", scene=made, time_s=0.1) is made
        assert made.screenshot(return_img=True).std() > 1.0
        made.close()
        assert (tmp_path / "two.png").exists()


def test_a_contact_shows_its_force_only_while_it_acts(collision, tmp_path):
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


def test_the_force_that_is_shown_follows_the_contact(collision):
    contact = collision.contacts[0]
    touch, parting = contact.pulses[0]
    before, within, after = scenes.instants(
        collision, [touch - 1e-3, 0.5 * (touch + parting), parting + 2e-4], exposure_s=0.0
    )
    assert (before.forces_n, after.forces_n) == ((0.0,), (0.0,))
    assert within.forces_n == pytest.approx(contact.at([within.time_s])[2])
    times, force = contact.sampled()
    # An image of a film stands for the time since the image before it, and for no other.
    exposure = 4e-3
    moments = np.arange(exposure, collision.model_s, exposure)
    shown = [one.forces_n[0] for one in scenes.instants(collision, moments, exposure_s=exposure)]
    for moment, value in zip(moments, shown, strict=True):
        since = (times > moment - exposure) & (times <= moment)
        assert value == pytest.approx(max(force[since].max(), contact.at([moment])[2][0]))
    assert max(shown) == pytest.approx(force.max())


def test_a_film_of_a_long_run_is_bounded_and_shows_its_largest_moment(shaken_stick, tmp_path, monkeypatch):
    monkeypatch.setitem(films.LONGEST_S, ".mp4", 0.4)
    path, size = tmp_path / "film.mp4", (160, 200)
    made = []
    if draws(lambda: made.append(films.film(shaken_stick.motion, path, size=size)), tmp_path):
        assert made[0].length_s == pytest.approx(0.4)
        assert made[0].start_s < scenes.largest_moment(shaken_stick.motion) < made[0].end_s
        assert len(frames_of(path, size)) == made[0].images == 10
        assert str(made[0]).startswith("0.4 s, 10 images")


def test_images_drawn_by_one_process_and_by_three_are_the_same(shaken_stick):
    if cannot_render() is not None:
        return
    fixed = scenes.setting(shaken_stick.motion)
    shown = scenes.instants(shaken_stick.motion, [0.3, 0.35, 0.4, 0.45])
    alone, shared = (list(film_images.images(fixed, shown, (160, 200), count)) for count in (1, 3))
    assert [len(image) for image in alone] == [3 * 160 * 200] * 4
    assert alone == shared
    assert len(set(alone)) == 4


IN_PROC = pytest.mark.skipif(not Path("/proc").is_dir(), reason="processes are looked for in /proc")


@IN_PROC
def test_a_process_that_dies_in_a_film_is_told_and_leaves_nothing(shaken_stick, tmp_path, monkeypatch):
    began, running = [], set(children(os.getpid()))

    def killing(share):
        began.append(share)
        for child in children(os.getpid()):
            if "film_images" in Path(f"/proc/{child}/cmdline").read_text():
                os.kill(child, signal.SIGKILL)

    with pytest.raises(FrameError, match=r"cannot render|ended \(exit status -9\)"):
        films.film(shaken_stick.motion, tmp_path / "film.mp4", size=(160, 200), progress=killing)
    assert began or cannot_render()
    assert os.listdir(tmp_path) == []
    assert set(children(os.getpid())) <= running


FILMING = """
import os, pickle, signal, sys
from pounding.experiments.console.exit_status import command, run
from pounding.experiments.pictures import films

motion = pickle.load(open(sys.argv[1], "rb"))

def stops(share):
    if share > 0.05:
        os.kill(os.getpid(), getattr(signal, sys.argv[3]))

app = command(name="filming")
app.default(lambda: films.film(motion, sys.argv[2] + "/film.mp4", size=(160, 200), progress=stops))
run(app, [])
"""


@IN_PROC
@pytest.mark.parametrize(("name", "status"), [("SIGINT", 130), ("SIGTERM", 143)])
def test_a_film_that_is_stopped_leaves_neither_file_nor_process(shaken_stick, tmp_path, name, status):
    if cannot_render() is not None:
        return
    run = tmp_path / "run.pickle"
    run.write_bytes(pickle.dumps(shaken_stick.motion))
    folder = tmp_path / "films"
    folder.mkdir()
    mark = {"FILM_OF_TEST": f"{name}-{os.getpid()}"}
    done = subprocess.run(
        [sys.executable, "-c", FILMING, run, folder, name],
        env=dict(os.environ) | mark,
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == status, done.stderr
    assert os.listdir(folder) == []
    assert "Traceback" not in done.stderr
    assert not marked(f"FILM_OF_TEST={mark['FILM_OF_TEST']}")


def children(process):
    """Numbers of the processes that a process started and that have not ended."""
    return [int(number) for number in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def marked(variable):
    """Numbers of the living processes that have a variable in their environment."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if variable.encode() in (folder / "environ").read_bytes():
                found.append(folder.name)
    return found


def test_another_run_stands_behind_in_blue_lines(collision, tmp_path):
    def blue(name):
        pixels = np.asarray(Image.open(tmp_path / name).convert("RGB")).astype(int)
        return int(np.sum((pixels[..., 2] - pixels[..., 0] > 90) & (pixels[..., 1] > 70)))

    def draw():
        scenes.picture(collision, tmp_path / "alone.png", time_s=0.5)
        scenes.picture(collision, tmp_path / "both.png", time_s=0.5, behind=collision)

    if draws(draw, tmp_path):
        assert blue("both.png") > blue("alone.png") + 300
    (shown,) = scenes.instants(collision, [0.5], behind=collision)
    for behind, own in zip(shown.behind, shown.coordinates, strict=True):
        np.testing.assert_array_equal(behind, own)
    assert scenes.instants(collision, [0.5])[0].behind == ()
