"""What is missing in the thesis' own tables? States of the frames, damping, frequencies, gain of the table; held out.

Models with up to three fitted numbers and a state for each frame are fitted to a part of the uncontested peaks of Table 4.1
and judged on the rest: two records of four in all six splits, three of four, one frame left out. What is fitted to all peaks
then foretells the gaps of Table 4.2 and the impacts of Table 6.2. Every choice is made on the part that is fitted; models
whose states were chosen beforehand, with all data seen, stand beside them and are called so. Run it with
``pounding study missing-in-the-thesis``.
"""

from __future__ import annotations

import json as jsonlib
from collections.abc import Iterable
from dataclasses import asdict
from itertools import combinations, product
from pathlib import Path
from typing import Any

import numpy as np
from rich.progress import Progress

from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.records import find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.states import Frequency
from pounding.experiments.studies import foretold
from pounding.experiments.studies.averaged_peaks import averaged, averaged_errors
from pounding.experiments.studies.frame_states import TWO_STATES, Setting
from pounding.experiments.studies.held_out import picked_inside, row
from pounding.experiments.studies.missing_picture import picture
from pounding.experiments.studies.peak_lattice import Chosen, Freedom, PeakLattice
from pounding.experiments.studies.table_4_1 import (
    BLIND,
    FRAMES,
    RECORDS,
    measured,
    score,
    table_motion,
    trusted,
)
from pounding.frames.files import write_whole

NUMBERS = tuple(chosen for count in range(4) for chosen in combinations(("damping", "factor", "gain"), count))
WORDS = {"damping": "one damping ratio", "factor": "a factor on all frequencies", "gain": "gain of the table"}
BACK_RATIOS = (None, 0.0075, 0.0105, 0.012, 0.0135, 0.0175, 0.0225)
"""Damping ratios that are fitted to gaps and to impacts; no ratio is each frame's own."""
BEFOREHAND = "states chosen beforehand"


def freedoms() -> dict[str, Freedom]:
    """Return every model that is tried by its name, the baseline model first."""
    found = {}
    for states, words in (
        ("baseline", ""),
        ("fitted", "a state for each frame"),
        (tuple(TWO_STATES.items()), BEFOREHAND),
    ):
        for numbers in NUMBERS:
            name = " + ".join([*([words] if words else []), *(WORDS[one] for one in numbers)])
            found[name or "baseline"] = Freedom(numbers, states)
    return found


def foretold_by(chosen: Chosen, rule: str, records: Path | None) -> dict[str, Any]:
    """Return what a model says of gaps and impacts: `own` keeps each frame's state, else it follows the configuration.

    Args:
        chosen: The model as fitted to the peaks.
        rule: `own` or `configuration`.
        records: Folder with ground motions; None for the default.
    """
    states = foretold.kept(chosen.states) if rule == "own" else foretold.by_configuration
    motions = {name: table_motion(name, BLIND, records) for name in RECORDS}
    gaps = foretold.gaps(chosen.setting, states, motions)
    counts = foretold.counts(chosen.setting, states, records)
    return {
        "states": rule,
        "equation_4_1": foretold.mean_error(gaps, "equation_4_1_mm"),
        "closing": foretold.mean_error(gaps, "closing_mm"),
        "impacts": int(counts["ours"].sum()),
        "counted": int(counts["counted"].sum()),
        "sum_of_differences": foretold.sum_of_differences(counts),
    }


def and_back(lattice: PeakLattice, records: Path | None) -> dict[str, Any]:
    """Return models fitted to the gaps, and to the impacts, and what they say of what they were not fitted to.

    One damping ratio is fitted, and a rule for the states is chosen: all of free vibration, all of the sweep, or as printed
    for the pair (for the peaks of single frames: as chosen beforehand).

    Args:
        lattice: The errors of the peaks.
        records: Folder with ground motions; None for the default.
    """
    motions = {name: table_motion(name, BLIND, records) for name in RECORDS}
    rules: dict[str, tuple[foretold.States, dict[str, Frequency]]] = {
        "free vibration": (
            lambda left, right: ("free vibration", "free vibration"),
            dict.fromkeys(FRAMES, "free vibration"),
        ),
        "sweep": (lambda left, right: ("sweep", "sweep"), dict.fromkeys(FRAMES, "sweep")),
        "as printed for the pair": (foretold.by_configuration, TWO_STATES),
    }
    tried: list[dict[str, Any]] = []
    for (rule, (states, single)), damping in product(rules.items(), BACK_RATIOS):
        setting = Setting(damping)
        gaps, counts = foretold.gaps(setting, states, motions), foretold.counts(setting, states, records)
        tried.append(
            {
                "states": rule,
                "damping": damping,
                "equation_4_1": foretold.mean_error(gaps, "equation_4_1_mm"),
                "impacts": int(counts["ours"].sum()),
                "sum_of_differences": foretold.sum_of_differences(counts),
                "peaks_58": lattice.error(Chosen(setting, single, np.nan), range(len(RECORDS))),
            }
        )
    return {
        "gaps": min(tried, key=lambda one: one["equation_4_1"]),
        "impacts": min(tried, key=lambda one: one["sum_of_differences"]),
    }


