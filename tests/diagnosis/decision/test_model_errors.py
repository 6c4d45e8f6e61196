"""What is an error of the model of a real frame, and what stands out from its errors."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from pounding.diagnosis import decide
from pounding.diagnosis.decision import objections
from pounding.diagnosis.decision.measures import explained, model_error
from pounding.diagnosis.decision.verdict import error_of_frame
from tests.diagnosis.decision.problems import (
    ALL,
    CUBIC,
    DATA,
    MASS,
    Data,
    Problem,
    Tried,
    allow,
    bench,
    findings,
    of,
    rival,
)

SOFTER = of("p_delta")

pytestmark = pytest.mark.usefixtures("made_up_fits")


@pytest.mark.parametrize(
    ("tried", "verdicts"),
    [
        (Tried((CUBIC,), 5000.0, 1.0), ("effect_named", "effect_named")),
        (Tried((CUBIC,), 5000.0, 1.5), ("effect_named", "effect_named")),
        (Tried((ALL,), 5000.0, 1.0), ("effect_named", "effect_named")),
        (Tried((ALL,), 5000.0, 1.2), ("effect_named", "effect_named")),
        (Tried((ALL,), 5000.0, 1.3), ("effect_named", "nothing_missing")),
        (Tried((CUBIC,), 5000.0, 3.5), ("unknown_effect", "nothing_missing")),
        (Tried((rival,), 5000.0, 1.0), ("unknown_effect", "unknown_effect")),
        (Tried((rival,), 5000.0, 1.5), ("unknown_effect", "nothing_missing")),
        (Tried((CUBIC,), 5.0, 3.9), ("unknown_effect", "nothing_missing")),
    ],
    ids=[
        "all",
        "the larger part",
        "all, in all storeys",
        "much, in all storeys",
        "less, in all storeys",
        "the smaller part",
        "all, a rival",
        "the larger part, a rival",
        "little evidence",
    ],
)
def test_what_models_of_real_frames_leave_is_no_effect_unless_that_has_a_place_or_stands_out(
    tried: Tried, verdicts: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The baseline model leaves 3.9 % of the motion beyond the noise, against less and more that it may leave."""
    found = findings(Problem(4.0, (tried,), ""), DATA["quiet"])
    assert model_error(found) == pytest.approx(0.01 * np.sqrt(15.0))
    for allowed, verdict in zip((0.038, 0.039), verdicts, strict=True):
        allow(monkeypatch, allowed)
        assert decide(found).verdict == verdict


