"""Calls a compiled force by its address, so that the compiled loop over time need not know which function it is.

The loop stays compiled and cached whatever a user writes: the function's address comes with the effect's data.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import carray, cfunc, njit, types
from numba.extending import intrinsic
from numba.np.unsafe.ndarray import to_fixed_tuple

PARAMETERS = 5
"""How many parameters a force may have."""

_SIGNATURE = types.double(types.double, types.double, types.double, types.CPointer(types.double))


def _typed(context: Any, address: Any, d: Any, v: Any, t: Any, pointer: Any) -> Any:
    """Call the C function at an address with three numbers and a pointer to its parameters."""
    del context
    signature = types.double(types.intp, types.double, types.double, types.double, types.intp)

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        del context, signature
        double, pointer_type = ir.DoubleType(), ir.DoubleType().as_pointer()
        kind = ir.FunctionType(double, [double, double, double, pointer_type])
        function = builder.inttoptr(arguments[0], kind.as_pointer())
        place = builder.inttoptr(arguments[4], pointer_type)
        return builder.call(function, [*arguments[1:4], place])

    del address, d, v, t, pointer
    return signature, codegen


_call: Any = intrinsic(_typed)
_as_tuple: Any = to_fixed_tuple


@njit(cache=True)
def called(address: int, p: Any, d: float, v: float, t: float) -> float:
    """Return the force [N] at drift d [m], rate v [m/s] and time t [s] of the function at an address.

    `p` are its parameters in SI, a contiguous float64 array of at least as many as the function takes.
    """
    return _call(address, d, v, t, p.ctypes.data)


def compiled(function: Callable[..., float], count: int) -> Any:
    """Return a C callback of ``function(d, v, t, *parameters)`` with `count` parameters; `.address` is what `called` takes.

    The result must be kept alive as long as its address is in use.

    Raises:
        numba.core.errors.NumbaError: The function uses what numba does not compile.
    """
    # Division by zero gives inf or NaN as in numpy: an exception could not leave the compiled loop.
    inner = njit(error_model="numpy")(function)

    @cfunc(_SIGNATURE, error_model="numpy")
    def entry(d, v, t, pointer):
        return inner(d, v, t, *_as_tuple(carray(pointer, (count,)), count))

    return entry