def main(
    *, records: options.Records = None, json: options.Json = False, out: options.Out = None
) -> dict[str, Any]:
    """Find which states, damping, frequencies and gain explain the thesis' tables, on data that were not fitted."""
    models = freedoms()
    with Progress(console=progress_console(), transient=True) as progress:
        task = progress.add_task("responses of the frames", total=1.0)
        lattice = PeakLattice(records, lambda share: progress.update(task, completed=share))
        task = progress.add_task("fitting and judging", total=len(models))
        rows = []
        for name, freedom in models.items():
            rows.append(row(lattice, name, freedom))
            progress.update(task, advance=1)
        task = progress.add_task("gaps and impacts", total=len(models))
        for one, freedom in zip(rows, models.values(), strict=True):
            chosen = lattice.fit(freedom, range(len(RECORDS)))
            rules = ("own",) if freedom.states == "baseline" else ("own", "configuration")
            one["foretold"] = [foretold_by(chosen, rule, records) for rule in rules]
            progress.update(task, advance=1)
    honest = [one for one in models.values() if isinstance(one.states, str)]
    nested, picked = picked_inside(lattice, honest)
    nested_64, _ = picked_inside(lattice, honest, every=True)
    names = {freedom: name for name, freedom in models.items()}
    everything = range(len(RECORDS))
    result = stamp({"baseline": asdict(BLIND)}, [find(name, records) for name in RECORDS])
    result |= {
        "models": rows,
        "picked_inside": {
            "halves_58": nested,
            "halves_64": nested_64,
            "models": [names[one] for one in picked],
        },
        "averaged": {
            "all_58": lattice.error_of(averaged(lattice, everything), everything),
            "halves_58": float(np.mean(averaged_errors(lattice, 2))),
            "three_58": float(np.mean(averaged_errors(lattice, 3))),
            "halves_64": float(np.mean(averaged_errors(lattice, 2, every=True))),
            "three_64": float(np.mean(averaged_errors(lattice, 3, every=True))),
        },
        "and_back": and_back(lattice, records),
        "sap2000": {
            "all_58": score(measured("numerical"), trusted()).mean,
            "all_64": score(measured("numerical")).mean,
        },
    }
    if out is not None:
        write_whole(
            out / "missing_in_the_thesis.json", (jsonlib.dumps(plain(result), indent=2) + "\n").encode()
        )
        picture(rows, result["sap2000"]["all_58"], out / "missing-in-the-thesis.png")
    emit(result, as_json=json, show=lambda: show(result))
    return result


def show(result: dict[str, Any]) -> Iterable[Any]:
    """Return the study as tables for a reader."""
    keys = ("all_58", "halves_58", "three_58", "frames_58", "all_64", "halves_64")
    lines = [
        [one["model"], str(one["fitted"]), *(f"{100 * one[key]:.1f}" for key in keys), _setting(one)]
        for one in result["models"]
    ]
    yield table(
        "Table 4.1: mean |ours - measured| / measured [%] of 58 uncontested peaks, and of all 64",
        [
            "model",
            "fitted",
            "all",
            "2 of 4 records",
            "3 of 4",
            "one frame",
            "64: all",
            "64: 2 of 4",
            "fitted to 58",
        ],
        lines,
    )
    yield table(
        "What the model fitted to the 58 peaks foretells",
        ["model", "states in pairs", "eq. 4.1 [%]", "closing gap [%]", "impacts", "sum of differences"],
        [
            [
                one["model"],
                "as in Table 4.1" if said["states"] == "own" else "as printed for the pair",
                f"{100 * said['equation_4_1']:.1f}",
                f"{100 * said['closing']:.1f}",
                f"{said['impacts']} of {said['counted']}",
                str(said["sum_of_differences"]),
            ]
            for one in result["models"]
            for said in one["foretold"]
        ],
    )
    for fitted, one in result["and_back"].items():
        damping = "own damping" if one["damping"] is None else f"{100 * one['damping']:.3g} % of damping"
        yield (
            f"Fitted to the {fitted}: states {one['states']}, {damping}: eq. 4.1 {100 * one['equation_4_1']:.1f} %, "
            f"{one['impacts']} impacts, sum of differences {one['sum_of_differences']}, "
            f"58 peaks {100 * one['peaks_58']:.1f} %."
        )
    inside, theirs, mean = result["picked_inside"], result["sap2000"], result["averaged"]
    yield (
        f"With the model itself picked inside each split: {100 * inside['halves_58']:.1f} % of 58 peaks, "
        f"{100 * inside['halves_64']:.1f} % of 64. SAP2000 as printed: {100 * theirs['all_58']:.1f} and "
        f"{100 * theirs['all_64']:.1f} %."
    )
    yield (
        "With the weighted median of all models, weighted by the fitted peaks: 58 peaks, two of four records "
        f"{100 * mean['halves_58']:.1f} %, three of four {100 * mean['three_58']:.1f} %, all fitted "
        f"{100 * mean['all_58']:.1f} %; 64 peaks {100 * mean['halves_64']:.1f} and {100 * mean['three_64']:.1f} %."
    )


def _setting(one: dict[str, Any]) -> str:
    """Return fitted numbers and states in words."""
    setting, states = one["setting"], one["states"]
    damping = "own" if setting["damping"] is None else f"{100 * setting['damping']:.2g} %"
    short: dict[Frequency, str] = {"free vibration": "f", "sweep": "s", "unequal pair": "u"}
    letters = " ".join(f"{name} {short[state]}" for name, state in states.items())
    return f"damping {damping}, f x {setting['factor']:.3g}, gain {setting['gain']:.3g}; {letters}"


if __name__ == "__main__":
    run_script(main)
