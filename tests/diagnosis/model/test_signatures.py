"""Signatures beside small differences of the prediction: what the inference takes for slopes are its slopes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.every_storey import AllCubicStiffness
from pounding.diagnosis.effects.storey import (
    STICKING,
    STICKING_RATIO,
    CoulombFriction,
    CubicStiffness,
    DampingChange,
    Hysteresis,
)
from pounding.diagnosis.effects.table_and_sensors import SensorGain, TableClock, TableGain
from pounding.diagnosis.inference import filtering
from pounding.diagnosis.inference.filtering import (
    LARGEST_SLOPE,
    Filtered,
    run_filter,
    run_signatures,
    signature_pieces_of_run,
    tangents_of,
    whitened,
)
from pounding.diagnosis.inference.motions import motion_of
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import MODAL_DAMPING
from pounding.diagnosis.model.terms import nuisance_terms
from tests.diagnosis.models import measured

LAWS: dict[str, list[tuple[Effect, np.ndarray]]] = {
    "no law": [],
    "cubic spring": [(CubicStiffness(index=1, frame="bench", storey=2), np.array([2e10]))],
    "damper": [(DampingChange(index=1, frame="bench", storey=2), np.array([200.0, 0.0]))],
    "hysteresis": [(Hysteresis(index=0, frame="bench", storey=1), np.array([25.0, 3e4, 2.0, 0.0]))],
    "friction": [(CoulombFriction(index=0, frame="bench", storey=1), np.array([4.0, 4.0, 0.0, 0.3]))],
    "cubic springs": [(AllCubicStiffness(index=0, frame="bench"), np.array([3e5, 0.2]))],
}


@pytest.mark.parametrize(
    ("law", "by_drift", "by_rate"),
    [("cubic spring", True, False), ("damper", False, True), ("hysteresis", True, False)],
)
def test_a_law_answers_what_its_force_depends_on(law: str, by_drift: bool, by_rate: bool) -> None:
    """A damper answers no drift, and the drifts of none are worked out."""
    model = measured(LAWS[law])
    still = np.zeros(len(model.std))
    laws = tangents_of(model, run_filter(model, still, starting_noise(model, (0,), 0.1), (0,), LAWS[law]), 0)
    assert laws is not None
    assert laws.answers.tolist() == [[by_drift], [by_rate]]
    assert not laws.unanswering().answers.any()


@pytest.mark.parametrize("level", [0.1, 0.003])
@pytest.mark.parametrize("law", LAWS)
def test_signatures_are_slopes_of_the_innovations(
    law: str, level: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever acts, and however far the filter corrects a frame that is not quite the measured one."""
    model = measured(LAWS[law])
    values = np.zeros(len(model.std))
    coupling = np.array([one.kind == MODAL_DAMPING for one in model.parameters])
    for which, seed in ((~coupling, 5), (coupling, 6)):
        values[which] = 0.5 * model.std[which] * np.random.default_rng(seed).standard_normal(which.sum())
    filtered = run_filter(model, values, starting_noise(model, (0,), level), (0,), LAWS[law])
    found = errors(model, filtered)
    assert np.median(found) < 0.05
    assert found.max() < 0.12
    if filtered.effects and level < 0.1:
        monkeypatch.setattr(filtering, "tangents_of", lambda *_: None)
        assert np.median(errors(model, filtered)) > 2 * np.median(found)


@pytest.mark.parametrize(
    ("effect", "size"),
    [(TableClock(), -0.01), (TableGain(), -0.4), (SensorGain(index=2, channel="a3"), -1.8)],
)
def test_slopes_follow_gain_and_clock_of_table_and_sensors(effect: Effect, size: float) -> None:
    acting = [(effect, np.array([size]))]
    model = measured(acting)
    noise = starting_noise(model, (0,), 0.003)
    filtered = run_filter(model, np.zeros(len(model.std)), noise, (0,), acting)
    assert errors(model, filtered).max() < 0.12


