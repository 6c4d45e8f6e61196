"""Two frames that touch: what the frames themselves are judged on, and forces at floors where none was measured.

An impact excites modes up to the sampling rate, of which a frame's model knows the lower ones. The frames are therefore
judged on motions below `forces.rate_hz`, all channels and forces filtered alike, which linear frames do not notice; a
contact is judged on the samples as they were recorded (`pounding.diagnosis.contact_force.impacts`).

A contact force that no cell measured shows in the innovations of the filter as the response to a few short pushes. Their
sizes follow by least squares; one impulse response of the filter is enough, since it is steady.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.signal import correlate

from pounding.constants import STD_PER_MAD
from pounding.diagnosis.contact_force.impacts import found_noise
from pounding.diagnosis.inference.filtering import Filtered, run_filter, whitened_innovations
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.sensitivity import Term, signatures
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.settings import SETTINGS
from pounding.frames.floors import level_floors

MEMORY_S = 0.25
"""Time [s] in which the filter forgets a push."""
LARGEST_N = 2e4
"""Prior standard deviation of a force [N]."""


@dataclass(frozen=True)
class Pushes:
    """Forces found between two floors of one run.

    Attributes:
        force: Force at each sample [N], zero outside the windows, shape (samples,).
        windows: First and last sample of each window.
        ln_bayes: Half the drop of the sum of squares, less what so many free forces gain by chance.
    """

    force: np.ndarray
    windows: tuple[tuple[int, int], ...]
    ln_bayes: float


def shared_floors(structure: Structure, left: int, right: int) -> list[tuple[int, int]]:
    """Return the floors (left, right) among all at which two frames could touch, from the table up.

    Args:
        structure: All frames of the case.
        left, right: Numbers of the two frames, from 0.
    """
    level = level_floors(structure.frames[left].height_m, structure.frames[right].height_m)
    return [(structure.first(left) + i - 1, structure.first(right) + j - 1) for i, j in level]


def quick_filter(model: Model, runs: Sequence[int]) -> Filtered:
    """Return the baseline model as it is, its latent forces large enough for what is not calibrated."""
    noise = starting_noise(model, runs, SETTINGS.start.quick_level)
    return run_filter(model, np.zeros(len(model.std)), noise, runs)


def with_contacts(model: Model, kept: Sequence[int] = ()) -> Model:
    """Return the model as if of the contact forces only these columns were known, none by default."""
    observed = model.observed
    runs = tuple(replace(run, contact=run.contact[:, list(kept)]) for run in observed.runs)
    floors = tuple(observed.contact_floors[column] for column in kept)
    return model.seeing(replace(observed, runs=runs, contact_floors=floors))


def found_force(model: Model, floors: tuple[int, int], filtered: Filtered) -> tuple[Model, list[float]]:
    """Return the model with a contact's force as the motion shows it, and the standard deviation of that in each run [N].

    It stands beside the forces that the model has; runs that were not filtered have none.

    Args:
        model: The baseline model.
        floors: Left and right floor among all.
        filtered: The filtered model.
    """
    pushed, observed = pushes(model, filtered, floors), model.observed
    forces = {run: one.force for run, one in zip(filtered.runs, pushed, strict=True)}
    runs = []
    for number, run in enumerate(observed.runs):
        column = forces.get(number, np.zeros(len(run.table)))
        runs.append(replace(run, contact=np.column_stack([run.contact, column])))
    contact_floors = (*observed.contact_floors, floors)
    found = model.seeing(replace(observed, runs=tuple(runs), contact_floors=contact_floors))
    return found, [found_noise(one.force) for one in pushed]


def pushes(
    model: Model,
    filtered: Filtered,
    floors: tuple[int, int],
    closed: Sequence[np.ndarray] | None = None,
    sides: tuple[float, float] = (1.0, 1.0),
) -> list[Pushes]:
    """Return the forces between two floors that the innovations of each run of a baseline show.

    Args:
        model: The baseline model.
        filtered: The filter, with the forces that are known already.
        floors: Left and right floor.
        closed: For each run where no push is looked for, shape (samples,).
        sides: Share of the force that acts on the left and on the right floor; a contact pushes both alike.
    """
    direction = sides[1] * filtered.modes.floors[floors[1]] - sides[0] * filtered.modes.floors[floors[0]]
    found = []
    for number, (matched, own) in enumerate(answers(model, filtered, direction)):
        step = model.observed.runs[filtered.runs[number]].step_s
        found.append(_solved(matched, own, step, None if closed is None else closed[number]))
    return found


def answers(model: Model, filtered: Filtered, direction: np.ndarray) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return what each run answers to whether a force of this modal direction acted at a sample.

    Args:
        model: The baseline model.
        filtered: The filter, with the forces that are known already.
        direction: Modal force of a unit force [N], shape (modes,).

    Returns:
        For each run the innovations' product with the response to a unit push at each sample, shape (samples,), and that
        response's own product with itself so many samples later, whose first is the variance of the answer.
    """
    found = []
    residuals = whitened_innovations(model, filtered)
    for number, run in enumerate(filtered.runs):
        step = model.observed.runs[run].step_s
        length = max(16, int(MEMORY_S / step))
        steady = filtered.filters[number]
        impulse = np.zeros(length + 1)
        impulse[1] = 1.0
        whiten = np.linalg.inv(np.linalg.cholesky(steady.covariance))
        response = signatures(steady, [[Term(impulse, direction)]], whiten)[:, :, 0].astype(float)
        channels = response.shape[1]
        series = residuals[number].reshape(-1, channels)
        samples = len(series)
        matched = np.zeros(samples)
        own = np.zeros(length)
        for c in range(channels):
            matched += correlate(series[:, c], response[:, c], "full")[length - 1 : length - 1 + samples]
            own += correlate(response[:, c], response[:, c], "full")[length : 2 * length]
        found.append((matched, own))
    return found


