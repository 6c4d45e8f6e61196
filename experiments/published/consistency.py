"""Contradictions inside published peaks and gaps, found by rules that hold for any two structures.

Two structures shake beside each other without touching; ``u`` and ``v`` are the displacements of the left and
the right one at the level where they could meet, towards the right. The gap that just keeps them apart is
``S = max(u - v)``. From the peaks alone follows, whatever the motion was:

- ``S <= max u + |min v|``, the sum that both reach only if their peaks coincide;
- ``S >= max u - max v`` and ``S >= |min v| - |min u|``, because when one is at its peak the other is no
  further.

Which side is called `max` depends on how the sensors were turned, so a measured gap contradicts the peaks
only if it does for both ways round. Sums and roots of squares that a table says it computed from the peaks
are computed again. What several independent pairs contradict in the same history is called contested.
"""

from __future__ import annotations

import math
import operator
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from pounding.experiments import published

GAP_TOLERANCE_MM = 1.0
"""Gaps were set to whole millimetres."""

RULE_TOLERANCE_MM = 0.15
"""Peaks and sums are printed to a tenth, so that the sum of two rounded peaks may be 0.1 off."""

History = tuple[str, str]
"""A frame under a record: all its floors' peaks come from one shaking."""


@dataclass(frozen=True)
class Pair:
    """Two adjacent frames under one record.

    Attributes:
        left: Frame on the left.
        right: Frame on the right.
        floor: Level at which they can meet.
        record: Ground motion.
    """

    left: str
    right: str
    floor: int
    record: str

    def __str__(self) -> str:
        return f"{self.left} beside {self.right} at floor {self.floor} under {self.record}"


@dataclass(frozen=True)
class Contradiction:
    """Two published numbers that cannot both be right.

    Attributes:
        rule: `gap too small`, `gap too large`, `abs`, `srss` or `abs against srss`.
        pair: Where.
        printed_mm: The printed gap or sum [mm].
        expected_mm: The bound it breaks, or the value computed again [mm].
        sentence: The finding in words.
    """

    rule: str
    pair: Pair
    printed_mm: float
    expected_mm: float
    sentence: str

    @property
    def histories(self) -> tuple[History, History]:
        """The two histories, one of which (or the printed gap) is wrong."""
        return (self.pair.left, self.pair.record), (self.pair.right, self.pair.record)


Peaks = Mapping[tuple[str, int, str], tuple[float, float]]
"""By frame, floor and record: largest displacement and size of the smallest, both positive [mm]."""


def published_peaks(source: str = "experiment") -> dict[tuple[str, int, str], tuple[float, float]]:
    """Return the peaks of Table 4.1 [mm], of the `experiment` or the thesis' `numerical` model."""
    wide = published.long("4.1").xs(source, level="source").unstack("side")
    return {
        (str(frame), int(floor), str(record)): (float(high), float(low))
        for (frame, floor, record), high, low in zip(wide.index, wide["max"], wide["min"], strict=True)
    }


def published_gaps(number: str, quantity: str) -> dict[Pair, float]:
    """Return one quantity of Table 4.2 or 4.3 for each pair [mm]."""
    values = published.long(number).xs(quantity, level="quantity")
    return {
        Pair(str(left), str(right), int(floor), str(record)): float(value)
        for (left, right, floor, record), value in zip(values.index, values, strict=True)
    }


def bounds_mm(left: tuple[float, float], right: tuple[float, float]) -> tuple[float, float]:
    """Return the least and the largest gap that peaks (max, min) of two structures allow [mm].

    Both ways round are allowed for: the least of the lower and the largest of the upper bounds.
    """
    ways = [(left, right), (left[::-1], right[::-1])]
    lower = min(max(0.0, a[0] - b[0], b[1] - a[1]) for a, b in ways)
    upper = max(a[0] + b[1] for a, b in ways)
    return lower, upper


