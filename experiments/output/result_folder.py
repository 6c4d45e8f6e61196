"""The folder that a shaking leaves: data, plots, pictures, VTK files and, on request, a film and CSV."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from pounding.experiments import published
from pounding.experiments.measurements.history import Channel
from pounding.experiments.pictures import films, plots, scenes
from pounding.experiments.pictures.series import write_series
from pounding.experiments.results import dataset as results
from pounding.experiments.rig.motion import Motion
from pounding.experiments.rig.shaking import Shaking
from pounding.frames import names
from pounding.frames.drawing.rendering import cannot_render
from pounding.frames.files import tried_folder, write_whole

SERIES_S = 1.0
"""The VTK series covers so long before and after the largest roof displacement or contact force [s]."""

SERIES_STEP_S = 0.02
"""Step of the VTK series [s]: twenty states in a period of the tallest frame."""


@dataclass(frozen=True)
class Wish:
    """What to keep of a shaking beside data, plots, a picture and a VTK series."""

    csv: bool = False
    film: bool = False
    measured: Sequence[Channel] = ()


class Kept(NamedTuple):
    """What a result folder holds.

    Attributes:
        files: Names of the files.
        notes: A sentence for each thing that could not be made.
        film: What the film shows, if one was made.
    """

    files: list[str]
    notes: list[str]
    film: films.Film | None = None


def prepare(folder: Path) -> None:
    """See that a folder for results can be made and written, before anything is computed; it is made with its first file.

    Raises:
        FrameError: It cannot be made or written.
    """
    tried_folder(folder)


def keep(
    shaking: Shaking,
    data: xr.Dataset,
    result: dict[str, Any],
    folder: Path,
    *,
    wish: Wish = Wish(),
    progress: Callable[[str, float], None] | None = None,
) -> Kept:
    """Write everything that a shaking leaves into a folder.

    Args:
        shaking: The run.
        data: The run as a labelled dataset.
        result: What is printed, kept as ``shake.json``.
        folder: Where to write.
        wish: What else to keep.
        progress: Called with what is being made and the share that is done.

    Returns:
        What is in the folder now.

    Raises:
        FrameError: A file cannot be written; what was finished before is whole.
    """
    told = progress or (lambda _what, _share: None)
    title = f"Frame {shaking.reduced.name}, {shaking.record.name}, {shaking.record.pga_g:.3f} g"
    told("data", 0.0)
    results.save(data, folder / "shake.nc")
    files = ["shake.nc"]
    if wish.csv:
        results.save_csv(data, folder / "shake.csv")
        files.append("shake.csv")
    told("plots", 0.1)
    files += _plots(shaking, data, folder, wish, title)
    if shaking.reduced.is_mesh:
        told("VTK series", 0.3)
        write_series(shaking.motion, around(shaking.motion), folder / "series.pvd")
        files.append("series.pvd")
    told("pictures", 0.5)
    reason, film = cannot_render(), None
    if reason is None:
        scenes.picture(shaking.motion, folder / "peak.png", title=title)
        files.append("peak.png")
        if wish.film:
            film = _film(shaking, folder / "film.mp4", title, told)
            files.append("film.mp4")
    write_whole(folder / "shake.json", (json.dumps(result, indent=2) + "\n").encode())
    return Kept([*files, "shake.json"], [reason] if reason else [], film)


CAPTIONS = {
    "history.png": "The table's acceleration [g] and the displacement of floors relative to the table [mm] over time.",
    "measured.png": "The measured channels over the run, each in its own unit.",
    "peak.png": "The frame at its largest displacement, enlarged, with the von Mises stress of its columns [MPa].",
    "spectra.png": "Response and Fourier spectra of the table's motion; dashed: the frame's first natural frequencies.",
}
"""What the pictures of the folder show."""


def written(result: Mapping[str, Any]) -> Iterator[str]:
    """Say which files were written and what a film shows, if anything was kept."""
    if "files" in result:
        yield f"written: {', '.join(result['files'])}"
    if result.get("film"):
        yield f"film: {films.Film(**result['film'])}"


def published_peaks(frame: str, record: str) -> dict[int, tuple[float, float]]:
    """Return the measured peaks of Table 4.1 by floor (maximum, minimum; both positive) [mm], if any."""
    table = published.table("4.1")
    if frame not in names() or frame not in table.index.get_level_values("frame"):
        return {}
    if record not in table.columns.get_level_values("record"):
        return {}
    rows = table.loc[frame][record]["experiment"]
    return {int(floor): (float(row["max"]), float(row["min"])) for floor, row in rows.iterrows()}


def _plots(shaking: Shaking, data: xr.Dataset, folder: Path, wish: Wish, title: str) -> list[str]:
    name = shaking.reduced.name
    peaks = published_peaks(name, shaking.record.name) if shaking.record.is_as_in_the_laboratory else {}
    floors = sorted(set(peaks) | {shaking.reduced.storeys}, reverse=True)
    plots.history(data, folder / "history.png", frame=name, floors=floors, published_mm=peaks, title=title)
    frequencies = shaking.reduced.frequencies_hz[:3]
    plots.spectra(
        shaking.record,
        folder / "spectra.png",
        damping_ratio=shaking.reduced.damping_ratio,
        marks_hz={f"mode {mode + 1}": float(value) for mode, value in enumerate(frequencies)},
        title=title,
    )
    files = ["history.png", "spectra.png"]
    if plots.overlay(data, wish.measured, folder / "measured.png", frame=name, title=title):
        files.append("measured.png")
    return files


def _film(shaking: Shaking, path: Path, title: str, told: Callable[[str, float], None]) -> films.Film:
    return films.film(
        shaking.motion, path, title=title, progress=lambda share: told("film", 0.6 + 0.4 * share)
    )


def around(motion: Motion, moment_s: float | None = None) -> NDArray[np.floating[Any]]:
    """Return the times (k,) [s] of a VTK series around a moment of a run.

    Args:
        motion: The run.
        moment_s: The moment [s]; that of the largest contact force or roof displacement when None.
    """
    moment = scenes.largest_moment(motion) if moment_s is None else moment_s
    start, end = max(0.0, moment - SERIES_S), min(motion.model_s, moment + SERIES_S)
    return np.arange(start, end, SERIES_STEP_S)
