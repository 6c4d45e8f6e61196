"""Cost of many pounding runs by the exact solver, over runs and workers.

Two sticks of 10 storeys under the 44 far-field components of FEMA P695, each at a peak of 0.35 g, with gaps from
30 to 60 mm:
`python tests/benchmarks/many_records_cost.py --out docs/validation/many-records-cost.json`.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path

from pounding.contact.parameters import make_law
from pounding.experiments.records.sets import record_set
from pounding.experiments.rig.contacts import Contact
from pounding.experiments.rig.many import Case, many
from pounding.frames import ReducedFrame, StickFrame, build

RUNS = (10, 100, 1000)
WORKERS = (1, 2)
PGA_G = 0.35


def stick(name: str, first_hz: float) -> ReducedFrame:
    """Return a stick of 10 storeys."""
    return build(
        StickFrame(
            name=name,
            storeys=10,
            storey_height_m=3.2,
            floor_mass_kg=[300e3] * 10,
            frequency_hz=[first_hz],
            damping_ratio=0.05,
        )
    )


def cases(count: int) -> Iterator[Case]:
    """Return so many runs: each record in turn, the gap widened a little after each round."""
    row = stick("left", 0.9), stick("right", 1.25)
    law = make_law("linear_viscoelastic", stiffness=3.75e9, restitution=0.65, masses=(3e5, 3e5))
    records = [record.scaled(1.0, PGA_G) for record in record_set("fema-p695-farfield")]
    for number in range(count):
        record = records[number % len(records)]
        gap_m = 0.03 + 0.03 * (number // len(records)) / max(1, count // len(records))
        yield Case(row, (Contact(law, gap_m, 10),), record.acceleration_m_s2, record.step_s)


def main() -> None:
    """Write wall and processor time for each number of runs and workers."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, required=True)
    list(many(cases(2)))  # loads the compiled loop
    rows = []
    for workers in WORKERS:
        for count in RUNS:
            begun, worked = time.perf_counter(), time.process_time()
            found = list(many(cases(count), workers=workers))
            rows.append(
                {
                    "runs": count,
                    "workers": workers,
                    "wall_s": time.perf_counter() - begun,
                    "processor_s": time.process_time() - worked,
                    "touching": sum(bool(one.touches.sum()) for one in found),
                    "steps": sum(one.steps for one in found),
                }
            )
            print(
                "{runs} runs, {workers} workers: {wall_s:.2f} s, {processor_s:.2f} CPU s".format(**rows[-1])
            )
    parser.parse_args().out.write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
