"""What is missing in the thesis' own tables? States of the frames, damping, frequencies, gain of the table; held out.

Models with up to three fitted numbers and a state for each frame are fitted to a part of the uncontested peaks of Table
4.1 and judged on the rest: two records of four in all six splits, three of four, one frame left out. The numbers are
damping, frequencies and gain of the table; slip or friction in the storeys stand alone or beside one of them. What is
fitted to all peaks then foretells the gaps of Table 4.2 and the impacts of Table 6.2. Every choice is made on the part
that is fitted; models whose states were chosen beforehand, with all data seen, stand beside them and are called so. Run
it with ``pounding study missing-in-the-thesis``.
"""

from __future__ import annotations

import json as jsonlib
from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict
from functools import partial
from itertools import combinations, product
from pathlib import Path
from typing import Any

import numpy as np
from rich.progress import Progress, TaskID

from pounding.experiments.console import options
from pounding.experiments.console.exit_status import run_script
from pounding.experiments.console.output import emit, plain, progress_console, table
from pounding.experiments.records import RECORDS, find
from pounding.experiments.results.provenance import stamp
from pounding.experiments.rig.states import Frequency
from pounding.experiments.studies import foretold
from pounding.experiments.studies.added_lattice import AddedLattice, Effect
from pounding.experiments.studies.averaged_peaks import averaged, averaged_errors
from pounding.experiments.studies.frame_states import TWO_STATES, Setting
from pounding.experiments.studies.held_out import picked_inside, row
from pounding.experiments.studies.missing_picture import picture
from pounding.experiments.studies.peak_lattice import Chosen, Freedom, Lattice, PeakLattice
from pounding.experiments.studies.table_4_1 import (
    BLIND,
    FRAMES,
    measured,
    score,
    table_motion,
    trusted,
)
from pounding.frames.files import write_whole

NUMBERS = tuple(chosen for count in range(4) for chosen in combinations(("damping", "factor", "gain"), count))
EFFECTS: tuple[Effect, ...] = ("slip", "friction")
WORDS = {
    "damping": "one damping ratio",
    "factor": "a factor on all frequencies",
    "gain": "gain of the table",
    "slip": "slip in the storeys",
    "friction": "friction in the storeys",
}
BACK_RATIOS = (None, 0.0075, 0.0105, 0.012, 0.0135, 0.0175, 0.0225)
"""Damping ratios that are fitted to gaps and to impacts; no ratio is each frame's own."""
BEFOREHAND = "states chosen beforehand"


def freedoms(numbers: Sequence[tuple[str, ...]] = NUMBERS) -> dict[str, Freedom]:
    """Return every model that is tried by its name, the baseline model first if it is one of them.

    Args:
        numbers: The sets of numbers that are fitted together.
    """
    found = {}
    for states, words in (
        ("baseline", ""),
        ("fitted", "a state for each frame"),
        (tuple(TWO_STATES.items()), BEFOREHAND),
    ):
        for chosen in numbers:
            name = " + ".join([*([words] if words else []), *(WORDS[one] for one in chosen)])
            found[name or "baseline"] = Freedom(chosen, states)
    return found


def with_effect(effect: Effect) -> dict[str, Freedom]:
    """Return the models with slip or friction by their names: alone, and with one other number.

    Args:
        effect: Which.
    """
    return freedoms([(effect,), (effect, "damping"), (effect, "gain")])


