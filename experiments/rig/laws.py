"""Laws: forces that oppose a drift, each one compiled definition for both solvers and for the diagnosis.

A law is a function of its parameters, its memory, the drift, its rate and the time (see `Law`). It never changes its
memory but writes the new one elsewhere, so that a solver may try a step and take it back; a law without memory leaves
both alone.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from functools import cached_property
from typing import Any, Protocol

import numpy as np
from numba import njit

from pounding.calling import MEMORY, NUMBERS, STEP, called, entry

_COMPILING = threading.Lock()


class Numbers(Protocol):
    """Numbers by their places: pointers where a law is compiled, an array or a list where it is called from Python."""

    def __getitem__(self, place: int, /) -> float: ...

    def __setitem__(self, place: int, number: float, /) -> None: ...


Force = Callable[[Numbers, Numbers, float, float, float, Numbers], float]
"""What a law is made of; see `Law`."""


class Law:
    """A force that opposes a drift, compiled when it is first used.

    The function is ``force(p, state, d, v, t, new)`` of the law's parameters `p` in SI, what it remembers `state`, the drift
    `d` [m], its rate `v` [m/s] and the time `t` [s] since the run began. It returns the force [N] and writes to `new` what
    it remembers if the motion really goes to `d`. After the parameters `p` has the step (`calling.STEP`) over which the mean
    force is wanted, for a force that begins or ends within it.

    Args:
        function: The force, written for numba.
        remembers: Whether it has a memory.
        followed: How many numbers of its memory slopes follow: those after them, as where it turned last, change at once.
        cache: Whether the compiled function is kept on disk, which needs a function of a module.
    """

    def __init__(
        self, function: Force, *, remembers: bool = False, followed: int = MEMORY, cache: bool = True
    ) -> None:
        self.function, self.remembers, self._cache = function, remembers, cache
        self.followed = followed if remembers else 0

    @cached_property
    def _entry(self) -> Any:
        return entry(self.function, self._cache)

    def compile(self) -> None:
        """Compile the function now.

        Raises:
            numba.core.errors.NumbaError: The function uses what numba does not compile.
        """
        _ = self._entry

    @property
    def address(self) -> int:
        """Where the compiled function is, for `calling.called`."""
        with _COMPILING:
            # Of two threads that compile it, one would keep what the other throws away.
            return int(self._entry.address)

    def along(
        self, parameters: tuple[float, ...], drift: np.ndarray, rate: np.ndarray, time: np.ndarray
    ) -> np.ndarray:
        """Return the force [N] along a motion that begins at rest, shape (samples,).

        Args:
            parameters: In SI; NaN stands for the end of the motion.
            drift, rate, time: Drift [m], its rate [m/s] and times [s], each (samples,).
        """
        return along(self.address, filled(parameters, float(time[-1])), drift, rate, time)


def memoryless(function: Force) -> Law:
    """Return the law of a force without memory; used as a decorator."""
    return Law(function)


def remembering(function: Force) -> Law:
    """Return the law of a force with memory; used as a decorator."""
    return Law(function, remembers=True)


def remembering_turns(followed: int) -> Callable[[Force], Law]:
    """Return a decorator for a force that also remembers where it turned.

    Args:
        followed: How many numbers of its memory come before those that say where.
    """
    return lambda function: Law(function, remembers=True, followed=followed)


def filled(parameters: tuple[float, ...], end_s: float, step_s: float = 0.0) -> np.ndarray:
    """Return parameters as a law takes them, shape (NUMBERS,).

    Args:
        parameters: In SI; NaN stands for the run's end.
        end_s: The run's end [s].
        step_s: Step [s] over which the force's mean is wanted; zero for the force at one moment.
    """
    padded = np.zeros(NUMBERS)
    padded[STEP] = step_s
    padded[: len(parameters)] = [end_s if np.isnan(number) else number for number in parameters]
    return padded


def along(
    address: int, parameters: np.ndarray, drift: np.ndarray, rate: np.ndarray, time: np.ndarray
) -> np.ndarray:
    """Return the force [N] of the law at an address along a motion that begins at rest, shape (samples,).

    Args:
        address: Where its compiled function is.
        parameters: As `filled` returns them, shape (NUMBERS,).
        drift, rate, time: Drift [m], its rate [m/s] and times [s], each (samples,).
    """
    motion = (np.ascontiguousarray(series, float) for series in (drift, rate, time))
    return np.asarray(_along(address, np.ascontiguousarray(parameters, float), *motion))


@njit(cache=True)
def _along(
    address: int, parameters: np.ndarray, drift: np.ndarray, rate: np.ndarray, time: np.ndarray
) -> np.ndarray:
    state, new = np.zeros(MEMORY), np.zeros(MEMORY)
    force = np.empty(drift.size)
    for k in range(drift.size):
        force[k] = called(address, parameters, state, drift[k], rate[k], time[k], new)
        # Number by number: for whole rows numba compiles messages about shapes, which takes longer than the loop itself.
        for i in range(MEMORY):
            state[i] = new[i]
    return force
