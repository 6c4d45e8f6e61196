"""What sensors and logger show of the engine's motion: places, gains, delays, offsets, the table's pitch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.interpolate import CubicHermiteSpline, CubicSpline

from pounding.diagnosis.model.model import Acting, Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.predictor import (
    ABSOLUTE_DISPLACEMENT,
    ACCELERATION,
    TABLE_DISPLACEMENT,
    TABLE_MOVED,
    VELOCITY,
)
from pounding.diagnosis.model.tilt import tilt_series
from pounding.experiments.rig.motion import FrameMotion


def channels(
    model: Model,
    assembly: Assembly,
    number: int,
    motion: FrameMotion,
    values: np.ndarray,
    effects: Sequence[tuple[Acting, np.ndarray]],
    mean_s: float = 0.0,
) -> np.ndarray:
    """Return what the channels show of the engine's motion in SI, shape (samples, channels), sensors' errors included.

    Args:
        model: The baseline model.
        assembly: The assembly of nuisance parameters and effects.
        number: Number of the run.
        motion: Motion of all frames as one body.
        values: Nuisance parameters in their own units, shape (nuisance,).
        effects: Effects that act, each with its SI parameters, shape (parameters,).
        mean_s: Time over which accelerations are averaged [s]; at zero they are those of the moment.
    """
    run, observed = model.observed.runs[number], model.observed
    times = np.arange(len(run.table)) * run.step_s
    # Sensors that are late show the motion of before.
    place = CubicHermiteSpline(motion.time_s, motion.displacement_m, motion.velocity_m_s)
    rate = CubicHermiteSpline(motion.time_s, motion.velocity_m_s, motion.acceleration_m_s2)
    table = CubicSpline(times, model.predict(values, None, effects, [number]).before[0][:, TABLE_MOVED])
    outputs = np.zeros((len(times), len(observed.names)))
    modes = model.plain_modes(assembly)
    tilted = tilt_series(model, modes, run) if assembly.table_tilt else None
    for c, (quantity, f) in enumerate(zip(observed.quantity, observed.floor, strict=True)):
        true = times / (1 + assembly.channel_clock[c]) - assembly.channel_delay_s[c]
        late = np.clip(true, 0.0, motion.time_s[-1])
        if quantity == ACCELERATION:
            relative = rate(late, 1) if mean_s == 0.0 else _mean_rate(rate, late, mean_s, motion.time_s[-1])
            shown = relative[:, f] + model.table_at(assembly, number, late)
        elif quantity == VELOCITY:
            shown = rate(late)[:, f]
        elif quantity == TABLE_DISPLACEMENT:
            shown = table(late)
        else:
            shown = place(late)[:, f]
            if quantity == ABSOLUTE_DISPLACEMENT:
                shown = shown + table(late)
        if tilted is not None:
            pitch, pitching, *_, seen = tilted
            shown = shown + assembly.table_tilt * pitch * seen[c]
            if quantity == ACCELERATION:
                height = np.concatenate([frame.height_m for frame in model.structure.frames])
                shown = shown + assembly.table_tilt * pitching * height[f]
        outputs[:, c] = (1 + assembly.channel_gain[c]) * shown + assembly.channel_offset[c]
    return outputs


def _mean_rate(velocity: CubicHermiteSpline, at: np.ndarray, over_s: float, end_s: float) -> np.ndarray:
    """Return the mean acceleration over `over_s` about each time."""
    before, after = np.maximum(at - over_s / 2, 0.0), np.minimum(at + over_s / 2, end_s)
    return np.asarray((velocity(after) - velocity(before)) / (after - before)[:, None])
