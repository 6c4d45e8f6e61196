"""A law as a connector of exudyn between two coordinates.

The law's own definition is recorded symbolically, so that the engine evaluates it without calling Python.
Laws that refer to the velocity at first touch, and laws that the recording cannot take, are called as
Python functions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items
from exudyn.advancedUtilities import CreateSymbolicUserFunction
from numpy.typing import NDArray

from contact.errors import ContactError
from contact.laws import FloatOperations, Law

symbolic: Any = exudyn.symbolic  # type: ignore[attr-defined]
Real = NDArray[np.float64]
Force = Callable[[float, float], float]


class SymbolicOperations:
    """The operations a law may use, recorded by exudyn instead of evaluated."""

    power = staticmethod(symbolic.pow)
    sqrt = staticmethod(symbolic.sqrt)

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> Any:
        """Record a choice."""
        return symbolic.IfThenElse(condition, _recorded(yes), _recorded(no))

    @staticmethod
    def maximum(first: Any, second: Any) -> Any:
        """Record the larger of two."""
        return SymbolicOperations.where(first > second, first, second)


def _recorded(value: Any) -> Any:
    return symbolic.Real(float(value)) if isinstance(value, float | int) else value


def force_function(law: Law) -> Force:
    """The law as a function of deformation [m] and rate [m/s] that remembers the velocity at first touch.

    The velocity is that of the straight line between the last moment apart and the first in touch. A step
    that the engine takes back and takes again leaves a memory of the same touch, so it does no harm; a
    moment apart at the end of a contact, seen on the way out, is no new touch.
    """
    if not law.latches:
        return lambda deformation, rate: law.force(deformation, rate, 0.0, FloatOperations)
    apart: tuple[float, float] | None = (0.0, 0.0)
    approach = 0.0

    def force(deformation: float, rate: float) -> float:
        nonlocal apart, approach
        if deformation <= 0.0:
            apart = (deformation, rate)
            return 0.0
        if apart is not None and rate > 0.0:
            part = apart[0] / (apart[0] - deformation)
            # From rest against each other, only the velocity now is known.
            approach = apart[1] + part * (rate - apart[1]) if apart[0] < 0.0 else rate
            apart = None
        return law.force(deformation, rate, approach, FloatOperations)

    return force


def checked_gap(gap_m: float) -> float:
    """The gap [m] itself if it is zero or more and finite; `ContactError` otherwise."""
    if not (gap_m >= 0 and math.isfinite(gap_m)):
        raise ContactError(
            f"a gap of {1e3 * gap_m:g} mm: give zero or more, for bodies cannot overlap at rest"
        )
    return float(gap_m)


class ContactConnector:
    """A contact between two coordinates: left coordinate minus right coordinate minus gap is the deformation.

    Args:
        mbs: The exudyn system.
        law: The law.
        gap_m: Gap at rest [m], zero allowed.
        left: Marker of the coordinate that moves in +x towards the other.
        right: Marker of the other coordinate.
        record: Record the law symbolically where that is possible.

    Attributes:
        item: Number of the connector in the system.
        recorded: Is the law evaluated by the engine itself?

    Raises:
        ContactError: A negative gap.
    """

    def __init__(
        self, mbs: Any, law: Law, gap_m: float, left: int, right: int, *, record: bool = True
    ) -> None:
        self.law, self.gap_m = law, checked_gap(gap_m)
        self.recorded = record and not law.latches
        # exudyn keeps no reference to a user function: the connector must, and its owner the connector.
        self._function = self._symbolic(mbs) if self.recorded else self._python()
        self.item = mbs.AddObject(
            items.ObjectConnectorCoordinateSpringDamper(
                markerNumbers=[right, left], stiffness=1.0, springForceUserFunction=self._function
            )
        )

    def _python(self) -> Any:
        force, gap = force_function(self.law), self.gap_m
        return lambda _mbs, _t, _item, u, v, _k, _d, _offset: force(u - gap, v)

    def _symbolic(self, mbs: Any) -> Any:
        law, gap = self.law, self.gap_m

        def force(mbs: Any, t: Any, itemNumber: Any, u: Any, v: Any, k: Any, d: Any, offset: Any) -> Any:
            return law.force(u - gap, v, 0.0, SymbolicOperations)

        return CreateSymbolicUserFunction(
            mbs, force, "springForceUserFunction", itemTypeName="ObjectConnectorCoordinateSpringDamper"
        )


class PointContact:
    """A contact at any point of two bodies: the point's displacement is a row times the body's coordinates.

    Slower than `ContactConnector` (a Python function on whole coordinate vectors), and free of its limit that
    each contact needs a coordinate of its own: several points across one rigid floor may touch.

    Args:
        mbs: The exudyn system.
        law: The law.
        gap_m: Gap at rest [m], zero allowed.
        left: Node of the left body and row (n_left,) of its point.
        right: Node of the right body and row (n_right,) of its point.

    Raises:
        ContactError: A negative gap.
    """

    recorded = False

    def __init__(
        self, mbs: Any, law: Law, gap_m: float, left: tuple[int, Real], right: tuple[int, Real]
    ) -> None:
        self.law, self.gap_m = law, checked_gap(gap_m)
        row = np.concatenate([np.asarray(left[1], float), -np.asarray(right[1], float)])
        force, gap = force_function(law), self.gap_m

        def push(_mbs: Any, _t: float, _item: int, q: Any, q_t: Any) -> Any:
            return -force(float(row @ q) - gap, float(row @ q_t)) * row

        self._function = push
        self.item = mbs.AddObject(
            items.ObjectGenericODE2(nodeNumbers=[left[0], right[0]], forceUserFunction=push)
        )
