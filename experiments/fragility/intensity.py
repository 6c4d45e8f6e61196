"""The intensity of a ground motion: one number that scales with its acceleration."""

from __future__ import annotations

from dataclasses import dataclass

from pounding.constants import STANDARD_GRAVITY
from pounding.experiments.records import Record
from pounding.experiments.records.spectra import response_spectrum

DAMPING = 0.05
"""Damping ratio of the spectral acceleration [-], that of all codes' spectra."""


@dataclass(frozen=True)
class Intensity:
    """What a ground motion's strength is measured by.

    Attributes:
        period_s: Period of the pseudo spectral acceleration [s]; None: the peak ground acceleration.
    """

    period_s: float | None = None

    @property
    def words(self) -> str:
        """What it is, with its unit."""
        if self.period_s is None:
            return "peak ground acceleration [g]"
        return f"spectral acceleration at {self.period_s:.3g} s, {100 * DAMPING:g} % damping [g]"

    def of(self, record: Record) -> float:
        """Return the intensity of a record [g].

        Args:
            record: The ground motion.
        """
        if self.period_s is None:
            return record.pga_g
        spectrum = response_spectrum(record, [self.period_s], DAMPING)
        return float(spectrum.pseudo_acceleration_m_s2[0]) / STANDARD_GRAVITY
