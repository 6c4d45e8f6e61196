"""What a force cell does wrong, told from the frames' motion: polarity, gain, delay, offset, clipping.

Two frames that are pushed apart say by themselves how hard and when (`contact_force.pairs.pushes`). A force that is pressed
out of the motion has no cell's gain; its impulses and times are compared with those of the channel.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from pounding.constants import STD_PER_MAD
from pounding.diagnosis.case.case import Case
from pounding.diagnosis.contact_force import impacts, pairs
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.pair import TURNED_ROUND, Cell
from pounding.diagnosis.model.sensors import at_its_top
from pounding.diagnosis.settings import SETTINGS


def checked(
    case: Case, model: Model, touching: tuple[int, int], against_motion: bool = True
) -> tuple[Observations, Cell | None, list[str]]:
    """Return the observations with the force cell's errors taken out, the cell, and warnings; without a good cell None.

    A gain or a delay is taken out as soon as more speaks for it than against it: whether it stays so calibrated frames say
    (`pair.cell_at_its_word`).

    Args:
        case: The case.
        model: The baseline model.
        touching: Left and right floor among all between which the cell is.
        against_motion: Whether gain and delay are judged by the forces that the motion asks for: not where another contact
            pushes the same frames.
    """
    observed = model.observed
    if touching not in observed.contact_floors:
        return observed, None, []
    column = observed.contact_floors.index(touching)
    names = [channel.name for channel in case.channels if channel.quantity == "contact_force"]
    name = names[column]
    series = [run.contact[:, column] for run in observed.runs]
    if not any(np.any(force) for force in series):
        return observed, Cell(name, column), [f"channel {name} never shows a force"]
    if _clipped(series):
        others = [i for i in range(len(observed.contact_floors)) if i != column]
        top = max(float(force.max()) for force in series)
        return (
            pairs.with_contacts(model, others).observed,
            None,
            [f"channel {name} is clipped at {top:g} N; the force is taken from the motion instead"],
        )
    faults, warnings, needs = [], [], SETTINGS.pair_decision
    level = float(np.median(np.concatenate(series)))
    noise = impacts.force_noise(np.concatenate(series))
    quiet = np.concatenate(
        [force[np.abs(force - level) < SETTINGS.force_cell.quiet * noise] for force in series]
    )
    offset, spread = float(quiet.mean()), float(quiet.std() / np.sqrt(max(len(quiet), 1)))
    ln_bayes = 0.5 * offset**2 / (spread**2 + (SETTINGS.force_cell.offset_error * noise) ** 2) - 0.5 * np.log(
        len(quiet)
    )
    if ln_bayes > needs.contact_evidence:
        faults.append(("sensor_offset", offset, spread, float(ln_bayes)))
        series = [force - offset for force in series]
    if -min(f.min() for f in series) > SETTINGS.force_cell.turned * max(f.max() for f in series):
        told = SETTINGS.force_cell
        faults.append(("sensor_gain", TURNED_ROUND, told.gain_error, told.turned_evidence))
        warnings.append(f"channel {name} pulls where floors push: its polarity is reversed")
        series = [-force for force in series]
    elif against_motion and (seen := _against_motion(model, touching, series)) is not None:
        (gain, gain_std), (delay, delay_std) = seen
        if (ln_bayes := 0.5 * (gain / gain_std) ** 2 - needs.parameter_cost) > 0.0:
            faults.append(("sensor_gain", gain, gain_std, float(ln_bayes)))
            series = [force / (1 + gain) for force in series]
        if (ln_bayes := 0.5 * (delay / delay_std) ** 2 - needs.parameter_cost) > 0.0:
            faults.append(("sensor_delay", delay, delay_std, float(ln_bayes)))
            series = [_earlier(f, run.step_s, delay) for f, run in zip(series, observed.runs, strict=True)]
    runs = []
    for run, force in zip(observed.runs, series, strict=True):
        contact = run.contact.copy()
        contact[:, column] = force
        runs.append(replace(run, contact=contact))
    return replace(observed, runs=tuple(runs)), Cell(name, column, tuple(faults)), warnings


def _clipped(series: list[np.ndarray]) -> bool:
    return bool(at_its_top(np.concatenate(series), SETTINGS.force_cell.clipped_samples).any())


def _earlier(force: np.ndarray, step: float, delay: float) -> np.ndarray:
    at = np.arange(len(force)) * step
    return np.asarray(np.interp(at + delay, at, force))


def _against_motion(
    model: Model, touching: tuple[int, int], series: list[np.ndarray]
) -> tuple[tuple[float, float], tuple[float, float]] | None:
    """Return the cell's relative gain and its delay [s] against the forces that the motion asks for, with errors."""
    told = SETTINGS.force_cell
    observed, without = model.observed, pairs.with_contacts(model)
    runs = range(len(observed.runs))
    filtered = pairs.quick_filter(without, runs)
    ratio, late = [], []
    for run, force, pushed in zip(
        observed.runs, series, pairs.pushes(without, filtered, touching), strict=True
    ):
        noise = impacts.force_noise(force)
        for first, last in impacts.groups(force, noise, run.step_s):
            before, after = (int(s / run.step_s) for s in (told.before_s, told.after_s))
            around = slice(max(0, first - before), last + after)
            both = np.stack([force[around], pushed.force[around]])
            total = both.sum(axis=1)
            # Only what the motion shows plainly, and once.
            if total[1] <= told.shown * total[0] or total[0] <= 0:
                continue
            time = both @ np.arange(both.shape[1]) / total * run.step_s
            ratio.append(float(np.log(total[0] / total[1])))
            late.append(float(time[0] - time[1]))
    if len(ratio) < told.least:
        return None

    def middle(values: list[float], least: float) -> tuple[float, float]:
        centre = float(np.median(values))
        spread = (
            STD_PER_MAD * float(np.median(np.abs(np.array(values) - centre))) * 1.25 / np.sqrt(len(values))
        )
        return centre, float(np.hypot(spread, least))

    gain, gain_std = middle(ratio, told.gain_error)
    return (float(np.expm1(gain)), gain_std), middle(late, told.delay_error_s)
