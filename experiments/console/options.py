"""Options that several verbs take alike, described once."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from pounding import bounds
from pounding.bounds import Bound
from pounding.experiments.console.completion import Frames, Laws
from pounding.experiments.console.completion import Records as KnownRecords
from pounding.experiments.rig.states import State as FrameState
from pounding.frames.files import tried_file, tried_folder


def bounded(bound: Bound, *, per: float = 1.0, unit: str | None = None) -> Callable[[object, Any], None]:
    """Return a check of an option's values, one or several, by the table of physical bounds.

    Args:
        bound: Their bound.
        per: The bound's unit for one unit of the option.
        unit: Unit of the option; the bound's own when None.
    """

    def check(_kind: object, value: Any) -> None:
        for one in value if isinstance(value, list) else [value]:
            if one is not None:
                bound.check(one, "the value", per=per, unit=unit)

    return check


def writable_folder(_kind: object, folder: Path | None) -> None:
    """Refuse a folder that cannot be written, when the words of the command are read."""
    if folder is not None:
        tried_folder(folder)


def writable_file(_kind: object, path: Path | None) -> None:
    """Refuse a file that cannot be written, when the words of the command are read."""
    if path is not None:
        tried_file(path)


def report_file(_kind: object, path: Path | None) -> None:
    """Refuse a report that is no HTML file, as one of the command's own files would be, or cannot be written."""
    if path is not None:
        if path.suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"a report is an HTML file; call it {path.with_suffix('.html').name}")
        tried_file(path)


# What the Tab key offers; any other name or file is taken too.
_OPEN = Parameter(show_choices=False, metavar="NAME")
FrameName = Annotated[Frames | str, _OPEN]
RecordName = Annotated[KnownRecords | str, _OPEN]
LawName = Annotated[Laws | str, _OPEN]
Solver = Annotated[
    Literal["exudyn", "exact"],
    Parameter(
        help="exudyn, or exact: closed formulas between impacts, much quicker, for frames that are "
        "linear apart from their contacts."
    ),
]
Joints = Annotated[
    Literal["calibrated", "rigid"],
    Parameter(help="Stiffness between columns and floors: calibrated on the first frequency, or rigid."),
]
State = Annotated[
    FrameState | None,
    Parameter(
        help="State of the laboratory's frames, first frequency and damping: free-vibration (default), sweep, or "
        "strong-motion, which depends on what stands on the table and is fitted to Table 4.1."
    ),
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
RecordUnit = Annotated[
    str | None,
    Parameter(
        name="--record-unit",
        help="Unit of acceleration of a record's file that names none: g, m/s2, cm/s2 or gal, mm/s2, mg, ft/s2, in/s2.",
    ),
]
Json = Annotated[
    bool,
    Parameter(name="--json", negative=(), help="Print one JSON object and nothing else on standard output."),
]
Out = Annotated[
    Path | None, Parameter(help="Folder for files; created if missing.", validator=writable_folder)
]
TimeFactor = Annotated[
    float | None,
    Parameter(
        help="Factor on the record's time; default: that of the frames' scale, 1 for buildings and 0.1826 at 1:30.",
        validator=bounded(bounds.TIME_FACTOR),
    ),
]
Pga = Annotated[
    float | None,
    Parameter(
        help="Peak of the table's acceleration [g]; default: the record's own.", validator=bounded(bounds.PGA)
    ),
]
Seed = Annotated[int, Parameter(help="Seed of all random numbers.", validator=bounded(bounds.SEED))]
Workers = Annotated[
    int | None,
    Parameter(help="Processes; default: one a core, 0: none.", validator=bounded(bounds.WORKERS)),
]
