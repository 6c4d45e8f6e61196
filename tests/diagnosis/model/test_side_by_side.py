"""Independent pieces on several threads, or in worker processes: results in the order of the pieces, no threads within."""

from __future__ import annotations

import multiprocessing
import os
import threading
import time
from collections.abc import Callable
from typing import Literal

import numpy as np
import pytest

from pounding.diagnosis.model.forked import forked
from pounding.diagnosis.model.side_by_side import cores, side_by_side


@pytest.fixture(autouse=True)
def two_cores(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 1}, raising=False)
    monkeypatch.setattr(multiprocessing, "parent_process", lambda: None)


@pytest.mark.parametrize("together", [side_by_side, forked])
def test_results_keep_the_order_of_the_pieces_whichever_ends_first(
    together: Callable[[Callable[[int], int], list[int], Callable[[int], None]], list[int]],
) -> None:
    def slow(piece: int) -> int:
        time.sleep(0.02 * (3 - piece))
        return piece * piece

    heard: list[int] = []
    assert together(slow, [0, 1, 2], heard.append) == [0, 1, 4]
    assert heard == [0, 1, 2]


def test_pieces_run_at_the_same_time() -> None:
    both = threading.Barrier(2, timeout=10.0)
    assert sorted(side_by_side(lambda _: both.wait(), [0, 1])) == [0, 1]


def test_a_piece_has_no_further_threads() -> None:
    """Else two fits of two runs each would be four threads on two cores."""
    assert side_by_side(lambda _: cores(), [0, 1, 2]) == [1, 1, 1]
    assert cores() == 2


@pytest.mark.parametrize("together", [side_by_side, forked])
@pytest.mark.parametrize("over", ["ignore", "raise"])
def test_a_piece_warns_of_what_its_caller_warns_of(
    over: Literal["ignore", "raise"], together: Callable[[Callable[[int], str], list[int]], list[str]]
) -> None:
    with np.errstate(over=over):
        assert together(lambda _: np.geterr()["over"], [0, 1]) == [over, over]


def test_an_error_in_a_piece_is_the_callers() -> None:
    def fails(piece: int) -> int:
        raise ValueError(f"piece {piece}")

    with pytest.raises(ValueError, match="piece 0"):
        side_by_side(fails, [0, 1])
