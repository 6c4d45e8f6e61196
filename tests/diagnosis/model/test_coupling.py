"""What is tuned to a mode: damping couples both modes, and the prediction is that of the matrices."""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from pounding.diagnosis.effects.frame import TorsionalEccentricity
from pounding.diagnosis.effects.rivals import Appendage
from pounding.diagnosis.model.nuisance import MODAL_DAMPING
from pounding.diagnosis.model.storeys import Coupling
from tests.diagnosis.models import STEP_S, measured, shaking


def test_the_prediction_of_what_hangs_on_a_damper_is_that_of_its_matrices() -> None:
    model = measured(runs=1)
    still = np.zeros(len(model.std))
    effects = [(Appendage(index=1, frame="bench", storey=2), np.array([0.03, 6.84, 0.03]))]
    ((assembly, modes),) = model.systems(still, effects, [0])
    predicted = model.predict(still, None, effects, [0]).outputs[0][:, 4]
    mass, stiffness, damping, influence = model.matrices(assembly)
    exact = top_displacement(mass, stiffness, damping, influence)
    assert off(predicted, exact) < 0.005
    shapes = modes.shapes
    alone = np.linalg.inv(shapes).T @ np.diag(2 * modes.ratio * modes.omega) @ np.linalg.inv(shapes)
    assert off(top_displacement(mass, stiffness, alone, influence), exact) > 0.03


def test_the_prediction_of_a_frame_whose_modes_damping_couples_is_that_of_its_matrices() -> None:
    """What couples them moves the top by a quarter of a per cent here: the prediction is nearer by far."""
    model = measured(runs=1)
    coupled = np.array([0.9 * (one.kind == MODAL_DAMPING) for one in model.parameters])
    predicted = model.predict(coupled, None, (), [0]).outputs[0][:, 4]
    with_it, without = (
        top_displacement(*model.matrices(model.assemble(values))) for values in (coupled, 0 * coupled)
    )
    moved = off(without, with_it)
    assert moved > 0.002
    assert off(predicted, with_it) < 0.4 * moved


def test_a_frame_that_turns_has_the_damping_of_its_modes() -> None:
    model = measured(runs=1)
    turning = [(TorsionalEccentricity(index=0, frame="bench"), np.array([0.004, 1.01, 3.0]))]
    ((_, modes),) = model.systems(np.zeros(len(model.std)), turning, [0])
    assert not len(modes.coupling.rates)


def test_coupling_is_that_of_the_pairs_which_it_changes_most() -> None:
    damping = np.array([[1.0, 0.2, 0.5], [0.2, 1.0, 0.0], [0.5, 0.0, 1.0]])
    coupling = Coupling.strongest(np.array([10.0, 11.0, 20.0]), damping, 1)
    np.testing.assert_array_equal(coupling.pairs, [[0, 1]])
    np.testing.assert_array_equal(coupling.matrix(3), [[0.0, 0.2, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.0]])


def off(one: np.ndarray, exact: np.ndarray) -> float:
    """Return how far a series is from the exact one, as a share of it."""
    return float(np.linalg.norm(one - exact) / np.linalg.norm(exact))


def top_displacement(
    mass: np.ndarray, stiffness: np.ndarray, damping: np.ndarray, influence: np.ndarray
) -> np.ndarray:
    """Return the third floor's displacement by the exact step of the whole system under a table between samples."""
    finer, n = 8, len(mass)
    table = shaking(2000, 0)
    between = np.interp((np.arange(len(table) * finer) + 0.5) / finer, np.arange(len(table)), table)
    block = np.block(
        [
            [np.zeros((n, n)), np.eye(n), np.zeros((n, 1))],
            [-np.linalg.solve(mass, stiffness), -np.linalg.solve(mass, damping), -influence[:, None]],
            [np.zeros((1, 2 * n + 1))],
        ]
    )
    step = expm(block * STEP_S / finer)
    state, found = np.zeros(2 * n), np.zeros(len(table))
    for k in range(len(table)):
        found[k] = state[2]
        for j in range(finer):
            state = step[:-1, :-1] @ state + step[:-1, -1] * between[k * finer + j]
    return found
