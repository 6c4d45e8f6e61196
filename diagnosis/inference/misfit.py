"""How far a simulation is from what was measured, and how near it could come."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.linalg import expm
from scipy.signal import fftconvolve

from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.kalman import TABLE_NOISE_RATE, Noise, discretise, noise_density
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.observations import RunData, root_mean_square
from pounding.diagnosis.model.predictor import ABSOLUTE_DISPLACEMENT, TABLE_DISPLACEMENT
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.settings import SETTINGS

SLOW = 0.3
"""Share of the lowest frequency below which absolute displacements are not compared."""


def channel_misfits(model: Model, outputs: Sequence[np.ndarray], runs: Sequence[int]) -> np.ndarray:
    """Return rms(simulated - measured) / rms(measured) of each channel, (channels,), over pooled runs.

    Args:
        model: The baseline model.
        outputs: Simulated channels of each run in SI, shape (samples, channels).
        runs: Numbers of the runs.
    """
    measured = [model.observed.runs[run].measured for run in runs]
    return channel_differences(model, outputs, measured, runs)


def channel_differences(
    model: Model, outputs: Sequence[np.ndarray], others: Sequence[np.ndarray], runs: Sequence[int]
) -> np.ndarray:
    """Return rms(outputs - others) / rms(measured) of each channel, (channels,), over pooled runs where it was measured.

    Args:
        model: The baseline model.
        outputs, others: Channels of each run in SI, shape (samples, channels).
        runs: Numbers of the runs.
    """
    measured = [model.observed.runs[run].measured for run in runs]
    difference = [
        levelled(model, np.where(np.isfinite(there), one - other, np.nan), model.observed.runs[run].step_s)
        for run, one, other, there in zip(runs, outputs, others, measured, strict=True)
    ]
    rms = root_mean_square(np.concatenate(measured))
    over = root_mean_square(np.concatenate(difference))
    return np.asarray(np.divide(over, rms, out=np.full(len(rms), np.nan), where=rms > 0))


def levelled(model: Model, difference: np.ndarray, step_s: float) -> np.ndarray:
    """Return differences, (samples, channels), without what is slow against the frames in absolute displacements.

    Integrated twice, a table's noise drifts.

    Args:
        model: The baseline model.
        difference: Simulated less measured, (samples, channels).
        step_s: Sampling step [s].
    """
    difference = difference.copy()
    drifting = np.flatnonzero(np.isin(model.observed.quantity, (ABSOLUTE_DISPLACEMENT, TABLE_DISPLACEMENT)))
    if not len(drifting):
        return difference
    slow = _slow(len(difference), step_s, SLOW * model.structure.lowest_hz)
    for channel in drifting:
        good = np.isfinite(difference[:, channel])
        if good.sum() > slow.shape[1]:
            fitted, *_ = np.linalg.lstsq(slow[good], difference[good, channel])
            difference[:, channel] -= slow @ fitted
    return difference


@lru_cache(8)
def _slow(samples: int, step_s: float, below_hz: float) -> np.ndarray:
    """Return a line and the cosines of a run that lie below a frequency, shape (samples, terms)."""
    time = np.linspace(0.0, 1.0, samples)
    cosines = int(2 * samples * step_s * below_hz)
    return np.column_stack([time - 0.5, *(np.cos(np.pi * k * time) for k in range(cosines + 1))])


def differences(
    model: Model, filtered: Filtered, runs: Sequence[int]
) -> Iterator[tuple[RunData, np.ndarray]]:
    """Yield each run with simulated less measured channels in SI, shape (samples, channels), levelled.

    Args:
        model: The baseline model.
        filtered: The filtered model, whose parameters are simulated.
        runs: Numbers of the runs.
    """
    for run, output in zip(runs, simulate(model, filtered.values, filtered.effects, runs), strict=True):
        data = model.observed.runs[run]
        yield data, levelled(model, output - data.measured, data.step_s)


def over_floor(model: Model, misfits: np.ndarray, floor: np.ndarray) -> np.ndarray:
    """Return misfits over the noise floor, shape (..., channels), as they would be at the rate of the logger.

    Where samples were made fewer their noise fell, and a model's error would stand out of it as it never does in what
    was recorded.

    Args:
        model: The baseline model.
        misfits: Misfits, shape (..., channels).
        floor: Misfits that a perfect model would leave, shape (..., channels).
    """
    slower = model.observed.slower
    with np.errstate(invalid="ignore"):
        return np.asarray(np.sqrt(((misfits / floor) ** 2 + slower - 1) / slower))


def allowed_error(model: Model) -> float:
    """Return how much of the motion the model of a real frame may leave, rms beyond the noise (`model_error` in case.toml).

    Blows between frames excite modes of which a calibration by shaking says less than of the lowest.

    Args:
        model: The baseline model.
    """
    touched = bool(model.observed.contact_floors)
    return model.prior.model_error * (SETTINGS.pair_decision.model_error_factor if touched else 1.0)


def own_error(model: Model, filtered: Filtered, number: int) -> np.ndarray:
    """Return the error that a model may have in a run in SI as noise that is new in every sample, shape (channels,).

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run.
    """
    motion = np.nan_to_num(model.observed.rms(model.observed.runs[number]))
    return as_new_in_every_sample(model, filtered, number, allowed_error(model) * motion)


def as_new_in_every_sample(model: Model, filtered: Filtered, number: int, error: np.ndarray) -> np.ndarray:
    """Return an error of a run's motion in SI as noise that is new in every sample, shape (channels,).

    What a model gets wrong it gets wrong for a whole swing of the first mode: the samples of one count as one.

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run.
        error: Its rms, shape (channels,).
    """
    period_s = 2.0 * np.pi / filtered.modes.omega.min()
    return np.asarray(error * np.sqrt(period_s / model.observed.runs[number].step_s))


def beyond_noise(misfit: np.ndarray, floor: np.ndarray) -> np.ndarray:
    """Return the part of misfits [-] that is no noise, (...), as powers add up; zero below the noise floor [-], (...)."""
    return np.asarray(np.sqrt(np.maximum(misfit**2 - floor**2, 0.0)))


def by_frame(model: Model, over: np.ndarray) -> np.ndarray:
    """Return the median of misfits over the noise floor (..., channels) over the channels of each frame, (..., frames).

    What one frame lacks hardly shows in the channels of another, which may be more.
    """
    frames = range(len(model.structure.frames))
    return np.stack([median(over[..., model.at_frame(frame)]) for frame in frames], axis=-1)


def median(misfits: np.ndarray) -> np.ndarray:
    """Return the median of misfits (..., channels) over the channels that were measured, NaN where none was."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return np.asarray(np.nanmedian(misfits, axis=-1))


