"""Storeys that yield, as laws of the rig: what a frame's file says of it, run by either solver, and the ductility.

A storey with stiffness k that yields at the drift y has a plastic drift p, which keeps the elastic part d - p within
-y and y. The linear frame already has k d; the law adds what yielding takes away, -(1 - h) k p with the share h of
hardening. This is the return mapping of one-dimensional plasticity with kinematic hardening (Simo and Hughes,
*Computational Inelasticity*, 1998, chapter 1), exact for any step as long as the drift does not turn within it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from pounding.calling import PARAMETERS, entry
from pounding.experiments.rig.motion import FrameMotion, StoreyHistory
from pounding.experiments.rig.storeys import StoreyLaw, history_of
from pounding.frames.yielding import StoreyYield, storey_yields

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


def plastic_force(p: Any, state: Any, d: float, v: float, t: float, new: Any) -> float:
    """Return what yielding takes away from a storey's elastic force [N]; it remembers the plastic drift [m].

    Args:
        p: Stiffness that yields [N/m] and yield drift [m].
        state: Plastic drift before [m].
        d: Drift [m].
        v: Its rate [m/s], which does not matter.
        t: Time [s], which does not matter.
        new: Gets the plastic drift at this drift [m].
    """
    plastic = state[0]
    if d - plastic > p[1]:
        plastic = d - p[1]
    elif d - plastic < -p[1]:
        plastic = d + p[1]
    new[0] = plastic
    return float(-p[0] * plastic)


_ENTRY = entry(plastic_force)


def yielding_laws(frames: Sequence[ReducedFrame]) -> list[StoreyLaw]:
    """Return the laws of all storeys that yield.

    Args:
        frames: Reduced frames, from left to right.
    """
    return [
        StoreyLaw(_ENTRY.address, _row(frame, one.storey), _parameters(one), body)
        for body, frame in enumerate(frames)
        for one in storey_yields(frame)
    ]


def histories(frames: Sequence[ReducedFrame], motions: Sequence[FrameMotion]) -> tuple[StoreyHistory, ...]:
    """Return what the laws of yielding storeys did in a run that did not keep it.

    Args:
        frames: Reduced frames, from left to right.
        motions: What they did.
    """
    found = []
    for law in yielding_laws(frames):
        motion = motions[law.body]
        drift, rate = _drift(motion, law.row)
        step = np.diff(motion.time_s)
        middle = 0.5 * (drift[:-1] + drift[1:]) + 0.125 * step * (rate[:-1] - rate[1:])
        dense = np.insert(drift, np.arange(1, len(drift)), middle)
        force = -law.parameters[0] * plastic_drift(dense, law.parameters[1])
        found.append(history_of(frames, motions, law, force[::2], np.concatenate([[0.0], force[1::2]])))
    return tuple(found)


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
        drift, _ = _drift(motion, _row(motion.reduced, one.storey))
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


@njit(cache=True)
def plastic_drift(drift: Real, limit: float) -> Real:
    """Return the plastic drift (m,) [m] along a drift (m,) [m] that begins at rest, for a yield drift [m]."""
    found, plastic = np.empty(len(drift)), 0.0
    for place in range(len(drift)):
        plastic = min(max(plastic, drift[place] - limit), drift[place] + limit)
        found[place] = plastic
    return found


def _drift(motion: FrameMotion, row: Real) -> tuple[Real, Real]:
    floors = motion.reduced.floor_x
    return motion.displacement_m[:, floors] @ row, motion.velocity_m_s[:, floors] @ row


def _row(frame: ReducedFrame, storey: int) -> NDArray[np.float64]:
    row = np.zeros(frame.storeys)
    row[storey - 1] = 1.0
    if storey > 1:
        row[storey - 2] = -1.0
    return row


def _parameters(one: StoreyYield) -> NDArray[np.float64]:
    parameters = np.zeros(PARAMETERS)
    parameters[:2] = (1.0 - one.hardening) * one.stiffness_n_per_m, one.drift_m
    return parameters
