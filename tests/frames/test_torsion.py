"""Sticks that turn: one storey by its closed form, several by a solver of its own, none without eccentricity."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from pounding import frames
from pounding.frames import FrameError
from pounding.frames.opensees_script import script
from pounding.frames.response import modal

MASS, STIFFNESS, PLAN = 2e5, 5e7, (20.0, 15.0)
RADIUS_2 = (PLAN[0] ** 2 + PLAN[1] ** 2) / 12.0


def stick(storeys: int = 1, **fields: Any) -> Any:
    tree = {
        "kind": "stick",
        "name": "office",
        "storeys": storeys,
        "storey_height_m": 3.2,
        "floor_mass_kg": [MASS] * storeys,
        "damping_ratio": 0.05,
        "plan_m": list(PLAN),
    }
    if not {"frequency_hz", "matrices"} & set(fields):
        tree["storey_stiffness_n_per_m"] = [STIFFNESS] * storeys
    return frames.from_mapping(tree | fields, "office.toml")


@pytest.mark.parametrize(("eccentricity", "ratio"), [(1.5, 1.2), (-3.0, 0.8), (0.75, 1.0)])
def test_one_storey_has_the_frequencies_of_the_closed_form(eccentricity: float, ratio: float) -> None:
    """Roots of x^2 - (1 + e^2 + R^2) x + R^2 = 0 with the eccentricity e in radii of gyration (Chopra, chapter 9)."""
    turning = frames.build(stick(torsion={"eccentricity_m": eccentricity, "frequency_ratio": ratio}))
    total = 1.0 + eccentricity**2 / RADIUS_2 + ratio**2
    roots = (total + np.array([-1.0, 1.0]) * np.sqrt(total**2 - 4.0 * ratio**2)) / 2.0
    assert turning.frequencies_hz == pytest.approx(
        np.sqrt(roots * STIFFNESS / MASS) / (2.0 * np.pi), rel=1e-9
    )


def test_a_push_in_the_middle_turns_the_side_that_is_soft() -> None:
    """F / k + e^2 F / K in the middle and a turn of e F / K, so that the side off the centre of stiffness moves further."""
    turning = frames.build(stick(torsion={"eccentricity_m": 2.0, "stiffness_n_m_per_rad": [4e9]}))
    moved = np.linalg.solve(turning.stiffness, turning.point_row(1) * 1e6)
    assert moved == pytest.approx([1e6 / STIFFNESS + 4.0 * 1e6 / 4e9, 2.0 * 1e6 / 4e9])
    assert turning.point_row(1, -7.5) @ moved > moved[0] > turning.point_row(1, 7.5) @ moved


def test_several_storeys_are_those_of_a_solver_of_its_own() -> None:
    springs, turns, off = [9e7, 7e7, 5e7], [8e9, 7e9, 3e9], [2.0, 1.0, -0.5]
    inertia = [1.1e7, 0.9e7, 0.8e7]
    torsion = {"eccentricity_m": off, "stiffness_n_m_per_rad": turns, "floor_inertia_kg_m2": inertia}
    found = frames.build(stick(3, storey_stiffness_n_per_m=springs, torsion=torsion))
    own = np.zeros((6, 6))
    for storey, (spring, turn, place) in enumerate(zip(springs, turns, off, strict=True)):
        drift, twist = np.zeros(6), np.zeros(6)
        drift[storey], twist[3 + storey] = 1.0, 1.0
        if storey:
            drift[storey - 1], twist[2 + storey] = -1.0, -1.0
        at_springs = drift - place * twist
        own += spring * np.outer(at_springs, at_springs) + turn * np.outer(twist, twist)
    squares = eigh(own, np.diag([MASS] * 3 + inertia), eigvals_only=True)
    assert found.frequencies_hz == pytest.approx(np.sqrt(squares) / (2.0 * np.pi), rel=1e-9)


@pytest.mark.parametrize("fields", [{}, {"frequency_hz": [1.0], "stiffness_ratio": 2.0}])
def test_without_eccentricity_it_is_the_plain_stick(fields: dict[str, Any]) -> None:
    plain = frames.build(stick(3, **fields))
    symmetric = stick(3, torsion={"frequency_ratio": 1.0}, **fields)
    alike = frames.build(symmetric)
    for name in ("mass", "stiffness", "damping", "influence", "frequencies_hz", "shapes", "floor_rz"):
        assert np.array_equal(getattr(alike, name), getattr(plain, name))
    turning = frames.build(symmetric, planar=False)
    # A ratio of 1: each turn has the frequency of its sway.
    assert turning.frequencies_hz == pytest.approx(np.repeat(plain.frequencies_hz, 2))
    assert turning.damping[:3, :3] == pytest.approx(plain.damping)
    assert np.abs(turning.damping[:3, 3:]).max() < 1e-9 * np.abs(plain.damping).max()


def test_a_mode_has_the_damping_of_the_sway_and_the_turn_that_it_is_made_of() -> None:
    torsion = {"eccentricity_m": 2.0, "frequency_ratio": 1.3}
    given = [0.02, 0.05, 0.03]
    found = frames.build(stick(3, damping_ratio=given, torsion=torsion))
    # With one inertia and one eccentricity for all floors each sway mixes with its own turn alone.
    total = 1.0 + 2.0**2 / RADIUS_2 + 1.3**2
    both = np.sqrt((total + np.array([-1.0, 1.0]) * np.sqrt(total**2 - 4.0 * 1.3**2)) / 2.0)
    frequencies = np.outer(frames.build(stick(3)).frequencies_hz, both).ravel()
    order = frequencies.argsort()
    assert found.frequencies_hz == pytest.approx(frequencies[order])
    assert found.damping_ratios == pytest.approx(np.repeat(given, 2)[order])
    modes = modal.analyse(found.definition)
    assert modes.effective_mass_ratio[:, 0].sum() == pytest.approx(1.0)
    assert modes.descriptions[:2] == ["1st bending in x", "1st torsion"]


def test_the_mass_that_a_push_finds_is_less_off_the_middle() -> None:
    turning = frames.build(stick(2, torsion={"eccentricity_m": 3.0, "frequency_ratio": 1.3}))
    assert turning.mass_at(2) == pytest.approx(MASS)
    row = turning.point_row(2, 5.0)
    assert turning.mass_at(2, 5.0) == pytest.approx(1.0 / (row @ np.linalg.solve(turning.mass, row)))


def test_matrices_may_turn() -> None:
    matrices = {"mass_kg": [[2e5, 1e4], [1e4, 2e5]], "stiffness_n_per_m": [[9e7, -4e7], [-4e7, 4e7]]}
    given = {"matrices": matrices, "floor_mass_kg": [], "torsion": {"frequency_ratio": 1.5}}
    turning = frames.build(stick(2, **given), planar=False)
    plain = frames.build(stick(2, **{**given, "torsion": {"frequency_ratio": 1.0}}))
    expected = np.sort(np.concatenate([plain.frequencies_hz, 1.5 * plain.frequencies_hz]))
    assert turning.frequencies_hz == pytest.approx(expected)


@pytest.mark.parametrize(
    ("torsion", "more", "sentence"),
    [
        ({}, {}, "either frequency_ratio or stiffness_n_m_per_rad, one of them (none is stated)"),
        ({"frequency_ratio": 1.0, "stiffness_n_m_per_rad": [1e9]}, {}, "(both are stated)"),
        ({"frequency_ratio": 0.0}, {}, "torsion.frequency_ratio is 0; it must be 0.05 to 20"),
        ({"stiffness_n_m_per_rad": [-1e9]}, {}, "torsion.stiffness_n_m_per_rad, value 1 is -1e+09 N m/rad"),
        ({"stiffness_n_m_per_rad": [1e9, 1e9]}, {}, "has 2 values, needs one for each of 1 storeys"),
        ({"frequency_ratio": 1.0, "floor_inertia_kg_m2": [0.0]}, {}, "value 1 is 0 kg m^2"),
        ({"frequency_ratio": 1.0, "eccentricity_m": 8.0}, {}, "is 8 m, off the floor, whose width"),
        ({"frequency_ratio": 1.0, "eccentricity_m": [1.0, 1.0]}, {}, "eccentricity_m has 2 values"),
        (
            {"frequency_ratio": 1.0, "eccentricity_m": [1.0]},
            {"frequency_hz": [1.0], "stiffness_ratio": 2.0},
            "only a chain has storeys of its own",
        ),
        ({"frequency_ratio": 1.0}, {"yielding": {"storey_shear_n": 1e6}}, "exclude each other"),
        ({"frequency_rati": 1.0}, {}, "did you mean frequency_ratio?"),
    ],
)
def test_torsion_that_cannot_be(torsion: dict[str, Any], more: dict[str, Any], sentence: str) -> None:
    with pytest.raises(FrameError) as caught:
        stick(torsion=torsion, **more)
    assert sentence in str(caught.value)
    assert "\n" not in str(caught.value)


def test_torsion_needs_the_plan() -> None:
    tree = {"kind": "stick", "name": "office", "torsion": {"frequency_ratio": 1.0}}
    with pytest.raises(FrameError, match="torsion needs plan_m, the floors' length along the shaking"):
        frames.from_mapping(tree)


def test_what_does_not_turn_is_refused_where_it_must_and_the_other_way_round() -> None:
    with pytest.raises(FrameError, match="whose floors do not turn"):
        frames.build(stick(), planar=False)
    eccentric = stick(torsion={"eccentricity_m": 1.0, "frequency_ratio": 1.2})
    with pytest.raises(FrameError, match="it has an eccentricity, planar=True cannot be"):
        frames.build(eccentric, planar=True)
    with pytest.raises(FrameError, match="its floors turn, and the script's nodes move along x alone"):
        script(frames.build(eccentric))
