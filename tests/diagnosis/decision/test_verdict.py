"""The verdict by what it must do: hand-made findings, each on several kinds of data."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from pounding.diagnosis import decide
from pounding.diagnosis.decision import objections
from pounding.diagnosis.decision import verdict as verdict_rules
from pounding.diagnosis.decision.measures import (
    explained,
    less_certain,
    remaining,
    signal_to_noise,
)
from pounding.diagnosis.inference.filtering import Filtered
from pounding.diagnosis.inference.findings import BesideLatentForce
from pounding.diagnosis.inference.model_checks import DAMPING, STRUCTURE
from tests.diagnosis.decision.problems import (
    CUBIC,
    DATA,
    MASS,
    OTHER_FLOOR,
    PROBLEMS,
    Problem,
    Tried,
    allow,
    bench,
    decided,
    effect,
    findings,
    judged,
)

pytestmark = pytest.mark.usefixtures("made_up_fits")


@pytest.mark.parametrize("data", DATA)
@pytest.mark.parametrize("problem", PROBLEMS)
def test_the_verdict_is_what_the_findings_say(problem: str, data: str) -> None:
    wanted = PROBLEMS[problem]
    found, decision = decided(wanted, DATA[data])
    assert decision.verdict == wanted.verdict
    assert decision.named == (wanted.verdict in ("effect_named", "effect_class"))
    behind = () if wanted.behind is None else wanted.tried[wanted.behind].effects
    assert decision.judged.effects == tuple(one() for one in behind)
    assert [one.effects[0] for one in decision.alike] == [
        wanted.tried[number].effects[0]() for number in wanted.alike
    ]
    # Deciding leaves the findings as they are.
    assert decide(found) == decision


@pytest.mark.parametrize("data", DATA)
def test_more_evidence_for_what_explains_everything_never_takes_its_name_away(data: str) -> None:
    named = []
    for ln_bayes in np.geomspace(1.0, 1e5, 40):
        _, decision = decided(Problem(1.1, (Tried((CUBIC,), float(ln_bayes), 1.0),), ""), DATA[data])
        named.append(decision.verdict == "effect_named")
    assert named == sorted(named)
    assert not named[0]
    assert named[-1]


@pytest.mark.parametrize("data", DATA)
def test_what_a_candidate_leaves_decides_between_named_and_unknown(data: str) -> None:
    verdicts = [
        decided(Problem(6.0, (Tried((CUBIC,), 5000.0, over),), ""), DATA[data])[1].verdict
        for over in np.linspace(1.0, 5.9, 25)
    ]
    assert verdicts[0] == "effect_named"
    assert verdicts[-1] == "unknown_effect"
    unknown = [verdict == "unknown_effect" for verdict in verdicts]
    assert unknown == sorted(unknown)


@pytest.mark.parametrize("data", DATA)
def test_what_remains_makes_sizes_less_certain_as_one_sample_a_radian(data: str) -> None:
    found, _ = decided(PROBLEMS["one effect explains everything"], DATA[data])
    model, best = found.model, found.judged[0]
    assert less_certain(found, best) == 1.0
    radian = 1 / (2 * np.pi * model.structure.lowest_hz * model.observed.runs[0].step_s)
    assert less_certain(found, found.null) == pytest.approx(np.sqrt(1 + (4.0**2 - 1.15**2) * radian))


@pytest.mark.parametrize("data", DATA)
def test_measures_are_in_units_of_the_noise(data: str) -> None:
    found, _ = decided(PROBLEMS["one effect explains everything"], DATA[data])
    best, other = found.judged
    assert remaining(found, best) == pytest.approx(1.0)
    assert remaining(found, found.null) == pytest.approx(4.0)
    assert signal_to_noise(found, best) == pytest.approx(np.sqrt(15.0))
    assert signal_to_noise(found, other, best) == 0.0
    assert explained(found, best, 1.0) == pytest.approx(1.0)
    assert 0.0 < explained(found, other, 1.0) < 0.5


def test_frames_far_from_the_priors_are_unknown_however_well_they_fit() -> None:
    """Another frame than the believed one: no effect of the catalogue may be named on it."""
    model, usual = bench()
    kinds = [parameter.kind for parameter in model.parameters]
    values = np.where([kind == "storey_stiffness" for kind in kinds], 5.0, 0.0) * model.std
    other = cast(Filtered, replace(usual, values=values))
    for name in ("nothing was tried and nothing is left", "one effect explains everything"):
        decision = decide(findings(PROBLEMS[name], DATA["quiet"], other))
        assert decision.verdict == "unknown_effect"
        assert decision.model_checks


def test_an_effect_that_bends_a_frame_which_is_itself_without_it_is_not_another_frame(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The baseline model leaves 3.9 % of the motion within its priors, and the effect explains that far beyond them."""
    model, usual = bench()
    kinds = [parameter.kind for parameter in model.parameters]
    values = np.where([kind == "storey_stiffness" for kind in kinds], 5.0, 0.0) * model.std
    other = cast(Filtered, replace(usual, values=values))
    problem, data = PROBLEMS["one effect explains everything"], DATA["quiet"]
    found = findings(problem, data, other)
    found.null = judged(data, Tried((), 0.0, problem.null), usual)
    for allowed, verdict in ((0.038, "unknown_effect"), (0.04, "nothing_missing")):
        allow(monkeypatch, allowed)
        decision = decide(found)
        assert decision.verdict == verdict
        assert bool(decision.model_checks) == (verdict == "unknown_effect")