def stuck() -> tuple[Model, Filtered]:
    """Return a frame with a joint twenty times as stiff as its storey that never slips, filtered."""
    damping_ratio = STICKING_RATIO * np.sqrt(STICKING / 20.0)
    joint = [(CoulombFriction(index=1, frame="bench", storey=2), np.array([500.0, 20.0, 0.0, damping_ratio]))]
    model = measured(joint, runs=1)
    return model, run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.1), (0,), joint)


def test_slopes_follow_a_joint_that_is_stuck(monkeypatch: pytest.MonkeyPatch) -> None:
    model, filtered = stuck()
    found = np.median(errors(model, filtered))
    monkeypatch.setattr(filtering, "tangents_of", lambda *_: None)
    assert found < 0.15 < 0.8 < np.median(errors(model, filtered))


@pytest.mark.parametrize("law", ["no law", "hysteresis", "cubic springs"])
def test_a_column_has_the_sum_of_what_its_terms_show_alone(law: str) -> None:
    """However many terms each column has: what pushes it is added up before it goes through the loop, not after."""
    model = measured(LAWS[law], samples=300)
    still = np.zeros(len(model.std))
    filtered = run_filter(model, still, starting_noise(model, (0,), 0.1), (0,), LAWS[law])
    terms = [
        term
        for group in nuisance_terms(model, filtered.modes, motion_of(model, filtered, 0))
        for term in group
    ]
    many = [terms[:2], [], terms[2:3], terms[3:8], [], terms[:1], terms[8:]]
    together = run_signatures(model, filtered, 0, many)
    for column, group in zip(together.T, many, strict=True):
        alone = run_signatures(model, filtered, 0, [[one] for one in group]).sum(axis=1)
        np.testing.assert_allclose(column, alone, atol=2e-6 * np.abs(together).max())
    assert not run_signatures(model, filtered, 0, [[], []]).any()


def test_signatures_stay_finite_where_laws_would_blow_up_to_first_order(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    model, filtered = stuck()
    motion = motion_of(model, filtered, 0)
    groups = nuisance_terms(model, filtered.modes, motion)
    laws = tangents_of(model, filtered, 0)
    assert laws is not None
    wild = replace(laws, within=-laws.within)
    plain, largest = (
        max(np.abs(rows).max() for _, rows in signature_pieces_of_run(model, filtered, 0, groups, 512, one))
        for one in (laws.unanswering(), wild)
    )
    assert not largest < LARGEST_SLOPE
    monkeypatch.setattr(filtering, "tangents_of", lambda *_: wild)
    assert np.abs(run_signatures(model, filtered, 0, groups)).max() == plain < LARGEST_SLOPE


def errors(model: Model, filtered: Filtered) -> np.ndarray:
    """Return the relative error of each nuisance parameter's signature in the first run, (parameters told,)."""
    slopes = np.array([slope(model, filtered, j) for j in range(len(model.std))]).T
    # A shift moves the noise as well, which no prediction knows; `test_kalman` has it by itself.
    told = np.array([parameter.kind != "channel_delay" for parameter in model.parameters])
    columns = run_signatures(
        model, filtered, 0, nuisance_terms(model, filtered.modes, motion_of(model, filtered, 0))
    )
    return np.asarray(np.linalg.norm(columns - slopes, axis=0)[told] / np.linalg.norm(slopes, axis=0)[told])


def slope(model: Model, filtered: Filtered, j: int) -> np.ndarray:
    """Return the slope of whitened innovations by a nuisance parameter, downwards, from a small change to either side."""
    there = []
    for side in (-1.0, 1.0):
        moved = filtered.values.copy()
        moved[j] += side * 0.01 * model.std[j]
        found = model.predict(moved, filtered.gains, filtered.effects, (0,), whole=False).innovations[0]
        there.append(whitened(found, filtered.filters[0]).ravel())
    return np.asarray((there[0] - there[1]) / (0.02 * model.std[j]))
