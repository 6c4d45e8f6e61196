"""The conclusions of section 8.1 of the thesis, each with its test, the figures of the test, and a verdict."""

from __future__ import annotations

from collections.abc import Callable

import pandas as pd

from pounding.experiments.separation.chapter_7 import experience
from pounding.experiments.studies.chapter_8_tables import Conclusion, Printed, Runs

RECOMMENDED = ("7.13", "7.7", "7.14")
"""Model-scale equations behind those that section 7.6 recommends, one a class."""


def conclusions(printed: Printed, runs: Runs | None) -> list[Conclusion]:
    """Return every conclusion with its test and verdict.

    Args:
        printed: What follows from the printed tables.
        runs: What follows from our model; None leaves its figures out.
    """
    return [
        *_separation(printed, runs),
        *_collisions(runs),
        *_laws(printed, runs),
        *_equations(printed, runs),
    ]


def _said(runs: Runs | None, words: Callable[[Runs], str]) -> str:
    return "" if runs is None else words(runs)


def _separation(printed: Printed, runs: Runs | None) -> list[Conclusion]:
    heights, rules, field = printed.height_rule, printed.rules, printed.by_field
    share = printed.share_of_abs

    def rule(one: Runs, name: str) -> str:
        row = one.rules.loc[name]
        return f"{name}: safe in {row['safe']:.0%} of 20, error {row['error']:.0%}"

    def per_field(table: pd.DataFrame) -> str:
        mean, per_g = table["gap_mm"], table["gap_mm_per_g"]
        return (
            f"mean gap {mean['far']:.1f} mm far, {mean['near']:.1f} mm near; "
            f"over the peak {per_g['far']:.0f} and {per_g['near']:.0f} mm/g"
        )

    def close(one: Runs) -> str:
        found = one.srss
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

    return [
        Conclusion(
            "8.1, 1",
            "1 % of the lower height (AS 1170.4) is inadequate; 1 % of the taller is inadequate in the near field",
            "Table 4.2: measured gaps against 1 % of heights; our required gaps",
            f"covered: lower height {heights.loc['lower', 'far'] + heights.loc['lower', 'near']} of 20, taller height in "
            f"the near field {heights.loc['taller', 'near']} of 10 (15A beside 15B under Kobe)",
            _said(
                runs,
                lambda one: (
                    f"{rule(one, '1 % of the lower height')}; {rule(one, '1 % of the taller height')}"
                ),
            ),
            "pounding study chapter-4",
            "confirmed",
        ),
        Conclusion(
            "8.1, 2",
            "1 % of the taller height is adequate in the far field",
            "Table 4.2: measured gaps",
            f"covered: {heights.loc['taller', 'far']} of 10",
            "",
            "",
            "contradicted",
        ),
        Conclusion(
            "section 4.3.3",
            "The gap that AS 1170.4 asks for is 1 % of one of the two heights",
            "the clause is a setback of each building from the boundary: Table 4.2 against 1 % of both heights together",
            f"covered: {heights.loc['summed', 'far']} of 10 in the far field, {heights.loc['summed', 'near']} of 10 in the "
            f"near field, least {heights.loc['summed', 'least']:.2f} of the gap",
            "",
            "",
            "contradicted",
        ),
        Conclusion(
            "8.1, 3",
            "ABS is the most reliable rule, and tends to overestimate",
            "Table 4.3; our peaks and gaps",
            f"safe in {rules.loc[('abs', 'all'), 'safe']} of 20, the other three under 15 % short; up to "
            f"{rules.loc[('abs', 'all'), 'largest']:.1f} times the gap",
            _said(runs, lambda one: rule(one, "ABS")),
            "pounding study chapter-4",
            "confirmed",
        ),
        Conclusion(
            "8.1, 4",
            "SRSS is truer than ABS, and overestimates at times",
            "Table 4.3; our peaks and gaps",
            f"mean error {rules.loc[('srss', 'all'), 'error']:.0%} (ABS {rules.loc[('abs', 'all'), 'error']:.0%}); it "
            f"overestimates in {rules.loc[('srss', 'all'), 'safe']} of 20 and is unsafe in the others",
            _said(runs, lambda one: rule(one, "SRSS")),
            "pounding study chapter-4",
            "confirmed in part",
        ),
        Conclusion(
            "8.1, 5",
            "SRSS is conservative when the frequencies are close, and reasonably accurate when they differ",
            "Table 4.3: pairs of equal height (frequencies 1 to 6 % apart) and the others; our frames",
            f"close: safe in {rules.loc[('srss', 'equal heights'), 'safe']} of 8, least "
            f"{rules.loc[('srss', 'equal heights'), 'least']:.2f}; different: safe in "
            f"{rules.loc[('srss', 'unequal'), 'safe']} of 12, least {rules.loc[('srss', 'unequal'), 'least']:.2f}, error "
            f"{rules.loc[('srss', 'unequal'), 'error']:.0%}",
            _said(runs, close),
            "pounding study chapter-8",
            "contradicted",
        ),
        Conclusion(
            "8.1, 6",
            "Near-field and far-field earthquakes ask for very different gaps",
            "Table 4.2: mean gaps, and over the record's peak; our closing gaps",
            per_field(field),
            _said(runs, lambda one: per_field(one.by_field)),
            "pounding study chapter-4",
            "confirmed in part",
        ),
        Conclusion(
            "section 4.3.2",
            "Gaps of frames of equal height differ from those of unequal height",
            "Tables 4.2 and 4.3: measured gap over the sum of both peaks",
            f"mean share of ABS {share['equal']:.2f} for equal heights, {share['unequal']:.2f} for the others",
            "",
            "",
            "confirmed",
        ),
    ]


