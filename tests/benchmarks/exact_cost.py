"""What the exact solver costs, beside exudyn and beside the same modes without contact, in one run.

Processor seconds per simulated second, the best of some runs, so that what else runs on the machine counts little. The
base case is 15B beside 5B under El Centro, one contact, the linear viscoelastic law. Then one thing varies at a time, and
last come thousands of runs at once: two ten-storey buildings at full scale.

    python tests/benchmarks/exact_cost.py --out docs/validation/exact-cost.json --picture docs/_static/exact-cost.png
"""

from __future__ import annotations

import argparse
import json
import resource
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from rich.console import Console
from rich.table import Table

from pounding import frames
from pounding.contact import LinearViscoelastic, thesis_law
from pounding.contact.parameters import PRINTED
from pounding.experiments.records import find
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.exact import ExactRig, longest_step
from pounding.experiments.rig.many import Case, many
from pounding.experiments.rig.pounding import built, shaking
from pounding.experiments.rig.rig import Rig
from pounding.frames.response.exact import poles, refine, run

mpl.use("Agg")
from matplotlib import pyplot as plt

RECORD, LAW, GAP_M, REPEATS = "elcentro", "linear_viscoelastic", 9.5e-3, 15
STEEL_FLOORS_KG, BUILDING_HZ = 2.5e5, (0.8, 1.1)


def best(measure: Callable[[], float], repeats: int = REPEATS) -> float:
    """Return the least of several measurements, the first of which compiles what is not compiled yet."""
    measure()
    return min(measure() for _ in range(repeats))


def solving(row: Sequence[frames.ReducedFrame], contacts: Sequence[Contact]) -> dict[str, Any]:
    """Return the cost of a run by the exact solver, with and without reading the whole motion from it."""
    record = shaking(RECORD)
    rig = ExactRig(row, contacts)

    def solve() -> float:
        started = time.thread_time()
        rig.solve(record.acceleration_m_s2, record.step_s)
        return time.thread_time() - started

    def whole() -> float:
        started = time.thread_time()
        rig.motion(rig.solve(record.acceleration_m_s2, record.step_s), (0.0, 0.0))
        return time.thread_time() - started

    motion = rig.motion(rig.solve(record.acceleration_m_s2, record.step_s), (0.0, 0.0))
    return {
        "poles": len(rig.rates),
        "contacts": len(contacts),
        "steps": motion.steps,
        "touches": sum(len(history.pulses) for history in motion.contacts),
        "solve_s_per_s": best(solve) / record.duration_s,
        "with_motion_s_per_s": best(whole, 5) / record.duration_s,
    }


def base() -> dict[str, Any]:
    """15B beside 5B: the exact solver, exudyn, and a bare recursion of the same modes over the same longest steps."""
    row, record = [built("15B"), built("5B")], shaking(RECORD)
    contacts = [Contact(thesis_law(LAW), GAP_M, 5)]
    found = solving(row, contacts)
    motion = min((Rig(row, contacts).run(record) for _ in range(3)), key=lambda one: one.processor_s)
    parts = int(np.ceil(record.step_s / longest_step(row)))
    history, rates = refine(record.acceleration_m_s2, parts), [poles(frame).rates for frame in row]

    def recursion() -> float:
        started = time.thread_time()
        for one in rates:
            run(one, history, record.step_s / parts)
        return time.thread_time() - started

    exudyn, bare = motion.processor_s / record.duration_s, best(recursion) / record.duration_s
    return found | {
        "gap_mm": 1e3 * GAP_M,
        "exudyn_s_per_s": exudyn,
        "exudyn_steps": motion.steps,
        "bare_recursion_s_per_s": bare,
        "faster_than_exudyn": exudyn / found["solve_s_per_s"],
        "times_the_bare_recursion": found["solve_s_per_s"] / bare,
    }


def stick(
    storeys: int, name: str, hz: float, floor_kg: float = 6.5, height_m: float = 0.1
) -> frames.ReducedFrame:
    """Return a shear building with equal floors."""
    return frames.build(
        frames.StickFrame(
            name=name,
            storeys=storeys,
            storey_height_m=height_m,
            floor_mass_kg=[floor_kg] * storeys,
            frequency_hz=[hz],
            damping_ratio=0.02,
        )
    )


def modes() -> Iterator[tuple[str, dict[str, Any]]]:
    """Pairs of sticks with ever more floors and the same first frequencies; one contact at the lower roof."""
    for count in (10, 20, 40, 80):
        pair = [stick(count, "left", 2.3), stick(count, "right", 3.1)]
        yield f"{2 * count}", solving(pair, [Contact(thesis_law(LAW), GAP_M, count)])


def contacts() -> Iterator[tuple[str, dict[str, Any]]]:
    """15B beside 10, contacts from the lower roof downwards."""
    for count in (1, 2, 5, 10):
        floors = [Contact(thesis_law(LAW), 6e-3, 10 - down) for down in range(count)]
        yield f"{count}", solving([built("15B"), built("10")], floors)


