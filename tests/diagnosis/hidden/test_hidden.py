"""Hidden cases: what is hidden and stated, and that what makes them shares nothing with the diagnosis."""

from __future__ import annotations

import ast
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from pounding import frames
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.errors import CaseError
from pounding.diagnosis.hidden import laws
from pounding.diagnosis.hidden.baseline import baseline
from pounding.diagnosis.hidden.contact_effects import CONTACT
from pounding.diagnosis.hidden.effects import CATALOGUE, hysteresis, joint_flexibility, loosening
from pounding.diagnosis.hidden.hide import VISIBILITY, Hidden, hide
from pounding.diagnosis.hidden.instruments import PAIR_RATES_HZ
from pounding.diagnosis.hidden.modes import lone_storey_stiffness, storey_stiffness
from pounding.diagnosis.hidden.outsiders import OUTSIDE
from pounding.diagnosis.hidden.reference import Typical
from pounding.diagnosis.hidden.rigging import draw_rig
from pounding.diagnosis.hidden.scenario import Scenario
from pounding.diagnosis.hidden.setting import Parameters, Setting
from pounding.diagnosis.hidden.visibility import Eye, nudged, ordinary_parameters
from pounding.diagnosis.hidden.whole_frame import STATES, in_all_storeys, yielding
from pounding.diagnosis.hidden.worlds import OWN
from pounding.diagnosis.hidden.writing import write_hidden
from pounding.experiments.errors import ExperimentError

HIDDEN = Path(__file__).parents[3] / "diagnosis" / "hidden"

MAY_USE = {
    "pounding.diagnosis.errors",
    "pounding.diagnosis.case.case",
    "pounding.diagnosis.case.writing",
    "pounding.diagnosis.case.quantities",
    "pounding.constants",
    "pounding.frames",
    "pounding.frames.files",
    "pounding.experiments.errors",
    "pounding.experiments.records",
    "pounding.scale",
    "pounding.spelling",
}
"""Frames as data, ground motions, whole files, and the format's reading, writing and units; nothing that knows an effect."""


@pytest.mark.parametrize(
    "path", sorted(HIDDEN.rglob("*.py")), ids=lambda path: path.relative_to(HIDDEN).as_posix()
)
def test_imports_nothing_that_knows_an_effect(path: Path) -> None:
    used = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            used |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0
            # `from pounding import frames` names a package, `from pounding.frames import load` a member of one.
            packages = ("pounding", "pounding.diagnosis", "pounding.experiments")
            used |= (
                {f"{node.module}.{alias.name}" for alias in node.names}
                if node.module in packages
                else {str(node.module)}
            )
        elif isinstance(node, ast.Call):
            assert getattr(node.func, "attr", getattr(node.func, "id", "")) not in (
                "import_module",
                "__import__",
            )
    ours = {name for name in used if name.partition(".")[0] == "pounding"}
    assert {name for name in ours if not name.startswith("pounding.diagnosis.hidden")} <= MAY_USE


def test_the_rule_of_imports_has_an_object() -> None:
    """Every module that may be used is used, so that the names above are those that are imported."""
    text = "".join(path.read_text(encoding="utf-8") for path in HIDDEN.rglob("*.py"))
    assert all(
        f"from {name} import" in text or f"from pounding import {name.rpartition('.')[2]}" in text
        for name in MAY_USE
    )


@cache
def bare() -> Hidden:
    """Return the case in which nothing is hidden, once for all effects; they change nothing of it."""
    return hide([], ["5A"], seed=8, source="artificial", duration_s=2.0)


@pytest.mark.parametrize("effect", [*CATALOGUE, *OUTSIDE])
def test_every_effect_changes_the_case_and_states_itself(effect: str) -> None:
    hidden = hide([effect], ["5A"], seed=8, visibility=2.0, source="artificial", duration_s=2.0)
    (truth,) = hidden.truth["effects"]
    assert truth["effect"] == effect
    assert hidden.truth["kind"] == ("outside" if effect in OUTSIDE else "single")
    assert all(np.isfinite(parameter["value"]) for parameter in truth["parameters"])
    assert truth["visibility"] > 0.05
    assert bare().truth["kind"] == "nothing"
    assert [channel.name for channel in bare().case.channels] == [
        channel.name for channel in hidden.case.channels
    ]


