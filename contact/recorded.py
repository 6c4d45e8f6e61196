"""A law's own formula, recorded as a short program that compiled loops evaluate without calling Python.

The law is called once with symbols instead of numbers (see `contact.laws`); what it does with them becomes a list of
operations on registers. So one definition serves numpy, exudyn and the compiled loop, a law that a user adds needs no
compiler, and a sweep over thousands of parameters compiles nothing: a law's parameters are constants of its program.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pounding.contact.errors import ContactError
from pounding.contact.laws import Law

INPUTS = 3
"""The first registers hold deformation [m], rate [m/s] and velocity at first touch [m/s]."""


class Operation(IntEnum):
    """What an instruction does with its operands; comparisons give 1 or 0."""

    ADD = 0
    SUBTRACT = 1
    MULTIPLY = 2
    DIVIDE = 3
    POWER = 4
    SQRT = 5
    MAXIMUM = 6
    GREATER = 7
    GREATER_EQUAL = 8
    WHERE = 9


@dataclass(frozen=True, eq=False)
class Program:
    """A law as a list of operations.

    Attributes:
        instructions: Operation, result and up to three operands as numbers of registers (k, 5).
        registers: Registers at the start (r,): three inputs, the constants, and room for the results.
        result: Register that holds the force [N] at the end.
    """

    instructions: NDArray[np.int64]
    registers: NDArray[np.float64]
    result: int


class _Recorder:
    """Collects constants and operations of one law."""

    def __init__(self) -> None:
        self.constants: dict[float, int] = {}
        self.operations: list[tuple[Operation, tuple[_Symbol, ...]]] = []

    def constant(self, value: float) -> _Symbol:
        return _Symbol(self, "constant", self.constants.setdefault(float(value), len(self.constants)))

    def do(self, operation: Operation, *operands: Any) -> _Symbol:
        symbols = tuple(one if isinstance(one, _Symbol) else self.constant(one) for one in operands)
        self.operations.append((operation, symbols))
        return _Symbol(self, "result", len(self.operations) - 1)

    def program(self, force: Any) -> Program:
        force = force if isinstance(force, _Symbol) else self.constant(force)
        first = INPUTS + len(self.constants)
        start = {"input": 0, "constant": INPUTS, "result": first}
        rows = np.zeros((len(self.operations), 5), np.int64)
        for place, (operation, operands) in enumerate(self.operations):
            rows[place, :2] = operation, first + place
            rows[place, 2 : 2 + len(operands)] = [start[one.kind] + one.place for one in operands]
        registers = np.zeros(first + len(self.operations))
        registers[INPUTS:first] = list(self.constants)
        return Program(rows, registers, start[force.kind] + force.place)


@dataclass(frozen=True, eq=False)
class _Symbol:
    """A number of a law that is not known yet."""

    recorder: _Recorder
    kind: str
    place: int

    def __add__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.ADD, self, other)

    def __radd__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.ADD, other, self)

    def __sub__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.SUBTRACT, self, other)

    def __rsub__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.SUBTRACT, other, self)

    def __mul__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.MULTIPLY, self, other)

    def __rmul__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.MULTIPLY, other, self)

    def __truediv__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.DIVIDE, self, other)

    def __rtruediv__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.DIVIDE, other, self)

    def __pow__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.POWER, self, other)

    def __rpow__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.POWER, other, self)

    def __neg__(self) -> _Symbol:
        return self.recorder.do(Operation.MULTIPLY, -1.0, self)

    def __pos__(self) -> _Symbol:
        return self

    def __abs__(self) -> _Symbol:
        return self.recorder.do(Operation.MAXIMUM, self, -self)

    def __gt__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.GREATER, self, other)

    def __lt__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.GREATER, other, self)

    def __ge__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.GREATER_EQUAL, self, other)

    def __le__(self, other: Any) -> _Symbol:
        return self.recorder.do(Operation.GREATER_EQUAL, other, self)

    def __eq__(self, other: object) -> bool:
        raise TypeError("it asks whether numbers are equal, one of which is not known yet; ask by >= and <=")

    __ne__ = __eq__
    __hash__ = object.__hash__

    def __bool__(self) -> bool:
        raise TypeError("it asks whether a number that is not known yet is true; use xp.where")

    def __float__(self) -> float:
        raise TypeError("it turns a number that is not known yet into a float; use the operations of xp")


class _RecordedOperations:
    """The operations a law may use (`contact.laws`), recorded."""

    def __init__(self, recorder: _Recorder) -> None:
        self._recorder = recorder

    def power(self, base: Any, exponent: Any) -> _Symbol:
        return self._recorder.do(Operation.POWER, base, exponent)

    def sqrt(self, value: Any) -> _Symbol:
        return self._recorder.do(Operation.SQRT, value)

    def where(self, condition: Any, yes: Any, no: Any) -> _Symbol:
        return self._recorder.do(Operation.WHERE, condition, yes, no)

    def maximum(self, first: Any, second: Any) -> _Symbol:
        return self._recorder.do(Operation.MAXIMUM, first, second)


def recorded(law: Law) -> Program:
    """Return a law as a program of deformation [m] above zero, rate [m/s] and velocity at first touch [m/s].

    Whether the bodies touch is asked by who evaluates it; the switch for tension is part of the program.

    Args:
        law: The law with its parameters.

    Raises:
        ContactError: The law's formula uses other operations than those of `xp`.
    """
    recorder = _Recorder()
    deformation, rate, approach = (_Symbol(recorder, "input", place) for place in range(INPUTS))
    operations = _RecordedOperations(recorder)
    try:
        force = law.compression(deformation, rate, approach, operations)
        if not law.tension:
            force = operations.maximum(force, 0.0)
    except (TypeError, AttributeError) as error:
        raise ContactError(
            f"{law.name}: the formula cannot be recorded for the exact solver ({error}); write it with +, -, *, /, "
            "<, <=, >, >= and xp.power, xp.sqrt, xp.where and xp.maximum, or run it with --solver exudyn"
        ) from None
    return recorder.program(force)
