"""The tables of the thesis: transcription checked by what the thesis computes from them, and the loader."""

import numpy as np
import pytest

from pounding.experiments import published
from pounding.experiments.errors import ExperimentError

GOOD = "# title: T\n# source: thesis, p. 1\n# index: frame\n# levels: a, b\nframe,x/y,x/z\n5A,1,2\n10,3,\n"


def test_every_table_names_its_place_in_the_thesis():
    assert {"3.1", "4.1", "4.2", "4.3", "7.1", "section 3.7"} <= set(published.tables())
    for number in published.tables():
        table = published.table(number)
        assert number.removeprefix("section ") in table.attrs["source"]
        assert "p. " in table.attrs["source"]
        assert len(table) > 0


def test_table_4_1_has_64_measured_peaks_and_the_printed_error_of_sap2000():
    table = published.table("4.1")
    measured = table.xs("experiment", axis=1, level="source")
    numerical = table.xs("numerical", axis=1, level="source")
    assert measured.size == 64
    # 9.5 % is what the tables' first readers get; a slip in any of the 128 numbers above 0.3 mm moves it
    assert ((numerical - measured).abs() / measured).to_numpy().mean() == pytest.approx(0.095, abs=5e-4)


def test_table_4_1_says_what_section_4_2_says_about_the_largest_peaks():
    peaks = (
        published.long("4.1")
        .xs("experiment", level="source")
        .groupby(level=["frame", "floor", "record"])
        .max()
    )
    for frame, floor, record in [
        ("5A", 5, "kobe"),
        ("5B", 5, "kobe"),
        ("10", 10, "northridge"),
        ("15A", 15, "northridge"),
        ("15B", 15, "northridge"),
    ]:
        assert peaks[frame, floor].idxmax() == record


def test_table_4_2_agrees_with_the_numbers_in_the_text_of_section_4_3_2():
    gaps = published.long("4.2")
    text = {"experiment": (18, 21, 53, 29, 11, 13, 27, 17), "numerical": (16, 19, 52, 30, 9, 10.5, 25, 17)}
    records = ("elcentro", "hachinohe", "northridge", "kobe")
    for quantity, values in text.items():
        printed = [
            gaps["15B", right, floor, r, quantity]
            for right, floor in (("10", 10), ("5B", 5))
            for r in records
        ]
        assert printed == list(values)


def test_tables_4_2_and_4_3_differ_in_one_measured_gap():
    first = published.long("4.2").xs("experiment", level="quantity")
    second = published.long("4.3").xs("experiment", level="quantity")
    different = first[first != second.reindex(first.index)]
    assert list(different.index) == [("15B", "5B", 5, "northridge")]
    assert (different.iloc[0], second[different.index[0]]) == (27, 28)


def test_table_3_1_is_in_the_order_of_nature():
    table = published.table("3.1")
    for source in ("experiment", "numerical"):
        modes = table[source][["mode1_hz", "mode2_hz", "mode3_hz"]].to_numpy()
        assert (np.diff(modes, axis=1) > 0).all()
    # printed masses are 6.9 to 7.4 kg a storey
    per_storey = table["numerical", "mass_kg"] / [5, 5, 10, 15, 15]
    assert per_storey.max() / per_storey.min() < 1.07


def test_table_7_1_has_the_levels_its_text_states():
    table = published.table("7.1")
    limits = {"low": (0.1, 0.3), "moderate": (0.3, 0.6), "high": (0.6, 0.9)}
    assert all(limits[row.level][0] <= row.pga_g <= limits[row.level][1] for row in table.itertuples())
    assert len(table) == 9


def test_names_are_forgiving_and_unknown_tables_are_named():
    assert published.table("Table 4.1").equals(published.table("4.1"))
    with pytest.raises(ExperimentError, match=r"table '9\.9' .* there are .*4\.1"):
        published.table("9.9")


def test_frames_stay_text_and_empty_cells_stay_empty():
    table = published.parse(GOOD, "x.csv")
    assert list(table.index) == ["5A", "10"]
    assert np.isnan(table.loc["10", ("x", "z")])
    assert table.columns.names == ["a", "b"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (GOOD.replace("# source: thesis, p. 1\n", ""), "no line '# source"),
        (GOOD.replace("3,\n", "3\n"), "row 2 has not the 3 cells"),
        (GOOD.replace("index: frame", "index: place"), "'place', which is no column"),
    ],
)
def test_a_broken_file_is_named(text, message):
    with pytest.raises(ExperimentError, match=message):
        published.parse(text, "x.csv")
