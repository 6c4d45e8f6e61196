"""A ground motion: uniformly sampled acceleration with its identity and what was done to it."""

from __future__ import annotations

import hashlib
import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding import bounds
from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.errors import ExperimentError
from pounding.scale import THESIS


@dataclass(frozen=True, eq=False)
class Record:
    """Acceleration of the ground, sampled uniformly and straight between the samples.

    Attributes:
        name: What it is called in results.
        acceleration_m_s2: Samples (m,), float64, read-only [m/s^2]; positive in +x.
        step_s: Time between samples [s].
        source: File or package it was read from.
        history: What was done to the samples since they were read, oldest first, one sentence each.

    Raises:
        ExperimentError: Fewer than two samples, a sample that is not finite or larger than any ground motion's, or
            a step that is not positive or no instrument's.
    """

    name: str
    acceleration_m_s2: NDArray[np.float64]
    step_s: float
    source: str = "memory"
    history: tuple[str, ...] = field(default=())

    def __post_init__(self) -> None:
        samples = np.array(self.acceleration_m_s2, dtype="<f8")
        if samples.ndim != 1 or len(samples) < 2:
            raise ExperimentError(
                f"record '{self.name}' from {self.source} has {samples.size} sample(s): a motion needs a row"
                " of at least two"
            )
        bad = np.flatnonzero(~np.isfinite(samples))
        if bad.size:
            raise ExperimentError(
                f"record '{self.name}' from {self.source}: sample {bad[0] + 1} of {len(samples)} is"
                f" {samples[bad[0]]} ({bad.size} not finite in all); repair the file"
            )
        here, largest = f"record '{self.name}' from {self.source}", int(np.abs(samples).argmax())
        bounds.GROUND.check(
            samples[largest], f"{here}: sample {largest + 1} of {len(samples)}", ExperimentError
        )
        bounds.STEP.check(self.step_s, f"{here}: the time step", ExperimentError)
        bounds.SAMPLES.check(len(samples), f"{here}: the number of samples", ExperimentError)
        bounds.DURATION.check(self.step_s * (len(samples) - 1), f"{here}: the duration", ExperimentError)
        samples.setflags(write=False)
        object.__setattr__(self, "acceleration_m_s2", samples)

    def __repr__(self) -> str:
        count = len(self.acceleration_m_s2)
        return f"Record({self.name!r}, {count} samples at {self.step_s:.4g} s, peak {self.pga_g:.3g} g)"

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of the samples [m/s^2] as little-endian float64, whatever file they came in."""
        return hashlib.sha256(self.acceleration_m_s2.tobytes()).hexdigest()

    @cached_property
    def pga_m_s2(self) -> float:
        """Largest absolute acceleration [m/s^2]."""
        return float(np.abs(self.acceleration_m_s2).max())

    @property
    def pga_g(self) -> float:
        """Largest absolute acceleration [g]."""
        return self.pga_m_s2 / STANDARD_GRAVITY

    @property
    def duration_s(self) -> float:
        """Time from the first to the last sample [s]."""
        return self.step_s * (len(self.acceleration_m_s2) - 1)

    @property
    def time_s(self) -> NDArray[np.float64]:
        """Time of each sample (m,), from zero [s]."""
        return self.step_s * np.arange(len(self.acceleration_m_s2), dtype=np.float64)

    def scaled(self, time_factor: float, pga_g: float | None = None) -> Record:
        """Return the record with time multiplied by `time_factor` and, if asked, another peak.

        Args:
            time_factor: New time over old time [-]: that of the frames' scale, 1 at full scale; see `pounding.scale`.
            pga_g: Wanted peak [g]; None leaves the samples as they are.

        Raises:
            ExperimentError: A factor or peak that is not positive, or zeros to be scaled to a peak.
        """
        if not (math.isfinite(time_factor) and time_factor > 0):
            raise ExperimentError(f"time factor {time_factor} of record '{self.name}': it must be positive")
        samples, done = self.acceleration_m_s2, []
        if time_factor != 1:
            done.append(_time_multiplied(time_factor))
        if pga_g is not None:
            samples = samples * self._factor_to(pga_g)
            done.append(f"peak scaled from {self.pga_g:.4g} g to {pga_g:.4g} g")
        return self._changed(samples, *done, step_s=self.step_s * time_factor)

    @property
    def is_as_in_the_laboratory(self) -> bool:
        """Whether its time was brought to the scale of the thesis' frames and its peak left as it was."""
        return _time_multiplied(THESIS.time_factor) in self.history and not any(
            "peak scaled" in step for step in self.history
        )

    def _factor_to(self, pga_g: float) -> float:
        if not (math.isfinite(pga_g) and pga_g > 0):
            raise ExperimentError(f"peak of {pga_g} g asked of record '{self.name}': it must be positive")
        if self.pga_m_s2 == 0:
            raise ExperimentError(
                f"record '{self.name}' from {self.source} is zero throughout: no scaling to {pga_g} g"
            )
        return pga_g * STANDARD_GRAVITY / self.pga_m_s2

    def flipped(self) -> Record:
        """Return the record with the opposite polarity."""
        return self._changed(-self.acceleration_m_s2, "sign reversed")

    def padded(self, after_s: float) -> Record:
        """Return the record followed by at least `after_s` [s] of rest, in which a frame rings down."""
        zeros = np.zeros(math.ceil(after_s / self.step_s - 1e-9))
        return self._changed(np.append(self.acceleration_m_s2, zeros), f"followed by {after_s:.6g} s of rest")

    def resampled(self, step_s: float) -> Record:
        """Return the record at another time step [s].

        A finer step interpolates linearly: with a step that divides the old one the motion stays the same.
        A coarser one is first freed from what it cannot carry, by a zero-phase Butterworth filter of order 8
        at 0.8 of its Nyquist frequency. The end of the record may move by less than one step.
        """
        if not (math.isfinite(step_s) and step_s > 0):
            raise ExperimentError(f"time step {step_s} s asked of record '{self.name}': it must be positive")
        count = int(self.duration_s / step_s * (1 + 1e-12) + 1e-9) + 1
        if count < 2:
            raise ExperimentError(
                f"time step {step_s} s is longer than record '{self.name}' ({self.duration_s:.4g} s)"
            )
        samples, how = self.acceleration_m_s2, "linear"
        if step_s > self.step_s * (1 + 1e-9):
            from scipy.signal import butter, sosfiltfilt  # only here: importing it takes half a second

            filter_ = butter(4, 0.8 * self.step_s / step_s, output="sos")
            samples = sosfiltfilt(filter_, samples, padlen=min(len(samples) - 1, 27))
            how = "low-pass filtered, then linear"
        samples = np.interp(step_s * np.arange(count), self.time_s, samples)
        return self._changed(
            samples, f"resampled from {self.step_s:.6g} s to {step_s:.6g} s ({how})", step_s=step_s
        )

    def baseline_corrected(self, degree: int = 1) -> Record:
        """Return the record without drift.

        A polynomial of the given degree through zero at the start is fitted to the velocity by least squares
        and its derivative is taken off the acceleration: degree 1 removes a constant offset, 2 also a trend
        (Boore 2001, Bull. Seism. Soc. Am. 91(5), the single-line form).

        Raises:
            ExperimentError: A degree below 1 or not below the number of samples.
        """
        if not 1 <= degree < len(self.acceleration_m_s2):
            raise ExperimentError(f"baseline of degree {degree} of record '{self.name}': need at least 1")
        from scipy.integrate import cumulative_trapezoid

        u = np.linspace(0, 1, len(self.acceleration_m_s2))
        velocity = cumulative_trapezoid(self.acceleration_m_s2, dx=u[1], initial=0)
        powers = np.arange(1, degree + 1)
        fit = np.linalg.lstsq(u[:, None] ** powers, velocity, rcond=None)[0]
        drift = (powers * fit) @ (u[:, None] ** (powers - 1)).T
        done = f"baseline of degree {degree} in velocity removed"
        return self._changed(self.acceleration_m_s2 - drift, done)

    def trimmed(
        self,
        criterion: str = "arias",
        *,
        lower: float = 0.001,
        upper: float = 0.999,
        threshold_g: float = 0.05,
    ) -> Record:
        """Return the strong part of the record; the criterion is kept in the history.

        Args:
            criterion: `arias`: from where the integral of squared acceleration passes the fraction `lower`
                of its end value to where it passes `upper` (0.05 and 0.95: significant duration of Trifunac
                and Brady 1975); `bracket`: from the first to the last sample of at least `threshold_g`
                (Bolt 1973).
            lower: Fraction of the Arias intensity before the start [-].
            upper: Fraction of the Arias intensity before the end [-].
            threshold_g: Acceleration of the bracket [g].

        Raises:
            ExperimentError: An unknown criterion, fractions out of order, or nothing left.
        """
        if criterion == "arias":
            if not 0 <= lower < upper <= 1:
                raise ExperimentError(f"Arias fractions {lower} and {upper}: need 0 <= lower < upper <= 1")
            inside = self._arias_between(lower, upper)
            done = f"trimmed to {lower:.4g} to {upper:.4g} of the Arias intensity"
        elif criterion == "bracket":
            inside = np.flatnonzero(np.abs(self.acceleration_m_s2) >= threshold_g * STANDARD_GRAVITY)
            done = f"trimmed to the bracket of {threshold_g:.4g} g"
        else:
            raise ExperimentError(f"trimming criterion '{criterion}' is not known: use 'arias' or 'bracket'")
        if inside.size < 2:
            raise ExperimentError(f"record '{self.name}' {done} keeps {inside.size} sample(s)")
        kept = self.acceleration_m_s2[inside[0] : inside[-1] + 1]
        start, end = inside[[0, -1]] * self.step_s
        return self._changed(kept, f"{done}: {start:.6g} s to {end:.6g} s")

    def _arias_between(self, lower: float, upper: float) -> NDArray[np.intp]:
        from scipy.integrate import cumulative_trapezoid

        energy = cumulative_trapezoid(self.acceleration_m_s2**2, initial=0)
        if energy[-1] == 0:
            return np.empty(0, dtype=np.intp)
        energy = energy / energy[-1]
        return np.flatnonzero((energy >= lower) & (energy <= upper))

    def renamed(self, name: str, *notes: str) -> Record:
        """Return the record under another name, with notes added to its history."""
        return replace(self, name=name, history=(*self.history, *notes))

    def _changed(self, samples: ArrayLike, *done: str, step_s: float | None = None) -> Record:
        return replace(
            self,
            acceleration_m_s2=np.asarray(samples, dtype=np.float64),
            step_s=self.step_s if step_s is None else step_s,
            history=(*self.history, *done),
        )


def _time_multiplied(factor: float) -> str:
    return f"time multiplied by {factor:.6g}"
