"""Response and Fourier spectra of a ground motion, and its dominant period.

The oscillator is integrated exactly for ground acceleration that is straight between its samples (Nigam and
Jennings 1969, Bull. Seism. Soc. Am. 59(2)), in the complex form of a first-order recursion, and looked at
often enough within each period that its peak is not missed between samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from experiments.errors import ExperimentError
from experiments.records.record import Record

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


def oscillator(
    acceleration_m_s2: ArrayLike, step_s: float, frequency_hz: float, damping_ratio: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the exact relative displacement [m] and velocity [m/s], each (m,), from rest.

    Solves x'' + 2 z w x' + w^2 x = -a(t), a piecewise linear: x = Im(y) / w_d with y' = p y - a and the pole
    p = w (-z + i sqrt(1 - z^2)).

    Raises:
        ExperimentError: A frequency that is not positive or a damping ratio outside [0, 1).
    """
    if frequency_hz <= 0 or not 0 <= damping_ratio < 1:
        raise ExperimentError(
            f"oscillator of {frequency_hz} Hz with damping ratio {damping_ratio}: need a positive"
            " frequency and a ratio from 0 to below 1"
        )
    omega = 2 * np.pi * frequency_hz
    pole = omega * (-damping_ratio + 1j * np.sqrt(1 - damping_ratio**2))
    old, new = _ramp_weights(pole * step_s)
    load = -np.asarray(acceleration_m_s2, dtype=float)
    # y(0) = 0: the first sample only counts as the start of the first interval.
    drive = np.concatenate(([0.0], step_s * (old * load[:-1] + new * load[1:])))
    y = lfilter([1.0], [1.0, -np.exp(pole * step_s)], drive)
    return y.imag / pole.imag, (pole * y).imag / pole.imag


def _ramp_weights(s: complex) -> tuple[complex, complex]:
    """Return the integrals over one step of exp(s (1 - u)) times (1 - u) and times u."""
    if abs(s) < 1e-2:  # the closed forms cancel here; five terms leave 1e-13
        new = 1 / 2 + s / 6 + s**2 / 24 + s**3 / 120 + s**4 / 720 + s**5 / 5040
        whole = 1 + s / 2 + s**2 / 6 + s**3 / 24 + s**4 / 120 + s**5 / 720
    else:
        whole = (np.exp(s) - 1) / s
        new = (np.exp(s) - 1 - s) / s**2
    return whole - new, new


def oscillator_extremes(record: Record, period_s: float, damping_ratio: float) -> tuple[float, float]:
    """Return the largest and the smallest relative displacement of one oscillator [m]."""
    displacement, _, _ = _fine_response(record, period_s, damping_ratio)
    return float(displacement.max()), float(displacement.min())


Histories = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def _fine_response(record: Record, period_s: float, damping_ratio: float) -> Histories:
    """Return displacement, velocity and absolute acceleration, looked at often enough for their peaks."""
    parts = max(1, int(np.ceil(LOOKS_PER_PERIOD * record.step_s / period_s)))
    fine = record.resampled(record.step_s / parts) if parts > 1 else record
    displacement, velocity = oscillator(fine.acceleration_m_s2, fine.step_s, 1 / period_s, damping_ratio)
    omega = 2 * np.pi / period_s
    return displacement, velocity, -(2 * damping_ratio * omega * velocity + omega**2 * displacement)


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
    if not (np.isfinite(periods).all() and (periods > 0).all()):
        raise ExperimentError("response spectrum: every period must be positive")
    histories = (_fine_response(record.padded(period), float(period), damping_ratio) for period in periods)
    peaks = np.array([[np.abs(part).max() for part in parts] for parts in histories])
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
        by: `fourier`: period of the largest Fourier amplitude of acceleration (Kramer 1996, section 3.3.2);
            `response`: period of the largest absolute acceleration in the 5 % response spectrum.
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
