"""Whether the frame that was measured can be the frame that is named: first frequencies as they stand in the data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import csd, find_peaks, welch

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.predictor import ACCELERATION, VELOCITY
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.settings import SETTINGS

SEGMENT_CYCLES = 16
"""Length of the segments of a spectrum in cycles of the first frequency of the baseline model."""
SPIKE = 1.5
"""What is larger than so many times the value that one sample in 200 exceeds counts as that."""


def check_resolved(model: Model) -> None:
    """Refuse runs whose samples are too far apart to show the first mode of a frame.

    Raises:
        CaseError: A frame's first frequency is not below half the sampling rate.
    """
    modes = model.modes(model.assemble(np.zeros(len(model.std))))
    for number, frame in enumerate(model.structure.frames):
        first = _first(model, modes, number)
        for run in model.observed.runs:
            if first * run.step_s >= 0.5:
                raise CaseError(
                    f"{run.name}: samples {run.step_s:g} s apart cannot show the first frequency of {frame.name}, "
                    f"{first:g} Hz in the baseline model; check the times, or the frame's masses and frequencies"
                )


def _first(model: Model, modes: Modes, number: int) -> float:
    """Return the first frequency of a frame in the baseline model [Hz]."""
    floors = modes.floors[model.structure.span(number)]
    own = np.flatnonzero(np.abs(floors).max(axis=0) > 1e-6 * np.abs(modes.floors).max())
    return float(modes.omega[own].min()) / (2 * np.pi)


def frequency_warnings(model: Model) -> list[str]:
    """Return a sentence for each frame whose measured first frequency is unlikely before the test."""
    modes = model.modes(model.assemble(np.zeros(len(model.std))))
    prior = model.prior
    said = []
    for number, frame in enumerate(model.structure.frames):
        first = _first(model, modes, number)
        runs = range(len(model.observed.runs))
        since, before = model.since(runs), [run for run in runs if not model.acts(run)]
        # What changed since is for the diagnosis to say.
        found = measured_frequency(model, number, first, before or None)
        said += [*_odd_run(model, number, first, since), *_odd_run(model, number, first, before)]
        spread = 0.5 * np.hypot(prior.frame_stiffness, prior.storey_stiffness / np.sqrt(frame.floors))
        unlikely = SETTINGS.screening.frequency_unlikely * spread
        if found is None or found.holds(first):
            continue
        apart = abs(np.log(found.hertz / first))
        if apart < unlikely + found.resolution_hz / first:
            continue
        said.append(
            f"{frame.name}: the first frequency in the data is {found.hertz:.2f} Hz "
            f"and in the baseline model {first:.2f} Hz, "
            f"{apart / spread:.1f} prior standard deviations apart; if nothing was changed on "
            "purpose, check that this is the frame that case.toml names"
        )
    return said


@dataclass(frozen=True)
class Peak:
    """Where a floor answers the table most [Hz], the resolution [Hz], and between which frequencies it answers half as much.

    `amplification` is the relative acceleration there for a unit of the table's.
    A storey that sticks and slips answers from the one frequency to the other, and none of them is the first alone.
    """

    hertz: float
    resolution_hz: float
    from_hz: float
    to_hz: float
    amplification: float

    def holds(self, hertz: float) -> bool:
        """Return whether a frequency [Hz] lies in the peak."""
        return self.from_hz <= hertz <= self.to_hz


def _odd_run(model: Model, frame: int, first_hz: float, runs: Sequence[int]) -> list[str]:
    """Return a sentence if the first frequency in one of some runs is unlike that in the others, nothing if alike."""
    names = [model.observed.runs[number].name for number in runs]
    peaks = [measured_frequency(model, frame, first_hz, [number]) for number in runs]
    each = zip(names, peaks, strict=True)
    known = sorted(((name, peak) for name, peak in each if peak is not None), key=lambda one: one[1].hertz)
    if not known:
        return []
    usual, middle = known[(len(known) - 1) // 2]
    name, odd = max(known, key=lambda one: abs(np.log(one[1].hertz / middle.hertz)))
    unlikely = SETTINGS.screening.frequency_unlikely * 0.5 * model.prior.frame_stiffness
    near = abs(np.log(odd.hertz / middle.hertz)) <= unlikely
    if near or odd.holds(middle.hertz) or middle.holds(odd.hertz):
        return []
    return [
        f"{model.structure.frames[frame].name}: the first frequency is {odd.hertz:.2f} Hz in {name} and "
        f"{middle.hertz:.2f} Hz in {usual}; are both of one frame?"
    ]


def measured_frequency(
    model: Model, frame: int, first_hz: float, runs: Sequence[int] | None = None
) -> Peak | None:
    """Return where a frame's highest measured floor answers the table most.

    The ratio of cross spectrum to the table's own, as a displacement, in which the first mode is the largest; of it the
    part a quarter of a period behind the table, which alone has a peak at a mode: an absolute acceleration or displacement
    is in phase with the table far below the first mode, and would be largest there. Over all runs that are long enough;
    None without one, or without a peak.

    Args:
        model: The baseline model.
        frame: Number of the frame.
        first_hz: Its first frequency in the baseline model [Hz].
        runs: Numbers of the runs, all by default.
    """
    observed = model.observed
    used = observed.runs if runs is None else [observed.runs[number] for number in runs]
    floor = model.observed.floor
    inside = np.flatnonzero(model.at_frame(frame))
    # A dead sensor, or a table's, shows no frequency; the next lower one may.
    for channel in inside[np.argsort(-floor[inside], kind="stable")]:
        derivative = {ACCELERATION: 2, VELOCITY: 1}.get(int(model.observed.quantity[channel]), 0)
        spectra = _spectra([(run, int(channel)) for run in used], first_hz)
        found = None if spectra is None else _peak(spectra, first_hz, derivative)
        if found is not None and found.amplification > SETTINGS.screening.answers:
            return found
    return None


@dataclass(frozen=True)
class _Spectra:
    """Spectra of the table and between it and a channel, summed over runs, with their frequencies and resolution [Hz]."""

    hertz: np.ndarray
    across: np.ndarray
    table: np.ndarray
    resolution_hz: float


def _spectra(runs: Sequence[tuple[RunData, int]], first_hz: float) -> _Spectra | None:
    """Return the spectra of all runs that are long enough and have the step of the first of them; None without one."""
    found: _Spectra | None = None
    step_s = 0.0
    for run, channel in runs:
        answer = np.nan_to_num(run.measured[:, channel])
        # A spike has all frequencies.
        usual = SPIKE * np.percentile(np.abs(answer), 99.5)
        answer = np.clip(answer, -usual, usual)
        segment = int(SEGMENT_CYCLES / first_hz / run.step_s)
        if (
            len(answer) < segment
            or not np.any(answer)
            or not np.any(run.table)
            or step_s not in (0.0, run.step_s)
        ):
            continue
        step_s = run.step_s
        settings = {"fs": 1 / step_s, "nperseg": segment, "noverlap": 3 * segment // 4, "nfft": 4 * segment}
        hertz, crossed = csd(run.table, answer, **settings)
        across, own = len(answer) * crossed, len(answer) * welch(run.table, **settings)[1]
        if found is not None:
            across, own = across + found.across, own + found.table
        found = _Spectra(hertz, across, own, 0.5 / (segment * step_s))
    return found


def _peak(spectra: _Spectra, first_hz: float, derivative: int) -> Peak | None:
    """Return the largest peak of a channel that is such a derivative of a displacement."""
    low, high = SETTINGS.screening.frequency_range
    looked = (spectra.hertz > low * first_hz) & (spectra.hertz < high * first_hz)
    hertz, table = spectra.hertz[looked], spectra.table
    ratio = spectra.across[looked] / np.maximum(table[looked], 1e-3 * table.max())
    height = np.abs((ratio / (1j * hertz) ** derivative).imag)
    # At an end of the range it may be the slope of what lies outside.
    peaks = find_peaks(height)[0]
    if not len(peaks):
        return None
    top = int(peaks[np.argmax(height[peaks])])
    below = np.flatnonzero(height < 0.5 * height[top])
    first, last = below[below < top], below[below > top]
    return Peak(
        float(hertz[top]),
        spectra.resolution_hz,
        float(hertz[first[-1]] if len(first) else hertz[0]),
        float(hertz[last[0]] if len(last) else hertz[-1]),
        float(height[top] * (2 * np.pi) ** (2 - derivative) * hertz[top] ** 2),
    )
