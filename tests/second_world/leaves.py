"""How much of a null's motion the diagnosis leaves beyond the noise, against what the calibrated frame leaves.

`python -m tests.second_world.leaves SEED [SKIP]` (needs openseespy) hides nothing in eight frames with model errors of
several sizes and little noise, calibrates the baseline model to each as the diagnosis does, and prints a line a case:
shares of the motion. The first SKIP cases are left out. docs/diagnosis/hidden-cases.md has what it found.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from pounding.diagnosis.case.case import Case
from pounding.diagnosis.case.reading import read_case
from pounding.diagnosis.hidden.hide import hide
from pounding.diagnosis.hidden.writing import write_hidden
from pounding.diagnosis.inference.findings import fit_misfits
from pounding.diagnosis.inference.null_model import best_null, by_its_motion, unswapped
from pounding.diagnosis.inference.refine import Fit
from pounding.diagnosis.inference.starting import calibrated
from pounding.diagnosis.model.frames import baseline_frames
from pounding.diagnosis.model.model import Model
from pounding.diagnosis.model.observations import observe
from pounding.diagnosis.model.sensors import screened
from pounding.diagnosis.model.storeys import Structure

DURATION_S = 4.0
SET = (
    ("5A", 0.001, 0.005),
    ("5B", 0.002, 0.01),
    ("10", 0.002, 0.02),
    ("5A", 0.002, 0.03),
    ("5B", 0.002, 0.02),
    ("15A", 0.002, 0.01),
    ("15B", 0.002, 0.03),
    ("10", 0.002, 0.01),
)
"""Frame, noise and model error of each case. Little noise: that of the table channel moves the model, too."""


def left(case: Case, noise: float) -> tuple[float, float]:
    """Misfit beyond the noise, median over the channels: of the likeliest model, and of the one by its motion."""
    structure = Structure(baseline_frames(case))
    model = Model(structure, screened(observe(case, structure)), case.prior)
    numbers = {run.file: i for i, run in enumerate(case.runs)}
    training = [numbers[run.file] for run in case.split()[0]]
    null = best_null(model, calibrated(model, training))
    model, null = unswapped(model, null, training)
    ours = np.array([name != "table" for name in model.observed.names])

    def beyond(fit: Fit) -> float:
        misfits = fit_misfits(model, fit.filtered, tuple(training))[ours]
        return float(np.median(np.sqrt(np.maximum(misfits**2 - noise**2, 0.0))))

    return beyond(null), beyond(by_its_motion(model, null))


def main() -> None:
    """Print a line a case."""
    seed = int(sys.argv[1])
    skip = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    print("frame  noise  asked  calibrated  likeliest  by_its_motion  over_calibrated  seconds", flush=True)
    for number, (name, noise, error) in list(enumerate(SET))[skip:]:
        start = time.process_time()
        hidden = hide(
            [],
            [name],
            seed=seed + number,
            source="artificial",
            duration_s=DURATION_S,
            engine="opensees",
            noise=noise,
            model_error=error,
        )
        with tempfile.TemporaryDirectory() as folder:
            write_hidden(hidden, Path(folder, "case"))
            likeliest, moved = left(read_case(Path(folder, "case")), noise)
        seconds = time.process_time() - start
        stated = hidden.truth["model_error"]["misfit"]
        sizes = f"{stated:12.4f} {likeliest:12.4f} {moved:13.4f} {moved / stated:12.2f}"
        print(f"{name:5s} {noise:6.3f} {error:6.3f} {sizes} {seconds:8.0f}", flush=True)


if __name__ == "__main__":
    main()
