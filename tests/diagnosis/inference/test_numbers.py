"""Modal data and peaks beside runs: further terms of the same sum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.case.numbers import ModalDatum, Peak
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.numbers import Numbers, NumbersTerm
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured


def effect(name: str, place: int | None = None) -> Effect:
    return next(
        one for one in candidates(measured()) if one.name == name and place in (None, one.storey, one.floor)
    )


def blank(model: Model) -> Model:
    modal = tuple(ModalDatum("bench", "frequency", mode, "test", 1.0, 0.005) for mode in (1, 2, 3))
    modal += (
        ModalDatum("bench", "roof_stiffness", None, "push", 1.0, 0.01),
        ModalDatum("bench", "mass", None, "scales", 1.0, 0.002),
    )
    peaks = tuple(
        Peak(run, "bench", floor, side, 1.0, 0.02)
        for run in ("run1.csv", "run2.csv")
        for floor in (1, 3)
        for side in ("max", "min")
    )
    return Model(model.structure, replace(model.observed, modal=modal, peaks=peaks), model.prior)


def with_numbers(effects: list[tuple[Effect, np.ndarray]], kinds: str = "modal peaks") -> Model:
    """The bench with runs and numbers that it made itself with effects in it."""
    model = blank(measured(effects, samples=1200))
    numbers = Numbers(model, (0, 1))
    shown = np.exp(numbers.shown(np.zeros(len(model.std)), effects))
    data = [
        replace(one, value=float(value), std=float(value) * one.std)
        for one, value in zip((*numbers.modal, *numbers.peaks), shown, strict=True)
    ]
    count = len(numbers.modal)
    observed = replace(
        model.observed,
        modal=tuple(data[:count]) if "modal" in kinds else (),  # type: ignore[arg-type]
        peaks=tuple(data[count:]) if "peaks" in kinds else (),  # type: ignore[arg-type]
    )
    return Model(model.structure, observed, model.prior)


def test_numbers_are_what_the_frame_shows() -> None:
    numbers = Numbers(blank(measured(samples=1200)), (0, 1))
    shown = np.exp(numbers.shown(np.zeros(len(numbers.model.std))))
    frame = numbers.model.structure.frames[0]
    squares = np.linalg.eigvals(np.linalg.solve(frame.mass, frame.stiffness))
    assert shown[:3] == pytest.approx(np.sqrt(np.sort(squares)) / (2 * np.pi))
    assert shown[3] == pytest.approx(6e4 / 3)
    assert shown[4] == pytest.approx(19.5)
    roof = numbers.model.predict(np.zeros(len(numbers.model.std))).outputs[1][:, 4]
    assert shown[-2:] == pytest.approx([roof.max(), -roof.min()], rel=1e-6)


def test_peaks_of_held_out_runs_do_not_count() -> None:
    assert len(Numbers(blank(measured(samples=1200)), (0,))) == 5 + 4


@pytest.mark.parametrize("name", ["stiffness_change", "added_mass", "base_rocking", "air_drag"])
def test_the_slope_of_numbers_is_that_of_their_cost(name: str) -> None:
    one = effect(name)
    truth = one.values(0.5 * (one.sign or 1) * one.size(measured(), scales_of(measured()), ()), ())
    model = with_numbers([(one, truth)])
    coordinates = Coordinates.of(model, [one], [truth], [np.abs(truth)])
    term = NumbersTerm(Numbers(model, (0, 1)), coordinates)
    theta = coordinates.theta(np.zeros(len(model.std)))
    theta[-1] += 0.1
    ((residual, columns),) = term.blocks(theta)
    slope = columns.T @ residual
    for j in (0, 2, len(theta) - 1):
        ends = []
        for sign in (1.0, -1.0):
            moved = theta.copy()
            moved[j] += sign * 1e-4
            ends.append(term.cost(moved))
        assert slope[j] == pytest.approx((ends[1] - ends[0]) / 2e-4, rel=1e-2, abs=0.2)


def scales_of(model: Model) -> object:
    return scales(model, calibrated(model, [0, 1]))


@pytest.mark.parametrize(("kinds", "worth"), [("modal", 10.0), ("peaks", -1.0), ("modal peaks", 10.0)])
def test_numbers_that_agree_with_the_effect_speak_for_it(kinds: str, worth: float) -> None:
    """Scales that know the mass say much, peaks of runs whose histories are known hardly anything."""
    mass, change = effect("added_mass", 3), np.array([0.3])
    gained = []
    for model in (with_numbers([(mass, change)], ""), with_numbers([(mass, change)], kinds)):
        null = refine(model, calibrated(model, [0, 1]), (), (), ())
        fit = refine(model, null.filtered, (mass,), (change,), (np.array([1.6]),))
        gained.append(fit.log_posterior - null.log_posterior)
    assert fit.values[0] == pytest.approx(change, rel=0.1)
    assert gained[1] > gained[0] + worth


def test_a_candidate_is_scored_by_the_numbers_too() -> None:
    mass, change = effect("added_mass", 3), np.array([0.3])
    frames = [one for one in candidates(measured()) if one.name in ("added_mass", "stiffness_change")]
    apart = []
    for kinds in ("", "modal"):
        model = with_numbers([(mass, change)], kinds)
        null = refine(model, calibrated(model, [0, 1]), (), (), ())
        ranked = score(model, null.filtered, frames, scales(model, null.filtered)).ranked
        assert ranked[0].effect == mass
        apart.append(ranked[0].ln_bayes - ranked[1].ln_bayes)
    assert apart[1] > apart[0] + 2.0


def test_a_number_that_contradicts_an_effect_speaks_against_it() -> None:
    mass, change = effect("added_mass", 3), np.array([0.6])
    plain = with_numbers([(mass, change)], "")
    posterior = []
    for weighed_kg in (19.5 + 0.6, 19.5):
        scales_say = ModalDatum("bench", "mass", None, "scales", weighed_kg, 0.002)
        model = Model(plain.structure, replace(plain.observed, modal=(scales_say,)), plain.prior)
        null = refine(model, calibrated(model, [0, 1]), (), (), ())
        fit = refine(model, null.filtered, (mass,), (change,), (np.array([1.6]),))
        posterior.append(fit.log_posterior)
    assert posterior[1] < posterior[0] - 5.0
