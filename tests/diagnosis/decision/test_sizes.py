"""Sizes that are stated: the likeliest, or those of the nearest frame where errors of the model bias the likeliest."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from msgspec import structs

from pounding.diagnosis.decision import sizes
from pounding.diagnosis.decision.measures import less_certain
from pounding.diagnosis.decision.nearest_frame import evidence_beside_errors, nearest_fit
from pounding.diagnosis.decision.sizes import likeliest_sizes, stated_sizes, with_unbiased_sizes
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.inference.discrepancy import SCALES
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.search import search
from tests.diagnosis.models import measured
from tests.diagnosis.report.bench import diagnosed

MASS = 0.4


@cache
def heavier() -> tuple[Findings, Judged]:
    """Return findings on a frame with a mass on its second floor, and the mass, with a discrepancy beside it."""
    blank = measured(samples=50, runs=1)
    mass = next(one for one in candidates(blank) if one.name == "added_mass" and one.floor == 2)
    model = measured([(mass, np.array([MASS]))], noise=0.01, samples=1500)
    found = search(model, [mass], (0,), (1,), lambda *_: None)
    judged = found.judged[0]
    filtered = judged.fit.filtered.with_discrepancy(float(SCALES[4]))
    return found, replace(judged, fit=replace(judged.fit, filtered=filtered))


def nearest(monkeypatch: pytest.MonkeyPatch, off: float, wider: float) -> None:
    """Let the nearest frame have the mass so many of the likeliest one's standard errors off, its own so many of them."""
    _, judged = heavier()
    values, std = judged.fit.values[0], judged.fit.std[0]
    filtered = judged.fit.filtered
    other = run_filter(
        heavier()[0].model,
        filtered.values,
        filtered.noise,
        filtered.runs,
        [(judged.effects[0], values + off * std)],
    )
    fit = replace(judged.fit, values=(values + off * std,), std=(wider * std,), filtered=other)
    monkeypatch.setattr(sizes, "nearest_fit", lambda found, judged: fit)


@pytest.mark.parametrize(
    ("off", "wider", "biased"),
    [
        (0.0, 1.1, False),
        (2.0, 3.0, False),
        (-2.0, 3.0, False),
        (5.0, 3.0, True),
        (-5.0, 3.0, True),
        (0.2, 0.9, False),
        (2.0, 0.9, True),
    ],
)
def test_the_sizes_with_the_smaller_mean_square_error_are_stated(
    off: float, wider: float, biased: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of the likeliest it is the variance and the square of what both differ by beyond chance."""
    found, judged = heavier()
    assert less_certain(found, judged) == pytest.approx(1.0, abs=0.01)
    nearest(monkeypatch, off, wider)
    sized = with_unbiased_sizes(found, judged)
    assert (sized.sized is not None) == biased
    ((values, std),) = stated_sizes(found, sized)
    (likeliest,), (error,) = judged.fit.values[0], judged.fit.std[0]
    assert values == pytest.approx([likeliest + (off * error if biased else 0.0)])
    law = judged.effects[0].law_error(found.model, values, found.sizes) * abs(values[0])
    assert std == pytest.approx([np.hypot((wider if biased else 1.0) * error, law)], rel=0.01)


def test_the_model_has_the_sizes_that_are_stated_and_moves_as_measured(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, judged = heavier()
    nearest(monkeypatch, 6.0, 2.0)
    sized = with_unbiased_sizes(found, judged)
    assert sized.sized is not None
    ((effect, values),) = sized.fit.filtered.effects
    assert effect == judged.effects[0]
    assert values == pytest.approx(sized.sized.values[0])
    assert sized.misfit == pytest.approx(judged.misfit, rel=0.05)
    # Its frame has moved to make up for it: the evidence is what it was.
    assert np.abs(sized.fit.filtered.values - judged.fit.filtered.values).max() > 1e-3
    assert sized.ln_bayes == judged.ln_bayes


@pytest.mark.parametrize("known", ["no discrepancy", "reference runs"])
def test_where_nothing_bends_the_frame_the_likeliest_sizes_are_stated(
    known: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    found, judged = heavier()
    nearest(monkeypatch, 6.0, 2.0)
    if known == "no discrepancy":
        filtered = judged.fit.filtered.with_discrepancy(float(SCALES[0]))
        judged = replace(judged, fit=replace(judged.fit, filtered=filtered))
    else:
        found = replace(found, reference=(0,))
    assert with_unbiased_sizes(found, judged) is judged


def test_the_nearest_frame_knows_the_size_less_well_and_contains_the_truth() -> None:
    found, judged = heavier()
    fit = nearest_fit(found, judged)
    assert fit.std[0][0] > judged.fit.std[0][0]
    assert fit.values[0][0] == pytest.approx(MASS, abs=2 * fit.std[0][0])
    assert nearest_fit(found, judged) is fit


def test_what_is_named_is_sized(monkeypatch: pytest.MonkeyPatch) -> None:
    found, judged = heavier()
    nearest(monkeypatch, 6.0, 2.0)
    found = replace(found, judged=[judged])
    decision = decide(found)
    assert decision.verdict == "effect_named"
    assert decision.judged.sized is not None
    ((values, _),) = stated_sizes(found, decision.judged)
    assert values == pytest.approx(judged.fit.values[0] + 6.0 * judged.fit.std[0])
    likeliest = likeliest_sizes(found, decision.judged)
    assert likeliest is judged
    assert likeliest_sizes(found, judged) is None


def test_the_report_says_what_the_likeliest_size_is(monkeypatch: pytest.MonkeyPatch) -> None:
    found, judged = heavier()
    nearest(monkeypatch, 6.0, 2.0)
    conclusion = diagnosed(replace(found, judged=[judged])).conclusion
    ((mass,), (candidate,)) = (one[0].parameters for one in (conclusion.effects, conclusion.candidates))
    assert mass == candidate
    assert mass.value == pytest.approx(judged.fit.values[0][0] + 6.0 * judged.fit.std[0][0])
    said = f"errors of the model bias the likeliest size (mass {judged.fit.values[0][0]:.3g} ± "
    assert [one.startswith(said) for one in conclusion.warnings] == [True]
    # What is as good as the same needs no sentence.
    nearest(monkeypatch, 0.9, 0.95)
    assert diagnosed(replace(found, judged=[judged])).conclusion.warnings == ()


def test_effects_that_do_not_show_beside_the_errors_keep_their_likeliest_sizes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found, judged = heavier()
    assert evidence_beside_errors(found, judged) > 0.0
    allow = structs.replace(found.model.prior, model_error=100.0)
    monkeypatch.setattr(found.model, "prior", allow)
    hidden = replace(found, nearest={})
    assert evidence_beside_errors(hidden, judged) < 0.0
    nearest(monkeypatch, 6.0, 2.0)
    assert with_unbiased_sizes(hidden, judged) is judged
