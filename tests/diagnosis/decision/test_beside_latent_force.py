"""A second effect beside a law that is not the right one: friction that was fitted with a damper."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.decision.beside_latent_force import beside_latent_force, with_sizes
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.storey import POWER_RANGE
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.findings import Findings, Judged, judge
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.refining import refined, usual_widths
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


@pytest.mark.parametrize(("second", "there"), [(("added_mass", 2), False), (HEAVIER[:2], True)])
def test_what_a_wrong_law_leaves_is_no_second_effect_and_what_else_is_missing_is_one(
    second: tuple[str, object], there: bool
) -> None:
    """By their evidence beside the law as it is the two could hardly be told apart."""
    found = _found(("damping_change", 2), FRICTION, HEAVIER)
    (single,), double = found.judged, _beside(found, *second)
    gained = double.ln_bayes - single.ln_bayes
    assert 300.0 < gained < 450.0
    freed = beside_latent_force(found, single, double)
    assert (freed.gained > 0.8 * gained) if there else (freed.gained < 0.25 * gained)
    # It is worked out once.
    assert beside_latent_force(found, single, double) is freed
    sized = with_sizes(found, single, double)
    assert sized.effects == double.effects
    assert sized.ln_bayes == double.ln_bayes
    if there:
        (size,), std = sized.fit.values[1], float(sized.fit.std[1][0])
        assert size == pytest.approx(HEAVIER[2][0], abs=3.0 * std)
        assert std < 0.2


@pytest.mark.parametrize("start", [(20.0, 0.0), (60.0, -0.5), (120.0, -0.79)])
def test_a_power_at_the_end_of_its_range_stays_there_and_the_rest_makes_the_best_of_it(
    start: tuple[float, float],
) -> None:
    """Friction as a damper sees it: as low a power as it may have, and one size from whatever start."""
    found = _found(("damping_change", 2), FRICTION)
    known = found.judged[0].fit
    wide = usual_widths(found, known.effects)
    fit = refine(found.model, found.null.fit.filtered, known.effects, (np.array(start),), wide)
    (size, power), std = fit.values[0], fit.std[0]
    assert power == pytest.approx(POWER_RANGE[0], abs=1e-6)
    assert abs(size - known.values[0][0]) < 0.1 * std[0]
    assert abs(fit.log_posterior - known.log_posterior) < 3.0


def test_a_law_with_a_power_of_its_own_leaves_a_sensor_nothing() -> None:
    found = _found(("damping_change", 2), FRICTION)
    (single,), double = found.judged, _beside(found, *LATE)
    assert double.ln_bayes - single.ln_bayes < 20.0


def test_what_is_no_force_of_storeys_may_get_a_tenth_of_its_evidence_wrong() -> None:
    found = _found(HEAVIER[:2], FRICTION, HEAVIER)
    (single,), double = found.judged, _beside(found, *SOFTER)
    gained = double.ln_bayes - single.ln_bayes
    assert beside_latent_force(found, single, double).gained == pytest.approx(gained - 0.1 * single.ln_bayes)
    assert with_sizes(found, single, double) is double
