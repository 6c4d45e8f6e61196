"""What a further measurement is expected to bring, against what it brings when it is made."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.design.frame_advice import advice, as_it_was, expected, measurements, rivals
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured


def effect(name: str, storey: int) -> Effect:
    return next(one for one in candidates(measured()) if one.name == name and one.storey == storey)


def searched(model: Model) -> Findings:
    effects = [one for one in candidates(model) if one.name in ("hysteresis", "cubic_stiffness", "bumper")]
    return search(model, effects, [0], [1], lambda what, share: None)


@cache
def stiffening() -> Findings:
    """Findings on the bench with a cubic spring, which tests change nothing of."""
    return searched(measured([(effect("cubic_stiffness", 2), np.array([2e9]))]))


YIELDING = (effect("hysteresis", 2), effect("hysteresis", 2).values(1e4, (0.002,)))


def louder(factor: float, noise: float) -> Model:
    """The bench that yields, shaken harder, with the same noise in SI."""
    quiet = measured([YIELDING], noise=noise)
    rng = np.random.default_rng(5)
    runs = []
    for number, run in enumerate(quiet.observed.runs):
        clean = quiet.predict(np.zeros(len(quiet.std)), None, [YIELDING], [number]).outputs[0]
        std = noise * clean.std(axis=0)
        harder = replace(run, table=factor * run.table)
        alone = Model(quiet.structure, replace(quiet.observed, runs=(harder,)), quiet.prior)
        output = alone.predict(np.zeros(len(alone.std)), None, [YIELDING], [0]).outputs[0]
        runs.append(replace(harder, measured=output + std * rng.standard_normal(output.shape)))
    return Model(quiet.structure, replace(quiet.observed, runs=tuple(runs)), quiet.prior)


@pytest.mark.slow
def test_twice_the_amplitude_tells_what_one_could_not_as_was_foretold() -> None:
    weak = searched(louder(1.0, 0.05))
    decision = decide(weak)
    assert decision.verdict == "nothing_missing"
    said = advice(weak, decision)
    assert said[0].sentence.startswith("The same shaking at twice its amplitude")
    # So weakly shown, its storey is a guess.
    assert "hysteresis" in said[0].sentence
    assert "nothing missing" in said[0].sentence
    best = weak.judged[0]
    gains = {gain.what: gain.ln_bayes for gain in expected(weak, best.fit, weak.null.fit)}
    assert (
        gains["the same shaking at twice its amplitude"]
        > 100
        > gains["the same shaking at half its amplitude"]
    )
    strong = searched(louder(2.0, 0.05))
    assert decide(strong).verdict != "nothing_missing"
    assert strong.judged[0].effects[0].name == "hysteresis"
    # The order of magnitude holds; the null model bends more than a linear imitation can.
    assert strong.judged[0].ln_bayes > 100


def test_what_is_tried_is_a_measurement_that_was_not_made_and_a_clear_verdict_asks_for_none() -> None:
    found = stiffening()
    decision = decide(found)
    assert decision.verdict == "effect_named"
    assert rivals(found, decision) is None
    assert advice(found, decision) == []
    tried = list(measurements(found, as_it_was(found)))
    further = [one for one in tried if not one.more]
    # Of three floors all accelerations and the first and third displacement are there.
    assert [one.what for one in further] == ["a displacement sensor at floor 2 of bench"]
    assert further[0].noise[-1] > 0
    assert len([one for one in tried if one.more]) == 4


def test_a_rival_that_is_the_truth_itself_gains_nothing() -> None:
    found = stiffening()
    best = found.judged[0].fit
    assert all(abs(gain.ln_bayes) < 1e-6 for gain in expected(found, best, best))


def test_a_dead_channel_is_no_measurement_and_those_after_it_keep_their_place() -> None:
    """Effects know channels by their number: a delay of the last one is a rival although the first was left out."""
    whole = measured([], samples=1000)
    runs = tuple(
        replace(run, measured=run.measured * np.where(np.arange(5) == 0, np.nan, 1.0))
        for run in whole.observed.runs
    )
    model = whole.seeing(replace(whole.observed, runs=runs))
    of_sensors = [one for one in candidates(model) if (one.name, one.where) == ("sensor_delay", "channel")]
    assert [one.index for one in of_sensors] == [1, 2, 3, 4]
    late = of_sensors[-1:]
    found = search(model, late, [0], [1], lambda what, share: None)
    truth, null = (
        refine(model, found.null.fit.filtered, late, [np.array([0.01])], iterations=0),
        found.null.fit,
    )
    gains = {gain.what: gain.ln_bayes for gain in expected(found, truth, null)}
    assert "an accelerometer on floor 1 of bench" in gains
    assert gains["the same shaking at twice its amplitude"] > 1.0
    assert all(np.isfinite(gain) for gain in gains.values())