def test_the_same_seed_is_the_same_case_and_a_round_trip_keeps_it(tmp_path: Path) -> None:
    one = hide(["coulomb_friction:3"], ["5B"], seed=1, visibility=3.0, source="artificial", duration_s=2.0)
    two = hide(["coulomb_friction:3"], ["5B"], seed=1, visibility=3.0, source="artificial", duration_s=2.0)
    for mine, other in zip(one.case.runs, two.case.runs, strict=True):
        np.testing.assert_array_equal(mine.values, other.values)
    assert one.truth["effects"][0]["storey"] == 3
    write_hidden(one, tmp_path / "case", tmp_path / "truth.json")
    again = read_case(tmp_path / "case")
    np.testing.assert_allclose(again.runs[0].values, one.case.runs[0].values, rtol=1e-5)
    assert not list((tmp_path / "case").glob("*truth*"))
    with pytest.raises(CaseError, match="holds a case already"):
        write_hidden(one, tmp_path / "case")


def test_reference_runs_are_of_the_frame_before_the_effect() -> None:
    wish = {"effects": ["sensor_gain:5A_a5"], "seed": 5, "duration_s": 1.0, "source": "artificial"}
    plain, more = hide(**wish), hide(**wish, reference=2)
    since, before = more.case.runs[:3], more.case.runs[3:]
    assert all(
        np.array_equal(one.values, run.values) for one, run in zip(plain.case.runs, since, strict=True)
    )
    assert [(run.file, run.role) for run in before] == [
        ("before1.csv", "reference"),
        ("before2.csv", "reference"),
    ]
    column = more.case.channel_index("5A_a5")
    (size,) = more.truth["effects"][0]["parameters"]
    ratio = since[0].values[:, column].std() / before[0].values[:, column].std()
    assert ratio == pytest.approx(1.0 + size["value"], rel=0.02)


def test_the_noise_is_as_stated() -> None:
    """A null's channels over frequencies that no frame and no table reaches are noise alone."""
    hidden = hide([], ["5A"], seed=2, source="artificial")
    log, run = hidden.truth, hidden.case.runs[0]
    values = run.values[:, 1]
    # The window keeps what does not end at rest from leaking all over the spectrum.
    window = np.hanning(len(values))
    spectrum = np.abs(np.fft.rfft(values * window)) ** 2
    frequency = np.fft.rfftfreq(len(values), run.step_s)
    quiet = frequency > 150.0
    noise = np.sqrt(spectrum[quiet].mean() / np.sum(window**2))
    stated = log["noise"][hidden.case.channels[1].name]
    assert noise / values.std() == pytest.approx(stated, rel=0.1)


def test_visibility_is_drawn_in_its_range() -> None:
    drawn = [
        hide(["sensor_offset"], seed=seed, source="artificial", duration_s=3.0).truth["effects"][0]
        for seed in range(3)
    ]
    for truth in drawn:
        assert VISIBILITY[0] <= truth["visibility_wanted"] <= VISIBILITY[1]
        assert truth["visibility"] == pytest.approx(truth["visibility_wanted"], rel=0.3)


def test_what_nuisance_parameters_make_they_imitate() -> None:
    rig = draw_rig(np.random.default_rng(2), ["5A"], "artificial", 4.0, world=OWN)
    noise = rig.log.noise_of(rig.channels, rig.clean(rig.bare, 0))
    eye = Eye(lambda scenario, coarsely: rig.clean(scenario, 0, coarsely=coarsely), rig.bare, noise)
    far = np.random.default_rng(3).uniform(-2.0, 2.0, ordinary_parameters(rig.bare))
    # A frame that is softer or stiffer by a tenth is soon out of step: the refit has to follow it there.
    for share in (0.1, 0.3, 1.0):
        raw, left = eye.sees(rig.clean(nudged(rig.bare, share * far), 0))
    assert raw > 30
    assert left < 0.02 * raw


def test_a_model_error_hides_an_effect_as_noise_does() -> None:
    rig = draw_rig(np.random.default_rng(1), ["5A"], "artificial", 2.0, world=OWN)
    bare = rig.clean(rig.bare, 0)
    noise, moved = rig.log.noise_of(rig.channels, bare), bare.std(axis=0)
    responses = np.array([not channel.is_table for channel in rig.channels])
    left = np.where(responses, np.linspace(0.01, 0.05, len(responses)), 0.0)
    channels = {channel.name: one for channel, one in zip(rig.channels, left, strict=True) if one}
    both = replace(rig, model_error={"misfit": 0.03, "channels": channels}).errors(bare)
    assert rig.errors(bare) == pytest.approx(noise)
    assert both[responses] == pytest.approx(np.hypot(noise, left * moved)[responses])
    assert both[~responses] == pytest.approx(noise[~responses])


