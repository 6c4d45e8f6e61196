"""What may be claimed of a pair's frames, by hand-made verdicts."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pounding.diagnosis.decision.confidence import PAIR_NOTHING, features_of
from pounding.diagnosis.decision.decision import Decision
from pounding.diagnosis.decision.verdict import remaining, signal_to_noise
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.report.figures import _evidence
from tests.diagnosis.colliding_models import CONTACT, colliding, judged, model_of


def effect(name: str, value: float, **where: Any) -> tuple[Any, list[float]]:
    """Return something like an effect, and its parameters."""
    return SimpleNamespace(**({"name": name, "storey": None, "floor": None, "absorbing": False} | where)), [
        value
    ]


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
    found.pair, *_ = judged(colliding(CONTACT))
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
    assert found.plain(absorbing(40.0), 0.21)
    pair, *_ = judged(colliding(CONTACT))
    found.pair = pair
    assert found.claimable() == [judged_ones[0], *judged_ones[2:]]
    verdict = Decision("nothing_missing", judged_ones[1], ())
    assert features_of(found, verdict, 0.1, 1.0).verdict == PAIR_NOTHING
    found.pair = replace(pair, second=(2, 500.0, 1))
    assert found.claimable() == [judged_ones[0], judged_ones[5]]


def test_what_an_effect_needs_in_a_pair() -> None:
    nothing: Any = None
    found = Findings(nothing, nothing, nothing, nothing, (0,), (1,))
    assert found.plain(absorbing(30.0), 0.2)
    pair, *_ = judged(colliding(CONTACT))
    found.pair = pair
    # Modes are never quite those of the baseline frame, and impacts show it.
    assert not found.plain(absorbing(199.0), 0.5)
    assert found.plain(absorbing(200.0), 0.2)
    assert found.plain(absorbing(1000.0), 0.1)
    assert not found.plain(local(99.0), 0.5)
    assert found.plain(local(100.0), 0.1)
    found.pair = replace(pair, contact_claimed=True)
    assert not found.plain(absorbing(299.0), 0.5)
    assert found.plain(absorbing(300.0), 0.5)
    assert not found.plain(absorbing(1499.0), 0.1)
    assert found.plain(absorbing(1500.0), 0.1)
    assert found.plain(local(100.0), 0.1)
    # Without a cell, forces are what the motion asks for.
    found.pair = replace(pair, second=(2, 500.0, 1))
    assert not found.plain(absorbing(1000.0), 0.1)
    assert not found.plain(absorbing(399.0), 0.25)
    assert found.plain(absorbing(500.0), 0.25)
    assert not found.plain(local(199.0), 0.5)


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


@pytest.mark.parametrize(("needed", "lines"), [(30.0, 1), (200.0, 2)])
def test_what_a_verdict_needs_is_inside_the_picture_of_the_evidence(needed: float, lines: int) -> None:
    place = dict.fromkeys(("frame", "storey", "floor", "channel", "contact"))
    report = {
        "candidates": [{"effect": "p_delta", "log_evidence": 14.8, **place}],
        "effects": [],
        "thresholds": {"log_evidence": needed / lines, "absorbing": {"log_evidence": needed}},
    }
    (axes,) = _evidence(report).axes
    drawn = [float(np.ravel(line.get_xdata())[0]) for line in axes.get_lines()]
    assert drawn == [needed / lines, needed][:lines]
    assert max(drawn) < axes.get_xlim()[1]
    assert axes.texts[-1].get_text() == "14.8"