def _solved(matched: np.ndarray, own: np.ndarray, step: float, closed: np.ndarray | None) -> Pushes:
    """Return the pushes from the matched filter's output at each sample and the response's own correlation."""
    samples = len(matched)
    # The response begins a sample after the impulse of the filter.
    free = np.ones(samples, bool) if closed is None else ~closed
    impact = SETTINGS.impacts
    before, after = (int(np.ceil(s / step)) + 1 for s in (impact.lead_s, impact.tail_s))
    open_ = np.zeros(samples, bool)
    force, left = np.zeros(samples), matched.copy()
    size = np.sqrt(own[0])
    usual = max(1.0, STD_PER_MAD * float(np.median(np.abs(matched))) / size)
    gram = np.zeros((0, 0))
    active = np.zeros(0, int)
    for _ in range(SETTINGS.forces.rounds):
        plain = np.flatnonzero((left / size > SETTINGS.forces.plain * usual) & free & ~open_)
        if not len(plain):
            break
        for k in plain:
            open_[max(k - before, 1) : k + after] = True
        open_ &= free
        active = np.flatnonzero(open_)
        lag = np.abs(active[:, None] - active[None, :])
        gram = np.where(lag < len(own), own[np.minimum(lag, len(own) - 1)], 0.0)
        gram = gram / usual**2 + np.eye(len(active)) / LARGEST_N**2
        force[:] = 0.0
        force[active] = cho_solve(cho_factor(gram), matched[active] / usual**2)
        spread = np.convolve(force, np.r_[own[:0:-1], own], "full")
        left = matched - spread[len(own) - 1 : len(own) - 1 + samples]
    if not len(active):
        return Pushes(force, (), 0.0)
    covariance = np.linalg.inv(gram)
    starts = np.flatnonzero(np.diff(np.r_[-2, active]) > 1)
    groups = np.split(np.arange(len(active)), starts[1:])
    windows = []
    for group in groups:
        total = force[active[group]].sum()
        # A contact pushes: what pulls on the whole is something else.
        if total < SETTINGS.forces.pushing * np.sqrt(covariance[np.ix_(group, group)].sum()):
            force[active[group]] = 0.0
            continue
        windows.append((int(active[group[0]]), int(active[group[-1]])))
    gained = 0.5 * float(force[active] @ matched[active]) / usual**2
    return Pushes(force, tuple(windows), gained - SETTINGS.forces.cost * len(active))
