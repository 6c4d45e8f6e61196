"""The corrected model as files: a frame that is shaken from its file moves as the diagnosis' own run with the effects."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import structs

from pounding import frames
from pounding.diagnosis.case.case import Case, CaseFrame, Prior
from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import Effect, places
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.inference.evidence import scales
from pounding.diagnosis.inference.filtering import run_filter
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.nuisance import MODAL_DAMPING
from pounding.diagnosis.model.storeys import Structure
from pounding.diagnosis.model.twin import simulate_engine, table_of
from pounding.diagnosis.report.corrected_model import corrected_frame, on_frames
from pounding.diagnosis.report.frame_text import frame_text
from pounding.experiments.rig.motion import FrameMotion
from pounding.experiments.rig.rig import Rig, Solver
from pounding.frames.definition import Yielding
from pounding.frames.loading import parse
from tests.diagnosis.models import measured, three_storeys, with_joints_that_turn

SAMPLES = 300
BENCH = frames.StickFrame(
    name="bench",
    scale="1:20",
    storeys=3,
    storey_height_m=0.2,
    floor_mass_kg=[6.5] * 3,
    storey_stiffness_n_per_m=[6e4] * 3,
    damping_ratio=0.01,
)


def bench() -> Model:
    """The bench with joints and one short run, so that every effect has a place."""
    frame = three_storeys().frames[0]
    joints = 6e4 * frame.drift.T @ np.diag([0.3, 0.2, 0.1]) @ frame.drift
    # As of a frame of plates, whose floors carry part of each other's mass.
    mass = frame.mass + 0.3 * (np.eye(3, k=1) + np.eye(3, k=-1))
    plates = replace(frame, mass=mass, joint_derivative=joints, joint_stiffness=1000.0)
    structure = with_joints_that_turn(Structure((plates,)))
    observed = measured(samples=SAMPLES, runs=1).observed
    return Model(structure, observed, Prior())


MODEL = bench()
COUPLING = np.array([one.kind == MODAL_DAMPING for one in MODEL.parameters])
CALIBRATED = np.where(COUPLING, 0.0, 0.3 * MODEL.std * np.cos(np.arange(len(MODEL.std))))
"""Nuisance parameters that are not zero: table, masses, storeys, dampings and the discrepancy differ from the baseline.
A frame file has a damping ratio for each mode, and nothing that couples them."""


@lru_cache
def sizes() -> Any:
    """Typical sizes of the motion."""
    quiet = np.zeros(len(MODEL.std))
    return scales(MODEL, run_filter(MODEL, quiet, starting_noise(MODEL, (0,), 0.01), (0,)))


def usual(effect: Effect) -> np.ndarray:
    """Return the parameters of an effect as strong as its prior expects."""
    shapes = effect.grid(sizes())
    shape = shapes[len(shapes) // 2]
    return effect.values((effect.sign or 1) * effect.size(MODEL, sizes(), shape), shape)


def effect_of(name: str) -> Effect:
    kind = next(kind for kind in kinds() if kind.name == name)
    return list(places(kind, MODEL))[-1]


def on_file(acting: list[tuple[Effect, np.ndarray]]) -> str:
    """Return the text of the frame file with effects in it."""
    found = on_frames(MODEL, CALIBRATED, acting)
    return frame_text(
        corrected_frame(found, 0, BENCH, "bench"), MODEL.structure.frames[0], "Found.", found.beside
    )


def own_run(acting: list[tuple[Effect, np.ndarray]], values: np.ndarray = CALIBRATED) -> FrameMotion:
    """Return the diagnosis' own run with the effects and other nuisance parameters."""
    motions: list[FrameMotion] = []
    simulate_engine(MODEL, values, acting, [0], {0: motions.append})
    return motions[0]


def from_file(text: str, acting: list[tuple[Effect, np.ndarray]], solver: Solver) -> FrameMotion:
    """Return the motion of the frame in a file under the table's motion as it was corrected."""
    times, table = table_of(MODEL, MODEL.assemble(CALIBRATED, acting), 0)
    reduced = frames.build(parse(text, "corrected.toml"))
    return Rig([reduced]).run(table, float(times[1]), solver=solver).frames[0]


def apart(one: FrameMotion, other: FrameMotion) -> float:
    """Return the rms difference of two motions of the floors over the first one's rms."""
    times = np.linspace(0.0, 0.999 * one.time_s[-1], 1000)
    first, second = one.sampled(times)[0], other.sampled(times)[0]
    return float(np.sqrt(np.mean((first - second) ** 2) / np.mean(first**2)))


def test_what_damping_couples_of_the_modes_is_not_in_the_file_and_little() -> None:
    coupled = CALIBRATED + COUPLING * MODEL.std
    assert 2e-4 < apart(own_run([], coupled), from_file(on_file([]), [], "exact")) < 5e-3


