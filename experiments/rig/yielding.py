"""Storeys that yield, as laws of the rig: what a frame's file says of it, run by either solver.

A storey with stiffness k that yields at the drift y has a plastic drift p, which keeps the elastic part d - p within
-y and y. The linear frame already has k d; the law adds what yielding takes away, -(1 - h) k p with the share h of
hardening. This is the return mapping of one-dimensional plasticity with kinematic hardening (Simo and Hughes,
*Computational Inelasticity*, 1998, chapter 1), exact for any step as long as the drift does not turn within it. With a
rounded knee the part (1 - h) k is the law of Bouc and Wen instead.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pounding.experiments.rig.drifts import storey_row
from pounding.experiments.rig.laws import Law, filled, remembering
from pounding.experiments.rig.storey_forces import yielding as rounded_force
from pounding.experiments.rig.storeys import StoreyLaw
from pounding.frames.yielding import StoreyYield, storey_yields

if TYPE_CHECKING:
    from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


@remembering
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


def yielding_laws(frames: Sequence[ReducedFrame]) -> list[StoreyLaw]:
    """Return the laws of all storeys that yield.

    Args:
        frames: Reduced frames, from left to right.
    """
    found = []
    for body, frame in enumerate(frames):
        for one in storey_yields(frame):
            law, parameters = _law(one)
            row = storey_row(frame, one.storey)
            found.append(StoreyLaw(law.address, row, filled(parameters, np.nan), body))
    return found


def _law(one: StoreyYield) -> tuple[Law, tuple[float, ...]]:
    """Return what yielding takes away from a storey's elastic force, and its parameters."""
    stiffness = (1.0 - one.hardening) * one.stiffness_n_per_m
    if one.sharpness is None:
        return plastic_force, (stiffness, one.drift_m)
    return rounded_force, (stiffness * one.drift_m, stiffness, one.sharpness)


def plastic_drift(one: StoreyYield, drift_m: Real, rate_m_s: Real, time_s: Real) -> Real:
    """Return the part of a drift that is not elastic (m,) [m], from a start at rest.

    Args:
        one: How the storey yields.
        drift_m, rate_m_s, time_s: Its drift [m], the drift's rate [m/s] and the times [s], each (m,).
    """
    law, parameters = _law(one)
    force = law.along(parameters, drift_m, rate_m_s, time_s)
    return np.asarray(-force / ((1.0 - one.hardening) * one.stiffness_n_per_m))
