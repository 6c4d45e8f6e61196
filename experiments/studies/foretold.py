"""What a model that was fitted to peaks foretells of other tests: the gaps of Table 4.2, the impacts behind Table 6.2."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd

from pounding.contact.parameters import thesis_law
from pounding.experiments.campaign.cases import chapter_6
from pounding.experiments.campaign.dissimilarity import counted_impacts
from pounding.experiments.records import RECORDS, Record
from pounding.experiments.rig.pounding import floor_masses, pound, shaking
from pounding.experiments.rig.required_gap import required_gap
from pounding.experiments.rig.rig import Solver
from pounding.experiments.rig.states import Frequency, first_frequency, strong_frequencies
from pounding.experiments.separation.gaps import tables_4
from pounding.experiments.separation.gaps.gap import published_gap
from pounding.experiments.studies.frame_states import (
    Setting,
    displacements,
    in_state,
)

LAW = "linear_viscoelastic"
"""Impact law with its printed parameters; all five give the same counts within the table's own scatter."""
States = Callable[[str, str], tuple[Frequency, Frequency]]
"""The states of the left and of the right frame of a pair."""


def by_configuration(left: str, right: str) -> tuple[Frequency, Frequency]:
    """Return the states that the thesis prints for a pair: of the sweep beside a frame as tall, else of unequal pairs.

    Args:
        left: Name of the frame on the left.
        right: Name of the frame on the right.
    """
    first, second = strong_frequencies([left, right])
    return first, second


def kept(states: Mapping[str, Frequency]) -> States:
    """Return the rule by which each frame stays in its own state, whatever stands beside it."""
    return lambda left, right: (states[left], states[right])


def gaps(setting: Setting, states: States, motions: Mapping[str, Record]) -> pd.DataFrame:
    """Return the gaps of Table 4.2 that a model asks for beside the measured ones, one row a pair and record [mm].

    Args:
        setting: Damping, frequency factor and gain.
        states: The state of each frame of a pair.
        motions: Motion of the table by each record at the frames' scale.
    """
    rows = {}
    for (left, right, floor), record in product(tables_4.pairs(), RECORDS):
        motion = motions[record]
        moved = [
            displacements(
                name, [floor], motion, first_frequency(name, state) * setting.factor, setting.damping
            )[:, 0]
            for name, state in zip((left, right), states(left, right), strict=True)
        ]
        gap = required_gap(moved[0], moved[1], motion.step_s)
        printed = published_gap(left, right, floor, record)
        assert printed is not None
        rows[(left, right, floor, record)] = {
            "experiment_mm": printed["experiment_mm"],
            "closing_mm": 1e3 * setting.gain * gap.closing_m,
            "equation_4_1_mm": 1e3 * setting.gain * gap.equation_4_1_m,
        }
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "floor", "record"])


def mean_error(table: pd.DataFrame, column: str) -> float:
    """Return the mean of abs(ours - measured) / measured of a column of `gaps` [-]."""
    return float((table[column] / table["experiment_mm"] - 1.0).abs().mean())


def counts(
    setting: Setting, states: States, records: Path | None = None, solver: Solver = "exact"
) -> pd.DataFrame:
    """Return the impacts of the tests of section 6.3.2 at the laboratory's gaps beside those of Table 6.2, one row a test.

    Args:
        setting: Damping, frequency factor and gain.
        states: The state of each frame of a pair.
        records: Folder with ground motions; None for the default.
        solver: What runs the collisions.
    """
    printed, rows = counted_impacts(), {}
    for test in chapter_6():
        left_state, right_state = states(test.left, test.right)
        left = in_state(test.left, left_state, setting)
        right = in_state(test.right, right_state, setting)
        motion = shaking(test.record, None if records is None else str(records))
        louder = replace(motion, acceleration_m_s2=setting.gain * np.asarray(motion.acceleration_m_s2))
        law = thesis_law(LAW, "printed", masses=floor_masses(left, right))
        found = pound(left, right, louder, law, 1e-3 * test.gap_mm, solver=solver)
        key = (test.left, test.right, test.record)
        rows[key] = {"counted": int(printed.get(key, 0)), "ours": len(found.impacts)}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["left", "right", "record"])


def sum_of_differences(table: pd.DataFrame) -> int:
    """Return the sum of abs(ours - counted) of `counts`."""
    return int((table["ours"] - table["counted"]).abs().sum())
