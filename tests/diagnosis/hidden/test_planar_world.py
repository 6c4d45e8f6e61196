"""The world of plane frames moves as it should and is near the baseline models: `python -m tests.planar_world`."""

from __future__ import annotations

import ast
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lsim

from pounding.diagnosis.case.reading import read_case
from tests.planar_world import laws
from tests.planar_world.__main__ import main
from tests.planar_world.baseline import STOREYS, baseline_of, modes
from tests.planar_world.frame import drawn_frame
from tests.planar_world.integration import STEP_S, STORED_HZ, respond
from tests.planar_world.judging import Judged, summary
from tests.planar_world.making import make
from tests.planar_world.plan import DOUBLES, NULLS, OUTSIDE, SINGLES, Plan, plans
from tests.planar_world.structure import Structure, drift

WORLD = Path(__file__).parents[2] / "planar_world"
PULSE_S = 0.1


def pulse(times: np.ndarray) -> np.ndarray:
    """A push of the table [m/s^2], then rest."""
    return np.where(times < PULSE_S, 5 * np.sin(np.pi * times / PULSE_S) ** 2, 0.0)


def undamped(name: str) -> Structure:
    structure = drawn_frame(name, np.random.default_rng(1)).structure()
    return replace(structure, damping=np.zeros_like(structure.damping))


def energies(structure: Structure, displacement: np.ndarray) -> np.ndarray:
    """Kinetic and elastic energy [J] at all times, by the velocities of the floors."""
    velocity = np.gradient(displacement, 1 / STORED_HZ, axis=0, edge_order=2)
    moving = np.einsum("ti,ij,tj->t", velocity, structure.mass, velocity)
    bent = np.einsum("ti,ij,tj->t", displacement, structure.stiffness, displacement)
    return np.asarray(0.5 * (moving + bent))


def test_a_frame_without_effects_moves_as_its_state_matrices_say() -> None:
    structure, duration = drawn_frame("5A", np.random.default_rng(4)).structure(), 0.5
    (found,) = respond(structure, [pulse], duration=duration)
    count = structure.freedoms
    springs = -np.linalg.solve(structure.mass, np.hstack([structure.stiffness, structure.damping]))
    state = np.vstack([np.hstack([np.zeros((count, count)), np.eye(count)]), springs])
    table = np.concatenate([np.zeros(count), -np.ones(count)])[:, None]
    # Of the floors: displacement, and acceleration in the room.
    seen = np.vstack([np.eye(count, 2 * count), springs])
    times = np.arange(round(duration / STEP_S) * 2 + 1) * STEP_S / 2
    expected = lsim((state, table, seen, np.zeros((2 * count, 1))), pulse(times), times)[1]
    every = round(2 / STEP_S / STORED_HZ)
    both = np.hstack([found.displacement, found.acceleration])
    assert np.abs(both - expected[::every]).max(axis=0) == pytest.approx(0, abs=1e-8)
    assert np.abs(found.displacement).max() > 1e-3


@pytest.mark.parametrize("name", STOREYS)
def test_a_frame_has_the_frequencies_of_the_baseline_model(name: str) -> None:
    """The first modes, for the construction's scatter is about 1 %; the damping ratio within its own."""
    frame = drawn_frame(name, np.random.default_rng(2))
    found = modes(*frame.matrices())[0]
    assert found[0] == pytest.approx(baseline_of(name).frequencies()[0], rel=0.02)
    assert found[1:3] == pytest.approx(baseline_of(name).frequencies()[1:3], rel=0.05)
    assert frame.ratios[0] == pytest.approx(baseline_of(name).ratios[0], rel=0.4)


@pytest.mark.parametrize(("name", "style"), [(name, style) for name, _, style in NULLS])
def test_a_strange_construction_is_tuned_too(name: str, style: object) -> None:
    for strength in (0.5, 2.0):
        frame = drawn_frame(name, np.random.default_rng(3), style, strength)
        assert modes(*frame.matrices())[0][0] == pytest.approx(baseline_of(name).frequencies()[0], rel=0.02)


def test_friction_takes_what_its_force_does_along_the_slip() -> None:
    bare = undamped("5A")
    direction = drift(5, 3)
    rubbing = bare.with_law(laws.friction(direction, 2.0))
    (free,), (rubbed,) = (respond(one, [pulse], duration=2.0) for one in (bare, rubbing))
    after = slice(round(PULSE_S * STORED_HZ) + 2, -2)
    kept, lost = (energies(one, run.displacement)[after] for one, run in ((bare, free), (rubbing, rubbed)))
    assert kept == pytest.approx(kept[0], rel=1e-3)
    assert np.diff(lost).max() < 1e-4 * kept[0]
    # What is lost is the force times the way that the storey slips.
    slips = np.abs(np.diff((rubbed.displacement @ direction)[after])).sum()
    assert lost[0] - lost[-1] == pytest.approx(2.0 * slips, rel=0.02)
    assert lost[-1] < 0.8 * kept[0]


