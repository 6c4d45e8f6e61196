"""A run as a series of VTK files that ParaView opens through one `.pvd`: motion and plate stress in time."""

from __future__ import annotations

import os
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pounding.experiments.errors import ExperimentError
from pounding.experiments.results.dataset import labels
from pounding.frames.drawing.shapes import Shape, shape_of
from pounding.frames.drawing.vtk import write
from pounding.frames.errors import FrameError
from pounding.frames.files import scratch, write_whole
from pounding.frames.response.stress import StressMap, stress_map

if TYPE_CHECKING:
    from pounding.experiments.rig.motion import FrameMotion, Motion

Real = NDArray[np.floating[Any]]


def write_series(motion: Motion, times_s: ArrayLike, path: str | Path) -> None:
    """Write the frames at some times as `.vtu` files in a folder beside a `.pvd` that lists them.

    Each file holds displacement [m], velocity [m/s] and acceleration [m/s^2] of the nodes relative to the
    table, and von Mises' stress of the elements [Pa]. Frames stand side by side, at rest their gaps apart. A
    series that was there is replaced once the new one is whole.

    Args:
        motion: The run.
        times_s: Times wanted (k,) [s].
        path: The ``.pvd`` file; the folder beside it has its name without the suffix.

    Raises:
        FrameError: The files cannot be written.
        ExperimentError: No times, or times outside the run.
    """
    path, times = Path(path), np.atleast_1d(np.asarray(times_s, float))
    if not times.size or times.min() < 0.0 or times.max() > motion.model_s + 1e-9:
        raise ExperimentError(f"series {path}: its times must lie in the run, 0 to {motion.model_s:.3f} s")
    entries = []
    try:
        with scratch(path.parent, path.stem) as folder:
            for number, (frame, name) in enumerate(zip(motion.frames, labels(motion), strict=True)):
                files = _frame_files(frame, name, times, folder, places(motion)[number])
                entries += [
                    (time, number, f"{path.stem}/{file}") for time, file in zip(times, files, strict=True)
                ]
            replace_folder(folder, path.with_suffix(""))
    except OSError as error:
        raise FrameError(f"{path}: cannot be written ({error.strerror or error})") from error
    write_whole(path, _collection(entries))


def places(motion: Motion, *, factor: float = 1.0) -> list[float]:
    """Return where the middle of each frame stands along x [m], the first at zero.

    Args:
        motion: The run; gaps come from its contacts, 10 mm where a pair has none.
        factor: Enlargement of the gaps, the same as that of drawn displacements, so that frames that touch in
            the picture touch.
    """
    found = [0.0]
    for left, right in pairwise(motion.frames):
        gaps = [c.gap_m for c in motion.contacts if (c.left, c.right) == (left.name, right.name)]
        gap = min(gaps, default=0.01)
        half = (left.reduced.plan_m[0] + right.reduced.plan_m[0]) / 2.0
        found.append(found[-1] + half + factor * gap)
    return found


def _frame_files(frame: FrameMotion, name: str, times: Real, folder: Path, place: float) -> list[str]:
    shape = shape_of(frame.reduced)
    stresses = stress_map(frame.reduced) if frame.reduced.is_mesh else None
    moved, rates = frame.sampled(times)
    accelerations = np.column_stack(
        [np.interp(times, frame.time_s, column) for column in frame.acceleration_m_s2.T]
    )
    standing = Shape(
        shape.nodes + [place, 0.0, 0.0], shape.quads, shape.level, shape.is_column, shape.follows
    )
    files = []
    for number, states in enumerate(zip(moved, rates, accelerations, strict=True)):
        files.append(f"{_plain(name)}_{number:05d}.vtu")
        _write_state(folder / files[-1], standing, states, stresses)
    return files


def _write_state(
    path: Path, shape: Shape, states: tuple[Real, Real, Real], stresses: StressMap | None
) -> None:
    names = ("displacement [m]", "velocity [m/s]", "acceleration [m/s^2]")
    points = {name: shape.moved(state).astype(np.float32) for name, state in zip(names, states, strict=True)}
    cells = {}
    if stresses is not None:
        cells["von Mises stress [Pa]"] = stresses.von_mises(states[0]).astype(np.float32)
    write(path, shape, point_data=points, cell_data=cells)


def _collection(entries: list[tuple[float, int, str]]) -> bytes:
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for time, part, file in entries:
        ElementTree.SubElement(
            collection, "DataSet", timestep=f"{time:.9g}", group="", part=str(part), file=file
        )
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def replace_folder(new: Path, folder: Path) -> None:
    """Put a new folder of a series in the place of the one that was there.

    Args:
        new: The new folder.
        folder: Where it goes.

    Raises:
        OSError: The old one holds other files, or the new one cannot be moved.
    """
    if folder.is_dir():
        for old in folder.glob("*.vtu"):
            old.unlink()
        # Only what is ours goes: a folder with other files in it stays, and is told as not empty.
        folder.rmdir()
    new.chmod(0o755)
    os.replace(new, folder)


def _plain(name: str) -> str:
    return "".join(letter if letter.isalnum() else "-" for letter in name)
