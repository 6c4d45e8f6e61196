"""How much of a null's motion the diagnosis leaves beyond the noise, against what the best linear frame leaves.

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
from pounding.diagnosis.inference.null_model import best_null, unswapped
from pounding.diagnosis.inference.refine import refine
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


def left(case: Case) -> np.ndarray:
    """Misfit of every channel after the diagnosis' calibration over the runs that it uses, with the noise."""
    structure = Structure(baseline_frames(case))
    model = Model(structure, screened(observe(case, structure)), case.prior)
    numbers = {run.file: i for i, run in enumerate(case.runs)}
    training = [numbers[run.file] for run in case.split()[0]]
    null = best_null(model, refine(model, calibrated(model, training)))
    model, null = unswapped(model, null, training)
    misfits = fit_misfits(model, null.filtered, tuple(training))
    return np.array(
        [value for name, value in zip(model.observed.names, misfits, strict=True) if name != "table"]
    )


def main() -> None:
    """Print a line a case."""
    seed = int(sys.argv[1])
    skip = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    print("frame  noise  asked  linear_frame  left  left_over_linear  seconds", flush=True)
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
            beyond = np.sqrt(np.maximum(left(read_case(Path(folder, "case"))) ** 2 - noise**2, 0.0))
        found, seconds = float(np.median(beyond)), time.process_time() - start
        linear = hidden.truth["model_error"]["misfit"]
        print(
            f"{name:5s} {noise:6.3f} {error:6.3f} {linear:9.4f} {found:11.4f} {found / linear:10.2f} {seconds:14.0f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
