"""`pounding new-frame`: a frame file to begin with."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from pounding.experiments.console import options
from pounding.experiments.console.output import printer
from pounding.experiments.errors import ExperimentError
from pounding.frames.files import write_whole
from pounding.frames.templates import template

A_NAME = re.compile(r"[\w. -]+")


def new_frame(
    file: Annotated[
        Path, Parameter(help="File to write, such as office.toml.", validator=options.writable_file)
    ],
    /,
    *,
    plates: Annotated[
        bool,
        Parameter(negative=(), help="Floors and columns as finite elements instead of one mass a floor."),
    ] = False,
) -> None:
    """Write a commented frame file that runs as it stands, to be changed into a frame of your own.

    The frame has the name of the file. A file that is there is not overwritten.
    """
    if file.suffix != ".toml":
        raise ExperimentError(f"{file}: a frame file ends in .toml; write {file.name}.toml")
    if not A_NAME.fullmatch(file.stem):
        raise ExperimentError(
            f"{file}: the frame gets the name of the file; use letters, digits, '-', '_' and blanks"
        )
    if file.exists():
        raise ExperimentError(f"{file} is there already; name another file, or remove it first")
    write_whole(file, template("plate" if plates else "stick", file.stem).encode())
    printer().print(
        f"written: {file}; change its numbers, then try pounding modal {file}", markup=False, soft_wrap=True
    )
