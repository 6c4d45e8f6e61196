"""The folder that a collision leaves: data, plots of the forces, a still and, on request, a film."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from pounding.experiments.output.result_folder import Kept, prepare
from pounding.experiments.pictures import collision_scene
from pounding.experiments.pictures import contact_plots as plots_contact
from pounding.experiments.results import dataset as results
from pounding.experiments.rig.pounding import Pounding
from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.files import write_whole


def keep(
    runs: Sequence[Pounding],
    result: dict[str, Any],
    folder: Path,
    *,
    film: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Kept:
    """Write `pound.json`, one NetCDF file a law and, if the floors touched, plots and pictures.

    Args:
        runs: Runs that differ in their law; pictures show the first one that touched.
        result: What `pounding pound --json` prints.
        folder: Where to; made if it is not there.
        film: Also film the hardest collision in slow motion (`collision.mp4`).
        progress: Called with the share of the film that is done.

    Returns:
        What is in the folder now.

    Raises:
        FrameError: The folder or a file cannot be written; what was finished before is whole.
    """
    prepare(folder)
    files, notes, shown = [], [], None
    for run in runs:
        data = results.dataset(run.motion, run.record, provenance=result)
        files.append(f"{run.motion.contacts[0].law.name}.nc")
        results.save(data, folder / files[-1])
    touched = [run for run in runs if run.impacts]
    if touched:
        plots_contact.force_histories(runs, folder / "forces.png")
        plots_contact.loops(runs, folder / "loops.png")
        files += ["forces.png", "loops.png"]
        reason = cannot_render()
        if reason:
            notes.append(reason)
        else:
            collision_scene.still(touched[0], folder / "collision.png")
            files.append("collision.png")
            if film:
                shown = collision_scene.film(touched[0], folder / "collision.mp4", progress=progress)
                files.append("collision.mp4")
    write_whole(folder / "pound.json", (json.dumps(result, indent=2) + "\n").encode())
    return Kept([*files, "pound.json"], notes, shown)
