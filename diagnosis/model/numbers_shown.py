"""What modal tests would find on the frames of an assembly: frequencies, roof stiffness, mass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.storeys import Structure, squared


def modal_numbers(structure: Structure, assembly: Assembly, data: Sequence[ModalDatum]) -> np.ndarray:
    """Return what an assembly's frames would show, NaN where one has lost its stiffness.

    Args:
        structure: The frames.
        assembly: Their matrices with effects; coordinates that effects added take no part.
        data: What is asked for; its values are not looked at.

    Returns:
        Frequencies [Hz], roof stiffnesses [N/m] and masses [kg], shape (data,).
    """
    found = np.full(len(data), np.nan)
    for name in {datum.frame for datum in data}:
        span = structure.span(structure.index(name))
        stiffness, mass = assembly.stiffness[span, span], assembly.mass[span, span]
        squares, _ = squared(mass, stiffness)
        if squares[0] <= 0:
            continue
        for i, datum in enumerate(data):
            if datum.frame != name:
                continue
            if datum.quantity == "frequency":
                found[i] = np.sqrt(squares[int(datum.mode or 1) - 1]) / (2 * np.pi)
            elif datum.quantity == "mass":
                found[i] = mass.sum()
            else:
                found[i] = 1 / np.linalg.inv(stiffness)[-1, -1]
    return found