@pytest.mark.parametrize(
    ("effects", "options", "said"),
    [
        (["coulomb_fricton"], {}, "did you mean 'coulomb_friction'"),
        (["xyz"], {}, "known are nothing, stiffness_change"),
        (["coulomb_friction:9"], {}, "storey '9' is not on 5A; give 1 to 5"),
        (["sensor_gain:5A_a9"], {}, "no channel '5A_a9'"),
        *(
            ([f"{name}:3"], {}, f"^{name}:3: {name} has no storey, floor or channel to choose; write {name}$")
            for name in ("joint_flexibility", "table_gain", "contact_damping", "nothing")
        ),
        ([], {"visibility": -1.0}, "visibility is -1"),
        ([], {"source": "recrods"}, "motions 'recrods' are not known"),
        ([], {"frames": ["5C"]}, "did you mean 5"),
        ([], {"duration_s": 0.1}, "duration is 0.1 s; give 0.5 to 60"),
        ([], {"reference": 4}, "4 reference runs are not made; give 0 to 3"),
        ([], {"reference": 1, "frames": ["5A", "5B"]}, "none for frames that touch"),
    ],
)
def test_bad_wishes(effects: list[str], options: dict, said: str) -> None:
    options = {"source": "artificial", **options}
    with pytest.raises((CaseError, frames.FrameError), match=said):
        hide(effects, **options)


def test_a_folder_of_records_that_is_not_there_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("POUNDING_RECORDS", "/nowhere")
    with pytest.raises(ExperimentError, match="POUNDING_RECORDS"):
        hide([], source="records")


@pytest.mark.slow
@pytest.mark.parametrize("effect", [*CONTACT, "coulomb_friction", "hidden_appendage"])
def test_effects_of_a_pair(effect: str, tmp_path: Path) -> None:
    hidden = hide([effect], ["10", "5B"], seed=4, source="artificial", duration_s=1.5)
    (truth,) = hidden.truth["effects"]
    assert hidden.truth["kind"] == ("outside" if effect in OUTSIDE else "single")
    write_hidden(hidden, tmp_path / "case")
    case = read_case(tmp_path / "case")
    assert (case.contacts[0].left, case.contacts[0].right, case.contacts[0].floor) == ("10", "5B", 5)
    if effect == "second_contact":
        assert (truth["left"], truth["right"]) == ("10", "5B")
        assert 1 <= truth["floor"] <= 4
        assert truth["parameters"][0]["value"] < 1e3 * case.contacts[0].gap_m
    elif effect in CONTACT:
        assert truth["contact"] == 1
    if effect == "gap_offset":
        # The truth of the effect is against what the case states.
        offset = 1e-3 * truth["parameters"][0]["value"]
        assert hidden.truth["touches"][0]["gap_m"] == pytest.approx(case.contacts[0].gap_m + offset, abs=1e-9)


@pytest.mark.parametrize("rate", PAIR_RATES_HZ)
def test_frames_apart_are_looked_at_coarsely_at_the_rate_of_the_logger(rate: float) -> None:
    """At 2 kHz an effect of a pair could not be hidden: half the samples were looked at."""
    world = replace(OWN, pair_rates_hz=(rate,))
    rig = draw_rig(np.random.default_rng(1), ["10", "5B"], "artificial", 0.6, world=world)
    fine, coarse = (rig.clean(rig.apart, 0, coarsely=coarsely) for coarsely in (False, True))
    assert coarse.shape == fine.shape
    assert np.std(coarse - fine) < 0.05 * np.std(fine)


def test_a_contact_effect_needs_a_pair() -> None:
    with pytest.raises(CaseError, match="nothing touches on a single frame"):
        hide(["gap_offset"], ["5A"], source="artificial", duration_s=1.0)
    with pytest.raises(CaseError, match="give one, or two different ones"):
        hide([], ["5A", "5A"], source="artificial", duration_s=1.0)


def test_a_clock_of_another_rate_can_be_hidden() -> None:
    (truth,) = hide(["clock_rate"], ["5A"], seed=4, source="artificial", duration_s=3.0).truth["effects"]
    assert truth["effect"] == "clock_rate"
    assert truth["channel"].startswith("5A_")
    assert 0 < abs(truth["parameters"][0]["value"]) < 0.03


