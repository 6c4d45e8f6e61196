"""The laboratory's preliminary tests, simulated as they were done: roof push, free vibration, sine sweep.

Thesis, section 3.6. Frequency and damping are read from the simulated records alone, by the half-power
bandwidth, and must give back what was put into the model. The motion between samples is exact
(`pounding.frames.response.exact`), so what is left is the error of the reading itself.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.signal import chirp, find_peaks, get_window, zoom_fft
from scipy.stats import linregress

from pounding.frames.errors import FrameError
from pounding.frames.response.exact import absolute_acceleration, forced, free_response, poles

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]
Complex = NDArray[np.complexfloating[Any, Any]]

SAMPLE_HZ = 1000.0
"""Sampling rate of the simulated accelerometers [Hz]; the thesis does not state the laboratory's."""

SWEEP_HZ = (0.1, 50.0)
"""Band of the sine sweep [Hz] (section 3.6.3)."""

DECAYED = 7.0
"""Time constants of the first mode after which a record ends: e^-7 = 0.1 % of the motion is left."""


class Reading(NamedTuple):
    """What the half-power bandwidth reads from one resonance.

    Attributes:
        frequency_hz: Frequency of the peak [Hz].
        damping_ratio: Half of the bandwidth at 1 / sqrt(2) of the peak, over the frequency, a fraction.
    """

    frequency_hz: float
    damping_ratio: float


class PushTest(NamedTuple):
    """Load and deflection of the roof.

    Attributes:
        force_n: Lateral loads at the roof (k,) [N].
        deflection_m: Deflections of the roof (k,) [m].
        stiffness_n_per_m: Slope of the regression line of load on deflection [N/m].
    """

    force_n: Real
    deflection_m: Real
    stiffness_n_per_m: float


class FreeVibration(NamedTuple):
    """A decay after the roof was displaced and released.

    Attributes:
        time_s: Times (m,) [s].
        acceleration_m_s2: Acceleration of the roof (m,) [m/s^2].
        frequency_hz: Frequencies around the first mode (k,) [Hz].
        amplitude_m_s: Fourier amplitude of the acceleration (k,) [m/s].
        reading: First mode, from the half-power bandwidth.
    """

    time_s: Real
    acceleration_m_s2: Real
    frequency_hz: Real
    amplitude_m_s: Real
    reading: Reading


class SineSweep(NamedTuple):
    """A logarithmic sweep of the table at constant acceleration.

    Attributes:
        time_s: Times (m,) [s].
        table_m_s2: Acceleration of the table (m,) [m/s^2].
        roof_m_s2: Acceleration of the roof in the room (m,) [m/s^2].
        roof_displacement_m: Displacement of the roof relative to the table (m,) [m].
        frequency_hz: Frequencies (k,) [Hz].
        ratio: Roof's over table's Fourier amplitude (k,).
        readings: The lowest modes, from the half-power bandwidth of the ratio.
        instant_hz: Frequency of the table when the roof's acceleration was largest around each mode [Hz]:
            what one reads from the time history alone; late, hence high, in a fast sweep upwards.
    """

    time_s: Real
    table_m_s2: Real
    roof_m_s2: Real
    roof_displacement_m: Real
    frequency_hz: Real
    ratio: Real
    readings: list[Reading]
    instant_hz: list[float]


def push_test(reduced: ReducedFrame, *, largest_force_n: float = 50.0, loads: int = 6) -> PushTest:
    """Push the roof sideways in steps and return the slope of load against deflection (section 3.6.2).

    Args:
        reduced: The frame.
        largest_force_n: Last load [N].
        loads: Number of loads, evenly spaced from zero.
    """
    forces = np.linspace(0.0, largest_force_n, loads)
    deflections = forces * pushed(reduced)[reduced.floor_x[-1]]
    return PushTest(forces, deflections, float(linregress(deflections, forces).slope))


