"""A report in sentences: the verdict, how sure it is, what comes next to it, and what would tell more."""

from __future__ import annotations

from pathlib import Path

import pytest
from msgspec import UNSET, structs

from pounding.diagnosis.case.case import Case, Channel
from pounding.diagnosis.decision.claims import Place, candidate, claim, parameter
from pounding.diagnosis.decision.decision import Verdict
from pounding.diagnosis.report.report import (
    ChannelMisfit,
    Threshold,
    Thresholds,
)
from pounding.diagnosis.report.report_text import (
    against_the_next,
    beside_the_verdict,
    misread,
    next_steps,
    percent,
    sentence,
    together,
)
from tests.diagnosis.report.reports import DAMPING, FRICTION, LAW, of_a_pair, of_modal_data, of_runs


def test_the_sentence_says_what_where_how_large_and_how_sure() -> None:
    assert sentence(of_runs()) == (
        "Missing is coulomb friction in storey 3 of 5B (friction force 12.1 ± 0.4 N), or damping change in storey 3 of 5B, "
        "which this data cannot tell from it; the misfit on run3.csv, which was not used, goes from 35 % to 2.4 %, "
        "where noise alone leaves 2 % (97 % sure)."
    )
    nothing = structs.replace(of_runs(), verdict="nothing_missing", effects=(), confidence=0.999)
    assert sentence(nothing).startswith(
        "Nothing is missing that this data could show: the misfit on run3.csv"
    )
    assert sentence(nothing).endswith("(more than 99 % sure).")
    unknown = structs.replace(of_runs(), verdict="unknown_effect")
    assert "nothing in the catalogue fits it" in sentence(unknown)
    alone = structs.replace(of_runs(), misfit=structs.replace(of_runs().misfit, held_out=None))
    assert "the misfit on the runs used goes from 31 % to 2.1 %" in sentence(alone)
    assert "(law hertz, stiffness 1e+09 N/m^1.5)" in sentence(of_a_pair())
    modal = sentence(of_modal_data())
    assert "hysteresis of 5B, only in the free vibration (first mode stiffness change -0.08 ± 0.01)" in modal
    assert "predicted from the others is off by 1 % in the median instead of 6 %" in modal


def test_the_other_one_of_a_class_of_two_has_its_own_size() -> None:
    sized = candidate(DAMPING, 9.0, (parameter("damping", -7.7, 0.8, "N s/m"),))
    said = sentence(structs.replace(of_runs(), candidates=(*of_runs().candidates[:1], sized)))
    assert (
        "or damping change in storey 3 of 5B (damping -7.7 ± 0.8 N s/m), which this data cannot tell" in said
    )


def test_what_frames_gain_beside_a_contact_is_not_said_to_be_the_contacts() -> None:
    gap = claim(Place(effect="gap_offset", contact=1), [parameter("offset", -1.6, 0.01, "mm")], 900.0)
    said = sentence(structs.replace(of_runs(), verdict="effect_named", effects=(gap,)))
    assert (
        "goes from 35 % to 2.4 % by the frames' own errors in the model, where noise alone leaves 2 %" in said
    )
    one = structs.replace(of_runs().misfit.held_out, after=0.35)
    same = structs.replace(of_runs(), effects=(gap,), misfit=structs.replace(of_runs().misfit, held_out=one))
    assert "stays at 35 %, where noise alone leaves 2 %" in sentence(same)


def test_a_worst_channel_that_the_median_hides_is_told() -> None:
    bad = ChannelMisfit(channel="d5", before=1.5, after=0.05, noise_floor=0.02)
    told = structs.replace(of_runs(), channels=(*(of_runs().channels or ()), bad))
    assert "and that of channel d5 from 150 % to 5 %" in sentence(told)
    like_others = structs.replace(bad, before=0.5)
    assert "d5" not in sentence(structs.replace(of_runs(), channels=(like_others,)))


def test_how_strongly_an_effect_is_told_from_the_next_is_said_where_that_can_be_compared() -> None:
    named = structs.replace(of_runs(), verdict="effect_named")
    (effect,) = named.effects
    alone = structs.replace(named, effects=(structs.replace(effect, members=(FRICTION,)),))
    assert against_the_next(alone) == (
        "Coulomb friction in storey 3 of 5B against the next candidate, damping change in storey 3 of 5B: "
        "the evidence is decisive (ln Bayes factor 7)."
    )
    for behind, word in ((409.0, "weak"), (408.0, "strong"), (400.0, "decisive")):
        tried = (candidate(FRICTION, 412.0), candidate(DAMPING, behind))
        assert f"is {word} " in str(against_the_next(structs.replace(alone, candidates=tried)))
    ahead = (candidate(DAMPING, 424.0), candidate(FRICTION, 412.0))
    said = str(against_the_next(structs.replace(alone, candidates=ahead)))
    assert said.startswith(
        "Damping change in storey 3 of 5B has more evidence (an ln Bayes factor of 12 against"
    )
    # All that was tried is in the class, nothing is missing, or impacts were weighed beside motions.
    assert against_the_next(of_runs()) is None
    assert against_the_next(structs.replace(alone, effects=())) is None
    both = (*alone.candidates, candidate(LAW, 3.0))
    assert against_the_next(structs.replace(alone, candidates=both)) is None


