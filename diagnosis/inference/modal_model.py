"""What modal tests would find on a baseline frame with effects in it: frequencies, roof stiffness, mass.

The nuisance parameters and the catalogue's effects act on the storeys' matrices exactly as they do in the diagnosis of
histories. Only joints differ: here their whole range is known, from a few exact models of the frame, so that a frame
believed with rigid joints can have flexible ones.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.linalg import eigh

from pounding import frames
from pounding.diagnosis.case.case import CaseFrame, Prior
from pounding.diagnosis.case.numbers import ModalDatum
from pounding.diagnosis.effects.catalogue import Quantity, Scales
from pounding.diagnosis.effects.frame import FrameEffect
from pounding.diagnosis.model.frames import definition
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import Assembly
from pounding.diagnosis.model.observations import Observations
from pounding.diagnosis.model.storeys import StoreyFrame, Structure, from_reduced
from pounding.frames.calibration import with_joint_stiffness

COMPLIANCES = (0.0, 1 / 8000, 1 / 3000, 1 / 1500, 1 / 900, 1 / 500, 1 / 250)
"""Joint compliances [rad/(N m)] at which a frame is modelled; its flexibility is interpolated between them."""
LINEAR = {"frame_stiffness", "storey_stiffness", "floor_mass"}
"""Nuisance parameters that a frequency depends on."""
STEP = 1e-3


@dataclass(frozen=True)
class Joints(FrameEffect):
    """Joints whose rotational stiffness differs from the believed, from rigid to soft."""

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
        """Put joints of this stiffness in the believed ones' place."""
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
    """Return a frame as believed, without any measured history."""
    nothing = Observations((), np.zeros(0), np.zeros(0, int), np.zeros(0, int), ())
    return Model(Structure((frame,)), nothing, prior)


def predicted(model: Model, assembly: Assembly, data: Sequence[ModalDatum]) -> np.ndarray:
    """Return what an assembly would show, in SI, shape (data,); NaN where it has lost its stiffness."""
    squares = eigh(assembly.stiffness, assembly.mass, eigvals_only=True)
    if squares[0] <= 0:
        return np.full(len(data), np.nan)
    hertz = np.sqrt(squares) / (2 * np.pi)
    found = []
    for datum in data:
        if datum.quantity == "frequency":
            found.append(hertz[int(datum.mode or 1) - 1])
        elif datum.quantity == "mass":
            found.append(assembly.mass.sum())
        else:
            roof = np.eye(len(hertz))[-1]
            found.append(1 / np.linalg.solve(assembly.stiffness, roof)[-1])
    return np.array(found)


def scatter(model: Model, data: Sequence[ModalDatum]) -> np.ndarray:
    """Return the covariance of the logarithms of data: their own, and what the nuisance parameters' priors bring.

    The sensitivities are those of the baseline model; they hardly change with an effect.
    """
    count = len(model.std)
    columns = []
    for number, parameter in enumerate(model.parameters):
        if parameter.kind in LINEAR:
            ends = []
            for sign in (1.0, -1.0):
                values = np.zeros(count)
                values[number] = sign * STEP
                ends.append(np.log(predicted(model, model.assemble(values), data)))
            columns.append((ends[0] - ends[1]) / (2 * STEP) * parameter.std)
    sensitivity = np.array(columns).T
    own = np.array([datum.std / datum.value for datum in data])
    return np.asarray(np.diag(own**2) + sensitivity @ sensitivity.T)