def _collisions(runs: Runs | None) -> list[Conclusion]:
    def both(one: Runs) -> str:
        found = one.floors
        reduced = (found["left_most"] < 0.999) & (found["right_most"] < 0.999)
        close = found.loc[found["off_period"].idxmin()]
        return (
            f"{int(reduced.sum())} of {len(found)} collisions reduce both frames over all floors; the closest in period "
            f"({found['off_period'].idxmin()}, within {close['off_period']:.0%}): {close['left_least']:.2f} to "
            f"{close['left_most']:.2f} and {close['right_least']:.2f} to {close['right_most']:.2f}"
        )

    def tops(one: Runs) -> str:
        found, twins = one.floors, one.floors["where"] == "tops"
        sides = [(found.loc[twins, f"{s}_least"], found.loc[twins, f"{s}_most"]) for s in ("left", "right")]
        sides.append((found.loc[~twins, "right_least"], found.loc[~twins, "right_most"]))
        top_least, top_most = (pd.concat([side[i] for side in sides]) for i in (0, 1))
        middle = found[~twins]
        return (
            f"struck at the top: {int((top_most < 0.99).sum())} of {len(top_most)} frames move less at every floor, "
            f"{int((top_least > 1.01).sum())} more (up to {top_most.max():.2f}); struck at mid-height: "
            f"{int((middle['left_most'] < 0.99).sum())} of {len(middle)} less, "
            f"{int((middle['left_least'] > 1.01).sum())} more (up to {middle['left_most'].max():.2f})"
        )

    return [
        Conclusion(
            "8.1, 7",
            "Pounding reduces the displacement of both buildings only when their periods and the motion's are close",
            "18 collisions against runs without contact; periods against the dominant one of Table 7.1",
            "",
            _said(runs, both),
            "pounding study chapter-8",
            "open",
        ),
        Conclusion(
            "8.1, 8",
            "Pounding at the top can reduce, at mid-height can increase the displacement over the whole height",
            "the same collisions",
            "",
            _said(runs, tops),
            "pounding study chapter-8",
            "confirmed in part",
        ),
    ]


