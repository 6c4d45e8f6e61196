"""Joint stiffness from a measured first frequency."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq

from pounding.frames.building import build
from pounding.frames.definition import Joints, PlateFrame, changed
from pounding.frames.errors import FrameError

RANGE_N_M_PER_RAD = (1.0, 1e6)
"""The search gives up below (nearly hinged) and above (practically rigid) [N m/rad]."""

FACTOR = 2.0
"""Step by which the search widens around the joints that the frame has."""

CLOSE = 1e-6
"""Fraction to which the stiffness is found."""


def joint_stiffness(frame: PlateFrame, first_hz: float, **options: Any) -> float:
    """Return the stiffness of one joint [N m/rad] that gives a frame its first frequency along x.

    The first frequency alone decides; everything else the model says is a prediction.

    Args:
        frame: The frame; its own joint stiffness is where the search begins.
        first_hz: First frequency along x [Hz].
        options: Options of `frames.build` other than ``joints`` and ``calibration``.

    Raises:
        FrameError: No joint stiffness gives this frequency.
    """

    def miss(logarithm: float) -> float:
        return float(np.log(_first(frame, float(np.exp(logarithm)), options) / first_hz))

    low = high = float(np.log(frame.joint_stiffness()))
    least, most = np.log(RANGE_N_M_PER_RAD)
    while miss(low) > 0.0:
        high, low = low, low - np.log(FACTOR)
        if low < least:
            raise FrameError(f"frame {frame.name}: {first_hz:g} Hz is below what nearly hinged joints give")
    while miss(high) < 0.0:
        low, high = high, high + np.log(FACTOR)
        if high > most:
            rigid = first_hz * np.exp(miss(high))
            raise FrameError(
                f"frame {frame.name}: {first_hz:g} Hz is above the {rigid:.4g} Hz of rigid joints; check "
                "masses and thicknesses"
            )
    return float(np.exp(brentq(miss, low, high, xtol=CLOSE)))


def with_joint_stiffness(frame: PlateFrame, stiffness_n_m_per_rad: float, name: str = "stated") -> PlateFrame:
    """Return a frame with one joint stiffness, under the name of a calibration.

    Args:
        frame: The frame; it is not changed.
        stiffness_n_m_per_rad: Stiffness of one joint [N m/rad].
        name: Name of the calibration.
    """
    return changed(frame, joints=Joints(default=name, stiffness_n_m_per_rad={name: stiffness_n_m_per_rad}))


def _first(frame: PlateFrame, stiffness: float, options: dict[str, Any]) -> float:
    # Without any fixed-interface mode the first frequency is right to 1e-6 already.
    reduced = build(with_joint_stiffness(frame, stiffness), modes=0, use_cache=False, **options)
    return float(reduced.frequencies_hz[0])
