"""Joint stiffness from a measured first frequency."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import brentq

from frames.building import build
from frames.definition import Joints, PlateFrame, changed
from frames.errors import FrameError

PRACTICALLY_RIGID = 1e6
"""Where the search begins [N m/rad]."""

NEARLY_HINGED = 1.0
"""Where it gives up [N m/rad]."""

CLOSE = 1e-8
"""Fraction to which the stiffness is found."""


def joint_stiffness(frame: PlateFrame, first_hz: float, **options: Any) -> float:
    """Return the stiffness of one joint [N m/rad] that gives a frame its first frequency along x.

    The first frequency alone decides; everything else the model says is a prediction.

    Args:
        frame: The frame; its own joint stiffnesses do not matter.
        first_hz: First frequency along x [Hz].
        options: Options of `frames.build` other than ``joints`` and ``calibration``.

    Raises:
        FrameError: No joint stiffness gives this frequency.
    """

    def miss(logarithm: float) -> float:
        return float(np.log(_first(frame, float(np.exp(logarithm)), options) / first_hz))

    high = low = np.log(PRACTICALLY_RIGID)
    if miss(high) < 0.0:
        rigid = first_hz * np.exp(miss(high))
        raise FrameError(
            f"frame {frame.name}: {first_hz:g} Hz is above the {rigid:.4g} Hz of rigid joints; check masses "
            "and thicknesses"
        )
    # Downwards in steps, so that the search does not run far into joints that let the frame buckle.
    while miss(low) > 0.0:
        high, low = low, low - np.log(4.0)
        if low < np.log(NEARLY_HINGED):
            raise FrameError(f"frame {frame.name}: {first_hz:g} Hz is below what nearly hinged joints give")
    return float(np.exp(brentq(miss, low, high, xtol=CLOSE)))


def with_joint_stiffness(frame: PlateFrame, stiffness_n_m_per_rad: float, name: str = "stated") -> PlateFrame:
    """Return a frame with one joint stiffness, under the name of a calibration."""
    return changed(frame, joints=Joints(default=name, stiffness_n_m_per_rad={name: stiffness_n_m_per_rad}))


def _first(frame: PlateFrame, stiffness: float, options: dict[str, Any]) -> float:
    reduced = build(with_joint_stiffness(frame, stiffness), use_cache=False, **options)
    return float(reduced.frequencies_hz[0])
