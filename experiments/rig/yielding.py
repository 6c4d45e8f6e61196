"""Storeys that yield, as laws of the rig: what a frame's file says of it, run by either solver.

A storey with stiffness k that yields at the drift y has a plastic drift p, which keeps the elastic part d - p within
-y and y. The linear frame already has k d; the law adds what yielding takes away, -(1 - h) k p with the share h of
hardening. This is the return mapping of one-dimensional plasticity with kinematic hardening (Simo and Hughes,
*Computational Inelasticity*, 1998, chapter 1), exact for any step as long as the drift does not turn within it.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pounding.calling import PARAMETERS, entry
from pounding.experiments.rig.ductility import plastic_drift, storey_drift, storey_row
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
        StoreyLaw(_ENTRY.address, storey_row(frame, one.storey), _parameters(one), body)
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
        drift, rate = storey_drift(motion, law.row)
        step = np.diff(motion.time_s)
        middle = 0.5 * (drift[:-1] + drift[1:]) + 0.125 * step * (rate[:-1] - rate[1:])
        dense = np.insert(drift, np.arange(1, len(drift)), middle)
        force = -law.parameters[0] * plastic_drift(dense, law.parameters[1])
        found.append(history_of(frames, motions, law, force[::2], np.concatenate([[0.0], force[1::2]])))
    return tuple(found)


def _parameters(one: StoreyYield) -> NDArray[np.float64]:
    parameters = np.zeros(PARAMETERS)
    parameters[:2] = (1.0 - one.hardening) * one.stiffness_n_per_m, one.drift_m
    return parameters
