"""Design spectra: corners, plateaus, and records that are brought to them."""

from __future__ import annotations

import numpy as np
import pytest

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records import Record, find
from pounding.experiments.records.code_spectra import LOOKS, target
from pounding.experiments.records.spectra import response_spectrum

ALL = [
    *(f"ec8-{kind}:0.25:{ground}" for kind in (1, 2) for ground in "ABCDE"),
    "asce7:0.8:0.4",
    "asce7:0.8:0.4:6",
    "gb50011:0.24:0.45",
    *(f"as1170:0.1:{ground}e" for ground in "ABCDE"),
]


@pytest.mark.parametrize("text", ALL)
def test_spectra_rise_to_a_plateau_and_fall_without_a_jump(text: str) -> None:
    periods = np.geomspace(0.01, 4.0, 20_000)
    values = target(text).at(periods)
    assert values.min() > 0.0
    # Rounded coefficients of AS 1170.4 leave a step of 0.05 %.
    assert np.abs(np.diff(np.log(values))).max() < 2e-3
    top = values.max()
    plateau = periods[values > 0.9999 * top]
    assert plateau[-1] / plateau[0] > 1.5
    assert (np.diff(values[periods > plateau[-1]]) <= 0.0).all()


@pytest.mark.parametrize(
    ("text", "period_s", "expected_g"),
    [
        ("ec8-1:0.25:B", 0.3, 0.25 * 1.2 * 2.5),
        ("ec8-1:0.25:B", 1.0, 0.25 * 1.2 * 2.5 * 0.5),
        ("ec8-1:0.25:B", 4.0, 0.25 * 1.2 * 2.5 * 0.5 * 2.0 / 16.0),
        ("asce7:0.8:0.4", 0.05, 0.8 * (0.4 + 0.6 * 0.05 / 0.1)),
        ("asce7:0.8:0.4", 2.0, 0.2),
        ("asce7:0.8:0.4:3", 4.0, 0.4 * 3.0 / 16.0),
        ("gb50011:0.24:0.45", 0.9, 0.24 * 0.5**0.9),
        ("as1170:0.1:Ce", 0.2, 0.368),
        ("as1170:0.1:Ce", 1.0, 0.125),
        ("as1170:0.1:Ce", 2.0, 0.1 * 1.874 / 4.0),
    ],
)
def test_values_by_hand(text: str, period_s: float, expected_g: float) -> None:
    assert target(text).at(np.array([period_s]))[0] == pytest.approx(expected_g)


def test_a_record_brought_to_its_target_meets_it_in_the_mean() -> None:
    record, aim = find("elcentro-chopra"), target("ec8-1:0.25:B")
    factor = aim.factor(record, (0.9, 1.4))
    scaled = record.scaled(1.0, factor * record.pga_g)
    periods = np.geomspace(0.2 * 0.9, 2.0 * 1.4, LOOKS)
    own = response_spectrum(scaled, periods, 0.05).pseudo_acceleration_m_s2 / 9.80665
    assert np.mean(np.log(own / aim.at(periods))) == pytest.approx(0.0, abs=1e-9)


def test_a_model_meets_the_spectrum_of_its_building() -> None:
    record, aim = find("elcentro-chopra"), target("ec8-1:0.25:B")
    small = record.scaled(0.2)
    assert aim.factor(small, (0.2, 0.3), 0.2) == pytest.approx(aim.factor(record, (1.0, 1.5)), rel=1e-6)


def test_a_record_that_is_too_short_is_refused() -> None:
    short = Record("short", np.sin(np.arange(200.0)), 0.02)
    with pytest.raises(
        ExperimentError, match=r"record short, 3.98 s .* says nothing of periods from 0.2 to 3 s"
    ):
        target("ec8-1:0.25:B").factor(short, (1.0, 1.5))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("ec8:0.25:B", "no such code"),
        ("ec8-1:0.25:X", "cannot be read; write ec8-1:AG:GROUND"),
        ("ec8-1:much:B", "cannot be read"),
        ("ec8-1:-1:B", "the acceleration of a target is -1 g"),
        ("asce7:0.8", "cannot be read"),
        ("asce7:0.8:0.4:0.1", "cannot be read"),
        ("gb50011:0.24:45", "cannot be read"),
        ("as1170:0.1", "cannot be read"),
    ],
)
def test_targets_that_cannot_be(text: str, sentence: str) -> None:
    with pytest.raises(ExperimentError) as caught:
        target(text)
    assert sentence in str(caught.value)
