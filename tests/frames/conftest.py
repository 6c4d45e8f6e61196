from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import eigh


def _shear_building(storeys=3, mass_kg=6.5, stiffness=20e3, ratio=0.005, damping=None):
    mass = np.diag(np.full(storeys, mass_kg))
    stiff = stiffness * (2 * np.eye(storeys) - np.eye(storeys, k=1) - np.eye(storeys, k=-1))
    stiff[-1, -1] = stiffness
    squares, shapes = eigh(stiff, mass)
    if damping is None:
        rows = shapes.T @ mass
        damping = rows.T @ np.diag(2 * ratio * np.sqrt(squares)) @ rows
    return SimpleNamespace(
        name="shear",
        storeys=storeys,
        heights_m=0.1 * np.arange(1, storeys + 1),
        mass=mass,
        stiffness=stiff,
        damping=damping,
        influence=np.ones(storeys),
        floor_x=np.arange(storeys),
        frequencies_hz=np.sqrt(squares) / (2 * np.pi),
        shapes=shapes,
        damping_ratio=ratio,
    )


@pytest.fixture
def shear_building():
    """A small shear building with the attributes of a reduced frame, so that tests need no mesh."""
    return _shear_building
