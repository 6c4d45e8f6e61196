"""What speaks against a model that fits: a frame beyond its priors, a tone that nothing makes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis.effects.storey import CoulombFriction
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.model_checks import strain, strained, stray_tones, table_lines, tones
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import STEP_S, measured

SAMPLES = 2000
TIME = STEP_S * np.arange(SAMPLES)


def noise(channels: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((SAMPLES, channels))


def with_tone(frequency: float, size: float, channels: list[int], effects: Sequence[Any] = ()) -> Model:
    """The bench with a tone on some channels of its first run, as a share of the channel's rms."""
    model = measured(effects)
    first, *others = model.observed.runs
    series = first.measured.copy()
    for channel in channels:
        series[:, channel] += size * series[:, channel].std() * np.sin(2 * np.pi * frequency * TIME)
    runs = (replace(first, measured=series), *others)
    return Model(model.structure, replace(model.observed, runs=runs), model.prior)


def null_model(model: Model, values: np.ndarray | None = None) -> Filtered:
    started = np.zeros(len(model.std)) if values is None else values
    return run_filter(model, started, starting_noise(model, (0, 1), 0.01), (0, 1))


@pytest.mark.parametrize("seed", range(20))
def test_noise_has_no_tone(seed: int) -> None:
    assert tones(noise(8, seed), STEP_S) == []


def test_a_tone_in_two_channels_is_found_and_in_one_of_two_it_is_not() -> None:
    tone = np.sin(2 * np.pi * 33.3 * TIME)[:, None]
    assert tones(noise(3) + tone * [1.0, 0.0, 1.5], STEP_S) == pytest.approx([33.3], abs=0.3)
    assert tones(noise(3) + tone * [2.0, 0.0, 0.0], STEP_S) == []
    assert tones(noise(1) + tone, STEP_S) == pytest.approx([33.3], abs=0.3)


def test_a_line_at_the_highest_frequency_is_a_tone_there_and_not_at_the_lowest() -> None:
    highest = 0.5 / STEP_S
    every_other = np.cos(2 * np.pi * highest * TIME)[:, None]
    for channels in (1, 3):
        assert tones(noise(channels) + every_other, STEP_S) == pytest.approx([highest], abs=0.3)


def test_a_good_model_is_not_doubted() -> None:
    model = measured()
    assert strained(model, null_model(model).values) == []
    assert stray_tones(model, null_model(model)) == []


def test_a_fan_is_told_with_its_frequency_and_run() -> None:
    model = with_tone(23.0, 0.3, [0, 1, 2])
    (said,) = stray_tones(model, null_model(model))
    assert "run1.csv" in said
    assert "23.0 Hz" in said


def test_a_line_beside_a_mode_is_a_fan_and_one_at_a_mode_is_that_mode() -> None:
    own = float(null_model(measured()).modes.omega[1] / (2 * np.pi))
    beside, at = (with_tone(own * ratio, 0.3, [0, 1, 2]) for ratio in (1.025, 1.005))
    assert len(stray_tones(beside, null_model(beside))) == 1
    assert stray_tones(at, null_model(at)) == []


def test_a_frame_with_a_joint_that_sticks_swings_faster_and_that_is_no_fan() -> None:
    """Stuck for good, the joint is a second spring as stiff as the storey."""
    stuck = ((CoulombFriction(index=0, frame="bench", storey=1), np.array([1e5, 1.0, 0.0, 0.3])),)

    def said(frequency: float) -> list[str]:
        model = with_tone(frequency, 0.3, [0, 1, 2], stuck)
        noise = starting_noise(model, (0, 1), 0.01)
        return stray_tones(model, run_filter(model, np.zeros(len(model.std)), noise, (0, 1), stuck))

    model = measured()
    row = model.structure.drift[0] @ null_model(model).modes.floors
    squares = null_model(model).modes.omega ** 2
    faster = np.linalg.eigvalsh(np.diag(squares) + 6e4 * np.outer(row, row))
    assert said(np.sqrt(faster[0]) / (2 * np.pi)) == []
    assert len(said(1.06 * np.sqrt(faster[0]) / (2 * np.pi))) == 1


