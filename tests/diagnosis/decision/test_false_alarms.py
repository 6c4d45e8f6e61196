"""What an effect needs and what remains, by nulls: those of the package, and those of one's own rig."""

from __future__ import annotations

import csv
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from pounding.diagnosis.decision.confidence import Features
from pounding.diagnosis.decision.false_alarms import (
    FILE,
    of_nulls,
    p_value,
    remains,
    stored,
    thresholds,
)
from pounding.diagnosis.decision.measures import remaining
from pounding.diagnosis.decision.nulls import Shown
from pounding.diagnosis.decision.rig_calibration import Outcome, false_alarms
from pounding.diagnosis.decision.verdict import decide
from pounding.diagnosis.inference.discrepancy import SCALES
from pounding.diagnosis.inference.findings import Findings
from pounding.diagnosis.settings import SETTINGS
from tests.diagnosis.decision.problems import CUBIC, DATA, Problem, Tried, findings


def alone() -> Findings:
    nothing: Any = None
    return Findings(nothing, nothing, nothing, nothing, (0,), (1,))


def rows() -> list[dict[str, str]]:
    lines = FILE.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def test_the_nulls_of_the_package_say_how_they_were_made() -> None:
    first = FILE.read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("# python -m pounding.diagnosis.benchmark.nulls ")
    assert "--seed" in first
    assert "commit" in first
    assert stored().source.startswith(f"{len(rows())} simulated nulls; python -m")
    numbers = [int(row["number"]) for row in rows()]
    assert numbers == list(range(len(numbers)))
    assert {float(row["discrepancy"]) for row in rows()} <= {float(f"{one:.5g}") for one in SCALES}


def test_few_of_the_stored_nulls_would_raise_an_alarm() -> None:
    """At most one more than expected: the tail is above what the nulls show, not below."""
    known = stored(0.2)
    named = [max(float(row["ordinary"]), float(row["absorbing"])) > known.needed for row in rows()]
    left = [known.too_much(float(row["left"])) for row in rows()]
    for alarms in (named, left):
        assert sum(alarms) <= 0.1 * len(rows()) + 1


def test_a_rarer_false_alarm_asks_for_more() -> None:
    needed = [stored(rate) for rate in (0.2, 0.05, 0.01, 0.002)]
    evidence = [one.needed for one in needed]
    assert evidence == sorted(evidence)
    assert evidence[0] < evidence[-1]
    assert thresholds(alone())[0] == thresholds(alone(), True)[0] == stored().needed
    strict = replace(alone(), false_alarms=stored(0.01))
    assert thresholds(strict)[0] > thresholds(alone())[0]
    # A misfit that is too much at the usual rate is chance at a stricter one.
    left = 0.5 * (stored(0.05).most_by_chance + stored(0.01).most_by_chance)
    assert remains(alone(), left)
    assert not remains(strict, left)


def test_what_remains_has_the_probability_of_nulls_that_leave_as_much() -> None:
    found = replace(alone(), false_alarms=of_nulls(0.05, [0.0], [1 + i / 100 for i in range(100)], "ours"))
    assert p_value(found, 1.3) == pytest.approx(0.7, abs=0.02)
    assert p_value(found, 3.0) == pytest.approx(0.0, abs=0.01)
    touching = replace(found, pair=SimpleNamespace(blind=False, contact_claimed=False))
    assert p_value(touching, 3.0) is None
    assert remains(touching, 1.2)
    assert not remains(touching, 1.1)


@pytest.mark.parametrize("data", DATA)
def test_nulls_of_one_s_own_rig_decide(data: str) -> None:
    """What is plain where nulls show nothing is none where they show as much, and what is left follows them, too."""
    found = findings(Problem(1.5, (Tried((CUBIC,), 50.0, 1.0),), ""), DATA[data])
    quiet = of_nulls(0.05, [i / 10 for i in range(20)], [1.0 + i / 1000 for i in range(20)], "")
    loud = of_nulls(0.05, [5.0 * i for i in range(20)], [1.0 + i / 10 for i in range(20)], "")
    found.false_alarms = quiet
    assert decide(found).verdict == "effect_named"
    found.false_alarms = loud
    assert not remains(found, remaining(found, found.null))
    assert decide(found).verdict == "nothing_missing"


def outcome(number: int, null: Shown | None) -> Outcome:
    return Outcome(number, "", True, Features("nothing_missing", 0.0, 0.0, 0.0, 1.0, 0), null)


def test_a_rig_s_own_nulls_count_where_there_are_enough() -> None:
    null = Shown(30.0, "table tilt", 0.1, 1.0, "p delta, 5A", 0.1, 0.0, 0.0, 1.01, 1.0)
    least = SETTINGS.calibration.least_nulls
    others = [outcome(100, None)]
    assert false_alarms(alone(), [outcome(i, null) for i in range(least - 1)] + others) is None
    strict = replace(alone(), false_alarms=stored(0.01, 70))
    known = false_alarms(strict, [outcome(i, null) for i in range(least)] + others)
    assert known is not None
    assert (known.rate, known.candidates) == (0.01, 70)
    assert known.needed == 30.0
    assert known.source.startswith(f"{least} nulls simulated on this rig")
