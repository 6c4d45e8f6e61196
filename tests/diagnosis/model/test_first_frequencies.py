"""The first frequency as it stands in the data: what must be said of another frame and what must not of friction."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.effects.catalogue import places
from pounding.diagnosis.effects.storey import CoulombFriction
from pounding.diagnosis.model.first_frequencies import frequency_warnings, measured_frequency
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.storeys import Structure
from tests.diagnosis.models import measured

FIRST_HZ = 6.806


def with_friction(force_n: float, storey: int) -> Model:
    effect = places(CoulombFriction, measured(samples=50))[storey - 1]
    return measured([(effect, np.asarray(effect.values(force_n, ())))], samples=3000)


@pytest.mark.parametrize("force_n", [16.0, 30.0])
@pytest.mark.parametrize("storey", [1, 2])
def test_friction_that_sticks_is_no_other_frame(force_n: float, storey: int) -> None:
    # An absolute acceleration follows the table far below the first mode, which friction makes low and wide.
    model = with_friction(force_n, storey)
    assert frequency_warnings(model) == []
    found = measured_frequency(model, 0, FIRST_HZ)
    assert found is not None
    assert found.holds(FIRST_HZ)


def test_without_friction_the_peak_is_the_first_mode() -> None:
    found = measured_frequency(measured(samples=3000), 0, 7.5)
    assert found is not None
    assert found.hertz == pytest.approx(FIRST_HZ, abs=found.resolution_hz)
    assert not found.holds(7.5)


def test_a_first_mode_outside_the_range_is_not_read_off_its_end() -> None:
    # 0.4 to 2 times 18 Hz holds the bench's second mode, 19 Hz, and none of the slope of its first.
    found = measured_frequency(measured(samples=3000), 0, 18.0)
    assert found is not None
    assert found.hertz > 1.05 * 0.4 * 18.0


def test_friction_of_another_simulator_is_no_other_frame(open_cases: Path) -> None:
    case = read_case(open_cases / "open-friction")
    structure = Structure(baseline_frames(case))
    assert frequency_warnings(Model(structure, observe(case, structure), case.prior)) == []
