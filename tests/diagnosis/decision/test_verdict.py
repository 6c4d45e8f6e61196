"""The verdict by what it must do: hand-made findings, each on several kinds of data."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace
from typing import Any, cast

import msgspec
import numpy as np
import pytest

from pounding.diagnosis import Decision, Findings, decide
from pounding.diagnosis.decision.false_alarms import of_nulls
from pounding.diagnosis.decision.measures import (
    explained,
    less_certain,
    model_error,
    remaining,
    signal_to_noise,
)
from pounding.diagnosis.effects.candidates import candidates
from pounding.diagnosis.effects.catalogue import Effect
from pounding.diagnosis.inference.filtering import Filtered, run_filter
from pounding.diagnosis.inference.findings import Judged
from pounding.diagnosis.inference.sight import Sight
from pounding.diagnosis.inference.starting import starting_noise
from pounding.diagnosis.model.model import Model
from tests.diagnosis.models import measured

CHANNELS = 5
NULLS = of_nulls(0.05, [30.0] * 100, [1.15] * 100, "nulls that are all alike")
"""An effect needs an ln Bayes factor of 30, and something remains beyond 1.15 noise floors."""


@cache
def bench() -> tuple[Model, Filtered]:
    """Return a model that leaves nothing of a real frame, and a filter with which nothing in its data is odd."""
    model = measured()
    model.prior = msgspec.structs.replace(model.prior, model_error=1e-6)
    return model, run_filter(model, np.zeros(len(model.std)), starting_noise(model, (0, 1), 0.01), (0, 1))


@cache
def effect(name: str, place: int | None = None) -> Effect:
    """Return an effect of the catalogue, or a rival, at a storey or floor of the bench."""
    return next(
        one for one in candidates(bench()[0]) if one.name == name and place in (None, one.storey, one.floor)
    )


@cache
def rival() -> Effect:
    """Return something that is outside the catalogue."""
    return next(one for one in candidates(bench()[0]) if one.rival)


@dataclass(frozen=True)
class Data:
    """What was measured: the noise as a share of each channel, whether a run was held out, channels that were dead."""

    noise: float
    held_out: bool = True
    dead: tuple[int, ...] = ()

    def misfits(self, over: float) -> np.ndarray:
        """Return misfits that are so many times the noise floor, shape (2, channels)."""
        found = np.full((2, CHANNELS), over * self.noise)
        found[:, list(self.dead)] = np.nan
        if not self.held_out:
            found[1] = np.nan
        return found


@dataclass(frozen=True)
class Tried:
    """A candidate: its effects, its ln Bayes factor, and how many times the noise floor its misfit is."""

    effects: tuple[Callable[[], Effect], ...]
    ln_bayes: float
    over: float


@dataclass(frozen=True)
class Problem:
    """Findings, and what must be said of them.

    Attributes:
        null: Misfit of the baseline model over the noise floor.
        tried: The candidates.
        verdict: The verdict.
        behind: The number of the candidate behind it, None for the baseline model.
        alike: The numbers of candidates that cannot be told from it.
    """

    null: float
    tried: tuple[Tried, ...]
    verdict: str
    behind: int | None = None
    alike: tuple[int, ...] = ()


def of(name: str, place: int | None = None) -> Callable[[], Effect]:
    return lambda: effect(name, place)


CUBIC, FRICTION, MASS = of("cubic_stiffness", 2), of("coulomb_friction", 2), of("added_mass", 3)
ALL = of("all_cubic_stiffness")
NEXT = of("cubic_stiffness", 3)
OTHER_FLOOR = of("coulomb_friction", 3)

PROBLEMS = {
    "nothing was tried and nothing is left": Problem(1.0, (), "nothing_missing"),
    "a candidate with little evidence": Problem(1.05, (Tried((CUBIC,), 5.0, 1.0),), "nothing_missing"),
    "much evidence that takes nothing out of the noise": Problem(
        1.02, (Tried((CUBIC,), 500.0, 1.02),), "nothing_missing"
    ),
    "one effect explains everything": Problem(
        4.0, (Tried((CUBIC,), 5000.0, 1.0), Tried((FRICTION,), 400.0, 3.0)), "effect_named", 0
    ),
    "two effects that the data cannot tell apart": Problem(
        4.0, (Tried((CUBIC,), 5000.0, 1.0), Tried((FRICTION,), 4997.0, 1.0)), "effect_class", 0, (1,)
    ),
    "much is left and nothing was tried": Problem(3.0, (), "unknown_effect"),
    "much is left that no candidate touches": Problem(
        3.0, (Tried((CUBIC,), 5.0, 2.99),), "unknown_effect", 0
    ),
    "the best candidate leaves the larger part": Problem(
        6.0, (Tried((CUBIC,), 5000.0, 4.0),), "unknown_effect", 0
    ),
    "something outside the catalogue is clearly better": Problem(
        4.0, (Tried((rival,), 5000.0, 1.0), Tried((CUBIC,), 4500.0, 1.1)), "unknown_effect", 0
    ),
    "something outside the catalogue is likelier and explains no more": Problem(
        4.0, (Tried((rival,), 5000.0, 1.9), Tried((CUBIC,), 4500.0, 2.0)), "effect_named", 1
    ),
    "a law that is not quite ours, and leaves some": Problem(
        6.0, (Tried((CUBIC,), 5000.0, 2.0),), "effect_named", 0
    ),
    "something outside the catalogue is hardly better": Problem(
        4.0, (Tried((rival,), 5002.0, 1.0), Tried((CUBIC,), 5000.0, 1.0)), "effect_named", 1
    ),
    "two effects at once, in two places": Problem(
        6.0, (Tried((CUBIC, MASS), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "effect_named", 0
    ),
    "a second effect that adds little": Problem(
        4.0, (Tried((CUBIC, MASS), 5020.0, 1.0), Tried((CUBIC,), 5000.0, 1.0)), "effect_named", 1
    ),
    "a law in all storeys and the same in one, which explains little of what is left": Problem(
        9.0, (Tried((ALL, CUBIC), 9000.0, 2.0), Tried((ALL,), 4000.0, 3.0)), "effect_named", 1
    ),
    "a law in all storeys and the same in one, which explains nearly all that is left": Problem(
        9.0, (Tried((ALL, CUBIC), 9000.0, 1.0), Tried((ALL,), 4000.0, 4.0)), "effect_named", 0
    ),
    "one law in two storeys that meet": Problem(
        6.0, (Tried((CUBIC, NEXT), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "unknown_effect", 0
    ),
    "a second law in the same storey that explains what the first leaves": Problem(
        6.0, (Tried((CUBIC, FRICTION), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "effect_named", 0
    ),
    "a second law in the same storey that only mends the first": Problem(
        30.0, (Tried((CUBIC, FRICTION), 9000.0, 1.8), Tried((CUBIC,), 4000.0, 2.0)), "effect_named", 1
    ),
    "two laws in two storeys that meet": Problem(
        6.0, (Tried((CUBIC, OTHER_FLOOR), 9000.0, 1.0), Tried((CUBIC,), 4000.0, 4.0)), "effect_named", 0
    ),
}
DATA = {
    "quiet": Data(0.01),
    "noisy": Data(0.3),
    "a single run": Data(0.02, held_out=False),
    "a dead channel": Data(0.02, dead=(1,)),
}


def judged(data: Data, tried: Tried, filtered: Filtered) -> Judged:
    effects = tuple(one() for one in tried.effects)
    values = [np.ones(len(one.quantities)) for one in effects]
    fit: Any = SimpleNamespace(effects=effects, values=values, std=values, filtered=filtered)
    misfits = data.misfits(tried.over)
    return Judged(fit, tried.ln_bayes, (tried.over * data.noise,) * 2, misfits)


def findings(problem: Problem, data: Data, filtered: Filtered | None = None) -> Findings:
    """Return findings as a search would have made them."""
    model, usual = bench()
    null = judged(data, Tried((), 0.0, problem.null), filtered or usual)
    found = [judged(data, one, filtered or usual) for one in problem.tried]
    nothing: Any = None
    return Findings(
        model, null, nothing, nothing, (0,), (1,) if data.held_out else (),
        sorted(found, key=lambda one: -one.ln_bayes), data.misfits(1.0), false_alarms=NULLS,
    )  # fmt: skip


def decided(problem: Problem, data: Data) -> tuple[Findings, Decision]:
    found = findings(problem, data)
    return found, decide(found)


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


def allow(monkeypatch: pytest.MonkeyPatch, model_error: float) -> None:
    """Let the model of the bench leave that share of the motion."""
    model, _ = bench()
    prior = msgspec.structs.replace(model.prior, model_error=model_error)
    monkeypatch.setattr(model, "prior", prior)


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


@pytest.mark.parametrize("second", [ALL, rival], ids=["in all storeys", "a rival"])
@pytest.mark.parametrize(("left", "effects"), [(1.0, 2), (1.04, 2), (1.1, 1)])
def test_what_every_frame_has_is_named_beside_an_effect_only_where_it_stands_out(
    second: Any, left: float, effects: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first leaves 1.7 % of the motion, the second nothing, 0.3 and 0.5 %."""
    allow(monkeypatch, 0.05)
    tried = (Tried((MASS, second), 9000.0, left), Tried((MASS,), 4000.0, 2.0))
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
    assert "the model also has a little all cubic stiffness" in decision.model_checks[-1]


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
        (0.3, 1.0, "nothing_missing"),
    ],
    ids=["all of it", "half of it", "no model error", "less than a model may leave"],
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
        "pounding.diagnosis.decision.verdict.stray_tones", lambda *given: ["a tone of 8.4 Hz"]
    )
    left = model_error(found, found.judged[0] if tried else found.null)
    for allowed, verdict in zip((0.99 * left, 1.01 * left), verdicts, strict=True):
        allow(monkeypatch, allowed)
        decision = decide(found)
        assert decision.verdict == verdict
        assert decision.model_checks == ("a tone of 8.4 Hz",)


@pytest.mark.parametrize(("nearest", "verdict"), [(0.0, "effect_named"), (9.0, "unknown_effect")])
def test_another_frame_is_one_that_no_frame_near_the_baseline_moves_like(
    nearest: float, verdict: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The likeliest stiffness and mass are nine standard deviations off."""
    model, usual = bench()
    tried = Tried((CUBIC,), 5000.0, 2.0)
    found = findings(Problem(6.0, (tried,), ""), DATA["quiet"], replace(usual, values=9.0 * model.std))
    monkeypatch.setattr(Sight, "nearest", lambda sight, runs: nearest * sight.model.std)
    assert decide(found).verdict == verdict


@pytest.mark.parametrize("data", DATA)
def test_what_remains_makes_sizes_less_certain_as_one_sample_a_swing(data: str) -> None:
    found, _ = decided(PROBLEMS["one effect explains everything"], DATA[data])
    model, best = found.model, found.judged[0]
    assert less_certain(found, best) == 1.0
    swing = 1 / (model.structure.lowest_hz * model.observed.runs[0].step_s)
    assert less_certain(found, found.null) == pytest.approx(np.sqrt(1 + (4.0**2 - 1.15**2) * swing))


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
