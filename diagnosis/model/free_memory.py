"""Memory that is free within the process, given back to the system."""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any


@cache
def _trim() -> Any:
    """Return glibc's `malloc_trim`; None where the C library is another one."""
    try:
        return ctypes.CDLL("libc.so.6").malloc_trim
    except (OSError, AttributeError):
        return None


def give_back() -> None:
    """Give memory that is free back to the system, where the C library is glibc; elsewhere nothing happens.

    Arrays of several megabytes that come and go in two threads leave its heap full of holes, which it keeps: a diagnosis of
    long runs grew by twice what it needs at a time.
    """
    trim = _trim()
    if trim is not None:
        trim(0)
