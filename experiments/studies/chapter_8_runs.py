"""Runs of our model that test conclusions of chapter 8: what collisions do to the floors, and where SRSS is safe."""

from __future__ import annotations

import json
from collections.abc import Mapping
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from pounding.experiments import published
from pounding.experiments.campaign.cases import (
    Trial,
    chapter_6,
    frame_of,
    own_required_mm,
    run_all,
    run_apart,
)
from pounding.experiments.campaign.tables import KEY, case, effect, label
from pounding.experiments.records import RECORDS, Record
from pounding.experiments.rig.pounding import built
from pounding.experiments.rig.required_gap import required_gap
from pounding.experiments.rig.states import first_frequency
from pounding.experiments.separation.rules.rules import square_root_of_squares
from pounding.experiments.studies.frame_states import baseline, displacements
from pounding.experiments.studies.sap2000_peaks import TWINS
from pounding.experiments.sweeps.sweep import sweep

TWIN_FRACTION = 0.7
"""Gap of the runs of frames of equal height, which the laboratory did not let collide, over the required gap."""
SLOW_M_S = 0.05
"""Impacts slower than this are left out of ratios of force to velocity [m/s]."""
RATIOS = (1.0, 1.01, 1.02, 1.05, 1.1, 1.2, 1.5)
"""First frequency of a frame over that of its neighbour, which is the same frame otherwise."""


def collisions(folder: Path | None = None, workers: int | None = None) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the collisions of 12 tests and of 8 pairs and records of equal height, and what they do to each floor.

    The gap is the laboratory's fraction of our required gap, for frames of equal height `TWIN_FRACTION` of it; the impact
    law is the linear viscoelastic one with its printed parameters.

    Args:
        folder: Records; the usual places when None.
        workers: Processes; 0 for none.

    Returns:
        The runs (see `run_all`), and the ratios of the floors' peaks to those of the run without contact (see `effect`).
    """
    name = None if folder is None else str(folder)
    tests = [(test, test.own_gap_mm(name)) for test in chapter_6()]
    for (left, right), record in product(TWINS, RECORDS):
        gap = TWIN_FRACTION * own_required_mm(left, right, record, name)
        tests.append((Trial(left, right, record, gap, gap / TWIN_FRACTION), gap))
    runs = run_all([case(test, gap) for test, gap in tests], folder=folder, workers=workers)
    keys = [{key: getattr(test, key) for key in KEY} for test, _ in tests]
    apart = frame_of(sweep(run_apart, keys, settings={"folder": name or ""}, workers=workers))
    return runs, effect(runs, apart)


def effect_on_frames(runs: pd.DataFrame, ratios: pd.DataFrame) -> pd.DataFrame:
    """Return the lowest and highest ratio of peak displacements over each frame's floors, one row a collision.

    Args:
        runs: See `collisions`.
        ratios: See `collisions`.

    Returns:
        ``left_least``, ``left_most``, ``right_least``, ``right_most`` [-], ``where``: at which height of the left and of the
        right frame they collide, and ``off_period``: the largest of abs(ln(T / T_g)) over both first periods, T_g being the
        dominant period of the record in Table 7.1.
    """
    dominant = published.table("7.1")["tg_s"]
    rows = {}
    for row in runs[runs["count"] > 0].to_dict("records"):
        name = label(row["left"], row["right"], row["record"])
        found = ratios.loc[name]["displacement"]
        spans = {side: found.xs(side, level="side") for side in ("left", "right")}
        periods = [1.0 / float(built(row[side]).frequencies_hz[0]) for side in ("left", "right")]
        heights = [float(built(row[side]).heights_m[-1]) for side in ("left", "right")]
        rows[name] = {
            **{f"{side}_least": float(span.min()) for side, span in spans.items()},
            **{f"{side}_most": float(span.max()) for side, span in spans.items()},
            "where": "tops" if heights[0] == heights[1] else "mid-height and top",
            "off_period": max(abs(np.log(period / float(dominant[row["record"]]))) for period in periods),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("case")


def force_over_velocity(runs: pd.DataFrame) -> pd.DataFrame:
    """Return peak force over velocity of approach of first and of later impacts, one row each [N s/m].

    Impacts of one touch are compared within their pair, to whose mean they are related: ``low`` and ``high`` are the 5th and
    95th percentile of that ratio, ``impacts`` how many there are.

    Args:
        runs: See `collisions`.
    """
    found = []
    for row in runs.to_dict("records"):
        for number, one in enumerate(json.loads(row["impacts"])):
            velocity = one["approach_velocity_m_s"]
            if one["touches"] == 1 and velocity >= SLOW_M_S:
                pair = f"{row['left']}-{row['right']}"
                found.append((pair, "first" if number == 0 else "later", one["peak_force_n"] / velocity))
    table = pd.DataFrame(found, columns=["pair", "order", "ratio"])
    table["ratio"] /= table.groupby("pair")["ratio"].transform("mean")
    ratio = table.groupby("order")["ratio"]
    return pd.DataFrame(
        {
            "impacts": ratio.size(),
            "mean": ratio.mean(),
            "low": ratio.quantile(0.05),
            "high": ratio.quantile(0.95),
        }
    )


def srss_by_ratio(
    motions: Mapping[str, Record], names: tuple[str, ...] = ("5B", "10", "15B")
) -> pd.DataFrame:
    """Return SRSS over the required gap of a frame beside itself with another first frequency, one row a ratio.

    Args:
        motions: Motion of the table by record.
        names: The frames; the roofs meet.

    Returns:
        ``cases``, ``safe`` (how many SRSS covers), ``least``, ``median`` and ``largest`` of SRSS / required by equation 4.1;
        two equal frames need no gap and have no ratio.
    """
    rows = {}
    for ratio in RATIOS:
        found = []
        for name, (_, motion) in product(names, motions.items()):
            first, floor = first_frequency(name, "free vibration"), len(baseline(name).height_m)
            one, other = (
                displacements(name, [floor], motion, hz, None)[:, 0] for hz in (first, ratio * first)
            )
            gap = required_gap(one, other, motion.step_s)
            if gap.equation_4_1_m > 0.0:
                root = square_root_of_squares(gap.left_peak_m, gap.right_peak_m)
                found.append(root / gap.equation_4_1_m)
        rows[ratio] = {
            "cases": len(found),
            "safe": int(np.sum(np.array(found) >= 1.0)),
            "least": min(found, default=np.nan),
            "median": float(np.median(found)) if found else np.nan,
            "largest": max(found, default=np.nan),
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis("frequency ratio")