def simulate(
    model: Model, values: np.ndarray, effects: Sequence[tuple[Acting, np.ndarray]], runs: Sequence[int]
) -> list[np.ndarray]:
    """Return the simulated channels of each run in SI, shape (samples, channels), nothing corrected by measurements.

    Args:
        model: The baseline model.
        values: Nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        runs: Numbers of the runs.
    """
    return model.predict(values, None, effects, runs).outputs


def floors(model: Model, filtered: Filtered, runs: Sequence[int]) -> np.ndarray:
    """Return the misfit that a perfect model would leave in each channel, (channels,): its and the inputs' noise.

    What a fit takes for noise may be what its model lacks: no channel has more than it shows where nothing moves it.
    Contact forces are as uncertain as their contact events say in runs that were not fitted.

    Args:
        model: The baseline model.
        filtered: A fit; its noise is taken as a share of each channel's rms, its modes carry the table's noise.
        runs: Runs for which the floor is wanted, fitted or not.
    """
    squares, total = np.zeros(len(model.observed.names)), np.zeros(len(model.observed.names))
    for number, noise in zip(runs, expected_noise(model, filtered, runs), strict=True):
        run = model.observed.runs[number]
        rms = np.nan_to_num(model.observed.rms(run))
        known = np.isfinite(noise.channel)
        own = np.where(known, np.fmin(noise.channel, run.largest_noise), 0.0)
        shaken = min(noise.table, run.largest_table_noise)
        _, modes = model.systems(filtered.values, filtered.effects, [number])[0]
        carried = table_response(model, modes, run.step_s, len(run.table)) * shaken
        carried = carried * _held(model, filtered, number, shaken)
        pushed = 0.0 if number in filtered.runs else contact_response(model, filtered.modes, number)
        squares = squares + len(run.table) * (own**2 + carried**2 + pushed)
        total = total + len(run.table) * rms**2
    ratio = np.divide(squares, total, out=np.full(np.shape(total), np.nan), where=np.asarray(total) > 0)
    return np.asarray(np.sqrt(ratio))


