"""The entries: complete, what the thesis prints, and refused in one sentence where they are wrong."""

from __future__ import annotations

from collections import Counter
from itertools import product
from pathlib import Path

import msgspec
import pytest

from pounding import frames
from pounding.contact.laws import BUILT_IN
from pounding.contact.parameters import STIFFNESS_SETS
from pounding.experiments import published
from pounding.experiments.campaign.cases import chapter_5, chapter_6
from pounding.experiments.campaign.dissimilarity import counted_impacts
from pounding.experiments.configurations import measured
from pounding.experiments.configurations.definition import AnyExperiment, Collision, ContactStiffness, Shaken
from pounding.experiments.configurations.library import FILES, experiments, find, parse
from pounding.experiments.configurations.page import markdown
from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import RECORDS

GOOD = """
[[experiment]]
name = "alone-5A-kobe"
kind = "alone"
chapters = [4]
frames = [{ name = "5A" }]
record = "kobe"
measured = [{ table = "4.1", row = ["5A", 5] }]
"""


def of_kind(*kinds: str) -> list[AnyExperiment]:
    return [one for one in experiments().values() if one.kind in kinds]


def test_every_configuration_of_chapters_3_to_6_is_there() -> None:
    counts = Counter(one.kind for one in experiments().values())
    # One collision is in chapters 5 and 6: 20 + 12 tests are 31 configurations.
    assert counts == {
        "free-vibration": 5,
        "push": 5,
        "sweep": 5,
        "alone": 20,
        "apart": 20,
        "collision": 31,
        "contact-stiffness": 20,
    }


@pytest.mark.parametrize("name", experiments())
def test_an_entry_says_what_the_printed_tables_say(name: str) -> None:
    one = experiments()[name]
    measured.check(one)
    assert {frame.name for frame in one.frames} <= set(frames.names())
    if isinstance(one, Shaken):
        assert one.record in RECORDS
    if isinstance(one, Collision):
        assert one.laws == BUILT_IN
    if isinstance(one, ContactStiffness):
        assert one.sources == tuple(STIFFNESS_SETS)
    assert set("/\\ ").isdisjoint(name)


def test_no_printed_row_is_left_out() -> None:
    used = {
        (printed.table, printed.row, one.motion) for one in experiments().values() for printed in one.measured
    }
    for number in ("4.1", "4.2", "4.3"):
        for row, record in product(published.table(number).index, RECORDS):
            assert (number, tuple(row), record) in used
    for number in ("section 5.2.2", "section 6.3.2"):
        assert {tuple(row) for row in published.table(number).index} == {
            row for table, row, _ in used if table == number
        }
    assert {(*row, record) for table, row, record in used if table == "6.2"} == set(counted_impacts())


def test_the_collisions_are_those_of_the_campaign() -> None:
    for trials, chapter in ((chapter_5(), 5), (chapter_6(), 6)):
        ours = {
            (*one.frame_names, one.record, one.gap_mm)
            for one in experiments().values()
            if isinstance(one, Collision) and chapter in one.chapters
        }
        assert ours == {(trial.left, trial.right, trial.record, trial.gap_mm) for trial in trials}


def test_the_counts_are_those_of_table_6_2() -> None:
    for one in of_kind("collision"):
        assert isinstance(one, Collision)
        touches = {"touches": 4.0, "longest_touch_ms": 1.0, "touch_restitution": 0.8}
        runs = {"hertz": {"impacts": 3, "peak_force_n": 100.0} | touches}
        rows = {row.source.partition(",")[0]: row for row in measured.collision(one, one.record, runs)}
        if 6 in one.chapters:
            assert rows["Table 6.2"].measured == counted_impacts()[(*one.frame_names, one.record)]
        else:
            assert rows["section 5.2.2"].measured == 1.0


def test_a_gap_that_is_not_the_printed_one_is_refused() -> None:
    one = find("collision-15B-5B-kobe-17mm")
    with pytest.raises(ExperimentError, match=r"section 6\.3\.2, 15B 5B kobe has another gap"):
        measured.check(msgspec.structs.replace(one, gap_mm=17.5))


def test_the_page_has_the_table_as_it_is_printed_now() -> None:
    page = Path(__file__).parents[3] / "docs" / "experiments.md"
    assert markdown() in page.read_text(encoding="utf-8"), (
        "python -m pounding.experiments.configurations.page"
    )


def test_the_files_are_written_as_they_are_read() -> None:
    (entry,) = parse(GOOD, "test.toml")
    assert entry == msgspec.convert(msgspec.to_builtins(entry), AnyExperiment)
    assert len(FILES) == 4


@pytest.mark.parametrize(
    ("name", "near"),
    [("alone-15b-elcentr", "alone-15B-elcentro"), ("push_5a", "push-5A"), ("sweep-5C", "sweep-5")],
)
def test_a_mistyped_name_is_one_sentence_with_what_is_near(name: str, near: str) -> None:
    with pytest.raises(ExperimentError, match=f"'{name}' is not known; did you mean {near}"):
        find(name)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('kind = "alone"', 'kind = "lone"', "lone"),
        ('record = "kobe"', "", "record"),
        ('record = "kobe"', 'record = "kobe"\nstate = "sweep"', "state"),
        ('frames = [{ name = "5A" }]', 'frames = [{ name = "5A" }, { name = "5B" }]', "1 frame"),
        ("chapters = [4]", "chapters = [7]", "chapters between 3 and 6"),
        ('measured = [{ table = "4.1", row = ["5A", 5] }]', "measured = []", "rows that were measured"),
        ("[[experiment]]", "[experiment]", "[[experiment]]"),
        ("[[experiment]]", "[[experiment]", "not TOML"),
    ],
)
def test_a_wrong_entry_is_one_sentence_that_names_it(old: str, new: str, sentence: str) -> None:
    with pytest.raises(ExperimentError) as said:
        parse(GOOD.replace(old, new), "test.toml")
    assert sentence in str(said.value)
    assert str(said.value).startswith("test.toml")


def test_a_printed_row_that_is_not_there_is_refused() -> None:
    (entry,) = parse(GOOD.replace('["5A", 5]', '["5A", 3]'), "test.toml")
    with pytest.raises(ExperimentError, match=r"Table 4\.1, 5A 3: the table has no such row"):
        measured.check(entry)
