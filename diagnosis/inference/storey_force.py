"""What the effects of a fit do in one storey, along a motion: to be laid over the leftover force."""

from __future__ import annotations

import numpy as np
from numba import njit

from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.predictor import DRAG, USER, _remember, law


@njit(cache=True)
def along(
    kind: int, parameters: np.ndarray, drift: np.ndarray, rate: np.ndarray, time: np.ndarray
) -> np.ndarray:
    """Return the force of a law of `pounding.diagnosis.model.predictor` along a motion [N], each array (samples,) in SI."""
    memory = np.zeros(4)
    force = np.empty(drift.size)
    for k in range(drift.size):
        force[k] = law(kind, parameters, memory, drift[k], rate[k], time[k])
        _remember(kind, parameters, memory, drift[k])
    return force


def storey_force(
    model: Model, fit: Filtered, storey: int, drift: np.ndarray, rate: np.ndarray, step_s: float
) -> np.ndarray | None:
    """Return the force of a fit's effects in a storey [N], shape (samples,), or None where none of them acts there.

    Args:
        model: The baseline model.
        fit: The fit with its effects.
        storey: Index of the storey among all.
        drift, rate: Drifts [m] and their rates [m/s] of every storey, shape (samples, storeys).
        step_s: Sampling step [s].
    """
    structure = model.structure
    assembly = model.assemble(fit.values, fit.effects)
    plain = model.assemble(fit.values)
    time = np.arange(len(drift)) * step_s
    total = np.zeros(len(drift))
    for kind, row, numbers, _ in assembly.laws:
        if kind in (DRAG, USER) or not np.allclose(row, structure.drift[storey]):
            continue
        parameters = np.zeros(5)
        parameters[: len(numbers)] = [time[-1] if np.isnan(number) else number for number in numbers]
        own, own_rate = np.ascontiguousarray(drift[:, storey]), np.ascontiguousarray(rate[:, storey])
        total += along(kind, parameters, own, own_rate, time)
    frame, number = structure.place(storey)
    span = structure.span(structure.index(frame))
    # A change of the stiffness pushes the floors; the storey carries what acts on the floors above it.
    displacement = np.linalg.solve(structure.drift, drift.T).T
    pushed = displacement @ (assembly.stiffness - plain.stiffness)
    total += pushed[:, span.start + number - 1 : span.stop].sum(axis=1)
    return total if np.any(total) else None
