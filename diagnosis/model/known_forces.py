"""Known forces on the frames: series that each push along one direction, as the predictor takes them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class KnownForces:
    """Series of known forces, and the modal forces that a unit of each makes.

    Attributes:
        middle: The series at the middle of each substep, shape (samples, substeps, known).
        samples: The series at the samples, shape (samples, known).
        directions: Modal forces of a unit at the midpoints and at the samples, shape (2, known, modes).
    """

    middle: np.ndarray
    samples: np.ndarray
    directions: np.ndarray

    @classmethod
    def none(cls, samples: int, substeps: int, modes: int) -> KnownForces:
        """Return no forces.

        Args:
            samples: Number of samples.
            substeps: Substeps of each.
            modes: Number of modes.
        """
        return cls(np.zeros((samples, substeps, 0)), np.zeros((samples, 0)), np.zeros((2, 0, modes)))

    def with_one(
        self, middle: np.ndarray, samples: np.ndarray, direction: np.ndarray, at_samples: bool = True
    ) -> KnownForces:
        """Return these and one more.

        Args:
            middle: Its series at the middle of each substep, shape (samples, substeps).
            samples: Its series at the samples, shape (samples,).
            direction: Modal forces of a unit of it, shape (modes,).
            at_samples: Whether an acceleration shows it at once.
        """
        both = np.stack([direction, direction if at_samples else np.zeros_like(direction)])
        return KnownForces(
            np.concatenate([self.middle, middle[..., None]], axis=2),
            np.concatenate([self.samples, samples[:, None]], axis=1),
            np.concatenate([self.directions, both[:, None]], axis=1),
        )