EXPORTED = [
    kind.name
    for kind in kinds()
    if not kind.rival
    and kind.where not in ("", "channel", "logger")
    and kind.name != "torsional_eccentricity"
]


@pytest.mark.parametrize("name", EXPORTED)
def test_the_frame_in_the_file_moves_as_the_corrected_model_of_the_report(name: str) -> None:
    effect = effect_of(name)
    acting = [(effect, usual(effect))]
    text = on_file(acting)
    own = own_run(acting)
    # The table's velocity, on which drag acts, forgets what is slow in the diagnosis and is the integral on the rig.
    close = 4e-3 if name == "air_drag" else 2e-4
    assert apart(own, from_file(text, acting, "exact")) < close
    assert apart(own, from_file(text, acting, "exudyn")) < close
    # What the file adds is more than what the solvers differ by.
    assert apart(own, from_file(on_file([]), [], "exact")) > 0.02


def test_what_loosens_are_columns_that_bend_as_their_joints_turn() -> None:
    acting = [(effect_of("loosening"), np.array([-0.3, 1.0]))]
    text = on_file(acting)
    assert 'kind = "loosening"' in text
    assert "drift_shares = [" in text
    own = own_run(acting)
    assert apart(own, from_file(text, acting, "exact")) < 2e-4
    assert apart(own, from_file(text, acting, "exudyn")) < 2e-4
    whole_storey = on_file([(effect_of("loosening"), np.array([-0.3, 0.0]))])
    assert "drift_shares" not in whole_storey
    assert apart(own, from_file(whole_storey, acting, "exact")) > 1e-3


def test_what_moves_the_floors_otherwise_is_refused() -> None:
    effect = effect_of("torsional_eccentricity")
    with pytest.raises(CaseError, match=r"torsional eccentricity, bench: .*cannot state"):
        on_file([(effect, usual(effect))])


def test_an_effect_of_a_sensor_is_said_to_be_on_no_frame() -> None:
    gain = effect_of("sensor_gain")
    found = on_frames(MODEL, CALIBRATED, [(gain, np.array([0.5]))])
    assert found.beside == (gain.label(),)
    assert f"not on the frame: {gain.label()}" in on_file([(gain, np.array([0.5]))]).replace("\n# ", " ")


def test_a_frame_that_yields_is_not_exported_as_a_linear_one() -> None:
    weak = structs.replace(BENCH, yielding=Yielding(storey_shear_n=50.0))
    with pytest.raises(CaseError, match="frame bench yields by its file"):
        corrected_frame(on_frames(MODEL, CALIBRATED, []), 0, weak)


def test_a_file_with_laws_is_no_baseline(tmp_path: Path) -> None:
    effect = effect_of("cubic_stiffness")
    (tmp_path / "bench.toml").write_text(on_file([(effect, usual(effect))]), encoding="utf-8")
    frame = CaseFrame("bench", 3, file=tmp_path / "bench.toml")
    with pytest.raises(CaseError, match=r"has \[\[storey_law\]\], and a baseline model is linear"):
        baseline_frames(Case("bench", tmp_path, (frame,), (), ()))
    # Without laws it is the frame that was calibrated.
    (tmp_path / "bench.toml").write_text(on_file([]), encoding="utf-8")
    (again,) = baseline_frames(Case("bench", tmp_path, (frame,), (), ()))
    np.testing.assert_allclose(again.stiffness, MODEL.assemble(CALIBRATED).stiffness, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(again.damping_ratio, np.exp(MODEL.assemble(CALIBRATED).log_damping), rtol=1e-6)


def test_a_file_with_an_eccentricity_is_no_baseline_and_a_symmetric_one_is(tmp_path: Path) -> None:
    text = (
        'kind = "stick"\nname = "bench"\nstoreys = 2\nstorey_height_m = 0.2\nscale = "1:30"\nfloor_mass_kg = [6.0, 6.0]\n'
        "frequency_hz = [6.8]\ndamping_ratio = 0.01\nplan_m = [0.4, 0.4]\n"
    )
    frame = CaseFrame("bench", 2, file=tmp_path / "bench.toml")
    turning = "torsion = {{ eccentricity_m = {}, frequency_ratio = 1.3 }}\n"
    (tmp_path / "bench.toml").write_text(text + turning.format(0.02), encoding="utf-8")
    with pytest.raises(CaseError, match="sways without turning; take it out of 'torsion'"):
        baseline_frames(Case("bench", tmp_path, (frame,), (), ()))
    (tmp_path / "bench.toml").write_text(text + turning.format(0.0), encoding="utf-8")
    (even,) = baseline_frames(Case("bench", tmp_path, (frame,), (), ()))
    (tmp_path / "bench.toml").write_text(text, encoding="utf-8")
    (plain,) = baseline_frames(Case("bench", tmp_path, (frame,), (), ()))
    np.testing.assert_allclose(even.stiffness, plain.stiffness, rtol=1e-9)
