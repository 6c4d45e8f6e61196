"""Noise by what a channel shows where nothing moves it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.misfit import floors
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.noise import MARGIN, largest_noise
from tests.diagnosis.models import measured

STEP_S = 0.002


def shaken(rest_s: float, noise: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a channel that sways at 6 Hz with white noise, and the table, which rests at first."""
    time = np.arange(0.0, 8.0, STEP_S)
    moving = time >= rest_s
    table = np.where(moving, np.sin(2 * np.pi * 3.0 * time), 0.0)
    rng = np.random.default_rng(2)
    return np.where(moving, 4.0 * np.sin(2 * np.pi * 6.0 * time), 0.0) + noise * rng.standard_normal(
        len(time)
    ), table


@pytest.mark.parametrize("rest_s", [0.0, 1.0])
def test_white_noise_is_found_beside_a_motion(rest_s: float) -> None:
    series, table = shaken(rest_s, 0.05)
    assert largest_noise(series, STEP_S, table) == pytest.approx(MARGIN * 0.05, rel=0.1)


def test_noise_that_is_slow_is_seen_before_the_shaking() -> None:
    series, table = shaken(1.0, 0.01)
    slow = series + 0.2 * np.sin(2 * np.pi * 2.5 * np.arange(len(series)) * STEP_S)
    assert largest_noise(slow, STEP_S, table) > 0.1


def test_what_a_fit_takes_for_noise_raises_no_floor() -> None:
    model = measured(noise=0.02)
    noise = starting_noise(model, (0,))
    values = np.zeros(len(model.std))
    honest = run_filter(model, values, noise, (0,))
    bought = run_filter(
        model, values, [replace(one, channel=20 * one.channel, table=50 * one.table) for one in noise], (0,)
    )
    own, larger = (floors(model, one, (0,)) for one in (honest, bought))
    assert np.nanmax(larger) < 0.06
    assert np.nanmin(larger / own) > 0.9
