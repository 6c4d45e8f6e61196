"""An effect behind a larger error of the frame: a part that sways on the roof, and friction in a storey below."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.decision import beyond_errors as module
from pounding.diagnosis.decision.beyond_errors import beyond_errors, first_decides
from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.decision.measures import model_error
from pounding.diagnosis.decision.rig_calibration import scattered
from pounding.diagnosis.decision.verdict import decide, error_of_frame
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference import null_with_error
from pounding.diagnosis.inference.evidence import Scores
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.search import search, silent
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.report.calibration import remainder
from pounding.diagnosis.report.corrected_model import export_model
from pounding.diagnosis.report.details import channels
from pounding.diagnosis.report.history_figure import history_figure
from pounding.diagnosis.report.loops import loops
from pounding.diagnosis.report.making import Made, report_on, shown_after
from pounding.diagnosis.report.on_the_frame import on_the_frame
from pounding.diagnosis.report.transmissibility import answers
from tests.diagnosis.models import measured
from tests.diagnosis.report.bench import diagnosed

SWAYING, RUBBING = np.array([0.1, 11.0, 0.02]), np.array([0.15, 10.0, 0.0, 0.3])


def one(name: str, place: int | None) -> Effect:
    every = candidates(measured())
    return next(effect for effect in every if effect.name == name and place in (effect.storey, effect.floor))


SWAY, RUB = one("appendage", 3), one("coulomb_friction", 2)
EFFECTS = [SWAY, RUB, one("coulomb_friction", 1), one("coulomb_friction", 3), one("cubic_stiffness", 2)]


@cache
def alone() -> Findings:
    """Return what the search finds without the error in the null model."""
    model = measured([(SWAY, SWAYING), (RUB, RUBBING)], noise=0.005)
    return search(model, EFFECTS, [0], [1], silent)


def singles() -> Findings:
    """Return what the search finds of single effects."""
    return replace(alone(), judged=[one for one in alone().judged if len(one.effects) == 1], later=None)


@cache
def beyond() -> Findings:
    """Return what is found beyond the error."""
    return beyond_errors(singles(), EFFECTS, silent)


@cache
def shown() -> Diagnosis:
    """Return the diagnosis of these runs as those of a frame with sensors."""
    return diagnosed(beyond())


@cache
def made() -> Made:
    return report_on(shown())


def test_an_effect_that_alone_has_little_evidence_is_named_beside_the_error_that_hides_it() -> None:
    found, about = alone(), beyond()
    hidden = max(judged.ln_bayes for judged in found.judged if judged.effects == (RUB,))
    error = error_of_frame(found)
    assert error is not None
    assert error.effects == (SWAY,)
    assert about.null.effects == ()
    assert about.null.fit.effects == (SWAY,)
    assert model_error(about) < model_error(found)
    decision = decide(about)
    assert decision.verdict == "effect_named"
    assert decision.judged.effects == (RUB,)
    assert decision.judged.fit.values[1][0] == pytest.approx(RUBBING[0], rel=0.03)
    assert decision.judged.ln_bayes > 10 * hidden
    assert decision.judged.ln_bayes == pytest.approx(
        decision.judged.fit.log_posterior - error.fit.log_posterior
    )


def test_the_error_beside_which_an_effect_is_named_is_said_with_its_size() -> None:
    (said,) = [one for one in shown().conclusion.warnings if "the model also has" in one]
    assert said.startswith("the model also has a little appendage, floor 3 of bench (")
    mass = re.search(r"mass ([0-9.]+) ± [0-9.]+ kg", said)
    assert mass is not None
    assert float(mass[1]) == pytest.approx(SWAYING[0], rel=0.3)


def test_no_second_effect_is_needed_where_an_error_of_the_frame_leads(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    found = singles()
    friction = [one for one in found.judged if one.effects == (RUB,)]
    (first, *_), double = found.judged, next(one for one in alone().judged if len(one.effects) == 2)
    monkeypatch.setattr(module, "first_detected", lambda _: True)
    assert first_decides(found)
    assert not first_decides(found, more_errors=False)
    assert not first_decides(replace(found, judged=friction))
    assert not first_decides(replace(found, judged=[]))
    assert not first_decides(replace(found, judged=[double, *friction, first]))


@pytest.mark.parametrize("more_errors", [True, False])
def test_no_second_effect_is_needed_where_no_single_one_is_detected(
    more_errors: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "moved_by_themselves", lambda _: None)
    found = singles()
    (friction,) = (one for one in found.judged if one.effects == (RUB,))
    assert not first_decides(replace(found, judged=[friction]), more_errors)
    assert first_decides(replace(found, judged=[replace(friction, ln_bayes=0.5)]), more_errors)


@pytest.mark.parametrize("enough", [True, False])
def test_a_second_effect_is_looked_for_beside_an_error_unless_single_ones_are_enough(
    enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All effects are judged anew beside the next error, and what is beside nothing is not needed before."""
    looked: list[Findings] = []
    (error, *others) = singles().judged

    def beside(about: Findings, *_: object) -> Scores:
        about.judged = others
        return about.scores

    monkeypatch.setattr(null_with_error, "beside", beside)
    monkeypatch.setattr(null_with_error, "second", lambda about, _: looked.append(about))
    monkeypatch.setattr(null_with_error, "moved_by_themselves", lambda _: None)
    about = null_with_error.with_error(singles(), error, EFFECTS, silent, lambda of: enough)
    assert len(looked) == (0 if enough else 1)
    assert about.null.effects == ()
    assert about.judged == others


