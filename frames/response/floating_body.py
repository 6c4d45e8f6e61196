"""A frame as exudyn's own flexible body, to verify the body on Craig-Bampton coordinates (`body`) by.

It is the engine's floating frame of reference with modal reduction (`ObjectFFRFreducedOrder`; Zwölfer and Gerstmayr,
Acta Mechanica 232, 2021): a rigid-body frame that may move and turn freely, and modes relative to it. The engine
computes the modes and all the coupling terms itself, from mass and stiffness of nodes with three displacements. The
table is the rigid-body frame, made heavy.
"""

from __future__ import annotations

import time
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface as items
from exudyn.FEM import FEMinterface, HCBstaticModeSelection, ObjectFFRFreducedOrderInterface
from numpy.typing import ArrayLike, NDArray

from pounding.frames.reduction.translations import Translations
from pounding.frames.response.body import LONGEST_STEP_S, TABLE_MASS_KG, Table, quiet, settings, solve

Real = NDArray[np.floating[Any]]

RIGID = 6
"""Coordinates of the rigid-body frame: three displacements, three angles."""


class Floating(NamedTuple):
    """What the engine's own flexible body did on the table.

    Attributes:
        frequencies_hz: Its natural frequencies (modes,) [Hz], rising, from the engine's eigenvalue solver.
        displacement: Displacement along x of the middle of each floor, relative to the table, at the samples
            of the acceleration (m, storeys) [m].
        steps: Integration steps.
        modes_s: Wall time of the modes and coupling terms [s].
        wall_s: Wall time of the integration [s].
    """

    frequencies_hz: Real
    displacement: Real
    steps: int
    modes_s: float
    wall_s: float


def run_floating(
    frame: Translations,
    acceleration_m_s2: ArrayLike,
    step_s: float,
    *,
    damping_ratio: float,
    modes: int,
    longest_step_s: float = LONGEST_STEP_S,
) -> Floating:
    """Shake a frame as the engine's own flexible body, with the classical Runge-Kutta method.

    Args:
        frame: The frame on three displacements a node.
        acceleration_m_s2: Acceleration of the table along x (m,) [m/s^2].
        step_s: Its sample step [s].
        damping_ratio: Damping ratio of every mode, a fraction.
        modes: How many modes of the frame on a fixed base, the lowest.
        longest_step_s: Longest integration step [s].

    Raises:
        FrameError: The acceleration cannot be used, or the engine could not finish.
    """
    container = exudyn.SystemContainer()
    mbs = container.AddSystem()
    started = time.perf_counter()
    with quiet():
        body = _added(mbs, frame, damping_ratio, modes)
    modes_s = time.perf_counter() - started
    table = Table(mbs, acceleration_m_s2, step_s, node=body["nRigidBody"])
    sensors = [
        mbs.AddSensor(
            items.SensorSuperElement(
                bodyNumber=body["oFFRFreducedOrder"],
                meshNodeNumber=int(node),
                outputVariableType=exudyn.OutputVariableType.DisplacementLocal,
                storeInternal=True,
                writeToFile=False,
            )
        )
        for node in frame.floor
    ]
    mbs.Assemble()
    frequencies, _ = mbs.ComputeODE2Eigenvalues(convert2Frequencies=True)
    chosen = settings(table, longest_step_s)
    wall_s = solve(mbs, chosen)
    moved = np.column_stack([np.asarray(mbs.GetSensorStoredData(sensor))[:, 1] for sensor in sensors])
    steps = int(chosen.timeIntegration.numberOfSteps)
    return Floating(np.sort(frequencies)[RIGID:], moved, steps, modes_s, wall_s)


def _added(mbs: Any, frame: Translations, damping_ratio: float, modes: int) -> dict[str, Any]:
    """Add the body and the table's mass to a system; return the numbers of its nodes and object."""
    fem = FEMinterface()
    fem.nodes = {"Position": frame.nodes}
    fem.stiffnessMatrix, fem.massMatrix = frame.stiffness, frame.mass
    # One boundary, the base, which the rigid-body frame holds: no static mode is left, only those of a fixed base.
    fem.ComputeHurtyCraigBamptonModes(
        [frame.base.tolist()], modes, computationMode=HCBstaticModeSelection.RBE2
    )
    # Angles about the axes need no constraint equation, so that an explicit integrator can be used.
    terms = ObjectFFRFreducedOrderInterface(fem, rigidBodyNodeType=exudyn.NodeType.RotationRxyz)
    added: dict[str, Any] = terms.AddObjectFFRFreducedOrder(mbs)
    mbs.AddObject(
        items.ObjectRigidBody(
            nodeNumber=added["nRigidBody"], mass=TABLE_MASS_KG, inertia=[TABLE_MASS_KG] * 3 + [0.0] * 3
        )
    )
    mass, stiffness = np.diag(terms.massMatrixReduced), np.diag(terms.stiffnessMatrixReduced)
    damping = exudyn.MatrixContainer()
    damping.SetWithDenseMatrix(np.diag(2.0 * damping_ratio * np.sqrt(mass * stiffness)), useDenseMatrix=True)
    mbs.SetObjectParameter(added["oFFRFreducedOrder"], "dampingMatrixReduced", damping)
    return added
