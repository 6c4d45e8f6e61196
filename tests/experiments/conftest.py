from __future__ import annotations

import numpy as np
import pytest

from pounding import frames
from pounding.experiments.records import Record
from pounding.experiments.rig.shaking import shake


def _record(samples=400, step_s=0.0036, name="noise", peak_g=0.3):
    """Noise under an envelope, at model scale."""
    history = np.random.default_rng(5).normal(size=samples) * np.hanning(samples)
    history *= peak_g * 9.80665 / np.abs(history).max()
    return Record(name=name, acceleration_m_s2=history, step_s=step_s, source="made for a test")


@pytest.fixture(scope="session")
def noise():
    """Makes short records of noise at model scale."""
    return _record


@pytest.fixture(scope="session")
def stick():
    """A two-storey stick."""
    definition = frames.StickFrame(
        name="stick",
        storeys=2,
        storey_height_m=0.3,
        floor_mass_kg=[6.0, 5.0],
        damping_ratio=0.01,
        frequency_hz=[3.0],
    )
    return frames.build(definition)


@pytest.fixture(scope="session")
def plate():
    """Frame 5A of the thesis."""
    return frames.build(frames.load("5A"))


@pytest.fixture(scope="session")
def shaken_stick(stick):
    return shake(stick, _record())


@pytest.fixture(scope="session")
def shaken_plate(plate):
    return shake(plate, _record())
