"""Long runs are sampled as often as the modes need, and what linear frames do stays what it was."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.case.case import Case, Run
from pounding.diagnosis.model import slowing
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.slowing import samples_looked_at, slowed_if_long
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.models import STEP_S, measured


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let 20,000 samples be many."""
    screening = replace(SETTINGS.screening, long_samples=20_000, long_rate_hz=125.0)
    monkeypatch.setattr(slowing, "SETTINGS", replace(SETTINGS, screening=screening))


def test_short_runs_stay_as_they_are() -> None:
    model = measured()
    assert slowed_if_long(model.observed, model.structure) is model.observed
    assert model.observed.warnings == []


def test_long_runs_are_sampled_at_the_rate_that_modes_need(few: None) -> None:
    model = measured(samples=3000)
    slow = slowed_if_long(model.observed, model.structure)
    highest = float(model.modes(model.assemble(np.zeros(len(model.std)))).omega.max()) / (2 * np.pi)
    assert slow.slower == 4
    assert 1 / slow.runs[0].step_s == pytest.approx(0.25 / STEP_S)
    assert 1 / slow.runs[0].step_s > 3.0 * highest
    assert len(slow.runs[0].time_s) == len(slow.runs[0].table) == len(slow.runs[0].measured) == 750
    (said,) = slow.warnings
    assert "125 Hz" in said


def test_the_samples_that_are_announced_are_those_that_are_looked_at(few: None) -> None:
    runs = tuple(
        Run(run.name, None, run.time_s, run.step_s, np.zeros((len(run.time_s), 6)))
        for run in measured(samples=3000).observed.runs
    )
    case = Case("bench", Path("bench"), (), runs, ())
    assert samples_looked_at(case) == 2 * 750
    assert samples_looked_at(replace(case, runs=runs[:1])) == 3000
    # Frames that touch are looked at this often however few samples there are.
    touching: Any = replace(case, runs=runs[:1], contacts=(None,))
    assert samples_looked_at(touching) == pytest.approx(3000 * STEP_S * SETTINGS.forces.rate_hz)


def test_a_linear_frame_does_not_notice(few: None) -> None:
    model = measured(samples=3000, noise=0.0)
    slow = Model(model.structure, slowed_if_long(model.observed, model.structure), model.prior)
    for run, output in zip(slow.observed.runs, slow.predict(np.zeros(len(slow.std))).outputs, strict=True):
        assert np.all((output - run.measured).std(axis=0) < 0.005 * run.measured.std(axis=0))


def test_noise_falls_with_the_rate(few: None) -> None:
    clean, noisy = measured(samples=3000, noise=0.0), measured(samples=3000, noise=0.02)
    slow = [slowed_if_long(one.observed, one.structure) for one in (clean, noisy)]
    plain = [one.observed.runs[0].measured for one in (noisy, clean)]
    left = slow[1].runs[0].measured - slow[0].runs[0].measured
    np.testing.assert_allclose(left.std(axis=0), 0.5 * (plain[0] - plain[1]).std(axis=0), rtol=0.1)
