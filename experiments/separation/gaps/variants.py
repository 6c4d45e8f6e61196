"""A frame with other damping, floor masses or stiffness: a modal model made from the same reduced frame."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh

from pounding.experiments.errors import ExperimentError
from pounding.frames import ReducedFrame
from pounding.frames.response.exact import Poles, modal_poles


@dataclass(frozen=True)
class ModalFrame:
    """Frequencies and shapes of a frame, its damping still open.

    Attributes:
        circular: Circular frequencies (p,), lowest first [rad/s].
        shapes: Mass-normalised shapes (n, p).
        mass: Mass matrix (n, n) [kg].
        influence: Coordinates under a unit translation of the table (n,).
        floor_x: Coordinate of each floor's x displacement (storeys,).
    """

    circular: NDArray[np.floating[Any]]
    shapes: NDArray[np.floating[Any]]
    mass: NDArray[np.floating[Any]]
    influence: NDArray[np.floating[Any]]
    floor_x: NDArray[np.intp]

    @property
    def frequency_hz(self) -> float:
        """First natural frequency [Hz]."""
        return float(self.circular[0] / (2.0 * np.pi))

    def poles(self, damping_ratio: float) -> Poles:
        """Return the poles with one damping ratio in every mode, a fraction."""
        return modal_poles(self.circular, damping_ratio, self.shapes, self.mass, self.influence)

    def lowest(self, modes: int) -> ModalFrame:
        """Return the frame with its lowest modes only."""
        return replace(self, circular=self.circular[:modes], shapes=self.shapes[:, :modes])


def modal_frame(
    frame: ReducedFrame, *, added_floor_mass_kg: float = 0.0, stiffness_factor: float = 1.0
) -> ModalFrame:
    """Return a frame with mass added at the centre of every floor and its stiffness multiplied.

    Floors are rigid in their plane, so a mass at the centre enters at the floor's x displacement alone; its
    rotary inertia and its part in P-Delta are left out.

    Args:
        frame: The reduced frame as it stands.
        added_floor_mass_kg: Mass added to every floor [kg].
        stiffness_factor: Factor of the whole stiffness matrix.

    Raises:
        ExperimentError: A negative mass or a factor that is not positive.
    """
    if added_floor_mass_kg < 0.0 or stiffness_factor <= 0.0:
        raise ExperimentError(
            f"a mass of {added_floor_mass_kg:g} kg and a stiffness factor of {stiffness_factor:g} cannot be "
            "put on a frame: mass must not be negative, the factor must be above zero"
        )
    mass = np.array(frame.mass, float)
    mass[frame.floor_x, frame.floor_x] += added_floor_mass_kg
    squares, shapes = eigh(stiffness_factor * np.asarray(frame.stiffness), mass)
    if squares[0] <= 0.0:
        raise ExperimentError(f"frame {frame.name} has lost its stiffness: its first frequency is not real")
    influence = np.asarray(frame.influence)
    return ModalFrame(np.sqrt(squares), shapes, mass, influence, np.asarray(frame.floor_x))


def tuned_frame(frame: ReducedFrame, frequency_hz: float, *, added_floor_mass_kg: float = 0.0) -> ModalFrame:
    """Return a frame whose first frequency is a given one, its stiffness multiplied as that needs.

    Args:
        frame: The reduced frame as it stands.
        frequency_hz: Wanted first frequency with the added mass [Hz].
        added_floor_mass_kg: Mass added to every floor [kg].
    """
    if frequency_hz <= 0.0:
        raise ExperimentError(f"a first frequency must be above zero, not {frequency_hz:g} Hz")
    plain = modal_frame(frame, added_floor_mass_kg=added_floor_mass_kg)
    factor = (frequency_hz / plain.frequency_hz) ** 2
    return replace(plain, circular=plain.circular * factor**0.5)


def effective_base_mass(base_hz: float, loaded_hz: float, added_kg: float) -> float:
    """Return the moving mass that explains how an added mass lowers a frequency [kg].

    With the mass added in proportion to what is there, ``(base_hz / loaded_hz)^2 = 1 + added / base``.

    Args:
        base_hz: First frequency without the added mass [Hz].
        loaded_hz: First frequency with it [Hz].
        added_kg: The added mass [kg].
    """
    return added_kg / ((base_hz / loaded_hz) ** 2 - 1.0)
