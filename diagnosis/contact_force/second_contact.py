"""A second contact: pushes at another floor of a pair than that of the contact which is stated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pounding.diagnosis.contact_force import contacts, impacts, pairs
from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.hypotheses import (
    UNLISTED_GAP_M,
    UNLISTED_RESTITUTION,
    UNLISTED_SPREAD,
    UNLISTED_STIFFNESS,
    WIDE_STIFFNESS,
    Hypothesis,
)
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS

ONE_SIDED = ((1.0, 0.0), (0.0, 1.0))
"""Pushes on the left frame alone and on the right one alone."""


def second_contact(
    full: Model,
    floors: Sequence[tuple[int, int]],
    touching: tuple[int, int],
    column: int,
    noise: Sequence[float],
    runs: Sequence[int],
) -> tuple[Model, tuple[int, float, int] | None]:
    """Look for pushes at another floor while the stated contact is open.

    Args:
        full: The baseline model at the rate of the logger.
        floors: Left and right floor among all of every place at which the frames can touch.
        touching: Those of the stated contact.
        column: Column of the stated contact's force.
        noise: Standard deviation of that force in each run [N].
        runs: Numbers of the runs.

    Returns:
        The model, with the force of a second contact if there is one, and this one's floor (from 1), ln Bayes factor and
        column; None without one.
    """
    filtered = pairs.quick_filter(full, runs)
    closed = [
        _closed(run.contact[:, column], level, run.step_s)
        for run, level in zip(full.observed.runs, noise, strict=True)
    ]
    tried = []
    for pair in floors:
        if pair != touching:
            found = pairs.pushes(full, filtered, pair, closed)
            if sum(len(one.windows) for one in found) >= SETTINGS.second_contact.pushes:
                tried.append((sum(one.ln_bayes for one in found), pair))
    if not tried or max(tried)[0] < SETTINGS.second_contact.evidence:
        return full, None
    ln_bayes, pair = max(tried)
    if not _of_a_contact(full, filtered, pair, closed):
        return full, None
    # Now with its pushes during impacts of the stated contact too.
    both, _ = pairs.found_force(full, pair, filtered)
    return both, (full.structure.place(pair[0])[1], ln_bayes, len(both.observed.contact_floors) - 1)


def _closed(force: np.ndarray, noise: float, step: float) -> np.ndarray:
    needs = SETTINGS.second_contact
    closed = np.zeros(len(force), bool)
    for first, last in impacts.groups(force, noise, step):
        before, after = (int(s / step) for s in (needs.before_s, needs.after_s))
        closed[max(0, first - before) : last + after] = True
    return closed


def _of_a_contact(
    full: Model, filtered: Filtered, pair: tuple[int, int], closed: Sequence[np.ndarray]
) -> bool:
    """Return whether pushes come as the floors come near, or at least push both frames, which no part of one does."""
    pushed = pairs.pushes(full, filtered, pair, closed)
    share = _opposed(full, filtered, pair, pushed, closed)
    if share >= SETTINGS.second_contact.share or share < SETTINGS.second_contact.least_share:
        return share >= SETTINGS.second_contact.share
    alone = [
        sum(one.ln_bayes for one in pairs.pushes(full, filtered, pair, closed, sides)) for sides in ONE_SIDED
    ]
    return sum(one.ln_bayes for one in pushed) > max(alone) + SETTINGS.second_contact.both


def _opposed(
    full: Model,
    filtered: Filtered,
    pair: tuple[int, int],
    pushed: Sequence[pairs.Pushes],
    closed: Sequence[np.ndarray],
) -> float:
    """Return the share of approaches beyond the gap at which pushes begin that do meet a push.

    Approaches while the stated contact is `closed` do not count: no push is looked for then.
    """
    row = filtered.modes.floors[pair[0]] - filtered.modes.floors[pair[1]]
    n = len(filtered.modes.omega)
    begun, tops = [], []
    for number, one in enumerate(pushed):
        distance = filtered.prediction.after[number][:, :n] @ row
        peaks = np.flatnonzero((distance[1:-1] > distance[:-2]) & (distance[1:-1] >= distance[2:])) + 1
        step = full.observed.runs[filtered.runs[number]].step_s
        near, reach = np.zeros(len(distance), bool), int(SETTINGS.second_contact.near_s / step)
        for first, last in one.windows:
            begun.append(float(distance[min(first + int(1e-3 / step), last)]))
            near[max(0, first - reach) : last + reach] = True
        tops += [(float(distance[k]), bool(near[k])) for k in peaks if near[k] or not closed[number][k]]
    if not begun:
        return 0.0
    gap = float(np.median(begun))
    beyond = [met for top, met in tops if top > gap]
    return float(np.mean(beyond)) if beyond else 0.0


def second_fit(
    full: Model, filtered: Filtered, column: int, mass: float, errors: np.ndarray
) -> Fitted | None:
    """Return the fit of a contact that the case does not list, all its numbers free; None without impacts.

    Args:
        full: The baseline model at the rate of the logger.
        filtered: The filtered model.
        column: Column of its force.
        mass: Reduced mass of the two floors [kg].
        errors: Share of its motion by which the model of each frame is wrong, shape (frames,).
    """
    noise = [impacts.found_noise(full.observed.runs[run].contact[:, column]) for run in filtered.runs]
    met = impacts.bodies(full, filtered, column, noise, mass)
    if not met.impacts:
        return None
    onset = float(np.median([one.free[min(one.onset, len(one.free) - 1)] for one in met.impacts]))
    law = impacts.Law(
        "linear_viscoelastic", onset, UNLISTED_STIFFNESS, float("nan"), UNLISTED_RESTITUTION, mass
    )
    free = Hypothesis("second_contact", law, UNLISTED_GAP_M, WIDE_STIFFNESS, UNLISTED_SPREAD)
    met = replace(met, common_m=impacts.common_error(full, filtered, column, errors))
    return contacts.fit(met, free)
