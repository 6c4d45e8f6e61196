"""Every effect of the catalogue: its name, places, parameters, its force for scoring, and its run in the engine."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import CATALOGUE, Effect
from pounding.diagnosis.hidden.contact_effects import CONTACT
from pounding.diagnosis.hidden.effects import CATALOGUE as HIDDEN
from pounding.diagnosis.inference.evidence import scales
from pounding.diagnosis.inference.filtering import grouped_signatures, motions, run_filter, whitened
from pounding.diagnosis.inference.misfit import simulate
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.observations import root_mean_square
from pounding.diagnosis.model.twin import simulate_engine
from tests.diagnosis.models import measured

BELIEVED = measured()
BASELINE = run_filter(BELIEVED, np.zeros(len(BELIEVED.std)), starting_noise(BELIEVED, (0,), 0.01), (0,))
SIZES = scales(BELIEVED, BASELINE)


def one_of_each() -> list[Effect]:
    found: dict[type, Effect] = {}
    for effect in candidates(BELIEVED):
        if effect.name != "joint_flexibility":  # A stick has no joints; see the test of a plate frame.
            found.setdefault(type(effect), effect)
    return list(found.values())


def names(effect: Effect) -> str:
    return type(effect).__name__


def test_the_catalogue_has_every_effect_of_a_single_frame() -> None:
    candidates(BELIEVED)
    assert set(CATALOGUE.names()) == set(HIDDEN) - set(CONTACT)


def test_every_storey_floor_and_channel_is_a_place() -> None:
    found = candidates(BELIEVED)
    storeys = {effect.storey for effect in found if effect.name == "coulomb_friction"}
    floors = {effect.floor for effect in found if effect.name == "added_mass"}
    channels = {effect.channel for effect in found if effect.name == "sensor_gain"}
    assert storeys == floors == {1, 2, 3}
    assert channels == set(BELIEVED.observed.names)


def small(effect: Effect) -> tuple[np.ndarray, np.ndarray, tuple[float, ...], float]:
    """Return the values of hardly anything, of a little, the shape, and the amplitude between the two."""
    shapes = effect.grid(SIZES)
    friction = effect.name == "coulomb_friction"
    shape = shapes[0 if friction else len(shapes) // 2]
    # Friction slides from a drift on that grows with it; the other forces are proportional to their amplitude.
    share = 0.1 if friction else 0.01
    size = (effect.sign or 1) * share * effect.size(BELIEVED, SIZES, shape)
    return effect.values(size, shape), effect.values(2 * size, shape), shape, size


@pytest.mark.parametrize("effect", one_of_each(), ids=names)
def test_the_force_for_scoring_is_the_effect_itself(effect: Effect) -> None:
    """The signature is the derivative of the predictor with the effect in it."""
    before, after, shape, size = small(effect)
    motion = motions(BELIEVED, BASELINE)[0]
    groups = [[effect.terms(BELIEVED, BASELINE.modes, motion, shape)]]
    column = grouped_signatures(BELIEVED, BASELINE, groups)[0][:, 0]

    def innovations(values: np.ndarray) -> np.ndarray:
        if any("_frequency_ratio" in q.name or q.name == "frequency" for q in effect.quantities):
            there = run_filter(BELIEVED, BASELINE.values, BASELINE.noise, (0,), [(effect, values)])
            return whitened(there.prediction.innovations[0], BASELINE.filters[0]).ravel()
        gains = [steady.gain for steady in BASELINE.filters]
        found = BELIEVED.predict(BASELINE.values, gains, [(effect, values)], (0,)).innovations[0]
        return whitened(found, BASELINE.filters[0]).ravel()

    if effect.name in ("sensor_delay",):
        expected_least = 0.5  # A shift of the data moves their noise too.
    elif effect.name == "coulomb_friction":
        expected_least = 0.6  # The stuck joint's own stiffness and damping are not in the score.
    else:
        expected_least = 0.95
    change = (innovations(before) - innovations(after)) / size
    cosine = column @ change / np.linalg.norm(column) / np.linalg.norm(change)
    assert cosine > expected_least


@pytest.mark.parametrize("effect", one_of_each(), ids=names)
def test_the_engine_agrees_with_the_fast_simulator(effect: Effect) -> None:
    short = replace(
        BELIEVED.observed,
        runs=tuple(
            replace(run, table=run.table[:700], time_s=run.time_s[:700], measured=run.measured[:700],
                    contact=run.contact[:700])
            for run in BELIEVED.observed.runs[:1]
        ),
    )  # fmt: skip
    model = type(BELIEVED)(BELIEVED.structure, short, BELIEVED.prior)
    shapes = effect.grid(SIZES)
    shape = shapes[len(shapes) // 2]
    size = (effect.sign or 1) * 0.5 * effect.size(model, SIZES, shape)
    acting = [(effect, effect.values(size, shape))]
    nuisance = np.zeros(len(model.std))
    fast = simulate(model, nuisance, acting, [0])[0]
    engine = simulate_engine(model, nuisance, acting, [0])[0]
    rms = root_mean_square(fast)
    rms[:3] = np.maximum(rms[:3], 1e-9)
    error = root_mean_square(fast - engine) / rms
    without = root_mean_square(fast - simulate(model, nuisance, [], [0])[0]) / rms
    # Where joints stick or yield the two switch at slightly different moments.
    tolerance = 0.03 if effect.name in ("coulomb_friction", "hysteresis") else 0.006
    assert error.max() < tolerance
    assert without.max() > 3 * error.max()


def test_every_parameter_has_a_unit_and_positive_ones_are_refined_as_such() -> None:
    for effect in one_of_each():
        assert len(effect.logarithmic()) == len(effect.quantities)
        assert all(quantity.name and quantity.unit for quantity in effect.quantities)
        values = effect.values((effect.sign or 1) * effect.size(BELIEVED, SIZES, effect.grid(SIZES)[0]),
                               effect.grid(SIZES)[0])  # fmt: skip
        assert len(values) == len(effect.quantities)
        assert (values[list(effect.logarithmic())] > 0).all()
