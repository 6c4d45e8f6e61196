"""How far the storeys of a frame went beyond their yield in a run, and what is left of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from pounding.experiments.rig.drifts import storey_drift, storey_row
from pounding.experiments.rig.motion import FrameMotion
from pounding.frames.yielding import storey_yields


def ductilities(motion: FrameMotion) -> list[dict[str, Any]]:
    """Return each yielding storey's ductility and what is left of its drift; none for a frame that is linear.

    Args:
        motion: Motion of the frame.

    Returns:
        For each storey `storey`, `ductility` (largest drift over yield drift), `yield_drift_mm`, and
        `plastic_drift_mm` at the end of the run.
    """
    yields = storey_yields(motion.reduced)
    if not yields:
        return []
    # The compiler of laws takes a while to load, which a linear frame need not wait for.
    from pounding.experiments.rig.yielding import plastic_drift

    found = []
    for one in yields:
        drift, rate = storey_drift(motion, storey_row(motion.reduced, one.storey))
        found.append(
            {
                "storey": one.storey,
                "ductility": float(np.abs(drift).max()) / one.drift_m,
                "yield_drift_mm": 1e3 * one.drift_m,
                "plastic_drift_mm": 1e3 * float(plastic_drift(one, drift, rate, motion.time_s)[-1]),
            }
        )
    return found


def ductility_sentence(name: str, rows: Sequence[dict[str, Any]]) -> Iterable[str]:
    """Say which storeys of a frame yielded; nothing of a frame that is linear.

    Args:
        name: Name of the frame.
        rows: What `ductilities` gives.
    """
    beyond = [row for row in rows if row["ductility"] > 1.0]
    if beyond:
        yield f"{name}, storeys that yielded (ductility, drift left): " + ", ".join(
            f"{row['storey']} ({row['ductility']:.2f}, {row['plastic_drift_mm']:.2f} mm)" for row in beyond
        )
    elif rows:
        largest = max(row["ductility"] for row in rows)
        yield f"{name}: no storey yielded; the largest drift is {largest:.2f} of the yield drift"