def free_vibration_test(
    reduced: ReducedFrame,
    *,
    displacement_m: float = 0.005,
    record_s: float | None = None,
    window: str = "boxcar",
) -> FreeVibration:
    """Displace the roof, release it, and read the first mode from its accelerometer (section 3.6.1).

    A record that is cut before the motion has died out, and any tapering window, widen the peak and make the
    damping read too large; `docs/theory/engine.md` shows by how much.

    Args:
        reduced: The frame.
        displacement_m: Displacement of the roof before the release [m].
        record_s: Length of the record [s]; default: until e^-7 of the first mode is left.
        window: Name of a window of scipy over the record.

    Raises:
        FrameError: The record is too short to resolve the peak, or the frame has no damping.
    """
    length = _decay_time(reduced) if record_s is None else record_s
    time_s = np.arange(0.0, length, 1.0 / SAMPLE_HZ)
    start = pushed(reduced)
    start *= displacement_m / start[reduced.floor_x[-1]]
    acceleration = _roof_of_decay(reduced, start, time_s)
    tapered = acceleration * get_window(window, len(acceleration), fftbins=False)
    frequencies, spectrum = _zoom(tapered, _about(reduced.frequencies_hz[0], length, reduced))
    amplitude = np.abs(spectrum) / SAMPLE_HZ
    return FreeVibration(time_s, acceleration, frequencies, amplitude, half_power(frequencies, amplitude))


def sine_sweep_test(
    reduced: ReducedFrame,
    *,
    acceleration_m_s2: float = 0.1,
    octaves_per_minute: float = 2.0,
    modes: int = 3,
) -> SineSweep:
    """Sweep the table from 0.1 to 50 Hz at constant acceleration and read the lowest modes (section 3.6.3).

    The ratio of the spectra holds for any rate of sweep, because the frame is linear and the record runs on
    until it has come to rest.

    Args:
        reduced: The frame.
        acceleration_m_s2: Amplitude of the table's acceleration [m/s^2]; the thesis does not state it.
        octaves_per_minute: Rate of the sweep; the thesis does not state it.
        modes: Number of modes wanted.

    Raises:
        FrameError: Fewer resonances than wanted stand out below 50 Hz.
    """
    lowest, highest = SWEEP_HZ
    sweep_s = 60.0 * np.log2(highest / lowest) / octaves_per_minute
    time_s = np.arange(0.0, sweep_s + _decay_time(reduced), 1.0 / SAMPLE_HZ)
    table = np.where(
        time_s <= sweep_s,
        acceleration_m_s2 * chirp(time_s, lowest, sweep_s, highest, method="logarithmic", phi=-90),
        0.0,
    )
    displacement, roof = _roof_of_shaking(reduced, table)
    frequencies = np.fft.rfftfreq(len(time_s), 1.0 / SAMPLE_HZ)
    band = (frequencies > 2.0 * lowest) & (frequencies < highest)
    ratio = np.abs(np.fft.rfft(roof)[band] / np.fft.rfft(table)[band])
    found = _resonances(frequencies[band], ratio, modes, reduced)
    readings = [_read_ratio(roof, table, frequency, reduced) for frequency in found]
    swept = lowest * (highest / lowest) ** (time_s / sweep_s)
    instants = [_loudest(swept, roof, reading.frequency_hz) for reading in readings]
    return SineSweep(time_s, table, roof, displacement, frequencies[band], ratio, readings, instants)


def pushed(reduced: ReducedFrame) -> Real:
    """Return the coordinates (n,) [m/N] under a unit force at the roof."""
    force = np.zeros(len(reduced.mass))
    force[reduced.floor_x[-1]] = 1.0
    return np.linalg.solve(reduced.stiffness, force)


def half_power(frequency_hz: ArrayLike, amplitude: ArrayLike) -> Reading:
    """Return frequency and damping ratio of the highest peak of a spectrum (Chopra, section 3.4.2).

    Args:
        frequency_hz: Increasing frequencies (k,) [Hz], fine enough for some twenty in the bandwidth.
        amplitude: Amplitude (k,); the half-power points are at 1 / sqrt(2) of the peak.

    Raises:
        FrameError: The amplitude does not fall to the half-power points within the frequencies given.
    """
    frequency, height = np.asarray(frequency_hz, float), np.asarray(amplitude, float)
    top = int(height.argmax())
    half = height[top] / np.sqrt(2.0)
    below, above = np.flatnonzero(height[:top] < half), np.flatnonzero(height[top:] < half) + top
    if not (below.size and above.size):
        raise FrameError(f"half-power bandwidth: the peak at {frequency[top]:.3g} Hz is not resolved")
    left, right = below[-1], above[0]
    lower = np.interp(half, height[[left, left + 1]], frequency[[left, left + 1]])
    upper = np.interp(half, height[[right, right - 1]], frequency[[right, right - 1]])
    return Reading(float(frequency[top]), float((upper - lower) / (2.0 * frequency[top])))


