"""Fragilities: critical intensities against runs with contact, fits of known curves, sets of records, the verb."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from pounding.contact.parameters import thesis_law
from pounding.experiments.command.app import main
from pounding.experiments.errors import ExperimentError
from pounding.experiments.fragility.capacity import Limit, closings, passing, touching_intensity
from pounding.experiments.fragility.intensity import Intensity
from pounding.experiments.fragility.lognormal import Lognormal, band, fit_capacities, fit_counts
from pounding.experiments.records import find
from pounding.experiments.records.sets import record_set
from pounding.experiments.rig.contacts import Contact
from tests.experiments.rig.models import shear, two_sines

FRAMES = (shear(2, 3.0), shear(3, 6.4))
CONTACT = Contact(thesis_law("linear_viscoelastic", "printed", masses=(6.0, 6.0)), 0.004, 2, 0)
RECORDS = (two_sines(1.2), two_sines(1.2).flipped())


def test_at_the_touching_intensity_the_floors_begin_to_touch() -> None:
    for record in RECORDS:
        closing = closings(FRAMES, [CONTACT], record)
        critical = touching_intensity(closing, [CONTACT], record.name, record.pga_g)
        factors = critical / record.pga_g * np.array([[0.995, 1.01]])
        (below, above), *_ = passing(FRAMES, [CONTACT], [record], factors, [Limit("force", 0.0)])[0]
        assert not below
        assert above


def test_a_drift_limit_is_passed_by_the_stronger_run() -> None:
    passed = passing(FRAMES, [CONTACT], RECORDS, np.array([[0.01, 3.0]] * 2), [Limit("drift", 0.02)])
    assert passed.shape == (1, 2, 2)
    assert not passed[0, :, 0].any()
    assert passed[0, :, 1].all()


def test_fits_find_the_curve_that_made_the_data() -> None:
    generator, truth = np.random.default_rng(5), Lognormal(0.3, 0.4)
    capacity = truth.median_g * np.exp(truth.beta * generator.standard_normal(4000))
    exact = fit_capacities(capacity)
    levels = np.geomspace(0.1, 1.0, 9)
    counted = fit_counts(levels, capacity[:, None] < levels)
    for found in (exact, counted):
        assert found.median_g == pytest.approx(0.3, rel=0.03)
        assert found.beta == pytest.approx(0.4, rel=0.05)


def test_a_band_holds_the_truth_about_as_often_as_it_says() -> None:
    generator, truth = np.random.default_rng(6), Lognormal(0.3, 0.4)
    inside = []
    for _ in range(40):
        capacity = truth.median_g * np.exp(truth.beta * generator.standard_normal(44))
        low, high = band(lambda some, own=capacity: fit_capacities(own[some]), 44, np.array([0.3]))
        inside.append(low[0] <= 0.5 <= high[0])
    assert 0.78 <= np.mean(inside) <= 0.98


@pytest.mark.parametrize("counts", [[0, 0, 5], [0, 5, 5], [0, 3, 5]])
def test_counts_that_do_not_say_how_steep_the_curve_is(counts: list[int]) -> None:
    passed = np.array([[row < count for count in counts] for row in range(5)])
    with pytest.raises(ExperimentError, match="two or more levels at which some do and some do not"):
        fit_counts(np.array([0.1, 0.2, 0.4]), passed)


def test_one_record_is_no_fragility() -> None:
    with pytest.raises(ExperimentError, match="two records or more"):
        fit_capacities(np.array([0.3]))


def test_intensities_scale_with_the_acceleration() -> None:
    record = find("elcentro-chopra")
    doubled = record.scaled(1.0, 2.0 * record.pga_g)
    for intensity in (Intensity(), Intensity(1.0)):
        assert intensity.of(doubled) == pytest.approx(2.0 * intensity.of(record))
    assert Intensity().of(record) == record.pga_g


def test_the_sets_of_fema_have_both_components_of_all_pairs() -> None:
    far = record_set("fema-p695-farfield")
    assert len(far) == 44
    assert [far[0].name, far[43].name] == ["farfield-1-a", "farfield-22-b"]
    # Northridge, Beverly Hills Mulholland, 279: the greater of its pair.
    assert far[1].pga_g == pytest.approx(find("beverlyhills-mul279").pga_g)
    assert len(record_set("fema-p695-nearfield-no-pulse")) == 28


def test_a_folder_is_a_set(tmp_path: Path) -> None:
    with pytest.raises(ExperimentError, match="no file in it ends in"):
        record_set(str(tmp_path))
    (tmp_path / "one.csv").write_text("time_s,acceleration_m_s2\n0,0\n0.1,1\n0.2,0\n")
    assert [record.name for record in record_set(str(tmp_path))] == ["one"]
    with pytest.raises(ExperimentError, match="is no folder and no known set"):
        record_set("femap695")


def test_the_verb_writes_curves_that_scale_with_the_gap(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("left", "right"):
        main(["new-frame", str(tmp_path / f"{name}.toml")])
    text = (tmp_path / "right.toml").read_text()
    (tmp_path / "right.toml").write_text(text.replace("[1.1, 3.2]", "[1.9]").replace("[0.03, 0.04]", "0.03"))
    street = str(tmp_path / "street.toml")
    main(["new-street", street, str(tmp_path / "left.toml"), str(tmp_path / "right.toml")])
    capsys.readouterr()
    records = [word for name in ("elcentro-chopra", "elcentro-peer180") for word in ("--record", name)]
    words = [
        "fragility",
        street,
        *records,
        "--gap",
        "50",
        "--gap",
        "100",
        "--out",
        str(tmp_path / "out"),
        "--json",
    ]
    main(words)
    found = json.loads(capsys.readouterr().out)
    small, large = found["fragilities"]
    assert large["median_g"] == pytest.approx(2.0 * small["median_g"])
    assert large["beta"] == pytest.approx(small["beta"])
    assert (tmp_path / "out" / "fragility.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["5A", "--record", "elcentro-chopra"], "is one frame and no street file"),
        (["STREET", "--record", "elcentro-chopra"], "1 record was found; a fragility needs several"),
        (
            ["STREET", "--record", "elcentro-chopra", "--record", "elcentro-chopra"],
            "are the same ground motion",
        ),
        (["STREET", "--set", "nowhere"], "is no folder and no known set"),
        (["STREET", "--set", "fema-p695-farfield", "--force", "-1"], "--force is -1 kN"),
        (["STREET", "--set", "fema-p695-farfield", "--gap", "0"], "touch at any intensity"),
    ],
)
def test_the_verb_refuses(
    tmp_path: Path, words: list[str], sentence: str, capsys: pytest.CaptureFixture[str]
) -> None:
    street = tmp_path / "street.toml"
    main(["new-street", str(street), "10", "5B", "--gap", "3"])
    with pytest.raises(SystemExit) as left:
        main(["fragility", *(str(street) if word == "STREET" else word for word in words)])
    assert left.value.code == 2
    assert sentence in " ".join(capsys.readouterr().err.split())
