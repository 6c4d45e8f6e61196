"""How large a figure becomes by chance: the upper tail of what simulated nulls showed."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.stats import chi2, norm

from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class Tail:
    """The upper tail of a figure over nulls: exponential above its upper quartile, as that of an ln Bayes factor is.

    The mean excess is its upper confidence limit, so that few nulls ask for more.

    Attributes:
        values: The figure of each null, in increasing order.
    """

    values: tuple[float, ...]

    @cached_property
    def _begin(self) -> float:
        return float(np.quantile(self.values, 1.0 - SETTINGS.decision.tail))

    @cached_property
    def _share(self) -> float:
        return float(np.mean(np.array(self.values) > self._begin))

    @cached_property
    def _mean_excess(self) -> float:
        excess = np.array([value - self._begin for value in self.values if value > self._begin])
        # A sum of m exponential excesses over their mean is half a chi-square of 2 m degrees of freedom.
        return float(2.0 * excess.sum() / chi2.ppf(1.0 - SETTINGS.decision.tail_sure, 2 * len(excess)))

    def exceeded_by(self, rate: float) -> float:
        """Return what a share of the nulls exceeds.

        Args:
            rate: The share.
        """
        if rate >= self._share or not self._share:
            return float(np.quantile(self.values, 1.0 - rate))
        return self._begin + self._mean_excess * float(np.log(self._share / rate))

    def probability(self, value: float) -> float:
        """Return the share of the nulls that show as much.

        Args:
            value: The figure.
        """
        if value <= self._begin or not self._share:
            return float((1 + np.sum(np.array(self.values) >= value)) / (1 + len(self.values)))
        return self._share * float(np.exp(-(value - self._begin) / self._mean_excess))


@dataclass(frozen=True)
class FalseAlarms:
    """The rate of false alarms that a verdict may have, and the nulls by which it is met.

    Attributes:
        rate: Share of the cases without an effect in which one is named or something is said to remain; half for each.
        evidence: Largest ln Bayes factor of a single effect.
        left: Misfit that remains over the noise floor.
        source: Where the nulls come from.
        candidates: How many effects are tried.
    """

    rate: float
    evidence: Tail
    left: Tail
    source: str
    candidates: int = 1

    @property
    def needed(self) -> float:
        """The ln Bayes factor that an effect needs to be named.

        It is more than nulls show, and enough where that something is missing is as likely beforehand as that nothing is,
        and each candidate as likely as another.
        """
        alarms = self.rate / 2
        return max(self.evidence.exceeded_by(alarms), float(np.log(self.candidates / alarms)))

    @property
    def from_none(self) -> float:
        """So many standard errors from none the size of any candidate is by chance, at half the rate of false alarms."""
        return float(norm.isf(self.rate / 4 / self.candidates))

    @property
    def most_by_chance(self) -> float:
        """The misfit over the noise floor that no more nulls exceed than may raise an alarm by it."""
        return self.left.exceeded_by(self.rate / 2)

    def too_much(self, left: float) -> bool:
        """Return whether a misfit is more than nulls leave.

        Args:
            left: The misfit over the noise floor.
        """
        return self.left.probability(left) < self.rate / 2
