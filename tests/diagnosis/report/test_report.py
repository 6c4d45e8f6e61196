"""The report: written and read again, that of schema 1 too, and what is no report refused in one sentence."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import UNSET, structs
from rich.console import Console

from pounding.diagnosis import CaseError, Report, read_report
from pounding.diagnosis.case.case import Case
from pounding.diagnosis.decision.claims import Place, candidate, claim, parameter
from pounding.diagnosis.decision.conclusion import ContactMisfit
from pounding.diagnosis.decision.confidence import Basis, Features
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.inference.misfit_map import Spot
from pounding.diagnosis.report.details import with_shares
from pounding.diagnosis.report.figures import evidence_figure
from pounding.diagnosis.report.making import said_once
from pounding.diagnosis.report.report import (
    ChannelMisfit,
    HeldOutMisfit,
    Misfit,
    Misfits,
    ModalRow,
    Threshold,
    Thresholds,
)
from pounding.diagnosis.report.report_text import (
    against_the_next,
    beside_the_verdict,
    next_steps,
    percent,
    sentence,
    together,
)
from pounding.diagnosis.report.tables import tables

FRICTION = Place(effect="coulomb_friction", frame="5B", storey=3)
DAMPING = Place(effect="damping_change", frame="5B", storey=3)
LAW = Place(effect="contact_law", contact=1)
FEATURES = Features("effect_named", 412.0, 380.0, 6.0, 0.97, 1)
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


def of_runs() -> Report:
    """Return a report on shaken frames: an effect that another cannot be told from, a dead channel among the rest."""
    size = parameter("friction_force", 12.1, 0.4, "N")
    return Report(
        verdict="effect_class",
        confidence=0.97,
        confidence_basis=Basis(calibration="some cases", features=FEATURES),
        effects=(claim(FRICTION, [size], 412.0, [FRICTION, DAMPING]),),
        misfit=Misfits(
            training=Misfit(before=0.31, after=0.021, noise_floor=0.02, explained=0.99),
            held_out=HeldOutMisfit(run="run3.csv", before=0.35, after=0.024, noise_floor=0.02),
        ),
        where=(Spot(channel="5B_a3", run="run2.csv", window_s=(1.2, 2.9), band_hz=(5.0, 8.0), misfit=0.44),),
        candidates=(candidate(FRICTION, 412.0), candidate(DAMPING, 405.0)),
        warnings=("a1 is clipped",),
        channels=(ChannelMisfit(channel="a1", before=None, after=None, noise_floor=None),),
    )


def of_a_pair() -> Report:
    """Return a report on frames that pound, whose contact has another law than believed."""
    sizes = [parameter("law", "hertz", None, "-"), parameter("stiffness", 1e9, float("nan"), "N/m^1.5")]
    report = structs.replace(of_runs(), verdict="effect_named", effects=(claim(LAW, sizes, 60.0),))
    impacts = ContactMisfit(impacts=9, before=5.0, after=1.1)
    return structs.replace(report, misfit=structs.replace(report.misfit, contact=impacts))


def of_modal_data() -> Report:
    """Return a report on modal data alone, of which one effect acts in a single test."""
    only = structs.replace(Place(effect="hysteresis", frame="5B"), test="free_vibration")
    size = parameter("first_mode_stiffness_change", -0.08, 0.01, "1")
    row = ModalRow(
        frame="5B", quantity="frequency", mode=1, test="hammer", measured=6.5, std=0.03,
        baseline=6.9, fitted=6.5, predicted=None, surprise=None,
    )  # fmt: skip
    errors = HeldOutMisfit(
        run="each number predicted from the others", before=0.06, after=0.01, noise_floor=0.005
    )
    return Report(
        verdict="effect_named",
        confidence=0.8,
        confidence_basis=Basis(calibration="posterior probability"),
        effects=(claim(only, [size], 12.0),),
        misfit=Misfits(training=Misfit(before=0.04, after=0.005, noise_floor=0.005), held_out=errors),
        where=(),
        candidates=(candidate(only, 12.0),),
        warnings=(),
        modal=(row,),
    )


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


def test_the_sentence_says_what_where_how_large_and_how_sure() -> None:
    assert sentence(of_runs()) == (
        "Missing is coulomb friction in storey 3 of 5B (friction force 12.1 ± 0.4 N), or damping change in storey 3 of 5B, "
        "which this data cannot tell from it; the misfit on run3.csv, which was not used, goes from 35 % to 2.4 %, "
        "where noise alone leaves 2 % (97 % sure)."
    )
    nothing = structs.replace(of_runs(), verdict="nothing_missing", effects=(), confidence=0.999)
    assert sentence(nothing).startswith(
        "Nothing is missing that this data could show: the misfit on run3.csv"
    )
    assert sentence(nothing).endswith("(more than 99 % sure).")
    unknown = structs.replace(of_runs(), verdict="unknown_effect")
    assert "nothing in the catalogue fits it" in sentence(unknown)
    alone = structs.replace(of_runs(), misfit=structs.replace(of_runs().misfit, held_out=None))
    assert "the misfit on the runs used goes from 31 % to 2.1 %" in sentence(alone)
    assert "(law hertz, stiffness 1e+09 N/m^1.5)" in sentence(of_a_pair())
    modal = sentence(of_modal_data())
    assert "hysteresis of 5B, only in the free vibration (first mode stiffness change -0.08 ± 0.01)" in modal
    assert "predicted from the others is off by 1 % in the median instead of 6 %" in modal


def test_a_worst_channel_that_the_median_hides_is_told() -> None:
    bad = ChannelMisfit(channel="d5", before=1.5, after=0.05, noise_floor=0.02)
    told = structs.replace(of_runs(), channels=(*(of_runs().channels or ()), bad))
    assert "and that of channel d5 from 150 % to 5 %" in sentence(told)
    like_others = structs.replace(bad, before=0.5)
    assert "d5" not in sentence(structs.replace(of_runs(), channels=(like_others,)))


def test_how_strongly_an_effect_is_told_from_the_next_is_said_where_that_can_be_compared() -> None:
    named = structs.replace(of_runs(), verdict="effect_named")
    (effect,) = named.effects
    alone = structs.replace(named, effects=(structs.replace(effect, members=(FRICTION,)),))
    assert against_the_next(alone) == (
        "Coulomb friction in storey 3 of 5B against the next candidate, damping change in storey 3 of 5B: "
        "the evidence is decisive (ln Bayes factor 7)."
    )
    for behind, word in ((409.0, "weak"), (408.0, "strong"), (400.0, "decisive")):
        tried = (candidate(FRICTION, 412.0), candidate(DAMPING, behind))
        assert f"is {word} " in str(against_the_next(structs.replace(alone, candidates=tried)))
    ahead = (candidate(DAMPING, 424.0), candidate(FRICTION, 412.0))
    said = str(against_the_next(structs.replace(alone, candidates=ahead)))
    assert said.startswith(
        "Damping change in storey 3 of 5B has more evidence (an ln Bayes factor of 12 against"
    )
    # All that was tried is in the class, nothing is missing, or impacts were weighed beside motions.
    assert against_the_next(of_runs()) is None
    assert against_the_next(structs.replace(alone, effects=())) is None
    both = (*alone.candidates, candidate(LAW, 3.0))
    assert against_the_next(structs.replace(alone, candidates=both)) is None


def test_a_warning_that_holds_for_several_runs_is_said_once() -> None:
    unused = "columns 'a', 'b' are no [[channel]] of the case and not used"
    warnings = [f"run{number}.csv: {unused}" for number in (1, 2, 3)]
    warnings[1:1] = ["run1.csv: nothing moves in this run; it was left out", "the clock may be off"]
    assert said_once([*warnings, warnings[0]]) == (
        f"run1.csv, run2.csv and run3.csv: {unused}",
        "run1.csv: nothing moves in this run; it was left out",
        "the clock may be off",
    )


def test_what_to_measure_next_is_said_without_figures_and_with_them_on_the_technical_pages() -> None:
    said = "A weight on the roof is expected to decide between friction and yielding."
    report = structs.replace(of_runs(), advice=(said,), advice_evidence=(588.4,))
    case = Case("bench", Path(), (), (), ())
    assert next_steps(case, report)[0] == said
    assert next_steps(case, report, figures=True)[0] == f"{said[:-1]} (ln Bayes factor 588)."


def test_one_late_logger_is_one_effect_on_its_channels() -> None:
    late = [
        claim(Place(effect="sensor_delay", channel=name), [parameter("delay", 3.0, 0.1, "ms")], 90.0)
        for name in ("d1", "d3")
    ]
    (shown,) = together(late)
    assert shown.words() == "sensor delay of channels d1, d3"
    other = claim(Place(effect="sensor_delay", channel="a1"), [parameter("delay", 1.0, 0.1, "ms")], 90.0)
    assert len(together([*late, other])) == 2
    assert len(together([claim(FRICTION, [], 9.0), claim(FRICTION, [], 9.0)])) == 2


@pytest.mark.parametrize(
    ("before", "after", "noise", "share"),
    [(0.3, 0.1, 0.05, 0.8), (0.3, 0.05, 0.05, 1.0), (0.054, 0.05, 0.05, None), (0.3, None, 0.05, None)],
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


def test_what_is_not_known_is_a_dash() -> None:
    assert [percent(value) for value in (None, UNSET, 0.0, 0.1234)] == ["–", "–", "0 %", "12.3 %"]


@pytest.mark.parametrize(
    ("verdict", "evidence", "refined", "said"),
    [
        ("nothing_missing", 6.4, True, True),
        ("nothing_missing", 2.9, True, False),
        ("nothing_missing", 6.4, False, False),
        ("unknown_effect", 6.4, True, False),
    ],
)
def test_what_comes_nearest_to_being_named_is_said_with_its_size(
    verdict: Verdict, evidence: float, refined: bool, said: bool
) -> None:
    """A storey that lost a fifth, and that the calibration may have lost as well, is not passed over in silence."""
    place = Place(effect="stiffness_change", frame="5B", storey=1)
    sizes = (parameter("relative_change", -0.221, 0.029, "1"),) if refined else UNSET
    absorbing = Threshold(log_evidence=7.66, share_of_noise=0.4)
    report = structs.replace(
        of_runs(),
        verdict=verdict,
        effects=(),
        candidates=(candidate(place, evidence, sizes),),
        thresholds=Thresholds(log_evidence=7.66, share_of_noise=0.2, absorbing=absorbing),
    )
    sentence = (
        "Nearest to a verdict is stiffness change in storey 1 of 5B (relative change -0.221 ± 0.029): its ln Bayes factor "
        "is 6.4, and a name needs 7.66 and 20 % of some channel's noise, or more."
    )
    assert (sentence in beside_the_verdict(report)) == said


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
