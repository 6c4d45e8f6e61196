"""Evaluates recorded laws inside compiled loops."""

from __future__ import annotations

import math
from typing import Any

from numba import njit

from pounding.contact.recorded import Operation

ADD, SUBTRACT, MULTIPLY, DIVIDE = map(
    int, (Operation.ADD, Operation.SUBTRACT, Operation.MULTIPLY, Operation.DIVIDE)
)
POWER, SQRT, MAXIMUM = map(int, (Operation.POWER, Operation.SQRT, Operation.MAXIMUM))
GREATER, GREATER_EQUAL = int(Operation.GREATER), int(Operation.GREATER_EQUAL)


@njit(cache=True, nogil=True, error_model="numpy")
def force_of(
    instructions: Any,
    first: int,
    last: int,
    registers: Any,
    result: int,
    deformation: float,
    rate: float,
    approach: float,
) -> float:
    """Return a recorded law's force [N] (compiled).

    Args:
        instructions: Instructions of one or more programs (k, 5).
        first, last: The program's first instruction and the one past its last.
        registers: The program's registers (r,); its results are written there.
        result: Register of the force.
        deformation: How far the bodies overlap [m]; below zero counts as zero.
        rate: Its time derivative [m/s].
        approach: Velocity at first touch [m/s].
    """
    registers[0], registers[1], registers[2] = max(deformation, 0.0), rate, approach
    for place in range(first, last):
        what = instructions[place, 0]
        a = registers[instructions[place, 2]]
        b = registers[instructions[place, 3]]
        if what == ADD:
            value = a + b
        elif what == SUBTRACT:
            value = a - b
        elif what == MULTIPLY:
            value = a * b
        elif what == DIVIDE:
            value = a / b
        elif what == POWER:
            value = math.pow(a, b)
        elif what == SQRT:
            value = math.sqrt(a)
        elif what == MAXIMUM:
            value = a if a > b else b
        elif what == GREATER:
            value = 1.0 if a > b else 0.0
        elif what == GREATER_EQUAL:
            value = 1.0 if a >= b else 0.0
        else:
            value = b if a != 0.0 else registers[instructions[place, 4]]
        registers[instructions[place, 1]] = value
    return float(registers[result])
