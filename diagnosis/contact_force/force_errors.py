"""What samples get wrong of a contact force, as the frames' motion tells it.

An impact lasts a millisecond or two, and a logger takes as many samples of it: what its filter lets through beyond half
its rate is folded back, a cell rings, and a force that is off by a hundredth makes the highest modes ring by more than an
accelerometer's noise. So the force at each sample in a touch is an unknown that is known within a share of its size; the
share is the one that makes the motion likeliest, and a force is put right by what motion and share say together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.ndimage import maximum_filter1d

from pounding.diagnosis.contact_force import pairs
from pounding.diagnosis.inference.filtering import Baseline, descend, matched_noise, run_baseline
from pounding.diagnosis.inference.misfit import expected_noise
from pounding.diagnosis.inference.refine import refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Believed
from pounding.diagnosis.model.observations import RunData

SHARES = (0.003, 0.01, 0.03, 0.1)
"""Shares of a contact force's size within which its samples may be known."""
NEAR_SAMPLES = 2
"""How far from a sample the size of a force is looked for: an error in time is one where the force has just ended too."""
LEAST = 1e-3
"""Share of a run's largest force below which it is taken as it is."""
ROUNDS = 3
"""How often errors, frames and noise are found in turn: what a wrong force leaves counts as noise of the struck floors at
first."""


@dataclass(frozen=True)
class _Touching:
    """Samples of a run at which floors touch, sizes of the force about them [N], and what the motion says there.

    Attributes:
        samples: Numbers of the samples, shape (n,).
        size: Size of the force [N], shape (n,).
        pull: Slope of the log likelihood with the force where it has no errors, (n,).
        own: Its curvature, (n, n).
    """

    samples: np.ndarray
    size: np.ndarray
    pull: np.ndarray
    own: np.ndarray

    def within(self, share: float) -> tuple[np.ndarray, float]:
        """Return the posterior mean of the force's errors [N], (n,), and the log evidence of there being any [nats].

        Beforehand they are independent and Gaussian, of a standard deviation that is a share of the force's size.
        """
        width = share * self.size
        factor = cho_factor(width[:, None] * self.own * width + np.eye(len(width)))
        found = cho_solve(factor, width * self.pull)
        nats = 0.5 * float(width * self.pull @ found) - float(np.log(np.diag(factor[0])).sum())
        return width * found, nats


def put_right(
    believed: Believed, training: Sequence[int], measured: bool = True
) -> tuple[Believed, Baseline | None]:
    """Return the model with contact forces in all runs as the motion of calibrated frames corrects them, and these frames.

    Args:
        believed: The believed model below `pairs.RATE_HZ`.
        training: The runs that the frames are calibrated to.
        measured: Whether cells measured the forces, none of which is missed then: what the motion tells of those in the
            other runs, to which nothing is fitted, is not uncertain any more.
    """
    observed = believed.observed
    if not any(np.any(run.contact) for run in observed.runs):
        return believed, None
    if measured:
        touches = tuple(touch for touch in observed.touches if touch.run in training)
        believed = Believed(believed.structure, replace(observed, touches=touches), believed.prior)
    baseline = calibrated(believed, training)
    better, baseline = _told(believed, believed, baseline, training, ROUNDS - 1)
    # What wrong forces needed to be explained holds a calibration back that begins with it.
    fits = [refine(better, start, (), (), ()) for start in (baseline, calibrated(better, training))]
    baseline = max(fits, key=lambda fit: fit.log_posterior).baseline
    return _told(believed, better, baseline, training, 1)


def put_right_by(believed: Believed, corrected: Believed, baseline: Baseline) -> tuple[Believed, Baseline]:
    """Return the model with contact forces as frames with effects correct them, and these frames.

    Forces that frames without an effect have put right keep a part of it.

    Args:
        believed: The model with the forces as they were measured or found.
        corrected: The same with those about which the effects were fitted.
        baseline: The fit, with its effects.
    """
    return _told(believed, corrected, baseline, baseline.runs, ROUNDS)


