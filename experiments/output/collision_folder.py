"""The folder that a collision leaves: data, plots of the forces, a still, a VTK series and, on request, a film."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pounding.experiments.output.result_folder import Kept, around, prepare
from pounding.experiments.pictures import collision_scene
from pounding.experiments.pictures import contact_plots as plots_contact
from pounding.experiments.pictures.series import write_series
from pounding.experiments.results import dataset as results
from pounding.experiments.rig.pounding import Pounding
from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.files import write_whole

CAPTIONS = {
    "forces.png": "Contact force [N] over time by each impact law, and its first impact closer.",
    "loops.png": "Contact force [N] over deformation [mm] in the hardest impact, by each impact law.",
    "collision.png": "The frames at the largest contact force, displacements enlarged; the arrow is the force.",
    "closest.png": "The frames when they come nearest to each other, displacements enlarged; they do not touch.",
}
"""What the pictures of the folder show."""


def keep(
    runs: Sequence[Pounding],
    result: dict[str, Any],
    folder: Path,
    *,
    film: bool = False,
    labels: Sequence[str] | None = None,
    progress: Callable[[float], None] | None = None,
) -> Kept:
    """Write `pound.json`, one NetCDF file a run, a VTK series, a still and, if the floors touched, plots of the force.

    Args:
        runs: Runs that differ in their law; still and series show the first one that touched, or the first of all.
        result: What `pounding pound --json` prints.
        folder: Where to; made if it is not there.
        film: Also film the hardest collision in slow motion (`collision.mp4`).
        labels: What the runs are called in plots and names of files; the names of their laws when None.
        progress: Called with the share of the film that is done.

    Returns:
        What is in the folder now.

    Raises:
        FrameError: The folder or a file cannot be written; what was finished before is whole.
    """
    prepare(folder)
    files, notes, shown = [], [], None
    for run, name in zip(runs, labels or ["-".join(run.laws) for run in runs], strict=True):
        data = results.dataset(run.motion, run.record, provenance=result)
        files.append(f"{name}.nc")
        results.save(data, folder / files[-1])
    touched = [run for run in runs if run.impacts]
    if touched:
        plots_contact.force_histories(runs, folder / "forces.png", labels=labels)
        plots_contact.loops(runs, folder / "loops.png", labels=labels)
        files += ["forces.png", "loops.png"]
    seen = (touched or list(runs))[0]
    if all(frame.reduced.is_mesh for frame in seen.motion.frames):
        times = around(seen.motion, collision_scene.moment(seen))
        write_series(seen.motion, times, folder / "series.pvd")
        files.append("series.pvd")
    reason = cannot_render()
    if reason:
        notes.append(reason)
    else:
        files.append("collision.png" if touched else "closest.png")
        collision_scene.still(seen, folder / files[-1])
        if film and touched:
            shown = collision_scene.film(seen, folder / "collision.mp4", progress=progress)
            files.append("collision.mp4")
        elif film:
            notes.append("no film: the floors did not touch; narrow the gap")
    write_whole(folder / "pound.json", (json.dumps(result, indent=2) + "\n").encode())
    return Kept([*files, "pound.json"], notes, shown)