@pytest.mark.parametrize(
    ("law", "before", "verdict"),
    [(ALL, 12.0, "nothing_missing"), (ALL, 16.0, "effect_named"), (CUBIC, 12.0, "effect_named")],
    ids=["small, in all storeys", "large, in all storeys", "small, in one storey"],
)
def test_no_model_has_errors_that_are_next_to_nothing(
    law: Any, before: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What all storeys share takes 2.4 or 3.2 % out of the motion; noise hides less than 0.5 % of other errors."""
    allow(monkeypatch, 0.05)
    found = findings(Problem(before, (Tried((law,), 5000.0, 1.0),), ""), Data(0.002))
    assert decide(found).verdict == verdict


@pytest.mark.parametrize(("before", "left", "nothing"), [(1.5, 1.1, True), (2.5, 1.6, False)])
def test_frames_have_their_errors_where_no_cell_measured_what_pushes_them_too(
    before: float, left: float, nothing: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What such forces leave is no error of a frame: more than the noise may not remain."""
    allow(monkeypatch, 0.05)
    found = findings(Problem(before, (Tried((ALL,), 5000.0, left),), ""), DATA["quiet"])
    found.pair = SimpleNamespace(blind=True, second=None, contact_claimed=True)  # type: ignore[assignment]
    assert (decide(found).verdict == "nothing_missing") is nothing


@pytest.mark.parametrize("second", [ALL, rival], ids=["in all storeys", "a rival"])
@pytest.mark.parametrize(
    ("first", "left", "effects"), [(3.5, 1.0, 2), (3.5, 1.04, 2), (3.5, 1.3, 1), (2.0, 1.0, 1)]
)
def test_what_every_frame_has_is_named_beside_an_effect_only_where_it_stands_out(
    second: Any, first: float, left: float, effects: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first leaves 3.4 or 1.7 % of the motion, the second nothing, 0.3 and 0.8 %; noise may hide 0.5 %."""
    allow(monkeypatch, 0.05)
    tried = (Tried((MASS, second), 9000.0, left), Tried((MASS,), 4000.0, first))
    found = findings(Problem(6.0, tried, ""), DATA["quiet"])
    assert len(decide(found).judged.effects) == effects


def test_an_effect_beside_an_error_of_the_frame_that_leads_is_judged_with_that_in_the_model(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    allow(monkeypatch, 0.05)
    tried = (Tried((ALL, MASS), 9000.0, 1.1), Tried((ALL,), 4000.0, 3.0), Tried((MASS,), 1000.0, 2.0))
    found = findings(Problem(6.0, tried, ""), DATA["quiet"])
    decision = decide(found)
    assert decision.verdict == "effect_named"
    assert [effect.name for effect in decision.judged.effects] == ["added_mass"]
    assert decision.judged.ln_bayes == pytest.approx(5000.0)
    assert decision.judged.fit.effects == found.judged[0].fit.effects
    assert decision.judged.beside is not None
    assert [effect.name for effect in decision.judged.beside.fit.effects] == ["all_cubic_stiffness"]


@pytest.mark.parametrize(
    ("tried", "error"),
    [
        ((Tried((ALL,), 4000.0, 3.0), Tried((MASS,), 1000.0, 3.5)), (0,)),
        ((Tried((ALL,), 4000.0, 1.0), Tried((MASS,), 1000.0, 3.5)), ()),
        ((Tried((CUBIC,), 4000.0, 3.0), Tried((ALL,), 1000.0, 3.5)), ()),
        ((Tried((MASS, ALL), 9000.0, 1.5), Tried((MASS,), 4000.0, 2.0), Tried((ALL,), 900.0, 3.5)), (2,)),
        ((Tried((MASS, ALL), 9000.0, 1.1), Tried((MASS,), 4000.0, 3.5), Tried((ALL,), 900.0, 3.6)), ()),
        ((Tried((MASS, ALL), 9000.0, 1.5), Tried((MASS,), 4000.0, 2.0)), ()),
        ((Tried((ALL,), 5.0, 3.0),), ()),
        (
            (Tried((MASS, SOFTER), 9000.0, 1.5), Tried((MASS,), 4000.0, 2.0), Tried((SOFTER,), 900.0, 3.5)),
            (2,),
        ),
        ((Tried((SOFTER,), 4000.0, 3.0), Tried((MASS,), 1000.0, 3.5)), ()),
    ],
    ids=[
        "leads",
        "stands out",
        "behind an effect",
        "beside an effect",
        "stands out beside an effect",
        "never alone",
        "little evidence",
        "softens the whole frame beside an effect",
        "softens the whole frame and leads",
    ],
)
def test_an_error_of_the_frame_is_what_it_has_a_little_of_and_leads_or_is_second(
    tried: tuple[Tried, ...], error: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    allow(monkeypatch, 0.05)
    found = findings(Problem(4.0, tried, ""), DATA["quiet"])
    expected = [one for number, one in enumerate(found.judged) if number in error]
    assert error_of_frame(found) is (expected[0] if expected else None)
    found.pair = SimpleNamespace(blind=False, second=None, contact_claimed=False)  # type: ignore[assignment]
    assert error_of_frame(found) is (expected[0] if expected else None)
    found.pair.blind = True  # type: ignore[misc, union-attr]
    assert error_of_frame(found) is None


def test_what_one_of_two_frames_lacks_is_no_measure_of_the_errors_of_the_other() -> None:
    """The left frame leaves 3 and 4 % beyond a floor of 1 %, whatever becomes of the right one, which leaves much less."""
    at = {0: np.array([True, True, False]), 1: np.array([False, False, True])}
    structure = SimpleNamespace(frames=("left", "right"), index=("left", "right").index)
    found = SimpleNamespace(
        model=SimpleNamespace(structure=structure, at_frame=at.__getitem__),
        floor=np.full((2, 3), 0.01),
    )
    beyond = np.array([[0.03, 0.03, 0.002], [0.04, 0.04, 0.004]])
    left = SimpleNamespace(channel_misfit=np.hypot(beyond, 0.01))
    one, other = (model_error(found, left, name) for name in ("left", "right"))  # type: ignore[arg-type]
    assert one == pytest.approx(0.035)
    assert other == pytest.approx(0.003)
    assert model_error(found, left) == pytest.approx(one)  # type: ignore[arg-type]


def test_an_effect_has_to_explain_what_its_own_frame_lacks() -> None:
    """Held out, the left one leaves 4 floors, then 1; the right one 2, and 3 by other parameters of its own."""
    at = {0: np.array([True, True, False]), 1: np.array([False, False, True])}
    structure = SimpleNamespace(frames=("left", "right"), index=("left", "right").index)
    model = SimpleNamespace(
        structure=structure,
        at_frame=at.__getitem__,
        observed=SimpleNamespace(names=("a", "b", "c"), slower=np.ones(3)),
    )
    judged = {
        name: SimpleNamespace(
            effects=tuple(SimpleNamespace(frame=frame, channel=None) for frame in frames),
            channel_misfit=np.array([[9.0, 9.0, 9.0], misfits]),
        )
        for name, frames, misfits in (
            ("null", (), [4.0, 4.0, 2.0]),
            ("left", ("left",), [1.0, 1.0, 3.0]),
            ("right", ("right",), [4.0, 4.0, 1.0]),
            ("both", ("left", "right"), [1.0, 1.0, 2.0]),
        )
    }
    found = SimpleNamespace(model=model, null=judged["null"], held_out=(1,), floor=np.ones((2, 3)))
    share = {name: explained(found, one, 1.0) for name, one in judged.items()}  # type: ignore[arg-type]
    assert share["null"] == 0.0
    assert share["left"] == share["right"] == 1.0
    assert share["both"] == pytest.approx(1.0 - np.sqrt(3.0 / 33.0))
    beside = explained(found, judged["left"], 1.0, judged["right"])  # type: ignore[arg-type]
    assert beside == pytest.approx(1.0 - np.sqrt(8.0 / 33.0))


def test_what_is_found_beside_an_error_of_the_frame_is_about_a_null_model_that_has_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    allow(monkeypatch, 0.05)
    tried = (Tried((ALL, MASS), 9000.0, 1.1), Tried((ALL,), 4000.0, 3.0), Tried((MASS,), 1000.0, 2.0))
    found = findings(Problem(6.0, tried, ""), DATA["quiet"])
    error = found.judged[1]
    beside = replace(found.judged[0], ln_bayes=5000.0, beside=error)
    about = replace(found, null=replace(error, ln_bayes=0.0, beside=error), judged=[beside])
    assert about.null.effects == ()
    decision = decide(about)
    assert decision.judged is beside
    assert [effect.name for effect in decision.judged.effects] == ["added_mass"]
    assert error_of_frame(about) is None
    nothing = decide(replace(about, judged=[]))
    assert nothing.verdict == "nothing_missing"


@pytest.mark.parametrize(("left", "verdict"), [(2.8, "effect_named"), (3.0, "nothing_missing")])
def test_an_effect_is_one_of_the_errors_where_it_takes_less_than_it_leaves(
    left: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside an error that leaves 4 noise floors it takes 2.86 and leaves 2.55, or takes 2.65 and leaves 2.77."""
    allow(monkeypatch, 0.05)
    error = of("torsional_eccentricity")
    tried = (Tried((error, CUBIC), 9000.0, left), Tried((error,), 4000.0, 4.0), Tried((CUBIC,), 1000.0, 4.5))
    assert decide(findings(Problem(6.0, tried, ""), DATA["quiet"])).verdict == verdict


@pytest.mark.parametrize(
    ("allowed", "left", "verdict"),
    [
        (0.05, 1.0, "effect_named"),
        (0.05, 12.0, "unknown_effect"),
        (1e-6, 1.0, "effect_named"),
        (0.3, 1.0, "effect_named"),
        (0.3, 12.0, "effect_named"),
    ],
    ids=["all of it", "half of it", "no model error", "an error may be larger", "half beside such an error"],
)
def test_a_sensor_need_not_explain_what_the_model_leaves_in_other_channels(
    allowed: float, left: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every channel has 6 % of model error over a noise of 1 %, and one reads 20 % too much."""
    allow(monkeypatch, allowed)
    gain = of("sensor_gain")
    found = findings(Problem(6.0, (Tried((gain,), 9000.0, 6.0),), ""), DATA["quiet"])
    channel = bench()[0].observed.names.index(gain().channel)
    found.null.channel_misfit[:, channel] = 0.2
    found.judged[0].channel_misfit[:, channel] = 0.01 * np.hypot(left, 6.0)
    assert decide(found).verdict == verdict


@pytest.mark.parametrize(
    ("before", "left", "after", "verdict"),
    [
        pytest.param(1.5, 2.0, 1.45, "effect_named", id="nothing to be seen in weak shaking"),
        pytest.param(1.5, 20.0, 1.45, "unknown_effect", id="the smaller part in strong shaking"),
        pytest.param(1.5, 2.0, 8.0, "unknown_effect", id="much brought into weak shaking"),
        pytest.param(8.0, 2.0, 7.9, "effect_named", id="hardly anything done in weak shaking"),
    ],
)
def test_shaking_too_weak_for_an_effect_says_nothing_of_it(
    before: float, left: float, after: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What yields in the strong runs leaves 30 % of their motion; in the held-out run it does what it takes out of it."""
    allow(monkeypatch, 0.05)
    found = findings(Problem(30.0, (Tried((CUBIC,), 5000.0, left),), ""), DATA["quiet"])
    found.null.channel_misfit[1] = 0.01 * before
    found.judged[0].channel_misfit[1] = 0.01 * after
    assert decide(found).verdict == verdict


@pytest.mark.parametrize(
    ("tried", "verdicts"),
    [
        ((), ("unknown_effect", "nothing_missing")),
        ((Tried((CUBIC,), 5000.0, 1.5),), ("unknown_effect", "effect_named")),
    ],
    ids=["nothing was tried", "the larger part"],
)
def test_a_tone_objects_where_more_is_left_than_a_model_of_a_real_frame_may_leave(
    tried: tuple[Tried, ...], verdicts: tuple[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A part of a real frame that sways by itself is an error of its model; it is said, and it decides nothing."""
    found = findings(Problem(4.0, tried, ""), DATA["quiet"])
    monkeypatch.setattr(
        "pounding.diagnosis.decision.objections.stray_tones", lambda *given: ["a tone of 8.4 Hz"]
    )
    left = model_error(found, found.judged[0] if tried else found.null)
    for allowed, verdict in zip((0.99 * left, 1.01 * left), verdicts, strict=True):
        allow(monkeypatch, allowed)
        decision = decide(found)
        assert decision.verdict == verdict
        assert decision.model_checks == ("a tone of 8.4 Hz",)


@pytest.mark.parametrize(("blind", "objects"), [(False, True), (True, False)])
def test_a_tone_of_frames_whose_forces_are_found_from_the_motion_is_said_and_decides_nothing(
    blind: bool, objects: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What such forces get wrong comes again with every touch."""
    found = findings(Problem(4.0, (), ""), DATA["quiet"])
    found.pair = SimpleNamespace(blind=blind, second=None, contact_claimed=False)  # type: ignore[assignment]
    allow(monkeypatch, 0.0)
    monkeypatch.setattr(objections, "stray_tones", lambda *given: ["a tone of 5.3 Hz"])
    assert objections.against_the_model(found, found.null) == (objects, ("a tone of 5.3 Hz",))


@pytest.mark.parametrize(("nearest", "verdict"), [(0.0, "effect_named"), (9.0, "unknown_effect")])
def test_another_frame_is_one_that_no_frame_near_the_baseline_moves_like(
    nearest: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The likeliest stiffness and mass are nine standard deviations off."""
    model, usual = bench()
    tried = Tried((CUBIC,), 5000.0, 2.0)
    found = findings(Problem(6.0, (tried,), ""), DATA["quiet"], replace(usual, values=9.0 * model.std))
    monkeypatch.setattr(objections, "nearest_frame", lambda found, _: nearest * found.model.std)
    assert decide(found).verdict == verdict