def laws() -> Iterator[tuple[str, dict[str, Any]]]:
    """The base case with each law."""
    for name in PRINTED:
        yield name, solving([built("15B"), built("5B")], [Contact(thesis_law(name), GAP_M, 5)])


def thousands(runs: int) -> dict[str, Any]:
    """Run two ten-storey buildings at full scale many times, 20 s each: other gaps, other strengths of the shaking."""
    pair = [stick(10, f"{hz} Hz", hz, STEEL_FLOORS_KG, 3.0) for hz in BUILDING_HZ]
    record = find(RECORD).scaled(1.0)
    history = record.acceleration_m_s2[: round(20.0 / record.step_s) + 1]
    law = LinearViscoelastic(1e9, damping=1e6)

    def cases() -> Iterator[Case]:
        for place in np.linspace(0.0, 1.0, runs):
            yield Case(pair, [Contact(law, 0.02 + 0.1 * place, 10)], (0.5 + place) * history, record.step_s)

    list(many(list(cases())[:4]))
    started, worked, touched = time.perf_counter(), time.process_time(), 0
    for outcome in many(cases()):
        touched += int(outcome.touches[0] > 0)
    return {
        "runs": runs,
        "model_s": 20.0 * runs,
        "that_touch": touched,
        "wall_s": time.perf_counter() - started,
        "processor_s": time.process_time() - worked,
        "largest_memory_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }


def slope(rows: dict[str, dict[str, Any]], key: str) -> float:
    """Return the exponent of the cost over a number, by least squares of the logarithms."""
    x, y = ([float(row[name]) for row in rows.values()] for name in (key, "solve_s_per_s"))
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def show(result: dict[str, Any], console: Console) -> None:
    """Print the result."""
    one = result["base"]
    console.print(
        f"15B beside 5B, {one['touches']} touches: exact {one['solve_s_per_s']:.5f} CPU s per simulated s "
        f"({one['with_motion_s_per_s']:.5f} with the whole motion), exudyn {one['exudyn_s_per_s']:.3f}: "
        f"{one['faster_than_exudyn']:.0f} times; {one['times_the_bare_recursion']:.1f} times the bare recursion"
    )
    for axis in ("modes", "contacts", "laws"):
        table = Table(axis, "poles", "steps", "touches", "CPU s / simulated s")
        for name, row in result[axis].items():
            table.add_row(
                name, f"{row['poles']}", f"{row['steps']}", f"{row['touches']}", f"{row['solve_s_per_s']:.5f}"
            )
        console.print(table)
    console.print(f"cost grows with the power {result['exponent_modes']:.2f} of the modes")
    console.print(f"cost grows with the power {result['exponent_contacts']:.2f} of the contacts")
    all_ = result["thousands"]
    console.print(
        f"{all_['runs']} runs of 20 s, {all_['that_touch']} of which touch: {all_['wall_s']:.0f} s, "
        f"{all_['processor_s']:.0f} s of CPU time, {all_['largest_memory_gb']:.2f} GB"
    )


def picture(result: dict[str, Any], path: Path) -> None:
    """Draw the cost over modes and contacts."""
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.4), sharey=True, layout="constrained")
    for axis, key, label, place in zip(
        ("modes", "contacts"), ("poles", "contacts"), ("modes", "contacts, 15B beside 10"), axes, strict=True
    ):
        rows = result[axis].values()
        place.loglog(
            [row[key] for row in rows], [row["solve_s_per_s"] for row in rows], "o-", label="exact solver"
        )
        place.axhline(result["base"]["exudyn_s_per_s"], color="0.5", ls="--", label="exudyn, 15B beside 5B")
        place.set_xlabel(label)
        place.set_xticks([row[key] for row in rows], [str(row[key]) for row in rows])
        place.minorticks_off()
        place.grid(alpha=0.3)
    axes[0].set_ylabel("CPU s per simulated s")
    axes[0].legend()
    figure.savefig(path, dpi=120)


def main() -> None:
    """Measure, print, and write where asked."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--runs", type=int, default=10_000, help="runs at once")
    parser.add_argument("--out", type=Path, help="JSON file")
    parser.add_argument("--picture", type=Path, help="PNG file")
    chosen = parser.parse_args()
    result: dict[str, Any] = {"base": base()}
    result |= {axis.__name__: dict(axis()) for axis in (modes, contacts, laws)}
    result["exponent_modes"] = slope(result["modes"], "poles")
    result["exponent_contacts"] = slope(result["contacts"], "contacts")
    result["thousands"] = thousands(chosen.runs)
    show(result, Console(width=110))
    if chosen.out:
        chosen.out.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    if chosen.picture:
        picture(result, chosen.picture)


if __name__ == "__main__":
    main()
