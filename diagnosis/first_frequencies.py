"""Whether the frame that was measured can be the frame that is named: first frequencies as they stand in the data."""

from __future__ import annotations

import numpy as np
from scipy.signal import csd, welch

from diagnosis.believed import Believed
from diagnosis.observations import RunData

SEGMENT_CYCLES = 16
"""Length of the segments of a spectrum in cycles of the believed first frequency."""
RANGE = (0.4, 2.0)
"""Where the measured first frequency is looked for, in believed ones."""
UNLIKELY = 2.0
"""Prior standard deviations from which a measured frequency is told."""


def frequency_warnings(believed: Believed) -> list[str]:
    """Return a sentence for each frame whose measured first frequency is unlikely before the test."""
    modes = believed.modes(believed.assemble(np.zeros(len(believed.std))))
    prior = believed.prior
    said = []
    for number, frame in enumerate(believed.structure.frames):
        span = believed.structure.span(number)
        floors = modes.floors[span]
        own = np.flatnonzero(np.abs(floors).max(axis=0) > 1e-6 * np.abs(modes.floors).max())
        first = float(modes.omega[own].min()) / (2 * np.pi)
        found = measured_frequency(believed, span, first)
        spread = 0.5 * np.hypot(prior.frame_stiffness, prior.storey_stiffness / np.sqrt(frame.floors))
        if found is None or abs(np.log(found[0] / first)) < UNLIKELY * spread + found[1] / first:
            continue
        said.append(
            f"{frame.name}: the first frequency in the data is {found[0]:.2f} Hz and the believed one {first:.2f} Hz, "
            f"{abs(np.log(found[0] / first)) / spread:.1f} prior standard deviations apart; if nothing was changed on "
            "purpose, check that this is the frame that case.toml names"
        )
    return said


def measured_frequency(believed: Believed, span: slice, first_hz: float) -> tuple[float, float] | None:
    """Return where a frame's highest measured floor answers the table most [Hz], and the resolution [Hz].

    The ratio of cross spectrum to the table's own, over all runs that are long enough; None without one.
    """
    floor = believed.observed.floor
    inside = np.flatnonzero((floor >= span.start) & (floor < span.stop))
    if len(inside) == 0:
        return None
    channel = int(inside[np.argmax(floor[inside])])
    peaks = [_peak(run, channel, first_hz) for run in believed.observed.runs]
    known = [peak for peak in peaks if peak is not None]
    if not known:
        return None
    return float(np.median([peak[0] for peak in known])), max(peak[1] for peak in known)


def _peak(run: RunData, channel: int, first_hz: float) -> tuple[float, float] | None:
    answer = np.nan_to_num(run.measured[:, channel])
    length = min(len(answer), int(SEGMENT_CYCLES / first_hz / run.step_s))
    if length * run.step_s * first_hz < SEGMENT_CYCLES / 2 or not np.any(answer) or not np.any(run.table):
        return None
    settings = {"fs": 1 / run.step_s, "nperseg": length, "nfft": 4 * length}
    hertz, across = csd(run.table, answer, **settings)
    own = welch(run.table, **settings)[1]
    looked = (hertz > RANGE[0] * first_hz) & (hertz < RANGE[1] * first_hz)
    gain = np.abs(across[looked]) / np.maximum(own[looked], 1e-6 * own.max())
    return float(hertz[looked][np.argmax(gain)]), 0.5 / (length * run.step_s)
