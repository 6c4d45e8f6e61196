"""Whether the frame that was measured can be the frame that is named: first frequencies as they stand in the data."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.signal import csd, welch

from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.predictor import ACCELERATION, VELOCITY
from pounding.diagnosis.model.storeys import Modes
from pounding.diagnosis.settings import SETTINGS

SEGMENT_CYCLES = 16
"""Length of the segments of a spectrum in cycles of the first frequency of the baseline model."""


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
        found = measured_frequency(model, number, first)
        spread = 0.5 * np.hypot(prior.frame_stiffness, prior.storey_stiffness / np.sqrt(frame.floors))
        unlikely = SETTINGS.screening.frequency_unlikely * spread
        if found is None or abs(np.log(found[0] / first)) < unlikely + found[1] / first:
            continue
        said.append(
            f"{frame.name}: the first frequency in the data is {found[0]:.2f} Hz and in the baseline model {first:.2f} Hz, "
            f"{abs(np.log(found[0] / first)) / spread:.1f} prior standard deviations apart; if nothing was changed on "
            "purpose, check that this is the frame that case.toml names"
        )
    return said


def measured_frequency(model: Model, frame: int, first_hz: float) -> tuple[float, float] | None:
    """Return where a frame's highest measured floor answers the table most [Hz], and the resolution [Hz].

    The ratio of cross spectrum to the table's own, as a displacement, in which the first mode is the largest; over all
    runs that are long enough; None without one.

    Args:
        model: The baseline model.
        frame: Number of the frame.
        first_hz: Its first frequency in the baseline model [Hz].
    """
    floor = model.observed.floor
    inside = np.flatnonzero(model.at_frame(frame))
    if len(inside) == 0:
        return None
    channel = int(inside[np.argmax(floor[inside])])
    power = {ACCELERATION: 2, VELOCITY: 1}.get(int(model.observed.quantity[channel]), 0)
    return _peak([(run, channel) for run in model.observed.runs], first_hz, power)


def _peak(runs: Sequence[tuple[RunData, int]], first_hz: float, power: int) -> tuple[float, float] | None:
    """Return frequency and resolution of the peak, spectra of all runs with the first usable run's step added up."""
    step_s, across, own, hertz, length = 0.0, 0.0, 0.0, np.zeros(0), 0
    for run, channel in runs:
        answer = np.nan_to_num(run.measured[:, channel])
        segment = int(SEGMENT_CYCLES / first_hz / run.step_s)
        if (
            len(answer) < segment
            or not np.any(answer)
            or not np.any(run.table)
            or step_s not in (0.0, run.step_s)
        ):
            continue
        step_s, length = run.step_s, segment
        settings = {"fs": 1 / step_s, "nperseg": segment, "noverlap": 3 * segment // 4, "nfft": 4 * segment}
        hertz, crossed = csd(run.table, answer, **settings)
        across = across + len(answer) * crossed
        own = own + len(answer) * welch(run.table, **settings)[1]
    if step_s == 0.0:
        return None
    low, high = SETTINGS.screening.frequency_range
    looked = (hertz > low * first_hz) & (hertz < high * first_hz)
    table = np.asarray(own)
    gain = np.abs(np.asarray(across)[looked]) / np.maximum(table[looked], 1e-3 * table.max())
    return float(hertz[looked][np.argmax(gain / hertz[looked] ** power)]), 0.5 / (length * step_s)