def _decay_time(reduced: ReducedFrame) -> float:
    # The frame's slowest decay that shakes the roof is that of its first mode.
    rate = reduced.damping_ratio * 2.0 * np.pi * float(reduced.frequencies_hz.min())
    if rate <= 0.0:
        raise FrameError(f"{reduced.name}: without damping a free vibration has no bandwidth to read")
    return DECAYED / rate


def _roof_of_decay(reduced: ReducedFrame, start: Real, time_s: Real) -> Real:
    rows = np.array(_acceleration_rows(reduced))
    displacement, velocity = free_response(reduced, start, np.zeros_like(start), time_s, outputs=rows)
    return displacement[:, 0] + velocity[:, 1]


def _acceleration_rows(reduced: ReducedFrame) -> tuple[Real, Real]:
    """Return the rows that give the roof's absolute acceleration from displacement and from velocity."""
    size = len(reduced.mass)
    roof = int(reduced.floor_x[-1])
    none = np.zeros((size, size))
    from_displacement = absolute_acceleration(reduced, np.eye(size), none)[:, roof]
    from_velocity = absolute_acceleration(reduced, none, np.eye(size))[:, roof]
    return from_displacement, from_velocity


def _roof_of_shaking(reduced: ReducedFrame, table: Real) -> tuple[Real, Real]:
    """Return the roof's displacement relative to the table and its acceleration in the room, (m,) each."""
    from_displacement, from_velocity = _acceleration_rows(reduced)
    roof = np.eye(len(reduced.mass))[reduced.floor_x[-1]]
    displacement, velocity = forced(
        poles(reduced), table, 1.0 / SAMPLE_HZ, outputs=np.array([roof, from_displacement, from_velocity])
    )
    return displacement[:, 0], displacement[:, 1] + velocity[:, 2]


def _about(frequency: float, record_s: float, reduced: ReducedFrame) -> tuple[float, float]:
    """Return a band around a resonance, wide enough for its half-power points and for a short record."""
    half = max(10.0 * reduced.damping_ratio * frequency, 2.0 / record_s)
    return max(frequency - half, 0.2 * frequency), min(frequency + half, 1.8 * frequency)


def _zoom(signal: Real, band: tuple[float, float], lines: int = 2001) -> tuple[Real, Complex]:
    """Return the transform of a record on a fine grid of frequencies, as zero-padding without end would."""
    return np.linspace(*band, lines), zoom_fft(signal, band, lines, fs=SAMPLE_HZ, endpoint=True)


def _resonances(frequency: Real, ratio: Real, modes: int, reduced: ReducedFrame) -> Real:
    peaks, _ = find_peaks(np.log(ratio), prominence=np.log(2.0))
    if len(peaks) < modes:
        raise FrameError(f"{reduced.name}: {len(peaks)} resonances below 50 Hz, {modes} wanted")
    return np.asarray(frequency[peaks[:modes]])


def _read_ratio(roof: Real, table: Real, frequency: float, reduced: ReducedFrame) -> Reading:
    band = _about(frequency, len(roof) / SAMPLE_HZ, reduced)
    frequencies, shaken = _zoom(roof, band)
    return half_power(frequencies, np.abs(shaken / _zoom(table, band)[1]))


def _loudest(swept_hz: Real, roof: Real, frequency: float) -> float:
    near = np.flatnonzero((swept_hz > frequency / 1.25) & (swept_hz < frequency * 1.25))
    return float(swept_hz[near[np.abs(roof[near]).argmax()]])
