"""The collision to look at: a still at the hardest impact, and a film of the moments around it."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures import films, scenes
from pounding.experiments.rig.pounding import Pounding

BEFORE_S, AFTER_S = 0.12, 0.18
"""What the film shows of the time before and after the hardest impact [s]."""

SLOWED = 0.05
"""Model seconds in a second of the film."""


def still(run: Pounding, path: str | Path, *, size: tuple[int, int] | None = None) -> None:
    """Draw both frames at the hardest impact, with the force at the contact as an arrow.

    Args:
        run: The run.
        path: Image file to write.
        size: Width and height [pixels].

    Raises:
        ExperimentError: The floors did not touch.
        FrameError: The machine cannot render, or the file cannot be written.
    """
    scenes.picture(run.motion, path, time_s=_hardest(run), title=_title(run), size=size)


def film(run: Pounding, path: str | Path, *, progress: Callable[[float], None] | None = None) -> films.Film:
    """Film the collision in slow motion, MP4 or GIF by the suffix.

    Args:
        run: The run.
        path: File to write.
        progress: Called with the share that is done, 0 to 1.

    Returns:
        What the film shows.

    Raises:
        ExperimentError: The floors did not touch, or another suffix.
        FrameError: The machine cannot render, or the file cannot be written.
    """
    moment = _hardest(run)
    return films.film(
        run.motion,
        path,
        start_s=max(0.0, moment - BEFORE_S),
        end_s=min(run.motion.model_s, moment + AFTER_S),
        speed=SLOWED,
        title=_title(run),
        progress=progress,
    )


def _hardest(run: Pounding) -> float:
    if not run.impacts:
        raise ExperimentError("no collision to show: the floors did not touch; narrow the gap")
    return scenes.largest_moment(run.motion)


def _title(run: Pounding) -> str:
    left, right = run.motion.frames
    return f"{left.name} beside {right.name}, {run.record.name}"
