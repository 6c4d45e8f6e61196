"""Joints from rigid to soft, as modal data show them: their whole range is known, from a few exact models of the frame.

A frame whose baseline has rigid joints can so have flexible ones.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline

from pounding import frames
from pounding.diagnosis.case.case import CaseFrame, Prior
from pounding.diagnosis.effects.bases import FrameEffect
from pounding.diagnosis.effects.catalogue import Quantity, Scales
from pounding.diagnosis.model.frames import definition
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.storeys import StoreyFrame, Structure, from_reduced
from pounding.frames.calibration import with_joint_stiffness

COMPLIANCES = (0.0, 1 / 8000, 1 / 3000, 1 / 1500, 1 / 900, 1 / 500, 1 / 250)
"""Joint compliances [rad/(N m)] at which a frame is modelled; its flexibility is interpolated between them."""


@dataclass(frozen=True)
class Joints(FrameEffect):
    """Joints whose rotational stiffness differs from that of the baseline model, from rigid to soft."""

    name = "joint_flexibility"
    quantities = (Quantity("joint_stiffness", "N m/rad"),)
    sign = 1
    flexibility: CubicSpline | None = None

    def size(self, model: Model, scales: Scales | None, shape: tuple[float, ...]) -> float:
        """Return the compliance [rad/(N m)] at which the roof gives way twice as much as with rigid joints."""
        assert self.flexibility is not None
        fine = np.linspace(COMPLIANCES[1], COMPLIANCES[-1], 400)
        roof = self.flexibility(fine)[:, -1, -1] / self.flexibility(0.0)[-1, -1]
        return float(np.interp(2.0, roof, fine))

    def values(self, amplitude: float, shape: tuple[float, ...]) -> np.ndarray:
        """Return the joints' stiffness [N m/rad]."""
        return np.array([1 / max(amplitude, 1e-9)])

    def apply(self, assembly: Assembly, values: np.ndarray, model: Model) -> None:
        """Put joints of this stiffness in the place of the baseline model's."""
        assert self.flexibility is not None
        span = self.span(model)
        soft = self.flexibility(np.clip(1 / float(values[0]), 0.0, COMPLIANCES[-1]))
        assembly.stiffness[span, span] += np.linalg.inv(soft) - self.storeys(model).stiffness


def joints(frame: CaseFrame) -> Joints | None:
    """Return the joints of a case's frame as an effect, or None for a frame without any."""
    plain = definition(frame)
    if not isinstance(plain, frames.PlateFrame):
        return None
    flexibility = []
    for compliance in COMPLIANCES:
        if compliance:
            options: dict[str, Any] = {"joints": "calibrated"}
            made = with_joint_stiffness(plain, 1 / compliance)
        else:
            options, made = {"joints": "rigid"}, plain
        reduced = frames.build(made, p_delta=frame.p_delta, **options)
        flexibility.append(np.linalg.inv(from_reduced(reduced).stiffness))
    return Joints(frame=frame.name, flexibility=CubicSpline(COMPLIANCES, np.array(flexibility)))


def alone(frame: StoreyFrame, prior: Prior) -> Model:
    """Return the baseline model of a frame, without any measured history."""
    nothing = Observations((), np.zeros(0), np.zeros(0, int), np.zeros(0, int), ())
    return Model(Structure((frame,)), nothing, prior)
