"""How long a piece of work takes and how much memory: said before it starts, so that nobody waits without a word.

Each kind of work has one function. Their factors are rounded measurements on one core of a common computer, good to a
factor of some three: enough to tell a minute from an hour.
"""

from __future__ import annotations

import math
import os
from collections.abc import Sequence
from dataclasses import dataclass

from rich.console import Console

from pounding import bounds
from pounding.cores import cores
from pounding.errors import InputError
from pounding.experiments.rig.rig import APART
from pounding.frames import Frame, PlateFrame, ReducedFrame
from pounding.frames.fe.mesh import node_count

SAID_S = 60.0
"""What takes longer is announced [s]."""

DAY_S = 86400.0
GIGABYTE = 1e9


@dataclass(frozen=True)
class Work:
    """A piece of work.

    Attributes:
        what: What it is, the subject of a sentence.
        seconds: Time on one core [s].
        gigabytes: Memory [GB].
    """

    what: str
    seconds: float
    gigabytes: float = 0.0


def of_frame(frame: Frame, up_to_hz: float = 0.0) -> Work:
    """Return the work of reducing a frame or of finding its modes up to a frequency.

    Args:
        frame: The frame; a stick costs nothing.
        up_to_hz: Highest frequency of all modes that are shown [Hz].

    Raises:
        FrameError: Its mesh is too large for any computer.
    """
    nodes = node_count(frame) if isinstance(frame, PlateFrame) else 0
    solving = 1e-4 * nodes * (1.0 + (nodes / 12e3) ** 1.5)
    return Work(f"building frame {frame.name}", solving * (1.0 + (up_to_hz / 77.0) ** 2), 35e-6 * nodes)


def of_run(frames: Sequence[ReducedFrame], duration_s: float, runs: int = 1) -> Work:
    """Return the work of shaking frames on one table.

    Args:
        frames: Frames on the table.
        duration_s: Length of the shaking [s].
        runs: How often they are shaken.
    """
    size = sum(len(frame.mass) for frame in frames)
    highest_hz = max(float(frame.frequencies_hz.max()) for frame in frames)
    # An explicit integrator must resolve the fastest mode.
    steps = duration_s * max(1.0 / APART.longest_step_s, 2.0 * math.pi * highest_hz / 3.0)
    return Work(
        f"shaking {' and '.join(frame.name for frame in frames)}",
        runs * steps * (2e-5 + 2.5e-8 * size**2),
        runs * steps * (size + 1) * 72.0 / GIGABYTE,
    )


def of_gap(frames: Sequence[ReducedFrame], duration_s: float, step_s: float) -> Work:
    """Return the work of computing the required gap of two frames with its spread and all floors.

    Args:
        frames: The frames.
        duration_s: Length of the shaking [s].
        step_s: Step at which motions are looked at [s].
    """
    samples, storeys = duration_s / step_s, [frame.storeys for frame in frames]
    return Work(
        f"the gap between {' and '.join(frame.name for frame in frames)}",
        3e-7 * samples * sum(storeys),
        5e-8 * samples * max(storeys),
    )


def of_experiments(count: int) -> Work:
    """Return the work of running so many experiments of the thesis with their pictures, finished ones not counted."""
    return Work("running the experiments, unless they are kept from before,", 11.0 * count, 1.7)


def of_hiding(frames: int, effects: int, duration_s: float) -> Work:
    """Return the work of making a case with hidden effects.

    Args:
        frames: Frames on the table.
        effects: Effects to hide, each tried at several sizes.
        duration_s: Length of each run [s].
    """
    return Work("making the case", 0.05 * frames**2 * duration_s * (6 + 7 * effects), 0.3)


def of_calibration(minutes: float) -> Work:
    """Return the work of `--calibrate`, which ends after so many minutes."""
    return Work("the calibration, unless it is kept from before,", 60.0 * minutes, 0.6)


def of_diagnosis(samples: int, floors: int, touching: bool = False) -> Work:
    """Return the work of a diagnosis.

    Args:
        samples: Samples of all runs that it looks at.
        floors: Floors of all frames.
        touching: Whether frames touch: their forces are put right again and again.
    """
    each = 3e-3 if touching else 1e-3
    return Work("the diagnosis", each * samples * floors, 0.6 + each * 1e-3 * samples * floors)


def of_benchmark(cases: int) -> Work:
    """Return the work of judging a diagnosis on hidden cases, finished ones not counted."""
    return Work(f"judging {cases} cases", 40.0 * cases / cores())


def announce(*works: Work) -> None:
    """Say on standard error what takes more than a minute, and refuse what would not end or not fit into memory.

    Args:
        works: Pieces of work, done one after the other.

    Raises:
        InputError: Together they take longer than anybody waits, or one needs more memory than this computer has.
    """
    seconds = sum(work.seconds for work in works)
    longest = max(works, key=lambda work: work.seconds)
    largest = max(works, key=lambda work: work.gigabytes)
    bounds.WORK.check(seconds / DAY_S, f"the time that {longest.what} takes")
    installed = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / GIGABYTE
    if largest.gigabytes > installed:
        raise InputError(
            f"{largest.what} takes about {largest.gigabytes:.0f} GB of memory and this computer has "
            f"{installed:.0f}; ask for less"
        )
    if seconds > SAID_S:
        Console(stderr=True, highlight=False, soft_wrap=True).print(
            f"{longest.what} takes about {in_words(seconds)} on one core and {largest.gigabytes:.1f} GB of memory",
            markup=False,
        )


def remaining(elapsed_s: float, finished: int, missing: int, at_most_s: float = math.inf) -> str:
    """Return the time that remains in words, to follow others; nothing before the first case is finished.

    Args:
        elapsed_s: Time since the work began [s].
        finished: Cases finished since then.
        missing: Cases still to do.
        at_most_s: Time after which the work ends anyway [s].
    """
    if not finished or not missing:
        return ""
    return f", about {in_words(min(elapsed_s / finished * missing, max(at_most_s, 0.0)))} remain"


def in_words(seconds: float) -> str:
    """Return a time [s] rounded, in the unit that fits."""
    for unit, length in (("days", DAY_S), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 1.5 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.0f} s"
