"""The world of shear buildings moves as it should, and knows nothing of the project: `python -m tests.shear_world`."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.signal import lsim

from pounding import frames
from pounding.diagnosis.case.reading import read_case
from tests.shear_world.building import Building, Real, scattered
from tests.shear_world.cases import CASES, EIGHT, THREE
from tests.shear_world.integration import respond
from tests.shear_world.laws import Cubic, Damper, Elastoplastic, Law, ProgressiveStop
from tests.shear_world.making import make
from tests.shear_world.motion import motions

WORLD = Path(__file__).parents[1] / "shear_world"


def system(building: Building) -> tuple[np.ndarray, np.ndarray]:
    """The state matrices of a linear building: displacements and velocities under the table's acceleration."""
    count = building.storeys
    springs = -np.hstack([building.stiffness(), building.damping()]) / building.masses[:, None]
    state = np.vstack([np.hstack([np.zeros((count, count)), np.eye(count)]), springs])
    return state, np.concatenate([np.zeros(count), -np.ones(count)])[:, None]


@pytest.mark.parametrize("believed", [THREE, EIGHT], ids=["3", "8"])
def test_a_linear_building_moves_as_its_state_matrices_say(believed: Building) -> None:
    building = scattered(believed, np.random.default_rng(4))
    shaken = motions(np.random.default_rng(5))[0]
    times, fine = np.arange(501) / 500, np.arange(8001) / 8000
    found = respond(building, (), shaken, times)
    state, table = system(building)
    count = building.storeys
    # Of the floors: displacement, velocity, acceleration in the room.
    seen = np.vstack([np.eye(2 * count), state[count:]])
    expected = lsim((state, table, seen, np.zeros((3 * count, 1))), shaken(fine), fine)[1][::16].T
    ours = np.vstack([found.displacement, found.velocity, found.acceleration])
    assert np.abs(ours - expected).max(axis=1) == pytest.approx(0, abs=1e-4 * np.abs(expected).max())
    assert np.all(np.abs(ours - expected).max(axis=1) < 3e-4 * np.abs(expected).max(axis=1))


def test_a_free_decay_is_that_of_the_matrix_exponential_and_of_every_ratio() -> None:
    building = scattered(THREE, np.random.default_rng(1))
    times = np.arange(501) / 500
    start = np.array([1e-3, 2e-3, -1e-3, 0.0, 0.02, 0.01])
    found = respond(building, (), lambda _: 0.0, times, start=start)
    state, _ = system(building)
    expected = np.stack([expm(time * state) @ start for time in times], axis=1)
    assert np.abs(np.vstack([found.displacement, found.velocity]) - expected).max() < 1e-4 * 0.02
    roots = np.linalg.eigvals(state)
    order = np.argsort(np.abs(roots))[::2]
    assert (-roots.real / np.abs(roots))[order] == pytest.approx(building.ratios)


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        (Damper(180.0, 1.5), lambda d, v: 180.0 * np.abs(v) ** 1.5 * np.sign(v)),
        (Cubic(1e9), lambda d, v: 1e9 * d**3),
        (
            ProgressiveStop(1e-3, 8e3, 4e6),
            lambda d, v: (d > 1e-3) * (8e3 * (d - 1e-3) + 4e6 * (d - 1e-3) ** 2),
        ),
    ],
    ids=["damper", "cubic", "stop"],
)
def test_a_force_in_a_storey_is_its_formula(law: Law, expected: Callable[[Real, Real], Real]) -> None:
    """What the floors' inertia and the frame leave is the force, in its storey and no other."""
    building, storey = THREE, 2
    found = respond(building, ((storey, law),), lambda time: 3 * np.sin(20 * time), np.arange(501) / 500)
    linear = building.stiffness() @ found.displacement + building.damping() @ found.velocity
    left = np.linalg.solve(building.drifts().T, -building.masses[:, None] * found.acceleration - linear)
    drift, rate = building.drifts() @ found.displacement, building.drifts() @ found.velocity
    wanted = expected(drift[storey - 1], rate[storey - 1])
    assert np.abs(wanted).max() > 1
    assert left[storey - 1] == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert left[[0, 2]] == pytest.approx(0, abs=1e-9)


def test_an_elastoplastic_force_is_that_of_play_and_stop() -> None:
    building, limit, stiffness = THREE, 2.0, 3e5
    times = np.arange(4001) / 4000
    found = respond(
        building, ((2, Elastoplastic(limit, stiffness)),), lambda time: 3 * np.sin(20 * time), times
    )
    linear = building.stiffness() @ found.displacement + building.damping() @ found.velocity
    left = np.linalg.solve(building.drifts().T, -building.masses[:, None] * found.acceleration - linear)[1]
    drift = (building.drifts() @ found.displacement)[1]
    force = 0.0
    expected = [
        force := float(np.clip(force + stiffness * by, -limit, limit)) for by in np.diff(drift, prepend=0.0)
    ]
    assert np.ptp(expected) == pytest.approx(2 * limit)
    assert np.sqrt(np.mean((left - expected) ** 2)) < 0.01 * limit


def test_a_written_case_is_read_as_it_was_made(tmp_path: Path) -> None:
    case = replace(CASES["mass"], accelerometers=(1, 5))
    assert make(tmp_path, "mass", case, seed=1).truth == {"mass": (1.5,)}
    read = read_case(tmp_path)
    assert [channel.name for channel in read.channels] == ["table", "a1", "a5", "d5"]
    assert [run.values.shape for run in read.runs] == [(4001, 4)] * 3
    believed = frames.build(frames.load(str(tmp_path / "frame.toml")))
    assert 2 * np.pi * believed.frequencies_hz == pytest.approx(case.believed.modes()[0], rel=1e-6)


@pytest.mark.parametrize("path", sorted(WORLD.glob("*.py")), ids=lambda path: path.stem)
def test_it_imports_the_diagnosis_only_to_diagnose(path: Path) -> None:
    imported = {
        name
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        for name in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [node.module or ""]
            if isinstance(node, ast.ImportFrom)
            else []
        )
    }
    ours = {name for name in imported if name.split(".")[0] == "pounding"}
    allowed = {"pounding.diagnosis.workflow", "pounding.diagnosis.report.report"}
    assert ours <= (allowed if path.stem == "__main__" else set())
