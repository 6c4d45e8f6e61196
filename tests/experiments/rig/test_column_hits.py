"""A floor against columns: statics against a beam of two elements, both solvers, what is reported and refused."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from pounding.contact.laws import Hertz, LinearViscoelastic
from pounding.experiments.command.app import main
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility.capacity import closings
from pounding.experiments.records import find
from pounding.experiments.rig.column_hits import Columns, Place, beyond, borne, masses_at, place_of, softened
from pounding.experiments.rig.contacts import Contact, column_weights, height_of
from pounding.experiments.rig.required_gap import gap_at
from pounding.experiments.rig.rig import Rig
from pounding.frames import StickFrame, build, load
from tests.experiments.rig.models import two_sines

COLUMNS = Columns(
    count=4, depth_m=0.02, width_m=0.03, youngs_modulus_gpa=200.0, shear_kn=0.5, moment_kn_m=0.01
)


def stick(name: str, heights: list[float], hertz: float, masses: tuple[float, ...] = ()) -> object:
    return build(
        StickFrame(
            name=name,
            storeys=len(heights),
            storey_height_m=heights,
            floor_mass_kg=masses or [6.0] * len(heights),
            frequency_hz=[hertz],
            damping_ratio=0.01,
        )
    )


LEFT, RIGHT = stick("left", [0.1, 0.1, 0.1], 3.0), stick("right", [0.1, 0.13], 6.4)
PLACE = place_of(LEFT, RIGHT, None)


def beam(length: float, share: float, bending: float) -> np.ndarray:
    """Stiffness (6, 6) of a beam of two elements: deflection and turn at the lower end, where it is hit, and on top."""
    whole = np.zeros((6, 6))
    for start, part in ((0, share * length), (2, (1.0 - share) * length)):
        own = np.array(
            [
                [12.0, 6 * part, -12.0, 6 * part],
                [6 * part, 4 * part**2, -6 * part, 2 * part**2],
                [-12.0, -6 * part, 12.0, -6 * part],
                [6 * part, 2 * part**2, -6 * part, 4 * part**2],
            ]
        )
        whole[start : start + 4, start : start + 4] += bending / part**3 * own
    return whole


@pytest.mark.parametrize("share", [0.2, 0.5, 0.77])
def test_the_columns_follow_beam_theory(share: float) -> None:
    matrix = beam(3.0, share, COLUMNS.bending_n_m2)
    held, free = [0, 1, 4, 5], [2, 3]
    inner = np.linalg.inv(matrix[np.ix_(free, free)])
    assert COLUMNS.stiffness(3.0, share) == pytest.approx(COLUMNS.count / inner[0, 0])
    reactions = matrix[np.ix_(held, free)] @ inner @ [1.0, 0.0]
    assert column_weights(share) == pytest.approx((-reactions[0], -reactions[2]))
    sway = -inner @ matrix[np.ix_(free, held)] @ [0.0, 0.0, 1.0, 0.0]
    assert column_weights(share)[1] == pytest.approx(sway[0])  # the same shape, as Maxwell and Betti say


def test_the_place_is_on_the_higher_neighbour() -> None:
    assert PLACE.floors == pytest.approx((2.3, 2))
    assert (PLACE.hit, PLACE.length_m, PLACE.share) == (0, pytest.approx(0.1), pytest.approx(0.3))
    assert height_of(LEFT, PLACE.floors[0]) == pytest.approx(0.23)
    mirrored = place_of(RIGHT, LEFT, None)
    assert mirrored.floors == pytest.approx((2, 2.3))
    assert mirrored.hit == 1
    assert masses_at(LEFT, RIGHT, PLACE) == pytest.approx((6.0, 6.0))


def test_the_floor_that_is_nearer_bears_more_of_a_blow_and_its_mass_counts_more() -> None:
    uneven = stick("left", [0.1, 0.1, 0.1], 3.0, (1.0, 2.0, 10.0))
    lower, upper = column_weights(PLACE.share)
    assert lower > 0.5 > upper  # hit at three tenths of the storey
    assert masses_at(uneven, RIGHT, PLACE)[0] == pytest.approx(2.0 * lower + 10.0 * upper)
    assert masses_at(uneven, RIGHT, PLACE)[0] < 6.0


def test_both_solvers_run_it_alike_and_report_the_same() -> None:
    law = softened(LinearViscoelastic(2e6, damping=500.0), PLACE, COLUMNS)
    contact = Contact(law, 0.002, PLACE.floors, 0)
    runs = [
        Rig([LEFT, RIGHT], [contact]).run(two_sines(1.0), solver=solver) for solver in ("exudyn", "exact")
    ]
    assert len(runs[0].contacts[0].pulses) == len(runs[1].contacts[0].pulses) > 3
    first, second = (borne(run, contact, PLACE, COLUMNS, 0) for run in runs)
    for key in ("shear_kn", "moment_kn_m", "shear_of_drift_kn"):
        assert first[key] == pytest.approx(second[key], rel=0.01)
    assert first["building"] == "left"
    assert first["between_floors"] == [2, 3]
    assert any("bears a shear of" in sentence for sentence in beyond(first))


def test_at_the_peak_the_ends_bear_the_force_and_the_drift() -> None:
    law = softened(LinearViscoelastic(2e6, damping=500.0), PLACE, COLUMNS)
    contact = Contact(law, 0.002, PLACE.floors, 0)
    run = Rig([LEFT, RIGHT], [contact]).run(two_sines(1.0), solver="exact")
    found = borne(run, contact, PLACE, COLUMNS, 0)
    times, force = run.contacts[0].sampled(50_000.0)
    frame = run.frames[0]
    drift = np.interp(times, frame.time_s, frame.displacement_m[:, 2] - frame.displacement_m[:, 1])
    matrix = beam(0.1, PLACE.share, COLUMNS.bending_n_m2)
    free, held = [2, 3], [0, 1, 4, 5]
    inner = np.linalg.inv(matrix[np.ix_(free, free)])
    ends = np.zeros((4, len(times)))
    ends[2] = drift  # relative to the lower end
    load = np.array([-force / COLUMNS.count, 0.0 * force])
    inside = inner @ (load - matrix[np.ix_(free, held)] @ ends)
    reactions = matrix[np.ix_(held, held)] @ ends + matrix[np.ix_(held, free)] @ inside
    assert found["shear_kn"] == pytest.approx(np.abs(reactions[[0, 2]]).max() / 1e3, rel=0.01)
    assert found["moment_kn_m"] == pytest.approx(np.abs(reactions[[1, 3]]).max() / 1e3, rel=0.01)


@pytest.mark.parametrize(("hit", "push"), [(1, 1.0), (0, -1.0)])
@pytest.mark.parametrize("drift", [4e-4, -4e-4])
def test_a_drift_adds_to_the_shear_on_one_side_of_a_blow(hit: int, push: float, drift: float) -> None:
    """A quarter up the storey: the right building is pushed along +x, the left one along -x."""
    force, length, share = 400.0, 0.1, 0.25
    times = np.array([0.0, 1e-3])
    history = SimpleNamespace(
        time_s=times, sampled=lambda: (times,), at=lambda at: (0 * at, 0 * at, force + 0 * at)
    )
    frame = SimpleNamespace(
        name="hit", time_s=times, floor=lambda number: number - 1, displacement_m=np.tile([0.0, drift], (2, 1)),
        reduced=SimpleNamespace(storeys=2, heights_m=[length, 2 * length]),
    )  # fmt: skip
    motion = SimpleNamespace(contacts=[history], frames=[frame, frame])
    floors = (1.0, 1.25) if hit else (1.25, 1.0)
    place = Place(floors, hit, length, share)
    found = borne(motion, SimpleNamespace(pair=0), place, COLUMNS, 0)  # type: ignore[arg-type]
    bending, one = COLUMNS.bending_n_m2, push * force / COLUMNS.count
    # Both ends fixed: the lower end bears b^2 (3 a + b) / L^3 of a force at a above it and b below the upper one.
    to_lower = 0.75**2 * (3 * 0.25 + 0.75)
    shears = [
        12 * bending * drift / length**3 + to_lower * one,
        12 * bending * drift / length**3 - (1 - to_lower) * one,
    ]
    assert found["shear_kn"] == pytest.approx(max(abs(each) for each in shears) / 1e3)
    assert found["shear_of_drift_kn"] == pytest.approx(12 * bending * abs(drift) / length**3 / 1e3)


def test_only_linear_laws_stand_in_series_with_columns() -> None:
    with pytest.raises(ExperimentError, match="hertz: columns bend like a spring"):
        softened(Hertz(1e9), PLACE, COLUMNS)


def test_a_floor_that_faces_a_floor_hits_no_column() -> None:
    with pytest.raises(ExperimentError, match="faces floor 1 of right, no columns"):
        place_of(LEFT, RIGHT, 1)


STREET = """
[[building]]
frame = "tall.toml"
[[building]]
frame = "low.toml"
[[gap]]
gap_mm = 30
columns = { count = 4, depth_m = 0.5, width_m = 0.5, shear_kn = 600 }
"""


@pytest.fixture
def folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Path:
    for name in ("tall", "low"):
        main(["new-frame", str(tmp_path / f"{name}.toml")])
    low = (tmp_path / "low.toml").read_text()
    for key, value in (
        ("storeys = 4", "storeys = 2"),
        ("[4.0, 3.2, 3.2, 3.2]", "[4.0, 4.6]"),
        ("[310e3, 290e3, 290e3, 250e3]", "[310e3, 290e3]"),
        ("[1.1, 3.2]", "[2.1]"),
        ("[0.03, 0.04]", "0.03"),
    ):
        low = low.replace(key, value)
    (tmp_path / "low.toml").write_text(low)
    (tmp_path / "street.toml").write_text(STREET)
    capsys.readouterr()
    return tmp_path


def test_pound_reports_the_columns(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["pound", str(folder / "street.toml"), "--record", "elcentro-chopra", "--solver", "exact"]
    main([*words, "--json", "--out", str(folder / "out")])
    out, err = capsys.readouterr()
    (run,) = json.loads(out)["runs"]
    (column,) = run["columns"]
    assert column["building"] == "tall"
    assert column["height_m"] == pytest.approx(8.6)
    assert column["shear_kn"] > 600.0
    assert "it breaks" in " ".join(err.split())
    main(words)
    assert "What one column that is hit bears at most" in capsys.readouterr().out


def test_the_required_gap_before_columns_is_the_closing_motion_of_the_place_that_is_hit(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    main(["gap", str(folder / "street.toml"), "--record", "elcentro-chopra", "--json"])
    (answer,) = json.loads(capsys.readouterr().out)["pairs"]
    tall, low = (build(load(folder / f"{name}.toml")) for name in ("tall", "low"))
    run = Rig([tall, low]).run(find("elcentro-chopra"), solver="exact")
    times = np.arange(0.0, run.model_s, 1e-3)
    moved, other = (frame.sampled(times)[0] for frame in run.frames)
    # 8.6 m lies between the floors at 7.2 and 10.4 m.
    share = (8.6 - 7.2) / 3.2
    upper = 3 * share**2 - 2 * share**3
    closing = (1 - upper) * moved[:, 1] + upper * moved[:, 2] - other[:, 1]
    assert answer["required_gap_mm"] == pytest.approx(1e3 * closing.max(), rel=1e-4)
    assert answer["on_columns"]
    assert answer["floor"] == 2
    assert [one["floor"] for one in answer["floors"]] == [1]


def test_how_likely_a_floor_hits_columns_follows_from_the_same_closing() -> None:
    record, law = two_sines(1.0), LinearViscoelastic(1e6, 100.0)
    contacts = [Contact(law, 0.001, PLACE.floors), Contact(law, 0.001, 1)]
    expected = [gap_at(LEFT, RIGHT, record, contact.floors).closing_m for contact in contacts]
    assert closings([LEFT, RIGHT], contacts, record) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("wrong", "right", "sentence"),
    [
        ("count = 4", "count = 0", "count is 0"),
        ("depth_m = 0.5", "depth_m = -0.5", "depth_m is -0.5 m"),
        ("shear_kn = 600", "shear_kn = -6", "shear_kn is -6"),
        ("gap_mm = 30", "gap_mm = 30\nfloors = [1]", "no columns; leave out 'columns'"),
        ("gap_mm = 30", "gap_mm = 30\nfloors = [3]", "floor 3 cannot meet"),
        ("gap_mm = 30", 'gap_mm = 30\nlaw = "hertz"', "columns bend like a spring"),
        ("gap_mm = 30", "gap_mm = 30\ny_m = 1.0", "leave these out, or the columns"),
    ],
)
def test_columns_that_cannot_be(
    wrong: str, right: str, sentence: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "street.toml").write_text(STREET.replace(wrong, right))
    with pytest.raises(SystemExit) as left:
        main(["pound", str(folder / "street.toml"), "--record", "elcentro-chopra"])
    assert left.value.code == 2
    assert sentence in " ".join(capsys.readouterr().err.split())
