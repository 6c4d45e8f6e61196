"""Frames whose columns yield: against an integration of their own, by both solvers, and with the numbers they report."""

from __future__ import annotations

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pounding import frames
from pounding.contact.parameters import thesis_law
from pounding.experiments.command.app import main
from pounding.experiments.records import Record
from pounding.experiments.rig.ductility import ductilities
from pounding.experiments.rig.pounding import pound
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.shaking import shake
from pounding.experiments.rig.yielding import yielding_laws
from pounding.frames.definition import Yielding
from pounding.frames.yielding import hinge_shear, storey_yields

MASS, STIFFNESS, RATIO, SHEAR, HARDENING = 6.0, 5e3, 0.02, 12.0, 0.1
STEP = 0.004


def stick(yielding: Yielding | None, storeys: int = 1) -> frames.ReducedFrame:
    return frames.build(
        frames.StickFrame(
            name="oscillator",
            storeys=storeys,
            storey_height_m=0.1,
            floor_mass_kg=[MASS] * storeys,
            storey_stiffness_n_per_m=[STIFFNESS] * storeys,
            damping_ratio=RATIO,
            yielding=yielding,
        )
    )


def motion(samples: int = 500) -> Record:
    time = STEP * np.arange(samples)
    return Record("sine", 3.0 * np.minimum(1.0, time / 0.5) * np.sin(2 * np.pi * 4.3 * time), STEP)


def reference(record: Record, sharpness: float | None) -> tuple[np.ndarray, float]:
    """Displacement at the samples and plastic drift at the end, the plastic part a state of its own.

    A sharp knee yields wholly or not at all; Bouc's and Wen's (beta = gamma = 1/2) by a power of the share of the limit.
    """
    limit, circular = SHEAR / STIFFNESS, np.sqrt(STIFFNESS / MASS)

    def share(elastic: float, v: float) -> float:
        if elastic * v <= 0.0:
            return 0.0
        if sharpness is None:
            return float(abs(elastic) >= limit)
        return float(min(abs(elastic) / limit, 1.0) ** sharpness)

    def rate(t: float, y: np.ndarray) -> list[float]:
        d, v, p = y
        elastic = d - p
        force = HARDENING * STIFFNESS * d + (1 - HARDENING) * STIFFNESS * np.clip(elastic, -limit, limit)
        table = np.interp(t, record.time_s, record.acceleration_m_s2)
        return [v, -table - force / MASS - 2 * RATIO * circular * v, v * share(elastic, v)]

    end = record.time_s[-1]
    done = solve_ivp(rate, (0.0, end), [0.0] * 3, t_eval=record.time_s, rtol=1e-6, atol=1e-9, max_step=2e-4)
    return done.y[0], done.y[2][-1]


@pytest.mark.parametrize("sharpness", [None, 2.0])
@pytest.mark.parametrize("solver", ["exudyn", "exact"])
def test_an_oscillator_that_yields_moves_as_an_integration_of_its_own_says(
    solver: str, sharpness: float | None
) -> None:
    record = motion()
    reduced = stick(Yielding(storey_shear_n=SHEAR, hardening_ratio=HARDENING, sharpness=sharpness))
    done = Rig([reduced]).run(record, solver=solver)  # type: ignore[arg-type]
    expected, left = reference(record, sharpness)
    moved, _ = done.frames[0].sampled(record.time_s.clip(max=done.model_s))
    assert np.abs(moved[:, 0] - expected).max() < 2e-3 * np.abs(expected).max()
    (found,) = ductilities(done.frames[0])
    assert found["ductility"] == pytest.approx(np.abs(expected).max() / (SHEAR / STIFFNESS), rel=2e-3)
    assert found["ductility"] > 2.0
    assert found["plastic_drift_mm"] == pytest.approx(1e3 * left, abs=5e-3 * 1e3 * np.abs(expected).max())
    assert done.energy.error < 1e-3
    assert done.energy.storey_j[-1] > 0.0


def test_below_its_yield_a_frame_is_the_linear_one() -> None:
    record = motion(200)
    strong, linear = stick(Yielding(storey_shear_n=1e6)), stick(None)
    one, other = (Rig([frame]).run(record, solver="exact").frames[0] for frame in (strong, linear))
    times = record.time_s[:-1]
    np.testing.assert_allclose(one.sampled(times)[0], other.sampled(times)[0], atol=1e-9)
    assert ductilities(one)[0]["ductility"] < 1.0
    assert ductilities(other) == []


