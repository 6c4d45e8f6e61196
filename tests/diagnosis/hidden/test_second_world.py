"""The second world as far as it can be tested without OpenSees; with it: `python -m tests.second_world`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from pounding.diagnosis.benchmark.drawing import NOISES, draw_set
from pounding.diagnosis.benchmark.run import kind, run_benchmark
from pounding.diagnosis.case.case import Prior
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.opensees import materials
from pounding.diagnosis.hidden.opensees.building import NEAR, search
from pounding.diagnosis.hidden.opensees.flaws import drawn_flaws
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame
from pounding.diagnosis.hidden.opensees.remainder import Believed, Calibration, Seen, beyond_calibration
from pounding.diagnosis.hidden.opensees.shaking import PlaneScenario
from pounding.diagnosis.hidden.places import wanted
from pounding.diagnosis.hidden.reference import Typical
from pounding.diagnosis.hidden.worlds import OWN, SECOND


@pytest.fixture
def _without_opensees(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "openseespy", None)


@pytest.mark.usefixtures("_without_opensees")
def test_without_opensees_the_engine_is_refused_before_anything_is_made() -> None:
    with pytest.raises(CaseError, match=r"pip install openseespy==3\.7\.1\.2"):
        hide([], ["5A"], engine="opensees")
    with pytest.raises(CaseError, match="licence"):
        run_benchmark(4, engine="opensees")


@pytest.mark.parametrize("words", [["hide", "nothing", "--out", "CASE"], ["diagnose", "--benchmark", "4"]])
def test_the_command_refuses_in_one_sentence(words: list[str], tmp_path: Path) -> None:
    (tmp_path / "openseespy.py").write_text("raise ImportError('libblas.so.3 is not there')")
    words = [str(tmp_path / "case") if word == "CASE" else word for word in words]
    ran = subprocess.run(
        [sys.executable, "-m", "pounding", *words, "--engine", "opensees"],
        env=os.environ | {"PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert ran.returncode == 2
    assert "libblas3 liblapack3" in ran.stderr
    assert "libblas.so.3 is not there" in ran.stderr
    assert "Traceback" not in ran.stderr
    assert not (tmp_path / "case" / "case.toml").exists()


def test_wishes_that_a_world_cannot_grant() -> None:
    with pytest.raises(CaseError, match="engine 'abaqus' is not known; use one of own, opensees"):
        hide([], engine="abaqus")
    with pytest.raises(CaseError, match="torsional_eccentricity cannot be hidden by the engine opensees"):
        wanted("torsional_eccentricity", SECOND.effects, "opensees")
    with pytest.raises(CaseError, match="did you mean 'rattling_mass'"):
        wanted("ratling_mass", SECOND.effects, "opensees")
    with pytest.raises(CaseError, match="the engine own has no model error"):
        hide([], model_error=0.01)
    with pytest.raises(CaseError, match=r"noise is 80 %; give 0\.01 to 50"):
        hide([], noise=0.8)


def test_noise_can_be_asked_for_in_the_own_world_too() -> None:
    case = {"seed": 3, "source": "artificial", "duration_s": 1.0}
    truth = hide([], ["5A"], noise=0.05, **case).truth
    assert set(truth["noise"].values()) == {0.05}
    assert truth["table_noise"] == pytest.approx(2.5 * hide([], ["5A"], **case).truth["table_noise"])


def test_a_set_of_the_second_world_deals_its_effects_frames_and_noise() -> None:
    drawn = draw_set(120, 1, engine="opensees")
    assert {one.noise for one in drawn} == set(NOISES["opensees"])
    assert {one.frames for one in drawn} == {(name,) for name in ("5A", "5B", "10", "15A", "15B")}
    hidden = {effect for one in drawn for effect in one.effects}
    assert hidden == set(SECOND.catalogue) | set(SECOND.outside)
    assert {kind(one) for one in drawn if "rattling_mass" in one.effects} == {"outside"}
    assert set(OWN.effects) - set(SECOND.effects) == {"torsional_eccentricity"}
    assert all(one.noise is None for one in draw_set(120, 1))


def test_ramberg_and_osgood_by_sliders_follows_their_curve() -> None:
    law = materials.ramberg_osgood(10.0, 1e4, 0.2, 8.0)
    sliders, (_, elastic) = law.parts[:-1], law.parts[-1]
    assert all(stiffness > 0 for _, stiffness, _ in sliders)
    for force in (2.0, 10.0, 14.0):
        at = force / 1e4 * (1 + 0.2 * (force / 10.0) ** 7)
        given = sum(stiffness * min(at, slips) for _, stiffness, slips in sliders) + (elastic + 1e4) * at
        assert given == pytest.approx(force, rel=0.02)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_progressive_stop_has_its_stiffness_in_the_middle(side: float) -> None:
    (part,) = materials.progressive_stop(side * 1e-3, 1e5, 2e-4).parts
    half = len(part) // 2
    at, force = np.array(part[2 : half + 1]), np.array(part[half + 2 :])
    assert np.all(np.diff(at) > 0)
    assert np.interp(0.0, at, force) == 0.0
    pressed = [side * np.interp(side * (1e-3 + depth), at, force) for depth in (2e-4, 4e-4)]
    assert (pressed[1] - pressed[0]) / 2e-4 == pytest.approx(1e5)


@pytest.mark.parametrize("target", [0.002, 0.013, 0.03])
def test_the_scale_of_a_model_error_is_found(target: float) -> None:
    scale, found = search(lambda scale: 0.0005 + 0.006 * scale**1.5, target)
    assert abs(np.log(found / target)) < NEAR
    assert found == pytest.approx(0.0005 + 0.006 * scale**1.5)


def test_a_scale_at_which_no_frame_stands_is_avoided() -> None:
    def misfit(scale: float) -> float:
        if scale > 2:
            raise CaseError("it does not stand")
        return 0.01 * (1 + scale)

    scale, found = search(misfit, 0.5)
    assert scale <= 2
    assert found == pytest.approx(0.03, rel=0.1)


def test_a_frame_that_runs_away_with_any_model_error_is_refused() -> None:
    with pytest.raises(CaseError, match="any model error"):
        search(lambda _: np.inf, 0.01)


STEP_S = 2e-3
MASS = np.array([2.0, 1.5])
SPRINGS = np.array([1100.0, 1500.0])
"""Two storeys of shear: 3 and 7 Hz."""


def shear(springs: np.ndarray) -> np.ndarray:
    return np.array([[springs[0] + springs[1], -springs[1]], [-springs[1], springs[1]]])


def believed(springs: np.ndarray = SPRINGS, mass: np.ndarray = MASS, ratio: float = 0.02) -> Believed:
    storeys = np.array([shear(springs * one) for one in np.eye(2)])
    return Believed(mass, shear(springs), storeys, np.full(2, ratio))


@cache
def shaken(peak: float, cubic: float = 0.0, swaying: float = 0.0) -> Seen:
    """Two storeys under a shaking: they stiffen by `cubic`, and a part of the mass of the roof sways on it."""
    count = 4000
    rng = np.random.default_rng(4)
    table = peak * np.convolve(rng.standard_normal(count), np.ones(8) / 8, "same")
    mass = np.array([*MASS, max(swaying, 1e-3) * MASS[1]])
    circular, shapes = eigh(shear(SPRINGS), np.diag(MASS))
    damping = np.diag(MASS) @ shapes @ np.diag(0.04 * np.sqrt(circular)) @ shapes.T @ np.diag(MASS)
    held = mass[2] * (2 * np.pi * 4.0) ** 2

    def change(place: np.ndarray, rate: np.ndarray, ground: float) -> np.ndarray:
        pull = held * (place[2] - place[1]) + 0.02 * np.sqrt(held * mass[2]) * (rate[2] - rate[1])
        force = -shear(SPRINGS) @ place[:2] - damping @ rate[:2]
        force -= [cubic * SPRINGS[0] * place[0] ** 3, 0.0]
        force += [0.0, pull * bool(swaying)]
        return np.array([*force, -pull]) / mass - ground

    place, rate, now, told = np.zeros(3), np.zeros(3), np.zeros(3), []
    for ground in table:
        later = now
        # Average acceleration.
        for _ in range(4):
            moved = place + STEP_S * rate + STEP_S**2 / 4 * (now + later)
            later = change(moved, rate + STEP_S / 2 * (now + later), ground)
        place = place + STEP_S * rate + STEP_S**2 / 4 * (now + later)
        rate, now = rate + STEP_S / 2 * (now + later), later
        told.append([place[0], place[1], rate[1], now[1] + ground])
    fixed = np.zeros((count, 4))
    fixed[:, 3] = table
    return Seen(STEP_S, table, np.array(told), fixed, np.array([0, 1, 1, 1]), np.array([0, 0, 1, 2]))


def test_a_calibrated_frame_leaves_nothing_of_a_frame_within_its_priors() -> None:
    one_softer = believed(SPRINGS * [1.06, 0.97], MASS * [1.01, 0.99], ratio=0.03)
    left = beyond_calibration([shaken(3.0), shaken(2.0), shaken(1.0)], one_softer, Prior())
    assert left.shape == (2, 4)
    assert left.max() < 0.001


def test_a_frame_that_is_much_softer_is_found_again() -> None:
    """Out of step after a few swings: a descent from the believed stiffness leaves most of the motion."""
    left = beyond_calibration([shaken(3.0), shaken(2.0), shaken(1.0)], believed(1.2 * SPRINGS), Prior())
    assert left.max() < 0.001


def test_a_frame_outside_its_priors_is_not_calibrated_away() -> None:
    other = believed(SPRINGS * [1.0, 2.0], MASS * [1.0, 1.5])
    left = beyond_calibration([shaken(3.0), shaken(2.0), shaken(1.0)], other, Prior())
    assert np.median(left) > 0.05


def test_what_no_calibration_can_do_is_left_the_more_there_is() -> None:
    stiffening = [
        float(np.median(beyond_calibration([shaken(3.0, cubic), shaken(1.0, cubic)], believed(), Prior())))
        for cubic in (300.0, 1200.0)
    ]
    assert 3e-3 < stiffening[0] < 0.5 * stiffening[1]
    swaying = beyond_calibration([shaken(3.0, 0.0, 0.05), shaken(1.0, 0.0, 0.05)], believed(), Prior())
    assert swaying.min() > 5e-3


def test_the_slopes_of_the_calibration_are_those_of_what_is_left() -> None:
    calibration = Calibration([shaken(1.0)], believed(), Prior())
    here, step = np.full(len(calibration.sizes), 0.3), 1e-4
    slopes = calibration.slopes(here)
    for number, one in enumerate(np.eye(len(here))):
        differences = (calibration.rows(here + step * one) - calibration.rows(here - step * one)) / (2 * step)
        np.testing.assert_allclose(slopes[:, number], differences, atol=2e-3 * np.abs(differences).max())


def test_flaws_come_in_all_kinds_and_grow_with_their_scale() -> None:
    frame = PlaneFrame(
        "5A",
        0.2,
        np.full(3, 40.0),
        np.full(4, 500.0),
        np.full(3, 4.0),
        0.1,
        np.full(3, 0.1),
        np.full(3, 100.0),
        np.array([0.01]),
        joint_stated=500.0,
    )
    usual = Typical(*[np.full(3, value) for value in (2e-3, 1e-3, 2e-2, 0.1, 4e4, 10.0)], first_hz=3.0)
    flaws = drawn_flaws(np.random.default_rng(1), 3)
    assert flaws.shares.sum() == pytest.approx(4.0)
    bare = PlaneScenario({"5A": frame})
    small, large = (flaws.on(bare, "5A", usual, scale) for scale in (0.5, 1.0))
    for rig in (small, large):
        assert {link(1.0).upper for link in rig.links} == {1, 2, 3}
        assert len(rig.riders) == 3
        assert len(rig.frames["5A"].slip_share) == 4
    assert large.frames["5A"].slip_share == pytest.approx(2 * small.frames["5A"].slip_share)
    assert [one.mass for one in large.riders] == pytest.approx([2 * one.mass for one in small.riders])
    without = flaws.on(bare, "5A", usual, 0.0)
    assert (without.links, without.riders) == ((), ())
    assert not without.frames["5A"].slip_share.any()
    assert json.dumps(flaws.stated())
