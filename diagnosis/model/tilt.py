"""The table's pitch: an angle proportional to its acceleration, and what that does to frames and sensors."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.fft import next_fast_len

from pounding.constants import STANDARD_GRAVITY
from pounding.diagnosis.model.known_forces import KnownForces
from pounding.diagnosis.model.observations import RunData
from pounding.diagnosis.model.predictor import ABSOLUTE_DISPLACEMENT, DISPLACEMENT
from pounding.diagnosis.model.storeys import Modes

PITCH_LIMIT_HZ = 60.0
"""The table cannot pitch faster; above it its second derivative would be noise alone."""


def smooth_derivatives(table: np.ndarray, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the table's acceleration below `PITCH_LIMIT_HZ` and its second derivative, both (samples,)."""
    length = next_fast_len(2 * len(table), real=True)
    frequency = np.fft.rfftfreq(length, step_s)
    keep = 1.0 / (1.0 + (frequency / PITCH_LIMIT_HZ) ** 8)
    spectrum = np.fft.rfft(table, length) * keep
    second = -((2 * np.pi * frequency) ** 2) * spectrum
    n = len(table)
    return np.fft.irfft(spectrum, length)[:n], np.fft.irfft(second, length)[:n]


def tilt_series(model: Any, modes: Modes, run: RunData) -> tuple[np.ndarray, ...]:
    """Return pitch and pitching of a unit tilt, their modal directions, and what the channels see of both.

    Args:
        model: The baseline model.
        modes: Modes of its assembly.
        run: The run.

    Returns:
        Pitch [rad] and its second derivative [rad/s^2] for a tilt of one, each (samples,); modal direction of the
        pitching floors' inertia (modes,) and of the leaning weight (modes,); what each channel sees of the pitch: a
        displacement its floor's height, an acceleration nothing but the frame's own restoring forces.
    """
    structure, observed = model.structure, model.observed
    pitch, pitching = smooth_derivatives(run.table, run.step_s)
    height = np.concatenate([frame.height_m for frame in structure.frames])
    mass = np.concatenate([frame.floor_mass for frame in structure.frames])
    inertia = modes.floors.T @ (mass * height)
    weight = modes.floors.T @ (mass * STANDARD_GRAVITY)
    seen = np.zeros(len(observed.names))
    for channel, (quantity, floor) in enumerate(zip(observed.quantity, observed.floor, strict=True)):
        if quantity in (DISPLACEMENT, ABSOLUTE_DISPLACEMENT):
            seen[channel] = height[floor]
    return pitch, pitching, inertia, weight, seen


def tilt_inputs(
    model: Any,
    assembly: Any,
    modes: Modes,
    number: int,
    middle: np.ndarray,
    at: np.ndarray,
    known: KnownForces,
) -> tuple[KnownForces, np.ndarray]:
    """Return known forces with those of an assembly's tilt, and what it adds to the channels [SI], (samples, channels).

    The inertia of the pitching floors is left out of the forces at the samples: an absolute acceleration shows it
    through the floors' own motion, not at once.

    Args:
        model: The baseline model.
        assembly: The assembly, with its tilt [rad s^2/m].
        modes: Its modes.
        number: Number of the run.
        middle: Midpoints of the substeps [s], shape (samples, substeps).
        at: Times of the samples [s], shape (samples,).
        known: The other known forces.
    """
    run = model.observed.runs[number]
    pitch, pitching, inertia, weight, seen = tilt_series(model, modes, run)
    size = assembly.table_tilt
    series = [(np.interp(middle, at, one), one) for one in (pitch, pitching)]
    leaning = known.with_one(*series[0], size * weight)
    return leaning.with_one(*series[1], -size * inertia, at_samples=False), size * pitch[:, None] * seen
