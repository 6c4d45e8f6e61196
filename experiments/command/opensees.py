"""`pounding opensees`: a stick as a script for OpenSeesPy."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pounding import frames
from pounding.experiments.console import options
from pounding.experiments.console.output import printer
from pounding.experiments.errors import ExperimentError
from pounding.frames.files import write_whole
from pounding.frames.opensees_script import script


def opensees(
    frame: str,
    file: Annotated[
        Path, Parameter(help="Script to write, such as office.py.", validator=options.writable_file)
    ],
    /,
    *,
    damping: options.Damping = None,
) -> None:
    """Write a stick as an OpenSeesPy script with the same mass, stiffness and damping, which prints its frequencies.

    A file that is there is not overwritten.

    Args:
        frame: Path of the frame file of a stick.
    """
    if file.suffix != ".py":
        raise ExperimentError(f"{file}: a script for OpenSeesPy ends in .py; write {file.name}.py")
    if file.exists():
        raise ExperimentError(f"{file} is there already; name another file, or remove it first")
    defined = frames.load(frame)
    if isinstance(defined, frames.PlateFrame):
        raise ExperimentError(
            f"frame {defined.name}: only a stick can be written for OpenSees; this one is of plates, whose mass couples "
            "its floors; make a stick with its floor masses and frequencies"
        )
    write_whole(file, script(frames.build(defined, damping=damping)).encode())
    printer().print(f"written: {file}; run it with OpenSeesPy: python {file}", markup=False, soft_wrap=True)
