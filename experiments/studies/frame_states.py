"""Frames of the thesis with other first frequencies and damping ratios than the baseline model's, to search for effects.

The printed first frequencies are those of `pounding.experiments.rig.states`, and what these studies fit as the state of a
frame is the place where its first frequency is printed. Here all frequencies of a frame move by one factor, so that one
decomposition into modes serves all models; an experiment takes a state through the joints instead.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.records import Record
from pounding.experiments.rig.states import LABORATORY, Frequency, first_frequency, strong_frequencies
from pounding.experiments.studies import single_changes as change
from pounding.experiments.studies.single_changes import Storeys, storeys
from pounding.experiments.studies.table_4_1 import BLIND, build
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.response.exact import forced, modal_poles

Real = NDArray[np.float64]
TWO_STATES: dict[str, Frequency] = {name: strong_frequencies([name])[0] for name in LABORATORY}
"""The states of strong motion of the frames alone, under any record: chosen with all peaks seen."""
MODES = 5
"""Modes that are followed; the sixth of 15A is at 25 Hz, above what a scaled record shakes."""


@dataclass(frozen=True)
class Setting:
    """What is believed of the frames and of the table.

    Attributes:
        damping: Damping ratio of all modes of all frames [-]; None for each frame's own from Table 3.1.
        factor: By which all printed frequencies are multiplied [-].
        gain: Motion of the table over the record [-].
    """

    damping: float | None = None
    factor: float = 1.0
    gain: float = 1.0


@cache
def baseline(frame: str) -> Storeys:
    """Return a frame of the thesis as the baseline model has it, condensed to its floors."""
    return storeys(build(frame, BLIND))


def in_state(frame: str, state: Frequency, setting: Setting) -> ReducedFrame:
    """Return a frame for a rig in a state: stiffness by its first frequency, damping ratio of every mode as set.

    Args:
        frame: Name of the frame.
        state: Its state.
        setting: Frequency factor and damping; the gain is the table's.
    """
    known = build(frame, BLIND)
    scale = first_frequency(frame, state) * setting.factor / float(known.frequencies_hz[0])
    damping = scale * (setting.damping or known.damping_ratio) / known.damping_ratio
    return replace(
        known,
        frequencies_hz=scale * known.frequencies_hz,
        stiffness=scale**2 * known.stiffness,
        damping=damping * known.damping,
        damping_ratios=(damping / scale) * known.damping_ratios,
    )


def displacements(
    frame: str, floors: list[int], motion: Record, first_hz: float, damping: float | None
) -> Real:
    """Return the exact displacements of floors relative to the table (samples, floors) [m].

    Args:
        frame: Name of the frame; its shapes and the ratios of its frequencies are the baseline model's.
        floors: Floors, from 1.
        motion: Motion of the table at the frame's scale.
        first_hz: First frequency [Hz].
        damping: Damping ratio of all modes [-]; None for the frame's own.
    """
    body = baseline(frame)
    basis = change.modes(body)
    count = min(MODES, len(basis.omega))
    omega = basis.omega[:count] * (2 * np.pi * first_hz / basis.omega[0])
    shapes = basis.shapes[:, :count]
    poles = modal_poles(omega, damping or body.ratio, shapes, body.mass, np.ones(len(body.mass)))
    found, _ = forced(poles, motion.acceleration_m_s2, motion.step_s, outputs=np.array(floors) - 1)
    return np.asarray(found, np.float64)
