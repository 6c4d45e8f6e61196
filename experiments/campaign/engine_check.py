"""Runs of a campaign by the exact solver, checked: a sample by exudyn, all by their energy balance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from pounding.experiments.campaign.cases import DEFAULTS, peaks_table, run_all

SAMPLE = 5
"""Runs that are run again, spread evenly over the campaign."""

CLOSES = 1e-4
"""Imbalance of a run's energy from which the run is wrong, over the largest energy in it [-]: forty times what the worst run
of chapters 5 and 6 has. A motion that is not that of the frame's matrices misses it by far."""


@dataclass(frozen=True)
class EngineCheck:
    """How runs by the exact solver compare with the same runs by exudyn.

    Attributes:
        runs: Number of runs of the campaign.
        checked: How many of them were run by exudyn, too.
        same_count: How many of these have the same number of impacts.
        displacement: Largest relative difference of a roof's peak displacement [-].
        first_peak: Largest relative difference of a first impact's peak force [-]; 0 where nothing touched.
        energy: Largest imbalance of energy of any run by the exact solver, those not in the sample too [-].
        unbalanced: How many runs have more than `CLOSES` of it.
        worst: The run of the largest imbalance, in words.
    """

    runs: int
    checked: int
    same_count: int
    displacement: float
    first_peak: float
    energy: float
    unbalanced: int
    worst: str

    def as_dict(self) -> dict[str, Any]:
        """Return the comparison as a dictionary, in the order above."""
        return asdict(self)

    @property
    def sentence(self) -> str:
        """The comparison in words."""
        return (
            f"{self.runs} runs by the exact solver; exudyn ran {self.checked} of them again: "
            f"{self.same_count} with the same number of impacts, roof displacements within "
            f"{100 * self.displacement:.2g} %, peak forces of first impacts within {100 * self.first_peak:.2g} %; "
            f"{self._balance}"
        )

    @property
    def _balance(self) -> str:
        if not self.unbalanced:
            return f"the energy of all runs closes within {100 * self.energy:.2g} %"
        return (
            f"but energy does not close within {100 * CLOSES:g} % in {self.unbalanced} of all runs, least in "
            f"{self.worst} ({100 * self.energy:.2g} %): do not use them, use --solver exudyn"
        )


def check_in_engine(
    cases: Sequence[dict[str, Any]],
    runs: pd.DataFrame,
    *,
    folder: Path | str | None = None,
    kept: Path | None = None,
    workers: int | None = None,
) -> EngineCheck:
    """Run a sample of a campaign by exudyn and compare; look at the energy balance of every run, which costs nothing.

    Args:
        cases: Arguments of `run_case` that the campaign had.
        runs: What `run_all` returned for them by the exact solver, in the same order.
        folder, kept, workers: As for `run_all`.
    """
    places = np.unique(np.linspace(0, len(cases) - 1, min(SAMPLE, len(cases))).round().astype(int))
    again = run_all(
        [cases[place] for place in places], folder=folder, kept=kept, workers=workers, solver="exudyn"
    )
    displacement, first_peak, same = 0.0, 0.0, 0
    for (_, one), (_, other) in zip(runs.iloc[places].iterrows(), again.iterrows(), strict=True):
        mine, theirs = (peaks_table(row["peaks"])["displacement_mm"] for row in (one, other))
        displacement = max(displacement, float((mine / theirs - 1.0).abs().max()))
        same += int(one["count"] == other["count"])
        if one["count"] and other["count"]:
            first_peak = max(first_peak, abs(one["first_peak_n"] / other["first_peak_n"] - 1.0))
    energy = runs["energy_error"].to_numpy(float)
    # What is no number does not close either.
    open_ = ~(energy <= CLOSES)
    worst = int(np.argmax(np.where(np.isnan(energy), np.inf, energy)))
    return EngineCheck(
        len(cases),
        len(places),
        same,
        displacement,
        float(first_peak),
        float(energy[worst]),
        int(open_.sum()),
        _in_words(cases[worst]),
    )


def _in_words(case: dict[str, Any]) -> str:
    named = f"{case['left']}-{case['right']} under {case['record']}, {case['law']}, gap {case['gap_mm']:g} mm"
    changed = [f"{key} {value}" for key, value in case.items() if key in DEFAULTS and value != DEFAULTS[key]]
    return ", ".join([named, *changed])
