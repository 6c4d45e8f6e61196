"""Chapter 4 against the thesis: Table 4.2, Table 4.3 recomputed, the rules judged."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest

from pounding.experiments.records import RECORDS, find
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.studies import chapter_4
from pounding.experiments.studies.table_4_1 import BLIND, build
from pounding.scale import THESIS


@pytest.fixture(scope="module")
def gaps(test_records):
    return tables_4.computed_gaps(
        lambda name: build(name, BLIND), lambda name: find(name, test_records).scaled(THESIS.time_factor)
    )


def test_sap2000_of_table_4_2_is_9_9_percent_off(gaps) -> None:
    """Pages 86 and 87; the mean over 20 entries."""
    found = tables_4.mean_errors(tables_4.table_4_2(gaps))
    assert found.loc["sap2000_mm", "mean"] == pytest.approx(0.099, abs=5e-4)


def test_our_gaps_against_the_measured_ones(gaps) -> None:
    """Table 4.2, p. 87, by the model fixed beforehand.

    24.3 % (closing) and 23.7 % (equation 4.1) in the mean, against 9.9 % of SAP2000: the free-vibration
    damping lets resonance build up under Kobe and Northridge, and 15A beside 15B under El Centro and
    Hachinohe hangs on a difference of 1 % between two frequencies. A model that becomes worse than that by a
    tenth has been damaged.
    """
    found = tables_4.mean_errors(tables_4.table_4_2(gaps))
    assert found.loc["closing_mm", "mean"] < 0.27
    assert found.loc["equation_4_1_mm", "mean"] < 0.26
    # Two entries in three lie within 25 %.
    error = tables_4.table_4_2(gaps).eval("closing_mm / experiment_mm - 1").abs()
    assert (error < 0.25).mean() > 0.6


def test_gaps_in_strong_motion_beside_the_blind_ones(gaps, test_records) -> None:
    """The damping ratio is fitted to Table 4.1, not to these gaps; the states were chosen with all peaks seen."""
    motions = {name: find(name, test_records).scaled(THESIS.time_factor) for name in RECORDS}
    strong = chapter_4.strong_motion(motions)
    found = tables_4.mean_errors(tables_4.table_4_2(gaps).join(chapter_4.in_mm(strong)))["mean"]
    assert found["strong_motion_equation_4_1_mm"] == pytest.approx(0.123, abs=0.005)
    assert found["strong_motion_closing_mm"] == pytest.approx(0.172, abs=0.005)
    assert found["equation_4_1_mm"] == pytest.approx(0.237, abs=0.005)
    pga = {name: motion.pga_g for name, motion in motions.items()}
    rules = tables_4.summary(chapter_4.rules_in_strong_motion(strong, pga))
    assert rules.loc["ABS", "safe"] == 1.0
    assert (rules.drop(index="ABS")["safe"] < 1.0).all()


def test_contested_entries_are_marked(gaps) -> None:
    table = tables_4.table_4_2(gaps)
    contested = table[table["contested"]]
    assert {(left, record) for left, _, _, record in contested.index} == {
        ("15B", "hachinohe"),
        ("15A", "hachinohe"),
    }
    assert len(contested) == 3


def test_table_4_3_follows_from_table_4_1_but_for_hachinohe() -> None:
    """Page 88: 40 sums and roots, of which the eight under Hachinohe with 15B or 5A do not follow."""
    found = tables_4.table_4_3()
    assert len(found) == 40
    wrong = found[~found["follows"]]
    assert {(left, right, record) for left, right, _, record, _ in wrong.index} == {
        ("15B", "10", "hachinohe"),
        ("15B", "5B", "hachinohe"),
        ("15A", "15B", "hachinohe"),
        ("5A", "5B", "hachinohe"),
    }
    assert len(wrong) == 8
    assert found[found["follows"]]["difference_mm"].abs().max() <= 0.1 + 1e-9
    assert wrong["difference_mm"].abs().max() == pytest.approx(16.9, abs=0.05)


def test_absolute_sum_covers_every_computed_gap(gaps, test_records) -> None:
    """No two motions can be further apart than the sum of their peaks; every other rule fails somewhere."""
    built = {name: build(name, BLIND) for name in chapter_4.FRAMES}
    pga = {name: find(name, test_records).pga_g for name in RECORDS}
    found = tables_4.summary(tables_4.rules_from_computed(lambda _pair: built, pga, gaps))
    assert found.loc["ABS", "safe"] == 1.0
    assert (found.drop(index="ABS")["safe"] < 1.0).all()
    assert found.index[0] == "DDC", "the closest rule"
    measured = tables_4.summary(tables_4.rules_from_measured(built, pga))
    # 10 beside 5B under El Centro: 12 mm measured where the measured peaks add up to 10.4 mm.
    assert measured.loc["ABS", "safe"] == pytest.approx(0.95)
    assert measured.loc["ABS", "least"] == pytest.approx(10.4 / 12.0)
    assert measured.index[0] == "DDC"


def test_summary_of_rules() -> None:
    ratios = pd.DataFrame({"a": [0.5, 1.0, 1.5], "b": [np.nan, 2.0, 2.0]})
    found = tables_4.summary(ratios)
    assert list(found.index) == ["a", "b"]
    assert found.loc["a", "safe"] == pytest.approx(2.0 / 3.0)
    assert found.loc["a", "error"] == pytest.approx(1.0 / 3.0)
    assert found.loc["a", "covers_for"] == pytest.approx(2.0)
    assert found.loc["b", "cases"] == 2


def test_gaps_are_confirmed_by_collisions(test_records, monkeypatch) -> None:
    """Contact 1 % below the required gap, none 1 % above; the study does so for all twenty."""
    monkeypatch.setattr(tables_4, "pairs", lambda: [("10", "5B", 5)])
    built = {name: build(name, BLIND) for name in ("10", "5B")}
    motions = {
        name: find(name, test_records).scaled(THESIS.time_factor) for name in ("elcentro", "hachinohe")
    }
    found = chapter_4.confirmations(built, motions)
    assert len(found) == 2
    assert found["holds"].all()
    np.testing.assert_allclose(found["engine_closing_mm"], found["closing_mm"], rtol=1e-3)


@pytest.mark.slow
def test_study_writes_tables_and_pictures(test_records, tmp_path, capsys, monkeypatch) -> None:
    every = chapter_4.variants()
    assert len([variant for variant in every if variant.polarity > 0]) == len(every) / 2 == 12
    # Each takes four seconds; the first has the peaks of Table 3.7, the second those of Table 7.1.
    monkeypatch.setattr(chapter_4, "variants", lambda: every[:4])
    chapter_4.main(out=tmp_path, records=test_records, collisions=False, json=True)
    result = json.loads(capsys.readouterr().out)
    assert len(result["table_4_2"]) == 20
    assert [row["variant"] for row in result["variants"]] == [str(variant) for variant in every[:4]]
    assert {path.name for path in tmp_path.glob("*.png")} == {
        "gap_maps.png",
        "gap_maps_strong_motion.png",
        "rules_computed.png",
        "rules_measured.png",
        "rules_strong_motion.png",
    }
    maps = pd.read_csv(tmp_path / "gap_maps.csv", index_col="damping_ratio")
    assert list(maps.index) == [0.005, 0.0105]
    assert (maps["largest_over_srss"] < 2**0.5 + 1e-6).all()
    assert not list(tmp_path.glob(".*"))
    assert len(pd.read_csv(tmp_path / "table_4_3.csv")) == 40


def test_contested_entries_are_left_out_by_name(gaps, test_records) -> None:
    """Left out is 15B under Hachinohe, and not the entry that no rule covers (10 beside 5B, El Centro)."""
    built = {name: build(name, BLIND) for name in chapter_4.FRAMES}
    pga = {name: find(name, test_records).pga_g for name in RECORDS}
    measured = tables_4.rules_from_measured(built, pga)
    contested = tables_4.table_4_2(gaps)["contested"].reindex(measured.index)
    left_out = measured[contested]
    assert {record for *_, record in left_out.index} == {"hachinohe"}
    assert tables_4.summary(measured[~contested]).loc["ABS", "least"] == pytest.approx(10.4 / 12.0)
