"""Counterparts of the thesis' figures 3.14 to 3.18, 4.2 to 4.10, 4.13 to 4.17, 5.9, 6.7 to 6.10 and E.1 to E.5.

The thesis' curves stood in figures and are lost; their peaks are printed in Tables 4.1 and 4.2 and stand in the panels.
Motion without contact is drawn by the baseline model, to which nothing is fitted, and in the state of strong motion, whose
damping is fitted to Table 4.1. All runs are exact. Run it with ``pounding study thesis-figures --out DIR``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from pounding.experiments.campaign.cases import WINDOW_S
from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, progress_console, table
from pounding.experiments.records import RECORDS
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.pounding import shaking
from pounding.experiments.studies.thesis_figure_runs import STEP_S
from pounding.experiments.studies.thesis_figure_sheets import (
    force_figure,
    gap_figure,
    history_figure,
    interval_figure,
    pairs_figure,
    stiffness_figure,
)

DISPLACEMENTS = {"4.3": 5, "4.4": 5, "4.5": 5, "4.6": 10, "4.7": 15, "4.8": 5, "4.9": 10, "4.10": 15}
ACCELERATIONS = {"E.1": 5, "E.2": 5, "E.3": 10, "E.4": 15, "E.5": 15}
"""Figures of frames alone, and the floor that each shows; the library of experiments knows the frames and records."""
GAPS = ("4.13", "4.14", "4.15", "4.16", "4.17")
FORCES = ("6.7", "6.8", "6.9")


def main(
    *, out: options.Out = None, records: options.Records = None, json: options.Json = False
) -> dict[str, Any]:
    """Draw the counterpart of each figure of the thesis that shows a test, a motion, a gap or a force.

    Args:
        out: Folder for the pictures; without it only the numbers behind them are printed.
    """
    folder = None if records is None else str(records)
    result = stamp({"step_s": STEP_S, "window_s": WINDOW_S}, [shaking(name, folder) for name in RECORDS])
    work = figures(folder, out)
    with progress_console().status("") as status:
        for place, (number, make) in enumerate(work.items(), 1):
            status.update(f"figure {number} ({place} of {len(work)})")
            result[f"figure_{number}"] = make()
    emit(result, as_json=json, show=lambda: show(result))
    return result


def figures(folder: str | None = None, out: Path | None = None) -> dict[str, Callable[[], Any]]:
    """Return what draws each figure and returns the numbers behind it, by the figure's number.

    Args:
        folder: Folder with ground motions; None for the default.
        out: Folder for the pictures; None draws nothing.
    """
    to: dict[str, Any] = {"folder": folder, "out": out}
    work: dict[str, Callable[[], Any]] = {"4.2": partial(pairs_figure, "4.2", out)}
    work |= {n: partial(history_figure, n, floor, "displacement", **to) for n, floor in DISPLACEMENTS.items()}
    work |= {n: partial(history_figure, n, floor, "acceleration", **to) for n, floor in ACCELERATIONS.items()}
    work |= {number: partial(gap_figure, number, **to) for number in GAPS}
    work |= {number: partial(force_figure, number, **to) for number in FORCES}
    work |= {"6.10": partial(interval_figure, "6.10", **to), "5.9": partial(stiffness_figure, "5.9", **to)}
    return work


def show(result: Mapping[str, Any]) -> Iterable[Any]:
    """Return a table of the numbers behind the figures for a reader."""
    rows = []
    for key, numbers in result.items():
        if key.startswith("figure_") and isinstance(numbers, dict):
            rows += [[key.removeprefix("figure_"), name, _shown(value)] for name, value in numbers.items()]
    yield table("Numbers behind the figures", ["figure", "record, law or stiffness", "ours"], rows)
    yield "The peaks and gaps that are printed in the thesis stand in Tables 4.1 and 4.2, and in the panels."
    if isinstance(result["figure_4.2"], str):
        yield result["figure_4.2"]


def _shown(value: Any) -> str:
    if not isinstance(value, Mapping):
        return f"{value:.4g} N"
    return ", ".join(
        f"{key.replace('_', ' ')}: {_shown(one) if isinstance(one, Mapping) else format(one, '.4g')}"
        for key, one in value.items()
    )


if __name__ == "__main__":
    run_script(main)