def _told(
    believed: Believed, better: Believed, baseline: Baseline, training: Sequence[int], rounds: int
) -> tuple[Believed, Baseline]:
    """Return the model with errors of its forces as a baseline tells them that works with those of `better`."""
    pairs_of_runs = zip(better.observed.runs, believed.observed.runs, strict=True)
    errors = [one.contact - run.contact for one, run in pairs_of_runs]
    for _ in range(rounds):
        for column in range(len(believed.observed.contact_floors)):
            _estimate(believed, (better, _of_all_runs(better, baseline)), column, training, errors)
            better = _with_errors(believed, errors)
        baseline = _quieter(better, baseline)
    return better, baseline


def _quieter(believed: Believed, baseline: Baseline) -> Baseline:
    """Return frames and noise of each channel as they are with better forces."""
    start = run_baseline(believed, baseline.values, baseline.noise, baseline.runs, baseline.effects)
    noise = matched_noise(believed, start)
    start = run_baseline(believed, start.values, noise, start.runs, start.effects)
    return descend(believed, start, 2)


def _of_all_runs(believed: Believed, baseline: Baseline) -> Baseline:
    """Return a baseline with the runs that it was not fitted to, whose noise is as large a share of their channels."""
    runs = range(len(believed.observed.runs))
    known = dict(zip(baseline.runs, baseline.noise, strict=True))
    noise = [
        known.get(run) or one for run, one in zip(runs, expected_noise(believed, baseline, runs), strict=True)
    ]
    return run_baseline(believed, baseline.values, noise, runs, baseline.effects)


def _estimate(
    believed: Believed,
    better: tuple[Believed, Baseline],
    column: int,
    training: Sequence[int],
    errors: list[np.ndarray],
) -> None:
    """Put a column of `errors`, (samples, contacts) of each run, to what a filter says that works with those so far."""
    corrected, baseline = better
    left, right = believed.observed.contact_floors[column]
    told = pairs.answers(corrected, baseline, baseline.modes.floors[right] - baseline.modes.floors[left])
    each = [
        _touching(run.contact[:, column], error[:, column], *answer)
        for run, error, answer in zip(believed.observed.runs, errors, told, strict=True)
    ]
    nats = {share: sum(each[run].within(share)[1] for run in training) for share in SHARES}
    share = max(nats, key=lambda one: nats[one])
    for error, one in zip(errors, each, strict=True):
        error[:, column] = 0.0
        if nats[share] > 0.0:
            error[one.samples, column] = one.within(share)[0]


def _touching(force: np.ndarray, error: np.ndarray, matched: np.ndarray, own: np.ndarray) -> _Touching:
    size = maximum_filter1d(np.abs(force), 2 * NEAR_SAMPLES + 1, mode="constant")
    samples = np.flatnonzero(size > LEAST * size.max())
    lag = np.abs(samples[:, None] - samples[None, :])
    curvature = np.where(lag < len(own), own[np.minimum(lag, len(own) - 1)], 0.0)
    return _Touching(samples, size[samples], matched[samples] + curvature @ error[samples], curvature)


def _with_errors(believed: Believed, errors: Sequence[np.ndarray]) -> Believed:
    """Return the model with errors (samples, contacts) of each run added to its contact forces."""
    runs = [_added(run, error) for run, error in zip(believed.observed.runs, errors, strict=True)]
    return Believed(believed.structure, replace(believed.observed, runs=tuple(runs)), believed.prior)


def _added(run: RunData, error: np.ndarray) -> RunData:
    if run.fine_contact is None:
        return replace(run, contact=run.contact + error)
    # The filter sees an error as lines between samples, and so does the finer grid.
    at, finer = np.arange(len(error)) * run.step_s, np.arange(len(run.fine_contact)) * run.fine_step_s
    fine = np.stack([np.interp(finer, at, column) for column in error.T], axis=1)
    return replace(run, contact=run.contact + error, fine_contact=run.fine_contact + fine)
