"""Processes that test side by side, each on a core of its own."""

from __future__ import annotations

import os


def on_own_core(worker: str | None) -> None:
    """Keep a process that tests, and all that it starts, on one core, so that none takes what another one works on.

    What spreads its work over all cores it may use gains nothing where each of them tests already, and pays for it.

    Args:
        worker: Name of a process of pytest-xdist, "gw0" and so on; None where there is only one, which keeps all cores.
    """
    if worker is None or not hasattr(os, "sched_setaffinity"):
        return
    allowed = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {allowed[int(worker.removeprefix("gw")) % len(allowed)]})