def _held(model: Model, filtered: Filtered, number: int, table: float) -> np.ndarray:
    """Return which part of the table's noise is carried on with the laws of the fit, each channel's rms, (channels,).

    Friction that sticks and dampers carry less of it than the frame alone; both are simulated with noise and without.
    """
    assembly, _ = model.systems(filtered.values, filtered.effects, [number])[0]
    if not assembly.laws:
        return np.ones(len(model.observed.names))
    run = model.observed.runs[number]
    white = table / np.sqrt(TABLE_NOISE_RATE * run.step_s / 2)
    noisy = run.table + white * np.random.default_rng(number).standard_normal(len(run.table))
    both = [
        model.seeing(replace(model.observed, runs=(one,), contact_events=()))
        for one in (run, replace(run, table=noisy))
    ]
    carried = []
    for effects in (filtered.effects, ()):
        values = filtered.values[: len(both[0].std)]
        quiet, shaken = (simulate(one, values, effects, [0])[0] for one in both)
        carried.append(root_mean_square(levelled(model, shaken - quiet, run.step_s)))
    ratio = np.divide(carried[0], carried[1], out=np.ones(len(carried[0])), where=carried[1] > 0)
    return np.asarray(ratio)


def expected_noise(model: Model, filtered: Filtered, runs: Sequence[int]) -> list[Noise]:
    """Return the noise of runs, fitted or not: as large as in those of a fit, or the same share of what is measured.

    Which of both it is, all these runs and the one in question tell by what they show where nothing moves them; where
    samples were made fewer, the noise of the fit tells.
    What a channel never showed in a fit is infinite.

    Args:
        model: The baseline model.
        filtered: The filtered model, with the noise of its runs.
        runs: Numbers of the runs.
    """
    size, quiet = (np.array([of(model, number) for number in filtered.runs]) for of in (_size, _quiet))
    noise = np.array([np.append(one.channel, one.table) for one in filtered.noise])
    channel, table = slice(-1), slice(-1, None)
    found = []
    for number in runs:
        there = _size(model, number)
        sizes, shown = np.vstack([size, there]), np.vstack([quiet, _quiet(model, number)])
        if not np.isfinite(shown).any():
            sizes, shown = size, noise
        expected = np.concatenate(
            [
                _expected(noise[:, of], size[:, of], there[of], _is_level(shown[:, of], sizes[:, of]))
                for of in (channel, table)
            ]
        )
        expected = np.where(expected > 0, expected, np.inf)
        found.append(Noise(filtered.noise[0].latent, float(expected[-1]), expected[:-1]))
    return found


def _size(model: Model, number: int) -> np.ndarray:
    """Return the rms of each channel of a run in SI, zero where it was not measured, and of the table, (channels + 1,)."""
    run = model.observed.runs[number]
    return np.append(np.nan_to_num(model.observed.rms(run)), root_mean_square(run.table))


def _quiet(model: Model, number: int) -> np.ndarray:
    """Return the most noise that each channel of a run and the table can have by what they show at rest, (channels + 1,)."""
    run = model.observed.runs[number]
    return np.append(run.largest_noise, run.largest_table_noise)


