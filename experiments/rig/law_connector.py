"""A law in a storey as a connector of exudyn; what it remembers advances before each step of the engine.

So a step that is taken back leaves no trace.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items
from numpy.typing import NDArray

from pounding.calling import MEMORY, called_at
from pounding.experiments.rig.storeys import StoreyLaw

Series = Callable[[float], float]
"""A quantity as a function of time [s]."""


class LawConnector:
    """A law as a connector of the engine, its memory that of the motion up to the step that is being tried.

    Args:
        mbs: The exudyn system.
        body: The frame's body.
        ground: Marker of a coordinate that rests on the table.
        law: The law.
        rate: What adds to the drift's rate [m/s], or None.
    """

    def __init__(self, mbs: Any, body: Any, ground: int, law: StoreyLaw, rate: Series | None = None) -> None:
        self._law, self._rate = law, rate
        self._parameters = np.ascontiguousarray(law.parameters, float)
        self._state, self._new = np.array(law.memory, float), np.zeros(MEMORY)
        # The engine asks many times a step, and numbers reach compiled code sooner than arrays.
        self._places = tuple(int(one.ctypes.data) for one in (self._parameters, self._state, self._new))
        self._address = law.address
        self._node, self._row = body.node, np.zeros(len(body.reduced.mass))
        self._row[body.reduced.floor_x] = law.row
        # The engine keeps no reference to a user function.
        self._asked = self._all
        self._item = mbs.AddObject(self._between(body, ground) if _is_drift(law.row) else self._along(body))

    def _between(self, body: Any, ground: int) -> Any:
        """Return what acts on one floor or between two."""
        return items.ObjectConnectorCoordinateSpringDamper(
            markerNumbers=ends(body, ground, self._law.row),
            stiffness=1.0,
            springForceUserFunction=self._force,
        )

    def _along(self, body: Any) -> Any:
        """Return what acts on several floors in other shares, to which the engine gives all of a body's coordinates."""
        return items.ObjectGenericODE2(nodeNumbers=[body.node], forceUserFunction=self._asked)

    def _all(self, mbs: Any, t: float, item: int, places: Any, rates: Any) -> NDArray[np.floating[Any]]:
        return -self._force(mbs, t, item, float(self._row @ places), float(self._row @ rates)) * self._row

    def _force(self, _mbs: Any, t: float, _item: int, d: float, v: float, *_: float) -> float:
        if self._rate is not None:
            v += self._rate(t)
        parameters, state, new = self._places
        return called_at(self._address, parameters, state, d, v, t, new)

    def latch(self, mbs: Any) -> None:
        """Remember the motion up to now, which is where a step begins."""
        if self._law.remembers:
            kind = exudyn.OutputVariableType
            # The engine gives the only coordinate of a node as a number.
            d, v = (
                float(self._row @ np.atleast_1d(mbs.GetNodeOutput(self._node, one)))
                for one in (kind.Coordinates, kind.Coordinates_t)
            )
            self._force(mbs, mbs.systemData.GetTime(), self._item, d, v)
            self._state[:] = self._new


def _is_drift(row: NDArray[np.floating[Any]]) -> bool:
    """Return whether a row of floors is the displacement of one or that between two."""
    acting = row[row != 0.0]
    return np.array_equal(acting, [1.0]) or np.array_equal(np.sort(acting), [-1.0, 1.0])


def partly(series: Series, share: float) -> Series | None:
    """Return a share of a series, None where it is nothing."""
    return (lambda t: share * series(t)) if share else None


def resting(mbs: Any) -> int:
    """Return the marker of a coordinate that rests on the table.

    Args:
        mbs: The exudyn system.
    """
    node = mbs.AddNode(items.NodePointGround(referenceCoordinates=[0, 0, 0]))
    return int(mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=0)))


def ends(body: Any, ground: int, row: NDArray[np.floating[Any]]) -> list[int]:
    """Return the markers below and above the drift that a row of floors gives.

    Args:
        body: The frame's body.
        ground: Marker of a coordinate that rests on the table.
        row: What the floors' displacements contribute to the drift (storeys,).
    """
    above, below = int(np.argmax(row)), np.flatnonzero(row < 0)
    return [body.marker(int(below[0]) + 1) if len(below) else ground, body.marker(above + 1)]