def test_both_solvers_agree_on_a_collision_of_frames_that_yield() -> None:
    soft = stick(Yielding(storey_shear_n=[15.0, 10.0], hardening_ratio=0.05), storeys=2)
    stiff = stick(None, storeys=2)
    law = thesis_law("linear_viscoelastic")
    runs = [pound(soft, stiff, motion(300), law, 0.001, solver=solver) for solver in ("exudyn", "exact")]  # type: ignore[arg-type]
    first, second = (run.result() for run in runs)
    assert len(first["impacts"]) == len(second["impacts"]) > 0
    for one, other in zip(first["ductility"]["left"], second["ductility"]["left"], strict=True):
        assert one["ductility"] == pytest.approx(other["ductility"], rel=0.01)
    assert max(row["ductility"] for row in first["ductility"]["left"]) > 1.0
    assert first["ductility"]["right"] == []


def test_a_storey_of_plates_yields_with_hinges_at_both_ends_of_its_columns() -> None:
    """Four columns of 40 x 2 mm, 95 mm between the floors: 8 times 11.2 N m over 0.095 m."""
    frame = frames.load("5B")
    assert hinge_shear(frame) == pytest.approx(943.2, abs=0.1)
    reduced = frames.build(msgspec.structs.replace(frame, yielding=Yielding()))
    found = storey_yields(reduced)
    assert [one.storey for one in found] == [1, 2, 3, 4, 5]
    assert all(one.stiffness_n_per_m * one.drift_m == pytest.approx(943.2, abs=0.1) for one in found)
    assert len(yielding_laws([reduced])) == 5
    # What yields is no part of the reduced matrices, which are kept on disk without it.
    assert np.array_equal(reduced.stiffness, frames.build(frame).stiffness)


def test_a_frame_of_plates_beyond_yield_reports_its_ductility_and_no_stress() -> None:
    frame = msgspec.structs.replace(frames.load("5B"), yielding=Yielding(storey_shear_n=60.0))
    done = shake(frames.build(frame), motion(150))
    result = done.result()
    assert max(row["ductility"] for row in result["ductility"]) > 1.0
    assert result["max_stress_mpa"] is None
    assert not [sentence for sentence in done.warnings if "stress" in sentence]


def test_the_required_gap_of_frames_that_yield_is_the_closing_motion_of_their_run() -> None:
    record = motion(300)
    soft, stiff = stick(Yielding(storey_shear_n=SHEAR, hardening_ratio=HARDENING)), stick(None)
    found = pair_gap(soft, stiff, record)
    # The other solver, of another method, with a gap that never closes.
    run = Rig([soft, stiff]).run(record, solver="exudyn")
    one, other = (frame.sampled(record.time_s[:-1])[0][:, 0] for frame in run.frames)
    assert found.closing_m == pytest.approx((one - other).max(), rel=0.01)
    assert found.left_peak_m > 2.0 * SHEAR / STIFFNESS
    linear = pair_gap(stick(None), stiff, record)
    assert linear.closing_m == 0.0


@pytest.mark.parametrize(
    ("yielding", "sentence"),
    [
        ("{}", "yielding.storey_shear_n is missing; a stick has no columns"),
        (
            "{ storey_shear_n = [1.0] }",
            "yielding.storey_shear_n has 1 values, needs one for each of 2 storeys",
        ),
        ("{ storey_shear_n = -1.0 }", "yielding.storey_shear_n is -1"),
        ("{ storey_shear_n = 9.0, hardening_ratio = 1.0 }", "yielding.hardening_ratio is 1.0, a fraction"),
        ("{ shear_n = 9.0 }", "'shear_n' is not a key of a frame; did you mean storey_shear_n"),
    ],
)
def test_a_yielding_that_cannot_be_is_refused_in_one_sentence(
    yielding: str, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "own.toml"
    path.write_text(
        'kind = "stick"\nname = "own"\nstoreys = 2\nstorey_height_m = 0.1\nfloor_mass_kg = [6.0, 6.0]\n'
        f"frequency_hz = [4.0]\ndamping_ratio = 0.01\nyielding = {yielding}\n"
    )
    with pytest.raises(SystemExit) as stopped:
        main(["shake", str(path), "--record", "elcentro-peer180", "--json"])
    assert stopped.value.code == 2
    assert sentence in capsys.readouterr().err


def test_the_command_reports_the_ductility(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "own.toml"
    path.write_text(
        'kind = "stick"\nname = "own"\nstoreys = 1\nscale = "1:30"\nstorey_height_m = 0.1\nfloor_mass_kg = [6.0]\n'
        "storey_stiffness_n_per_m = [5e3]\ndamping_ratio = 0.01\nyielding = { storey_shear_n = 12.0 }\n"
    )
    main(["shake", str(path), "--record", "elcentro-peer180", "--json"])
    (row,) = json.loads(capsys.readouterr().out)["ductility"]
    assert row["ductility"] > 1.0