def judged_together(models: Sequence[tuple[Lattice, dict[str, Freedom]]]) -> dict[str, Any]:
    """Return the held-out errors of a pick inside each split, and of the weighted median of all models [-].

    Only models whose states were not chosen beforehand take part.

    Args:
        models: The models by name, each lattice's.
    """
    honest = [
        (lattice, one) for lattice, named in models for one in named.values() if isinstance(one.states, str)
    ]
    names = {one: name for _, named in models for name, one in named.items()}
    lattices, everything = [lattice for lattice, _ in models], range(len(RECORDS))
    nested, picked = picked_inside(honest)
    return {
        "picked_inside": {
            "halves_58": nested,
            "halves_64": picked_inside(honest, every=True)[0],
            "models": [names[one] for one in picked],
        },
        "averaged": {
            "all_58": lattices[0].error_of(averaged(lattices, everything), everything),
            "halves_58": float(np.mean(averaged_errors(lattices, 2))),
            "three_58": float(np.mean(averaged_errors(lattices, 3))),
            "halves_64": float(np.mean(averaged_errors(lattices, 2, every=True))),
            "three_64": float(np.mean(averaged_errors(lattices, 3, every=True))),
        },
    }


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
                "peaks_58": lattice.error(Chosen({"damping": damping}, single, np.nan), range(len(RECORDS))),
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
        added: list[tuple[Lattice, dict[str, Freedom]]] = []
        for effect in EFFECTS:
            bar = progress.add_task(f"the same with {effect}", total=1.0)
            told = partial(_told, progress, bar)
            added.append((AddedLattice(effect, records, told), with_effect(effect)))
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
    result = stamp({"baseline": asdict(BLIND)}, [find(name, records) for name in RECORDS])
    result |= {
        "models": rows,
        "slip_and_friction": [
            row(one, name, freedom) for one, named in added for name, freedom in named.items()
        ],
        **judged_together([(lattice, models)]),
        "with_slip_and_friction": judged_together([(lattice, models), *added]),
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
    yield _peaks("Table 4.1: mean |ours - measured| / measured [%]", result["models"])
    yield _peaks("The same with slip or friction", result["slip_and_friction"])
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
    theirs = result["sap2000"]
    yield f"SAP2000 as printed: 58 peaks {100 * theirs['all_58']:.1f} %, 64 peaks {100 * theirs['all_64']:.1f} %."
    yield from _together("Models without slip and friction: ", result)
    yield from _together("With slip and friction among the models: ", result["with_slip_and_friction"])


def _together(start: str, judged: dict[str, Any]) -> Iterable[str]:
    inside, mean = judged["picked_inside"], judged["averaged"]
    yield (
        f"{start}with the model itself picked inside each split {100 * inside['halves_58']:.1f} % of 58 peaks, "
        f"{100 * inside['halves_64']:.1f} % of 64 ({'; '.join(inside['models'])})."
    )
    yield (
        f"{start}with the weighted median of all models, weighted by the fitted peaks: 58 peaks, two of four records "
        f"{100 * mean['halves_58']:.1f} %, three of four {100 * mean['three_58']:.1f} %, all fitted "
        f"{100 * mean['all_58']:.1f} %; 64 peaks {100 * mean['halves_64']:.1f} and {100 * mean['three_64']:.1f} %."
    )


def _peaks(title: str, rows: Sequence[dict[str, Any]]) -> Any:
    keys = ("all_58", "halves_58", "three_58", "frames_58", "all_64", "halves_64")
    heads = ["model", "fitted", "all", "2 of 4 records", "3 of 4", "one frame", "64: all", "64: 2 of 4"]
    lines = [
        [one["model"], str(one["fitted"]), *(f"{100 * one[key]:.1f}" for key in keys), _setting(one)]
        for one in rows
    ]
    return table(f"{title}: 58 uncontested peaks, and all 64", [*heads, "fitted to 58"], lines)


def _told(progress: Progress, bar: TaskID, share: float) -> None:
    progress.update(bar, completed=share)


def _setting(one: dict[str, Any]) -> str:
    """Return fitted numbers and states in words."""
    numbers = {name: value for name, value in one["numbers"].items() if value is not None}
    said = [_SHOWN[name](value) for name, value in numbers.items()]
    short: dict[Frequency, str] = {"free vibration": "f", "sweep": "s", "unequal pair": "u"}
    letters = " ".join(f"{name} {short[state]}" for name, state in one["states"].items())
    return f"{', '.join(said)}; {letters}"


_SHOWN: dict[str, Callable[[Any], str]] = {
    "damping": lambda ratio: f"damping {100 * ratio:.2g} %",
    "factor": lambda factor: f"f x {factor:.3g}",
    "gain": lambda gain: f"gain {gain:.3g}",
    "slip": lambda slip: f"{100 * slip[0]:.0f} % slips at {slip[1]:.2g} mm",
    "friction": lambda force: f"friction {force:.2g} N",
}


if __name__ == "__main__":
    run_script(main)