def _is_level(noise: np.ndarray, size: np.ndarray) -> bool:
    """Return whether noise is as large in weak as in strong shaking, or the same share of what is measured.

    A sensor's is the same, one of its range or of a disturbance may grow with what it measures: whichever of both changes
    less between the runs.

    Args:
        noise, size: Noise and rms of what is measured in each run, both of shape (runs, channels).
    """
    known = np.isfinite(noise) & (noise > 0) & (size > 0)
    count = np.maximum(known.sum(axis=0), 1)

    def spread(values: np.ndarray) -> float:
        logs = np.where(known, np.log(np.where(known, values, 1.0)), 0.0)
        return float(np.sum(np.where(known, logs - logs.sum(axis=0) / count, 0.0) ** 2))

    return spread(noise) < spread(noise / np.where(known, size, 1.0))


def _expected(noise: np.ndarray, size: np.ndarray, there: np.ndarray, is_level: bool) -> np.ndarray:
    """Return the noise of a run, (channels,), zero where nothing is known of it.

    Args:
        noise, size: Noise and rms of what is measured in each fitted run, both of shape (runs, channels).
        there: That rms in the run, shape (channels,).
        is_level: Whether the noise is that of the fitted runs, or the same share of what is measured.
    """
    known = np.isfinite(noise) & (size > 0)
    count = np.maximum(known.sum(axis=0), 1)
    if is_level:
        level = np.where(known, noise, 0.0).sum(axis=0) / count
        return np.asarray(np.where(there > 0, level, 0.0))
    share = np.where(known, noise / np.where(known, size, 1.0), 0.0).sum(axis=0) / count
    return np.asarray(share * there)


def table_response(model: Model, modes: Modes, step_s: float, samples: int) -> np.ndarray:
    """Return the rms of each channel in SI, shape (channels,), for table noise of unit standard deviation, from rest.

    Args:
        model: The baseline model.
        modes: Its modes.
        step_s: Sampling step [s].
        samples: Length of the run.
    """
    storeys = model.structure.floors
    system = model.linear_system(modes)
    density = noise_density(len(system.rate), Noise(np.zeros(storeys), 1.0, np.zeros(0)))
    step, covariance = discretise(system.rate, density, step_s)
    # Doubling: the covariance after 1, 2, 4, ... samples, up to half the run, where its mean lies.
    for _ in range(max(1, int(np.log2(max(samples, 4) / 2)))):
        covariance = covariance + step @ covariance @ step.T
        step = step @ step
    # What `levelled` takes off is not noise either.
    output = system.output.copy()
    output[:, -2:] = 0.0
    variance = np.einsum("ci,ij,cj->c", output, covariance, output)
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def contact_response(model: Model, modes: Modes, number: int) -> np.ndarray:
    """Return the mean square of each channel in SI, shape (channels,), that the uncertain contact forces of a run make.

    Args:
        model: The baseline model.
        modes: Its modes.
        number: Number of the run.
    """
    run, observed = model.observed.runs[number], model.observed
    total = np.zeros(len(observed.names))
    contact_events = [event for event in observed.contact_events if event.run == number]
    if not contact_events:
        return total
    system = model.linear_system(modes)
    swaying = slice(0, 2 * len(modes.omega))
    step = expm(system.rate[swaying, swaying] * run.step_s)
    times, samples = np.arange(len(run.table)) * run.step_s, len(run.table)
    for column, (left, right) in enumerate(observed.contact_floors):
        direction = modes.floors[right] - modes.floors[left]
        state = np.concatenate([np.zeros(len(direction)), direction])
        after = np.zeros((samples, len(total)))
        for k in range(samples):
            after[k] = system.output[:, swaying] @ state
            state = step @ state
        after[0] /= 2.0  # The trapezoidal rule: half of an impulse lies before its sample.
        for event in contact_events:
            if event.column == column:
                force = np.where(event.within(times), run.contact[:, column], 0.0)[:, None]
                moved = fftconvolve(force, run.step_s * after, axes=0)[:samples]
                added = event.std * (moved + force * (system.direct @ direction))
                total += np.mean(added**2, axis=0)
    return total
