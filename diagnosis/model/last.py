"""What was worked out last, kept for the next time that the same is asked for: in each thread by itself.

Threads that refine different candidates ask for different things in turn, and would throw away what the others need.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable
from threading import get_ident
from typing import Generic, TypeVar

T = TypeVar("T")


class Last(Generic[T]):
    """Results by place, of which each thread keeps its last one."""

    def __init__(self) -> None:
        self._kept: dict[tuple[int, Hashable], tuple[Hashable, T]] = {}

    def of(self, key: Hashable, make: Callable[[], T], place: Hashable = None) -> T:
        """Return the result that belongs to a key: the one of the last time if the key is the same, else a new one.

        Args:
            key: All that the result depends on beside the place.
            make: Works it out.
            place: Of what it is, such as the number of a run.
        """
        where = get_ident(), place
        last = self._kept.get(where)
        if last is None or last[0] != key:
            self._kept[where] = last = key, make()
        return last[1]
