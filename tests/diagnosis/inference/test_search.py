"""The search for effects by what it must do: the effect that made the data leads, and nothing leads where nothing did."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.effects.storey import CoulombFriction
from pounding.diagnosis.inference import other_starts as other_starts_module
from pounding.diagnosis.inference import search as search_module
from pounding.diagnosis.inference.evidence import Score, Scores, scales, score
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.findings import Findings, best, judge, leaders
from pounding.diagnosis.inference.other_starts import from_baseline, other_starts, softer
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.refining import keep, refined
from pounding.diagnosis.inference.search import search, silent, to_the_end
from pounding.diagnosis.inference.starting import calibrated, uncalibrated
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.inference.problems import NOTHING, PROBLEMS, Problem, catalogue
from tests.diagnosis.models import measured


def test_of_rivals_outside_the_catalogue_only_a_few_are_refined() -> None:
    """They act alike on neighbouring floors; the effects of the catalogue behind them keep their places."""
    limit = SETTINGS.search.rivals

    def scored(number: int, rival: bool) -> Score:
        effect = cast(Any, SimpleNamespace(rival=rival))
        return Score(effect, (), 1.0, 1.0, 1000.0 - number, number, np.zeros(0))

    ranked = [scored(number, number <= limit) for number in range(limit + 3)]
    chosen = search_module._chosen(Scores(ranked, np.eye(len(ranked))))
    assert [one.column for one in chosen] == [*range(limit), limit + 1, limit + 2]


def test_a_soft_base_is_found_from_a_stiff_one() -> None:
    base = next(one for one in candidates(measured()) if one.name == "base_rocking")
    truth = np.array([8000.0])
    model = measured([(base, truth)])
    null = refine(model, calibrated(model, [0]), (), (), ())
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, [base], sizes)
    found = Findings(model, judge(model, null, null, (0,), (1,)), scores, sizes, (0,), (1,))
    stiff = 6.0 * truth
    stuck = refine(model, null.filtered, (base,), (stiff,), (stiff,), iterations=0, thorough=False)
    fit = softer(found, stuck)
    assert fit.log_posterior > stuck.log_posterior + 1000.0
    assert fit.values[0] == pytest.approx(truth, rel=0.02)


@pytest.mark.parametrize(("truth", "share"), [(0.4, 0.5), (0.8, 0.1), (1.5, 0.2)])
def test_parameters_at_the_end_of_their_box_do_not_hide_an_effect(truth: float, share: float) -> None:
    """The calibration takes a part of a mass and cannot take more; the score let it, and saw a fortieth of the evidence."""
    masses = [one for one in candidates(measured()) if one.name == "added_mass"]
    model = measured([(masses[1], np.array([truth]))], noise=0.005, runs=1)
    null = refine(model, calibrated(model, [0]))
    first = score(model, null.filtered, masses, scales(model, null.filtered)).ranked[0]
    assert first.effect is masses[1]
    assert first.amplitude == pytest.approx(truth, rel=0.25)
    evidence = (
        refine(model, null.filtered, (masses[1],), (np.array([truth]),)).log_posterior - null.log_posterior
    )
    assert first.ln_bayes > share * evidence > 0.0


def test_what_leads_out_of_a_corner_of_the_null_model_is_refined_from_the_baseline_too() -> None:
    mass = next(one for one in candidates(measured()) if one.name == "added_mass" and one.floor == 3)
    truth = np.array([0.5])
    model = measured([(mass, truth)])
    start = calibrated(model, [0])
    corner = run_filter(model, 3.0 * model.std, start.noise, [0])
    null = refine(model, corner, iterations=0, thorough=False)
    stuck = refine(model, corner, (mass,), (truth / 2,), iterations=0, thorough=False)
    judged = judge(model, null, null, (0,), (1,))
    empty = score(model, null.filtered, [mass], scales(model, null.filtered))
    found = Findings(model, judged, empty, scales(model, null.filtered), (0,), (1,))
    found.judged = [replace(judge(model, stuck, null, (0,), (1,)), ln_bayes=1.0)]
    fit = from_baseline(found, stuck.effects, stuck.values)
    assert fit.log_posterior > stuck.log_posterior + 100.0
    assert fit.values[0] == pytest.approx(truth, abs=3.0 * fit.std[0][0])


def test_what_scores_better_than_all_that_was_fitted_is_refined_from_the_baseline_as_scored() -> None:
    masses = [one for one in candidates(measured()) if one.name == "added_mass"]
    truth = np.array([0.5])
    model = measured([(masses[2], truth)])
    null = refine(model, calibrated(model, [0]))
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, masses, sizes)
    assert scores.ranked[0].effect is masses[2]
    found = Findings(model, judge(model, null, null, (0,), (1,)), scores, sizes, (0,), (1,))
    other = refine(model, null.filtered, (masses[0],), (truth / 10,), iterations=0, thorough=False)
    found.judged = [replace(judge(model, other, null, (0,), (1,)), ln_bayes=1.0)]
    starts = [start() for start in other_starts(found)]
    led = max((fit for fit in starts if fit is not None), key=lambda fit: fit.log_posterior)
    assert led.effects == (masses[2],)
    assert led.values[0] == pytest.approx(truth, abs=3.0 * led.std[0][0])
    # Where a fit has kept more than any score promises only what leads, and what is alike, is refined again.
    found.judged = [replace(found.judged[0], ln_bayes=scores.ranked[0].ln_bayes + 1.0)]
    assert len(other_starts(found)) == 1


def test_what_leads_of_the_catalogue_is_refined_from_the_baseline_though_a_rival_leads() -> None:
    """A rival may lead because the effect that is missing is in a local optimum, and is needed no longer once it is not."""
    mass = next(one for one in candidates(measured()) if one.name == "added_mass" and one.floor == 3)
    rival = next(one for one in candidates(measured()) if one.name == "appendage")
    model = measured([(mass, np.array([0.5]))], runs=1)
    null = refine(model, calibrated(model, [0]))
    fits = {
        effect: refine(model, null.filtered, (effect,), (np.array(values),), iterations=0, thorough=False)
        for effect, values in ((rival, (0.1, 6.5, 0.01)), (mass, (0.05,)))
    }
    sizes = scales(model, null.filtered)
    found = Findings(
        model, judge(model, null, null, (0,), ()), score(model, null.filtered, [], sizes), sizes, (0,), ()
    )
    judged = {effect: judge(model, fit, null, (0,), ()) for effect, fit in fits.items()}
    found.judged = [replace(judged[rival], ln_bayes=500.0), replace(judged[mass], ln_bayes=100.0)]
    assert [one.effects for one in leaders(found)] == [(rival,), (mass,)]
    begun = {fits[rival].key}
    fit = next(start() for start in other_starts(found, begun))
    assert fit is not None
    assert fit.effects == (mass,)
    assert fit.log_posterior > fits[mass].log_posterior + 30.0
    assert not other_starts(found, begun | {fits[mass].key})


def test_what_is_tuned_to_a_mode_is_refined_from_its_score_though_another_shape_predicts_better() -> None:
    """What the score says of its size is twenty times too much: a mass that hardly shows at 1 Hz predicts better."""
    swaying = [one for one in candidates(measured()) if one.name == "appendage"]
    truth = np.array([0.1, 6.459, 0.01])
    model = measured([(swaying[1], truth)], noise=0.005, runs=1)
    null = refine(model, calibrated(model, [0]))
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, swaying, sizes)
    found = Findings(model, judge(model, null, null, (0,), ()), scores, sizes, (0,), ())
    scored = next(one for one in scores.ranked if one.effect is swaying[1])
    much = replace(scored, amplitude=20.0 * scored.amplitude, nuisance=np.zeros_like(scored.nuisance))
    fit = refined(found, null.filtered, much)
    assert fit.values[0] == pytest.approx(truth, rel=0.03)
    assert fit.log_posterior > null.log_posterior + 1000.0


QUICK = (7.49, 24.8, 0.8, 1.38)
"""Frequencies [Hz] and ratios that are tried before every change; `make guard` tries the others."""
TUNED = [
    *(("appendage", (0.02, frequency, 0.005)) for frequency in (6.12, 7.49, 10.2, 17.7, 24.8)),
    *(("torsional_eccentricity", (0.01, ratio, 1.0)) for ratio in (0.8, 1.15, 1.38)),
]


@pytest.mark.parametrize(
    ("name", "truth"),
    [
        pytest.param(name, truth, marks=[] if truth[1] in QUICK else [pytest.mark.slow, pytest.mark.guard])
        for name, truth in TUNED
    ],
)
def test_what_is_tuned_is_found_between_the_frequencies_that_are_tried(
    name: str, truth: tuple[float, ...]
) -> None:
    """The bench has 6.81, 19.1 and 27.6 Hz. What weighs 20 g, or lies 10 mm off, shows in a narrow band only."""
    effects = [one for one in candidates(measured()) if one.name == name]
    hidden = effects[min(1, len(effects) - 1)]
    model = measured([(hidden, np.array(truth))], noise=0.005, runs=1)
    null = refine(model, calibrated(model, [0]))
    sizes = scales(model, null.filtered)
    scores = score(model, null.filtered, effects, sizes)
    assert scores.ranked[0].effect is hidden
    found = Findings(model, judge(model, null, null, (0,), ()), scores, sizes, (0,), ())
    fit = refined(found, null.filtered, scores.ranked[0])
    true = refine(model, null.filtered, (hidden,), (np.array(truth),))
    gained, whole = (one.log_posterior - null.log_posterior for one in (fit, true))
    assert gained > max(300.0, 0.99 * whole)


def test_a_law_that_leads_in_one_storey_is_refined_in_all_storeys_too() -> None:
    """However little it looks like, to first order, beside a null model that has taken a part of it."""
    friction = [one for one in candidates(measured()) if one.name.endswith("coulomb_friction")]
    whole = next(one for one in friction if one.name == "all_coulomb_friction")
    alone = next(one for one in friction if one.storey == 1)
    model = measured([(whole, np.array([1.5e-5, 10.0, 0.0, 0.3, 0.0]))], runs=2)
    null = refine(model, calibrated(model, [0]))
    sizes = scales(model, null.filtered)
    led = refine(model, null.filtered, (alone,), (np.array([0.5, 10.0, 0.0, 0.3]),))
    base = judge(model, null, null, (0,), (1,))
    found = Findings(model, base, score(model, null.filtered, friction, sizes), sizes, (0,), (1,))
    keep(found, led)
    for fit in [start() for start in other_starts(found)]:
        if fit is not None:
            keep(found, fit)
    assert best(found).effects == (whole,)
    assert best(found).fit.log_posterior > led.log_posterior + 30.0
    assert not [one for one in other_starts(found) if getattr(one, "func", None) is refined]


def led_on(model: Model, led: Effect, start: tuple[float, ...]) -> tuple[Findings, Fit]:
    """Return the findings after the other starts of an effect that leads, and its fit before."""
    null = refine(model, calibrated(model, [0]))
    sizes = scales(model, null.filtered)
    fit = refine(model, null.filtered, (led,), (np.array(start),))
    scores = score(model, null.filtered, [], sizes)
    found = Findings(model, judge(model, null, null, (0,), (1,)), scores, sizes, (0,), (1,))
    keep(found, fit)
    for other in [start() for start in other_starts(found)]:
        if other is not None:
            keep(found, other)
    return found, fit


def usual_rate(index: int) -> float:
    return float(scales(measured(), calibrated(measured(), [0])).drift_rate[index])


@pytest.mark.parametrize(
    ("name", "start"), [("damping_change", (20.0, -0.5)), ("coulomb_friction", (2.0, 15.0, 0.0, 0.3))]
)
def test_friction_that_creeps_is_found_from_where_a_damper_or_sticking_friction_led(
    name: str, start: tuple[float, ...]
) -> None:
    """A damper takes hardly any power of its rate, and a joint that sticks is too stiff at each turn."""
    seen = {one.name: one for one in candidates(measured()) if one.storey == 2}
    friction = seen["coulomb_friction"]
    assert isinstance(friction, CoulombFriction)
    truth = friction.creeping(measured(), 2.0, 0.03 * usual_rate(friction.index))
    found, led = led_on(measured([(friction, truth)], noise=0.005), seen[name], start)
    assert best(found).effects == (friction,)
    assert best(found).fit.log_posterior > led.log_posterior + 100.0
    assert best(found).fit.values[0][0] == pytest.approx(2.0, rel=0.05)


def test_friction_of_all_storeys_that_creeps_is_found_from_where_it_sticks() -> None:
    seen = {one.name: one for one in candidates(measured())}
    whole, drift = seen["all_coulomb_friction"], 4e-5
    joint = CoulombFriction(index=0, frame="bench")
    force = drift * joint.stiffness(measured())
    truth = np.append(joint.creeping(measured(), force, 0.03 * usual_rate(0)) / (force / drift, 1, 1, 1), 0.0)
    found, led = led_on(measured([(whole, truth)], noise=0.005), whole, (drift, 15.0, 0.0, 0.3, 0.0))
    assert best(found).effects == (whole,)
    assert best(found).fit.log_posterior > led.log_posterior + 100.0
    assert best(found).fit.values[0][0] == pytest.approx(drift, rel=0.05)


@pytest.mark.parametrize(
    ("force", "stiffness", "rate", "slides"),
    [(1.0, 0.01, 0.03, True), (1.0, 0.01, 3.0, False), (1.0, 15.0, 3.0, True), (1e4, 15.0, 3.0, False)],
)
def test_friction_slides_from_a_part_of_the_usual_drift_or_rate_on(
    force: float, stiffness: float, rate: float, slides: bool
) -> None:
    """Below its force a joint is the damper or the spring that it holds by; `rate` is that from which it would creep on."""
    model = measured()
    joint = CoulombFriction(index=1, frame="bench", storey=2)
    null = refine(model, calibrated(model, [0]), iterations=0, thorough=False)
    sizes = scales(model, null.filtered)
    found = Findings(
        model, judge(model, null, null, (0,), ()), score(model, null.filtered, [], sizes), sizes, (0,), ()
    )
    crept = joint.creeping(model, force, rate * float(sizes.drift_rate[1]))
    # A stiffer joint is damped more, and creeps as before.
    values = np.array([force, stiffness, 0.0, crept[3] * crept[1] / stiffness])
    assert other_starts_module._slides(found, joint, values) is slides


SEARCHED = [problem for problem in PROBLEMS if problem.name != "hysteresis"]
"""Three parameters of hysteresis take five seconds; it is among the candidates, and test_refine.py has its truth."""


def searched(problem: Problem, backwards: bool = False) -> Findings:
    """Return the findings among the effects of all problems at every place of the bench."""
    order = -1 if backwards else 1
    return search(problem.model(), catalogue()[::order], (0,), (1,), lambda what, share: None)


def evidence(found: Findings) -> list[float]:
    """Return the ln Bayes factor of each effect that was refined, best first."""
    return [one.fit.log_posterior - found.null.fit.log_posterior for one in found.judged]


@pytest.mark.parametrize("problem", SEARCHED, ids=str)
def test_the_effect_that_made_the_data_leads_at_its_place(problem: Problem) -> None:
    found = searched(problem)
    assert found.judged[0].effects == (problem.effect,)
    best, *others = evidence(found)
    assert best > 30.0
    assert all(best > other + 10.0 for other in others)
    (values,) = found.judged[0].fit.values
    assert values[: problem.reported] == pytest.approx(problem.truth[: problem.reported], rel=0.1)


def test_nothing_leads_where_nothing_was_hidden() -> None:
    assert all(one < 3.0 for one in evidence(searched(NOTHING)))


@pytest.mark.parametrize("enough", [True, False])
def test_no_second_effect_is_looked_for_where_single_ones_are_enough(
    enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: Any = SimpleNamespace(judged=[SimpleNamespace(fit=None, ln_bayes=1.0)], floor=None)
    model: Any = SimpleNamespace(since=tuple)
    asked: list[Any] = []
    looked: list[Any] = []
    stubs: dict[str, Any] = {
        "best_null": lambda *_: None,
        "unswapped": lambda *_: (model, None),
        "_refined_best": lambda *_: (found, None),
        "noise_floor": lambda *_: 0.01,
        "moved_by_themselves": lambda _: None,
        "second": lambda of, _: looked.append(of),
    }
    for name, stub in stubs.items():
        monkeypatch.setattr(search_module, name, stub)

    def said(of: Any) -> bool:
        asked.append(of.floor)
        return enough

    search(model, [], (0,), (1,), silent, start=cast(Any, object()), enough=said)
    # An error of the frame is told by what exceeds the noise floor.
    assert asked == [0.01]
    assert looked == ([] if enough else [found])


def test_the_order_of_the_candidates_does_not_matter() -> None:
    problem = next(one for one in PROBLEMS if one.name == "cubic_stiffness")
    one, other = searched(problem), searched(problem, backwards=True)
    assert one.judged[0].effects == other.judged[0].effects
    assert evidence(one) == pytest.approx(evidence(other), abs=0.1)


@pytest.mark.parametrize(
    ("channels", "likely", "refined_further"),
    [
        pytest.param((None, None, None, None), (4.0, 3.0, 2.0, 1.0), [0, 1, 2], id="the three likeliest"),
        pytest.param((None, None, None, None), (1.0, 4.0, 3.0, 2.0), [1, 2, 0], id="and what scores best"),
        pytest.param(
            ("a", "b", "c", None, None), (4.0, 3.0, 2.0, 0.5, 1.0), [0, 1, 2, 4], id="and one of the frame"
        ),
        pytest.param(("a", "b"), (1.0, 2.0), [1, 0], id="nothing of the frame was tried"),
        pytest.param((), (), [], id="nothing was tried"),
    ],
)
def test_what_is_refined_to_the_end(
    channels: tuple[str | None, ...], likely: tuple[float, ...], refined_further: list[int]
) -> None:
    chosen: Any = [SimpleNamespace(effect=SimpleNamespace(channel=channel)) for channel in channels]
    assert to_the_end(chosen, likely) == refined_further


def test_what_starts_from_the_baseline_frame_is_given_up_where_it_will_not_come_near_what_is_ahead() -> None:
    mass = next(one for one in candidates(measured()) if one.name == "added_mass" and one.floor == 3)
    model = measured()
    # With its noise it would be at its end after a round.
    null = replace(refine(model, calibrated(model, [0])), filtered=uncalibrated(model, [0]))
    sizes = scales(model, null.filtered)
    empty = score(model, null.filtered, [mass], sizes)
    found = Findings(model, judge(model, null, null, (0,), (1,)), empty, sizes, (0,), (1,))
    ahead = replace(null, filtered=replace(null.filtered, log_likelihood=null.filtered.log_likelihood + 1e4))
    assert from_baseline(found, (mass,), (np.array([0.1]),)).to_the_end
    found.judged = [replace(found.null, fit=ahead)]
    assert not from_baseline(found, (mass,), (np.array([0.1]),)).to_the_end
