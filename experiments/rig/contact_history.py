"""What a contact of a run leaves: its deformation, its force, and when it touched."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicHermiteSpline

from pounding.contact.laws import Law

Real = NDArray[np.floating]


@dataclass(frozen=True, eq=False)
class ContactHistory:
    """One contact through a run, at any moment: deformation, its rate, and the force of the law.

    Attributes:
        floor: Floor of the left frame; a number between two floors is a place on its columns.
        left, right: Names of the frames.
        gap_m: Gap at rest [m].
        y_m: Place along the floors' edge [m].
        law: The law.
        time_s: The integrator's steps (m,) [s].
        deformation_m: Overlap at the steps (m,) [m]; negative while apart.
        rate_m_s: Its rate (m,) [m/s].
        rate_change_m_s2: The rate's derivative (m,) [m/s^2].
        right_floor: Floor of the right frame; that of the left one when None.
    """

    floor: float
    left: str
    right: str
    gap_m: float
    y_m: float
    law: Law
    time_s: Real
    deformation_m: Real
    rate_m_s: Real
    rate_change_m_s2: Real
    right_floor: float | None = None

    def __repr__(self) -> str:
        return (
            f"ContactHistory(floor {self.floor} of {self.left!r} beside {self.right!r}, gap {1e3 * self.gap_m:.4g} mm, "
            f"{self.law.name}, {len(self.touches[0])} touches)"
        )

    @cached_property
    def _splines(self) -> tuple[CubicHermiteSpline, CubicHermiteSpline]:
        return (
            CubicHermiteSpline(self.time_s, self.deformation_m, self.rate_m_s),
            CubicHermiteSpline(self.time_s, self.rate_m_s, self.rate_change_m_s2),
        )

    @cached_property
    def touches(self) -> tuple[Real, Real]:
        """Times of first touch (k,) [s] and the approach velocities there (k,) [m/s]."""
        steps = np.flatnonzero((self.deformation_m[:-1] <= 0.0) & (self.deformation_m[1:] > 0.0))
        before, after = self.deformation_m[steps], self.deformation_m[steps + 1]
        part = before / (before - after)
        times = self.time_s[steps] + part * np.diff(self.time_s)[steps]
        rates = self.rate_m_s[steps] + part * (self.rate_m_s[steps + 1] - self.rate_m_s[steps])
        return times, rates

    def at(self, times_s: ArrayLike) -> tuple[Real, Real, Real]:
        """Return deformation [m], rate [m/s] and force [N] at any times (k,) [s]."""
        times = np.asarray(times_s, float)
        deformation, rate = (spline(times) for spline in self._splines)
        return deformation, rate, np.asarray(self.law.force(deformation, rate, self._approach(times)), float)

    def _approach(self, times: Real) -> Real:
        touched, rates = self.touches
        if not len(touched):
            return np.zeros_like(times)
        # A whisker early: the moment of touch on the curve and on the straight line differ a little.
        latest = np.searchsorted(touched - 5e-6, times, side="right") - 1
        return np.where(latest >= 0, rates[np.maximum(latest, 0)], 0.0)

    def sampled(self, rate_hz: float = 10_000.0) -> tuple[Real, Real]:
        """Return times (k,) [s] and forces (k,) [N] as a force sensor sampled at `rate_hz` gives them."""
        times = np.arange(self.time_s[0], self.time_s[-1], 1.0 / rate_hz)
        force = np.zeros(len(times))
        touching = self._near(times, 1.0 / rate_hz)
        if touching.any():
            force[touching] = self.at(times[touching])[2]
        return times, force

    @cached_property
    def pulses(self) -> list[tuple[float, float]]:
        """First touch and parting [s] of each time in which the deformation is positive."""
        return [(self._zero(a - 1), self._zero(b - 1)) for a, b in _runs(self.deformation_m > 0.0)]

    def _zero(self, step: int) -> float:
        """Time [s] at which the deformation passes zero in a step, on the straight line."""
        if step < 0 or step + 1 >= len(self.time_s):
            return float(self.time_s[0 if step < 0 else -1])
        before, after = self.deformation_m[step], self.deformation_m[step + 1]
        return float(
            self.time_s[step] + before / (before - after) * (self.time_s[step + 1] - self.time_s[step])
        )

    def pulse(self, first_s: float, last_s: float) -> tuple[Real, Real, Real, Real]:
        """Return times [s], deformation [m], rate [m/s] and force [N] of a contact, each step of the engine cut in eight."""
        first, last = np.searchsorted(self.time_s, [first_s, last_s], side="right")
        inner = self.time_s[first:last]
        ends = np.concatenate([[first_s], inner[inner < last_s], [last_s]])
        times = np.interp(np.arange(8 * (len(ends) - 1) + 1) / 8, np.arange(len(ends)), ends)
        return times, *self.at(times)

    def _near(self, times: Real, margin: float) -> NDArray[np.bool_]:
        """Which times lie in or next to a step with contact: only there is the force worth computing."""
        closed = self.deformation_m > 0.0
        either = closed[:-1] | closed[1:]
        place = np.clip(np.searchsorted(self.time_s, times, side="right") - 1, 0, len(either) - 1)
        return either[place]


def _runs(inside: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """Return (first, one past the last) index of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], inside, [False]])))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
