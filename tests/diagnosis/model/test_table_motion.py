"""What the table does between samples: stated in the case, followed by the model, and worth stating."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from pounding.diagnosis.case.case import Case, CaseFrame, Channel, Run
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.case.writing import write_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.slowing import slowed
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.model.table_motion import HELD, LINEAR, SMOOTH, TableMotion
from pounding.diagnosis.model.twin import simulate_engine

FREQUENCY_HZ, RATIO, STEP_S, SAMPLES = 68.6, 0.05, 0.0016384, 3000
FRAME = CaseFrame("bench", 1, storey_height_m=0.1, floor_mass_kg=(1.0,), frequency_hz=(FREQUENCY_HZ,),
                  damping_ratio=(RATIO,))  # fmt: skip


def driven(held: bool, interpolation: str | None) -> Case:
    """A linear oscillator as scipy drives it: the table's acceleration held between samples, or straight lines."""
    omega = 2 * np.pi * FREQUENCY_HZ
    rng = np.random.default_rng(4)
    table = np.convolve(rng.standard_normal(SAMPLES), np.ones(3) / 3, "same")
    times = STEP_S * np.arange(SAMPLES)
    system = StateSpace(
        [[0.0, 1.0], [-(omega**2), -2 * RATIO * omega]], [[0.0], [-1.0]], [[1.0, 0.0]], [[0.0]]
    )
    _, answer, _ = lsim(system, table, times, interp=not held)
    channels = (
        Channel("table", "table_acceleration", "m/s^2", interpolation=interpolation),
        Channel("d1", "relative_displacement", "mm", frame="bench", floor=1),
    )
    run = Run("run1.csv", None, times, STEP_S, np.column_stack([table, answer]))
    return Case("driven", Path("driven"), (FRAME,), (run,), channels)


def model_of(case: Case) -> Model:
    structure = Structure(baseline_frames(case))
    return Model(structure, observe(case, structure), case.prior)


def error(model: Model, outputs: np.ndarray) -> float:
    measured = model.observed.runs[0].measured
    return float(np.sqrt(np.mean((outputs - measured) ** 2) / np.mean(measured**2)))


def predicted(model: Model) -> np.ndarray:
    return model.predict(np.zeros(len(model.std))).outputs[0]


@pytest.mark.parametrize(("held", "stated"), [(True, HELD), (False, LINEAR)])
def test_what_a_linear_oscillator_does_is_reproduced_better_where_it_is_stated(
    held: bool, stated: str, tmp_path: Path
) -> None:
    write_case(driven(held, stated), tmp_path)
    model = model_of(read_case(tmp_path))
    unstated = model_of(driven(held, None))
    assert error(model, predicted(model)) < 0.2 * error(unstated, predicted(unstated))
    assert error(model, predicted(model)) < 0.01


@pytest.mark.parametrize("of_half_the_rate", [0.1, 0.5, 0.9])
def test_between_samples_a_smooth_table_has_nothing_above_half_the_rate(of_half_the_rate: float) -> None:
    """A spline through the samples errs by 2 % of a shaking at half of that, and by half of one at nine tenths."""
    omega = of_half_the_rate * np.pi / 0.01
    smooth = TableMotion(np.sin(omega * 0.01 * np.arange(1000)), 0.01, SMOOTH, 0.005)
    times = 0.01 * (np.arange(100, 900)[:, None] + [0.0, 0.25, 0.61])
    np.testing.assert_allclose(smooth.at(times), np.sin(omega * times), atol=2e-3)
    np.testing.assert_allclose(smooth.slope(times) / omega, np.cos(omega * times), atol=0.02)


@pytest.mark.parametrize(("held", "stated"), [(True, HELD), (False, LINEAR)])
def test_the_engine_follows_what_is_stated(held: bool, stated: str) -> None:
    model = model_of(driven(held, stated))
    assert error(model, simulate_engine(model, np.zeros(len(model.std)), (), [0])[0]) < 0.02


def test_a_held_table_is_late_by_half_a_sample_where_samples_are_left_out() -> None:
    model, unstated = (model_of(driven(True, stated)) for stated in (HELD, None))
    slow, early = (one.seeing(slowed(one.observed, 300.0)) for one in (model, unstated))
    assert slow.observed.slower > 1
    assert slow.observed.runs[0].table_between == SMOOTH
    assert error(slow, predicted(slow)) < 0.5 * error(early, predicted(early))


def test_a_delay_moves_a_held_table_by_less_than_a_substep() -> None:
    samples = np.array([0.0, 1.0, 1.0, -2.0, 0.0])
    held = TableMotion(samples, 0.01, HELD, 0.005)
    middles = 0.01 * (np.arange(5)[:, None] + [0.25, 0.75])
    np.testing.assert_allclose(held.at(middles), np.repeat(samples[:, None], 2, axis=1), atol=1e-12)
    # A tenth of a substep late: a tenth of the first half of each sample is still the one before.
    late = held.at(middles - 0.0005)
    np.testing.assert_allclose(late[1:, 0], 0.9 * samples[1:] + 0.1 * samples[:-1], atol=1e-12)
    np.testing.assert_allclose(late[:, 1], samples, atol=1e-12)


@pytest.mark.parametrize(
    ("channel", "said"),
    [
        (0, "unknown interpolation 'zho'; did you mean 'zoh'"),
        (1, "interpolation says what the table does between samples"),
    ],
)
def test_what_cannot_be_stated_is_refused(tmp_path: Path, channel: int, said: str) -> None:
    case = driven(True, None)
    wrong = replace(case.channels[channel], interpolation="zoh" if channel else "zho")
    channels = [wrong if number == channel else one for number, one in enumerate(case.channels)]
    write_case(replace(case, channels=tuple(channels)), tmp_path)
    with pytest.raises(CaseError, match=said):
        read_case(tmp_path)
