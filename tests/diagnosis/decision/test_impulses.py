"""Short pushes on a floor that nothing makes are told, and nothing else is taken for one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import StateSpace, lsim

from pounding.diagnosis.decision.impulses import impulses
from pounding.diagnosis.effects.storey import CubicStiffness
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.models import STEP_S, measured, three_storeys

WIDTH_S = 0.005


def null_model(model: Model) -> Filtered:
    return run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0, 1), 0.01), (0, 1))


def answered(force: np.ndarray, floor: int) -> np.ndarray:
    """Return what a force on a floor adds to the channels of the bench, (samples, 5)."""
    (frame,) = three_storeys().frames
    squares, shapes = np.linalg.eigh(frame.stiffness / 6.5)
    damping = 6.5 * shapes @ np.diag(0.02 * np.sqrt(squares)) @ shapes.T
    still, inverse = np.zeros((3, 3)), np.eye(3) / 6.5
    system = np.block([[still, np.eye(3)], [-inverse @ frame.stiffness, -inverse @ damping]])
    push = np.concatenate([np.zeros(3), inverse[:, floor - 1]])[:, None]
    at = STEP_S * np.arange(len(force))
    states = lsim(StateSpace(system, push, np.eye(6), np.zeros((6, 1))), force, at)[1]
    acceleration = (states @ system.T)[:, 3:] + force[:, None] * push[3:].T
    return np.column_stack([acceleration, states[:, [0, 2]]])


def struck(times: list[float], floor: int, momentum: float) -> Model:
    """Return the bench, struck on a floor at some times of its first run."""
    model = measured()
    first, second = model.observed.runs
    at = STEP_S * np.arange(len(first.table))
    force = np.zeros(len(at))
    for time in times:
        inside = (at >= time) & (at < time + WIDTH_S)
        force[inside] += momentum / WIDTH_S * np.sin(np.pi * (at[inside] - time) / WIDTH_S)
    runs = (replace(first, measured=first.measured + answered(force, floor)), second)
    return Model(model.structure, replace(model.observed, runs=runs), model.prior)


def test_blows_are_told_with_their_floor_and_times() -> None:
    model = struck([1.3, 2.6], 2, 0.1)
    found = impulses(model, null_model(model))
    assert found is not None
    assert found.place == ("bench", 2)
    assert [name for name, _ in found.times] == ["run1.csv", "run1.csv"]
    assert [time for _, time in found.times] == pytest.approx([1.3, 2.6], abs=0.01)
    assert "short pushes at floor 2 of bench" in found.sentence()
    assert "1.30, 2.60 s" in found.sentence()


def test_a_good_model_and_one_blow_are_no_blows() -> None:
    assert impulses(measured(), null_model(measured())) is None
    once = struck([1.3], 2, 0.1)
    assert impulses(once, null_model(once)) is None


def test_the_ends_of_a_run_are_no_blows() -> None:
    """A low-pass has no samples beyond them, and what it makes up answers like a push."""
    end = STEP_S * len(measured().observed.runs[0].table)
    model = struck([0.03, end - 0.04], 2, 0.1)
    assert impulses(model, null_model(model)) is None


def test_an_effect_that_acts_all_the_time_is_no_blow() -> None:
    spring = CubicStiffness(index=1, frame="bench", storey=2)
    model = measured([(spring, np.array([2e10]))])
    assert impulses(model, null_model(model)) is None


def test_the_flank_of_a_touch_is_no_blow() -> None:
    pushed = struck([1.3, 2.6], 2, 0.1)
    filtered = null_model(pushed)
    # The time about a touch in which no push is looked for ends with the largest answer, 1 ms after a push began.
    at = STEP_S * np.arange(len(pushed.observed.runs[0].table))
    ends = [time + 0.003 - SETTINGS.pushes.beside_contact_s for time in (1.3, 2.6)]
    touching = np.any([(at > end - 0.02) & (at < end) for end in ends], axis=0).astype(float)
    runs = tuple(replace(run, contact=touching[: len(run.table), None]) for run in pushed.observed.runs)
    told = Model(pushed.structure, replace(pushed.observed, runs=runs), pushed.prior)
    assert impulses(told, filtered) is None
