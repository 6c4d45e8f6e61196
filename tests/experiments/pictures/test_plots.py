import os

import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

from pounding.experiments.errors import ExperimentError
from pounding.experiments.measurements.history import Channel
from pounding.experiments.pictures import plots
from pounding.experiments.results import dataset as results
from pounding.frames import FrameError


@pytest.fixture
def figures(monkeypatch):
    """The figures that were saved, so that their lines can be read."""
    saved = []
    original = Figure.savefig

    def keep(figure, *args, **options):
        saved.append(figure)
        return original(figure, *args, **options)

    monkeypatch.setattr(Figure, "savefig", keep)
    return saved


@pytest.fixture
def data(shaken_stick):
    return results.dataset(shaken_stick.motion, shaken_stick.record)


def test_history_shows_table_floors_published_peaks_and_measured(data, tmp_path, figures):
    measured = Channel("m", "relative_displacement", "stick", 2, np.array([0.0, 1.0]), np.array([0.0, 1e-3]))
    plots.history(
        data,
        tmp_path / "h.png",
        frame="stick",
        floors=[2, 1],
        published_mm={2: (3.0, 4.0)},
        measured=[measured],
    )
    table, roof, first = figures[0].axes
    np.testing.assert_allclose(table.lines[0].get_ydata(), data.table_acceleration / 9.80665)
    np.testing.assert_allclose(
        roof.lines[0].get_ydata(), 1e3 * data.relative_displacement.sel(frame="stick", floor=2)
    )
    np.testing.assert_allclose(roof.lines[1].get_ydata(), [0.0, 1.0])
    assert [line.get_ydata()[0] for line in roof.lines[2:]] == [3.0, -4.0]
    assert len(first.lines) == 1
    with Image.open(tmp_path / "h.png") as image:
        assert image.size[0] > 800


def test_overlay_shows_each_channel_that_the_run_has(data, tmp_path, figures):
    time = np.linspace(0.0, 1.0, 5)
    channels = [
        Channel("a", "absolute_acceleration", "stick", 1, time, np.ones(5)),
        Channel("t", "table_acceleration", None, None, time, np.ones(5)),
        Channel("x", "relative_displacement", "other", 1, time, np.ones(5)),
    ]
    assert plots.overlay(data, channels, tmp_path / "o.png", frame="stick") == figures[0].axes
    assert [axis.get_ylabel() for axis in figures[0].axes] == ["g", "g"]
    assert plots.overlay(data, channels[2:], tmp_path / "none.png", frame="stick") == []
    assert os.listdir(tmp_path) == ["o.png"]


def test_spectra_mark_the_modes(shaken_stick, tmp_path, figures):
    plots.spectra(shaken_stick.record, tmp_path / "s.png", damping_ratio=0.01, marks_hz={"mode 1": 3.0})
    displacement, acceleration, _ = figures[0].axes
    frequency, values = displacement.lines[0].get_data()
    # Pseudo-acceleration and acceleration differ by the damping's part, of the order of its ratio.
    pseudo = (2 * np.pi * frequency) ** 2 * values * 1e-3 / 9.80665
    np.testing.assert_allclose(acceleration.lines[0].get_ydata(), pseudo, rtol=0.1)
    assert displacement.lines[1].get_xdata()[0] == 3.0


def test_a_plot_that_cannot_be_written_is_told(data, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(FrameError, match=r"h\.png: cannot be written"):
        plots.history(data, tmp_path / "file" / "h.png", frame="stick")


def test_a_plot_goes_into_the_axes_that_it_is_given_and_writes_nothing_unasked(data, tmp_path, figures):
    mine = Figure().subplots(2, 1)
    given = plots.history(data, frame="stick", axes=mine)
    assert given == list(mine)
    assert len(mine[1].lines) == 1
    own = plots.history(data, frame="stick")
    assert own[0].figure is not mine[0].figure
    assert figures == []
    with pytest.raises(ExperimentError, match="2 panels, but 1 axes"):
        plots.history(data, frame="stick", axes=mine[:1])
