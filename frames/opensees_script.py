"""A stick as a script for OpenSeesPy, which anybody who has it can run and extend."""

from __future__ import annotations

import numpy as np

from pounding.frames.errors import FrameError
from pounding.frames.reduction.reduced_frame import ReducedFrame

ROUND_OFF = 1e-9
"""Share of a matrix's largest entry that counts as nothing."""

SCRIPT = '''\
"""Frame @NAME@ for OpenSeesPy: one node a floor, moving along x; SI units. Written by `pounding opensees`."""

import math

import openseespy.opensees as ops

MASSES = @MASSES@  # of each floor, from the first up [kg]
LINKS = [  # lower node (0: the base), upper node, stiffness [N/m], damping [N s/m]
@LINKS@]
DAMPING_RATIOS = @RATIOS@  # of each mode, a fraction: what the damping above amounts to


def build():
    """Build the model and return its frequencies [Hz]; the floors are the nodes from 1 on."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(0, 0.0)
    ops.fix(0, 1)
    for floor, mass in enumerate(MASSES, 1):
        ops.node(floor, 0.0)
        ops.mass(floor, mass)
    for tag, (lower, upper, stiffness, damping) in enumerate(LINKS, 1):
        ops.uniaxialMaterial("Elastic", tag, stiffness, damping)
        ops.element("zeroLength", tag, lower, upper, "-mat", tag, "-dir", 1)
    squares = ops.eigen("-fullGenLapack", len(MASSES))
    return [math.sqrt(square) / (2.0 * math.pi) for square in squares]


if __name__ == "__main__":
    for mode, frequency_hz in enumerate(build(), 1):
        print(f"mode {mode}: {frequency_hz:.6f} Hz")
'''


def script(reduced: ReducedFrame) -> str:
    """Return a frame as the text of an OpenSeesPy script with the same mass, stiffness and damping.

    A matrix that couples all floors becomes a net of springs and dashpots between all of them, some of which are negative.

    Args:
        reduced: A stick in its reduced form.

    Raises:
        FrameError: Its mass couples floors, which masses on nodes cannot do, its floors turn, or its storeys yield.
    """
    if reduced.turns:
        raise FrameError(
            f"frame {reduced.name}: its floors turn, and the script's nodes move along x alone; leave the table torsion out"
        )
    coupled = np.abs(reduced.mass - np.diag(np.diag(reduced.mass))).max()
    if coupled > ROUND_OFF * np.abs(reduced.mass).max():
        raise FrameError(
            f"frame {reduced.name}: its mass matrix couples floors (up to {coupled:.3g} kg), and a node of OpenSees has "
            "a mass of its own; make a stick with floor masses and frequencies"
        )
    if reduced.definition.yielding is not None:
        raise FrameError(
            f"frame {reduced.name}: its storeys yield, and the script is linear; leave the table yielding out"
        )
    # Not OpenSees' own modal damping: of modes that share a frequency its shapes are not orthogonal, and its damping is off.
    springs, dashpots = (
        {one[:2]: one[2] for one in springs_of(m)} for m in (reduced.stiffness, reduced.damping)
    )
    links = "".join(
        f"    ({low}, {high}, {springs.get((low, high), 0.0)!r}, {dashpots.get((low, high), 0.0)!r}),\n"
        for low, high in sorted(springs | dashpots)
    )
    return (
        SCRIPT.replace("@MASSES@", repr([float(mass) for mass in np.diag(reduced.mass)]))
        .replace("@LINKS@", links)
        .replace("@RATIOS@", repr([float(ratio) for ratio in reduced.damping_ratios]))
        .replace("@NAME@", "".join(letter for letter in reduced.name if letter not in '"\\'))
    )


def springs_of(stiffness: np.ndarray) -> list[tuple[int, int, float]]:
    """Return a stiffness matrix as springs: the lower floor (0: the base), the upper one, the stiffness [N/m].

    A damping matrix gives dashpots [N s/m] alike.

    Args:
        stiffness: Stiffness (n, n) [N/m], symmetric.
    """
    size, nothing = len(stiffness), ROUND_OFF * np.abs(stiffness).max()
    to_base = stiffness.sum(axis=1)
    found = [(0, floor + 1, float(to_base[floor])) for floor in range(size)]
    found += [(i + 1, j + 1, float(-stiffness[i, j])) for i in range(size) for j in range(i + 1, size)]
    return [spring for spring in found if abs(spring[2]) > nothing]
