"""The counterparts of the thesis' figures: right frames for each figure, numbers of the tables, files that are whole."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from pounding.contact.laws import BUILT_IN
from pounding.experiments.configurations.library import experiments
from pounding.experiments.pictures import sheets
from pounding.experiments.pictures.sheets import Level, Line
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.studies import thesis_figures
from pounding.experiments.studies.table_4_1 import RECORDS
from pounding.experiments.studies.thesis_figures import ACCELERATIONS, DISPLACEMENTS, FORCES, GAPS


def _frames(number: str) -> set[tuple[str, ...]]:
    """Return the frames of the named experiments that say that they show a figure."""
    return {
        one.frame_names
        for one in experiments().values()
        for figure in one.figures
        if figure.split("(")[0] == number
    }


@pytest.mark.parametrize("number", [*DISPLACEMENTS, *ACCELERATIONS, *GAPS, *FORCES])
def test_figures_show_the_frames_of_the_named_experiments(number):
    ours = GAPS | FORCES | {key: (roof.frame,) for key, roof in (DISPLACEMENTS | ACCELERATIONS).items()}
    assert _frames(number) == {ours[number]}


@pytest.fixture
def motions(test_records):
    return [shaking(name, str(test_records)) for name in RECORDS]


def test_displacements_are_those_of_table_4_1_by_the_model(motions, tmp_path):
    found = thesis_figures.displacement_figure("4.3", DISPLACEMENTS["4.3"], motions, tmp_path)
    # 5A under El Centro: docs/validation/table-4-1.md.
    assert found["elcentro"]["free-vibration"]["max_mm"] == pytest.approx(5.4, abs=0.05)
    assert found["elcentro"]["strong-motion"]["max_mm"] < found["elcentro"]["free-vibration"]["max_mm"]
    with Image.open(tmp_path / "figure-4-3.png") as image:
        assert image.size[0] > 800
        assert len(image.convert("RGB").getcolors(1 << 20)) > 50


def test_gaps_are_those_of_chapter_4_by_the_model(motions):
    found = thesis_figures.gap_figure("4.14", GAPS["4.14"], motions, None)
    # docs/validation/chapter-4.md: closing motion and equation 4.1 of 15B beside 10.
    assert found["elcentro"]["free-vibration"]["closing_mm"] == pytest.approx(14.9, abs=0.1)
    assert found["elcentro"]["free-vibration"]["equation_4_1_mm"] == pytest.approx(18.9, abs=0.1)


def test_the_interval_begins_at_each_law_s_own_touch(test_records, tmp_path):
    found = thesis_figures.interval_figure(str(test_records), tmp_path)
    assert set(found) == set(BUILT_IN)
    assert found["linear_viscoelastic"] == 0.0
    # With the intervals of one clock the laws' first touches would not lie over each other and differ by all of a pulse.
    assert all(0.0 < value < 8000.0 for law, value in found.items() if law != "linear_viscoelastic")
    assert (tmp_path / "figure-6-10.png").is_file()


def test_a_motion_is_drawn_until_it_has_died_away():
    time = np.arange(0.0, 10.0, 0.01)
    figure, axes = sheets.four_panels(list("abcd"), "title", x="time [s]", y="mm")
    sheets.motion(
        axes[0], [Line("ours", time, np.exp(-time) * np.cos(20.0 * time))], [Level("printed", (1.0, -1.0))]
    )
    assert 0.5 < axes[0].get_xlim()[1] < 1.2
    assert len(axes[0].lines) == 3
    sheets.legend(figure, axes)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["ours", "printed"]


def test_a_panel_without_a_touch_says_so():
    _figure, axes = sheets.four_panels(list("abcd"), "title", x="time [s]", y="N")
    sheets.forces(axes[0], {})
    assert axes[0].texts[0].get_text() == "the floors do not touch"
