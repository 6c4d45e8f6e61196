"""What a small force, input or sensor change does to the innovations: many at once through the steady filter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit

from pounding.diagnosis.model.kalman import SteadyFilter


@dataclass(frozen=True)
class Term:
    """One series acting along one direction.

    Attributes:
        series: Size at each sample, shape (samples,).
        force: Modal forces that a unit of it makes, shape (modes,), or None.
        output: What a unit of it adds to the channels by itself, shape (channels,), or None.
        end: Size at the end of the step before each sample, where it differs from `series` (a force that jumps when
            the state is corrected), shape (samples,), or None.
        table: What a unit of it adds to the table's own acceleration.
        inertial: The force comes from the table's motion, which an absolute acceleration does not show at once.
    """

    series: np.ndarray
    force: np.ndarray | None = None
    output: np.ndarray | None = None
    end: np.ndarray | None = None
    inertial: bool = False
    table: float = 0.0


def signatures(steady: SteadyFilter, groups: Sequence[Sequence[Term]], shown: np.ndarray) -> np.ndarray:
    """Return what the terms of each group add to the innovations, (samples, channels, groups), single precision.

    Args:
        steady: The filter.
        groups: Terms whose contributions are summed, group by group.
        shown: Matrix by which the innovations are multiplied, such as the one that whitens them, (channels, channels).

    This is the exact derivative of the one-step predictor for a force that is a series of its own states: the gain is
    fixed, and the state's change passes through the closed loop `step (1 - gain output)`.
    """
    terms = [term for group in groups for term in group]
    column = np.repeat(np.arange(len(groups)), [len(group) for group in groups])
    modes, channels = steady.force_start.shape[1] - 1, len(steady.output)
    force = np.zeros((modes + 1, len(terms)))
    output = np.zeros((channels, len(terms)))
    for j, term in enumerate(terms):
        if term.force is not None:
            force[:modes, j] = term.force
        force[modes, j] = term.table
        if term.output is not None:
            output[:, j] = term.output
    series = np.stack([term.series for term in terms], axis=1)
    at_end = np.stack([term.series if term.end is None else term.end for term in terms], axis=1)
    seen = np.array([not term.inertial for term in terms], float)
    direct = steady.direct @ force[:modes] * seen + output
    closed = steady.step @ (np.eye(len(steady.step)) - steady.gain @ steady.output)
    start = steady.force_start @ force
    back = -steady.step @ steady.gain @ direct
    end = steady.force_end @ force
    result = np.zeros((len(series), channels, len(groups)), np.float32)
    _filter(
        np.ascontiguousarray(closed),
        np.ascontiguousarray(shown @ steady.output),
        np.ascontiguousarray(start),
        np.ascontiguousarray(back),
        np.ascontiguousarray(end),
        np.ascontiguousarray(shown @ direct),
        series,
        at_end,
        column,
        result,
    )
    return result


@njit(cache=True)
def _filter(
    closed: np.ndarray,
    output: np.ndarray,
    start: np.ndarray,
    back: np.ndarray,
    end: np.ndarray,
    direct: np.ndarray,
    series: np.ndarray,
    at_end: np.ndarray,
    column: np.ndarray,
    result: np.ndarray,
) -> None:
    samples, terms = series.shape
    states = closed.shape[0]
    channels = output.shape[0]
    x = np.zeros((states, terms))
    new = np.empty((states, terms))
    y = np.empty((channels, terms))
    for k in range(samples):
        np.dot(output, x, y)
        for c in range(channels):
            for j in range(terms):
                result[k, c, column[j]] += y[c, j] + direct[c, j] * at_end[k, j]
        if k + 1 < samples:
            np.dot(closed, x, new)
            for i in range(states):
                for j in range(terms):
                    x[i, j] = (
                        new[i, j]
                        + start[i, j] * series[k, j]
                        + back[i, j] * at_end[k, j]
                        + end[i, j] * at_end[k + 1, j]
                    )
