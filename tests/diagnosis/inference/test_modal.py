"""Modal data: read with their uncertainty, diagnosed by evidence, the thesis' own among them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis import diagnose, read_report
from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.decision.modal_decision import probability
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.modal import examine
from pounding.diagnosis.inference.modal_evidence import (
    foretell,
    foretold_from_others,
    modal_candidates,
    weigh,
)
from pounding.diagnosis.inference.modal_model import alone
from pounding.diagnosis.inference.numbers import Numbers
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.report.report_text import sentence
from pounding.diagnosis.settings import SETTINGS
from pounding.diagnosis.studies.modal_diagnosis import amplitude_law, best_single, pooled
from pounding.diagnosis.studies.thesis_modal import thesis_belief, thesis_data, twin_scatter
from tests.diagnosis.models import three_storeys

BENCH = """
[[frame]]
name = "bench"
storeys = 3
storey_height_m = 0.2
floor_mass_kg = [6.5, 6.5, 6.5]
frequency_hz = [6.0]
damping_ratio = [0.01]
"""


def shows(
    model: Model, data: Sequence[ModalDatum], effects: Sequence[Effect], values: Sequence[float]
) -> np.ndarray:
    """What the model with effects of one parameter each shows of data."""
    acting = [(effect, np.array([value])) for effect, value in zip(effects, values, strict=True)]
    return np.asarray(np.exp(Numbers(model, (), data).shown(np.zeros(len(model.std)), acting)))


def numbers(effects: Sequence[Effect], values: Sequence[float], noise: float = 0.01) -> list[ModalDatum]:
    """What two tests of the bench would find with effects in it, exactly."""
    model = alone(three_storeys().frames[0], Prior())
    blank = [
        ModalDatum("bench", "frequency", mode, test, 1.0, noise)
        for test in ("free", "sweep")
        for mode in (1, 2, 3)
    ]
    blank.append(ModalDatum("bench", "roof_stiffness", None, "push", 1.0, noise))
    blank.append(ModalDatum("bench", "mass", None, "scales", 1.0, noise))
    found = shows(model, blank, effects, values)
    return [
        ModalDatum("bench", one.quantity, one.mode, one.test, float(value), noise * float(value))
        for one, value in zip(blank, found, strict=True)
    ]


def acting(name: str, test: str | None = None, storey: int | None = None) -> Effect:
    model = alone(three_storeys().frames[0], Prior())
    data = numbers([], [])
    return next(
        one
        for one in modal_candidates(model, None, data)
        if one.name == name and one.test == test and storey in (None, one.storey, one.floor)
    )


@pytest.mark.parametrize(
    ("hidden", "value"),
    [
        (acting("stiffness_change", storey=2), -0.35),
        (acting("added_mass", storey=3), 2.0),
        # The longest; a rocking base, which softens the whole frame too, is the quick one.
        pytest.param(
            acting("p_delta"), 40.0, marks=[pytest.mark.slow, pytest.mark.guard], id="p delta, bench-"
        ),
        (acting("base_rocking"), 1.2e4),
        (acting("hysteresis", "sweep"), -0.25),
    ],
    ids=lambda one: one.label() if isinstance(one, Effect) else "",
)
def test_what_was_put_in_is_found_with_its_size(hidden: Effect, value: float) -> None:
    model = alone(three_storeys().frames[0], Prior())
    data = numbers([hidden], [value])
    null = weigh(model, data)
    found = [weigh(model, data, [one]) for one in modal_candidates(model, None, data)]
    best = max(found, key=lambda one: one.log_evidence)
    assert best.acting == (hidden,)
    assert best.log_evidence > null.log_evidence + 3
    assert best.value[0] == pytest.approx(value, rel=0.25)
    assert best.misfit < 4


def test_nothing_is_claimed_where_nothing_was_put_in() -> None:
    model = alone(three_storeys().frames[0], Prior())
    found = examine(model, None, numbers([], []))
    assert found.best is found.null
    assert found.fits


def test_a_number_is_foretold_without_itself() -> None:
    model = alone(three_storeys().frames[0], Prior())
    data = numbers([], [])
    wrong = [*data[:-1], ModalDatum("bench", "mass", None, "scales", 40.0, 0.1)]
    (clean, _), (spoilt, surprise) = (foretold_from_others(model, one, ()) for one in (data, wrong))
    # The mass as foretold from the others does not know what the scales said.
    assert spoilt[-1] == pytest.approx(clean[-1])
    assert surprise[-1] > 5
    told, _ = foretell(model, data, (), [0])
    assert told[1] == pytest.approx(data[1].value, rel=0.01)


def test_the_sweep_is_worth_what_twins_say() -> None:
    # 5A and 5B differ by ln(5.585 / 5.123) in f3 / f1, 15A and 15B by ln(5.471 / 5.330).
    assert twin_scatter() == pytest.approx(0.023, abs=0.001)
    data = thesis_data("5B")
    assert data[0].value == 6.531
    assert data[3].std / data[3].value == pytest.approx(twin_scatter())


@pytest.mark.slow
def test_joint_flexibility_is_named_in_the_frames_of_the_thesis() -> None:
    rows = [row for name in ("5A", "5B", "10") for row in best_single(name)]
    ranked = pooled(rows)
    assert ranked[0]["effect"] == "joint_flexibility"
    assert ranked[0]["log_evidence"] > ranked[1]["log_evidence"] + 10
    # Fitted to the free vibration's first frequency alone, it foretells the rest within 4 %.
    assert ranked[0]["mean_foretold_error"] < 0.04
    assert ranked[0]["mean_foretold_error"] < min(row["mean_foretold_error"] for row in ranked[1:])


def test_the_fall_of_the_swept_frequency_grows_with_drift() -> None:
    laws = {one["power"]: one for one in amplitude_law()["laws"]}
    assert laws[1]["log_evidence"] > laws[0]["log_evidence"] + 3
    assert laws[2]["log_evidence"] > laws[0]["log_evidence"] + 3
    assert all(fall < 0 for fall in laws[2]["foretold"])


def test_joints_are_followed_from_rigid_to_soft() -> None:
    model, flexible = thesis_belief("5A", p_delta=False)
    data = thesis_data("5A")
    stiff, soft = (shows(model, data, [flexible], [stiffness]) for stiffness in (1e9, 1015.0))
    # Table 3.1 of the docs, with the frame rebuilt: 8.46 Hz rigid; 6.93, 21.12, 35.89 Hz and 29.97 N/mm at 1015 N m/rad.
    assert stiff[0] == pytest.approx(8.46, rel=1e-3)
    assert soft[[0, 2, 3]] == pytest.approx([6.93, 21.12, 35.89], rel=2e-3)
    assert soft[4] == pytest.approx(29970, rel=2e-3)


def modal(
    quantity: str = "frequency", value: object = 6.0, unit: str = "Hz", std: object = 0.05, more: str = ""
) -> str:
    return f'[[modal]]\nquantity = "{quantity}"\nvalue = {value}\nunit = "{unit}"\nstd = {std}\n{more}\n'


def test_a_modal_case_is_diagnosed_from_its_folder(tmp_path: Path) -> None:
    text = BENCH + "".join(
        modal(value=value, std=0.01 * value, more=f"mode = {mode}")
        for mode, value in ((1, 6.0), (2, 16.8), (3, 24.3))
    )
    (tmp_path / "case.toml").write_text(text)
    report = diagnose(tmp_path, tmp_path / "out")
    assert report.verdict == "nothing_missing"
    assert report.confidence is not None
    assert 0 < report.confidence <= 1
    assert read_report(tmp_path / "out") == report
    assert [row.mode for row in report.modal or ()] == [1, 2, 3]
    assert "predicted" in (tmp_path / "out" / "report.html").read_text()
    again = write_case(read_case(tmp_path), tmp_path / "copy").parent
    assert read_case(again).modal == read_case(tmp_path).modal


def test_numbers_that_contradict_each_other_are_not_called_nothing_missing(tmp_path: Path) -> None:
    twice = modal(value=5.0, std=0.05, more="mode = 1") + modal(value=7.0, std=0.05, more="mode = 1")
    (tmp_path / "case.toml").write_text(BENCH + twice)
    report = diagnose(tmp_path)
    assert report.verdict == "unknown_effect"
    assert report.effects == ()
    assert report.confidence is not None
    assert report.confidence > 0.999
    assert sentence(report).startswith("These numbers contradict the model or each other")


def test_the_probability_of_what_is_claimed_is_its_share_of_what_was_tried() -> None:
    """Two effects at once are less likely beforehand, by as much as a second one must bring."""
    tried = {
        name: SimpleNamespace(log_evidence=value, acting=(name,))
        for name, value in (("one", 4.0), ("other", 2.0))
    }
    null = SimpleNamespace(log_evidence=0.0, acting=())
    both = SimpleNamespace(log_evidence=5.0 + SETTINGS.modal.evidence, acting=("one", "other"))
    found: Any = SimpleNamespace(
        best=tried["one"], alike=(), null=null, singles=tuple(tried.values()), pairs=(both,)
    )
    whole = np.exp([0.0, 4.0, 2.0, 5.0]).sum()
    assert probability(found, "effect_named") == pytest.approx(np.exp(4.0) / whole)
    found.best = both
    assert probability(found, "effect_named") == pytest.approx(np.exp(5.0) / whole)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (modal("damping", more="mode = 1"), "unknown quantity 'damping'"),
        (modal(unit="rpm", more="mode = 1"), "unit 'rpm' does not fit"),
        (modal(), "a frequency needs `mode`"),
        (modal(more="mode = 4"), "mode 4 is not one of bench's 3"),
        (modal(std=0, more="mode = 1"), "state how uncertain the number is"),
        (modal(value=-6, more="mode = 1"), "value is -6 Hz; it must be 0.001 to 1000 Hz"),
        (modal(more='mode = 1\nframe = "5C"'), "frame '5C' is not in the case"),
        (modal(more="mode = 1\nmodel = 2"), "unknown key 'model'"),
    ],
)
def test_bad_modal_data_are_one_sentence_with_the_line(tmp_path: Path, text: str, said: str) -> None:
    (tmp_path / "case.toml").write_text(BENCH + text)
    with pytest.raises(CaseError) as caught:
        read_case(tmp_path)
    assert said in str(caught.value)
    assert "case.toml line" in str(caught.value)


def test_rigid_joints_are_for_plates_and_columns(tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(BENCH + 'joints = "rigid"\n' + modal(more="mode = 1"))
    with pytest.raises(CaseError, match="belongs to a frame of plates and columns"):
        read_case(tmp_path)
