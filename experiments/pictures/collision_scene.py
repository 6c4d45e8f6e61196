"""The collision to look at: a still at the hardest impact or closest approach, and a film of an impact."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pounding.experiments.errors import ExperimentError
from pounding.experiments.pictures import films, scenes
from pounding.experiments.rig.pounding import Pounding

BEFORE_S, AFTER_S = 0.12, 0.18
"""What the film shows of the time before and after the hardest impact [s]."""

SLOWED = 0.05
"""Model seconds in a second of the film."""


def still(
    run: Pounding,
    path: str | Path | None = None,
    *,
    size: tuple[int, int] | None = None,
    scene: Any = None,
) -> Any:
    """Draw both frames at the hardest impact, with the force as an arrow, or where they came closest without touching.

    Args:
        run: The run.
        path: Image file to write; none when None.
        size: Width and height [pixels].
        scene: A pyvista plotter to draw into; a new one when None.

    Returns:
        The plotter; one that was made here stays open if no file was asked for.

    Raises:
        FrameError: The machine cannot render, or the file cannot be written.
    """
    at = moment(run)
    return scenes.picture(run.motion, path, time_s=at, title=_title(run), size=size, scene=scene)


def moment(run: Pounding) -> float:
    """Return the time [s] of the largest contact force or, without an impact, of the closest approach."""
    if run.impacts:
        return scenes.largest_moment(run.motion)
    closest = max(run.motion.contacts, key=lambda contact: float(contact.deformation_m.max()))
    return float(closest.time_s[closest.deformation_m.argmax()])


def film(run: Pounding, path: str | Path, *, progress: Callable[[float], None] | None = None) -> films.Film:
    """Film the collision in slow motion, MP4 or GIF by the suffix, always into a file, as `films.film` does.

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
    if not run.impacts:
        raise ExperimentError("no collision to film: the floors did not touch; narrow the gap")
    middle = moment(run)
    return films.film(
        run.motion,
        path,
        start_s=max(0.0, middle - BEFORE_S),
        end_s=min(run.motion.model_s, middle + AFTER_S),
        speed=SLOWED,
        title=_title(run),
        progress=progress,
    )


def _title(run: Pounding) -> str:
    return f"{run.beside}, {run.record.name}"
