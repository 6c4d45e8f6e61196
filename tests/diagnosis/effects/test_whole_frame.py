"""Effects of all storeys of a frame at once: how they follow from those of one storey, and what the data cannot part."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.effects.every_storey import (
    EVERY,
    AllCoulombFriction,
    AllCubicStiffness,
    AllHysteresis,
)
from pounding.diagnosis.effects.whole_frame import AllAddedMass, AllStiffnessChange
from pounding.diagnosis.inference.evidence import scales, score
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.misfit import simulate
from pounding.diagnosis.inference.refine import Fit, refine
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.storeys import StoreyFrame, Structure
from pounding.experiments.rig.storey_forces import cubic_spring, friction, stop, yielding
from tests.diagnosis.models import measured, three_storeys

STIFFNESS = np.array([9e4, 6e4, 3e4])
"""Of each storey of the uneven bench [N/m]."""


@cache
def uneven() -> Model:
    frame = three_storeys().frames[0]
    stiffness = frame.drift.T @ np.diag(STIFFNESS) @ frame.drift
    return Model(Structure((replace(frame, stiffness=stiffness),)), measured().observed, Prior())


def of_all_storeys(model: Model) -> list[Effect]:
    return [effect for kind in kinds() if kind.where == EVERY for effect in places(kind, model)]


def placed(effect: Effect, values: list[float]) -> list[tuple[tuple[float, ...], np.ndarray, object]]:
    assembly = uneven().assemble(np.zeros(len(uneven().std)), [(effect, np.array(values))])
    return [(one.parameters, one.row, one.law) for one in assembly.laws]


@pytest.mark.parametrize(
    ("effect", "values", "law", "first"),
    [
        (AllCoulombFriction(frame="bench"), [2e-4, 15.0, 0.0, 0.3, 0.0], friction, 2e-4 * STIFFNESS),
        (AllCubicStiffness(frame="bench"), [1e4, 0.0], cubic_spring, 1e4 * STIFFNESS),
        (AllHysteresis(frame="bench"), [1e-3, 0.4, 8.0, 0.0, 0.0], yielding, 4e-4 * STIFFNESS),
    ],
)
def test_every_storey_has_the_law_in_proportion_to_its_stiffness(
    effect: Effect, values: list[float], law: object, first: np.ndarray
) -> None:
    found = placed(effect, values)
    assert [numbers[0] for numbers, _, _ in found] == pytest.approx(first)
    assert all(one is law for _, _, one in found)
    np.testing.assert_allclose(np.array([row for _, row, _ in found]), uneven().structure.drift)


def test_all_storeys_yield_at_one_drift() -> None:
    found = placed(AllHysteresis(frame="bench"), [1e-3, 0.4, 8.0, 0.1, 0.0])
    force, stiffness = np.array([numbers[:2] for numbers, _, _ in found]).T
    assert force / stiffness == pytest.approx(1e-3)
    assert stiffness == pytest.approx(0.4 * STIFFNESS)
    assert all(numbers[2:] == (8.0, 0.1) for numbers, _, _ in found)


@pytest.mark.parametrize(
    ("effect", "values", "first"),
    [
        (AllCoulombFriction(frame="bench"), [2e-4, 15.0, 0.0, 0.3, 0.5], 2e-4 * STIFFNESS),
        (AllCubicStiffness(frame="bench"), [1e4, 0.5], 1e4 * STIFFNESS),
        (AllHysteresis(frame="bench"), [1e-3, 0.4, 8.0, 0.0, 0.5], 4e-4 * STIFFNESS),
    ],
)
def test_a_law_of_all_storeys_tapers_evenly_from_base_to_roof(
    effect: Effect, values: list[float], first: np.ndarray
) -> None:
    """What yields does so at another force, and has the same share of each storey's stiffness."""
    found = placed(effect, values)
    assert [numbers[0] for numbers, _, _ in found] == pytest.approx(first * np.exp([-0.5, 0.0, 0.5]))
    if isinstance(effect, AllHysteresis):
        assert [numbers[1] for numbers, _, _ in found] == pytest.approx(0.4 * STIFFNESS)


def test_the_taper_of_a_law_is_found_and_said() -> None:
    truth = np.array([2e-4, 0.5, 8.0, 0.0, -0.5])
    effect = AllHysteresis(frame="bench")
    model = measured([(effect, truth)], runs=1)
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    fit = refine(model, filtered, (effect,), (np.array([2.5e-4, 0.4, 8.0, 0.0, 0.0]),))
    assert fit.values[0][[0, 1, 4]] == pytest.approx(truth[[0, 1, 4]], rel=0.05)
    sizes = scales(model, filtered)
    ((values, usual),), ((_, wider),) = fit.stated(model, sizes), fit.stated(model, sizes, 3.0)
    assert values == pytest.approx(fit.values[0])
    law = effect.law_error(model, values, sizes) * np.abs(values)
    assert usual == pytest.approx(np.hypot(fit.std[0], law))
    assert wider**2 == pytest.approx(9 * fit.std[0] ** 2 - 8 * fit.between[0] ** 2 + law**2)


def test_what_all_storeys_share_every_real_frame_has_a_little_of() -> None:
    """And a plan is never quite symmetric, and parts sway; what else has a place is no error of models (`Effect.common`)."""
    shared = {kind.name for kind in kinds() if kind.where == EVERY}
    assert {kind.name for kind in kinds() if kind.common} == {*shared, "torsional_eccentricity", "appendage"}


