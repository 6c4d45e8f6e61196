"""A small baseline model and data made by it, shared by the tests of the diagnosis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import Observations, RunData
from pounding.diagnosis.model.predictor import ABSOLUTE_DISPLACEMENT, ACCELERATION, DISPLACEMENT
from pounding.diagnosis.model.storeys import StoreyFrame, Structure

STEP_S = 0.002


def three_storeys() -> Structure:
    drift = np.eye(3) - np.eye(3, k=-1)
    frame = StoreyFrame(
        "bench", 6.5 * np.eye(3), 6e4 * drift.T @ drift, np.full(3, 0.01), 0.2 * np.arange(1, 4)
    )
    return Structure((frame,))


def with_joints_that_turn(structure: Structure) -> Structure:
    """Return a frame whose columns bend by less than their storeys drift: by a fifth of what those beside drift."""
    (frame,) = structure.frames
    count = frame.floors
    bends = frame.drift - 0.2 * (np.eye(count, k=1) + np.eye(count, k=-1)) @ frame.drift
    patterns = frame.storey_stiffness[:, None, None] * bends[:, :, None] * bends[:, None, :]
    return Structure((replace(frame, patterns=patterns),))


def shaking(samples: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    white = np.fft.rfft(rng.standard_normal(samples))
    frequency = np.fft.rfftfreq(samples, STEP_S)
    shaped = np.fft.irfft(white * np.exp(-((frequency / 25.0) ** 2)), samples)
    return shaped / shaped.std() * np.sin(np.linspace(0, np.pi, samples)) ** 0.5


def measured(
    effects: Sequence[Any] = (),
    *,
    noise: float = 0.02,
    samples: int = 2000,
    runs: int = 2,
    values: np.ndarray | None = None,
    reference: int = 0,
) -> Model:
    """Return the model with runs that it made itself, effects and nuisance parameters included, and white noise.

    The first `reference` runs are of the frame before the effects.
    """
    quantity = np.array([ACCELERATION] * 3 + [DISPLACEMENT] * 2)
    floor = np.array([0, 1, 2, 0, 2])
    names = ("a1", "a2", "a3", "d1", "d3")
    blank = tuple(
        RunData(
            f"run{i + 1}.csv",
            STEP_S,
            STEP_S * np.arange(samples),
            shaking(samples, i),
            np.zeros((samples, 5)),
            np.zeros((samples, 0)),
            reference=i < reference,
        )
        for i in range(runs)
    )
    structure = three_storeys()
    clean = Model(structure, Observations(names, np.ones(5), quantity, floor, blank), Prior())
    rng = np.random.default_rng(7)
    filled = []
    made_with = np.zeros(len(clean.std)) if values is None else values
    for run, output in zip(blank, clean.predict(made_with, None, effects).outputs, strict=True):
        noisy = output + noise * output.std(axis=0) * rng.standard_normal(output.shape)
        filled.append(replace(run, measured=noisy))
    return Model(structure, Observations(names, np.ones(5), quantity, floor, tuple(filled)), Prior())


def in_the_room(model: Model) -> Model:
    """Return a model whose displacements are those in the room: they see the table's own motion, too."""
    quantity = model.observed.quantity
    seen = np.where(quantity == DISPLACEMENT, ABSOLUTE_DISPLACEMENT, quantity)
    return model.seeing(replace(model.observed, quantity=seen))
