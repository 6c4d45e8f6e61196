"""States of the frames of the thesis: first frequencies that it prints for the same frame in different tests.

Free vibration and the sweep are measurements (Table 3.1); what Tables 7.2 to 7.4 list for pairs of unequal height is the
input of the thesis' own models of these pairs, and where it comes from is not said.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.records import Record
from pounding.experiments.studies import single_changes as change
from pounding.experiments.studies.single_changes import Storeys, storeys
from pounding.experiments.studies.table_4_1 import BLIND, build
from pounding.frames.reduction.reduced_frame import ReducedFrame
from pounding.frames.response.exact import forced, modal_poles

Real = NDArray[np.float64]
State = Literal["free vibration", "sweep", "unequal pair"]
STATES: tuple[State, ...] = ("free vibration", "sweep", "unequal pair")
TWO_STATES: dict[str, State] = {
    "15A": "sweep",
    "15B": "unequal pair",
    "10": "unequal pair",
    "5A": "sweep",
    "5B": "unequal pair",
}
"""The state of each frame that stands in an unequal pair of the thesis, the sweep's of the others: 15A and 5A."""
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


def first_frequency(frame: str, state: State) -> float:
    """Return the first frequency that the thesis prints for a frame in a state [Hz]."""
    if state == "unequal pair":
        return _of_unequal_pairs()[_height_mm(frame)]
    quantity = "free_vibration_hz" if state == "free vibration" else "mode1_hz"
    return float(published.table("3.1").loc[frame, ("experiment", quantity)])


def _height_mm(frame: str) -> int:
    return round(1e3 * float(baseline(frame).height_m[-1]))


@cache
def _of_unequal_pairs() -> dict[int, float]:
    """Return the first frequency [Hz] of frames without added masses in Table 7.2, the highest, by height [mm]."""
    rows = published.table("7.2")
    found: dict[int, float] = {}
    for side in ("tall", "short"):
        for height, frequency in zip(rows[f"{side}_height_mm"], rows[f"{side}_frequency_hz"], strict=True):
            found[int(height)] = max(found.get(int(height), 0.0), float(frequency))
    return found


@cache
def baseline(frame: str) -> Storeys:
    """Return a frame of the thesis as the baseline model has it, condensed to its floors."""
    return storeys(build(frame, BLIND))


def in_state(frame: str, state: State, setting: Setting) -> ReducedFrame:
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
