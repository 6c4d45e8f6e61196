"""What the study of chapter 8 works with: a conclusion, and the tables on which its verdict rests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import pandas as pd

Verdict = Literal["confirmed", "confirmed in part", "contradicted", "open", "no claim"]


@dataclass(frozen=True)
class Conclusion:
    """A conclusion of the thesis and what became of it.

    Attributes:
        place: Its place among the 20 of section 8.1 (p. 183 and following), or another section.
        statement: What the thesis says, shortened.
        test: What it was held against.
        printed: Figures that follow from the printed tables alone.
        runs: Figures of our model; empty where there are none, or where it was not run.
        command: What makes the figures of our model; empty where there are none.
        verdict: Whether it holds.
    """

    place: str
    statement: str
    test: str
    printed: str
    runs: str
    command: str
    verdict: Verdict


@dataclass(frozen=True)
class Printed:
    """Tables that follow from the printed ones alone, see `pounding.experiments.studies.chapter_8_printed`."""

    height_rule: pd.DataFrame
    rules: pd.DataFrame
    by_field: pd.DataFrame
    share_of_abs: pd.Series
    ranking: pd.DataFrame
    by_pair: pd.DataFrame
    taller_and_lower: pd.DataFrame


@dataclass(frozen=True)
class Runs:
    """Tables of our model.

    Attributes:
        by_field: As in `Printed`, of our closing gaps.
        srss: See `chapter_8_runs.srss_by_ratio`.
        floors: See `chapter_8_runs.effect_on_frames`.
        force: See `chapter_8_runs.force_over_velocity`.
        rules: How the codes' rules compare with our gaps by equation 4.1, see `tables_4.summary`.
        chapter_6: Tables of the study of chapter 6.
        correlations: Correlations of the gap, printed and ours.
        equations: Errors of the thesis' equations on our cases under its own motions.
        readings: The worked example of section 7.6 over the peak acceleration.
    """

    by_field: pd.DataFrame
    srss: pd.DataFrame
    floors: pd.DataFrame
    force: pd.DataFrame
    rules: pd.DataFrame
    chapter_6: dict[str, pd.DataFrame]
    correlations: pd.DataFrame
    equations: pd.DataFrame
    readings: pd.DataFrame


def said(runs: Runs | None, words: Callable[[Runs], str]) -> str:
    """Return what our model says of a conclusion; nothing where it was not run.

    Args:
        runs: What follows from our model, or None.
        words: Says it.
    """
    return "" if runs is None else words(runs)
