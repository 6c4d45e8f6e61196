"""The scale of the model discrepancy: how far a frame may be from its model in ways that no storey's parameter gives.

The scale is not known beforehand. Its prior is the same for each of `SCALES`, a factor of two apart (uniform in the
logarithm); evidence is the mean over them. What only imitates errors of the model so loses to these errors, and what makes
them needless gains by it (Kennedy and O'Hagan 2001; Beck 2010).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

SCALES = 1e-4 * 2.0 ** np.arange(9)
"""Scales of the discrepancy that are possible [-]: from nothing to speak of to 2.6 % of the modes' stiffness."""


def wider(discrepant: np.ndarray, parameters: int, factor: float) -> np.ndarray:
    """Return by how much each parameter's prior is wider where the discrepancy's is so by a factor, shape (parameters,).

    Args:
        discrepant: Which of the first parameters make the discrepancy, shape (nuisance,).
        parameters: How many parameters there are.
        factor: The factor.
    """
    by = np.ones(parameters)
    by[: len(discrepant)][discrepant] = factor
    return by


@dataclass(frozen=True)
class Linearised:
    """A fit that is linear about `theta`, in units of the priors at one scale of the discrepancy.

    Attributes:
        gram: Information of the data, shape (parameters, parameters).
        slope: Slope of the data, shape (parameters,).
        theta: Parameters, shape (parameters,).
        discrepant: Which of the first of them make the discrepancy, shape (nuisance,).
        scale: Scale of the discrepancy in whose units they are [-].
    """

    gram: np.ndarray
    slope: np.ndarray
    theta: np.ndarray
    discrepant: np.ndarray
    scale: float

    def log_weights(self) -> np.ndarray:
        """Return the log evidence at each of `SCALES`, up to what is common, shape (scales,)."""
        return np.array([self._log_weight(one / self.scale) for one in SCALES])

    def likelier(self) -> list[float]:
        """Return those of `SCALES` that have more evidence than the own one [-], the likeliest first."""
        weights = self.log_weights()
        return [float(SCALES[i]) for i in np.argsort(-weights) if weights[i] > self._log_weight(1.0)]

    def gained(self) -> float:
        """Return the log evidence averaged over `SCALES` less that at the own scale; nothing without a discrepancy.

        The own scale is to be the likeliest: where slopes promise more of another one, they are those of no maximum, and
        nothing is gained.
        """
        if not self.discrepant.any():
            return 0.0
        return min(averaged(self.log_weights()) - self._log_weight(1.0), 0.0)

    def _log_weight(self, factor: float) -> float:
        by = wider(self.discrepant, len(self.theta), factor)
        there = self.theta / by
        information = self.gram * np.outer(by, by) + np.eye(len(by))
        pull = self.slope * by - there
        gained = 0.5 * float(pull @ np.linalg.solve(information, pull))
        return gained - 0.5 * float(there @ there) - 0.5 * float(np.linalg.slogdet(information)[1])


def averaged(log_evidence: np.ndarray) -> float:
    """Return the log evidence averaged over the scales.

    Args:
        log_evidence: Log evidence at each of `SCALES`, shape (scales,).
    """
    return float(logsumexp(log_evidence) - np.log(len(SCALES)))
