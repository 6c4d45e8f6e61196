"""What may be claimed of a pair's frames, by hand-made verdicts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pounding.diagnosis.decision.confidence import PAIR_NOTHING, features_of
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.false_alarms import plain
from pounding.diagnosis.decision.measures import remaining, signal_to_noise
from pounding.diagnosis.inference.findings import Findings, Judged
from tests.diagnosis.pair_models import CONTACT, colliding, found_of, model_of


def effect(name: str, value: float, **where: Any) -> tuple[Any, list[float]]:
    """Return something like an effect, and its parameters."""
    return SimpleNamespace(
        **({"name": name, "storey": None, "floor": None, "channel": None, "absorbing": False} | where)
    ), [value]


def together(ln_bayes: float, *several: tuple[Any, list[float]]) -> Judged:
    """Return effects as they may have been judged."""
    effects, values = zip(*several, strict=True)
    return Judged(
        cast(Any, SimpleNamespace(effects=effects, values=values)), ln_bayes, (0.1, 0.1), np.ones((2, 1))
    )


def absorbing(ln_bayes: float) -> Judged:
    """Return a change of a frame's modes with so much evidence."""
    return together(ln_bayes, effect("p_delta", 1.0, absorbing=True))


def local(ln_bayes: float) -> Judged:
    """Return an effect in a storey with so much evidence."""
    return together(ln_bayes, effect("bumper", 1.0))


def one(name: str, value: float, **where: Any) -> Judged:
    return together(12.0, effect(name, value, **where))


def test_effects_are_judged_beside_the_delay_of_a_filter_that_is_likelier_than_each() -> None:
    filtered, late = effect("sensor_delay", 1e-4), effect("sensor_delay", 1e-3)
    bumper, friction = effect("bumper", 0.5, storey=2), effect("coulomb_friction", 3.0, storey=4)
    judged_ones = [
        together(900.0, filtered, bumper),
        together(700.0, filtered),
        together(650.0, friction),
    ]
    nothing: Any = None
    found = Findings(nothing, nothing, nothing, nothing, (0,), (1,), judged_ones)
    found.pair, *_ = found_of(CONTACT)
    # What imitates the delay alone is not claimed.
    (claimed_one,) = found.claimable()
    assert claimed_one.effects == (bumper[0],)
    assert claimed_one.ln_bayes == pytest.approx(200.0)
    assert claimed_one.beside is judged_ones[1]
    found.judged = [together(1000.0, late), *judged_ones]
    assert found.claimable() == [found.judged[0], judged_ones[2]]


def test_what_only_tells_how_badly_forces_and_filters_are_known_is_not_claimed() -> None:
    judged_ones = [
        one("sensor_delay", 1e-3),
        one("sensor_delay", 1e-4),
        one("bumper", 0.5, storey=2),
        one("bumper", 0.5, storey=3),
        one("added_mass", 0.5, floor=2),
        one("bumper", 0.5, storey=4),
    ]
    nothing: Any = None
    found = Findings(nothing, nothing, nothing, nothing, (0,), (1,), judged_ones)
    assert found.claimable() == judged_ones
    assert plain(found, absorbing(40.0), 0.41)
    assert not plain(found, absorbing(40.0), 0.39)
    pair, *_ = found_of(CONTACT)
    found.pair = pair
    assert found.claimable() == [judged_ones[0], *judged_ones[2:]]
    verdict = Decision("nothing_missing", judged_ones[1], ())
    assert features_of(found, verdict, 0.1, 1.0).verdict == PAIR_NOTHING
    found.pair = replace(pair, second=(2, 500.0, 1))
    assert found.claimable() == [judged_ones[0], judged_ones[5]]


def least(found: Findings, kind: Callable[[float], Judged], size: float) -> float:
    """Return the least evidence with which an effect of that size is detected, infinity where none is enough."""
    levels = np.geomspace(1.0, 1e5, 2001)
    return next((float(level) for level in levels if plain(found, kind(float(level)), size)), np.inf)


def test_an_effect_needs_more_the_less_is_known_of_what_acts_on_the_frames() -> None:
    """Modes are never quite those of the baseline frame, and impacts show it: more for what imitates that."""
    nothing: Any = None
    alone = Findings(nothing, nothing, nothing, nothing, (0,), (1,))
    pair, *_ = found_of(CONTACT)
    touching = replace(alone, pair=pair)
    beside = replace(alone, pair=replace(pair, contact_claimed=True))
    # Without a cell, forces are what the motion asks for.
    blind = replace(alone, pair=replace(pair, second=(2, 500.0, 1)))
    needed = [least(found, absorbing, 0.5) for found in (alone, touching, beside, blind)]
    assert needed == sorted(needed)
    assert len(set(needed)) == 4
    assert least(alone, local, 0.5) < least(touching, local, 0.5) < least(blind, local, 0.5)
    for found in (touching, beside, blind):
        assert least(found, local, 0.5) < least(found, absorbing, 0.5)
    # What is between the frames says nothing about an effect in a storey that no mode imitates.
    assert least(beside, local, 0.5) == least(touching, local, 0.5)


def test_overwhelming_evidence_makes_up_for_size_where_a_cell_measured_the_force() -> None:
    nothing: Any = None
    alone = Findings(nothing, nothing, nothing, nothing, (0,), (1,))
    pair, *_ = found_of(CONTACT)
    touching = replace(alone, pair=pair)
    blind = replace(alone, pair=replace(pair, second=(2, 500.0, 1)))
    small = 0.12
    assert least(touching, absorbing, 0.5) < least(touching, absorbing, small) < np.inf
    assert least(blind, absorbing, small) == np.inf
    assert least(alone, absorbing, small) == np.inf
    assert least(touching, absorbing, 0.01) == np.inf


def test_what_is_left_of_a_pair_is_that_of_the_frame_that_has_most() -> None:
    """Whatever is wrong with one frame, the other's channels hardly show it, and may be more."""
    model = model_of(colliding(CONTACT))
    nothing: Any = None
    found = Findings(
        model, nothing, nothing, nothing, (0,), (1,), floor=np.ones((2, len(model.observed.names)))
    )
    misfits = np.where(model.observed.floor >= 3, 2.0, 1.0) * np.ones((2, 1))
    fit = replace(local(0.0), channel_misfit=misfits)
    assert remaining(found, fit) == pytest.approx(2.0)
    # Without a second run only the first counts.
    assert remaining(found, replace(fit, channel_misfit=misfits * [[1.0], [np.nan]])) == pytest.approx(2.0)


def test_an_effect_of_one_frame_is_as_large_as_that_frame_shows_it() -> None:
    """Forces being known, it moves that frame alone: what the other's channels gain is another optimum of its own."""
    model = model_of(colliding(CONTACT))
    tall = model.observed.floor < 3
    nothing: Any = None
    before = replace(local(0.0), channel_misfit=2.0 * np.ones((2, len(tall))))
    found = Findings(model, before, nothing, nothing, (0,), (1,), floor=np.ones((2, len(tall))))
    misfits = np.where(tall, np.sqrt(3.0), 1.0) * np.ones((2, 1))
    for frame, size in (("tall", 1.0), ("stiff", np.sqrt(3.0)), (None, np.sqrt(3.0))):
        fit = replace(together(500.0, effect("bumper", 1.0, frame=frame)), channel_misfit=misfits)
        assert signal_to_noise(found, fit) == pytest.approx(size)
