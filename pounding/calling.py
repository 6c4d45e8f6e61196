"""Calls a compiled force by its address, so that the compiled loop over time need not know which function it is.

The loop stays compiled and cached whichever laws there are: a law's address comes with the effect's data.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
from llvmlite import ir
from numba import cfunc, njit, types
from numba.extending import intrinsic
from numba.np.unsafe.ndarray import to_fixed_tuple

PARAMETERS = 5
"""How many parameters a force may have."""
STEP = PARAMETERS
"""Place after the parameters of the time [s] over which a force's mean is wanted: a solver's step, 0 for one moment."""
NUMBERS = PARAMETERS + 1
"""How many numbers a force is given: its parameters and this time."""
MEMORY = 4
"""How many numbers a force may remember."""

# numba says neither what it exports nor of which type.
_untyped: Any = numba
_array = _untyped.carray
_POINTER = _untyped.types.CPointer(types.double)
_SIGNATURE = types.double(_POINTER, _POINTER, types.double, types.double, types.double, _POINTER)


def _typed(context: Any, address: Any, p: Any, state: Any, d: Any, v: Any, t: Any, new: Any) -> Any:
    """Call the C function at an address with pointers to parameters, memory and new memory, and three numbers."""
    del context
    number, place = types.double, types.intp
    signature = number(place, place, place, number, number, number, place)

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        del context, signature
        double, pointer = ir.DoubleType(), ir.DoubleType().as_pointer()
        kind = ir.FunctionType(double, [pointer, pointer, double, double, double, pointer])
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        p, state, new = (builder.inttoptr(arguments[i], pointer) for i in (1, 2, 6))
        return builder.call(function, [p, state, *arguments[3:6], new])

    del address, p, state, d, v, t, new
    return signature, codegen


_call: Any = intrinsic(_typed)
_as_tuple: Any = to_fixed_tuple


@njit(cache=True)
def called(address: int, p: Any, state: Any, d: float, v: float, t: float, new: Any) -> float:
    """Return the force [N] at drift d [m], rate v [m/s] and time t [s] of the law at an address.

    Args:
        address: Where the law's compiled function is.
        p: Its parameters in SI and at `STEP` the step [s], contiguous float64, shape (NUMBERS,).
        state: What it remembers, contiguous float64, shape (MEMORY,); it is read only.
        d, v, t: Drift, its rate, and the time since the run began.
        new: What it would remember from now on is written here, contiguous float64, shape (MEMORY,).
    """
    force: float = _call(address, p.ctypes.data, state.ctypes.data, d, v, t, new.ctypes.data)
    return force


@njit(cache=True)
def called_at(address: int, p: int, state: int, d: float, v: float, t: float, new: int) -> float:
    """Return the same as `called`, where parameters, memory and new memory are given by their addresses.

    It spares the compiled loop the views of its rows, which cost more than most laws.

    Args:
        address: Where the law's compiled function is.
        p: Address of these numbers, contiguous float64.
        state: Address of what it remembers, contiguous float64; it is read only.
        d, v, t: Drift [m], its rate [m/s], and the time since the run began [s].
        new: Address at which it writes what it would remember from now on, contiguous float64.
    """
    force: float = _call(address, p, state, d, v, t, new)
    return force


def entry(function: Callable[..., float], cache: bool = True) -> Any:
    """Return a C callback of ``function(p, state, d, v, t, new)``; `.address` is what `called` takes.

    The result must be kept alive as long as its address is in use.

    Raises:
        numba.core.errors.NumbaError: The function uses what numba does not compile.
    """
    # Division by zero gives inf or NaN as in numpy: an exception could not leave the compiled loop.
    return cfunc(_SIGNATURE, error_model="numpy", cache=cache)(function)


def with_parameters(function: Callable[..., float], count: int) -> Callable[..., float]:
    """Return ``function(d, v, t, *parameters)`` of `count` parameters and no memory in the form that `entry` takes."""
    inner = njit(error_model="numpy")(function)

    def force(p: Any, state: Any, d: float, v: float, t: float, new: Any) -> Any:
        return inner(d, v, t, *_as_tuple(_array(p, (count,)), count))

    return force
