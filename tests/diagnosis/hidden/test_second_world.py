"""The second world as far as it can be tested without OpenSees; with it: `python -m tests.second_world`."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from pounding.diagnosis.benchmark.drawing import NOISES, draw_set
from pounding.diagnosis.benchmark.run import kind, run_benchmark
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.opensees import materials
from pounding.diagnosis.hidden.opensees.building import NEAR, search
from pounding.diagnosis.hidden.opensees.flaws import drawn_flaws
from pounding.diagnosis.hidden.opensees.plane_frame import PlaneFrame
from pounding.diagnosis.hidden.opensees.remainder import Seen, beyond_linear
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
        [sys.executable, "-m", "pounding.experiments.command", *words, "--engine", "opensees"],
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


def swung(cubic: float, peak: float, eccentric: float = 0.0) -> Seen:
    """Two modes under a shaking, seen by two sensors: one stiffens by `cubic`, a third one is seen only if `eccentric`."""
    step, count = 2e-3, 3000
    rng = np.random.default_rng(4)
    table = peak * np.convolve(rng.standard_normal(count), np.ones(8) / 8, "same")
    hz, ratio = np.array([3.0, 9.0, 4.4]), np.array([0.02, 0.01, 0.02])
    circular = 2 * np.pi * hz
    moved = np.zeros((count, 3))
    rate = np.zeros(3)
    for sample in range(1, count):
        at = moved[sample - 1]
        pull = circular**2 * at * (1 + np.array([cubic, 0.0, 0.0]) * at**2) + 2 * ratio * circular * rate
        rate = rate + step * (-table[sample - 1] - pull)
        moved[sample] = at + step * rate
    shapes = np.array([[1.0, 0.4], [0.5, -1.0], [eccentric, eccentric]])
    return Seen(step, table, step**2 * np.cumsum(np.cumsum(table)), moved @ shapes)


def test_the_best_linear_frame_leaves_nothing_of_a_linear_frame() -> None:
    """Its frequencies were believed a little wrong, and its damping twice."""
    runs = [swung(0.0, 3.0), swung(0.0, 1.0)]
    left = beyond_linear(runs, np.array([3.05, 8.9]), np.array([0.04, 0.005]))
    assert left.shape == (2,)
    assert left.max() < 1e-3


def test_a_frame_that_is_much_softer_is_still_a_linear_frame() -> None:
    """Out of step after a few swings: a descent from the believed frequencies leaves 1 to 5 %."""
    believed = 1.12 * np.array([3.0, 9.0]), np.array([0.005, 0.005])
    left = beyond_linear([swung(0.0, 3.0), swung(0.0, 1.0)], *believed)
    assert left.max() < 1e-3


def test_what_no_linear_frame_can_do_is_left_the_more_there_is() -> None:
    believed = np.array([3.0, 9.0]), np.array([0.02, 0.01])
    stiffening = [
        float(np.median(beyond_linear([swung(cubic, 3.0), swung(cubic, 1.0)], *believed)))
        for cubic in (20.0, 80.0)
    ]
    assert 1e-3 < stiffening[0] < 0.5 * stiffening[1]
    swaying = beyond_linear([swung(0.0, 3.0, 0.05), swung(0.0, 1.0, 0.05)], *believed)
    assert swaying.min() > 5e-3


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
