"""How much effects explain is asked where they act: each run and each channel by what they do there."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from pounding.diagnosis.decision import measures
from pounding.diagnosis.decision.measures import explains, what_is_done
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.misfit import simulate
from tests.diagnosis.decision.problems import CHANNELS, CUBIC, DATA, Problem, Tried, allow, bench, findings

HALF = 0.5


def of_misfits(before: np.ndarray, after: np.ndarray) -> Findings:
    """Return findings of one effect with misfits over the noise floor, each of shape (2, channels)."""
    found = findings(Problem(2.0, (Tried((CUBIC,), 5000.0, 1.0),), ""), DATA["quiet"])
    found.null = replace(found.null, channel_misfit=0.01 * before)
    found.judged[0] = replace(found.judged[0], channel_misfit=0.01 * after)
    return found


def rows(training: float, held_out: float) -> np.ndarray:
    return np.outer([training, held_out], np.ones(CHANNELS))


@pytest.mark.parametrize(
    ("before", "after", "done", "named"),
    [
        pytest.param((6.0, 3.0), (2.0, 2.9), (32.0, 0.5), True, id="held-out shaking hardly reaches it"),
        pytest.param((6.0, 6.0), (2.0, 5.9), (32.0, 32.0), False, id="it acts in held-out shaking and explains nothing"),
        pytest.param((6.0, 3.0), (4.5, 1.2), (16.0, 0.5), False, id="it explains only where it hardly acts"),
        pytest.param((6.0, 1.5), (2.0, 2.0), (32.0, 1.0), False, id="it brings misfit into held-out shaking"),
        pytest.param((6.0, 6.0), (6.0, 6.0), (0.0, 0.0), False, id="it does nothing"),
    ],
)  # fmt: skip
def test_each_run_counts_by_what_effects_do_there(
    before: tuple[float, float],
    after: tuple[float, float],
    done: tuple[float, float],
    named: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(measures, "what_is_done", lambda *_: rows(*done))
    found = of_misfits(rows(*before), rows(*after))
    assert explains(found, found.judged[0], HALF) == named


@pytest.mark.parametrize(("allowed", "named"), [(0.014, True), (0.013, False)])
def test_an_effect_brings_no_more_misfit_into_held_out_runs_than_a_model_may_leave(
    allowed: float, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It brings 1.32 % of the motion into a run that it hardly reaches."""
    allow(monkeypatch, allowed)
    monkeypatch.setattr(measures, "what_is_done", lambda *_: rows(32.0, 0.1))
    found = of_misfits(rows(6.0, 1.5), rows(2.0, 2.0))
    assert explains(found, found.judged[0], HALF) == named


@pytest.mark.parametrize(("moved", "named"), [(0, True), (1, False)])
def test_each_channel_counts_by_what_effects_do_there(
    moved: int, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The effect explains all of the first channel, and nothing of the others."""
    before, after, done = rows(6.0, 6.0), rows(5.9, 5.9), np.zeros((2, CHANNELS))
    after[:, 0], done[:, moved] = 1.0, 30.0
    monkeypatch.setattr(measures, "what_is_done", lambda *_: done)
    found = of_misfits(before, after)
    assert explains(found, found.judged[0], HALF) == named


def test_what_effects_do_is_what_parts_the_simulations_where_something_was_measured() -> None:
    model, usual = bench()
    found = findings(Problem(2.0, (Tried((CUBIC,), 5000.0, 1.0),), ""), DATA["quiet"])
    acting = [(CUBIC(), np.array([3e9]))]
    found.judged[0].fit.filtered = cast(Filtered, replace(usual, effects=acting))
    runs = list(model.observed.runs)
    measured = runs[0].measured.copy()
    measured[500:, 2] = np.nan
    found.model = model.seeing(replace(model.observed, runs=(replace(runs[0], measured=measured), runs[1])))
    done = what_is_done(found, found.judged[0])
    for which, run in enumerate(found.model.observed.runs):
        with_it, without = (simulate(model, usual.values, effects, [which])[0] for effects in (acting, []))
        change = np.where(np.isfinite(run.measured), with_it - without, np.nan)
        share = np.nanmean(change**2, axis=0) / np.nanmean(run.measured**2, axis=0)
        np.testing.assert_allclose(done[which], share / 0.01**2, rtol=1e-9)
    assert done.min() > 1.0


@pytest.mark.parametrize(("blind", "named"), [(True, True), (False, False)])
def test_only_held_out_runs_are_asked_where_the_motion_says_what_the_forces_are(
    blind: bool, named: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The floor of the fitted runs does not know how uncertain such forces are."""
    monkeypatch.setattr(measures, "what_is_done", lambda *_: rows(32.0, 32.0))
    found = of_misfits(rows(6.0, 6.0), rows(5.0, 2.0))
    found.pair = SimpleNamespace(blind=blind)  # type: ignore[assignment]
    assert explains(found, found.judged[0], HALF) == named
