"""The conclusions of section 8.1 of the thesis, each with its test, the figures of the test, and a verdict."""

from __future__ import annotations

import pandas as pd

from pounding.experiments.separation.chapter_7 import experience
from pounding.experiments.studies.chapter_8_separation import on_separation
from pounding.experiments.studies.chapter_8_tables import Conclusion, Printed, Runs, said

RECOMMENDED = ("7.13", "7.7", "7.14")
"""Model-scale equations behind those that section 7.6 recommends, one a class."""


def conclusions(printed: Printed, runs: Runs | None) -> list[Conclusion]:
    """Return every conclusion with its test and verdict.

    Args:
        printed: What follows from the printed tables.
        runs: What follows from our model; None leaves its figures out.
    """
    on_collisions = (_both_frames_reduced, _top_and_mid_height)
    on_laws = (
        _stiffness_over_scale,
        _measured_stiffness,
        _agreement_of_laws,
        _force_over_tests,
        _sensitivity,
        _force_history,
        _best_law,
        _agreement_by_pair,
    )
    on_equations = (_gaps_by_equations, _lower_over_taller, _parameters_to_know, _reference_for_engineers)
    return [
        *on_separation(printed, runs),
        *(one(printed, runs) for one in (*on_collisions, *on_laws, *on_equations)),
    ]


def _both_frames_reduced(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 7",
        "Pounding reduces the displacement of both buildings only when their periods and the motion's are close",
        "18 collisions against runs without contact; periods against the dominant one of Table 7.1",
        "",
        said(runs, _both_reduced),
        "pounding study chapter-8",
        "open",
    )


def _both_reduced(runs: Runs) -> str:
    found = runs.floors
    reduced = (found["left_most"] < 0.999) & (found["right_most"] < 0.999)
    close = found.loc[found["off_period"].idxmin()]
    return (
        f"{int(reduced.sum())} of {len(found)} collisions reduce both frames over all floors; the closest in period "
        f"({found['off_period'].idxmin()}, within {close['off_period']:.0%}): {close['left_least']:.2f} to "
        f"{close['left_most']:.2f} and {close['right_least']:.2f} to {close['right_most']:.2f}"
    )


def _top_and_mid_height(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 8",
        "Pounding at the top can reduce, at mid-height can increase the displacement over the whole height",
        "the same collisions",
        "",
        said(runs, _by_height_of_impact),
        "pounding study chapter-8",
        "confirmed in part",
    )


def _by_height_of_impact(runs: Runs) -> str:
    found, twins = runs.floors, runs.floors["where"] == "tops"
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


def _stiffness_over_scale(_printed: Printed, _runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 9",
        "The impact stiffness scales as k = 620 kN/mm times the scale",
        "arithmetic: 20.66 kN/mm at 1:30",
        f"30 x 20.66 = {30 * 20.66:.1f}; one scale was tested",
        "",
        "",
        "open",
    )


def _measured_stiffness(_printed: Printed, _runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 10",
        "The measured k fits best",
        "needs a measured force history, which no text contains",
        "",
        "",
        "",
        "open",
    )


def _agreement_of_laws(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 11",
        "All laws give similar numbers and times of impact, but not the magnitude of the force",
        "12 tests with five laws; the measured forces are not available",
        "",
        said(runs, _spread_of_laws),
        "pounding study chapter-6",
        "confirmed in part",
    )


def _spread_of_laws(runs: Runs) -> str:
    found = runs.chapter_6["agreement_of_laws"]
    apart = (found["impacts_most"] - found["impacts_fewest"]).max()
    return (
        f"counts differ by at most {apart:.0f}, first impacts by {found['first_time_spread_ms'].max():.3f} ms, the "
        f"largest peaks by a factor of {found['peak_ratio'].min():.2f} to {found['peak_ratio'].max():.2f}"
    )


def _force_over_tests(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 12",
        "The force depends on the earthquake and on the frames' frequencies",
        "12 tests",
        "",
        said(runs, _range_of_forces),
        "pounding study chapter-6",
        "confirmed",
    )


def _range_of_forces(runs: Runs) -> str:
    peak = runs.chapter_6["peak_force_at_same_fraction"]["linear_viscoelastic"]
    hit = peak[peak > 100.0]
    return f"{hit.min() / 1e3:.1f} to {hit.max() / 1e3:.1f} kN over pairs and records"


def _sensitivity(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 13",
        "Results are more sensitive to the dynamic characteristics and the contact conditions",
        "12 tests with the frames' stiffness 8 % off, and the contact's halved and doubled",
        "",
        said(runs, _bands),
        "pounding study chapter-6",
        "confirmed",
    )