def test_what_to_measure_next_is_said_without_figures_and_with_them_on_the_technical_pages() -> None:
    said = "A weight on the roof is expected to decide between friction and yielding."
    report = structs.replace(of_runs(), advice=(said,), advice_evidence=(588.4,))
    assert next_steps(report)[0] == said
    assert next_steps(report, figures=True)[0] == f"{said[:-1]} (ln Bayes factor 588)."


@pytest.mark.parametrize(
    ("effect", "unit", "change", "said"),
    [
        ("sensor_gain", "g", 8.81, "channel a2 reads as if it were in m/s^2; case.toml says g"),
        ("sensor_gain", "m/s^2", -0.898, "channel a2 reads as if it were in g; case.toml says m/s^2"),
        ("sensor_gain", "g", -2.0, "channel a2 reads minus the truth: its polarity is wrong"),
        ("sensor_gain", "g", -0.08, None),
        ("table_gain", "g", -0.898, "channel table reads as if it were in m/s^2; case.toml says g"),
        ("table_gain", "m/s^2", 8.81, "channel table reads as if it were in g; case.toml says m/s^2"),
        ("table_gain", "g", 0.05, None),
        ("sensor_delay", "g", 8.81, None),
    ],
)
def test_a_gain_that_is_another_unit_is_read_as_that(
    effect: str, unit: str, change: float, said: str | None
) -> None:
    channels = (
        Channel("table", "table_acceleration", unit, floor=0),
        Channel("a2", "absolute_acceleration", unit, "bench", 2),
    )
    case = Case("bench", Path(), (), (), channels)
    place = Place(effect=effect, channel=None if effect == "table_gain" else "a2")
    assert misread(case, claim(place, [parameter("relative_change", change, 0.01, "-")], 100.0)) == said


def test_one_late_logger_is_one_effect_on_its_channels() -> None:
    late = [
        claim(Place(effect="sensor_delay", channel=name), [parameter("delay", 3.0, 0.1, "ms")], 90.0)
        for name in ("d1", "d3")
    ]
    (shown,) = together(late)
    assert shown.words() == "sensor delay of channels d1, d3"
    other = claim(Place(effect="sensor_delay", channel="a1"), [parameter("delay", 1.0, 0.1, "ms")], 90.0)
    assert len(together([*late, other])) == 2
    assert len(together([claim(FRICTION, [], 9.0), claim(FRICTION, [], 9.0)])) == 2


def test_what_is_not_known_is_a_dash() -> None:
    assert [percent(value) for value in (None, UNSET, 0.0, 0.1234)] == ["–", "–", "0 %", "12.3 %"]


@pytest.mark.parametrize(
    ("verdict", "evidence", "refined", "said"),
    [
        ("nothing_missing", 6.4, True, True),
        ("nothing_missing", 2.9, True, False),
        ("nothing_missing", 6.4, False, False),
        ("unknown_effect", 6.4, True, False),
    ],
)
def test_what_comes_nearest_to_being_named_is_said_with_its_size(
    verdict: Verdict, evidence: float, refined: bool, said: bool
) -> None:
    """A storey that lost a fifth, and that the calibration may have lost as well, is not passed over in silence."""
    place = Place(effect="stiffness_change", frame="5B", storey=1)
    sizes = (parameter("relative_change", -0.221, 0.029, "1"),) if refined else UNSET
    absorbing = Threshold(log_evidence=7.66, share_of_noise=0.4)
    report = structs.replace(
        of_runs(),
        verdict=verdict,
        effects=(),
        candidates=(candidate(place, evidence, sizes),),
        thresholds=Thresholds(
            log_evidence=7.66, share_of_noise=0.2, absorbing=absorbing, standard_errors=3.72
        ),
    )
    sentence = (
        "Nearest to a verdict is stiffness change in storey 1 of 5B (relative change -0.221 ± 0.029): its ln Bayes factor "
        "is 6.4, and a name needs 7.66 and 20 % of some channel's noise, or more."
    )
    assert (sentence in beside_the_verdict(report)) == said
    # Where evidence is not what it lacks, the sentence says what is.
    likely = structs.replace(report, candidates=(candidate(place, 60.0, sizes),))
    lacking = any(
        "is 60, enough for a name, but it takes too little out of the motion, or its size may as well be none"
        in one
        and one.endswith("and a size 3.7 standard errors from none.")
        for one in beside_the_verdict(likely)
    )
    assert lacking == (verdict == "nothing_missing" and refined)
    # What a contact needs is said by its impacts.
    struck = structs.replace(report, candidates=(candidate(LAW, 60.0, sizes), *report.candidates))
    assert not any("Nearest" in each for each in beside_the_verdict(struck))