@pytest.mark.parametrize(
    ("without", "beside", "ln_bayes", "verdict"),
    [
        pytest.param(5.0, 0.0, 40.0, "effect_named", id="another one without it"),
        pytest.param(0.0, 0.0, 40.0, "nothing_missing", id="itself without it, too"),
        pytest.param(5.0, 5.0, 40.0, "unknown_effect", id="another one with it, too"),
        pytest.param(5.0, 0.0, 20.0, "unknown_effect", id="too little says so"),
    ],
)
def test_an_effect_too_small_to_be_named_is_if_the_frame_is_another_one_without_it(
    without: float, beside: float, ln_bayes: float, verdict: str
) -> None:
    """What is missing is in stiffness and mass, and takes nothing out of the channels."""
    model, usual = bench()
    far = np.array([one.kind == "storey_stiffness" for one in model.parameters]) * model.std
    found = findings(
        Problem(1.0, (Tried((MASS,), ln_bayes, 1.0),), ""),
        DATA["quiet"],
        cast(Filtered, replace(usual, values=beside * far)),
    )
    found.null = judged(
        DATA["quiet"], Tried((), 0.0, 1.0), cast(Filtered, replace(usual, values=without * far))
    )
    # The likeliest baseline model has a wide discrepancy instead.
    found.wide = judged(DATA["quiet"], Tried((), 0.0, 1.0), usual)
    assert decide(found).verdict == verdict


@pytest.mark.parametrize("over", [1.0, 3.0], ids=["moves as measured", "moves otherwise"])
def test_sizes_beside_any_force_count_only_if_the_frame_moves_as_measured_with_them(
    monkeypatch: pytest.MonkeyPatch, over: float
) -> None:
    problem, data = PROBLEMS["two effects at once, in two places"], DATA["quiet"]
    sized = judged(data, replace(problem.tried[0], over=over), bench()[1])
    monkeypatch.setattr(verdict_rules, "with_sizes", lambda *_: sized)
    found, decision = decided(problem, data)
    assert decision.verdict == "effect_named"
    assert decision.judged is (sized if over == 1.0 else found.judged[0])


@pytest.mark.parametrize(
    ("alone", "alike", "verdict"),
    [(0.0, 0.0, "effect_named"), (0.0, 5.0, "unknown_effect"), (5.0, 0.0, "unknown_effect")],
    ids=["the law bends it", "it is another one with the effect", "it is another one without it"],
)
def test_what_a_law_gets_wrong_bends_a_frame_though_only_noise_remains(
    monkeypatch: pytest.MonkeyPatch, alone: float, alike: float, verdict: str
) -> None:
    """The likeliest parameters are five deviations off with the effect; those nearest to the baseline say what it is."""
    model, usual = bench()
    far = np.array([one.kind == "storey_stiffness" for one in model.parameters]) * model.std
    problem, data = PROBLEMS["one effect explains everything"], DATA["quiet"]
    found = findings(problem, data, cast(Filtered, replace(usual, values=5.0 * far)))
    found.null = judged(
        data, Tried((), 0.0, problem.null), cast(Filtered, replace(usual, values=alone * far))
    )
    allow(monkeypatch, 0.038)
    monkeypatch.setattr(objections, "nearest_frame", lambda *_: alike * far)
    assert decide(found).verdict == verdict


