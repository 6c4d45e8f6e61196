"""What no linear frame gives of a motion: the yardstick of a model error that no calibration takes away."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares
from scipy.signal import bilinear, lfilter

FREE_MODES = 5
"""Lowest modes whose frequencies and damping ratios are fitted; those above keep theirs."""

WEIGHTS = np.array([0.01, 0.2])
"""Size of a usual step of a frequency and of a damping ratio (logarithms)."""

STEPS = 12
SHIFTS = np.array([0.0, 1.0, -0.5, -1.0, -2.0, -3.0, -4.0, -6.0])
"""Where the fit may start: all frequencies shifted alike, in the sizes above; what slips is softer in the mean."""

ENOUGH_HZ = 400.0
"""Rate at which a motion is compared [Hz]: a table moves up to 60 Hz."""


@dataclass(frozen=True)
class Seen:
    """A run as its sensors see it, without noise.

    Attributes:
        step_s: Time between samples [s].
        table: Acceleration of the table [m/s^2], shape (samples,).
        table_moved: Its displacement [m], shape (samples,).
        channels: What the sensors on one frame read, in SI, shape (samples, channels).
    """

    step_s: float
    table: np.ndarray
    table_moved: np.ndarray
    channels: np.ndarray


def beyond_linear(runs: Sequence[Seen], hz: np.ndarray, ratios: np.ndarray) -> np.ndarray:
    """Return the misfit over the motion that the best linear frame leaves, root mean square, shape (channels,).

    The linear frame has as many modes as are given. The frequency and damping of the lowest are free, and so are the
    share and phase of every mode in every channel, the same in all runs: more than any stiffness, mass or damping
    matrix of it could do.

    Args:
        runs: The runs, each of which counts alike.
        hz: Natural frequencies where the fit starts [Hz], shape (modes,).
        ratios: Damping ratios there, shape (modes,).
    """
    free = min(FREE_MODES, len(hz))
    thin = max(int(1 / (runs[0].step_s * ENOUGH_HZ)), 1)
    sizes = [float(np.sqrt(np.mean(run.table**2))) for run in runs]
    wanted = np.vstack([run.channels[::thin] / size for run, size in zip(runs, sizes, strict=True)])
    motion = np.sqrt(np.mean((wanted - wanted.mean(axis=0)) ** 2, axis=0))
    wanted = wanted / motion

    # A step of the fit moves one mode, and most modes never move.
    @lru_cache(maxsize=2 * len(runs) * len(hz))
    def mode(run: int, at_hz: float, ratio: float) -> np.ndarray:
        return np.asarray(_mode(runs[run], at_hz, ratio)[::thin] / sizes[run])

    fixed = [_table(run)[::thin] / size for run, size in zip(runs, sizes, strict=True)]

    def left(moved: np.ndarray) -> np.ndarray:
        steps = np.zeros((2, len(hz)))
        steps[:, :free] = moved.reshape(2, free) * WEIGHTS[:, None]
        at = (np.exp(steps) * np.array([hz, ratios])).T.tolist()
        columns = [
            np.column_stack([table, *(mode(run, *one) for one in at)]) for run, table in enumerate(fixed)
        ]
        basis, _ = np.linalg.qr(_scaled(np.vstack(columns)))
        return np.asarray(wanted - basis @ (basis.T @ wanted))

    # With light damping a frequency that is off by more than that is out of step, and no descent leads back.
    starts = [np.repeat([shift, 0.0], free) for shift in SHIFTS]
    start = min(starts, key=lambda moved: float(np.sum(left(moved) ** 2)))
    fit = least_squares(lambda moved: left(moved).ravel(), start, diff_step=1e-3, x_scale=1.0, max_nfev=STEPS)
    return np.asarray(np.sqrt(np.mean(left(fit.x) ** 2, axis=0)))


def _table(run: Seen) -> np.ndarray:
    """Return what a sensor reads of the table itself, shape (samples, 3)."""
    return np.column_stack([run.table, run.table_moved, np.ones_like(run.table)])


def _mode(run: Seen, hz: float, ratio: float) -> np.ndarray:
    """Return how a mode moves and how fast, shape (samples, 2)."""
    circular = 2 * np.pi * hz
    below = [1.0, 2 * ratio * circular, circular**2]
    # The bilinear transform is Newmark's average acceleration.
    return np.column_stack(
        [lfilter(*bilinear(above, below, 1 / run.step_s), run.table) for above in ([-1.0], [-1.0, 0.0])]
    )


def _scaled(columns: np.ndarray) -> np.ndarray:
    return np.asarray(columns / np.sqrt(np.mean(columns**2, axis=0)))
