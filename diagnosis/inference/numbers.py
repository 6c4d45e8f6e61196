"""Measured numbers as a term of the inference: modal data and peaks, Gaussian in their logarithms about what a model shows.

A peak is the largest displacement of a floor in a run of the case whose table was recorded; the model's is that of its
simulation. Numbers that stand beside runs are further terms of the same sum.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np

from pounding.diagnosis.case.numbers import ModalDatum, Peak
from pounding.diagnosis.inference.coordinates import Coordinates
from pounding.diagnosis.inference.posterior import Likelihood
from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.numbers_shown import modal_numbers
from pounding.diagnosis.model.predictor import DISPLACEMENT

STEP = 1e-3
"""Change of a nuisance parameter, in prior standard deviations, by which slopes are taken."""
PROBE = 1e-2
"""Share of an effect's prior size by which it is scored."""
NONE = -10.0
"""Logarithm that stands for a number that a model does not show at all: it has buckled, or run away."""


class Numbers:
    """The modal data of a model's observations, and the peaks in some of its runs.

    Args:
        model: The baseline model.
        runs: Numbers of the runs whose peaks count; those of held-out runs do not.
        modal: Other modal data than those of the observations.
    """

    def __init__(self, model: Model, runs: Sequence[int], modal: Sequence[ModalDatum] | None = None) -> None:
        names = {model.observed.runs[run].name for run in runs}
        self.model, self.runs = model, tuple(runs)
        self.modal = model.observed.modal if modal is None else tuple(modal)
        self.peaks = tuple(peak for peak in model.observed.peaks if peak.run in names)
        data: tuple[ModalDatum | Peak, ...] = (*self.modal, *self.peaks)
        self.measured = np.log(np.array([one.value for one in data], float))
        self.std = np.array([one.std / one.value for one in data], float)

    def __len__(self) -> int:
        return len(self.std)

    def shown(self, nuisance: np.ndarray, acting: Sequence[tuple[Acting, np.ndarray]] = ()) -> np.ndarray:
        """Return the logarithms of the numbers in SI at nuisance parameters in their own units, shape (numbers,)."""
        shown = np.concatenate([self._tests(nuisance, acting), self._peaks(nuisance, acting)])
        good = np.isfinite(shown) & (shown > 0)
        return np.where(good, np.log(np.where(good, shown, 1.0)), NONE)

    def residual(self, nuisance: np.ndarray, acting: Sequence[tuple[Acting, np.ndarray]] = ()) -> np.ndarray:
        """Return measured less shown in standard deviations, shape (numbers,)."""
        return np.asarray((self.measured - self.shown(nuisance, acting)) / self.std)

    def nuisance_columns(
        self, nuisance: np.ndarray, acting: Sequence[tuple[Acting, np.ndarray]] = ()
    ) -> np.ndarray:
        """Return whitened slopes for the nuisance parameters in prior standard deviations, (numbers, nuisance)."""
        here = self.residual(nuisance, acting)
        columns = np.zeros((len(self), len(self.model.std)))
        for number, parameter in enumerate(self.model.parameters):
            # Of sensors no number knows, and of damping and the table only peaks.
            if parameter.kind.endswith(("stiffness", "mass")) or (
                self.peaks and not parameter.kind.startswith("channel")
            ):
                moved = nuisance.copy()
                moved[number] += STEP * parameter.std
                columns[:, number] = (here - self.residual(moved, acting)) / STEP
        return columns

    def _tests(self, nuisance: np.ndarray, acting: Sequence[tuple[Acting, np.ndarray]]) -> np.ndarray:
        """Return the modal data as each test shows them, with what acts in all tests or in this one, SI, (modal data,)."""
        found = np.zeros(len(self.modal))
        only = [getattr(effect, "test", None) for effect, _ in acting]
        # A test in which nothing acts alone shows what all the others show.
        tests = [datum.test if datum.test in only else None for datum in self.modal]
        for test in set(tests):
            which = [i for i, one in enumerate(tests) if one == test]
            # What a test alone shows comes on top of what all show.
            present = [
                acting[j] for wanted in dict.fromkeys((None, test)) for j, t in enumerate(only) if t == wanted
            ]
            assembly = self.model.assemble(nuisance, present)
            data = [self.modal[i] for i in which]
            found[which] = modal_numbers(self.model.structure, assembly, data)
        return found

    def _peaks(self, nuisance: np.ndarray, acting: Sequence[tuple[Acting, np.ndarray]]) -> np.ndarray:
        """Return the peaks [m] of simulated runs, shape (peaks,)."""
        if not self.peaks:
            return np.zeros(0)
        seen, column = self._seen
        with np.errstate(over="ignore", invalid="ignore"):
            outputs = seen.predict(seen.carried(self.model, nuisance), None, acting, self.runs).outputs
        series = {seen.observed.runs[run].name: out for run, out in zip(self.runs, outputs, strict=True)}
        found = []
        for peak in self.peaks:
            one = series[peak.run][:, column[peak.frame, peak.floor]]
            found.append(float(one.max() if peak.side == "max" else -one.min()))
        return np.array(found)

    @cached_property
    def _seen(self) -> tuple[Model, dict[tuple[str, int], int]]:
        """The model with displacement sensors where peaks were measured, and their columns."""
        observed, structure = self.model.observed, self.model.structure
        places = sorted({(peak.frame, peak.floor) for peak in self.peaks})
        blank = [
            replace(run, measured=np.full((len(run.table), len(places)), np.nan)) for run in observed.runs
        ]
        seen = replace(
            observed,
            names=tuple(f"{name} floor {floor}" for name, floor in places),
            to_si=np.ones(len(places)),
            quantity=np.full(len(places), DISPLACEMENT),
            floor=np.array([structure.first(structure.index(name)) + floor - 1 for name, floor in places]),
            runs=tuple(blank),
        )
        return self.model.seeing(seen), {place: i for i, place in enumerate(places)}