@pytest.mark.parametrize(
    ("also", "named"), [(0.0, 2), (5.0, 0)], ids=["with the second itself", "with both another frame"]
)
def test_a_frame_that_one_effect_makes_another_one_may_be_itself_with_two(also: float, named: int) -> None:
    """Little evidence is enough for the second: what the first left of it went into stiffness and mass, without misfit."""
    model, usual = bench()
    kinds = [parameter.kind for parameter in model.parameters]
    far = np.array([kind == "storey_stiffness" for kind in kinds]) * model.std
    found = findings(PROBLEMS["a second effect that adds little"], DATA["quiet"])
    for one in found.judged:
        fit: Any = one.fit
        shift = also if len(one.effects) == 2 else 5.0
        fit.filtered = cast(Filtered, replace(usual, values=shift * far))
    decision = decide(found)
    assert decision.named == bool(named)
    assert len(decision.judged.effects) == (named or 1)


@pytest.mark.parametrize(
    ("gained", "moved", "still", "left", "storey", "named"),
    [
        pytest.param(40.0, 3.2, 0.0, 1.0, 2, 2, id="what moved was the second effect"),
        pytest.param(20.0, 3.2, 0.0, 1.0, 2, 1, id="too little says so"),
        pytest.param(40.0, 2.8, 0.0, 1.0, 2, 1, id="calibration may move it as far"),
        pytest.param(40.0, 3.2, 0.0, 1.2, 2, 1, id="the law of the first effect may have moved it"),
        pytest.param(40.0, 3.2, 0.0, 1.2, 3, 2, id="the law of the first effect acts in another storey"),
        pytest.param(40.0, 3.2, 3.2, 1.0, 2, 1, id="something else moves another storey, too"),
    ],
)
def test_a_second_effect_that_calibration_took_is_named_where_the_first_does_not_bend_it(
    gained: float, moved: float, still: float, left: float, storey: int, named: int
) -> None:
    model, usual = bench()
    stiffness = partial(effect, "stiffness_change", storey)
    tried = (Tried((CUBIC, stiffness), 5000.0 + gained, left), Tried((CUBIC,), 5000.0, left))
    found = findings(Problem(4.0, tried, "effect_named"), DATA["quiet"])
    own = [(one.kind, one.place) for one in model.parameters]
    here, beside = (own.index(("storey_stiffness", place)) for place in (storey - 1, 0))
    for one in found.judged:
        values = np.zeros(len(model.std))
        values[beside] = still * model.std[beside]
        if len(one.effects) == 1:
            values[here] = -moved * model.std[here]
        fit: Any = one.fit
        fit.filtered = cast(Filtered, replace(usual, values=values))
    assert len(decide(found).judged.effects) == named


@pytest.mark.parametrize(
    ("moved", "left", "named"),
    [
        pytest.param(2.6, 1.0, 2, id="much likelier by the priors with both"),
        pytest.param(1.5, 1.0, 1, id="a little likelier"),
        pytest.param(2.6, 1.2, 1, id="the law of the first effect may have moved them"),
    ],
)
def test_a_second_effect_that_several_parameters_took_is_named(moved: float, left: float, named: int) -> None:
    """A mass beside friction: masses, stiffness and discrepancy each took a part, and no misfit is left."""
    model, usual = bench()
    kinds = ("frame_stiffness", "storey_stiffness", "modal_stiffness")
    far = np.array([one.kind in kinds for one in model.parameters]) * model.spread(usual.discrepancy)
    tried = (Tried((CUBIC, MASS), 5040.0, left), Tried((CUBIC,), 5000.0, left))
    found = findings(Problem(4.0, tried, ""), DATA["quiet"])
    for one in found.judged:
        fit: Any = one.fit
        values = (moved if len(one.effects) == 1 else 0.0) * far
        fit.filtered = cast(Filtered, replace(usual, values=values))
    assert len(decide(found).judged.effects) == named


