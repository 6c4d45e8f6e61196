"""Memory that is free within the process, given back to the system."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

OWN_PAGES = 131_072
"""Arrays from this size on [bytes] get pages of their own in a long case."""
M_MMAP_THRESHOLD = -3
"""The parameter's number in glibc's malloc.h."""


@cache
def _glibc() -> Any:
    """Return the C library where it is glibc, else None."""
    try:
        library = ctypes.CDLL("libc.so.6")
        return library if hasattr(library, "malloc_trim") else None
    except OSError:
        return None


def give_back() -> None:
    """Give memory that is free back to the system, where the C library is glibc; elsewhere nothing happens.

    Arrays of several megabytes that come and go in two threads leave its heap full of holes, which it keeps: a diagnosis of
    long runs grew by twice what it needs at a time.
    """
    library = _glibc()
    if library is not None:
        library.malloc_trim(0)


def keep_no_holes() -> None:
    """Let arrays go back to the system as soon as they are free, where the C library is glibc, in this process from now on.

    glibc would let ever larger arrays share its heap, and holes between them can be given back only in part. Pages of their
    own cost some time: they are worth it where runs are long.
    """
    library = _glibc()
    if library is not None:
        library.mallopt(M_MMAP_THRESHOLD, OWN_PAGES)
