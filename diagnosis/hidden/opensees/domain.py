"""OpenSees itself: the one module that touches it, and the small steps that all models of it need."""

from __future__ import annotations

import itertools
import os
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from pounding.diagnosis.errors import CaseError

HOW_TO_GET = (
    "the engine opensees needs openseespy, which is no dependency because its licence does not let everyone "
    "redistribute it; for development: pip install openseespy==3.7.1.2 "
    "(on Debian also apt-get install libblas3 liblapack3)"
)

UNBALANCE_N, MOVING_UNBALANCE_N = 1e-7, 1e-5
"""Unbalanced force at which an equilibrium iteration ends [N]: at rest, and in a step of time, where a frame's inertia is
tens of newtons."""

ITERATIONS = 60


def require() -> None:
    """Refuse to go on without OpenSees.

    Raises:
        CaseError: It is not installed, or a library that it needs is not.
    """
    _module()


def _module() -> Any:
    try:
        from openseespy import opensees
    except (ImportError, OSError, RuntimeError) as error:
        raise CaseError(f"{HOW_TO_GET} ({type(error).__name__}: {error})".replace("\n", " ")) from None
    return opensees


class Domain:
    """OpenSees' one model of a process, emptied; commands go to `ops`."""

    def __init__(self) -> None:
        self.ops = _module()
        # Its materials tell of every impact.
        self.ops.logFile(os.devnull, "-noEcho")
        self.ops.wipe()
        self.ops.model("basic", "-ndm", 2, "-ndf", 3)
        self._numbers: Iterator[int] = itertools.count(1)

    def number(self) -> int:
        """Return a tag that nothing has yet."""
        return next(self._numbers)

    def node(self, x: float, y: float, fixed: tuple[int, int, int] = (0, 0, 0)) -> int:
        """Add a node and return its tag.

        Args:
            x: Place along the shaking [m].
            y: Height [m].
            fixed: For x, y and the rotation: 1 where it cannot move.
        """
        tag = self.number()
        self.ops.node(tag, x, y)
        self.ops.fix(tag, *fixed)
        return tag

    def release(self, node: int, *directions: int) -> None:
        """Let a node go that was held in some directions (1: x, 2: y, 3: rotation)."""
        for direction in directions:
            self.ops.remove("sp", node, direction)

    def spring(
        self, low: int, high: int, direction: int, kind: str, *numbers: Any, damped: bool = False
    ) -> int:
        """Put a material between two nodes at one place and return the element's tag.

        Args:
            low: First node; the material stretches by what the second moves more.
            high: Second node.
            direction: 1: x, 2: y, 6: rotation.
            kind: The material as OpenSees calls it.
            numbers: Its parameters.
            damped: Whether Rayleigh damping acts on it.
        """
        material, element = self.number(), self.number()
        self.ops.uniaxialMaterial(kind, material, *numbers)
        rule = ("-mat", material, "-dir", direction, "-doRayleigh", int(damped))
        self.ops.element("zeroLength", element, low, high, *rule)
        return element

    def path(self, values: np.ndarray, step_s: float) -> int:
        """Return the tag of a time series that is linear between values, shape (samples,), of a step [s]."""
        tag = self.number()
        self.ops.timeSeries("Path", tag, "-dt", step_s, "-values", *values.tolist())
        return tag

    def loads(self, series: int, loads: Iterable[tuple[int, float, float]]) -> None:
        """Load nodes as a series says: (node, factor of the force along x, along y)."""
        self.ops.pattern("Plain", self.number(), series)
        for node, along, up in loads:
            self.ops.load(node, along, up, 0.0)

    def stand(self, loads: Iterable[tuple[int, float, float]]) -> None:
        """Bring dead loads [N] into equilibrium and keep them from then on.

        Args:
            loads: (node, along x, along y).

        Raises:
            CaseError: There is no equilibrium: the frame buckles.
        """
        ops, series = self.ops, self.number()
        ops.timeSeries("Constant", series)
        self.loads(series, loads)
        self._solver("BandGeneral")
        ops.algorithm("Newton")
        ops.integrator("LoadControl", 1.0)
        ops.analysis("Static")
        if ops.analyze(1) != 0:
            raise CaseError("the hidden frame does not stand under its weight; hide a smaller effect")
        ops.loadConst("-time", 0.0)
        ops.wipeAnalysis()

    def stiffness(self) -> np.ndarray:
        """Return the tangent stiffness of all free unknowns, shape (unknowns, unknowns)."""
        ops = self.ops
        self._solver("FullGeneral")
        ops.algorithm("Linear")
        ops.integrator("GimmeMCK", 0.0, 0.0, 1.0)
        ops.analysis("Transient")
        ops.analyze(1, 0.0)
        size = ops.systemSize()
        return np.array(ops.printA("-ret")).reshape(size, size)

    def move(self) -> None:
        """Make ready for steps of time: Newmark's average acceleration, which loses no energy."""
        ops = self.ops
        ops.wipeAnalysis()
        # The first stiffness and the inertia of a step are positive, and the profile is the quickest that OpenSees has.
        self._solver("ProfileSPD", MOVING_UNBALANCE_N)
        ops.algorithm("ModifiedNewton", "-initial")
        ops.integrator("Newmark", 0.5, 0.25)
        ops.analysis("Transient")

    def step(self, count: int, step_s: float) -> bool:
        """Take steps of time [s]; return whether every one found its equilibrium, by the second way if not the first."""
        ops = self.ops
        if ops.analyze(count, step_s) == 0:
            return True
        ops.algorithm("KrylovNewton", "-iterate", "initial", "-increment", "initial")
        found: bool = ops.analyze(4 * count, step_s / 4) == 0
        ops.algorithm("ModifiedNewton", "-initial")
        return found

    def _solver(self, system: str, unbalance_n: float = UNBALANCE_N) -> None:
        ops = self.ops
        ops.constraints("Transformation")
        ops.numberer("RCM")
        ops.system(system)
        ops.test("NormUnbalance", unbalance_n, ITERATIONS)