def _bands(runs: Runs) -> str:
    def width(name: str, table: str) -> float:
        found = runs.chapter_6[table]
        return float((found[f"{name}, to"] - found[f"{name}, from"]).mean())

    return ", ".join(
        f"{name}: mean width {width(name, 'band_of_impacts'):.1f} impacts and "
        f"{width(name, 'band_of_peak_force') / 1e3:.1f} kN"
        for name in ("frame stiffness 8 %", "contact stiffness x 2")
    )


def _force_history(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 14",
        "The force history depends on masses, relative velocity, material, geometry and previous impacts",
        "force over velocity of approach, first and later impacts of one touch",
        "",
        said(runs, _first_and_later_impacts),
        "pounding study chapter-8",
        "confirmed in part",
    )


def _first_and_later_impacts(runs: Runs) -> str:
    return "peak over velocity of approach, related to the mean of the pair: " + ", ".join(
        f"{name} impacts {row['mean']:.2f} ({row['low']:.2f} to {row['high']:.2f}; {row['impacts']:.0f})"
        for name, row in runs.force.iterrows()
    )


def _best_law(printed: Printed, _runs: Runs | None) -> Conclusion:
    sums, share = printed.ranking["rank_sum"], printed.ranking["first"]
    first, second = sums.nsmallest(2).index
    return Conclusion(
        "8.1, 15",
        "The linear viscoelastic law is the most suitable",
        "Table 6.2: sums of ranks, and 10,000 tables of 40 impacts drawn from it",
        f"{sums[first]} ({first}), next {sums[second]} ({second}); first in {share[first]:.0%} of the drawn tables",
        "",
        "",
        "open",
    )


def _agreement_by_pair(printed: Printed, _runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 16",
        "Tests and laws agree for 15B beside 5B and not for 15B beside 10",
        "Table 6.2: dissimilarities by pair, mean (median) [kN]",
        ", ".join(
            f"{name} {row['mean_n'] / 1e3:.1f} ({row['median_n'] / 1e3:.1f})"
            for name, row in printed.by_pair.iterrows()
        ),
        "",
        "",
        "open",
    )


def _gaps_by_equations(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 17",
        "The proposed equations can determine the required gap under different earthquakes",
        "our 9,768 cases; earthquakes left out of the fit",
        "",
        said(runs, _errors_of_equations),
        "pounding study chapter-7",
        "contradicted",
    )


def _errors_of_equations(runs: Runs) -> str:
    found = runs.equations.loc[list(RECOMMENDED), "relative"]
    return (
        f"equations {', '.join(RECOMMENDED)} under the four motions of the tests {found.min():.0%} to {found.max():.0%} "
        f"off by pair; their form, fitted to other earthquakes, {experience.BY_CLASS_UNSEEN_EVENT:.0%} off"
    )


def _lower_over_taller(printed: Printed, runs: Runs | None) -> Conclusion:
    table = printed.taller_and_lower
    count = len(table)
    return Conclusion(
        "8.1, 18",
        "HS counts for more than HT, and DS for more than DT",
        f"{count} printed tables of chapter 7, by size of correlation or coefficient; our cases",
        f"HS larger in {int(table['HS larger'].sum())} of {count}, DS larger in {int(table['DS larger'].sum())}",
        said(runs, _lower_over_taller_in_runs),
        "pounding study chapter-7",
        "confirmed in part",
    )


def _lower_over_taller_in_runs(runs: Runs) -> str:
    found = runs.correlations["ours"].abs().unstack("symbol")
    return (
        f"ours, correlations: HS above HT in {int((found['HS'] > found['HT']).sum())} of {len(found)} classes, DS above "
        f"DT in {int((found['DS'] > found['DT']).sum())}"
    )


def _parameters_to_know(_printed: Printed, _runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 19",
        "To use the equations one must know their parameters",
        "nothing to test",
        "",
        "",
        "",
        "no claim",
    )


def _reference_for_engineers(_printed: Printed, runs: Runs | None) -> Conclusion:
    return Conclusion(
        "8.1, 20",
        "The equations are a reference for engineers",
        "the worked example of section 7.6 across the border of two classes",
        "",
        said(runs, _jump_between_classes),
        "pounding study chapter-7",
        "contradicted",
    )


def _jump_between_classes(runs: Runs) -> str:
    below, above = runs.readings.loc[0.599, "7.17"], runs.readings.loc[0.6]
    return (
        f"its own example: {below:.0f} mm at 0.599 g, at 0.6 g {above['7.18 with 720 E']:.0f} mm by 7.18 as printed, "
        f"{above['7.18 with 1470 E, then 7.14 on S/30']:.0f} mm with 1470 E and 7.14"
    )
