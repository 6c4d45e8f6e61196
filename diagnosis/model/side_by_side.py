"""Independent pieces of work on all cores: threads, because compiled loops and linear algebra let others run meanwhile.

Each piece gives the same number whichever thread does it and whenever, and results keep the order of the pieces: nothing
is ever added up in the order in which threads happen to finish.
"""

from __future__ import annotations

import multiprocessing
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextvars import copy_context
from functools import cache
from typing import TypeVar

from pounding.cores import cores as own_cores

T = TypeVar("T")
R = TypeVar("R")

_mine = threading.local()


def cores() -> int:
    """Return how many threads work side by side: one a core of this process, one in a worker process or within a piece."""
    if multiprocessing.parent_process() is not None or getattr(_mine, "busy", False):
        return 1
    return own_cores()


def side_by_side(
    function: Callable[[T], R], pieces: Sequence[T], told: Callable[[T], None] | None = None
) -> list[R]:
    """Return the function's result for each piece, in the order of the pieces.

    Args:
        function: Does a piece; it must change nothing that another piece reads.
        pieces: The pieces.
        told: Called with each piece as its turn comes, in the order of the pieces.
    """
    if cores() < 2 or len(pieces) < 2:
        return in_turn(function, pieces, told)

    def busy(piece: T) -> R:
        _mine.busy = True
        try:
            return function(piece)
        finally:
            _mine.busy = False

    # A thread knows nothing of its caller's context, such as what numpy is not to warn of.
    futures: list[Future[R]] = [_pool(cores()).submit(copy_context().run, busy, piece) for piece in pieces]
    results = []
    try:
        for piece, future in zip(pieces, futures, strict=True):
            if told is not None:
                told(piece)
            results.append(future.result())
    finally:
        for future in futures:
            future.cancel()
    return results


def in_turn(
    function: Callable[[T], R], pieces: Sequence[T], told: Callable[[T], None] | None = None
) -> list[R]:
    """Return the same, one piece after the other in this thread.

    Args:
        function: Does a piece.
        pieces: The pieces.
        told: Called with each piece as its turn comes.
    """
    results = []
    for piece in pieces:
        if told is not None:
            told(piece)
        results.append(function(piece))
    return results


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads, thread_name_prefix="diagnosis")
