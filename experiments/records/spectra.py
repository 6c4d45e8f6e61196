"""Response and Fourier spectra of a ground motion, and its dominant period.

Oscillators are integrated exactly for ground acceleration that is straight between its samples, by the same
recursion as whole frames (`pounding.frames.response.exact`), and looked at often enough within each period that no peak is
missed between samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d

from pounding.experiments.errors import ExperimentError
from pounding.experiments.records.record import Record
from pounding.frames.response.exact import oscillator_peaks, refine, run

LOOKS_PER_PERIOD = 40
"""Times within one period at which the response is evaluated: a peak is missed by at most 0.31 %."""


@dataclass(frozen=True)
class ResponseSpectrum:
    """Peaks of linear oscillators under one motion, each array (periods,).

    Attributes:
        period_s: Undamped natural period [s].
        damping_ratio: Of every oscillator [-].
        displacement_m: Largest absolute relative displacement [m].
        velocity_m_s: Largest absolute relative velocity [m/s].
        acceleration_m_s2: Largest absolute acceleration in the room [m/s^2].
    """

    period_s: NDArray[np.float64]
    damping_ratio: float
    displacement_m: NDArray[np.float64]
    velocity_m_s: NDArray[np.float64]
    acceleration_m_s2: NDArray[np.float64]

    @property
    def pseudo_acceleration_m_s2(self) -> NDArray[np.float64]:
        """Displacement times the square of the circular frequency (periods,) [m/s^2]."""
        return (2 * np.pi / self.period_s) ** 2 * self.displacement_m


@dataclass(frozen=True)
class FourierSpectrum:
    """One-sided amplitude of the Fourier transform of acceleration.

    Attributes:
        frequency_hz: (n,) without zero [Hz].
        amplitude_m_s: (n,) absolute value of the transform [m/s].
    """

    frequency_hz: NDArray[np.float64]
    amplitude_m_s: NDArray[np.float64]


def oscillator_extremes(record: Record, period_s: float, damping_ratio: float) -> tuple[float, float]:
    """Return the largest and the smallest relative displacement of one oscillator [m].

    Args:
        record: The ground motion.
        period_s: Natural period [s].
        damping_ratio: Damping ratio [-].
    """
    peaks = oscillator_peaks(1 / period_s, damping_ratio, record.acceleration_m_s2, record.step_s)
    return float(peaks.maximum), float(peaks.minimum)


def _peaks(record: Record, period_s: float, damping_ratio: float) -> tuple[float, float, float]:
    """Return the largest relative displacement, relative velocity and absolute acceleration of an oscillator.

    With the pole p = w (-z + i sqrt(1 - z^2)) and y' = p y - a(t) the displacement is Im(y) / Im(p).
    """
    omega = 2 * np.pi / period_s
    pole = omega * complex(-damping_ratio, np.sqrt(1 - damping_ratio**2))
    parts = max(1, int(np.ceil(LOOKS_PER_PERIOD * record.step_s / period_s)))
    load = refine(-record.acceleration_m_s2, parts)
    state = run(np.array([pole]), load, record.step_s / parts)[0]
    displacement, velocity = state.imag / pole.imag, (pole * state).imag / pole.imag
    acceleration = 2 * damping_ratio * omega * velocity + omega**2 * displacement

    def peak(history: NDArray[np.float64]) -> float:
        return float(np.abs(history).max())

    return peak(displacement), peak(velocity), peak(acceleration)


def response_spectrum(
    record: Record, period_s: ArrayLike | None = None, damping_ratio: float = 0.05
) -> ResponseSpectrum:
    """Return the response spectrum of a record, the oscillators followed for one period after its end.

    Args:
        record: The ground motion.
        period_s: Natural periods (periods,) [s]; default: 200 from 4 steps of the record to a fifth of its
            duration, evenly in the logarithm.
        damping_ratio: Of every oscillator [-].

    Raises:
        ExperimentError: A period that is not positive, or a damping ratio outside [0, 1).
    """
    if period_s is None:
        period_s = np.geomspace(4 * record.step_s, max(8 * record.step_s, record.duration_s / 5), 200)
    periods = np.atleast_1d(np.asarray(period_s, dtype=float))
    if not (np.isfinite(periods).all() and (periods > 0).all() and 0 <= damping_ratio < 1):
        raise ExperimentError(
            f"response spectrum with damping ratio {damping_ratio}: periods must be positive, the ratio at"
            " least 0 and below 1"
        )
    peaks = np.array([_peaks(record.padded(period), float(period), damping_ratio) for period in periods])
    return ResponseSpectrum(periods, damping_ratio, *peaks.T)


def fourier_spectrum(record: Record, smoothing_hz: float = 0.0) -> FourierSpectrum:
    """Return the Fourier amplitude spectrum of a record's acceleration.

    Args:
        record: The ground motion; zeros are added up to a fast length of at least twice its own.
        smoothing_hz: Standard deviation of a Gaussian over the squared amplitude [Hz]; 0 leaves it as it is.
    """
    count = 1 << int(np.ceil(np.log2(2 * len(record.acceleration_m_s2))))
    amplitude = np.abs(np.fft.rfft(record.acceleration_m_s2, count)) * record.step_s
    frequency = np.fft.rfftfreq(count, record.step_s)
    if smoothing_hz > 0:
        power = gaussian_filter1d(amplitude**2, smoothing_hz / frequency[1], mode="nearest")
        amplitude = np.sqrt(np.maximum(power, 0))
    return FourierSpectrum(*np.asarray([frequency[1:], amplitude[1:]], dtype=np.float64))


def dominant_period(record: Record, by: str = "fourier", *, smoothing_hz: float = 0.0) -> float:
    """Return the predominant period of a motion [s].

    Args:
        record: The ground motion.
        by: `fourier`: period of the largest Fourier amplitude of acceleration (the predominant period of
            Kramer 1996, *Geotechnical Earthquake Engineering*, section 3.3.2); `response`: period of the
            largest absolute acceleration in the 5 % response spectrum.
        smoothing_hz: Smoothing of the Fourier spectrum [Hz], see `fourier_spectrum`.

    Raises:
        ExperimentError: Another method, or a record without motion.
    """
    if record.pga_m_s2 == 0:
        raise ExperimentError(f"record '{record.name}' is zero throughout: it has no dominant period")
    if by == "fourier":
        spectrum = fourier_spectrum(record, smoothing_hz)
        return float(1 / spectrum.frequency_hz[np.argmax(spectrum.amplitude_m_s)])
    if by == "response":
        response = response_spectrum(record)
        return float(response.period_s[np.argmax(response.acceleration_m_s2)])
    raise ExperimentError(f"dominant period by '{by}' is not known: use 'fourier' or 'response'")


def mean_period(record: Record, band_hz: tuple[float, float] = (0.25, 20.0)) -> float:
    """Return the mean of the Fourier periods weighted by the squared amplitude [s].

    Rathje, Abrahamson and Bray 1998, J. Geotech. Geoenviron. Eng. 124(2), take the band of 0.25 to 20 Hz at
    full scale; divide it by the time factor for a scaled record.

    Raises:
        ExperimentError: No motion inside the band.
    """
    spectrum = fourier_spectrum(record)
    inside = (spectrum.frequency_hz >= band_hz[0]) & (spectrum.frequency_hz <= band_hz[1])
    power = spectrum.amplitude_m_s[inside] ** 2
    if power.sum() == 0:
        raise ExperimentError(f"record '{record.name}' has no motion from {band_hz[0]} to {band_hz[1]} Hz")
    return float((power / spectrum.frequency_hz[inside]).sum() / power.sum())
