"""What the effects of a fit do in one storey, along a motion: to be laid over the residual force."""

from __future__ import annotations

import numpy as np

from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.model.model import Model


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
    displacement, velocity = (np.linalg.solve(structure.drift, one.T).T for one in (drift, rate))
    pushed = displacement @ (assembly.stiffness - plain.stiffness)
    for one in assembly.laws[len(plain.laws) :]:
        if not one.in_room:
            force = one.law.along(one.parameters, displacement @ one.row, velocity @ one.row, time)
            pushed += force[:, None] * one.row
    # What acts on the floors above it a storey carries.
    frame, number = structure.place(storey)
    span = structure.span(structure.index(frame))
    total = pushed[:, span.start + number - 1 : span.stop].sum(axis=1)
    return total if np.any(total) else None
