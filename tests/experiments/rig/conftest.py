from __future__ import annotations

import pytest

from pounding.experiments.records import Record
from pounding.frames.reduction.reduced_frame import ReducedFrame
from tests.experiments.rig.models import shear, two_sines


@pytest.fixture(scope="session")
def pair() -> tuple[ReducedFrame, ReducedFrame]:
    """A frame of four storeys beside a stiffer one of two."""
    return shear(4, 2.3), shear(2, 6.1)


@pytest.fixture(scope="module")
def shaking(request: pytest.FixtureRequest) -> Record:
    """Two sines that bring first modes up, for `SHAKEN_S` of the module of tests [s]."""
    return two_sines(request.module.SHAKEN_S)
