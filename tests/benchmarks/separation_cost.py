"""What a required gap costs: many cases by the exact recursion, beside one by one in the engine and in
OpenSees.

Processor seconds, so that what else runs on the machine does not count; wall times where processes share the
work.

    pip install openseespy        # not a dependency: its licence does not let everyone redistribute it
    python tests/benchmarks/separation_cost.py --out cost.json --picture separation-cost.png
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parent))
from opensees_model import lumped
from opensees_model import run as run_opensees

from pounding import frames
from pounding.experiments.records import Record, find
from pounding.experiments.rig.required_gap import pair_gap
from pounding.experiments.rig.rig import Rig
from pounding.experiments.separation.chapter_7.parametric import Variant, design_of_cases, pair_gaps, study
from pounding.scale import THESIS

RECORD = "elcentro"
COUNTS = (1, 10, 100, 407)
PAIRS = (("8", "5B"), ("10", "5B"), ("12", "8"), ("15B", "10"))
LABELS = ("elcentro", "hachinohe", "kobe", "northridge")
OPENSEES_STEPS_S = (4e-4, 2e-4)


def timed(work: Callable[[], object]) -> tuple[float, float]:
    """Return processor and wall seconds of a call."""
    cpu, wall = time.process_time(), time.perf_counter()
    work()
    return time.process_time() - cpu, time.perf_counter() - wall


def built(name: str) -> frames.ReducedFrame:
    """Return a frame of the thesis."""
    return frames.build(frames.load(name))


def against_cases(record: Record) -> list[dict]:
    """Cost over the number of cases, 15B beside 10."""
    tall, short, cases = built("15B"), built("10"), design_of_cases()
    rows = []
    for count in COUNTS:
        cpu, _ = timed(lambda count=count: pair_gaps(tall, short, record, cases[:count]))
        rows.append(
            {
                "what": "cases",
                "pair": "15B-10",
                "cases": count,
                "cpu_s": cpu,
                "ms_per_case": 1e3 * cpu / count,
            }
        )
    return rows


def against_storeys(record: Record) -> list[dict]:
    """Cost of 407 cases over the number of storeys."""
    rows = []
    for tall, short in PAIRS:
        one, other = built(tall), built(short)
        cpu, _ = timed(lambda one=one, other=other: pair_gaps(one, other, record, design_of_cases()))
        rows.append(
            {
                "what": "storeys",
                "pair": f"{tall}-{short}",
                "cases": 407,
                "cpu_s": cpu,
                "ms_per_case": cpu / 0.407,
            }
        )
    return rows


def against_workers() -> list[dict]:
    """Wall time of the four test motions (4,884 cases) over the number of processes."""
    rows = []
    for workers in (0, 1, 2):
        _, wall = timed(lambda workers=workers: study(LABELS, workers=workers))
        rows.append({"what": f"workers {workers}", "pair": "all", "cases": 4884, "wall_s": wall})
    return rows


def one_by_one(record: Record) -> list[dict]:
    """One case in the engine, in OpenSees at two steps, and by the recursion, with the gap of each."""
    tall, short = built("15B"), built("10")
    exact = pair_gaps(tall, short, record, [(Variant(), Variant())]).iloc[0]["gap_mm"]
    cpu, _ = timed(lambda: pair_gap(tall, short, record))
    rows = [{"what": "recursion, one case", "pair": "15B-10", "cases": 1, "cpu_s": cpu, "gap_mm": exact}]
    motion = None

    def engine() -> None:
        nonlocal motion
        motion = Rig([tall, short]).run(record)

    cpu, _ = timed(engine)
    apart = motion.frames[0].floor_displacement(10) - motion.frames[1].floor_displacement(10)
    rows.append(
        {
            "what": "exudyn, one case",
            "pair": "15B-10",
            "cases": 1,
            "cpu_s": cpu,
            "gap_mm": 1e3 * np.abs(apart).max(),
        }
    )
    left = lumped(np.full(15, tall.moving_mass_kg / 15), tall.frequencies_hz[0], tall.damping_ratio)
    right = lumped(np.full(10, short.moving_mass_kg / 10), short.frequencies_hz[0], short.damping_ratio)
    for step in OPENSEES_STEPS_S:
        found = None

        def opensees(step: float = step) -> None:
            nonlocal found
            found = run_opensees(
                left, right, floor=10, gap_m=1.0, law="linear_spring", numbers={"stiffness": 1.0},
                acceleration_m_s2=np.asarray(record.acceleration_m_s2), sample_s=record.step_s,
                step_s=step, duration_s=record.duration_s, integrator="Newmark",
            )  # fmt: skip

        cpu, _ = timed(opensees)
        gap = 1e3 * np.abs(found.left_m[:, 9] - found.right_m[:, 9]).max()
        rows.append(
            {
                "what": f"OpenSees, Newmark {step:g} s",
                "pair": "15-10 lumped",
                "cases": 1,
                "cpu_s": cpu,
                "gap_mm": gap,
            }
        )
    return rows


def picture(rows: list[dict], path: Path) -> None:
    """Draw processor time a case: one case by each program, then over the number of cases and of storeys."""
    figure = Figure(figsize=(10.0, 3.4), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    single = [row for row in rows if "gap_mm" in row]
    names = [row["what"].replace(", one case", "").replace(", Newmark ", ",\n") for row in single]
    _bars(left, names, [1e3 * row["cpu_s"] for row in single])
    left.set_yscale("log")
    left.set_ylim(1, 1e4)
    left.set_title("one case, 15B beside 10", loc="left", fontsize=10)
    many = [row for row in rows if row["what"] == "cases"]
    middle.loglog([row["cases"] for row in many], [row["ms_per_case"] for row in many], "o-", color="#1f4e79")
    middle.set_xlabel("cases")
    middle.set_title("recursion, many cases", loc="left", fontsize=10)
    heights = [row for row in rows if row["what"] == "storeys"]
    _bars(right, [row["pair"] for row in heights], [row["ms_per_case"] for row in heights])
    right.set_title("407 cases of other heights", loc="left", fontsize=10)
    left.set_ylabel("CPU time per case [ms]")
    for axis in (left, middle, right):
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(axis="y", color="#dddddd")
        axis.set_axisbelow(True)
    figure.savefig(path, dpi=80)


def _bars(axis: Axes, names: list[str], values: list[float]) -> None:
    bars = axis.bar(range(len(values)), values, color="#1f4e79")
    axis.bar_label(bars, [f"{value:.2f}" if value < 1 else f"{value:.0f}" for value in values], fontsize=8)
    axis.set_xticks(range(len(values)), names, fontsize=8)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--records", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--picture", type=Path)
    asked = parser.parse_args()
    record = find(RECORD, asked.records).scaled(THESIS.time_factor)
    pair_gap(built("10"), built("5B"), record)  # what is loaded once is not counted
    rows = [*one_by_one(record), *against_cases(record), *against_storeys(record), *against_workers()]
    columns = ("what", "pair", "cases", "cpu_s", "wall_s", "ms_per_case", "gap_mm")
    shown = Table(*columns)
    for row in rows:
        shown.add_row(
            *(
                "" if c not in row else f"{row[c]:.4g}" if isinstance(row[c], float) else str(row[c])
                for c in columns
            )
        )
    Console(width=120).print(shown)
    if asked.picture:
        picture(rows, asked.picture)
    if asked.out:
        asked.out.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