def test_hum_of_the_mains_is_no_fan() -> None:
    for frequency in (50.0, 60.0, 100.0, 180.0):
        model = with_tone(frequency, 0.3, [0, 1, 2])
        assert stray_tones(model, null_model(model)) == []


def test_another_frame_is_told() -> None:
    model = measured()
    values = np.zeros(len(model.std))
    ours = [
        number
        for number, one in enumerate(model.parameters)
        if one.kind in ("storey_stiffness", "floor_mass")
    ]
    values[ours] = 3.0 * model.std[ours]
    squares, count = strain(model, values)
    assert squares == pytest.approx(6 * 3.0**2)
    assert count == 7
    (said,) = strained(model, values)
    assert "case.toml" in said


def sine_test(table_hz: float, tone_hz: float) -> Model:
    """The bench shaken by little more than a sine, with a tone in its channels that no model makes."""
    model = measured()
    sine = 10.0 * np.sin(2 * np.pi * table_hz * TIME)
    shaken = tuple(replace(run, table=run.table + sine) for run in model.observed.runs)
    driven = Model(model.structure, replace(model.observed, runs=shaken), model.prior)
    rng = np.random.default_rng(3)
    runs = []
    for run, output in zip(shaken, driven.predict(np.zeros(len(model.std))).outputs, strict=True):
        tone = np.outer(np.sin(2 * np.pi * tone_hz * TIME), [0.3, 0.3, 0.3, 0.0, 0.0])
        runs.append(
            replace(
                run, measured=output + output.std(axis=0) * (tone + 0.02 * rng.standard_normal(output.shape))
            )
        )
    return Model(model.structure, replace(model.observed, runs=tuple(runs)), model.prior)


def said_of_tones(model: Model) -> list[str]:
    return stray_tones(model, null_model(model))


@pytest.mark.parametrize("order", [2, 3, 5, 7])
def test_a_harmonic_of_what_the_table_does_is_no_machine(order: int) -> None:
    assert len(said_of_tones(with_tone(order * 4.33, 0.3, [0, 1, 2]))) == 1
    assert said_of_tones(sine_test(4.33, order * 4.33)) == []


def test_a_tone_beside_the_harmonics_of_the_table_is_a_machine() -> None:
    (said,) = said_of_tones(sine_test(4.33, 5.5 * 4.33))
    assert "23.8 Hz" in said


def test_the_lines_of_a_table_are_its_sines_and_noise_has_none() -> None:
    sines = np.sin(2 * np.pi * 4.33 * TIME) + 0.3 * np.sin(2 * np.pi * 12.99 * TIME)
    table = sines + 0.01 * noise(1)[:, 0]
    np.testing.assert_allclose(table_lines(table, STEP_S), [4.33, 12.99], atol=0.03)
    assert table_lines(noise(1)[:, 0], STEP_S).size == 0
    assert table_lines(np.zeros(SAMPLES), STEP_S).size == 0


def test_a_line_far_below_the_noise_of_a_sensor_is_no_tone() -> None:
    # A sensor whose noise is white to the filter, and whose band above 100 Hz is empty but for a line.
    spectrum = np.fft.rfft(noise(2), axis=0)
    spectrum[int(100.0 * SAMPLES * STEP_S) :] *= 1e-4
    series = np.fft.irfft(spectrum, SAMPLES, axis=0)
    line = np.sin(2 * np.pi * 180.0 * TIME)[:, None]
    assert tones(series + 0.01 * line, STEP_S) == []
    assert tones(series + 0.5 * line, STEP_S) == pytest.approx([180.0], abs=0.3)


def test_a_tone_in_the_only_channel_is_said_to_be_in_one() -> None:
    model = with_tone(23.0, 0.3, [2])
    observed = model.observed
    runs = tuple(replace(run, measured=run.measured[:, [2]]) for run in observed.runs)
    kept = replace(
        observed,
        names=observed.names[2:3],
        to_si=observed.to_si[2:3],
        quantity=observed.quantity[2:3],
        floor=observed.floor[2:3],
        runs=runs,
    )
    (said,) = said_of_tones(Model(model.structure, kept, model.prior))
    assert "in the only channel" in said
