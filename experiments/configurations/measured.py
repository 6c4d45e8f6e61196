"""What was measured in a configuration, as printed, beside what the simulation gives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import pandas as pd

from pounding.experiments import published
from pounding.experiments.configurations.definition import Experiment, Printed
from pounding.experiments.errors import ExperimentError
from pounding.frames.files import write_whole

Peaks = list[dict[str, Any]]


@dataclass(frozen=True)
class Row:
    """One quantity of a configuration.

    Attributes:
        quantity: What it is.
        unit: Its unit; empty for a number without one.
        measured: As printed; None where it was not printed, or is lost with a figure.
        sap2000: Of the thesis' own model; None where it has none.
        ours: Of the simulation; None where it has none, such as a restitution without an impact.
        source: Where the measured number is printed.
    """

    quantity: str
    unit: str
    measured: float | None
    sap2000: float | None
    ours: float | None
    source: str

    def without_measured(self) -> Row:
        """Return the row without what was measured or computed in other conditions."""
        return replace(self, measured=None, sap2000=None)


def printed_row(reference: Printed) -> pd.Series | pd.DataFrame:
    """Return a printed row; rows of several impacts as a table.

    Raises:
        ExperimentError: There is no such table or row.
    """
    table = published.table(reference.table).sort_index()
    key = reference.row[0] if table.index.nlevels == 1 else reference.row
    try:
        return table.loc[key]
    except (KeyError, TypeError) as error:
        raise ExperimentError(f"{reference}: the table has no such row") from error


def free_vibration(experiment: Experiment, frequency_hz: float, damping_ratio: float) -> list[Row]:
    """Return frequency and damping of a free vibration.

    Args:
        experiment: The configuration.
        frequency_hz: Frequency that was read [Hz].
        damping_ratio: Damping ratio that was read [-].
    """
    (reference,) = experiment.measured
    known = printed_row(reference)["experiment"]
    rows = [
        ("first frequency", "Hz", float(known["free_vibration_hz"]), None, frequency_hz),
        ("damping ratio", "%", float(known["damping_percent"]), None, 100.0 * damping_ratio),
    ]
    return [Row(*cells, str(reference)) for cells in rows]


def push(experiment: Experiment, stiffness_n_per_m: float) -> list[Row]:
    """Return the stiffness of the roof.

    Args:
        experiment: The configuration.
        stiffness_n_per_m: Slope of load over deflection [N/m].
    """
    (reference,) = experiment.measured
    known = printed_row(reference)
    measured, numerical = (
        round(1e3 * float(known[source]["stiffness_kn_per_mm"]), 6) for source in ("experiment", "numerical")
    )
    ours = stiffness_n_per_m / 1e3
    return [Row("roof stiffness", "N/mm", measured, numerical, ours, str(reference))]


def sine_sweep(experiment: Experiment, frequencies_hz: Iterable[float]) -> list[Row]:
    """Return the lowest frequencies that a sweep shows.

    Args:
        experiment: The configuration.
        frequencies_hz: Frequencies that were read [Hz].
    """
    (reference,) = experiment.measured
    known = printed_row(reference)
    return [
        Row(
            f"frequency {mode}",
            "Hz",
            float(known["experiment"][f"mode{mode}_hz"]),
            float(known["numerical"][f"mode{mode}_hz"]),
            frequency,
            str(reference),
        )
        for mode, frequency in enumerate(frequencies_hz, 1)
    ]


def alone(experiment: Experiment, record: str, peaks: Peaks) -> list[Row]:
    """Return the peaks of the floors that were measured.

    Args:
        experiment: The configuration.
        record: Name of the ground motion of the thesis.
        peaks: Peaks of each floor, see `FrameMotion.peaks`.
    """
    by_floor = {peak["floor"]: peak for peak in peaks}
    rows = []
    for reference in experiment.measured:
        known, floor = printed_row(reference)[record], int(reference.row[1])
        for side in ("max", "min"):
            measured, numerical = (float(known[source][side]) for source in ("experiment", "numerical"))
            ours = by_floor[floor][f"{side}_mm"]
            rows.append(Row(f"floor {floor} {side}", "mm", measured, numerical, ours, str(reference)))
    return rows


def apart(experiment: Experiment, record: str, ours_mm: Mapping[str, float]) -> list[Row]:
    """Return the gap that is needed and the two rules of Table 4.3.

    Args:
        experiment: The configuration.
        record: Name of the ground motion of the thesis.
        ours_mm: `gap` (closing motion), `equation 4.1`, `ABS` and `SRSS` [mm].
    """
    gap, rules = experiment.measured
    known, ruled = printed_row(gap)[record], printed_row(rules)[record]
    measured, numerical = float(known["experiment"]), float(known["numerical"])
    return [
        Row("required gap (closing motion)", "mm", measured, numerical, ours_mm["gap"], str(gap)),
        Row("gap by equation 4.1", "mm", measured, numerical, ours_mm["equation 4.1"], str(gap)),
        Row("ABS of the peaks", "mm", float(ruled["abs"]), None, ours_mm["ABS"], str(rules)),
        Row("SRSS of the peaks", "mm", float(ruled["srss"]), None, ours_mm["SRSS"], str(rules)),
    ]


def collision(experiment: Experiment, record: str, runs: Mapping[str, Mapping[str, Any]]) -> list[Row]:
    """Return impacts, peak force and touches of each run of a collision.

    Args:
        experiment: The configuration.
        record: Name of the ground motion of the thesis.
        runs: For each law or stiffness its `impacts`, `peak_force_n`, `touches`, `longest_touch_ms` and
            `touch_restitution`, the median of all its touches.
    """
    rows = []
    for reference in experiment.measured:
        count = _COUNTS[reference.table]
        if count is not None:
            what, printed = count(reference, record)
            rows += [
                Row(f"{what}, {name}", "", printed, None, float(run["impacts"]), str(reference))
                for name, run in runs.items()
            ]
    for key, (what, unit) in _OF_TOUCHES.items():
        rows += [Row(f"{what}, {name}", unit, None, None, run[key], LOST) for name, run in runs.items()]
    return rows


LOST = "its history stood in a figure"
_OF_TOUCHES = {
    "peak_force_n": ("peak force", "N"),
    "touches": ("touches in all impacts", ""),
    "longest_touch_ms": ("longest touch", "ms"),
    "touch_restitution": ("restitution of a touch, median", ""),
}
"""What only a force history could be compared with: key, in words, unit."""


def _at_least_one(_reference: Printed, _record: str) -> tuple[str, float]:
    """All gaps of section 5.2.2 were chosen so that the frames collide."""
    return "impacts (measured: at least)", 1.0


def _counted(reference: Printed, record: str) -> tuple[str, float]:
    impacts = printed_row(reference)[record].dropna()
    return "impacts", float(len(impacts))


_COUNTS: dict[str, Callable[[Printed, str], tuple[str, float]] | None] = {
    "section 5.2.2": _at_least_one,
    "6.2": _counted,
    # It holds the gap alone, which the entry repeats.
    "section 6.3.2": None,
}


def check(experiment: Experiment) -> None:
    """See that the printed rows of a configuration are there and say the same of it as its entry.

    Raises:
        ExperimentError: A row is not there, belongs to other frames or another record, or has another gap.
    """
    for reference in experiment.measured:
        found = printed_row(reference)
        names = tuple(map(str, reference.row[: len(experiment.frames)]))
        if names != experiment.frame_names:
            raise ExperimentError(f"{experiment.name}: {reference} is of other frames")
        if reference.table.startswith("section"):
            gap = getattr(experiment, "gap_mm", None)
            if float(found["gap_mm"]) != gap or reference.row[2] != experiment.motion:
                raise ExperimentError(f"{experiment.name}: {reference} has another gap or record")
        elif experiment.motion is not None and experiment.motion not in _records(found):
            raise ExperimentError(f"{experiment.name}: {reference} has no record '{experiment.motion}'")


def _records(found: pd.Series | pd.DataFrame) -> set[str]:
    heads = found.columns if isinstance(found, pd.DataFrame) else found.index
    return set(heads.get_level_values("record"))


def write(rows: Iterable[Row], path: Path) -> None:
    """Write rows as CSV, one a line, units in a column of their own.

    Args:
        rows: The rows.
        path: File to write.

    Raises:
        FrameError: The file cannot be written.
    """
    _save(pd.DataFrame([asdict(row) for row in rows]), path)


def write_many(rows: Mapping[str, Iterable[Row]], path: Path) -> None:
    """Write the rows of several configurations as one CSV file.

    Args:
        rows: Rows by the name of the configuration.
        path: File to write.

    Raises:
        FrameError: The file cannot be written.
    """
    lines = [{"experiment": name} | asdict(row) for name, found in rows.items() for row in found]
    _save(pd.DataFrame(lines), path)


def _save(table: pd.DataFrame, path: Path) -> None:
    write_whole(path, table.to_csv(index=False).encode())
