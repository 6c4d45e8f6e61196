"""`pounding new-street`: a street file to begin with."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pounding import bounds, frames
from pounding.experiments.console import options
from pounding.experiments.console.output import printer
from pounding.experiments.errors import ExperimentError
from pounding.frames.files import write_whole
from pounding.units import LENGTH

HEAD = """\
# Buildings in a row, from left to right, and the gaps between neighbours. Change the numbers; what begins with '#' may be
# left out. Try it: pounding gap {file} --record elcentro-chopra, then pounding pound {file} --record elcentro-chopra
"""

BUILDING = """
[[building]]
frame = {frame}
# name = "east"             # what results call it, if not by its frame's name
"""

GAP = """
[[gap]]                     # between {left} and {right}
gap_mm = {gap_mm:g}
"""

GAP_KEYS = """\
# floors = [3, 4]           # floors of the lower neighbour that can touch; its roof without this line
# law = "linear_viscoelastic"   # impact law, see pounding list
# restitution = 0.65        # and stiffness = 3.75e9 (N/m), or radius_m of a Hertz contact: what is known of the contact
# bumper = { thickness_mm = 40, area_m2 = 0.3 }   # a block of rubber in the gap, for the floors' own contact
# columns = { count = 4, depth_m = 0.5, width_m = 0.5 }   # where a floor hits the neighbour's columns
# y_m = [-5.0, 0.0, 5.0]    # places along the floors' edge, for floors that turn; a stick needs a table torsion for it
"""


def new_street(
    file: Annotated[
        Path, Parameter(help="File to write, such as street.toml.", validator=options.writable_file)
    ],
    /,
    *buildings: Annotated[str, Parameter(help="Frames from left to right, names or frame files.")],
    gap: Annotated[
        list[float] | None,
        Parameter(
            negative=(),
            help="Gap at rest [mm], one for all neighbours or one for each pair; default: 50.",
            validator=options.bounded(bounds.GAP, per=LENGTH["mm"], unit="mm"),
        ),
    ] = None,
) -> None:
    """Write a commented street file: buildings in a row and the gaps between them, for `pound`, `gap` and `shake`.

    A file that is there is not overwritten.
    """
    if file.suffix != ".toml":
        raise ExperimentError(f"{file}: a street file ends in .toml; write {file.name}.toml")
    if len(buildings) < 2:
        raise ExperimentError(
            f"{len(buildings)} building(s); a street has two or more, name their frames in a row"
        )
    if file.exists():
        raise ExperimentError(f"{file} is there already; name another file, or remove it first")
    for name in buildings:
        frames.load(name)
    pairs = len(buildings) - 1
    gaps = gap or [50.0]
    if len(gaps) not in (1, pairs):
        raise ExperimentError(
            f"{len(gaps)} gaps for {pairs} pair(s) of neighbours: give one for all, or one for each pair"
        )
    text = HEAD.format(file=file)
    for name in buildings:
        text += BUILDING.format(frame=json.dumps(_from(name, file.parent), ensure_ascii=False))
    for place, gap_mm in enumerate(gaps * (pairs // len(gaps))):
        text += GAP.format(left=buildings[place], right=buildings[place + 1], gap_mm=gap_mm)
        text += GAP_KEYS if place == 0 else ""
    write_whole(file, text.encode())
    printer().print(f"written: {file}; now try pounding gap {file}", markup=False, soft_wrap=True)


def _from(name: str, folder: Path) -> str:
    """Return a frame as a street file in a folder names it: relative paths begin there."""
    if name in frames.names() or Path(name).is_absolute():
        return name
    return Path(os.path.relpath(name, folder)).as_posix()