class NumbersTerm(Likelihood):
    """Numbers as a likelihood of nuisance parameters and effects.

    Args:
        numbers: The numbers.
        coordinates: Nuisance parameters and effects.
        quick: Whether the slopes of the nuisance parameters stay as they first were: they hardly change, and cost most.
    """

    def __init__(self, numbers: Numbers, coordinates: Coordinates, quick: bool = False) -> None:
        self.numbers, self.coordinates, self._quick = numbers, coordinates, quick
        self._nuisance: np.ndarray | None = None

    def _residual(self, theta: np.ndarray) -> np.ndarray:
        return self.numbers.residual(self.coordinates.nuisance(theta), self.coordinates.acting(theta))

    def cost(self, theta: np.ndarray) -> float:
        """Return half the sum of squares."""
        return 0.5 * float(np.sum(self._residual(theta) ** 2))

    def effect_columns(self, theta: np.ndarray) -> list[np.ndarray]:
        """Return whitened slopes with respect to the effects' coordinates, one array (numbers, coordinates)."""
        here = self._residual(theta)
        columns = np.zeros((len(here), len(theta) - len(self.coordinates.scale)))
        for j in range(columns.shape[1]):
            moved, delta = theta.copy(), self.coordinates.nudge(theta, j)
            moved[len(self.coordinates.scale) + j] += delta
            columns[:, j] = (here - self._residual(moved)) / delta
        return [columns]

    def blocks(self, theta: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
        """Yield residuals and slopes."""
        if self._nuisance is None or not self._quick:
            slopes = self.numbers.nuisance_columns(
                self.coordinates.nuisance(theta), self.coordinates.acting(theta)
            )
            self._nuisance = slopes * (self.coordinates.scale / self.numbers.model.std)
        yield self._residual(theta), np.hstack([self._nuisance, *self.effect_columns(theta)])