def test_a_law_in_all_storeys_is_that_of_one_in_each_in_proportion_to_its_stiffness() -> None:
    """A yielding part of one share and one yield drift, but for a few per cent."""
    built, stiffness = baseline("5A"), np.array([5e4, 4e4, 4e4, 3e4, 2e4])
    even = Typical(
        *(np.full(5, value) for value in (3e-3, 1e-3, 0.03, 0.5)), stiffness, np.full(5, 10.0), 4.0
    )
    setting = Setting(Scenario({"5A": built}), even, "5A")
    put = in_all_storeys(hysteresis, yielding)
    scenario, stated = put(setting, 1.0, np.random.default_rng(1))
    assert [(spring.upper, spring.lower) for spring in scenario.springs] == [(n, n - 1) for n in range(1, 6)]
    each = [law for spring in scenario.springs if isinstance(law := spring.make(1.0), laws.BoucWen)]
    share, drift = np.array([(law.stiffness, law.yield_force / law.stiffness) for law in each]).T
    assert share / stiffness == pytest.approx(stated["stiffness_share"][0])
    assert 1e3 * drift == pytest.approx(stated["yield_drift"][0], rel=0.1)
    assert np.ptp(drift) > 0.0


def test_what_all_storeys_lose_is_stated_over_the_stiffness_of_a_storey_alone_too() -> None:
    """Joints turn: under a load a storey drifts more than its own columns let it."""
    built = baseline("15A")
    still = np.ones(15)
    setting = Setting(
        Scenario({"15A": built}),
        Typical(still, still, still, still, storey_stiffness(built), still, 4.0),
        "15A",
    )
    _, stated = in_all_storeys(loosening, STATES["all_loosening"])(setting, -0.1, np.random.default_rng(1))
    value, _, lone = stated["final_relative_change"]
    assert value == pytest.approx(-0.1, rel=0.05)
    ratio = float(np.mean(storey_stiffness(built) / lone_storey_stiffness(built)))
    assert ratio < 0.8
    assert lone == pytest.approx(ratio * value, rel=0.02)


def test_friction_of_all_storeys_is_stated_by_what_slides_and_by_what_breaks_away() -> None:
    built, level, breakaway = baseline("15A"), 2.0, 1.2
    still = np.ones(15)
    under_load, alone = storey_stiffness(built), lone_storey_stiffness(built)
    setting = Setting(
        Scenario({"15A": built}), Typical(still, still, still, still, under_load, still, 4.0), "15A"
    )

    def rubbing(here: Setting, size: float, rng: np.random.Generator) -> tuple[Scenario, Parameters]:
        del size, rng
        return here.scenario, {"friction_force": (level, "N", breakaway * level)}

    put = in_all_storeys(rubbing, STATES["all_coulomb_friction"])
    value, unit, *others = put(setting, 1.0, np.random.default_rng(1))[1]["slip_drift"]
    assert unit == "um"
    assert value == pytest.approx(1e6 * level * np.mean(1 / under_load))
    assert others == pytest.approx([1e6 * force * np.mean(1 / alone) for force in (breakaway * level, level)])


@pytest.mark.parametrize("size", [0.01, -0.3])
def test_joints_are_uneven_by_a_part_of_their_change(size: float) -> None:
    """Joints that differ from each other by more than they changed would be what is seen, and not what is stated."""
    built, still = baseline("5A"), np.ones(5)
    setting = Setting(Scenario({"5A": built}), Typical(still, still, still, still, still, still, 4.0), "5A")
    scenario, stated = joint_flexibility(setting, size, np.random.default_rng(1))
    changes = np.log(scenario.frames["5A"].joint / built.joint)
    assert changes == pytest.approx(size, rel=0.12)
    assert np.ptp(changes) > 0.01 * abs(size)
    value, _ = stated["joint_stiffness"]
    assert value == pytest.approx(built.joint_stated * np.exp(size), rel=0.05 * abs(size))


def test_a_whole_frame_differs_by_more_than_a_calibration_is_for() -> None:
    for effect in ("all_stiffness_change", "all_added_mass"):
        hidden = hide([effect], ["5A"], seed=8, visibility=0.1, source="artificial", duration_s=2.0)
        (changed,) = [one["value"] for one in hidden.truth["effects"][0]["parameters"]]
        assert abs(np.log1p(changed)) > 0.5
