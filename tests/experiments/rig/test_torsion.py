"""Sticks that turn, on the table: by an integration of its own, in both solvers, off the middle, and their required gap."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from pounding import frames
from pounding.contact.laws import LinearViscoelastic
from pounding.experiments.fragility.capacity import closings
from pounding.experiments.mitigation.response import response
from pounding.experiments.mitigation.standing import Standing
from pounding.experiments.records import Record
from pounding.experiments.rig.contact_checks import contact_warnings
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.impacts import all_impacts
from pounding.experiments.rig.pounding import pound
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.rig import Rig
from pounding.experiments.rig.shaking import largest_drift
from pounding.experiments.separation.gaps.gap import Where, gap_answer

TORSION = {"eccentricity_m": 2.0, "frequency_ratio": 1.3}
LAW = LinearViscoelastic(stiffness=2e9, damping=5e6)


def stick(hertz: float, torsion: dict[str, Any] | None = None, **options: Any) -> frames.ReducedFrame:
    tree = {
        "kind": "stick",
        "name": f"{hertz:g} Hz",
        "storeys": 2,
        "storey_height_m": 3.2,
        "floor_mass_kg": [3e5, 2.5e5],
        "frequency_hz": [hertz],
        "damping_ratio": 0.03,
        "plan_m": [20.0, 15.0],
    }
    return frames.build(frames.from_mapping(tree | ({"torsion": torsion} if torsion else {})), **options)


def shaking(end_s: float = 3.0) -> Record:
    time = 0.01 * np.arange(round(end_s / 0.01) + 1)
    return Record("sines", 3.0 * np.sin(2 * np.pi * 1.1 * time) + np.sin(2 * np.pi * 2.3 * time), 0.01)


@pytest.mark.parametrize(("solver", "error"), [("exudyn", 3e-3), ("exact", 1e-5)])
def test_a_turning_stick_moves_as_an_integration_of_its_own_says(solver: Any, error: float) -> None:
    frame, record = stick(1.5, TORSION), shaking()
    half = frame.size
    push = np.linalg.solve(frame.mass, np.column_stack([frame.stiffness, frame.damping]))

    def rate(t: float, y: np.ndarray) -> np.ndarray:
        table = np.interp(t, record.time_s, record.acceleration_m_s2)
        return np.concatenate([y[half:], -push @ y - table * np.array([1.0, 1.0, 0.0, 0.0])])

    own = solve_ivp(
        rate, (0.0, 3.0), np.zeros(2 * half), t_eval=record.time_s, rtol=1e-8, atol=1e-10, max_step=0.01
    )
    run = Rig([frame]).run(record, solver=solver)
    moved, _ = run.frames[0].sampled(record.time_s.clip(max=run.model_s))
    corner = frame.point_row(2, -7.5)
    largest = np.abs(own.y[:half].T @ corner).max()
    assert np.abs((moved - own.y[:half].T) @ corner).max() < error * largest
    peak = run.frames[0].peaks()[-1]
    assert peak["edge_mm"] == pytest.approx(1e3 * largest, rel=2e-3)
    assert peak["edge_mm"] > 1.1 * max(peak["max_mm"], peak["min_mm"])
    assert peak["rotation_mrad"] == pytest.approx(1e3 * np.abs(own.y[3]).max(), rel=2e-3)
    assert run.energy.error < 1e-3


def test_without_eccentricity_a_collision_is_exactly_that_of_plain_sticks() -> None:
    symmetric = {"frequency_ratio": 1.3}
    runs = [
        pound(stick(1.0, torsion), stick(1.6, torsion), shaking(), LAW, 0.02, solver="exact").result()
        for torsion in (None, symmetric)
    ]
    for run in runs:
        del run["wall_s"]
    assert runs[0] == runs[1]
    assert runs[0]["impacts"]
    turning = [stick(hertz, symmetric, planar=False) for hertz in (1.0, 1.6)]
    other = pound(*turning, shaking(), LAW, 0.02, solver="exact").result()
    roof = other["peaks"]["left"][-1]
    assert roof["max_mm"] == pytest.approx(runs[0]["peaks"]["left"][-1]["max_mm"], rel=1e-4)
    assert roof["rotation_mrad"] < 1e-9


def test_both_solvers_agree_on_a_collision_off_the_middle() -> None:
    row = [stick(1.0, {"frequency_ratio": 1.3}, planar=False), stick(1.6, TORSION)]
    rig = Rig(row, [Contact(LAW, 0.02, 2, y_m=y_m) for y_m in (-6.0, 6.0)])
    runs = [rig.run(shaking(), solver=solver) for solver in ("exudyn", "exact")]
    for one, other in zip(*(run.contacts for run in runs), strict=True):
        assert one.sampled()[1].max() == pytest.approx(other.sampled()[1].max(), rel=5e-3)
        assert len(one.pulses) == len(other.pulses) > 1
    for place in (0, 1):
        moved, same = (run.frames[place].peaks()[-1] for run in runs)
        assert moved["rotation_mrad"] == pytest.approx(same["rotation_mrad"], rel=5e-3)
        # The left one is symmetric, and turns because it is hit off its middle.
        assert moved["rotation_mrad"] > 1.0
    assert {impact.y_m for impact in all_impacts(runs[0])} == {-6.0, 6.0}
    alone = Rig(row, [Contact(LAW, 0.02, 2)]).run(shaking(), solver="exact")
    in_the_middle = "in the middle of the edge alone"
    assert in_the_middle in " ".join(contact_warnings(alone))
    # Most of all where they did not touch there: the ends, which come nearer, may have.
    apart = Rig(row, [Contact(LAW, 2.0, 2)]).run(shaking(), solver="exact")
    assert in_the_middle in " ".join(contact_warnings(apart))
    assert in_the_middle not in " ".join(contact_warnings(runs[1]))


def test_the_drift_of_floors_that_turn_is_that_of_their_edges() -> None:
    run = Rig([stick(1.5, TORSION)]).run(shaking(), solver="exact")
    motion = run.frames[0]
    q = motion.displacement_m
    upper = [np.abs((q[:, 1] - q[:, 0]) - y * (q[:, 3] - q[:, 2])).max() for y in (-7.5, 7.5)]
    lower = [np.abs(q[:, 0] - y * q[:, 2]).max() for y in (-7.5, 7.5)]
    assert largest_drift(motion)[0] == pytest.approx(max(upper + lower) / 3.2)


def test_the_required_gap_is_told_for_both_ends_of_the_edge() -> None:
    left, right = stick(2.5), stick(1.6, TORSION)
    answer = gap_answer(left, right, shaking(), own_peak=False, length_scale=1.0)
    ends = {one.y_m: one.required_gap_mm for one in answer.edges}
    assert answer.required_gap_mm == pytest.approx(1e3 * pair_gap(left, right, shaking()).closing_m)
    assert ends[-7.5] > 1.02 * answer.required_gap_mm > ends[7.5] * 1.02
    (warning,) = (one for one in answer.warnings if "turn" in one)
    assert f"(y = -7.5 m) floor 2 needs {ends[-7.5]:.4g} mm" in warning
    turning = stick(2.5, {"frequency_ratio": 1.3}, planar=False)
    at_the_end = gap_answer(turning, right, shaking(), Where(y_m=-7.5), own_peak=False, length_scale=1.0)
    assert at_the_end.required_gap_mm == pytest.approx(ends[-7.5], rel=1e-6)
    assert at_the_end.spread.low_mm <= ends[-7.5] <= at_the_end.spread.high_mm


def test_fragility_and_measures_find_the_same_closing_off_the_middle() -> None:
    row = (stick(2.5, {"frequency_ratio": 1.3}, planar=False), stick(1.6, TORSION))
    contact = Contact(LAW, 0.05, 2, y_m=-7.5)
    expected = pair_gap(*row, shaking(), y_m=-7.5).closing_m
    assert closings(row, [contact], shaking()) == pytest.approx([expected])
    found = response(Standing(row, (contact,)), shaking())
    assert found.required_gap_mm == pytest.approx([1e3 * expected], rel=1e-3)
