"""The conclusions of section 8.1 of the thesis on the gap between two frames: heights, combination rules, near field."""

from __future__ import annotations

import pandas as pd

from pounding.experiments.studies.chapter_8_tables import Conclusion, Printed, Runs, said


def on_separation(printed: Printed, runs: Runs | None) -> list[Conclusion]:
    """Return the conclusions on the gap with their tests and verdicts, see `chapter_8_conclusions.conclusions`.

    Args:
        printed: What follows from the printed tables.
        runs: What follows from our model; None leaves its figures out.
    """
    each = (
        _one_height,
        _taller_height,
        _clause_of_the_code,
        _absolute_sum,
        _square_root,
        _close_frequencies,
        _near_and_far_field,
        _equal_heights,
    )
    return [one(printed, runs) for one in each]


def _one_height(printed: Printed, runs: Runs | None) -> Conclusion:
    heights = printed.height_rule
    return Conclusion(
        "8.1, 1",
        "1 % of the lower height (AS 1170.4) is inadequate; 1 % of the taller is inadequate in the near field",
        "Table 4.2: measured gaps against 1 % of heights; our required gaps",
        f"covered: lower height {heights.loc['lower', 'far'] + heights.loc['lower', 'near']} of 20, taller height in "
        f"the near field {heights.loc['taller', 'near']} of 10 (15A beside 15B under Kobe)",
        said(
            runs,
            lambda one: f"{_rule(one, '1 % of the lower height')}; {_rule(one, '1 % of the taller height')}",
        ),
        "pounding study chapter-4",
        "confirmed",
    )


def _rule(runs: Runs, name: str) -> str:
    row = runs.rules.loc[name]
    return f"{name}: safe in {row['safe']:.0%} of 20, error {row['error']:.0%}"


def _taller_height(printed: Printed, _runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 2",
        "1 % of the taller height is adequate in the far field",
        "Table 4.2: measured gaps",
        f"covered: {printed.height_rule.loc['taller', 'far']} of 10",
        "",
        "",
        "contradicted",
    )


def _clause_of_the_code(printed: Printed, _runs: Runs | None) -> Conclusion:
    heights = printed.height_rule
    return Conclusion(
        "section 4.3.3",
        "The gap that AS 1170.4 asks for is 1 % of one of the two heights",
        "the clause is a setback of each building from the boundary: Table 4.2 against 1 % of both heights together",
        f"covered: {heights.loc['summed', 'far']} of 10 in the far field, {heights.loc['summed', 'near']} of 10 in the "
        f"near field, least {heights.loc['summed', 'least']:.2f} of the gap",
        "",
        "",
        "contradicted",
    )


def _absolute_sum(printed: Printed, runs: Runs | None) -> Conclusion:
    rules = printed.rules
    return Conclusion(
        "8.1, 3",
        "ABS is the most reliable rule, and tends to overestimate",
        "Table 4.3; our peaks and gaps",
        f"safe in {rules.loc[('abs', 'all'), 'safe']} of 20, the other three under 15 % short; up to "
        f"{rules.loc[('abs', 'all'), 'largest']:.1f} times the gap",
        said(runs, lambda one: _rule(one, "ABS")),
        "pounding study chapter-4",
        "confirmed",
    )


def _square_root(printed: Printed, runs: Runs | None) -> Conclusion:
    rules = printed.rules
    return Conclusion(
        "8.1, 4",
        "SRSS is truer than ABS, and overestimates at times",
        "Table 4.3; our peaks and gaps",
        f"mean error {rules.loc[('srss', 'all'), 'error']:.0%} (ABS {rules.loc[('abs', 'all'), 'error']:.0%}); it "
        f"overestimates in {rules.loc[('srss', 'all'), 'safe']} of 20 and is unsafe in the others",
        said(runs, lambda one: _rule(one, "SRSS")),
        "pounding study chapter-4",
        "confirmed in part",
    )


def _close_frequencies(printed: Printed, runs: Runs | None) -> Conclusion:
    rules = printed.rules
    return Conclusion(
        "8.1, 5",
        "SRSS is conservative when the frequencies are close, and reasonably accurate when they differ",
        "Table 4.3: pairs of equal height (frequencies 1 to 6 % apart) and the others; our frames",
        f"close: safe in {rules.loc[('srss', 'equal heights'), 'safe']} of 8, least "
        f"{rules.loc[('srss', 'equal heights'), 'least']:.2f}; different: safe in "
        f"{rules.loc[('srss', 'unequal'), 'safe']} of 12, least {rules.loc[('srss', 'unequal'), 'least']:.2f}, error "
        f"{rules.loc[('srss', 'unequal'), 'error']:.0%}",
        said(runs, _beside_itself),
        "pounding study chapter-8",
        "contradicted",
    )


def _beside_itself(runs: Runs) -> str:
    found = runs.srss
    near, middle, far = (
        found.loc[[1.01, 1.02]].sum(),
        found.loc[[1.05, 1.1]].sum(),
        found.loc[[1.2, 1.5]].sum(),
    )
    return (
        "a frame beside itself at another frequency, SRSS is safe: 1 to 2 % apart "
        f"{near['safe']:.0f} of {near['cases']:.0f}, 5 to 10 % {middle['safe']:.0f} of {middle['cases']:.0f} (least "
        f"{found.loc[[1.05, 1.1], 'least'].min():.2f}), 20 to 50 % {far['safe']:.0f} of {far['cases']:.0f}"
    )


def _near_and_far_field(printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 6",
        "Near-field and far-field earthquakes ask for very different gaps",
        "Table 4.2: mean gaps, and over the record's peak; our closing gaps",
        _per_field(printed.by_field),
        said(runs, lambda one: _per_field(one.by_field)),
        "pounding study chapter-4",
        "confirmed in part",
    )


def _per_field(table: pd.DataFrame) -> str:
    mean, per_g = table["gap_mm"], table["gap_mm_per_g"]
    return (
        f"mean gap {mean['far']:.1f} mm far, {mean['near']:.1f} mm near; "
        f"over the peak {per_g['far']:.0f} and {per_g['near']:.0f} mm/g"
    )


def _equal_heights(printed: Printed, _runs: Runs | None) -> Conclusion:
    share = printed.share_of_abs
    return Conclusion(
        "section 4.3.2",
        "Gaps of frames of equal height differ from those of unequal height",
        "Tables 4.2 and 4.3: measured gap over the sum of both peaks",
        f"mean share of ABS {share['equal']:.2f} for equal heights, {share['unequal']:.2f} for the others",
        "",
        "",
        "confirmed",
    )
