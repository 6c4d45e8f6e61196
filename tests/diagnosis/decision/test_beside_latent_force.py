"""A second effect beside a law that is not the right one: friction that was fitted with a damper."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.decision.beside_latent_force import beside_latent_force, with_sizes
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.findings import Findings, Judged, judge
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.refining import refined
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured

FRICTION = ("coulomb_friction", 2, (3.0, 15.0, 0.0, 0.3))
HEAVIER = ("added_mass", 3, (1.1,))
LATE, SOFTER = ("sensor_delay", "a1"), ("stiffness_change", 1)


def _effect(model: Model, name: str, place: object) -> Effect:
    return next(
        one for one in candidates(model) if one.name == name and place in (one.storey, one.floor, one.channel)
    )


def _found(first: tuple[str, object], *truths: tuple[str, object, tuple[float, ...]]) -> Findings:
    """Return the findings of one effect in data that others made."""
    blank = measured(samples=50, runs=1)
    acting = [(_effect(blank, name, place), np.array(values)) for name, place, values in truths]
    model = measured(acting, noise=0.01, samples=1000)
    null = refine(model, calibrated(model, (0, 1)))
    sizes, nothing = scales(model, null.filtered), SimpleNamespace(ranked=[])
    scores: Any = nothing
    found = Findings(model, judge(model, null, null, (0, 1), ()), scores, sizes, (0, 1), ())
    found.judged = [_beside(found, *first)]
    return found


def _beside(found: Findings, name: str, place: object) -> Judged:
    """Return an effect refined beside what is judged, which may be nothing."""
    about = (found.judged or [found.null])[0].fit
    effect = _effect(found.model, name, place)
    (scored,) = score(found.model, about.filtered, [effect], found.sizes, about.columns).ranked
    fit = refined(found, about.filtered, scored, about if found.judged else None)
    return judge(found.model, fit, found.null.fit, (0, 1), ())


@pytest.mark.parametrize(
    ("truths", "second", "there"),
    [((FRICTION,), LATE, False), ((FRICTION, HEAVIER), HEAVIER[:2], True)],
)
def test_what_a_wrong_law_leaves_is_no_second_effect_and_what_else_is_missing_is_one(
    truths: tuple[tuple[str, object, tuple[float, ...]], ...], second: tuple[str, object], there: bool
) -> None:
    """By their evidence beside the law as it is the two could not be told apart."""
    found = _found(("damping_change", 2), *truths)
    (single,), double = found.judged, _beside(found, *second)
    gained = double.ln_bayes - single.ln_bayes
    assert 100.0 < gained < 400.0
    freed = beside_latent_force(found, single, double)
    assert (freed.gained > 0.5 * gained) if there else (freed.gained < 0.05 * gained)
    # It is worked out once.
    assert beside_latent_force(found, single, double) is freed
    sized = with_sizes(found, single, double)
    assert sized.effects == double.effects
    assert sized.ln_bayes == double.ln_bayes
    if there:
        (size,), std = sized.fit.values[1], float(sized.fit.std[1][0])
        assert size == pytest.approx(HEAVIER[2][0], abs=3.0 * std)
        assert std < 0.2


def test_what_is_no_force_of_storeys_may_get_a_tenth_of_its_evidence_wrong() -> None:
    found = _found(HEAVIER[:2], FRICTION, HEAVIER)
    (single,), double = found.judged, _beside(found, *SOFTER)
    gained = double.ln_bayes - single.ln_bayes
    assert beside_latent_force(found, single, double).gained == pytest.approx(gained - 0.1 * single.ln_bayes)
    assert with_sizes(found, single, double) is double