def test_what_leads_is_asked_as_it_will_be_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """The discrepancy is put right about the baseline model, and again beside an error, in a copy."""
    asked: list[Findings] = []
    monkeypatch.setattr(module, "common", lambda *_: (RUB,))
    monkeypatch.setattr(module, "moved_by_themselves", lambda _: None)
    monkeypatch.setattr(module, "unhide", asked.append)
    monkeypatch.setattr(module, "error_of_frame", lambda of: of.judged[0])
    beside = replace(singles(), null=replace(alone().null, beside=alone().null))
    for found in (singles(), beside):
        asked.clear()
        assert first_decides(found)
        (of,) = asked
        assert of is not found


@pytest.mark.parametrize(
    ("name", "place", "error"), [("torsional_eccentricity", None, True), ("appendage", 2, False)]
)
def test_two_of_a_kind_are_no_effect_beside_an_error_of_theirs(
    name: str, place: int | None, error: bool
) -> None:
    """One thing that two of a kind describe together is larger than what either adds to the other."""
    other = one(name, place)
    (sway,) = (judged for judged in alone().judged if judged.effects == (SWAY,))

    def beside(judged: Judged) -> Judged:
        effects = tuple(other if effect == RUB else effect for effect in judged.fit.effects)
        misfit = 0.98 * sway.channel_misfit if len(effects) == 2 else judged.channel_misfit
        return replace(judged, fit=replace(judged.fit, effects=effects), channel_misfit=misfit)

    # A frame that moves so differently has more than an error, and a little is left for another effect to take.
    null = replace(alone().null, channel_misfit=10.0 * alone().null.channel_misfit)
    found = replace(alone(), null=null, judged=[beside(judged) for judged in alone().judged])
    assert (error_of_frame(found) is not None) == error


def test_before_is_the_baseline_model_without_the_error_and_after_the_model_with_both() -> None:
    found, report = beyond(), made().report
    assert found.baseline.fit is alone().null.fit
    assert report.misfit.training is not None
    assert report.misfit.training.before == pytest.approx(found.baseline.misfit[0])
    assert report.misfit.training.before > found.null.misfit[0] > (report.misfit.training.after or 1.0)
    rows = channels(shown(), made().outputs)
    np.testing.assert_allclose([row.before for row in rows], found.baseline.channel_misfit[1])
    effect = on_the_frame(shown(), made().motions).effect
    assert "appendage" in effect
    assert "friction" in effect


def test_what_is_said_of_the_storey_is_about_the_effect_and_not_about_the_error() -> None:
    loop = loops(shown())
    assert loop is not None
    assert loop.storey == 1
    judged = shown().decision.judged
    said = remainder(beyond(), judged, Sight.of(beyond(), judged.fit.filtered)).statement
    assert said.startswith("the baseline model with the frame's errors in it and the frame differ by")


def test_an_error_that_no_frame_file_can_state_does_not_keep_the_effect_out_of_it(tmp_path: Path) -> None:
    model = export_model(shown(), tmp_path / "bench.toml", "Friction is missing.")
    assert model.refused is None
    assert model.beside == ("appendage, floor 3 of bench",)
    text = (tmp_path / "bench.toml").read_text()
    assert "friction" in text
    assert "Left out, an error of the frame that no frame file can state: appendage" in text


def test_a_simulated_case_of_this_rig_has_the_error_and_all_effects_compete_in_it() -> None:
    found = beyond()
    assert set(found.candidates) == set(EFFECTS)
    for truth, effects in ((found.null, [SWAY]), (shown().decision.judged, [SWAY, RUB])):
        acting = scattered(truth, np.random.default_rng(1))
        assert [effect for effect, _ in acting] == effects


def test_where_no_effect_has_evidence_after_is_the_model_with_the_error() -> None:
    nothing = diagnosed(replace(beyond(), judged=[]))
    assert nothing.decision.verdict == "nothing_missing"
    assert shown_after(nothing) is beyond().null
    report = report_on(nothing)
    training = report.report.misfit.training
    assert training is not None
    assert training.after == pytest.approx(beyond().null.misfit[0], rel=0.05)
    (one,) = answers(nothing, report.outputs)
    assert set(one.sizes) == {"measured", "baseline", "calibrated", "with errors"}
    upper = history_figure(nothing, report.outputs).axes[0]
    assert "after (with the errors that this frame has)" in " ".join(upper.get_legend_handles_labels()[1])
