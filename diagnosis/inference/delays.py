"""What the noise of the readings adds to the slopes of the likelihood by the channels' delays.

The signature of a delay is that of a predicted motion, which no noise has, as its information is to be the motion's. But a
late channel is put in step with its noise (`model.shifting`), and so the likelihood's slope has the noise's rate too. It is
small beside what a delay's signature promises, and yet all that there is where every channel and the table are late
together: nothing tells of that, and the least slope promises as much as one likes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pounding.diagnosis.effects.bases import Departure
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.filtering import Filtered, assembly_of, run_signatures
from pounding.diagnosis.inference.posterior import product
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import CHANNEL_DELAY
from pounding.diagnosis.model.terms import Motion, channel_term


def late_channels(model: Model, effects: Sequence[Effect]) -> np.ndarray:
    """Return which channels the nuisance parameters, then effects, make late, shape (nuisance + effects, channels).

    Args:
        model: The baseline model.
        effects: The effects.
    """
    channels = np.arange(len(model.observed.names))
    ours = [[one.place] if one.kind == CHANNEL_DELAY else [] for one in model.parameters]
    theirs = [
        list(one.places) if isinstance(one, Departure) and one.parameter == CHANNEL_DELAY else []
        for one in effects
    ]
    return np.array([np.isin(channels, places) for places in ours + theirs])


def slopes_of_noise(
    model: Model, filtered: Filtered, number: int, motion: Motion, residual: np.ndarray
) -> np.ndarray:
    """Return what the noise adds to the slope of the log likelihood by each channel's delay [1/s], shape (channels,).

    Args:
        model: The baseline model.
        filtered: The filtered model.
        number: Number of the run among those of the filtered model.
        motion: The motion of this run.
        residual: Its whitened innovations, shape (samples * channels,).
    """
    assembly = assembly_of(model, filtered, number)
    # What was not measured has no noise.
    noise = np.nan_to_num(
        model.faults.rates(assembly, filtered.runs[number]) / motion.reads - motion.output_rate
    )
    groups = [[channel_term(model, channel, -series)] for channel, series in enumerate(noise.T)]
    return product(run_signatures(model, filtered, number, groups), residual)
