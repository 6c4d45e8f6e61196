"""Laws at their places in a structure, as the compiled predictor takes them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pounding.calling import NUMBERS
from pounding.experiments.rig.laws import Law, filled


@dataclass(frozen=True)
class PlacedLaw:
    """A law at its place in a structure.

    Attributes:
        law: The law.
        row: What the floors' displacements contribute to the drift on which it acts, shape (floors,).
        parameters: Its parameters in SI; NaN stands for the end of a run.
        in_room: Share of the table's rate in that on which it acts: one for the rate in the room, none for the drift's.
    """

    law: Law
    row: np.ndarray
    parameters: tuple[float, ...]
    in_room: float = 0.0


def placed_arrays(
    placed: Sequence[PlacedLaw], floors: np.ndarray, end_s: float, step_s: float = 0.0
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return laws at their places as the compiled predictor takes them.

    Args:
        placed: The laws.
        floors: Shapes of the modes at the floors [kg^-0.5], shape (floors, modes).
        end_s: End of the run [s].
        step_s: Step [s] over which the mean force is wanted; zero for the force at one moment.

    Returns:
        Addresses (laws,), what the modes contribute to each drift (laws, modes), shares of the table's rate (laws,), and
        parameters (laws, NUMBERS).
    """
    rows, parameters = np.zeros((len(placed), floors.shape[1])), np.zeros((len(placed), NUMBERS))
    for j, one in enumerate(placed):
        rows[j] = one.row @ floors
        parameters[j] = filled(one.parameters, end_s, step_s)
    laws = np.array([one.law.address for one in placed], np.int64)
    return laws, rows, np.array([one.in_room for one in placed], float), parameters
