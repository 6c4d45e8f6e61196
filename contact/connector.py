"""A law as a connector of exudyn between two coordinates.

The law's own definition is recorded symbolically, so that the engine evaluates it without calling Python. The
engine cannot remember the velocity at first touch, to which some laws refer: a `Latch` that is called before
each step gives it to the recorded law as a parameter. Without such calls, and for points across a floor, the
law is a Python function that remembers by itself.
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

from pounding.contact.errors import ContactError
from pounding.contact.laws import FloatOperations, Law

symbolic: Any = exudyn.symbolic  # type: ignore[attr-defined]
Real = NDArray[np.float64]
Force = Callable[[float, float], float]
DISPLACEMENT = exudyn.OutputVariableType.Displacement
VELOCITY = exudyn.OutputVariableType.Velocity


class SymbolicOperations:
    """The operations a law may use, recorded by exudyn instead of evaluated."""

    power = staticmethod(symbolic.pow)
    sqrt = staticmethod(symbolic.sqrt)

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> Any:
        """Record a choice.

        Args:
            condition: What is asked.
            yes: The value where it holds.
            no: The value elsewhere.
        """
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
            approach = _at_touch(apart, deformation, rate)
            apart = None
        value: float = law.force(deformation, rate, approach, FloatOperations)
        return value

    return force


NEAR_M = 2e-3
"""Distance [m] below which a latch looks at the velocity; the rig's longest step covers it at 4 m/s."""


class Latch:
    """Keeps a connector's velocity at first touch where its recorded law reads it.

    Call it before each step. While the bodies are apart but near, it sets the velocity at the step's start;
    at the first step that starts in touch, that of the straight line between the two, as `force_function`
    does. So only the step in which they meet, which error control makes short, has the former.

    Args:
        item: The connector; its parameter "stiffness" is what the recorded law reads.
        gap_m: Gap at rest [m].
    """

    def __init__(self, item: int, gap_m: float) -> None:
        self._item, self._gap_m = item, gap_m
        self._apart: tuple[float, float] | None = (0.0, 0.0)

    def __call__(self, mbs: Any) -> None:
        """Look at the connector and set its velocity at first touch [m/s] where that changes."""
        deformation = mbs.GetObjectOutput(self._item, DISPLACEMENT) - self._gap_m
        if deformation <= -NEAR_M:
            self._apart = (0.0, 0.0)
        elif deformation <= 0.0 or self._apart is not None:
            rate = mbs.GetObjectOutput(self._item, VELOCITY)
            approach = rate
            if deformation <= 0.0:
                self._apart = (deformation, rate)
            elif rate > 0.0:
                approach = _at_touch(self._apart, deformation, rate)
                self._apart = None
            mbs.SetObjectParameter(self._item, "stiffness", approach)


def _at_touch(apart: tuple[float, float] | None, deformation: float, rate: float) -> float:
    """Return the rate [m/s] at no deformation, on the straight line from the last (deformation, rate) apart."""
    if apart is None or apart[0] >= 0.0:  # from rest against each other, only the velocity now is known
        return rate
    return apart[1] + apart[0] / (apart[0] - deformation) * (rate - apart[1])


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
        stepped: Will `latch`, where there is one, be called before each step? Then a law that refers to the
            velocity at first touch is recorded too.

    Attributes:
        item: Number of the connector in the system.
        recorded: Is the law evaluated by the engine itself?
        latch: To be called with the system before each step; None where there is no need.

    Raises:
        ContactError: A negative gap.
    """

    def __init__(
        self,
        mbs: Any,
        law: Law,
        gap_m: float,
        left: int,
        right: int,
        *,
        record: bool = True,
        stepped: bool = False,
    ) -> None:
        self.law, self.gap_m = law, checked_gap(gap_m)
        self.recorded = record and (stepped or not law.latches)
        # exudyn keeps no reference to a user function: the connector must, and its owner the connector.
        self._function = self._symbolic(mbs) if self.recorded else self._python()
        self.item = mbs.AddObject(
            items.ObjectConnectorCoordinateSpringDamper(
                markerNumbers=[right, left], stiffness=0.0, springForceUserFunction=self._function
            )
        )
        self.latch = Latch(self.item, self.gap_m) if self.recorded and law.latches else None

    def _python(self) -> Any:
        force, gap = force_function(self.law), self.gap_m
        return lambda _mbs, _t, _item, u, v, _k, _d, _offset: force(u - gap, v)

    def _symbolic(self, mbs: Any) -> Any:
        law, gap = self.law, self.gap_m

        def force(mbs: Any, t: Any, itemNumber: Any, u: Any, v: Any, k: Any, d: Any, offset: Any) -> Any:
            # The spring's stiffness has no other use here: it carries the velocity at first touch.
            return law.force(u - gap, v, k, SymbolicOperations)

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

    recorded, latch = False, None

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