def check_gaps(
    peaks: Peaks, gaps: Mapping[Pair, float], tolerance_mm: float = GAP_TOLERANCE_MM
) -> list[Contradiction]:
    """Return the gaps that the peaks make impossible; pairs without peaks are left out.

    Args:
        peaks: Printed peaks [mm].
        gaps: Printed gap of each pair [mm].
        tolerance_mm: What a gap may be off before it counts [mm].
    """
    found = []
    for pair, gap in gaps.items():
        sides = _sides(peaks, pair)
        if sides is None:
            continue
        lower, upper = bounds_mm(*sides)
        if gap < lower - tolerance_mm:
            words = f"{pair}: a gap of {gap:g} mm cannot be enough, the peaks need at least {lower:.1f} mm"
            found.append(Contradiction("gap too small", pair, gap, lower, words))
        if gap > upper + tolerance_mm:
            words = f"{pair}: a gap of {gap:g} mm cannot be closed, the peaks reach {upper:.1f} mm together"
            found.append(Contradiction("gap too large", pair, gap, upper, words))
    return found


def check_rule(
    peaks: Peaks, printed: Mapping[Pair, float], rule: str, tolerance_mm: float = RULE_TOLERANCE_MM
) -> list[Contradiction]:
    """Return the printed sums (`abs`) or roots of squares (`srss`) that do not follow from the peaks.

    Args:
        peaks: Printed peaks [mm].
        printed: Printed value of the rule for each pair [mm].
        rule: `abs` or `srss`.
        tolerance_mm: What a value may be off before it counts [mm].
    """
    rules: dict[str, Callable[[float, float], float]] = {"abs": operator.add, "srss": math.hypot}
    combine = rules[rule]
    found = []
    for pair, value in printed.items():
        sides = _sides(peaks, pair)
        if sides is None:
            continue
        again = combine(max(sides[0]), max(sides[1]))
        # The thesis drops decimals at will in long numbers: 76 is printed for 75.5, 42 for 42.1.
        allowed = max(tolerance_mm, 0.51 if float(value).is_integer() else 0.0)
        if abs(value - again) > allowed:
            words = f"{pair}: {rule.upper()} is printed as {value:g} mm, the peaks give {again:.1f} mm"
            found.append(Contradiction(rule, pair, value, again, words))
    return found


def check_rules_together(sums: Mapping[Pair, float], roots: Mapping[Pair, float]) -> list[Contradiction]:
    """Return the pairs whose printed sum and root of squares no two peaks have: root < sum / sqrt(2)."""
    found = []
    for pair, root in roots.items():
        least = (sums[pair] - RULE_TOLERANCE_MM) / math.sqrt(2)
        if root < least - 0.05 or root > sums[pair]:
            words = f"{pair}: ABS {sums[pair]:g} mm and SRSS {root:g} mm belong to no two peaks"
            found.append(Contradiction("abs against srss", pair, root, least, words))
    return found


def check_published() -> list[Contradiction]:
    """Return every contradiction among the measured numbers of Tables 4.1, 4.2 and 4.3."""
    peaks = published_peaks()
    sums, roots = published_gaps("4.3", "abs"), published_gaps("4.3", "srss")
    return [
        *check_gaps(peaks, published_gaps("4.2", "experiment")),
        *check_rule(peaks, sums, "abs"),
        *check_rule(peaks, roots, "srss"),
        *check_rules_together(sums, roots),
    ]


def contested(contradictions: Iterable[Contradiction]) -> set[History]:
    """Return the histories that are to blame: those that two or more other frames contradict.

    The history with most contradicting partners is taken out first, with every contradiction it explains;
    then the next, as long as two partners are left. A single contradicted pair blames neither side: it may as
    well be its gap.
    """
    left = list(contradictions)
    blamed: set[History] = set()
    while left:
        partners = {frozenset(item.histories) for item in left}
        counts = Counter(history for pair in partners for history in pair)
        worst, count = max(counts.items(), key=lambda item: (item[1], item[0]))
        if count < 2:
            break
        blamed.add(worst)
        left = [item for item in left if worst not in item.histories]
    return blamed


def _sides(peaks: Peaks, pair: Pair) -> tuple[tuple[float, float], tuple[float, float]] | None:
    left = peaks.get((pair.left, pair.floor, pair.record))
    right = peaks.get((pair.right, pair.floor, pair.record))
    return None if left is None or right is None else (left, right)
