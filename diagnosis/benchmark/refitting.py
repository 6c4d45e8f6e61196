"""The obvious way: put each candidate into the model, refit, and take the one with the smallest residual.

No evidence, no priors, no filter: output error in least squares over the frame's stiffness and damping and
the candidate's own parameters, on the same simulator and the same catalogue as the workflow, so that what
differs is the judgement alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from pounding.diagnosis.benchmark.methods import report_of_method
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.decision.claims import Claim, claim, parameter, place_of
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect, Scales
from pounding.diagnosis.inference.evidence import scales
from pounding.diagnosis.inference.starting import uncalibrated
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.report.report import Report
from pounding.diagnosis.settings import SETTINGS

WORTH = 0.05
"""Share by which the residual has to fall before anything is said to be missing."""

ORDINARY = ("frame_stiffness", "frame_damping")
STARTS = 3
EVALUATIONS = 12
RUNAWAY = 1e3


def refit_each(folder: Path) -> Report:
    """Report on a case by the smallest residual, without a confidence and misfits.

    Args:
        folder: The case.

    Raises:
        CaseError: The case cannot be read.
    """
    case = read_case(folder)
    structure = Structure(baseline_frames(case))
    model = Model(structure, observe(case, structure), case.prior)
    rivals = [effect for effect in candidates(model) if not effect.rival]
    refit = Refit(model, _sizes(model))
    plain = refit.best(None)[0]
    fits = sorted(((*refit.best(effect), effect) for effect in rivals), key=lambda fit: fit[0])
    claims = [_claim(effect, values, plain / residual) for residual, values, effect in fits]
    missing = bool(fits) and fits[0][0] < (1 - WORTH) * plain
    return report_of_method(claims[:1] if missing else [], claims)


def _sizes(model: Model) -> Scales:
    start = uncalibrated(model, [0], SETTINGS.start.first_level)
    return scales(model, start)


class Refit:
    """Least squares on the first run, channel by channel relative to what was measured."""

    def __init__(self, model: Model, sizes: Scales) -> None:
        self.model, self.sizes = model, sizes
        self.free = [i for i, parameter in enumerate(model.parameters) if parameter.kind in ORDINARY]
        measured = model.observed.runs[0].measured
        self.good = np.isfinite(measured)
        self.rms = np.sqrt(np.nanmean(measured**2, axis=0))

    def residual(self, nuisance: np.ndarray, effects: Sequence[tuple[Effect, np.ndarray]]) -> np.ndarray:
        """Return the relative residuals of all samples, shape (good samples,), scaled to a mean square."""
        values = np.zeros(len(self.model.std))
        values[self.free] = nuisance * self.model.std[self.free]
        with np.errstate(all="ignore"):
            left = self.model.predict(values, None, effects, [0]).innovations[0] / self.rms
        left = np.clip(np.nan_to_num(left[self.good], nan=RUNAWAY), -RUNAWAY, RUNAWAY)
        return np.asarray(left / np.sqrt(left.size))

    def best(self, effect: Effect | None) -> tuple[float, np.ndarray]:
        """Return the smallest root mean square residual with an effect, and its SI parameters, shape (parameters,)."""
        if effect is None:
            fit = least_squares(lambda x: self.residual(x, ()), np.zeros(len(self.free)), diff_step=1e-3)
            return float(np.sqrt(2 * fit.cost)), np.zeros(0)
        starts = sorted(self._starts(effect), key=lambda start: self._cost(effect, start))
        return self._fit(effect, starts[0])

    def _starts(self, effect: Effect) -> list[np.ndarray]:
        shapes = effect.grid(self.sizes)
        chosen = [shapes[i] for i in np.unique(np.linspace(0, len(shapes) - 1, STARTS).astype(int))]
        signs = (effect.sign,) if effect.sign else (1, -1)
        return [
            effect.values(sign * part * effect.size(self.model, self.sizes, shape), shape)
            for shape in chosen
            for sign in signs
            for part in (0.1, 0.5)
        ]

    def _cost(self, effect: Effect, values: np.ndarray) -> float:
        return float(np.sum(self.residual(np.zeros(len(self.free)), ((effect, values),)) ** 2))

    def _fit(self, effect: Effect, start: np.ndarray) -> tuple[float, np.ndarray]:
        """Vary the effect's parameters by factors of their start; those that must be positive stay so."""
        positive = np.array(effect.logarithmic())
        least, most = np.transpose([quantity.ends for quantity in effect.quantities])

        def values(x: np.ndarray) -> np.ndarray:
            moved = np.where(positive, start * np.exp(np.clip(x, -5, 5)), start * (1 + x))
            return np.asarray(np.clip(moved, least, most))

        def residual(x: np.ndarray) -> np.ndarray:
            count = len(self.free)
            return self.residual(x[:count], ((effect, values(x[count:])),))

        fit = least_squares(
            residual, np.zeros(len(self.free) + len(start)), diff_step=1e-3, max_nfev=EVALUATIONS, x_scale=0.3
        )
        return float(np.sqrt(2 * fit.cost)), values(fit.x[len(self.free) :])


def _claim(effect: Effect, values: np.ndarray, better: float) -> Claim:
    told = [
        parameter(quantity.name, float(value) * quantity.per_si, None, quantity.unit)
        for quantity, value in zip(effect.quantities, values, strict=True)
        if quantity.reported
    ]
    return claim(place_of(effect), told, float(np.log(better)))
