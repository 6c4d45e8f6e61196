"""What is compiled first where several processes test: each compiles a part, and finds the other's on the disk.

Otherwise all of them compile all of it, more than a minute each in a fresh clone.
"""

from __future__ import annotations

import numpy as np

from pounding import frames
from pounding.experiments.records import Record
from pounding.experiments.rig.rig import Rig
from pounding.frames.definition import Yielding


def compiled_by(worker: str | None) -> None:
    """Compile a worker's part.

    Args:
        worker: The worker's name; nothing is compiled for those after the second one, nor where nobody shares the work.
    """
    if worker not in ("gw0", "gw1"):
        return
    # Imported by both, whoever needs it.
    from tests.diagnosis.inference.problems import PROBLEMS

    if worker == "gw0":
        _shaken(None)
        PROBLEMS[0].fitted(1.0)
    else:
        _shaken(Yielding(storey_shear_n=1e3))


def _shaken(yielding: Yielding | None) -> None:
    frame = frames.build(
        frames.StickFrame(
            name="oscillator",
            storeys=1,
            storey_height_m=0.1,
            floor_mass_kg=[6.0],
            storey_stiffness_n_per_m=[5e3],
            damping_ratio=0.02,
            yielding=yielding,
        )
    )
    Rig([frame]).run(Record("short", np.sin(np.arange(20.0)), 0.01), solver="exact")