def test_a_stop_that_touches_at_rest_is_a_storey_that_is_stiffer_one_way() -> None:
    stop = next(kind for kind in kinds() if kind.name == "bumper")(index=1, frame="bench", storey=2)
    moved: Any = SimpleNamespace(highest=np.array([0.0, 3e-3]), lowest=np.array([0.0, -5e-3]))
    gaps = (0.0, 4e-4, -4e-4, 6e-4, -6e-4)
    found = [stop.is_common(np.array([gap, 1e4, 0.0, 0.0]), moved) for gap in gaps]
    assert found == [True, True, True, False, False]


def test_a_frame_of_one_storey_has_none_of_them() -> None:
    frame = StoreyFrame("stick", 6.5 * np.eye(1), 6e4 * np.eye(1), np.full(1, 0.01), np.array([0.2]))
    pair = Structure((replace(three_storeys().frames[0], joint_derivative=None), frame))
    found = of_all_storeys(Model(pair, measured().observed, Prior()))
    assert Counter(effect.frame for effect in found) == {"bench": 8}


def test_no_motion_of_a_shaken_table_parts_stiffness_from_mass() -> None:
    model = uneven()
    nuisance = np.zeros(len(model.std))
    softer = [(AllStiffnessChange(frame="bench"), np.array([-0.4]))]
    heavier = [(AllAddedMass(frame="bench"), np.array([1 / 0.6 - 1]))]
    one, other = (simulate(model, nuisance, acting, [0])[0] for acting in (softer, heavier))
    np.testing.assert_allclose(one, other, atol=1e-9 * np.abs(one).max())


def ranked(model: Model, count: int) -> list[Fit]:
    """The best candidates of the catalogue, refined, the likeliest first."""
    filtered = run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0,), 0.01), (0,))
    tried = [effect for kind in kinds() if kind.default and not kind.rival for effect in places(kind, model)]
    sizes = scales(model, filtered)
    scored = score(model, filtered, [one for one in tried if one.name != "joint_flexibility"], sizes).ranked
    fits = [
        refine(model, filtered, (one.effect,), (one.effect.values(one.amplitude, one.shape),), thorough=False)
        for one in scored[:count]
    ]
    return sorted(fits, key=lambda fit: -fit.log_posterior)


def test_a_law_in_all_storeys_is_not_that_of_one_and_its_size_is_found() -> None:
    truth = np.array([2e-4, 0.5, 8.0, 0.0, 0.0])
    model = measured([(AllHysteresis(frame="bench"), truth)], runs=1)
    best, *others = ranked(model, 2)
    assert best.effects[0].name == "all_hysteresis"
    assert others[0].log_posterior < best.log_posterior - 100
    fit = refine(model, best.filtered, best.effects, best.values)
    assert fit.values[0][:2] == pytest.approx(truth[:2], rel=0.01)
    # What yields of a storey and the storey's stiffness are nearly the same: so exactly it is not known.
    assert fit.std[0][1] > 1e-3
    assert (np.abs(fit.values[0] - truth)[:2] < 3 * fit.std[0][:2]).all()


def test_a_law_in_one_storey_is_not_that_of_all() -> None:
    alone = next(one for kind in kinds() if kind.name == "hysteresis" for one in places(kind, measured()))
    best, *_ = ranked(measured([(alone, np.array([12.0, 3e4, 8.0, 0.0]))], runs=1), 2)
    assert best.effects == (alone,)


def test_what_breaks_friction_loose_is_gone_when_it_slides() -> None:
    time = np.linspace(0.0, 1.0, 4001)
    drift = 5e-3 * np.sin(2 * np.pi * time)
    rate = np.gradient(drift, time)
    plain, sticky = (
        friction.along((2.0, 1e6, 0.0, np.inf, excess), drift, rate, time) for excess in (0.0, 0.3)
    )
    fast = np.abs(rate) > 0.02
    np.testing.assert_allclose(sticky[fast], plain[fast], rtol=1e-6)
    assert np.abs(plain).max() == pytest.approx(2.0)
    assert np.abs(sticky).max() == pytest.approx(2.6, rel=0.01)


def test_a_stop_of_another_power_is_the_straight_one_at_a_millimetre_and_loss_takes_energy() -> None:
    depth = np.array([0.5e-3, 1e-3, 2e-3])
    still, time = np.zeros(3), np.arange(3.0)
    straight, progressive = (
        stop.along((1e-3, 1e5, 0.0, power), 1e-3 + depth, still, time) for power in (0.0, 1.0)
    )
    assert straight == pytest.approx(1e5 * depth)
    assert progressive == pytest.approx(1e8 * depth**2)
    mirrored = stop.along((-1e-3, 1e5, 0.0, 1.0), -1e-3 - depth, still, time)
    assert mirrored == pytest.approx(-progressive)
    phase = np.linspace(0.0, 1.0, 2001)
    drift = 2e-3 * np.sin(2 * np.pi * phase)
    lost = [
        np.trapezoid(stop.along((1e-3, 1e5, loss, 0.0), drift, np.gradient(drift, phase), phase), drift)
        for loss in (0.0, 2.0)
    ]
    assert abs(lost[0]) < 1e-6
    assert lost[1] > 1e-4