def _laws(printed: Printed, runs: Runs | None) -> list[Conclusion]:
    first, second = printed.ranking["rank_sum"].nsmallest(2).index
    sums, share = printed.ranking["rank_sum"], printed.ranking["first"]
    pairs = printed.by_pair

    def laws(one: Runs) -> str:
        found = one.chapter_6["agreement_of_laws"]
        apart = (found["impacts_most"] - found["impacts_fewest"]).max()
        return (
            f"counts differ by at most {apart:.0f}, first impacts by {found['first_time_spread_ms'].max():.3f} ms, the "
            f"largest peaks by a factor of {found['peak_ratio'].min():.2f} to {found['peak_ratio'].max():.2f}"
        )

    def forces(one: Runs) -> str:
        peak = one.chapter_6["peak_force_at_same_fraction"]["linear_viscoelastic"]
        hit = peak[peak > 100.0]
        return f"{hit.min() / 1e3:.1f} to {hit.max() / 1e3:.1f} kN over pairs and records"

    def bands(one: Runs) -> str:
        def width(name: str, table: str) -> float:
            found = one.chapter_6[table]
            return float((found[f"{name}, to"] - found[f"{name}, from"]).mean())

        return ", ".join(
            f"{name}: mean width {width(name, 'band_of_impacts'):.1f} impacts and "
            f"{width(name, 'band_of_peak_force') / 1e3:.1f} kN"
            for name in ("frame stiffness 8 %", "contact stiffness x 2")
        )

    def history(one: Runs) -> str:
        found = one.force
        return "peak over velocity of approach, related to the mean of the pair: " + ", ".join(
            f"{name} impacts {row['mean']:.2f} ({row['low']:.2f} to {row['high']:.2f}; {row['impacts']:.0f})"
            for name, row in found.iterrows()
        )

    return [
        Conclusion(
            "8.1, 9",
            "The impact stiffness scales as k = 620 kN/mm times the scale",
            "arithmetic: 20.66 kN/mm at 1:30",
            f"30 x 20.66 = {30 * 20.66:.1f}; one scale was tested",
            "",
            "",
            "open",
        ),
        Conclusion(
            "8.1, 10",
            "The measured k fits best",
            "needs a measured force history, which no text contains",
            "",
            "",
            "",
            "open",
        ),
        Conclusion(
            "8.1, 11",
            "All laws give similar numbers and times of impact, but not the magnitude of the force",
            "12 tests with five laws; the measured forces are not available",
            "",
            _said(runs, laws),
            "pounding study chapter-6",
            "confirmed in part",
        ),
        Conclusion(
            "8.1, 12",
            "The force depends on the earthquake and on the frames' frequencies",
            "12 tests",
            "",
            _said(runs, forces),
            "pounding study chapter-6",
            "confirmed",
        ),
        Conclusion(
            "8.1, 13",
            "Results are more sensitive to the dynamic characteristics and the contact conditions",
            "12 tests with the frames' stiffness 8 % off, and the contact's halved and doubled",
            "",
            _said(runs, bands),
            "pounding study chapter-6",
            "confirmed",
        ),
        Conclusion(
            "8.1, 14",
            "The force history depends on masses, relative velocity, material, geometry and previous impacts",
            "force over velocity of approach, first and later impacts of one touch",
            "",
            _said(runs, history),
            "pounding study chapter-8",
            "confirmed in part",
        ),
        Conclusion(
            "8.1, 15",
            "The linear viscoelastic law is the most suitable",
            "Table 6.2: sums of ranks, and 10,000 tables of 40 impacts drawn from it",
            f"{sums[first]} ({first}), next {sums[second]} ({second}); first in {share[first]:.0%} of the drawn tables",
            "",
            "",
            "open",
        ),
        Conclusion(
            "8.1, 16",
            "Tests and laws agree for 15B beside 5B and not for 15B beside 10",
            "Table 6.2: dissimilarities by pair, mean (median) [kN]",
            ", ".join(
                f"{name} {row['mean_n'] / 1e3:.1f} ({row['median_n'] / 1e3:.1f})"
                for name, row in pairs.iterrows()
            ),
            "",
            "",
            "open",
        ),
    ]


def _equations(printed: Printed, runs: Runs | None) -> list[Conclusion]:
    table = printed.taller_and_lower
    count = len(table)

    def shares(one: Runs) -> str:
        found = one.correlations["ours"].abs().unstack("symbol")
        return (
            f"ours, correlations: HS above HT in {int((found['HS'] > found['HT']).sum())} of {len(found)} classes, DS above "
            f"DT in {int((found['DS'] > found['DT']).sum())}"
        )

    def own(one: Runs) -> str:
        found = one.equations.loc[list(RECOMMENDED), "relative"]
        return (
            f"equations {', '.join(RECOMMENDED)} under the four motions of the tests {found.min():.0%} to {found.max():.0%} "
            f"off by pair; their form, fitted to other earthquakes, {experience.BY_CLASS_UNSEEN_EVENT:.0%} off"
        )

    def jump(one: Runs) -> str:
        below, above = one.readings.loc[0.599, "7.17"], one.readings.loc[0.6]
        return (
            f"its own example: {below:.0f} mm at 0.599 g, at 0.6 g {above['7.18 with 720 E']:.0f} mm by 7.18 as printed, "
            f"{above['7.18 with 1470 E, then 7.14 on S/30']:.0f} mm with 1470 E and 7.14"
        )

    return [
        Conclusion(
            "8.1, 17",
            "The proposed equations can determine the required gap under different earthquakes",
            "our 9,768 cases; earthquakes left out of the fit",
            "",
            _said(runs, own),
            "pounding study chapter-7",
            "contradicted",
        ),
        Conclusion(
            "8.1, 18",
            "HS counts for more than HT, and DS for more than DT",
            f"{count} printed tables of chapter 7, by size of correlation or coefficient; our cases",
            f"HS larger in {int(table['HS larger'].sum())} of {count}, DS larger in {int(table['DS larger'].sum())}",
            _said(runs, shares),
            "pounding study chapter-7",
            "confirmed in part",
        ),
        Conclusion(
            "8.1, 19",
            "To use the equations one must know their parameters",
            "nothing to test",
            "",
            "",
            "",
            "no claim",
        ),
        Conclusion(
            "8.1, 20",
            "The equations are a reference for engineers",
            "the worked example of section 7.6 across the border of two classes",
            "",
            _said(runs, jump),
            "pounding study chapter-7",
            "contradicted",
        ),
    ]
