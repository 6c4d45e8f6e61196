"""Laws in storeys by the exact solver beside exudyn: how far the two agree, law by law, and what each costs.

Two tables: a small frame alone and a pair at exudyn's tight tolerance (largest difference of a floor's peak, touches, energy
balance, processor seconds), and the twin of a measured pair (`simulate_pair`) at the tolerance that is used there. Times
are the best of some runs, so that what else runs on the machine counts little.

    python -m tests.benchmarks.storey_laws
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from unittest import mock

import numpy as np
from rich.console import Console
from rich.table import Table

from pounding.diagnosis.effects.candidates import kinds
from pounding.diagnosis.effects.catalogue import places
from pounding.diagnosis.model import twin
from pounding.diagnosis.model.model import Model
from pounding.experiments.rig.motion import Motion
from tests.diagnosis.model.test_exact_storeys import LAWS, PLACED, engine, exact, peaks
from tests.diagnosis.model.test_twin_pair import EFFECTS, refused, simulated
from tests.diagnosis.pair_models import CONTACT, colliding, model_of

REPEATS = 5


def timed(run: Callable[[], Any], repeats: int) -> tuple[float, Any]:
    """Return the least processor time [s] of some runs, and what the last one left."""
    best = np.inf
    for _ in range(repeats):
        started = time.process_time()
        left = run()
        best = min(best, time.process_time() - started)
    return best, left


def touches(motion: Motion) -> int:
    """Return how often anything touched."""
    return sum(len(one.touches[0]) for one in motion.contacts)


def alone_and_pair() -> Table:
    """Return the table of a frame alone and a pair, at exudyn's tight tolerance."""
    shown = Table("law", "frames", "peaks", "touches", "energy", "exact [s]", "exudyn [s]")
    for pair in (False, True):
        for name, placed in PLACED.items():
            law = LAWS[name]
            exact(law, placed, pair)
            own_s, mine = timed(lambda law=law, placed=placed, pair=pair: exact(law, placed, pair), REPEATS)
            engine_s, other = timed(lambda law=law, placed=placed, pair=pair: engine(law, placed, pair), 1)
            off = float(np.abs(peaks(mine) / peaks(other) - 1.0).max())
            counts = f"{touches(mine)}, {touches(other)}"
            shown.add_row(
                name,
                "pair" if pair else "alone",
                f"{off:.1e}",
                counts,
                f"{mine.energy.error:.1e}",
                f"{own_s:.4f}",
                f"{engine_s:.3f}",
            )
    return shown


def twins() -> Table:
    """Return the table of a measured pair's twin."""
    shown = Table("effect", "rms of channels", "exact [s]", "exudyn [s]", "ratio")
    model = model_of(colliding(CONTACT, measured=False))
    model = Model(model.structure, replace(model.observed, runs=model.observed.runs[:1]), model.prior)
    for name, values in {"none": None, **EFFECTS}.items():
        acting = []
        if values is not None:
            effect = next(one for kind in kinds() if kind.name == name for one in places(kind, model))
            acting = [(effect, np.array(values))]

        def run(acting: Any = acting) -> tuple[np.ndarray, np.ndarray]:
            return simulated(model, acting)

        run()
        with mock.patch.object(twin, "Rig", refused):
            own_s, mine = timed(run, REPEATS)
        with mock.patch.object(twin, "_exact", refused):
            engine_s, other = timed(run, 2)
        off = max(
            np.sqrt(np.mean((a - b) ** 2) / np.mean(b**2)) for a, b in zip(mine[0].T, other[0].T, strict=True)
        )
        shown.add_row(name, f"{off:.1e}", f"{own_s:.4f}", f"{engine_s:.3f}", f"{engine_s / own_s:.1f}")
    return shown


if __name__ == "__main__":
    console = Console(width=110)
    console.print(alone_and_pair())
    console.print(twins())
