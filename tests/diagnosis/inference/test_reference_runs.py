"""Runs of the frame as it was before: effects act in the runs since, and what changed by little is told from calibration."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.design.frame_advice import as_it_was, expected
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.inference.histories import Histories
from pounding.diagnosis.inference.search import search
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.twin import simulate_engine
from tests.diagnosis.models import measured

LOSS = -0.08
STOREY = 2
SOFTER = {("storey_stiffness", 1): 0.03, ("frame_stiffness", 0): 0.08, ("storey_stiffness", 0): -0.03}
"""The frame as it was built, in units of its parameters: a prior standard deviation off in each."""
NAMES = ("stiffness_change", "damping_change", "added_mass", "sensor_gain")


def effects(*names: str) -> list[Effect]:
    return [one for one in candidates(measured(samples=50, runs=1)) if one.name in (names or NAMES)]


def loss() -> Effect:
    return next(one for one in effects("stiffness_change") if one.storey == STOREY)


def model(size: float = LOSS, *, reference: int = 1) -> Model:
    """Return a frame with one run from before, if any, and two since, in which a storey has lost stiffness."""
    plain = measured(samples=50, runs=1)
    built = np.zeros(len(plain.std))
    for place, value in SOFTER.items():
        built[[(one.kind, one.place) for one in plain.parameters].index(place)] = value
    changed = [(loss(), np.array([size * (1.0 + 0.08 + 0.03)]))] if size else []
    return measured(changed, runs=2 + reference, values=built, reference=reference)


@cache
def found(size: float = LOSS, reference: int = 1) -> Findings:
    runs = range(1 + reference)
    return search(
        model(size, reference=reference), effects(), runs, [1 + reference], lambda what, share: None
    )


def test_effects_act_in_the_runs_since() -> None:
    here = model()
    nothing = np.zeros(len(here.std))
    acting = [(loss(), np.array([LOSS]))]
    plain, changed = (here.predict(nothing, None, some).outputs for some in ((), acting))
    assert np.array_equal(plain[0], changed[0])
    assert not np.allclose(plain[1], changed[1], rtol=0.01)
    twins = [simulate_engine(here, nothing, some, [0, 1]) for some in ((), acting)]
    assert np.array_equal(twins[0][0], twins[1][0])
    assert not np.allclose(twins[0][1], twins[1][1], rtol=0.01)


@pytest.mark.parametrize("name", ["stiffness_change", "sensor_gain", "damping_change", "added_mass"])
def test_an_effect_has_no_signature_in_a_reference_run(name: str) -> None:
    here = model()
    effect = effects(name)[0]
    values = effect.values(0.05, ())
    filtered = run_filter(
        here, np.zeros(len(here.std)), starting_noise(here, [0, 1]), [0, 1], [(effect, values)]
    )
    coordinates = Coordinates.of(here, [effect], [values], [values])
    columns = Histories(here, filtered, coordinates).effect_columns(
        coordinates.theta(np.zeros(len(here.std)))
    )
    assert not columns[0].any()
    assert columns[1].any()
    nuisance = Histories(here, filtered, coordinates).nuisance_columns()
    assert all(one.any(axis=0).sum() > len(here.std) - 2 for one in nuisance)


def test_a_score_is_that_of_the_runs_since() -> None:
    here = model()
    both = run_filter(here, np.zeros(len(here.std)), starting_noise(here, [0, 1]), [0, 1])
    since = both.since(here)
    assert since.runs == (1,)
    known = [score(here, one, [loss()], scales(here, one)).projected[0, 0] for one in (both, since)]
    # The run from before adds nothing of the effect itself, but what it says of the frame leaves more of it to be seen.
    assert known[0] > 1.5 * known[1]


def test_a_small_loss_is_named_with_its_size() -> None:
    here = found()
    decision = decide(here)
    assert decision.verdict == "effect_named"
    assert decision.judged.effects == (loss(),)
    ((values, std),) = decision.judged.fit.stated(here.model, here.sizes)
    assert values[0] == pytest.approx(LOSS, abs=2 * float(std[0]))
    assert std[0] < 0.01
    assert (here.reference, here.training, here.held_out) == ((0,), (1,), (2,))


def test_without_reference_runs_calibration_takes_it() -> None:
    assert decide(found(reference=0)).verdict == "nothing_missing"


def test_nothing_changed() -> None:
    assert decide(found(0.0)).verdict == "nothing_missing"


def test_an_effect_is_seen_better_beside_a_reference_run() -> None:
    sight = Sight.of(found(), found().null.fit.filtered)
    alone = replace(sight, before=np.zeros_like(sight.before))
    assert sight.run == 1
    both, one = (each.of_effect(loss(), np.array([LOSS])) for each in (sight, alone))
    assert both > 1.5 * one


def test_further_measurements_begin_from_a_run_since() -> None:
    now, before = as_it_was(found()), as_it_was(found(), 0)
    assert [each.model.observed.runs[0].reference for each in (now, before)] == [False, True]
    two = found().judged[:2]
    gains = expected(found(), *(one.fit for one in two))
    assert all(np.isfinite(gain.ln_bayes) for gain in gains)
