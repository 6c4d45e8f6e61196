"""A pair from its baseline contact to what is said of it: forces known or found, impacts, and the contact's effects.

Given the contact forces, the frames' motion does not depend on why there were forces, and given the motion the forces do
not depend on the rest of the frames. So frames and contact are judged apart, and what is found of both is said.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.contact.damping import reduced_mass
from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force import contacts, impacts, pairs
from pounding.diagnosis.contact_force.contacts import Fitted
from pounding.diagnosis.contact_force.force_cell import checked
from pounding.diagnosis.contact_force.hypotheses import GAP_M, baseline_law, hypotheses, null
from pounding.diagnosis.contact_force.impacts import Bodies, Law
from pounding.diagnosis.contact_force.second_contact import second_contact, second_fit
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.findings import Findings, Judged
from pounding.diagnosis.inference.misfit import beyond_noise, median
from pounding.diagnosis.inference.starting import calibrated, starting_noise
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.observations import ContactEvent, Observations
from pounding.diagnosis.model.pair import Pair
from pounding.diagnosis.model.predictor import ABSOLUTE_DISPLACEMENT, DISPLACEMENT
from pounding.diagnosis.model.slowing import slowed
from pounding.diagnosis.settings import SETTINGS


@dataclass(frozen=True)
class ContactFindings:
    """What the impacts say: the baseline contact, and each other with its ln Bayes factor against it, best first.

    `error` is the scatter of the impacts about the best of them over what was expected.
    """

    null: Fitted | None
    ranked: tuple[tuple[float, Fitted], ...] = ()
    second: Fitted | None = None
    impacts: int = 0
    nearest_m: float = float("nan")
    spread_m: float = float("nan")
    bodies: Bodies | None = None
    error: float = 1.0


def prepare(case: Case, model: Model, against_motion: bool = True) -> Pair:
    """Return a pair with the forces of its contacts filled in where no cell, or no good one, measured them.

    Args:
        case: The case.
        model: The baseline model.
        against_motion: Whether a force cell's gain and delay are judged by what the frames' sensors say.
    """
    contact = case.contacts[0]
    structure = model.structure
    left, right = structure.index(contact.left), structure.index(contact.right)
    floors = pairs.shared_floors(structure, left, right)
    touching = structure.first(left) + contact.floor - 1, structure.first(right) + contact.floor - 1
    runs = range(len(model.observed.runs))
    observed, cell, warnings = checked(case, model, touching, against_motion)
    full = model.seeing(observed)
    found = touching in observed.contact_floors
    if found:
        column = observed.contact_floors.index(touching)
        noise = [impacts.force_noise(run.contact[:, column]) for run in observed.runs]
    else:
        full, noise = pairs.found_force(full, touching, pairs.quick_filter(full, runs))
        column = len(full.observed.contact_floors) - 1
        count = sum(
            len(impacts.groups(run.contact[:, column], level, run.step_s))
            for run, level in zip(full.observed.runs, noise, strict=True)
        )
        warnings.append(
            "contact 1 has no usable force channel: its force is what the frames' motion asks for, "
            f"{count} impacts were found"
        )
    second = None
    if len(full.observed.contact_floors) == 1:
        full, second = second_contact(full, floors, touching, column, noise, runs)
    if second is not None and cell is not None and cell.corrected:
        # What the motion says of the cell was said without the other contact, whose pushes come at the same times.
        plainly = checked(case, model, touching, against_motion=False)
        again, once_more = second_contact(model.seeing(plainly[0]), floors, touching, column, noise, runs)
        if once_more is not None:
            full, second, (_, cell, warnings) = again, once_more, plainly
    pair = Pair(full, full, column, noise, cell, second, warnings)
    return replace(pair, slow=_slow(pair))


def cell_at_its_word(case: Case, model: Model, pair: Pair, training: Sequence[int]) -> Pair:
    """Return a pair whose force cell is corrected only if calibrated frames are likelier with the correction than without.

    The cell's gain and delay were estimated with the baseline frames, which may be wrong by more than the cell. A gain that
    these hardly tell may be all that keeps calibrated frames within their priors: a force that is too large by a share makes
    all that it pushes too light by as much.

    Args:
        case: The case.
        model: The baseline model.
        pair: The pair, as `prepare` gives it.
        training: Numbers of the runs that the frames are calibrated to.
    """
    if pair.cell is None or not pair.cell.corrected:
        return pair
    plain = prepare(case, model, against_motion=False)
    gained = _likely(pair.slow, training) - _likely(plain.slow, training)
    if gained <= SETTINGS.pair_decision.contact_evidence:
        return plain
    return replace(pair, cell=pair.cell.with_evidence(gained - SETTINGS.pair_decision.parameter_cost))


def _likely(model: Model, training: Sequence[int]) -> float:
    """Return the log posterior of calibrated frames."""
    filtered = calibrated(model, training)
    return filtered.log_likelihood - 0.5 * float(
        np.sum((filtered.values / model.spread(filtered.discrepancy)) ** 2)
    )


def found_again(pair: Pair, training: Sequence[int]) -> Pair:
    """Return a pair with the forces that no cell measured found anew, by frames calibrated with those found before.

    Weak contact events show only in frames that are calibrated; a force that is missed looks like an effect of a frame.
    """
    if not pair.blind:
        return pair
    values = calibrated(pair.slow, training).values[: len(pair.full.std)]
    runs = range(len(pair.full.observed.runs))
    if pair.second is None:
        full, noise = _found_by(pair, values, (), runs)
        again = replace(pair, full=full, noise=noise)
    else:
        stated = pairs.with_contacts(pair.full, range(len(pair.full.observed.contact_floors) - 1))
        filtered = run_filter(stated, values, starting_noise(stated, runs, SETTINGS.start.impact_level), runs)
        touching = pair.full.observed.contact_floors[pair.second[2]]
        again = replace(pair, full=pairs.found_force(stated, touching, filtered)[0])
    return replace(again, slow=_slow(again))


def _slow(pair: Pair) -> Model:
    full = pair.full
    observed = _with_contact_events(full.observed, _contacts(pair))
    return full.seeing(slowed(observed, SETTINGS.forces.rate_hz))


def _contacts(pair: Pair) -> list[tuple[int, Sequence[float], float]]:
    """Return column, least force in each run [N] and relative uncertainty of each contact's force.

    However weak, a contact event moves the frames: what was found is all taken, and of a cell's readings what is no noise.
    """
    nothing = [0.0] * len(pair.full.observed.runs)
    plain = [SETTINGS.impacts.plain * noise for noise in pair.noise]
    found, measured = SETTINGS.forces.found_size, SETTINGS.forces.cell_size
    stated = (pair.column, nothing, found) if pair.cell is None else (pair.column, plain, measured)
    return [stated] if pair.second is None else [stated, (pair.second[2], nothing, found)]


def _found_by(
    pair: Pair, values: np.ndarray, effects: Sequence[tuple[Acting, np.ndarray]], runs: Sequence[int]
) -> tuple[Model, list[float]]:
    """Return the model with the force that frames with these parameters and effects ask for, and its noise [N]."""
    full = pair.full
    without = pairs.with_contacts(full)
    again = run_filter(
        without, values, starting_noise(full, runs, SETTINGS.start.impact_level), runs, effects
    )
    return pairs.found_force(without, full.observed.contact_floors[pair.column], again)


def _with_contact_events(
    observed: Observations, contacts: Sequence[tuple[int, Sequence[float], float]]
) -> Observations:
    """Return the observations with their contact events: what a cell reads between them is noise and shakes no frame.

    The forces of the largest events are as well known as their source lets them.
    """
    around = SETTINGS.forces.around_s
    contact_events: list[tuple[float, ContactEvent]] = []
    runs = []
    for number, run in enumerate(observed.runs):
        times, contact = np.arange(len(run.table)) * run.step_s, run.contact.copy()
        for column, least, std in contacts:
            force, closed = run.contact[:, column], np.zeros(len(times), bool)
            for first, last in _merged(impacts.above(force, least[number], run.step_s), run.step_s):
                event = ContactEvent(
                    number, column, first * run.step_s - around, last * run.step_s + around, std
                )
                closed |= event.within(times)
                contact_events.append((float(force[first : last + 1].sum()) * run.step_s, event))
            contact[~closed, column] = 0.0
        runs.append(replace(run, contact=contact))
    contact_events.sort(key=lambda one: -one[0])
    return replace(
        observed,
        runs=tuple(runs),
        contact_events=tuple(event for _, event in contact_events[: SETTINGS.forces.free_events]),
    )


def _merged(groups: Sequence[tuple[int, int]], step_s: float) -> list[tuple[int, int]]:
    """Return first and last sample of contact events, those joined that are too near to be told apart at the lower rate."""
    merged: list[tuple[int, int]] = []
    for first, last in groups:
        if merged and (first - merged[-1][1]) * step_s < 2 * SETTINGS.forces.around_s:
            merged[-1] = (merged[-1][0], last)
        else:
            merged.append((first, last))
    return merged


def judge_contact(case: Case, found: Findings, judged: Judged) -> ContactFindings:
    """Return what the training runs' impacts say of the contact, the frames being as a decision on them has them.

    Args:
        case: The case.
        found: What the search found.
        judged: What the decision on the frames rests on.
    """
    assert found.pair is not None
    filtered, errors = judged.fit.filtered, _displacement_errors(found, judged)
    return contact_findings(case, found.pair, filtered.values, filtered.effects, found.training, errors)


def _displacement_errors(found: Findings, judged: Judged) -> np.ndarray:
    """Return the share of its motion by which the model of each frame is wrong beyond the noise, shape (frames,).

    Of displacements where the frame has channels of them, which higher modes hardly move.
    """
    model = found.model
    beyond = beyond_noise(np.asarray(judged.channel_misfit)[0], np.asarray(found.floor)[0])
    moved = np.isin(model.observed.quantity, (DISPLACEMENT, ABSOLUTE_DISPLACEMENT)) & np.isfinite(beyond)
    errors = []
    for frame in range(len(model.structure.frames)):
        own = model.at_frame(frame)
        errors.append(float(median(beyond[own & moved if np.any(own & moved) else own])))
    return np.asarray(np.nan_to_num(errors))


def contact_findings(
    case: Case,
    pair: Pair,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    runs: Sequence[int],
    errors: np.ndarray,
) -> ContactFindings:
    """Return what the impacts of some runs say of the contact.

    Args:
        case: The case.
        pair: The pair.
        values: Nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        runs: Numbers of the runs.
        errors: Share of its motion by which the model of each frame is wrong, shape (frames,).
    """
    full, start, met = met_in(pair, values, effects, runs)
    met = replace(met, common_m=impacts.common_error(full, start, pair.column, errors))
    left, right = full.observed.contact_floors[pair.column]
    nearest, spread = _nearest(full, start, left, right, case.contacts[0].gap_m)
    second = None
    if pair.second is not None:
        second = second_fit(full, start, pair.second[2], met.mass, errors)
    if len(met.impacts) < SETTINGS.impacts.least:
        return ContactFindings(None, (), second, len(met.impacts), nearest, spread)
    law = baseline_law(case.contacts[0], met.mass)
    speed = float(np.median([abs(one.free_rate[min(one.onset, len(one.free) - 1)]) for one in met.impacts]))
    met, temper, (model, *fits) = _fitted(met, law, max(speed, 1e-2))
    ranked = contacts.ranked([(one.log_evidence - model.log_evidence) / temper for one in fits], fits)
    error = met.sharpness * float(np.sqrt(temper))
    return ContactFindings(model, ranked, second, len(met.impacts), nearest, spread, met, error)


def _fitted(met: Bodies, law: Law, speed: float) -> tuple[Bodies, float, list[Fitted]]:
    """Return impacts with errors as large as they are seen to be, by what evidence on them is divided, and all fits.

    The first fit is that of the contact of the baseline model.
    """
    tried = [null(law), *hypotheses(law, speed)]
    fits = contacts.warmed(met, [contacts.best_fit(met, one) for one in tried])
    fits = contacts.warmed(met, fits)
    level = _level(met, fits)
    if level < 1.0:
        met = impacts.sharper(met, max(float(np.sqrt(level)), SETTINGS.impacts.sharpest))
        fits = contacts.warmed(met, [contacts.again(met, one, one) for one in fits])
    return met, max(1.0, _level(met, fits)), fits


def _level(met: Bodies, fits: Sequence[Fitted]) -> float:
    """Return the variance that the best fit leaves of impacts over the one that was expected."""
    cost, freedom = min((one.cost, one.freedom) for one in fits)
    return 2 * cost / max(freedom - 3 * len(met.impacts), 1)


def met_in(
    pair: Pair, values: np.ndarray, effects: Sequence[tuple[Acting, np.ndarray]], runs: Sequence[int]
) -> tuple[Model, Filtered, Bodies]:
    """Return the model at the logger's rate, its filter with the contact's force, and the impacts of some runs.

    Args:
        pair: The pair.
        values: Nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        runs: Numbers of the runs.
    """
    full, noise = pair.full, [pair.noise[run] for run in runs]
    # At the logger's rate forces are as measured: their sizes, the last parameters, are what is asked here.
    values = values[: len(full.std)]
    if pair.cell is None and pair.second is None:
        # The force was found with the baseline frames; once more with the frames as they are.
        full, noise = _found_by(pair, values, effects, runs)
    start = run_filter(full, values, starting_noise(full, runs, SETTINGS.start.impact_level), runs, effects)
    left, right = full.observed.contact_floors[pair.column]
    mass = np.concatenate([frame.floor_mass for frame in full.structure.frames])
    reduced = reduced_mass(float(mass[left]), float(mass[right]))
    return full, start, impacts.bodies(full, start, pair.column, noise, reduced)


def _nearest(full: Model, filtered: Filtered, left: int, right: int, gap: float) -> tuple[float, float]:
    """Return how near the floors come to each other [m] and how well that is known."""
    row = filtered.modes.floors[left] - filtered.modes.floors[right]
    n = len(filtered.modes.omega)
    top = max(float((states[:, :n] @ row).max()) for states in filtered.prediction.after)
    spread = float(np.sqrt(np.sum(row**2 * np.maximum(np.diag(filtered.filters[0].updated)[:n], 0.0))))
    return top, float(np.hypot(np.hypot(spread, GAP_M), 0.01 * gap))
