"""The scale of the model discrepancy: how far a frame may be from its model in ways that no storey's parameter gives.

The scale is not known beforehand. Its prior is the same for each of `SCALES`, a factor of two apart (uniform in the
logarithm); evidence is the mean over them. What only imitates errors of the model so loses to these errors, and what makes
them needless gains by it (Kennedy and O'Hagan 2001; Beck 2010).
"""

from __future__ import annotations

import numpy as np
from scipy.special import logsumexp

SCALES = 1e-4 * 2.0 ** np.arange(9)
"""Scales of the discrepancy that are possible [-]: from nothing to speak of to 2.6 % of the modes' stiffness."""


def log_weights(
    gram: np.ndarray, slope: np.ndarray, theta: np.ndarray, discrepant: np.ndarray, scale: float
) -> np.ndarray:
    """Return the log evidence at each of `SCALES` of a fit that is linear about `theta`, up to what is common, (scales,).

    Args:
        gram: Information of the data, shape (parameters, parameters), in units of the priors at `scale`.
        slope: Slope of the data, shape (parameters,).
        theta: Parameters, shape (parameters,).
        discrepant: Which of the first of them make the discrepancy, shape (nuisance,).
        scale: Scale of the discrepancy in whose units they are [-].
    """
    return np.array([_log_weight(gram, slope, theta, discrepant, one / scale) for one in SCALES])


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


def _log_weight(
    gram: np.ndarray, slope: np.ndarray, theta: np.ndarray, discrepant: np.ndarray, factor: float
) -> float:
    by = wider(discrepant, len(theta), factor)
    there = theta / by
    information = gram * np.outer(by, by) + np.eye(len(gram))
    pull = slope * by - there
    gained = 0.5 * float(pull @ np.linalg.solve(information, pull))
    return gained - 0.5 * float(there @ there) - 0.5 * float(np.linalg.slogdet(information)[1])


def likeliest_scale(
    gram: np.ndarray, slope: np.ndarray, theta: np.ndarray, discrepant: np.ndarray, scale: float
) -> float:
    """Return the one of `SCALES` with most evidence; arguments as of `log_weights`."""
    return float(SCALES[np.argmax(log_weights(gram, slope, theta, discrepant, scale))])


def gained_by_any_scale(
    gram: np.ndarray, slope: np.ndarray, theta: np.ndarray, discrepant: np.ndarray, scale: float
) -> float:
    """Return log evidence averaged over the scales less that at `scale`; other arguments as of `log_weights`."""
    if not discrepant.any():
        return 0.0
    weights = log_weights(gram, slope, theta, discrepant, scale)
    return averaged(weights) - _log_weight(gram, slope, theta, discrepant, 1.0)


def averaged(log_evidence: np.ndarray) -> float:
    """Return the log evidence averaged over the scales.

    Args:
        log_evidence: Log evidence at each of `SCALES`, shape (scales,).
    """
    return float(logsumexp(log_evidence) - np.log(len(SCALES)))
