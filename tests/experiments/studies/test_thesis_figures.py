"""The counterparts of the thesis' figures: numbers of the tables, files that are whole, panels that say what they show."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from pounding.contact.laws import BUILT_IN
from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures import sheets
from pounding.experiments.pictures.sheets import Level, Line
from pounding.experiments.records import RECORDS
from pounding.experiments.studies.thesis_figure_runs import panels
from pounding.experiments.studies.thesis_figure_sheets import gap_figure, history_figure, interval_figure
from pounding.experiments.studies.thesis_figures import ACCELERATIONS, DISPLACEMENTS, FORCES, GAPS, figures
from pounding.frames import load

REPOSITORY = Path(__file__).parents[3]


@pytest.mark.parametrize("number", [*DISPLACEMENTS, *ACCELERATIONS, *GAPS, *FORCES])
def test_a_figure_shows_the_same_frames_under_each_record(number: str):
    shown = panels(number)
    assert [one.record for one in shown] == list(RECORDS)
    assert len({one.frame_names for one in shown}) == 1
    floor = (DISPLACEMENTS | ACCELERATIONS).get(number, 1)
    assert floor <= load(shown[0].frame_names[0]).storeys


def test_all_figures_that_the_docs_show_are_drawn():
    pictures = {path.stem for path in (REPOSITORY / "docs" / "_static" / "thesis").iterdir()}
    assert pictures == {f"figure-{number.lower().replace('.', '-')}" for number in figures()}
    page = (REPOSITORY / "docs" / "validation" / "figures.md").read_text(encoding="utf-8")
    assert all(f"thesis/{name}.png" in page for name in pictures)


def test_a_figure_that_shows_no_experiment_is_one_sentence():
    with pytest.raises(ExperimentError, match=r"no experiment of the library is shown in figure 9\.9"):
        panels("9.9")


def test_displacements_are_those_of_table_4_1_by_the_model(test_records, tmp_path):
    found = history_figure("4.3", 5, "displacement", str(test_records), tmp_path)
    # 5A under El Centro: docs/validation/table-4-1.md.
    assert found["elcentro"]["free-vibration"]["max_mm"] == pytest.approx(5.4, abs=0.05)
    assert found["elcentro"]["strong-motion"]["max_mm"] < found["elcentro"]["free-vibration"]["max_mm"]
    with Image.open(tmp_path / "figure-4-3.png") as image:
        assert image.size[0] > 800
        assert len(image.convert("RGB").getcolors(1 << 20)) > 50


def test_gaps_are_those_of_chapter_4_by_the_model(test_records):
    found = gap_figure("4.14", str(test_records))
    # docs/validation/chapter-4.md: closing motion and equation 4.1 of 15B beside 10.
    assert found["elcentro"]["free-vibration"]["closing_mm"] == pytest.approx(14.9, abs=0.1)
    assert found["elcentro"]["free-vibration"]["equation_4_1_mm"] == pytest.approx(18.9, abs=0.1)


def test_the_interval_begins_at_each_law_s_own_touch(test_records, tmp_path):
    found = interval_figure("6.10", str(test_records), tmp_path)
    assert set(found) == set(BUILT_IN)
    assert found["linear_viscoelastic"] == 0.0
    # On one clock the laws' first touches would not lie over each other, and their sums would differ by all of a pulse.
    assert all(0.0 < value < 8000.0 for law, value in found.items() if law != "linear_viscoelastic")
    assert (tmp_path / "figure-6-10.png").is_file()


def test_a_motion_is_drawn_until_it_has_died_away():
    time = np.arange(0.0, 10.0, 0.01)
    figure, axes = sheets.four_panels(list("abcd"), "title", x="time [s]", y="mm")
    decay = Line("ours", time, np.exp(-time) * np.cos(20.0 * time))
    sheets.motion(axes[0], [decay], [Level("printed", (1.0, -1.0))])
    assert 0.5 < axes[0].get_xlim()[1] < 1.2
    assert len(axes[0].lines) == 3
    sheets.legend(figure, axes)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["ours", "printed"]


def test_a_panel_without_a_touch_says_so():
    _figure, axes = sheets.four_panels(list("abcd"), "title", x="time [s]", y="N")
    sheets.forces(axes[0], {})
    assert axes[0].texts[0].get_text() == "the floors do not touch"
