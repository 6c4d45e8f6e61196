"""How far the storeys of a frame went beyond their yield in a run, and what is left of it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.motion import FrameMotion
from pounding.frames.yielding import storey_yields

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


def ductilities(motion: FrameMotion) -> list[dict[str, Any]]:
    """Return each yielding storey's ductility and what is left of its drift; none for a frame that is linear.

    Args:
        motion: Motion of the frame.

    Returns:
        For each storey `storey`, `ductility` (largest drift over yield drift), `yield_drift_mm`, and
        `plastic_drift_mm` at the end of the run.
    """
    found = []
    for one in storey_yields(motion.reduced):
        drift, _ = storey_drift(motion, storey_row(motion.reduced, one.storey))
        found.append(
            {
                "storey": one.storey,
                "ductility": float(np.abs(drift).max()) / one.drift_m,
                "yield_drift_mm": 1e3 * one.drift_m,
                "plastic_drift_mm": 1e3 * float(plastic_drift(drift, one.drift_m)[-1]),
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


def plastic_drift(drift: Real, limit: float) -> Real:
    """Return the plastic drift (m,) [m] along a drift (m,) [m] that begins at rest, for a yield drift [m]."""
    found, plastic = [], 0.0
    for one in drift.tolist():
        plastic = min(max(plastic, one - limit), one + limit)
        found.append(plastic)
    return np.array(found)


def storey_drift(motion: FrameMotion, row: Real) -> tuple[Real, Real]:
    """Return a drift (m,) [m] and its rate (m,) [m/s] through a run.

    Args:
        motion: Motion of the frame.
        row: What the floors' displacements contribute to the drift (storeys,).
    """
    floors = motion.reduced.floor_x
    return motion.displacement_m[:, floors] @ row, motion.velocity_m_s[:, floors] @ row


def storey_row(frame: ReducedFrame, storey: int) -> NDArray[np.float64]:
    """Return what the floors' displacements contribute to a storey's drift (storeys,).

    Args:
        frame: The frame.
        storey: Its storey, from 1.
    """
    row = np.zeros(frame.storeys)
    row[storey - 1] = 1.0
    if storey > 1:
        row[storey - 2] = -1.0
    return row