def test_a_storey_that_friction_holds_creeps_by_less_the_smaller_the_step() -> None:
    bare, direction = undamped("5A"), drift(5, 3)
    (free,) = respond(bare, [pulse], duration=0.5)
    stuck = bare.with_law(laws.friction(direction, 1e3))
    held = [respond(stuck, [pulse], step, 0.5)[0].displacement for step in (STEP_S, STEP_S / 2)]
    creep, less = (np.abs(one @ direction).max() for one in held)
    assert np.abs(held[0][:, -1]).max() > 1e-3
    assert creep < 0.1 * np.abs(free.displacement @ direction).max()
    assert less == pytest.approx(creep / 2, rel=0.1)


def test_a_stop_pushes_and_never_pulls() -> None:
    assert laws.stop_force(-1e-3, 1.0, 1e4, 100.0) == 0.0
    assert laws.stop_force(1e-3, 0.1, 1e4, 100.0) == pytest.approx(20.0)
    assert laws.stop_force(1e-3, -1.0, 1e4, 100.0) == 0.0


def test_a_yielding_part_is_elastic_first_and_hardens_after() -> None:
    law = laws.yielding(drift(1, 1), 10.0, 1e4)
    values, state = np.array(law.values), np.zeros(laws.STATES)
    drifts = np.concatenate([np.linspace(0, 4e-3, 4001), np.linspace(4e-3, -4e-3, 8001)])
    force = np.array([laws.yielding_force(one, values, state) + 1e4 * one for one in drifts])
    assert force[100] == pytest.approx(1e4 * drifts[100], rel=1e-3)
    assert force[4000] == pytest.approx(10 + laws.HARDENING * 1e4 * 3e-3, rel=0.01)
    unloading = (force[4000] - force[4100]) / (drifts[4000] - drifts[4100])
    assert unloading == pytest.approx(1e4, rel=0.05)
    assert force[-1] == pytest.approx(-force[4000], rel=0.1)


@pytest.mark.parametrize("seed", [1, 70431986])
def test_a_set_is_the_same_mix_under_names_that_say_nothing(seed: int) -> None:
    drawn = plans(seed)
    assert drawn == plans(seed)
    assert [plan.name for plan in drawn] == [f"c{number:02d}" for number in range(1, 25)]
    counts = Counter(plan.kinds for plan in drawn)
    assert counts[()] == 5
    assert all(counts[(kind,)] == 1 for kind in (*SINGLES, *OUTSIDE))
    assert sum(counts[pair] for pair in DOUBLES) == 2
    assert plans(seed + 1) != drawn


def test_a_seed_makes_the_same_case_again(tmp_path: Path, test_records: Path) -> None:
    plan = Plan("c01", "5A", ("sensor_delay",), None, 0.02, True, 2, seed=7)
    one, two = (make(tmp_path / name, plan) for name in ("one", "two"))
    assert one.rig.effects == two.rig.effects
    for file in sorted((tmp_path / "one").iterdir()):
        assert file.read_bytes() == (tmp_path / "two" / file.name).read_bytes()
    case = read_case(tmp_path / "one")
    assert [run.values.shape for run in case.runs] == [(4000, 4)] * 3
    assert case.channels[0].name == "table"


def test_what_is_right_is_counted() -> None:
    def judged(effects: list[dict[str, object]], verdict: str, named: list[dict[str, object]]) -> Judged:
        claims = [one | {"parameters": [], "class": [one, {"effect": "air_drag"}]} for one in named]
        report = {"misfit": {"held_out": None}, "verdict": verdict, "effects": claims}
        outside = any("outside" in str(one["effect"]) for one in effects)
        return Judged.of({"case": "c", "frame": "5A", "effects": effects, "outside": outside}, report)

    loss, other = ({"effect": "stiffness_change", "storey": storey} for storey in (2, 3))
    cases = [
        judged([], "nothing_missing", []),
        judged([], "effect_named", [loss]),
        judged([loss], "effect_named", [loss]),
        judged([loss], "effect_named", [other]),
        judged([loss], "effect_class", [loss]),
        judged([loss, other], "effect_named", [other, loss]),
        judged([{"effect": "outside: rattling mass"}], "unknown_effect", [loss]),
    ]
    assert [line.partition(": ")[2] for line in summary(cases)] == [
        "1 of 2",
        "3 of 3",
        "1 of 3",
        "1 of 3",
        "1 of 1",
        "1 of 1",
    ]


@pytest.mark.parametrize("path", sorted(WORLD.glob("*.py")), ids=lambda path: path.stem)
def test_it_takes_baseline_models_and_records_and_nothing_else_but_to_diagnose(path: Path) -> None:
    ours = {
        node.module
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "pounding"
    }
    allowed = {
        "baseline": {"pounding.diagnosis.case.case", "pounding.diagnosis.model.frames"},
        "motion": {"pounding.experiments.records"},
        "judging": {"pounding.diagnosis.workflow"},
    }
    assert ours == allowed.get(path.stem, set())


@pytest.mark.parametrize(
    ("asked", "records", "said"),
    [
        ("--only c99", True, "no case 'c99'; there are c01"),
        ("--only c01", False, "no record elcentro.csv; set POUNDING_RECORDS"),
    ],
)
def test_what_cannot_be_made_is_refused_in_a_sentence(
    asked: str,
    records: bool,
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    if not records:
        monkeypatch.setenv("POUNDING_RECORDS", str(tmp_path))
    monkeypatch.setattr("sys.argv", ["planar_world", *asked.split(), "--out", str(tmp_path / "set")])
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "set").exists()
