"""Options that several verbs take alike, described once."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

Joints = Annotated[
    Literal["calibrated", "rigid"],
    Parameter(help="Stiffness between columns and floors: calibrated on the first frequency, or rigid."),
]
PDelta = Annotated[
    bool, Parameter(name="--p-delta", negative="--no-p-delta", help="Geometric stiffness of gravity.")
]
Damping = Annotated[
    float | None,
    Parameter(help="Damping ratio of every mode, a fraction (0.005 is 0.5 %); default: the frame's own."),
]
Records = Annotated[
    Path | None,
    Parameter(help="Folder with ground motions; default: POUNDING_RECORDS, then installed packages."),
]
Json = Annotated[
    bool,
    Parameter(name="--json", negative=(), help="Print one JSON object and nothing else on standard output."),
]
Out = Annotated[Path | None, Parameter(help="Folder for files; created if missing.")]
Pga = Annotated[
    float | None, Parameter(help="Peak of the table's acceleration [g]; default: the record's own.")
]
