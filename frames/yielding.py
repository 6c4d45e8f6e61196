"""Where the storeys of a frame yield: stiffness and yield drift of each, from what the frame file states.

A storey is elastic up to its yield force and goes on with a share of its stiffness. The force is stated, or that of
plastic hinges at both ends of all columns (elastic and perfectly plastic steel, as in Appendix B of the thesis up to a
strain of 1.5 %).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from pounding.frames.definition import Frame, PlateFrame
from pounding.frames.errors import FrameError
from pounding.frames.reduction.reduced_frame import ReducedFrame

Real = NDArray[np.floating[Any]]


class StoreyYield(NamedTuple):
    """How one storey yields.

    Attributes:
        storey: Its number, from 1.
        stiffness_n_per_m: Its elastic stiffness [N/m].
        drift_m: Drift at which it yields [m].
        hardening: Share of the stiffness that is left beyond [-].
        sharpness: Exponent of a rounded knee [-]; None: a sharp one.
    """

    storey: int
    stiffness_n_per_m: float
    drift_m: float
    hardening: float
    sharpness: float | None = None


def storey_yields(reduced: ReducedFrame) -> list[StoreyYield]:
    """Return how each storey of a frame yields; none for a frame whose file says nothing of it.

    The stiffness of a storey is its shear over its drift under the inertia forces of the first mode. For a stick it is
    the stated one.
    """
    frame = reduced.definition
    if frame.yielding is None:
        return []
    mass, stiffness, _ = reduced.storey_model()
    forces = mass @ np.abs(reduced.shapes[reduced.floor_x, 0])
    drift = np.diff(np.linalg.solve(stiffness, forces), prepend=0.0)
    storeys = np.cumsum(forces[::-1])[::-1] / drift
    return [
        StoreyYield(
            number, float(one), shear / float(one), frame.yielding.hardening_ratio, frame.yielding.sharpness
        )
        for number, (one, shear) in enumerate(zip(storeys, yield_shears(frame), strict=True), start=1)
    ]


def yield_shears(frame: Frame) -> list[float]:
    """Return the force [N] at which each storey of a frame yields.

    Raises:
        FrameError: The frame does not yield.
    """
    if frame.yielding is None:
        raise FrameError(f"frame {frame.name}: it has no table 'yielding'")
    stated = frame.yielding.storey_shear_n
    if stated is None and isinstance(frame, PlateFrame):
        stated = hinge_shear(frame)
    assert stated is not None  # a stick without it is refused when it is read
    return list(stated) if isinstance(stated, list) else [float(stated)] * frame.storeys


def hinge_shear(frame: PlateFrame) -> float:
    """Return the shear [N] of a storey with a plastic hinge at both ends of all columns, between the floors' faces."""
    columns = frame.columns
    moment = 1e6 * frame.material.yield_stress_mpa * columns.width_m * columns.thickness_m**2 / 4.0
    clear = frame.storey_height_m - frame.plate.thickness_m
    return 2.0 * len(frame.places_m) * moment / clear
