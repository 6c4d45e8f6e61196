"""Frames of the thesis as beams that ring as the software believes them to."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from scipy.optimize import least_squares

from pounding import frames
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.beams import Beams
from pounding.diagnosis.hidden.modes import frequencies_hz

FITTED_MODES = 4


@dataclass(frozen=True)
class Designed:
    """A frame of the thesis by its drawings.

    Attributes:
        plates: Its plates and columns.
        frequencies_hz: Natural frequencies of the software's model of it [Hz], shape (modes,).
        beams: Beams like its columns and joints, nothing fitted yet.
    """

    plates: frames.PlateFrame
    frequencies_hz: np.ndarray
    beams: Beams


def designed(name: str) -> Designed:
    """Return a frame of the thesis, nothing fitted yet.

    Args:
        name: A plate frame that `frames.load` knows.

    Raises:
        CaseError: The frame is none of plates.
    """
    plates = frames.load(name)
    if not isinstance(plates, frames.PlateFrame):
        raise CaseError(
            f"effects can be hidden in plate frames only, and {name!r} is none; use 5A, 5B, 10, 15A or 15B"
        )
    reduced = frames.build(plates)
    columns = len(plates.places_m)
    strip = plates.columns.width_m * plates.columns.thickness_m**3 / 12
    bending = columns * plates.material.youngs_modulus_gpa * 1e9 * strip
    extra = np.array(plates.added_by_floor_kg) + plates.nonstructural_mass_kg / plates.storeys
    floor_mass = plates.floor_plate_mass_kg + extra
    beams = Beams(
        name,
        plates.storey_height_m,
        np.full(plates.storeys, bending),
        np.full(plates.storeys + 1, columns * plates.joint_stiffness()),
        floor_mass,
        plates.storey_columns_mass_kg,
        floor_mass * plates.plate.length_m**2 / 12,
        np.array(plates.weights_n()),
        np.array([float(np.max(reduced.damping_ratio))]),
        joint_stated=plates.joint_stiffness(),
    )
    return Designed(plates, np.asarray(reduced.frequencies_hz), beams)


@lru_cache
def baseline(name: str) -> Beams:
    """Return a frame of the thesis as beams, its two stiffnesses fitted to the software's modes.

    Args:
        name: A plate frame that `frames.load` knows.

    Raises:
        CaseError: The frame is none of plates.
    """
    frame = designed(name)
    plates, start = frame.plates, frame.beams
    target = frame.frequencies_hz[: min(FITTED_MODES, plates.storeys)]
    # The first mode is what a test knows best.
    weights = 1.0 / np.arange(1, len(target) + 1) ** 2

    def scaled(logs: np.ndarray) -> Beams:
        return replace(start, bending=start.bending * np.exp(logs[0]), joint=start.joint * np.exp(logs[1]))

    def misfit(logs: np.ndarray) -> np.ndarray:
        return np.asarray(weights * np.log(frequencies_hz(scaled(logs), len(target)) / target))

    fit = least_squares(misfit, np.zeros(2), diff_step=[1e-5, 1e-5], xtol=1e-12, ftol=1e-15, gtol=1e-15)
    return scaled(fit.x)
