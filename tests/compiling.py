"""What is compiled first where several processes test: each compiles a part of the exact solver, and finds the other's.

Otherwise all of them compile all of it, most of a minute each in a fresh clone. All import the same, as the order of
tests may follow from that of imports.
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
    if worker == "gw0":
        _shaken(None)
    elif worker == "gw1":
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
