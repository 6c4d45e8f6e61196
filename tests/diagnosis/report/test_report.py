"""The report: written and read again, that of schema 1 too, and what is no report refused in one sentence."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import structs
from rich.console import Console

from pounding.diagnosis import CaseError, Report, read_report
from pounding.diagnosis.decision.claims import Place, candidate
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.report.figures import evidence_figure
from pounding.diagnosis.report.making import said_once, with_shares
from pounding.diagnosis.report.report import (
    HeldOutMisfit,
    Misfit,
    Misfits,
    Threshold,
    Thresholds,
)
from pounding.diagnosis.report.report_text import (
    sentence,
)
from pounding.diagnosis.report.tables import tables
from tests.diagnosis.report.reports import of_a_pair, of_modal_data, of_runs

KEYS = {
    "schema",
    "verdict",
    "confidence",
    "effects",
    "misfit",
    "where",
    "candidates",
    "remainder",
    "calibration",
    "warnings",
}
"""The keys that every report has, by the public format."""


REPORTS = {"runs": of_runs, "pair": of_a_pair, "modal data": of_modal_data}


@pytest.mark.parametrize("kind", REPORTS)
def test_what_is_written_is_read_again(kind: str, tmp_path: Path) -> None:
    report = REPORTS[kind]()
    (tmp_path / "report.json").write_text(report.json(), encoding="utf-8")
    assert read_report(tmp_path / "report.json") == report
    # The folder that was given as --out is as good.
    assert read_report(str(tmp_path)) == report
    written = json.loads(report.json())
    assert set(written) >= KEYS
    assert written["schema"] == 2
    assert set(written["misfit"]["held_out"]) >= {"run", "before", "after", "noise_floor"}
    assert written["remainder"] is None
    assert "NaN" not in report.json()


def test_places_and_members_have_the_keys_of_the_format() -> None:
    written = json.loads(of_runs().json())
    (effect,) = written["effects"]
    assert effect["class"][0] == {
        "effect": "coulomb_friction", "frame": "5B", "storey": 3, "floor": None, "channel": None,
        "contact": None, "left": None, "right": None,
    }  # fmt: skip
    assert effect["parameters"] == [{"name": "friction_force", "value": 12.1, "std": 0.4, "unit": "N"}]
    assert written["where"][0]["misfit"] == 0.44
    assert "modal" not in written
    assert json.loads(of_modal_data().json())["effects"][0]["test"] == "free_vibration"


def as_schema_1(report: Report) -> dict[str, Any]:
    """Return a report as it was written before: the disagreement is called `gap`, what it explains `closed`."""
    raw = json.loads(report.json())
    raw["schema"] = 1
    raw["gap"] = raw.pop("misfit")
    for gap in raw["gap"].values():
        if gap and "explained" in gap:
            gap["closed"] = gap.pop("explained")
    for spot in raw["where"]:
        spot["gap"] = spot.pop("misfit")
    former = {"ln_bayes": "nats", "signal_to_noise": "visible", "explained": "closed"}
    basis = raw["confidence_basis"]
    if "features" in basis:
        basis["features"] = {former.get(key, key): value for key, value in basis["features"].items()}
    for row in raw.get("modal", ()):
        row["believed"], row["foretold"] = row.pop("baseline"), row.pop("predicted")
    del raw["remainder"], raw["calibration"]
    return dict(raw)


@pytest.mark.parametrize("kind", REPORTS)
def test_a_report_of_schema_1_is_read_as_what_it_says(kind: str, tmp_path: Path) -> None:
    report = REPORTS[kind]()
    (tmp_path / "report.json").write_text(json.dumps(as_schema_1(report)), encoding="utf-8")
    assert read_report(tmp_path) == report


def without(key: str) -> str:
    raw = json.loads(of_runs().json())
    del raw[key]
    return json.dumps(raw)


def changed(**values: Any) -> str:
    return json.dumps(json.loads(of_runs().json()) | values)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (changed(schema=3), "has schema 3, and this version reads 1 and 2"),
        (changed(schema="2"), "has schema '2'"),
        (changed(schema=True), "has schema True"),
        (changed(schema=None), "has schema None"),
        (changed(schema=[2]), "has schema"),
        (of_runs().json()[:-40], "is not JSON"),
        ("", "is not JSON"),
        ("\x00", "is not JSON"),
        (of_runs().json().replace("412.0", "NaN"), "is not JSON"),
        ("[" * 100_000, "is not JSON"),
        ("[]", "is no report"),
        ('"report"', "is no report"),
        ("null", "is no report"),
        ('{"verdict": "nothing_missing"}', "is no report"),
        *((without(key), f"`{key}`") for key in ("verdict", "confidence", "effects", "misfit", "candidates")),
        (changed(verdict="perhaps"), "not a whole report"),
        (changed(effects=[{"frame": "5B"}]), "`effect`"),
        (changed(misfit=None), "not a whole report"),
        (changed(schema=1, gap=[1]), "not a whole report"),
        (changed(schema=1, gap={"training": 3, "held_out": None}), "not a whole report"),
        (changed(schema=1, where=3), "not a whole report"),
        (changed(schema=1, where=[3]), "not a whole report"),
        (changed(schema=1, modal=[3]), "not a whole report"),
        (changed(schema=1, confidence_basis={"features": [1]}), "not a whole report"),
    ],
)
def test_what_is_no_report_is_refused_in_one_sentence(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text(text, encoding="utf-8")
    with pytest.raises(CaseError) as refused:
        read_report(tmp_path)
    assert said in str(refused.value)
    assert str(refused.value).startswith(str(tmp_path / "report.json"))
    assert "\n" not in str(refused.value)


def test_a_missing_file_and_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"report\.json: cannot be read \(No such file"):
        read_report(tmp_path)
    (tmp_path / "report.json").write_bytes(b'{"schema": 2, "verdict": "\xff"}')
    with pytest.raises(CaseError, match="is not JSON"):
        read_report(tmp_path)


def test_keys_that_a_later_version_adds_are_passed_over(tmp_path: Path) -> None:
    (tmp_path / "report.json").write_text(changed(weather="fine"), encoding="utf-8")
    assert read_report(tmp_path) == of_runs()


@pytest.mark.parametrize("kind", REPORTS)
def test_the_terminal_shows_verdict_size_and_evidence(kind: str) -> None:
    report = REPORTS[kind]()
    console = Console(width=200, file=io.StringIO(), markup=False)
    for part in tables(report):
        console.print(part)
    text = " ".join(console.file.getvalue().split())  # type: ignore[attr-defined]
    assert sentence(report) in text
    assert report.effects[0].parameters[0].name in text
    # The figure by which everything is judged is explained once.
    assert text.count("natural logarithm") == 1
    assert "nats" not in text


@pytest.mark.parametrize("kind", REPORTS)
def test_a_terminal_of_80_columns_cuts_no_name(kind: str) -> None:
    report = REPORTS[kind]()
    console = Console(width=80, file=io.StringIO(), markup=False)
    for part in tables(report):
        console.print(part)
    assert "…" not in console.file.getvalue()  # type: ignore[attr-defined]


def test_a_warning_that_holds_for_several_runs_is_said_once() -> None:
    unused = "columns 'a', 'b' are no [[channel]] of the case and not used"
    warnings = [f"run{number}.csv: {unused}" for number in (1, 2, 3)]
    warnings[1:1] = ["run1.csv: nothing moves in this run; it was left out", "the clock may be off"]
    assert said_once([*warnings, warnings[0]]) == (
        f"run1.csv, run2.csv and run3.csv: {unused}",
        "run1.csv: nothing moves in this run; it was left out",
        "the clock may be off",
    )


@pytest.mark.parametrize(
    ("before", "after", "noise", "share"),
    [
        (0.3, 0.1, 0.05, 0.8),
        (0.3, 0.05, 0.05, 1.0),
        (0.3, 0.04, 0.05, 1.0),
        (0.054, 0.05, 0.05, None),
        (0.3, None, 0.05, None),
    ],
)
def test_only_what_exceeds_the_noise_can_be_explained(
    before: float, after: float | None, noise: float, share: float | None
) -> None:
    explained = Misfit(before=before, after=after, noise_floor=noise).share()
    assert explained == (None if share is None else pytest.approx(share))


@pytest.mark.parametrize(("verdict", "shown"), [("effect_named", "-14.3 %"), ("nothing_missing", "–")])
def test_where_nothing_is_missing_nothing_is_said_to_be_explained(verdict: Verdict, shown: str) -> None:
    worse = HeldOutMisfit(run="run3.csv", before=0.09, after=0.1, noise_floor=0.02)
    misfits = with_shares(Misfits(training=None, held_out=worse), verdict)
    report = structs.replace(of_runs(), verdict=verdict, misfit=misfits)
    console = Console(width=200, file=io.StringIO(), markup=False)
    for part in tables(report):
        console.print(part)
    (row,) = [line for line in console.file.getvalue().splitlines() if "held out" in line]  # type: ignore[attr-defined]
    assert [cell.strip() for cell in row.split("│")[2:-1]] == ["9 %", "10 %", "2 %", shown]


@pytest.mark.parametrize(("needed", "lines"), [(30.0, 1), (200.0, 2)])
def test_what_a_verdict_needs_is_inside_the_picture_of_the_evidence(needed: float, lines: int) -> None:
    weak = Place(effect="p_delta", frame="5B")
    thresholds = Thresholds(
        log_evidence=needed / lines,
        share_of_noise=0.2,
        absorbing=Threshold(log_evidence=needed, share_of_noise=0.2),
    )
    report = structs.replace(
        of_runs(), effects=(), candidates=(candidate(weak, 14.8),), thresholds=thresholds
    )
    (axes,) = evidence_figure(report).axes
    drawn = [float(np.ravel(line.get_xdata())[0]) for line in axes.get_lines()]
    assert drawn == [needed / lines, needed][:lines]
    assert max(drawn) < axes.get_xlim()[1]
    assert axes.texts[-1].get_text() == "14.8"
