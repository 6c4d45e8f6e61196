"""A case with numbers that no building and no sensor has is refused in one sentence when it is read."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.csv import MIN_SAMPLES
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.decision.impulses import _touching as touching
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.misfit_map import band
from pounding.diagnosis.workflow import diagnose
from tests.diagnosis.case.test_bad_input import case_of
from tests.diagnosis.models import measured


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_case(case_of(measured(samples=50, runs=2).observed), tmp_path / "case")
    return tmp_path / "case"


def cells(change: Callable[[int, list[str]], list[str]]) -> Callable[[str], str]:
    """A change of the cells of each row below the header, counted from 0."""

    def changed(text: str) -> str:
        header, *rows = text.splitlines()
        kept = [",".join(change(number, row.split(","))) for number, row in enumerate(rows)]
        return "\n".join([header, *kept]) + "\n"

    return changed


def spaced(step: str) -> Callable[[str], str]:
    return cells(lambda number, row: [str(number * float(step)), *row[1:]])


@pytest.mark.parametrize(
    ("file", "change", "said"),
    [
        ("run1.csv", cells(lambda n, row: [row[0], "1e300", *row[2:]]), "line 2, channel 'table': the cell is 1e+300 m/s^2"),
        ("run1.csv", cells(lambda n, row: [*row[:-1], f"{1 + n}e6"]), "line 3, channel 'd3': the cell is 2e+06 mm"),
        ("run2.csv", spaced("2"), "run2.csv: the step of time_s is 2 s; it must be 1e-06 to 0.2 s: "),
        ("run2.csv", spaced("1"), "is the time in another unit?"),
        ("run2.csv", spaced("1e6"), "run2.csv: the step of time_s is 1e+06 s"),
        ("run2.csv", spaced("1e-9"), "run2.csv: the step of time_s is 1e-09 s"),
        ("run2.csv", lambda text: text + "\n" * 3_000_000, "run2.csv: the number of lines is 3"),
        ("case.toml", lambda text: text.replace("6.806", "1e9"), "frequency_hz is 1e+09 Hz; it must be 0.001 to 1000 Hz"),
        ("case.toml", lambda text: text.replace("[6.5,", "[1e300,"), "floor_mass_kg is 1e+300 kg"),
        ("case.toml", lambda text: text.replace("storeys = 3", "storeys = 100000000"), "storeys is 1e+08"),
        ("case.toml", lambda text: text + "\n[prior]\nfloor_mass = 1e-300\n", "[prior] floor_mass is 1e-300"),
        ("case.toml", lambda text: text + "\n[prior]\njoint_stiffness = 0.1\n", "[prior] joint_stiffness is that of plates"),
        ("case.toml", lambda text: text + "\n[prior]\nmodel_error = 5\n", "[prior] model_error is 5; it must be"),
    ],
)  # fmt: skip
def test_numbers_that_cannot_be_are_refused(
    folder: Path, file: str, change: Callable[[str], str], said: str
) -> None:
    text = (folder / file).read_text(encoding="utf-8")
    assert change(text) != text
    (folder / file).write_text(change(text), encoding="utf-8")
    with pytest.raises(CaseError) as refused:
        read_case(folder)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_samples_too_far_apart_for_the_frame_are_refused(folder: Path) -> None:
    text = (folder / "case.toml").read_text(encoding="utf-8")
    (folder / "case.toml").write_text(text.replace("6.806", "260.0"), encoding="utf-8")
    with pytest.raises(CaseError, match=r"run1\.csv: samples 0\.002 s apart cannot show .* of bench, 260 Hz"):
        diagnose(folder)


def test_the_shortest_run_and_modes_beyond_the_sampling_rate_are_diagnosed(folder: Path) -> None:
    for file in ("run1.csv", "run2.csv"):
        lines = (folder / file).read_text(encoding="utf-8").splitlines()
        (folder / file).write_text("\n".join(lines[: MIN_SAMPLES + 1]), encoding="utf-8")
    text = (folder / "case.toml").read_text(encoding="utf-8")
    (folder / "case.toml").write_text(text.replace("6.806", "120.0"), encoding="utf-8")
    assert diagnose(folder).verdict


def test_a_band_beyond_half_the_sampling_rate_holds_nothing() -> None:
    series = np.ones((64, 2))
    assert not band(series, 300.0, 237.5, 0.002).any()


def test_a_touch_in_a_run_shorter_than_its_echo_is_all_of_it() -> None:
    assert touching(np.ones((5, 1)), 1e-4).shape == (5,)
