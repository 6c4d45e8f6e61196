"""What a film of half a minute costs: 15B beside 5B under El Centro, slowed until it fills the time.

Wall seconds, processor seconds of all processes (which a busy machine lengthens less) and the largest memory of
one process. The run itself is not counted.

    python tests/benchmarks/film_cost.py --records RECORDS --out docs/validation/film-cost.json
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import tempfile
import time
from pathlib import Path

from rich.console import Console

from pounding import frames
from pounding.contact import thesis_law
from pounding.cores import cores
from pounding.experiments.pictures.films import LONGEST_S, film
from pounding.experiments.rig.pounding import pound, shaking

GAP_M = 9.5e-3


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--records", help="folder with elcentro.csv; POUNDING_RECORDS without it")
    parser.add_argument("--film", type=Path, help="where to keep the film")
    parser.add_argument("--out", type=Path, help="JSON file for the numbers")
    chosen = parser.parse_args()
    left, right = (frames.build(frames.load(name)) for name in ("15B", "5B"))
    run = pound(left, right, shaking("elcentro", chosen.records), thesis_law("linear_viscoelastic"), GAP_M)
    with tempfile.TemporaryDirectory() as folder:
        path = chosen.film or Path(folder) / "film.mp4"
        before, began = os.times(), time.perf_counter()
        made = film(run.motion, path, speed=run.motion.model_s / LONGEST_S[".mp4"])
        after, wall = os.times(), time.perf_counter() - began
        size = path.stat().st_size
    row = {
        "film_s": made.length_s,
        "images": made.images,
        "cores": cores(),
        "wall_s": round(wall, 1),
        "cpu_s": round(sum(after[:4]) - sum(before[:4]), 1),
        "largest_process_mb": round(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1e3),
        "file_mb": round(size / 1e6, 1),
        "load": os.getloadavg()[0],
    }
    Console().print(row)
    if chosen.out:
        chosen.out.write_text(json.dumps(row, indent=1) + "\n")


if __name__ == "__main__":
    main()
