"""The measured force of the named storey over its drift, beside that of the law that was found there.

The law is looked at as the measurements are: runs are simulated with it, given the noise that was found, and passed
through the same smoother, which knows no law. What the smoother makes too small or too round it does to both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from pounding.diagnosis.decision.diagnosis import Diagnosis
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.misfit import simulate
from pounding.diagnosis.inference.residual_force import ResidualForce, residual_force
from pounding.diagnosis.inference.storey_force import storey_force
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.report.making import corrected, shown_after, without
from pounding.diagnosis.settings import SETTINGS

BLOCKS = 8
"""Parts of each run that are left out in turn to see how sure a loop's shape is."""
SAMPLES = 12_000
"""Runs are looked at until they have so many samples, the strongest ones first."""
SEED = 1
SENSORS = ("channel", "logger")
"""Places of effects that are no force in a frame."""


@dataclass(frozen=True)
class Loops:
    """Force over drift in a storey, in the runs that were used, the strongest first.

    Attributes:
        storey: Index of the storey among all.
        stiffness: The storey's own, calibrated [N/m].
        measured: What the storey has beyond the calibrated model.
        law: The same of runs that were simulated with the law.
    """

    storey: int
    stiffness: float
    measured: tuple[ResidualForce, ...]
    law: tuple[ResidualForce, ...]


@dataclass(frozen=True)
class Difference:
    """A measure of a loop's shape: as measured, by the law, and the standard error of their difference."""

    measured: float
    law: float
    std: float

    @property
    def apart(self) -> bool:
        """Whether the difference exceeds its standard error clearly, and is large enough to be seen."""
        needed = max(SETTINGS.report.loop_apart * self.std, SETTINGS.report.loop_size)
        return abs(self.measured - self.law) > needed


def loops(diagnosis: Diagnosis) -> Loops | None:
    """Return the loops of the storey in which the shown candidate has most force.

    None where it acts in no storey, and where nothing is missing. Errors of the frame that it is judged beside stay in the
    model beyond which the force is.

    Args:
        diagnosis: What was found and decided.
    """
    judged, found = shown_after(diagnosis), diagnosis.found
    if judged is None or not judged.effects or diagnosis.conclusion.verdict == "nothing_missing":
        return None
    model, fit = corrected(found, judged)
    strongest = _strongest(model, found.training)
    bare = without_forces(fit, judged.effects)
    first = residual_force(model, bare, strongest[0])
    storey = _storey(model, without(fit, found.null.fit.effects), first)
    if storey is None:
        return None
    measured = (first, *(residual_force(model, bare, run) for run in strongest[1:]))
    assembly = model.assemble(fit.values)
    frame, number = model.structure.place(storey)
    span = model.structure.span(model.structure.index(frame))
    above = (np.arange(span.stop - span.start) >= number - 1).astype(float)
    return Loops(
        storey,
        float(above @ assembly.stiffness[span, span] @ above),
        measured,
        tuple(
            residual_force(_simulated(model, fit, run, one.noise.channel), bare, run, one.noise)
            for run, one in zip(strongest, measured, strict=True)
        ),
    )


def _strongest(model: Model, runs: Sequence[int]) -> list[int]:
    """Return the strongest runs, at least one, as many as have `SAMPLES` together."""
    data = model.observed.runs
    ordered = sorted(runs, key=lambda run: -float(np.ptp(data[run].table)))
    before = np.cumsum([0, *(len(data[run].table) for run in ordered[:-1])])
    return [run for run, earlier in zip(ordered, before, strict=True) if not earlier or earlier < SAMPLES]


def without_forces(fit: Filtered, effects: Sequence[Effect]) -> Filtered:
    """Return a fit without those of the effects that are a force in a frame; what sensors have wrong stays put right.

    Args:
        fit: The fit.
        effects: The effects.
    """
    return without(fit, [one for one in effects if one.where not in SENSORS])


def _storey(model: Model, fit: Filtered, motion: ResidualForce) -> int | None:
    """Return the storey in which the effects of a fit have the largest force, None where they have none."""
    step = float(motion.time_s[1] - motion.time_s[0])
    sizes = []
    for storey in range(motion.drift.shape[1]):
        force = storey_force(model, fit, storey, motion.drift, motion.drift_rate, step)
        sizes.append(0.0 if force is None else float(np.sqrt(np.mean(force**2))))
    return int(np.argmax(sizes)) if any(sizes) else None


def _simulated(model: Model, fit: Filtered, run: int, noise: np.ndarray) -> Model:
    """Return a model that has seen, instead of a run, what a fit simulates of it with such noise of each channel."""
    data = model.observed.runs[run]
    (output,) = simulate(model, fit.values, fit.effects, [run])
    scatter = np.random.default_rng((SEED, run)).standard_normal(output.shape)
    seen = output + np.where(np.isfinite(noise), noise, 0.0) * scatter
    seen[~np.isfinite(data.measured)] = np.nan
    runs = list(model.observed.runs)
    runs[run] = replace(data, measured=seen)
    return model.seeing(replace(model.observed, runs=tuple(runs)))


def fullness(loop: Loops) -> Difference:
    """Return how full the loops are: the part of the force that goes with the drift's rate, as a correlation (-1 to 1)."""
    return _compared(
        loop, lambda force, drift, rate: np.array([force @ rate, force @ force, rate @ rate]), _correlation
    )


def bend(loop: Loops) -> Difference:
    """Return how the force bends over the drift: the part that goes with the drift's cube beyond the drift (-1 to 1)."""

    def sums(force: np.ndarray, drift: np.ndarray, rate: np.ndarray) -> np.ndarray:
        beyond = drift**3 - drift * float(drift @ drift**3) / max(float(drift @ drift), 1e-300)
        return np.array([force @ beyond, force @ force, beyond @ beyond])

    return _compared(loop, sums, _correlation)


def _correlation(sums: np.ndarray) -> float:
    return float(sums[0] / np.sqrt(max(sums[1] * sums[2], 1e-300)))


def _compared(
    loop: Loops,
    sums: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray],
    measure: Callable[[np.ndarray], float],
) -> Difference:
    """Return a measure of both loops; its standard error is that of leaving out one part of a run at a time."""
    both = [
        np.array(
            [
                sums(*(series[part, loop.storey] for series in (one.force, one.drift, one.drift_rate)))
                for one in each
                for part in np.array_split(np.arange(len(one.time_s)), BLOCKS)
            ]
        )
        for each in (loop.measured, loop.law)
    ]
    measured, law = (measure(part.sum(axis=0)) for part in both)
    count = len(both[0])
    each = np.array(
        [
            measure(np.delete(both[0], i, axis=0).sum(axis=0))
            - measure(np.delete(both[1], i, axis=0).sum(axis=0))
            for i in range(count)
        ]
    )
    std = float(np.sqrt((count - 1) / count * np.sum((each - each.mean()) ** 2)))
    return Difference(measured, law, std)