@pytest.mark.parametrize(
    ("left", "beside", "named"),
    [
        pytest.param(1.5, 1.0, 2, id="both leave nothing but noise"),
        pytest.param(1.5, 1.3, 1, id="the law of the first effect may leave as much"),
        pytest.param(1.1, 1.0, 1, id="the first leaves no more than noise, either"),
    ],
)
def test_a_second_effect_that_leaves_nothing_needs_no_share_of_the_first_ones_evidence(
    left: float, beside: float, named: int
) -> None:
    """It adds 200 to 5,000: enough for a second effect, but less than a tenth."""
    tried = (Tried((CUBIC, OTHER_FLOOR), 5200.0, beside), Tried((CUBIC,), 5000.0, left))
    decision = decide(findings(Problem(6.0, tried, "effect_named"), DATA["quiet"]))
    assert len(decision.judged.effects) == named


@pytest.mark.parametrize(
    ("kinds", "still", "left", "verdict"),
    [
        pytest.param(DAMPING, 0.0, 1.2, "effect_named", id="damping taken by calibration"),
        pytest.param(STRUCTURE, 0.0, 1.2, "effect_named", id="stiffness and mass taken by calibration"),
        pytest.param(DAMPING, 4.0, 1.2, "nothing_missing", id="damping is as strange with the effect"),
        pytest.param(DAMPING, 0.0, 9.0, "unknown_effect", id="what remains is no error of a model"),
        pytest.param((), 0.0, 1.2, "nothing_missing", id="nothing was taken"),
    ],
)
def test_what_the_calibration_took_is_named_though_it_takes_little_out_of_the_motion(
    kinds: tuple[str, ...], still: float, left: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    allow(monkeypatch, 0.05)
    model, usual = bench()
    far = np.array([parameter.kind in kinds for parameter in model.parameters]) * model.std
    tried = (Tried((partial(effect, "damping_change", 2),), 200.0, left),)
    found = findings(Problem(1.01 * left, tried, verdict), DATA["quiet"])
    for one, shift in ((found.null, 4.0), (found.judged[0], still)):
        fit: Any = one.fit
        fit.filtered = cast(Filtered, replace(usual, values=shift * far))
    assert decide(found).verdict == verdict


@pytest.mark.parametrize(
    ("name", "moved", "still", "verdict"),
    [
        pytest.param("p_delta", 2.6, 0.0, "effect_named", id="much likelier by the priors with it"),
        pytest.param("p_delta", 1.5, 0.0, "nothing_missing", id="a little likelier"),
        pytest.param("p_delta", 2.6, 2.2, "nothing_missing", id="as unlikely with it"),
        pytest.param("all_loosening", 2.6, 0.0, "nothing_missing", id="every frame has a little of it"),
    ],
)
def test_what_several_parameters_took_is_named_though_each_is_within_its_prior(
    name: str, moved: float, still: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Joints half as stiff: the frame's stiffness, its joints and its discrepancy each took a part of that."""
    allow(monkeypatch, 0.05)
    model, usual = bench()
    kinds = ("frame_stiffness", "storey_stiffness", "modal_stiffness")
    far = np.array([parameter.kind in kinds for parameter in model.parameters]) * model.spread(
        usual.discrepancy
    )
    found = findings(Problem(1.2, (Tried((partial(effect, name),), 60.0, 1.19),), verdict), DATA["quiet"])
    for one, shift in ((found.null, moved), (found.judged[0], still)):
        fit: Any = one.fit
        fit.filtered = cast(Filtered, replace(usual, values=shift * far))
    assert decide(found).verdict == verdict
    # Beside an error of the frame that is in the model, what softens the whole frame is one more.
    assert decide(replace(found, plain=found.null)).verdict == "nothing_missing"
    # A null model that is bent only by a smaller discrepancy than it likes tells of nothing that was taken.
    found.wide = replace(found.null, fit=found.judged[0].fit)
    assert decide(found).verdict == "nothing_missing"


@pytest.mark.parametrize(
    ("blind", "evidence", "named"),
    [
        pytest.param(False, 250.0, True, id="a cell measured what pushes the frames"),
        pytest.param(False, 90.0, False, id="less evidence than an effect of a pair needs"),
        pytest.param(True, 250.0, False, id="forces that the motion asks for bend a frame, too"),
    ],
)
def test_what_the_calibration_of_a_pair_took_is_named_where_its_forces_are_measured(
    blind: bool, evidence: float, named: bool
) -> None:
    """An added mass that stiffness, masses and the discrepancy imitate down to the noise, far beyond their priors."""
    model, usual = bench()
    far = np.array([parameter.kind in STRUCTURE for parameter in model.parameters]) * model.std
    tried = (Tried((MASS,), evidence, 1.0),)
    found = findings(Problem(1.004, tried, ""), DATA["quiet"])
    found.pair = SimpleNamespace(blind=blind, second=None, contact_claimed=False)  # type: ignore[assignment]
    for one, shift in ((found.null, 7.0), (found.judged[0], 0.0)):
        fit: Any = one.fit
        fit.filtered = cast(Filtered, replace(usual, values=shift * far))
    decision = decide(found)
    assert decision.named == named
    assert not named or decision.judged.effects == (tried[0].effects[0](),)


@pytest.mark.parametrize(
    ("leads", "named"),
    [("appendage", 1), ("sensor_offset", 1), ("added_mass", 0)],
    ids=["what every frame has a little of", "a sensor's fault", "another effect of the frame"],
)
def test_what_leads_and_takes_nothing_out_of_the_motion_hides_no_effect_that_does(
    leads: str, named: int
) -> None:
    tried = (Tried((partial(effect, leads),), 6000.0, 6.0), Tried((CUBIC,), 5000.0, 1.0))
    decision = decide(findings(Problem(6.0, tried, ""), DATA["quiet"]))
    assert decision.named == bool(named)
    assert decision.judged.effects[0] == tried[named].effects[0]()


@pytest.mark.parametrize(
    ("leads", "verdict"),
    [("sensor_offset", "effect_named"), ("added_mass", "nothing_missing")],
    ids=["a sensor's fault", "another effect of the frame"],
)
def test_a_sensors_fault_that_is_too_small_does_not_hide_what_the_calibration_took(
    leads: str, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    allow(monkeypatch, 0.05)
    model, usual = bench()
    monkeypatch.setattr(objections, "nearest_frame", lambda *_: 0.0 * model.std)
    far = np.array([parameter.kind in STRUCTURE for parameter in model.parameters]) * model.std
    tried = (Tried((partial(effect, leads),), 80.0, 1.2), Tried((partial(effect, "p_delta"),), 60.0, 1.19))
    found = findings(Problem(1.2, tried, verdict), DATA["quiet"])
    for one, shift in ((found.null, 4.0), (found.judged[0], 4.0), (found.judged[1], 0.0)):
        fit: Any = one.fit
        fit.filtered = cast(Filtered, replace(usual, values=shift * far))
    decision = decide(found)
    assert decision.verdict == verdict
    assert [one.name for one in decision.judged.effects] == (["p_delta"] if verdict == "effect_named" else [])


@pytest.mark.parametrize(("second", "errors", "both"), [
    ("sensor_offset", 0.4, True), ("sensor_offset", 0.6, False), ("added_mass", 0.6, False),
    ("joint_flexibility", 0.6, True),
])  # fmt: skip
def test_a_size_that_may_as_well_be_none_is_no_second_effect(second: str, errors: float, both: bool) -> None:
    """Between windows it varies by as much as it is; a stiffness that is only positive is never none."""
    tried = (
        Tried((CUBIC,), 5000.0, 3.0),
        Tried((CUBIC, partial(effect, second)), 6000.0, 1.0, between=errors),
    )
    decision = decide(findings(Problem(6.0, tried, ""), DATA["quiet"]))
    assert len(decision.judged.effects) == (2 if both else 1)


@pytest.mark.parametrize(("gained", "whatever_acts", "both"), [
    (5000.0, 500.0, True), (5000.0, 59.0, False),
    # What the law gets wrong may hide an effect as well as pass for one; no first effect has less evidence.
    (58.0, 500.0, True), (3.0, 500.0, False),
])  # fmt: skip
def test_a_second_effect_is_named_only_if_its_evidence_stands_whatever_force_acts(
    gained: float, whatever_acts: float, both: bool
) -> None:
    tried = (Tried((CUBIC, MASS), 4000.0 + gained, 1.9), Tried((CUBIC,), 4000.0, 2.0))
    found = findings(Problem(6.0, tried, ""), DATA["quiet"])
    double, single = found.judged
    asked = tuple((one.fit.effects, one.fit.log_posterior) for one in (single, double))
    found.beside_latent_force[asked] = BesideLatentForce(whatever_acts)
    assert decide(found).judged is (double if both else single)
