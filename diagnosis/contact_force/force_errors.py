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
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.likeliest_noise import likeliest_noise
from pounding.diagnosis.inference.misfit import expected_noise
from pounding.diagnosis.inference.refine import Fit, calibrated_further, refine
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.settings import SETTINGS


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
        """Return the posterior mean of the force's errors [N], (n,), and the ln Bayes factor of there being any.

        Beforehand they are independent and Gaussian, of a standard deviation that is a share of the force's size.
        """
        width = share * self.size
        factor = cho_factor(width[:, None] * self.own * width + np.eye(len(width)))
        found = cho_solve(factor, width * self.pull)
        ln_bayes = 0.5 * float(width * self.pull @ found) - float(np.log(np.diag(factor[0])).sum())
        return width * found, ln_bayes


def put_right(model: Model, training: Sequence[int], measured: bool = True) -> tuple[Model, Filtered | None]:
    """Return the model with contact forces in all runs as the motion of calibrated frames corrects them, and these frames.

    Args:
        model: The baseline model below `forces.rate_hz`.
        training: The runs that the frames are calibrated to.
        measured: Whether cells measured the forces, none of which is missed then: what the motion tells of those in the
            other runs, to which nothing is fitted, is not uncertain any more.
    """
    observed = model.observed
    if not any(np.any(run.contact) for run in observed.runs):
        return model, None
    if measured:
        contact_events = tuple(event for event in observed.contact_events if event.run in training)
        model = model.seeing(replace(observed, contact_events=contact_events))
    filtered = calibrated(model, training)
    better, filtered = _told(model, model, filtered, training, SETTINGS.forces.correction_rounds - 1)
    # What wrong forces needed to be explained holds a calibration back that begins with it.
    fits = [refine(better, start) for start in (filtered, calibrated(better, training))]
    filtered = max(fits, key=lambda fit: fit.log_posterior).filtered
    return _told(model, better, filtered, training, 1)


def put_right_with(model: Model, corrected: Model, fit: Fit) -> tuple[Model, Fit]:
    """Return the model with contact forces as frames with effects correct them, and the fit of these effects with them.

    Forces that frames without an effect have put right keep a part of it, and the effect is too small by that: forces and
    effects are found in turn until the effects' sizes stand still.

    Args:
        model: The model with the forces as they were measured or found.
        corrected: The same with those about which the effects were fitted.
        fit: The fit of the effects.
    """
    settings = SETTINGS.forces
    for _ in range(settings.settling_rounds):
        corrected, filtered = _told(
            model, corrected, fit.filtered, fit.filtered.runs, settings.correction_rounds
        )
        before, fit = fit, refine(corrected, filtered, fit.effects, fit.values)
        moved = (
            np.abs(new - old) / std for new, old, std in zip(fit.values, before.values, fit.std, strict=True)
        )
        if max(float(one.max()) for one in moved) < settings.settled:
            break
    return corrected, fit


def _told(
    model: Model, better: Model, filtered: Filtered, training: Sequence[int], rounds: int
) -> tuple[Model, Filtered]:
    """Return the model with errors of its forces as a baseline tells them that works with those of `better`."""
    pairs_of_runs = zip(better.observed.runs, model.observed.runs, strict=True)
    errors = [one.contact - run.contact for one, run in pairs_of_runs]
    for _ in range(rounds):
        for column in range(len(model.observed.contact_floors)):
            _estimate(model, (better, _of_all_runs(better, filtered)), column, training, errors)
            better = _with_errors(model, errors)
        filtered = _quieter(better, filtered)
    return better, filtered


def _quieter(model: Model, filtered: Filtered) -> Filtered:
    """Return frames and noise of each channel as they are with better forces."""
    start = run_filter(model, filtered.values, filtered.noise, filtered.runs, filtered.effects)
    return calibrated_further(model, likeliest_noise(model, start), 2)


def _of_all_runs(model: Model, filtered: Filtered) -> Filtered:
    """Return a baseline with the runs that it was not fitted to, whose noise is as large a share of their channels."""
    runs = range(len(model.observed.runs))
    known = dict(zip(filtered.runs, filtered.noise, strict=True))
    noise = [
        known.get(run) or one for run, one in zip(runs, expected_noise(model, filtered, runs), strict=True)
    ]
    return run_filter(model, filtered.values, noise, runs, filtered.effects)


def _estimate(
    model: Model,
    better: tuple[Model, Filtered],
    column: int,
    training: Sequence[int],
    errors: list[np.ndarray],
) -> None:
    """Put a column of `errors`, (samples, contacts) of each run, to what a filter says that works with those so far."""
    corrected, filtered = better
    left, right = model.observed.contact_floors[column]
    told = pairs.answers(corrected, filtered, filtered.modes.floors[right] - filtered.modes.floors[left])
    each = [
        _touching(run.contact[:, column], error[:, column], *answer)
        for run, error, answer in zip(model.observed.runs, errors, told, strict=True)
    ]
    ln_bayes = {
        share: sum(each[run].within(share)[1] for run in training) for share in SETTINGS.forces.shares
    }
    share = max(ln_bayes, key=lambda one: ln_bayes[one])
    for error, one in zip(errors, each, strict=True):
        error[:, column] = 0.0
        if ln_bayes[share] > 0.0:
            error[one.samples, column] = one.within(share)[0]


def _touching(force: np.ndarray, error: np.ndarray, matched: np.ndarray, own: np.ndarray) -> _Touching:
    size = maximum_filter1d(np.abs(force), 2 * SETTINGS.forces.near_samples + 1, mode="constant")
    samples = np.flatnonzero(size > SETTINGS.forces.least_share * size.max())
    lag = np.abs(samples[:, None] - samples[None, :])
    curvature = np.where(lag < len(own), own[np.minimum(lag, len(own) - 1)], 0.0)
    return _Touching(samples, size[samples], matched[samples] + curvature @ error[samples], curvature)


def _with_errors(model: Model, errors: Sequence[np.ndarray]) -> Model:
    """Return the model with errors (samples, contacts) of each run added to its contact forces."""
    runs = [_added(run, error) for run, error in zip(model.observed.runs, errors, strict=True)]
    return model.seeing(replace(model.observed, runs=tuple(runs)))


def _added(run: RunData, error: np.ndarray) -> RunData:
    if run.fine_contact is None:
        return replace(run, contact=run.contact + error)
    # The filter sees an error as lines between samples, and so does the finer grid.
    at, finer = np.arange(len(error)) * run.step_s, np.arange(len(run.fine_contact)) * run.fine_step_s
    fine = np.stack([np.interp(finer, at, column) for column in error.T], axis=1)
    return replace(run, contact=run.contact + error, fine_contact=run.fine_contact + fine)
